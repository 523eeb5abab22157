/* SPDX-License-Identifier: MIT */
/* A Kepler orbit, e = 0.5, 100 revolutions: the time of each integrator at the loosest tolerance that ends within 1e-8
 * of the exact place, alone and in runs of many particles, beside GSL's rk8pd and ARKODE's Fehlberg 7(8) where they are
 * installed, all interleaved; two threads against one; then 1,000 revolutions at rounding level. CPU time of the
 * thread; bench_motion [REPEATS]. */
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
#ifdef SKF_HAVE_ARKODE
#include <arkode/arkode_erkstep.h>
#include <nvector/nvector_serial.h>
#endif

#define TAU  6.283185307179586
#define GOAL 1e-8
#define MOST 4096

/* What is measured: one way to fly `count` particles, each ms / particle. */
typedef struct entrant {
  const char *name;
  enum { OURS, GSL, ARKODE } whose;
  size_t count;
  double tolerance, error, best, times[64];
  size_t evaluations; /* of one particle */
} entrant;

static skf_world *world;
static skf_state start[MOST], final[MOST];

static double seconds(clockid_t clock) {
  struct timespec t;
  clock_gettime(clock, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
static double now(void) { return seconds(CLOCK_THREAD_CPUTIME_ID); }

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

/* The right-hand side for others. */
static void pull(const double y[6], double f[6]) {
  double r2 = y[0] * y[0] + y[1] * y[1] + y[2] * y[2], w = -1 / (r2 * sqrt(r2));
  for (int k = 0; k < 3; k++) f[k] = y[3 + k], f[3 + k] = w * y[k];
}
static const double first[6] = {0.5, 0, 0, 0, 1.7320508075688772, 0};

#ifdef SKF_HAVE_GSL
static int gsl_force(double t, const double y[], double f[], void *count) {
  (void)t;
  pull(y, f);
  return ++*(size_t *)count, 0;
}

static void gsl(const entrant *e, double revolutions, skf_flight_report *report) {
  double y[6], t = 0;
  memcpy(y, first, sizeof y);
  gsl_odeiv2_system s = {gsl_force, NULL, 6, &report->evaluations};
  gsl_odeiv2_driver *d = gsl_odeiv2_driver_alloc_y_new(&s, gsl_odeiv2_step_rk8pd, 1e-3, e->tolerance, e->tolerance);
  gsl_odeiv2_driver_apply(d, &t, revolutions * TAU, y);
  final[0].position = (skf_vec3){y[0], y[1], y[2]};
  gsl_odeiv2_driver_free(d);
}
#else
static void gsl(const entrant *e, double revolutions, skf_flight_report *report) {
  (void)e, (void)revolutions, (void)report;
}
#endif

#ifdef SKF_HAVE_ARKODE
static int arkode_force(double t, N_Vector y, N_Vector f, void *count) {
  (void)t;
  pull(N_VGetArrayPointer(y), N_VGetArrayPointer(f));
  return ++*(size_t *)count, 0;
}

static void arkode(const entrant *e, double revolutions, skf_flight_report *report) {
  SUNContext context;
  double t, end = revolutions * TAU;
  if (SUNContext_Create(NULL, &context)) exit(1);
  N_Vector y = N_VNew_Serial(6, context);
  memcpy(N_VGetArrayPointer(y), first, sizeof first);
  void *a = ERKStepCreate(arkode_force, 0, y, context);
  ERKStepSStolerances(a, e->tolerance, e->tolerance);
  ERKStepSetTableNum(a, ARKODE_FEHLBERG_13_7_8);
  ERKStepSetUserData(a, &report->evaluations);
  ERKStepSetMaxNumSteps(a, 10000000);
  ERKStepSetStopTime(a, end);
  if (ERKStepEvolve(a, end, y, &t, ARK_NORMAL) < 0) t = NAN;
  const double *at = N_VGetArrayPointer(y);
  final[0].position = (skf_vec3){at[0] + 0 * t, at[1], at[2]};
  ERKStepFree(&a);
  N_VDestroy(y);
  SUNContext_Free(&context);
}
#else
static void arkode(const entrant *e, double revolutions, skf_flight_report *report) {
  (void)e, (void)revolutions, (void)report;
}
#endif

/* Milliseconds a particle. */
static double once(entrant *e, double revolutions) {
  skf_flight_report r = {0};
  double begun = now();
  void (*const how[])(const entrant *, double, skf_flight_report *) = {fly, gsl, arkode};
  how[e->whose](e, revolutions, &r);
  double ms = 1e3 * (now() - begun) / (double)e->count;
  e->error = 0;
  for (size_t i = 0; i < e->count; i++)
    e->error =
        fmax(e->error, hypot(final[i].position.x - start[i].position.x, final[i].position.y - start[i].position.y));
  if (r.evaluations) e->evaluations = r.evaluations;
  return ms;
}

/* The loosest tolerance from 10^(-k/8) on that meets the goal, as does the next one, in steps of 10^(1/8). */
static bool tune(entrant *e, int k) {
  bool before = false;
  for (; k <= 116; k++) {
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

static void tell(const entrant *e, int repeats) {
  double least = e->times[0], median = e->times[repeats / 2];
  printf("%-12s %5zu particle%s tolerance %7.1e  off by %7.1e  %8.4f / %8.4f ms each (min / median)", e->name, e->count,
         e->count == 1 ? " " : "s", e->tolerance, e->error, least, median);
  if (e->count == 1) printf("  %6zu evaluations, %3.0f ns each", e->evaluations, 1e6 * least / (double)e->evaluations);
  printf("\n");
}

/* Two threads against one. Both times are given, since a busy machine has not two cores to give: then the time that
   passes says nothing, and the time that the process spends tells what the second thread adds to the work. */
static void pair(entrant e, int repeats) {
  double best[3][2] = {{0}, {INFINITY, INFINITY}, {INFINITY, INFINITY}}; /* by threads: passed, spent */
  for (int r = 0; r < repeats; r++)
    for (int threads = 1; threads <= 2; threads++) {
      omp_set_num_threads(threads);
      double wall = seconds(CLOCK_MONOTONIC), spent = seconds(CLOCK_PROCESS_CPUTIME_ID);
      once(&e, 100);
      best[threads][0] = fmin(best[threads][0], seconds(CLOCK_MONOTONIC) - wall);
      best[threads][1] = fmin(best[threads][1], seconds(CLOCK_PROCESS_CPUTIME_ID) - spent);
    }
  omp_set_num_threads(1);
  printf("%zu particles on two threads: %.2f times as fast as on one; processor time %.3f of that of one\n", e.count,
         best[1][0] / best[2][0], best[2][1] / best[1][1]);
}

static void compare(int repeats) {
  entrant all[24];
  size_t n = 0;
#ifdef SKF_HAVE_GSL
  all[n++] = (entrant){.name = "gsl rk8pd", .whose = GSL, .count = 1};
#endif
#ifdef SKF_HAVE_ARKODE
  all[n++] = (entrant){.name = "arkode 7(8)", .whose = ARKODE, .count = 1};
#endif
  const size_t others = n;
  for (size_t i = 0; i < skf_integrator_count(); i++)
    if (skf_integrator_get(i)->adaptive) all[n++] = (entrant){.name = skf_integrator_get(i)->name, .count = 1};
  for (size_t i = 0, single = n; i < single; i++) {
    bool done = tune(all + i, 48), rkn = strcmp(all[i].name, "rkn12") == 0;
    for (size_t count = 256; done && rkn && count <= MOST; count *= 16) { /* the worst of them meets the goal */
      all[n] = (entrant){.name = all[i].name, .count = count};
      tune(all + n++, (int)round(-8 * log10(all[i].tolerance)));
    }
  }
  for (int r = 0; r < repeats; r++)
    for (size_t i = 0; i < n; i++)
      if (all[i].tolerance > 0) all[i].times[r] = once(all + i, 100);
  for (size_t i = 0; i < n; i++)
    if (all[i].tolerance > 0)
      qsort(all[i].times, (size_t)repeats, sizeof *all[i].times, ascending), tell(all + i, repeats);
  for (size_t k = 0; k < others; k++)
    for (size_t i = others; i < n; i++)
      if (all[k].tolerance > 0 && all[i].tolerance > 0)
        printf("%s / %s of %zu: %.2f (min), %.2f (median)\n", all[k].name, all[i].name, all[i].count,
               all[k].times[0] / all[i].times[0], all[k].times[repeats / 2] / all[i].times[repeats / 2]);
  if (all[n - 1].count == MOST) pair(all[n - 1], repeats);
}

static void long_run(const char *name, double tolerance, int repeats) {
  entrant e = {.name = name, .count = 1, .tolerance = tolerance};
  skf_flight_report r = {0};
  for (int k = 0; k < repeats; k++) e.times[k] = once(&e, 1000);
  fly(&e, 1000, &r);
  qsort(e.times, (size_t)repeats, sizeof *e.times, ascending);
  printf("1,000 revolutions, energy within %.1e: ", r.energy_drift);
  tell(&e, repeats);
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
