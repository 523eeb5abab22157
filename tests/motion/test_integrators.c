/* SPDX-License-Identifier: MIT */
/* Every integrator of the registry against exact orbits. */
#include "motion/gauss_radau.h"
#include "motion/worlds.h"
#include "random.h"
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
  assert_true(skf_integrator_count() >= 10 && adaptive_count() >= 3);
  assert_ptr_equal(skf_integrator_find(NULL), skf_integrator_get(0));
  assert_ptr_equal(skf_integrator_find(""), skf_integrator_get(0));
  assert_null(skf_integrator_find("euler"));
  assert_null(skf_integrator_get(skf_integrator_count()));
  for (size_t i = 0; i < skf_integrator_count(); i++) {
    const skf_integrator_info *info = skf_integrator_get(i);
    assert_ptr_equal(skf_integrator_find(info->name), info);
    assert_true(info->order >= 2 && info->dense_order >= 2 && strlen(info->doc) > 10);
    assert_true(!info->adaptive || (info->order >= 8 && info->dense_order >= 7));
  }
}

/* The error of whole orbits at the default tolerance; between the steps too. */
static void orbits_come_back(void **state) {
  (void)state;
  const double excentricity[] = {0, 0.5, 0.9};
  for (size_t i = 0; i < adaptive_count(); i++)
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

static skf_flight_options steps_of(size_t i, double h) {
  const skf_integrator_info *info = skf_integrator_get(i);
  return (skf_flight_options){.integrator = info->name,
                              .tolerance = info->adaptive ? 0.1 : 0,
                              .max_step = info->adaptive ? h : 0,
                              .step = info->adaptive ? 0 : h};
}

/* The error at a time with steps of length h, no other control: at the end of a step, or in the middle of one. */
static double error_at_step(size_t i, double h, bool between) {
  skf_flight *f = fly(sun, steps_of(i, h), kepler(0.2));
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
    double h = !info->adaptive ? 0.2 : info->order > 12 ? 1.1 : info->order > 10 ? 1.5 : 0.4;
    double order = log2(error_at_step(i, h, false) / error_at_step(i, h / 2, false));
    double dense = log2(error_at_step(i, h, true) / error_at_step(i, h / 2, true));
    print_message("%s: %g %g\n", info->name, order, dense);
    check_scaled(order, info->order, 1, 1);
    if (info->adaptive)
      check_scaled(dense, info->dense_order, 1, 1);
    else /* of high order the step's own error is still the larger one */
      assert_true(dense > info->dense_order - 0.5);
  }
}

/* Mean of the energy, or around what spins of the Jacobi constant, over a stretch of time. */
static double mean_invariant(const skf_world *w, skf_flight *f, double from, double span) {
  double sum = 0, start = 0;
  for (int k = 0; k < 1000; k++) {
    skf_state s = state_at(f, from + span * k / 1000, NULL, NULL);
    skf_invariants c = skf_world_invariants(w, &s);
    double value = isnan(c.energy) ? c.jacobi : c.energy;
    if (k == 0) start = value;
    sum += (value - start) / 1000;
  }
  return start + sum;
}

/* 100,000 revolutions with a fixed step: the energy oscillates by the error of a step, and is the same at the end. */
static void symplectic_steps_do_not_drift(void **state) {
  (void)state;
  skf_flight_options o = {.integrator = "leapfrog", .step = TAU / 100.3};
  skf_flight *f = fly(sun, o, kepler(0.2));
  /* spans that are no whole number of revolutions a sample */
  double first = mean_invariant(sun, f, 0, 618 * TAU), last = mean_invariant(sun, f, 99000 * TAU, 618 * TAU);
  double drift = fabs(last - first), swing = fabs(first + 0.5);
  print_message("leapfrog: mean energy moves by %.1e, swings by %.1e\n", drift, swing);
  assert_true(drift < 1e-2 * swing); /* the mean of 1,000 samples is not known any better */
  skf_flight_free(f);
}

/* The same around a cross that spins: the map is symplectic in its frame. */
static void turning_frames_do_not_drift(void **state) {
  (void)state;
  skf_element e[2] = {segment_of(v3(-2, 0, 0), v3(2, 0, 0), newton, 1),
                      segment_of(v3(0, -1, 0), v3(0, 1, 0), newton, 1)};
  skf_field *field;
  skf_world *w = single(e, 2, 1e3, 1.0 / 6, (skf_spin){{0, 0, 1}, {0, 0, 0}, 0.6}, &field);
  for (size_t i = adaptive_count(); i < skf_integrator_count(); i++) {
    const skf_integrator_info *info = skf_integrator_get(i);
    double h = info->order > 6 ? 0.5 : info->order > 2 ? 0.25 : 0.1;
    skf_flight *f =
        fly(w, (skf_flight_options){.integrator = info->name, .step = h}, (skf_state){0, {5, 0, 0.5}, {0, 0.5, 0.05}});
    double first = mean_invariant(w, f, 0, 2000), last = mean_invariant(w, f, 18000, 2000);
    double swing = fabs(first - skf_world_invariants(w, &(skf_state){0, {5, 0, 0.5}, {0, 0.5, 0.05}}).jacobi);
    print_message("%s: mean Jacobi constant off by %.1e, moves by %.1e\n", info->name, swing, fabs(last - first));
    assert_true(fabs(last - first) < 0.1 * swing + 1e-12);
    skf_flight_free(f);
  }
  skf_world_free(w);
  skf_field_free(field);
}

/* There and, with the velocity turned around, back. */
static void time_reverses(void **state) {
  (void)state;
  for (size_t i = 0; i < skf_integrator_count(); i++) {
    const skf_integrator_info *info = skf_integrator_get(i);
    skf_flight_options o = {.integrator = info->name, .step = info->adaptive ? 0 : 0.0625};
    skf_state begin = kepler(0.3);
    skf_flight *f = fly(sun, o, begin);
    skf_state s = state_at(f, 40, NULL, NULL);
    skf_flight_free(f);
    s.velocity = v3_scale(-1, s.velocity), s.t = 0;
    f = fly(sun, o, s);
    s = state_at(f, 40, NULL, NULL);
    double off = v3_dist(s.position, begin.position);
    print_message("%s: back within %.1e\n", info->name, off);
    check_scaled(off, 0, 1, info->adaptive ? 1e-9 : info->order == 4 ? 1e-7 : 1e-12);
    skf_flight_free(f);
  }
}

/* What Gauss-Radau does at its nodes has the same bits for every instruction set. */
static void nodes_do_not_see_the_instruction_set(void **state) {
  (void)state;
  const skf_radau_ops *ops[2] = {&skf_radau_base, skf_radau_get(skf_isa_pick())};
  uint64_t seed = 5;
  for (int k = 0; k < 100; k++) {
    skf_gauss_radau w = {.h = 1, .done = k % 10 ? rnd(&seed, 0.5, 2) : 0, .a0 = rnd_vec(&seed, 1)};
    w.from = (skf_orbit){.x = rnd_vec(&seed, 1), .v = rnd_vec(&seed, 1), .x_low = rnd_vec(&seed, 1e-16)};
    for (int i = 0; i < SKF_RADAU_TERMS; i++)
      w.b[i] = skf_row_of(rnd_vec(&seed, 1)), w.e[i] = skf_row_of(rnd_vec(&seed, 1));
    skf_radau_guess u[2];
    memset(u, 0, sizeof u);
    for (int i = 0; i < 2; i++) {
      skf_radau_predict(ops[i], &w, 1, u + i);
      u[i].ops = NULL; /* the rest is to be the same */
    }
    for (int n = 1; n < SKF_RADAU_NODES; n++) {
      skf_vec3 x[2], v[2], a = rnd_vec(&seed, 1);
      for (int i = 0; i < 2; i++) {
        ops[i]->place(u + i, 1.25, n, x + i, v + i);
        ops[i]->learn(n, a, u + i);
      }
      assert_memory_equal(x, x + 1, sizeof *x);
      assert_memory_equal(v, v + 1, sizeof *v);
      assert_memory_equal(u, u + 1, sizeof *u);
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(nodes_do_not_see_the_instruction_set),
      cmocka_unit_test(registry_is_complete),
      cmocka_unit_test(orbits_come_back),
      cmocka_unit_test(orders_hold),
      cmocka_unit_test(symplectic_steps_do_not_drift),
      cmocka_unit_test(turning_frames_do_not_drift),
      cmocka_unit_test(time_reverses),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
