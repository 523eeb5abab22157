/* SPDX-License-Identifier: MIT */
/* Large skeletons: 10^5 and 10^6 random Newtonian segments in a unit box, 0.02 long, and 10^5 of 1/r^2 and Cauchy, at
   10^6 random points in it. Times of the library's direct sum (of fewer points) and of the expansions, what those cost
   to make, and the worst difference; and elements of finite support. With the name of a kernel, its parameter, how many
   segments and the accuracy only that. CPU time on one thread; it only reports. */
#include "core/vec3.h"
#include "skelfield/field.h"
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { POINTS = 1000000, SAMPLES = 512 };

static double p[3][POINTS], F[POINTS], g[3][POINTS], want[SAMPLES], slope[3][SAMPLES];
static unsigned long long seed = 1;

static double uniform(void) {
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(seed >> 11) * 0x1p-53;
}

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static skf_element *segments(size_t n, skf_kernel kernel) {
  skf_element *e = calloc(n, sizeof *e);
  for (size_t i = 0; e && i < n; i++) {
    skf_vec3 m = {uniform(), uniform(), uniform()}, d = {uniform() - 0.5, uniform() - 0.5, uniform() - 0.5};
    d = v3_scale(0.01, v3_unit(d));
    e[i] = (skf_element){.kernel = kernel, .strength = 0.5 + uniform()};
    e[i].primitive = (skf_primitive){.shape = SKF_SEGMENT, .segment = {v3_sub(m, d), v3_add(m, d)}};
  }
  return e;
}

static double eval(const skf_field *f, size_t n, double *value, double *const grad[3]) {
  const double *const in[3] = {p[0], p[1], p[2]};
  double t = now();
  if (skf_field_eval(f, n, in, value, grad, NULL)) exit(1);
  return (now() - t) / (double)n * 1e6;
}

/* us per point by expansions */
static double row(const skf_element *e, size_t n, double accuracy, double direct) {
  const char *kernel = skf_kernel_get(e->kernel.type)->name;
  skf_field *f;
  double worst[2] = {0, 0}, t = now();
  if (skf_field_new_with(e, n, &(skf_field_options){.accuracy = accuracy}, &f)) exit(1);
  t = now() - t;
  double us = eval(f, POINTS, F, (double *const[3]){g[0], g[1], g[2]});
  for (int i = 0; i < SAMPLES; i++) {
    skf_vec3 a = {slope[0][i], slope[1][i], slope[2][i]}, b = {g[0][i], g[1][i], g[2][i]};
    worst[0] = fmax(worst[0], fabs(F[i] - want[i]) / want[i]);
    worst[1] = fmax(worst[1], v3_dist(a, b) / (v3_norm(a) + want[i]));
  }
  printf("%-15s %6g  %8zu  %6.0e  %7.2f  %9.2f  %8.1f  %6.0fx  %5.0fx  %8.1e  %8.1e\n", kernel, e->kernel.param, n,
         accuracy, t, us, direct, direct / us, direct / (us + t * 1e6 / POINTS), worst[0], worst[1]);
  fflush(stdout);
  skf_field_free(f);
  return us;
}

/* Elements of finite support, twenty of which reach a point: each point and segment costs what it has near it. */
static void compact(const char *name, bool segment, size_t n) {
  skf_element *e = segments(n, (skf_kernel){.type = SKF_INVERSE});
  skf_field *f;
  double R = cbrt(20 / (double)n * 3 / (4 * 3.14159265358979)), t = now();
  for (size_t i = 0; e && i < n; i++) {
    e[i].kernel = (skf_kernel){.type = SKF_QUARTIC, .param = R};
    skf_vec3 a = e[i].primitive.segment.from, d = v3_sub(e[i].primitive.segment.to, a);
    if (segment)
      e[i].primitive.segment.to = v3_mad(a, 50 * R, d); /* as long as R */
    else
      e[i].primitive = (skf_primitive){.shape = SKF_POINT, .point = {a}};
  }
  if (!e || skf_field_new(e, n, &f)) exit(1);
  t = now() - t;
  printf("%8zu quartic %s: made in %.2f s, %.2f us/point\n", n, name, t,
         eval(f, POINTS, F, (double *const[3]){g[0], g[1], g[2]}));
  skf_field_free(f);
  free(e);
}

/* Rows of n segments, at each accuracy until 0; us per point at the first. */
static double rows(skf_kernel kernel, size_t n, const double *accuracy) {
  skf_element *e = segments(n, kernel);
  size_t few = n > 100000 ? SAMPLES / 4 : SAMPLES;
  double us = 0;
  skf_field *f;
  if (!e || skf_field_new(e, n, &f)) exit(1);
  double direct = eval(f, few, want, (double *const[3]){slope[0], slope[1], slope[2]});
  if (few < SAMPLES) eval(f, SAMPLES, want, (double *const[3]){slope[0], slope[1], slope[2]});
  skf_field_free(f);
  for (int i = 0; accuracy[i] > 0; i++) {
    double one = row(e, n, accuracy[i], direct);
    us = i ? us : one;
  }
  return free(e), us;
}

static int alone(char **argv) {
  for (int k = 0; k < SKF_KERNEL_COUNT; k++) {
    if (strcmp(argv[1], skf_kernel_get((skf_kernel_type)k)->name)) continue;
    const double accuracy[2] = {atof(argv[4]), 0};
    return rows((skf_kernel){.type = (skf_kernel_type)k, .param = atof(argv[2])}, (size_t)atof(argv[3]), accuracy), 0;
  }
  return fprintf(stderr, "bench_tree: no kernel %s\n", argv[1]), 2;
}

int main(int argc, char **argv) {
  static const double both[] = {1e-6, 1e-12, 0}, one[] = {1e-6, 0};
  double us[2];
  omp_set_num_threads(1);
  for (int k = 0; k < 3; k++)
    for (size_t i = 0; i < POINTS; i++) p[k][i] = uniform();
  if (argc == 5) return alone(argv);
  for (size_t n = 10000; n <= 1000000; n *= 10) compact("points", false, n), compact("segments", true, n);
  puts("kernel           param  segments  accuracy  made, s  us/point    direct    ratio  with making  F off   "
       "gradient off");
  us[0] = rows((skf_kernel){.type = SKF_INVERSE}, 100000, both);
  rows((skf_kernel){.type = SKF_INVERSE_SQUARED}, 100000, both);
  rows((skf_kernel){.type = SKF_CAUCHY, .param = 3}, 100000, one);
  rows((skf_kernel){.type = SKF_CAUCHY, .param = 100}, 100000, one);
  us[1] = rows((skf_kernel){.type = SKF_INVERSE}, 1000000, one);
  printf("time of a point, 10^6 segments over 10^5: %.2f\n", us[1] / us[0]);
  return 0;
}
