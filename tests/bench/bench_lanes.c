/* SPDX-License-Identifier: MIT */
/* What lanes bring besides batches of doubles: floats beside doubles, for every pair and for sums, in cycles of samples
   of a core at rest (quiet.h); one point against many elements beside the closed forms, two threads beside one, the
   smallest of several interleaved runs, times of the threads' own but for the last. It only reports. With arguments,
   only floats, and of their rows those whose names contain one of them ("cauchy arc"). */
#include "core/vec3.h"
#include "field/kernel.h"
#include "quiet.h"
#include "random.h"
#include "skelfield/field.h"
#include "units.h"
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { POINTS = 1024, PAD = 24, RUNS = 25, LARGE = 1 << 19, SECONDS = 3 };

/* padded: rows a multiple of 4096 bytes apart disturb */
static double p[3][LARGE + PAD], F[LARGE], g[3][LARGE + PAD];
static float pf[3][POINTS + PAD], Ff[POINTS + PAD], gf[3][POINTS + PAD];
static quiet_state quiet;

static const struct {
  const char *name;
  skf_kernel_type kernel;
  skf_shape shape;
  int n;
} rows[] = {{"Newtonian segment", SKF_INVERSE, SKF_SEGMENT, 1},
            {"Cauchy segment", SKF_CAUCHY, SKF_SEGMENT, 1},
            {"Cauchy arc", SKF_CAUCHY, SKF_ARC, 1},
            {"Newtonian triangle", SKF_INVERSE, SKF_TRIANGLE, 1},
            {"quartic point", SKF_QUARTIC, SKF_POINT, 1},
            {"64 quartic points", SKF_QUARTIC, SKF_POINT, 64},
            {"64 inverse points", SKF_INVERSE, SKF_POINT, 64},
            {"8 Cauchy segments", SKF_CAUCHY, SKF_SEGMENT, 8},
            {"100 Cauchy segments", SKF_CAUCHY, SKF_SEGMENT, 100},
            {"1000 Newtonian segments", SKF_INVERSE, SKF_SEGMENT, 1000},
            {"100 Newtonian triangles", SKF_INVERSE, SKF_TRIANGLE, 100},
            {"100 Cauchy arcs", SKF_CAUCHY, SKF_ARC, 100}};
enum { ROWS = sizeof rows / sizeof *rows };

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void elements(int row, skf_element *e) {
  uint64_t seed = 3;
  for (int i = 0; i < rows[row].n; i++) {
    e[i] = (skf_element){.kernel = {rows[row].kernel, 1.5, NULL}, .strength = 1};
    rnd_primitive(&seed, rows[row].shape, 1, &e[i].primitive);
    if (rows[row].shape == SKF_ARC) e[i].primitive.arc.sweep = 2;
  }
}

static skf_field *make(int row, const char *isa) {
  skf_field *f = NULL;
  skf_element *e = calloc((size_t)rows[row].n, sizeof *e);
  if (e) elements(row, e);
  if (isa) setenv("SKELFIELD_ISA", isa, 1);
  if (!e || skf_field_new(e, (size_t)rows[row].n, &f)) exit(1);
  unsetenv("SKELFIELD_ISA");
  free(e);
  return f;
}

static void batch(const skf_field *f, size_t n) {
  const double *const in[3] = {p[0], p[1], p[2]};
  double *const out[3] = {g[0], g[1], g[2]};
  skf_field_eval(f, n, in, F, out, NULL);
}

static double at(const skf_field *f, size_t n) {
  double sum = 0;
  for (size_t i = 0; i < n; i++) {
    skf_vec3 slope;
    sum += skf_field_at(f, v3(p[0][i], p[1][i], p[2][i]), &slope) + slope.x;
  }
  return sum;
}

static bool wanted(const char *name, int words, char **word) {
  for (int i = 0; i < words; i++)
    if (strstr(name, word[i])) return true;
  return words == 0;
}

/* Largest error of F and of g in floats, in units of 2^-24 of themselves: points are floats in both */
static void errors(double e[2]) {
  e[0] = e[1] = 0;
  for (int i = 0; i < POINTS; i++) {
    const skf_vec3 want = v3(g[0][i], g[1][i], g[2][i]), got = v3((double)gf[0][i], (double)gf[1][i], (double)gf[2][i]);
    if (F[i] != 0) e[0] = fmax(e[0], fabs(((double)Ff[i] - F[i]) / F[i]) * 0x1p24);
    if (v3_norm(want) > 0) e[1] = fmax(e[1], v3_dist(want, got) / v3_norm(want) * 0x1p24);
  }
}

static void floats(const char *name, const skf_element *e, size_t n) {
  enum { IN_A_ROW = 4 };
  const float *const in[3] = {pf[0], pf[1], pf[2]};
  float *const out[3] = {gf[0], gf[1], gf[2]};
  quiet_series as_double, as_float;
  skf_field *f = NULL;
  skf_field_f32 *f32 = NULL;
  if (skf_field_new(e, n, &f) || skf_field_f32_new(f, v3(0, 0, 0), 1, &f32)) exit(1);
  quiet_clear(&as_double), quiet_clear(&as_float);
  const double end = quiet_now(CLOCK_MONOTONIC) + SECONDS * 1e9, per = 1. / IN_A_ROW / POINTS / (double)n;
  bool enough = false;
  for (int r = 0; r < RUNS || (!enough && quiet_now(CLOCK_MONOTONIC) < end); r++) {
    quiet_wait(&quiet, end);
    quiet_start(&quiet);
    for (int k = 0; k < IN_A_ROW; k++) batch(f, POINTS);
    double cycles = quiet_stop(&quiet);
    quiet_keep(&as_double, cycles * per, quiet_probe(&quiet));
    quiet_start(&quiet);
    for (int k = 0; k < IN_A_ROW; k++) skf_field_f32_eval(f32, POINTS, in, Ff, out);
    cycles = quiet_stop(&quiet);
    quiet_keep(&as_float, cycles * per, quiet_probe(&quiet));
    enough = quiet_enough(&as_double) && quiet_enough(&as_float);
  }
  double a = quiet_median(&as_double), b = quiet_median(&as_float), error[2];
  errors(error);
  printf("%-30s %9.2f %9.2f %7.2f   %9.1f %9.1f%s\n", name, a, b, a / b, error[0], error[1], enough ? "" : "  *");
  skf_field_f32_free(f32);
  skf_field_free(f);
}

static void float_table(int words, char **word) {
  char name[64];
  printf(
      "cycles per element and point, value and gradient: doubles, floats, ratio; largest errors of F and g in floats "
      "in 2^-24\nof themselves (*: the core was shared nearly all of the time, the least of all)\n");
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = 0; s < SKF_SOLID; s++)
      for (int other = 0; other <= (s == SKF_ARC || s == SKF_PLANE); other++) {
        const skf_element e = {unit((skf_shape)s, other), {.type = (skf_kernel_type)k, .param = 1.5}, 1};
        const char *shape = skf_shape_get((skf_shape)s)->name;
        if (other) shape = s == SKF_ARC ? "circle" : "tilted plane";
        snprintf(name, sizeof name, "%s %s", skf_kernel_get((skf_kernel_type)k)->name, shape);
        if (wanted(name, words, word)) floats(name, &e, 1);
      }
  for (int i = 0; i < ROWS; i++) {
    if (rows[i].n == 1 || rows[i].n == 1000 || !wanted(rows[i].name, words, word)) continue;
    skf_element e[100];
    elements(i, e);
    floats(rows[i].name, e, (size_t)rows[i].n);
  }
}

static void points(int row) {
  double best[2] = {INFINITY, INFINITY}, ignored = 0;
  size_t n = (size_t)(4000 / rows[row].n + 4);
  skf_field *f[2] = {make(row, "scalar"), make(row, NULL)};
  for (int r = 0; r < RUNS; r++)
    for (int k = 0; k < 2; k++) {
      double t = now();
      ignored += at(f[k], n);
      best[k] = fmin(best[k], now() - t);
    }
  double per = 1e9 / (double)n;
  printf("%-26s closed forms %9.0f   lanes %8.0f   %.1fx%s\n", rows[row].name, best[0] * per, best[1] * per,
         best[0] / best[1], ignored == 1 ? "." : "");
  skf_field_free(f[0]);
  skf_field_free(f[1]);
}

static void threads(int row) {
  double best[2] = {INFINITY, INFINITY};
  size_t n = rows[row].n > 1 ? LARGE / 64 : LARGE;
  skf_field *f = make(row, NULL);
  for (int r = 0; r < RUNS; r++)
    for (int k = 0; k < 2; k++) {
      omp_set_num_threads(k + 1);
      double t = omp_get_wtime();
      batch(f, n);
      best[k] = fmin(best[k], omp_get_wtime() - t);
    }
  printf("%-26s one thread %9.2f ms   two %8.2f ms   %.2fx\n", rows[row].name, best[0] * 1e3, best[1] * 1e3,
         best[0] / best[1]);
  omp_set_num_threads(1);
  skf_field_free(f);
}

int main(int argc, char **argv) {
  uint64_t seed = 1;
  omp_set_num_threads(1);
  for (int i = 0; i < LARGE; i++)
    for (int k = 0; k < 3; k++) {
      const float x = (float)rnd(&seed, -1.5, 1.5);
      p[k][i] = (double)x;
      if (i < POINTS) pf[k][i] = x;
    }
  quiet = quiet_begin();
  float_table(argc - 1, argv + 1);
  printf("clock %.2f GHz, %.0f %% of the samples quiet\n", 1 / quiet.cycle_ns, 100 * quiet.quiet / quiet.probed);
  if (argc > 1) return 0;
  puts("one point, ns");
  for (int i = 0; i < ROWS; i++)
    if (rows[i].n > 1) points(i);
  puts("batches, wall time");
  for (int i = 0; i < ROWS; i++)
    if (rows[i].n <= 64) threads(i);
  return 0;
}
