/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A progress bar on a terminal. */
#include "cli_private.h"
#include <math.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static struct {
  bool active, terminal, drawn;
  double start, last;
  const char *label;
} bar;

double cli_seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void put_time(char *text, size_t size, double s) {
  if (!(s < 3600 * 100))
    snprintf(text, size, "--:--");
  else if (s < 3600)
    snprintf(text, size, "%d:%02d", (int)s / 60, (int)s % 60);
  else
    snprintf(text, size, "%d:%02d:%02d", (int)s / 3600, (int)s / 60 % 60, (int)s % 60);
}

static void draw(double done, double time) {
  enum { WIDTH = 30 };
  char cells[WIDTH + 1], left[16];
  int full = (int)(done * WIDTH);
  memset(cells, '#', (size_t)full);
  memset(cells + full, '.', (size_t)(WIDTH - full));
  cells[WIDTH] = 0;
  put_time(left, sizeof left, done > 0 ? (time - bar.start) * (1 - done) / done : INFINITY);
  fprintf(stderr, "\r\033[K%s [%s] %3d%%, %s left", bar.label, cells, (int)(100 * done), left);
  fflush(stderr);
  bar.drawn = true;
}

static int report(void *user, double done) {
  (void)user;
  if (bar.active && bar.terminal) {
    double time = cli_seconds();
    if (time - bar.last >= 0.1) { /* a faster bar is only flicker */
      draw(fmin(fmax(done, 0), 1), time);
      bar.last = time;
    }
  }
  return cli_interrupted();
}

skf_progress cli_progress(const char *label) {
  cli_progress_end();
  bar.active = true;
  bar.terminal = !cli_is_muted() && isatty(STDERR_FILENO);
  bar.drawn = false;
  bar.start = bar.last = cli_seconds();
  bar.label = label;
  cli_polite(true);
  return (skf_progress){report, NULL};
}

void cli_progress_end(void) {
  if (bar.active && bar.drawn) fputs("\r\033[K", stderr);
  bar.active = bar.drawn = false;
  cli_polite(false);
}
