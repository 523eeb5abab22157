/* SPDX-License-Identifier: MIT */
/* Every integrator of the registry against exact orbits. */
#include "motion/worlds.h"
#include <string.h>

static skf_field *sun_field;
static skf_world *sun;

static int set_up(void **state) {
  (void)state;
  skf_element e = point_at(0, 0, 0, newton);
  sun = single(&e, 1, 1e3, 1, (skf_spin){0}, &sun_field);
  return 0;
}

static int tear_down(void **state) {
  (void)state;
  skf_world_free(sun);
  skf_field_free(sun_field);
  return 0;
}

/* Distance from the exact orbit after a time, relative to the semi-major axis 1. */
static double kepler_error(double e, double t, skf_state s) {
  double mean = fmod(t, TAU) - (t - fmod(t, TAU)) / TAU * 2.4492935982947064e-16, E = mean + e * sin(mean);
  for (int i = 0; i < 50; i++) E -= (E - e * sin(E) - mean) / (1 - e * cos(E));
  return hypot(s.position.x - (cos(E) - e), s.position.y - sqrt((1 - e) * (1 + e)) * sin(E));
}

static void registry_is_complete(void **state) {
  (void)state;
  assert_true(skf_integrator_count() >= 2);
  assert_ptr_equal(skf_integrator_find(NULL), skf_integrator_get(0));
  assert_ptr_equal(skf_integrator_find(""), skf_integrator_get(0));
  assert_null(skf_integrator_find("euler"));
  assert_null(skf_integrator_get(skf_integrator_count()));
  for (size_t i = 0; i < skf_integrator_count(); i++) {
    const skf_integrator_info *info = skf_integrator_get(i);
    assert_ptr_equal(skf_integrator_find(info->name), info);
    assert_true(info->order >= 8 && info->dense_order >= 7 && strlen(info->doc) > 10);
  }
}

/* The error of whole orbits at the default tolerance; between the steps too. */
static void orbits_come_back(void **state) {
  (void)state;
  const double excentricity[] = {0, 0.5, 0.9};
  for (size_t i = 0; i < skf_integrator_count(); i++)
    for (int k = 0; k < 3; k++) {
      skf_flight *f = fly(sun, (skf_flight_options){.integrator = skf_integrator_get(i)->name, .tolerance = 1e-12},
                          kepler(excentricity[k]));
      double worst = 0;
      for (int q = 1; q <= 700; q++)
        worst = fmax(worst, kepler_error(excentricity[k], q * 0.9, state_at(f, q * 0.9, NULL, NULL)));
      skf_flight_report r = skf_flight_get_report(f);
      /* measured: gauss-radau 8e-12, 6e-16, 2e-15; rkn12 2e-11, 8e-15, 8e-15; dop853 1.2e-8, 2e-12, 9e-12 */
      bool best = skf_integrator_get(i)->order > 10;
      check_scaled(worst, 0, 1, best ? 3e-11 : 4e-8);
      check_scaled(r.energy_drift, 0, 1, best ? 5e-15 : 1e-11);
      check_scaled(r.momentum_drift, 0, 1, best ? 5e-15 : 4e-11);
      skf_flight_free(f);
    }
}

/* The error at a time with steps of length h, no other control: at the end of a step, or in the middle of one. */
static double error_at_step(size_t i, double h, bool between) {
  skf_flight *f =
      fly(sun, (skf_flight_options){.integrator = skf_integrator_get(i)->name, .tolerance = 0.1, .max_step = h},
          kepler(0.2));
  double from, to, worst = 0;
  do {
    assert_int_equal(skf_flight_step(f, NULL, NULL), SKF_OK);
    skf_flight_span(f, &from, &to);
  } while (to < 6);
  skf_state s;
  for (int k = 1; k <= (between ? 7 : 0); k++) {
    double t = from + k * 0.125 * (to - from);
    skf_flight_at(f, t, &s);
    worst = fmax(worst, kepler_error(0.2, t, s));
  }
  if (!between) skf_flight_at(f, to, &s), worst = kepler_error(0.2, to, s);
  skf_flight_free(f);
  return worst;
}

static void orders_hold(void **state) {
  (void)state;
  for (size_t i = 0; i < skf_integrator_count(); i++) {
    const skf_integrator_info *info = skf_integrator_get(i);
    double h = info->order > 12 ? 1.1 : info->order > 10 ? 1.5 : 0.4;
    double order = log2(error_at_step(i, h, false) / error_at_step(i, h / 2, false));
    double dense = log2(error_at_step(i, h, true) / error_at_step(i, h / 2, true));
    check_scaled(order, info->order, 1, 1);
    check_scaled(dense, info->dense_order, 1, 1);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(registry_is_complete),
      cmocka_unit_test(orbits_come_back),
      cmocka_unit_test(orders_hold),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
