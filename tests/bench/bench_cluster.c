/* SPDX-License-Identifier: MIT */
/* Particles that attract each other: the direct sum of each instruction set beside a plain loop, in ns per pair, and
   whole steps of clouds, in ns per pair and evaluation (minimum of interleaved
   runs; CPU time of one thread, the clock's of several). */
#include "core/vec3.h"
#include "motion/pairs.h"
#include "random.h"
#include "skelfield/motion.h"
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { RUNS = 7, MOST = 4096 };

static double now(clockid_t clock) {
  struct timespec t;
  clock_gettime(clock, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double x[3][MOST], a[3][MOST], gm[MOST], rough[MOST];
static unsigned same[MOST];

/* What a program that knows nothing of vectors does. */
static void plain(const skf_pullers *s, size_t m, const double *const p[3], double *const to[3], double *out,
                  unsigned *hits) {
  (void)out, (void)hits;
  for (size_t i = 0; i < m; i++)
    for (size_t j = 0; j < s->n; j++) {
      if (i == j) continue;
      double d[3] = {s->x[0][j] - p[0][i], s->x[1][j] - p[1][i], s->x[2][j] - p[2][i]};
      double r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + s->softening2, w = s->gm[j] / (r2 * sqrt(r2));
      for (int k = 0; k < 3; k++) to[k][i] += w * d[k];
    }
}

static void sums(size_t n) {
  skf_pairs_pull *const ways[] = {plain, skf_pairs_pick(SKF_ISA_SCALAR), skf_pairs_pick(skf_isa_pick())};
  static const char *const names[] = {"plain loop", "base", "best"};
  double best[3] = {INFINITY, INFINITY, INFINITY};
  skf_pullers s = {n, {x[0], x[1], x[2]}, gm, 1e-4};
  size_t repeat = 4000000 / (n * n) + 1;
  for (int r = 0; r < RUNS; r++)
    for (int k = 0; k < 3; k++) {
      double t = now(CLOCK_THREAD_CPUTIME_ID);
      for (size_t q = 0; q < repeat; q++)
        ways[k](&s, n, (const double *const[]){x[0], x[1], x[2]}, (double *const[]){a[0], a[1], a[2]}, rough, same);
      t = (now(CLOCK_THREAD_CPUTIME_ID) - t) / (double)(repeat * n * n);
      best[k] = t < best[k] ? t : best[k];
    }
  printf("%5zu particles:", n);
  for (int k = 0; k < 3; k++) printf("  %s %.2f ns", names[k], 1e9 * best[k]);
  printf("  (%.1f times as fast)\n", best[0] / best[2]);
}

static skf_status ignore(void *user, double t, const skf_state *states) {
  return (void)user, (void)t, (void)states, SKF_OK;
}

static void flights(const skf_world *w, size_t n, int threads) {
  skf_state *start = calloc(n, sizeof *start);
  skf_flight_report *report = calloc(n, sizeof *report);
  uint64_t seed = 3;
  double best = INFINITY;
  for (size_t i = 0; i < n; i++) start[i] = (skf_state){0, rnd_vec(&seed, 1), rnd_vec(&seed, 0.3)};
  skf_run run = {.count = n, .start = start, .t_end = 0.05, .gm = gm, .softening = 0.01};
  omp_set_num_threads(threads);
  for (int r = 0; r < 3; r++) {
    clockid_t clock = threads > 1 ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID;
    double t = now(clock);
    if (skf_run_all(w, &run, &(skf_run_sink){ignore, NULL, NULL}, NULL, report, NULL)) exit(1);
    t = now(clock) - t;
    best = t < best ? t : best;
  }
  double pairs = (double)report[0].evaluations * (double)n * (double)n;
  printf("%5zu particles, %d thread%s: %zu steps, %.3f s, %.2f ns a pair and evaluation, energy %.1e\n", n, threads,
         threads > 1 ? "s" : "", report[0].steps, best, 1e9 * best / pairs, report[0].energy_drift);
  free(start), free(report);
}

int main(void) {
  uint64_t seed = 1;
  for (size_t i = 0; i < MOST; i++) {
    skf_vec3 p = rnd_vec(&seed, 1);
    x[0][i] = p.x, x[1][i] = p.y, x[2][i] = p.z, gm[i] = 1.0 / MOST;
  }
  for (size_t n = 16; n <= MOST; n *= 4) sums(n);
  skf_element e = {{.shape = SKF_POINT, .point = {{0, 0, 0}}}, {SKF_INVERSE, 0}, 1};
  skf_field *field;
  skf_world *w;
  if (skf_field_new(&e, 1, &field) || skf_world_new(&(skf_attractor){field, 1e9, 0, {{0, 0, 1}, {0, 0, 0}, 0}}, 1, &w))
    return 1;
  for (size_t n = 3; n <= 1000; n = n == 3 ? 100 : 10 * n)
    for (int threads = 1; threads <= 2; threads++) flights(w, n, threads);
  skf_world_free(w), skf_field_free(field);
  return 0;
}
