/* SPDX-License-Identifier: MIT */
/* 100 revolutions of a Kepler orbit, e = 0.5, by each integrator, and by GSL's rk8pd in the same run where there is
 * one. */
#include "skelfield/motion.h"
#include <math.h>
#include <stdio.h>
#include <time.h>
#ifdef SKF_HAVE_GSL
#include <gsl/gsl_odeiv2.h>
#endif

#define END (100 * 6.283185307179586)

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void tell(const char *name, double tolerance, double seconds, size_t evaluations, double x, double y) {
  printf("%-12s tolerance %.0e: %7.2f ms, %7zu evaluations, %4.0f ns each, position off by %.1e\n", name, tolerance,
         1e3 * seconds, evaluations, 1e9 * seconds / (double)evaluations, hypot(x - 0.5, y));
}

static void fly(const skf_world *world, const char *name, double tolerance) {
  skf_state s = {0, {0.5, 0, 0}, {0, sqrt(3), 0}};
  skf_flight *f;
  double from, to = 0, start = now();
  if (skf_flight_new(world, &(skf_flight_options){.integrator = name, .tolerance = tolerance}, &s, &f)) return;
  while (to < END && !skf_flight_step(f, NULL, NULL)) skf_flight_span(f, &from, &to);
  skf_flight_at(f, END, &s);
  tell(name, tolerance, now() - start, skf_flight_get_report(f).evaluations, s.position.x, s.position.y);
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

static void gsl(double tolerance) {
  size_t count = 0;
  double y[6] = {0.5, 0, 0, 0, sqrt(3), 0}, t = 0, start = now();
  gsl_odeiv2_system s = {force, NULL, 6, &count};
  gsl_odeiv2_driver *d = gsl_odeiv2_driver_alloc_y_new(&s, gsl_odeiv2_step_rk8pd, 1e-3, tolerance, tolerance);
  gsl_odeiv2_driver_apply(d, &t, END, y);
  tell("gsl rk8pd", tolerance, now() - start, count, y[0], y[1]);
  gsl_odeiv2_driver_free(d);
}
#endif

int main(void) {
  skf_element e = {{.shape = SKF_POINT, .point = {{0, 0, 0}}}, {SKF_INVERSE, 0}, 1};
  skf_field *field;
  skf_world *world;
  if (skf_field_new(&e, 1, &field)) return 1;
  if (skf_world_new(&(skf_attractor){field, 1e3, 1, {{0, 0, 1}, {0, 0, 0}, 0}}, 1, &world)) return 1;
  const double tolerances[] = {1e-8, 1e-10, 1e-12};
  for (int k = 0; k < 3; k++) {
    for (size_t i = 0; i < skf_integrator_count(); i++) fly(world, skf_integrator_get(i)->name, tolerances[k]);
#ifdef SKF_HAVE_GSL
    gsl(tolerances[k]);
#endif
  }
  skf_world_free(world);
  skf_field_free(field);
  return 0;
}
