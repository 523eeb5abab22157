/* SPDX-License-Identifier: MIT */
/* A Kepler orbit, e = 0.5, 100 revolutions: the time of each integrator at the loosest tolerance that ends within 1e-8
 * of the exact place, alone and in runs of many particles, beside GSL's rk8pd where there is one, all interleaved; then
 * 1,000 revolutions at rounding level. CPU time of the thread; bench_motion [REPEATS]. */
#include "skelfield/motion.h"
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#ifdef SKF_HAVE_GSL
#include <gsl/gsl_odeiv2.h>
#endif

#define TAU  6.283185307179586
#define GOAL 1e-8
#define MOST 4096

/* What is measured: one way to fly `count` particles, each ms / particle. */
typedef struct entrant {
  const char *name; /* of an integrator; NULL: GSL's */
  size_t count;
  double tolerance, error, best, times[64];
  size_t evaluations; /* of one particle */
} entrant;

static skf_world *world;
static skf_state start[MOST], final[MOST];

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The same orbit, turned by another angle for each particle. */
static void set_out(void) {
  for (size_t i = 0; i < MOST; i++) {
    double c = cos((double)i), s = sin((double)i), v = sqrt(3);
    start[i] = (skf_state){0, {0.5 * c, 0.5 * s, 0}, {-v * s, v * c, 0}};
  }
}

static skf_status keep(void *user, double t, const skf_state *states) {
  (void)t;
  memcpy(final, states, *(const size_t *)user * sizeof *states);
  return SKF_OK;
}

static void fly(const entrant *e, double revolutions, skf_flight_report *report) {
  skf_flight_options o = {.integrator = e->name, .tolerance = e->tolerance};
  double from, to = 0, end = revolutions * TAU;
  if (e->count > 1) {
    skf_run run = {e->count, start, end, 0, o};
    size_t count = e->count;
    skf_run_all(world, &run, &(skf_run_sink){.row = keep, .user = &count}, NULL, NULL, NULL);
    return;
  }
  skf_flight *f;
  if (skf_flight_new(world, &o, start, &f)) exit(1);
  while (to < end && !skf_flight_step(f, NULL, NULL)) skf_flight_span(f, &from, &to);
  skf_flight_at(f, end, final);
  *report = skf_flight_get_report(f);
  skf_flight_free(f);
}

#ifdef SKF_HAVE_GSL
static int force(double t, const double y[], double f[], void *count) {
  (void)t;
  double r2 = y[0] * y[0] + y[1] * y[1] + y[2] * y[2], w = -1 / (r2 * sqrt(r2));
  for (int k = 0; k < 3; k++) f[k] = y[3 + k], f[3 + k] = w * y[k];
  ++*(size_t *)count;
  return 0;
}

static void gsl(const entrant *e, double revolutions, skf_flight_report *report) {
  double y[6] = {0.5, 0, 0, 0, sqrt(3), 0}, t = 0;
  report->evaluations = 0;
  gsl_odeiv2_system s = {force, NULL, 6, &report->evaluations};
  gsl_odeiv2_driver *d = gsl_odeiv2_driver_alloc_y_new(&s, gsl_odeiv2_step_rk8pd, 1e-3, e->tolerance, e->tolerance);
  gsl_odeiv2_driver_apply(d, &t, revolutions * TAU, y);
  final[0].position = (skf_vec3){y[0], y[1], y[2]};
  gsl_odeiv2_driver_free(d);
}
#endif

/* Milliseconds a particle. */
static double once(entrant *e, double revolutions) {
  skf_flight_report r = {0};
  double begun = now();
#ifdef SKF_HAVE_GSL
  if (!e->name)
    gsl(e, revolutions, &r);
  else
#endif
    fly(e, revolutions, &r);
  double ms = 1e3 * (now() - begun) / (double)e->count;
  e->error = 0;
  for (size_t i = 0; i < e->count; i++)
    e->error =
        fmax(e->error, hypot(final[i].position.x - start[i].position.x, final[i].position.y - start[i].position.y));
  if (r.evaluations) e->evaluations = r.evaluations;
  return ms;
}

/* The loosest tolerance that meets the goal, as does the next one, in steps of 10^(1/8). */
static bool tune(entrant *e) {
  bool before = false;
  for (int k = 48; k <= 112; k++) {
    e->tolerance = pow(10, -0.125 * k);
    once(e, 100);
    if (e->error <= GOAL && before) return e->tolerance *= pow(10, 0.125), true;
    before = e->error <= GOAL;
  }
  return e->tolerance = 0, false;
}

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static void tell(entrant *e, int repeats, double unit) {
  qsort(e->times, (size_t)repeats, sizeof *e->times, ascending);
  double least = e->times[0], median = e->times[repeats / 2];
  printf("%-12s %5zu particle%s tolerance %7.1e  off by %7.1e  %8.4f / %8.4f ms each (min / median)",
         e->name ? e->name : "gsl rk8pd", e->count, e->count == 1 ? " " : "s", e->tolerance, e->error, least, median);
  if (e->count == 1) printf("  %6zu evaluations, %3.0f ns each", e->evaluations, 1e6 * least / (double)e->evaluations);
  if (unit > 0) printf("  rk8pd / it: %.2f", unit / median);
  printf("\n");
}

static void compare(int repeats) {
  entrant all[16] = {{NULL, 1, 0, 0, 0, {0}, 0}};
  size_t n = 0;
#ifdef SKF_HAVE_GSL
  n = 1;
#endif
  for (size_t i = 0; i < skf_integrator_count(); i++)
    if (skf_integrator_get(i)->adaptive) all[n++] = (entrant){.name = skf_integrator_get(i)->name, .count = 1};
  for (size_t i = 0, single = n; i < single; i++) {
    if (!tune(all + i) || !all[i].name || strcmp(all[i].name, "dop853") == 0) continue;
    for (size_t count = 256; count <= (strcmp(all[i].name, "rkn12") == 0 ? MOST : 256); count *= 16) {
      all[n] = all[i];
      all[n++].count = count;
    }
  }
  for (int r = 0; r < repeats; r++)
    for (size_t i = 0; i < n; i++)
      if (all[i].tolerance > 0) all[i].times[r] = once(all + i, 100);
  for (size_t i = 0; i < n; i++) {
    if (!(all[i].tolerance > 0)) continue;
    tell(all + i, repeats, all[0].name || i == 0 ? 0 : all[0].times[repeats / 2]);
  }
}

static void long_run(const char *name, double tolerance, int repeats) {
  entrant e = {.name = name, .count = 1, .tolerance = tolerance};
  skf_flight_report r = {0};
  for (int k = 0; k < repeats; k++) e.times[k] = once(&e, 1000);
  fly(&e, 1000, &r);
  printf("1,000 revolutions, energy within %.1e: ", r.energy_drift);
  tell(&e, repeats, 0);
}

int main(int argc, char **argv) {
  int repeats = argc > 1 ? atoi(argv[1]) : 7;
  if (repeats < 1 || repeats > 64) return 2;
  skf_element e = {{.shape = SKF_POINT, .point = {{0, 0, 0}}}, {SKF_INVERSE, 0}, 1};
  skf_field *field;
  if (skf_field_new(&e, 1, &field)) return 1;
  if (skf_world_new(&(skf_attractor){field, 1e3, 1, {{0, 0, 1}, {0, 0, 0}, 0}}, 1, &world)) return 1;
  omp_set_num_threads(1);
  set_out();
  compare(repeats);
  long_run("rkn12", 1e-13, repeats);
  long_run("gauss-radau", 1e-10, repeats);
  skf_world_free(world);
  skf_field_free(field);
  return 0;
}
