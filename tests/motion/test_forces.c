/* SPDX-License-Identifier: MIT */
/* Forces besides gravity, against solutions in closed form. */
#include "motion/worlds.h"
#include <complex.h>
#include <string.h>

static skf_field *nothing_field;

static int set_up(void **state) {
  (void)state;
  skf_element e = point_at(0, 0, 0, newton);
  nothing_field = field_of(&e, 1);
  return 0;
}

static int tear_down(void **state) {
  (void)state;
  skf_field_free(nothing_field);
  return 0;
}

/* One body without gravity that turns about z, and one force. */
static skf_world *world_with(skf_force force, double rate) {
  skf_world *w;
  skf_attractor body = {nothing_field, 1e3, 0, {{0, 0, 1}, {0, 0, 0}, rate}};
  assert_int_equal(skf_world_new_with(&body, 1, &force, 1, &w), SKF_OK);
  return w;
}

static skf_flight_options by(size_t i) {
  const skf_integrator_info *info = skf_integrator_get(i);
  return (skf_flight_options){.integrator = info->name, .step = info->adaptive ? 0 : 0.03125};
}

static bool takes(const skf_world *w, size_t i) {
  skf_flight *f;
  skf_flight_options o = by(i);
  skf_state s = {0, {1, 0, 0}, {0, 1, 0}};
  skf_status status = skf_flight_new(w, &o, &s, &f);
  skf_flight_free(f);
  assert_true(status == SKF_OK || status == SKF_ERR_UNSUPPORTED);
  return status == SKF_OK;
}

/* Flies through a world with every integrator that takes its force; returns how many do. */
static size_t check_all(skf_world *w, skf_state start, double t, skf_state want, double tolerance) {
  size_t taken = 0;
  for (size_t i = 0; i < skf_integrator_count(); i++) {
    const skf_integrator_info *info = skf_integrator_get(i);
    if (!takes(w, i)) continue;
    taken++;
    skf_flight *f = fly(w, by(i), start);
    skf_state s = state_at(f, t, NULL, NULL);
    double allowed = info->order > 6 ? tolerance : info->order > 4 ? 1e-8 : info->order > 2 ? 1e-5 : 1e-2;
    check_scaled(v3_dist(s.position, want.position), 0, 1, allowed);
    check_scaled(v3_dist(s.velocity, want.velocity), 0, 1, allowed);
    skf_invariants c = skf_world_invariants(w, &s);
    assert_true(isnan(c.energy) && isnan(c.jacobi) && isnan(c.axial_momentum));
    assert_true(isnan(skf_flight_get_report(f).energy_drift));
    skf_flight_free(f);
  }
  skf_world_free(w);
  return taken;
}

static void drag_decays(void **state) {
  (void)state;
  const double k = 0.7, t = 3, u = 2;
  skf_state start = {0, {1, 2, 3}, {0, u, 0}}, want = {t, {1, 2 - u / k * expm1(-k * t), 3}, {0, u * exp(-k * t), 0}};
  skf_force f = {.type = SKF_FORCE_DRAG, .k = k, .body = SKF_FORCE_AT_REST};
  assert_int_equal(check_all(world_with(f, 0), start, t, want, 1e-12), 2);
  f.type = SKF_FORCE_DRAG_SQUARED;
  want.position.y = 2 + log1p(k * u * t) / k, want.velocity.y = u / (1 + k * u * t);
  assert_int_equal(check_all(world_with(f, 0), start, t, want, 1e-11), 2);
}

/* A medium that turns, z'' = -k (z' - i omega z) in the complex plane. */
static void turning_media_carry(void **state) {
  (void)state;
  const double k = 0.7, omega = 0.4, t = 5;
  double complex root = csqrt(k * k / 4 + I * k * omega), a = -k / 2 + root, b = -k / 2 - root;
  double complex z0 = 1, v0 = I, A = (v0 - b * z0) / (a - b), B = z0 - A;
  double complex z = A * cexp(a * t) + B * cexp(b * t), v = a * A * cexp(a * t) + b * B * cexp(b * t);
  skf_force f = {.type = SKF_FORCE_DRAG, .k = k, .body = 0};
  skf_state want = {t, {creal(z), cimag(z), 0}, {creal(v), cimag(v), 0}};
  assert_int_equal(check_all(world_with(f, omega), (skf_state){0, {1, 0, 0}, {0, 1, 0}}, t, want, 1e-11), 2);
}

/* Straight up through an atmosphere: dv/dx = -k v exp(-(x - R) / H). */
static void atmospheres_thin_out(void **state) {
  (void)state;
  const double k = 2, H = 0.3, R = 1, x0 = 1.1, v0 = 1.5;
  skf_force f = {.type = SKF_FORCE_DRAG_SQUARED, .k = k, .body = SKF_FORCE_AT_REST, .scale_height = H, .radius = R};
  f.center = v3(0, 0, -4);
  skf_world *w = world_with(f, 0);
  for (size_t i = 0; i < 2; i++) {
    skf_flight *flight = fly(w, by(i), (skf_state){0, {0, 0, x0 - 4}, {0, 0, v0}});
    skf_state s = state_at(flight, 2, NULL, NULL);
    double x = s.position.z + 4, slowed = k * H * (exp(-(x0 - R) / H) - exp(-(x - R) / H));
    check_close(s.velocity.z, v0 * exp(-slowed), 1e-11);
    skf_flight_free(flight);
  }
  skf_world_free(w);
}

static void pushes_make_parabolas(void **state) {
  (void)state;
  const skf_vec3 a = {0.1, -0.2, 0.3};
  const double t = 4;
  skf_state start = {0, {1, 2, 3}, {1, 0, 0}},
            want = {t, v3_mad(v3(1 + t, 2, 3), t * t / 2, a), v3_mad(v3(1, 0, 0), t, a)};
  size_t taken = check_all(world_with((skf_force){.type = SKF_FORCE_PUSH, .push = a}, 0), start, t, want, 1e-13);
  assert_int_equal(taken, skf_integrator_count() - 1); /* hermite4 does not */
}

static void spring(const void *user, double t, skf_vec3 p, skf_vec3 v, skf_vec3 *a) {
  (void)t, (void)v;
  *a = v3_scale(-*(const double *)user, p);
}

static void swing(const void *user, double t, skf_vec3 p, skf_vec3 v, skf_vec3 *a) {
  (void)p, (void)v;
  *a = v3(0, 0, cos(*(const double *)user * t));
}

static void magnet(const void *user, double t, skf_vec3 p, skf_vec3 v, skf_vec3 *a) {
  (void)t, (void)p;
  *a = v3_scale(*(const double *)user, v3(v.y, -v.x, 0));
}

static void callbacks_are_called(void **state) {
  (void)state;
  static const double one = 1, two = 2;
  skf_force f = {.type = SKF_FORCE_USER, .eval = spring, .user = &one};
  skf_state start = {0, {1, 0, 0}, {0, 0.5, 0}};
  skf_state want = {5, {cos(5), 0.5 * sin(5), 0}, {-sin(5), 0.5 * cos(5), 0}};
  assert_int_equal(check_all(world_with(f, 0), start, 5, want, 2e-10), skf_integrator_count() - 1);
  f.eval = swing, f.user = &two;
  want = (skf_state){5, {1, 2.5, (1 - cos(10)) / 4}, {0, 0.5, sin(10) / 2}};
  assert_int_equal(check_all(world_with(f, 0), start, 5, want, 1e-10), skf_integrator_count() - 1);
  f = (skf_force){.type = SKF_FORCE_USER, .eval = magnet, .user = &two, .velocity = true};
  want = (skf_state){5, {1 + (1 - cos(10)) / 4, sin(10) / 4, 0}, {sin(10) / 2, cos(10) / 2, 0}};
  assert_int_equal(check_all(world_with(f, 0), start, 5, want, 1e-11), 2);
}

static skf_status keep(void *user, double t, const skf_state *states) {
  (void)t;
  memcpy(user, states, 40 * sizeof *states);
  return SKF_OK;
}

/* Many at once, each as alone. */
static void many_feel_what_one_feels(void **state) {
  (void)state;
  static const double one = 1;
  skf_force f[2] = {{.type = SKF_FORCE_USER, .eval = spring, .user = &one},
                    {.type = SKF_FORCE_PUSH, .push = {0.1, 0, 0}}};
  skf_attractor body = {nothing_field, 1e3, 0.3, {{0, 0, 1}, {0, 0, 0}, 0}};
  skf_world *w;
  skf_state start[40], end[40];
  assert_int_equal(skf_world_new_with(&body, 1, f, 2, &w), SKF_OK);
  for (int i = 0; i < 40; i++) start[i] = (skf_state){0, {1 + 0.1 * i, 0, 0}, {0, 1, 0.1}};
  skf_flight_options o = {.integrator = "rkn12"};
  skf_run run = {40, start, 9, 0, o};
  assert_int_equal(skf_run_all(w, &run, &(skf_run_sink){.row = keep, .user = end}, NULL, NULL, NULL), SKF_OK);
  for (int i = 0; i < 40; i++) {
    skf_flight *alone = fly(w, o, start[i]);
    skf_state s = state_at(alone, 9, NULL, NULL);
    assert_memory_equal(&s, end + i, sizeof s);
    skf_flight_free(alone);
  }
  skf_world_free(w);
}

static void bad_forces_are_refused(void **state) {
  (void)state;
  const struct {
    skf_force force;
    skf_status status;
  } cases[] = {
      {{.type = SKF_FORCE_DRAG, .k = -1, .body = SKF_FORCE_AT_REST}, SKF_ERR_RANGE},
      {{.type = SKF_FORCE_DRAG, .k = NAN, .body = SKF_FORCE_AT_REST}, SKF_ERR_RANGE},
      {{.type = SKF_FORCE_DRAG, .k = 1, .body = 1}, SKF_ERR_ARG},
      {{.type = SKF_FORCE_DRAG_SQUARED, .k = 1, .scale_height = -1}, SKF_ERR_RANGE},
      {{.type = SKF_FORCE_PUSH, .push = {INFINITY, 0, 0}}, SKF_ERR_RANGE},
      {{.type = SKF_FORCE_USER}, SKF_ERR_ARG},
      {{.type = (skf_force_type)77}, SKF_ERR_ARG},
  };
  skf_attractor body = {nothing_field, 1e3, 1, {{0, 0, 1}, {0, 0, 0}, 0}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    skf_world *w;
    assert_int_equal(skf_world_new_with(&body, 1, &cases[i].force, 1, &w), cases[i].status);
    assert_null(w);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(drag_decays),
      cmocka_unit_test(turning_media_carry),
      cmocka_unit_test(atmospheres_thin_out),
      cmocka_unit_test(pushes_make_parabolas),
      cmocka_unit_test(callbacks_are_called),
      cmocka_unit_test(many_feel_what_one_feels),
      cmocka_unit_test(bad_forces_are_refused),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
