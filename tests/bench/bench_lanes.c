/* SPDX-License-Identifier: MIT */
/* What lanes bring besides batches of doubles: floats beside doubles, one point against many elements beside the closed
   forms, two threads beside one. Smallest of several interleaved runs, times of the threads' own but for the last; it
   only reports. */
#include "random.h"
#include "skelfield/field.h"
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { POINTS = 2040, RUNS = 25, LARGE = 1 << 19 };

static double p[3][LARGE], F[LARGE], g[3][LARGE];
static float pf[3][POINTS], Ff[POINTS], gf[3][POINTS];

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

static skf_field *make(int row, const char *isa) {
  uint64_t seed = 3;
  skf_field *f = NULL;
  skf_element *e = calloc((size_t)rows[row].n, sizeof *e);
  for (int i = 0; e && i < rows[row].n; i++) {
    rnd_primitive(&seed, rows[row].shape, 1, &e[i].primitive);
    if (rows[row].shape == SKF_ARC) e[i].primitive.arc.sweep = 2;
    e[i].kernel = (skf_kernel){rows[row].kernel, 1.5, NULL}, e[i].strength = 1;
  }
  if (isa) setenv("SKELFIELD_ISA", isa, 1);
  if (!e || skf_field_new(e, (size_t)rows[row].n, &f)) exit(1);
  unsetenv("SKELFIELD_ISA");
  free(e);
  return f;
}

static double batch(const skf_field *f, size_t n) {
  const double *const in[3] = {p[0], p[1], p[2]};
  double *const out[3] = {g[0], g[1], g[2]};
  skf_field_eval(f, n, in, F, out, NULL);
  return 0;
}

static double at(const skf_field *f, size_t n) {
  double sum = 0;
  for (size_t i = 0; i < n; i++) {
    skf_vec3 slope;
    sum += skf_field_at(f, v3(p[0][i], p[1][i], p[2][i]), &slope) + slope.x;
  }
  return sum;
}

static void floats(int row) {
  const float *const in[3] = {pf[0], pf[1], pf[2]};
  float *const out[3] = {gf[0], gf[1], gf[2]};
  double best[2] = {INFINITY, INFINITY};
  skf_field *f = make(row, NULL);
  skf_field_f32 *f32 = NULL;
  if (skf_field_f32_new(f, v3(0, 0, 0), 1, &f32)) exit(1);
  for (int r = 0; r < RUNS; r++) {
    double t = now();
    batch(f, POINTS);
    best[0] = fmin(best[0], now() - t), t = now();
    skf_field_f32_eval(f32, POINTS, in, Ff, out);
    best[1] = fmin(best[1], now() - t);
  }
  double per = 1e9 / POINTS / rows[row].n;
  printf("%-26s double %7.2f   float %7.2f   %.2fx\n", rows[row].name, best[0] * per, best[1] * per, best[0] / best[1]);
  skf_field_f32_free(f32);
  skf_field_free(f);
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

int main(void) {
  uint64_t seed = 1;
  omp_set_num_threads(1);
  for (int i = 0; i < LARGE; i++)
    for (int k = 0; k < 3; k++) p[k][i] = rnd(&seed, -1.5, 1.5);
  for (int i = 0; i < POINTS; i++)
    for (int k = 0; k < 3; k++) pf[k][i] = (float)p[k][i];
  puts("batches, ns per element and point");
  for (int i = 0; i < ROWS; i++)
    if (rows[i].n != 1000) floats(i);
  puts("one point, ns");
  for (int i = 0; i < ROWS; i++)
    if (rows[i].n > 1) points(i);
  puts("batches, wall time");
  for (int i = 0; i < ROWS; i++)
    if (rows[i].n <= 64) threads(i);
  return 0;
}
