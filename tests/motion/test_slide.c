/* SPDX-License-Identifier: MIT */
/* Motion along surfaces, against closed forms. */
#include "motion/worlds.h"
#include "random.h"
#include <string.h>

#define G 9.81

static const skf_flight_options smooth = {.contact = SKF_CONTACT_BOUNCE};

static skf_flight_options rough(double friction) {
  return (skf_flight_options){.contact = SKF_CONTACT_BOUNCE, .friction = friction};
}

/* Bodies that do not pull, of one element each, under a weight down the z axis; G > 0. */
static skf_world *scene(const skf_element *e, size_t n, double iso, skf_spin spin, skf_field **fields) {
  skf_attractor bodies[3];
  skf_force weight = {.type = SKF_FORCE_PUSH, .push = {0, 0, -G}};
  skf_world *w;
  for (size_t i = 0; i < n; i++) {
    fields[i] = field_of(e + i, 1);
    bodies[i] = (skf_attractor){fields[i], iso, 0, spin};
  }
  assert_int_equal(skf_world_new_with(bodies, n, &weight, 1, &w), SKF_OK);
  return w;
}

static void drop_scene(skf_world *w, skf_field *const *fields, size_t n) {
  skf_world_free(w);
  for (size_t i = 0; i < n; i++) skf_field_free(fields[i]);
}

static double energy(const skf_state *s) { return 0.5 * v3_norm2(s->velocity) + G * s->position.z; }

/* Around a point mass, without friction: at all times on the ground and as fast as at first; no contact but the first.
   A planet is a small body, too. */
static void around_a_sphere_at_constant_speed(void **state) {
  (void)state;
  for (int k = -7; k <= 7; k += 7) {
    double L = pow(10, k), T = sqrt(L * L * L), v = 0.3 * L / T;
    skf_element e = point_at(0, 0, 0, newton);
    skf_field *field;
    skf_world *w = single(&e, 1, 1 / L, 1, still, &field);
    skf_flight *f = fly(w, smooth, (skf_state){0, {L, 0, 0}, {0, v, 0}});
    size_t n = 0;
    skf_contact c = {0};
    for (int i = 1; i <= 50; i++) {
      skf_state s = state_at(f, 2 * i * T, &n, &c);
      check_close(v3_norm(s.position), L, 1e-15);
      check_close(v3_norm(s.velocity), v, 1e-12);
      check_scaled(v3_dot(s.velocity, s.position), 0, L * v, 1e-15);
      double angle = v * (s.t - c.t) / L + atan2(c.position.y, c.position.x);
      check_scaled(remainder(atan2(s.position.y, s.position.x) - angle, TAU), 0, 1, 1e-11);
    }
    assert_int_equal(n, 1);
    assert_int_equal(c.outcome, SKF_OUTCOME_SLIDE);
    skf_flight_free(f);
    drop_world(w, field);
  }
}

/* From the top of a ball with speed v it takes off where cos = 2/3 + v^2 / (3 g R), and falls freely from there. */
static void off_a_ball_where_it_must(void **state) {
  (void)state;
  for (double v = 0.01; v < 3; v *= 3) {
    skf_element e = point_at(0, 0, 0, newton);
    skf_field *field;
    skf_world *w = scene(&e, 1, 1, still, &field);
    skf_flight *f = fly(w, smooth, (skf_state){0, {0, 0, 1}, {v, 0, 0}});
    size_t n = 0;
    skf_state s = state_at(f, 5, &n, NULL);
    double c = 2.0 / 3 + v * v / (3 * G), u = sqrt(c * G), sine = sqrt(1 - c * c);
    check_close(s.velocity.x, u * c, 1e-9);
    check_scaled(energy(&s), 0.5 * v * v + G, v3_norm2(s.velocity), 1e-12);
    double t = (-u * sine + sqrt(u * u * sine * sine + 2 * G * (c - s.position.z))) / G; /* of the fall */
    check_close(s.position.x, sine + u * c * t, 1e-8);
    assert_int_equal(n, 1);
    skf_flight_free(f);
    drop_scene(w, &field, 1);
  }
}

/* In a bowl, the inside of a sphere, it swings like a pendulum: T = 2 pi sqrt(R / g) / agm(1, cos(a / 2)). */
static void a_bowl_is_a_pendulum(void **state) {
  (void)state;
  skf_element e = point_at(0, 0, 0, newton);
  e.strength = -1;
  skf_field *field;
  skf_world *w = scene(&e, 1, -1, still, &field);
  for (double a = 0.01; a < 1.5; a *= 5) {
    double x = 1, y = cos(a / 2);
    for (int i = 0; i < 8; i++) {
      double m = 0.5 * (x + y);
      y = sqrt(x * y), x = m;
    }
    double period = TAU / sqrt(G) / x;
    skf_flight *f = fly(w, smooth, (skf_state){0, {sin(a), 0, -cos(a)}, {0, 0, 0}});
    size_t n = 0;
    for (int i = 1; i <= 20; i++) {
      skf_state s = state_at(f, i * period / 2, &n, NULL);
      check_scaled(s.position.x, sin(i % 2 ? -a : a), sin(a), 1e-10);
      check_close(v3_norm(s.position), 1, 1e-15);
      check_scaled(energy(&s), -G * cos(a), G * (1 - cos(a)), 1e-9);
    }
    assert_int_equal(n, 1);
    skf_flight_free(f);
  }
  drop_scene(w, &field, 1);
}

/* Up a slope, back down or not: by friction against its tangent. */
static void slopes_hold_or_do_not(void **state) {
  (void)state;
  const double tilt = 0.5, v = 3;
  skf_vec3 normal = {-sin(tilt), 0, cos(tilt)}, up = {cos(tilt), 0, sin(tilt)};
  skf_element e = {{.shape = SKF_PLANE, .plane = {{0, 0, 0}, normal}}, newton, 1};
  skf_field *field;
  skf_world *w = scene(&e, 1, -TAU, still, &field);
  for (int k = -1; k <= 1; k++) {
    double mu = tan(tilt) * (1 + 1e-9 * k), brake = G * (sin(tilt) + mu * cos(tilt)), stop = v / brake;
    skf_flight *f = fly(w, rough(mu), (skf_state){0, normal, v3_scale(v, up)});
    skf_contact c = {0};
    size_t n = 0;
    skf_state s = state_at(f, 20, &n, &c);
    double down = fmin(0, G * (mu * cos(tilt) - sin(tilt))), t = 20 - stop;
    check_scaled(v3_dot(s.position, up), 0.5 * v * stop + 0.5 * down * t * t, 1, 1e-12);
    check_scaled(v3_dot(s.velocity, up), down * t, 1, 1e-13);
    check_close(v3_dot(s.position, normal), 1, 2e-15);
    assert_int_equal(c.outcome, k < 0 ? SKF_OUTCOME_SLIDE : SKF_OUTCOME_REST);
    if (k >= 0) check_close(c.t, stop, 1e-12);
    skf_flight_free(f);
  }
  drop_scene(w, &field, 1);
}

/* On a floor that turns, friction drives a particle that was at rest outwards: against a Runge-Kutta integration. */
static skf_vec3 dragged(skf_vec3 x, skf_vec3 v, double mu, double omega) {
  skf_vec3 slip = v3(v.x + omega * x.y, v.y - omega * x.x, 0);
  return v3_scale(-mu * G / v3_norm(slip), slip);
}

static void a_turntable_drags(void **state) {
  (void)state;
  const double omega = 2, mu = 0.05, h = 1e-4;
  skf_element e = {{.shape = SKF_PLANE, .plane = {{0, 0, 0}, {0, 0, 1}}}, newton, 1};
  skf_field *field;
  skf_world *w = scene(&e, 1, -TAU, (skf_spin){{0, 0, 1}, {0, 0, 0}, omega}, &field);
  skf_flight *f = fly(w, rough(mu), (skf_state){0, {1, 0, 1}, {0, 0, 0}});
  skf_vec3 x = {1, 0, 1}, v = {0, 0, 0};
  for (int i = 0; i < 20000; i++) {
    skf_vec3 a1 = dragged(x, v, mu, omega), v2 = v3_mad(v, h / 2, a1), a2 = dragged(v3_mad(x, h / 2, v), v2, mu, omega);
    skf_vec3 v3_ = v3_mad(v, h / 2, a2), a3 = dragged(v3_mad(x, h / 2, v2), v3_, mu, omega);
    skf_vec3 v4 = v3_mad(v, h, a3), a4 = dragged(v3_mad(x, h, v3_), v4, mu, omega);
    x = v3_mad(x, h / 6, v3_add(v3_add(v, v4), v3_scale(2, v3_add(v2, v3_))));
    v = v3_mad(v, h / 6, v3_add(v3_add(a1, a4), v3_scale(2, v3_add(a2, a3))));
  }
  skf_state s = state_at(f, 2, NULL, NULL);
  check_scaled(v3_dist(s.position, x), 0, 1, 1e-11);
  check_scaled(v3_dist(s.velocity, v), 0, 1, 1e-11);
  skf_flight_free(f);
  drop_scene(w, &field, 1);
}

/* On a body that turns, without friction, the Jacobi constant is one; every row is on the ground and moves along it. */
static void turning_bodies_carry_no_energy(void **state) {
  (void)state;
  skf_element e = segment_of(v3(-1, 0, 0), v3(1, 0, 0), newton, 1);
  skf_field *field;
  skf_world *w = single(&e, 1, 1, 1, (skf_spin){{0, 0, 1}, {0.1, 0, 0}, 0.2}, &field);
  uint64_t seed = 5;
  for (int i = 0; i < 10; i++) {
    skf_contact c = {0};
    size_t n = 0, on = 0;
    skf_flight *f = fly(w, smooth, (skf_state){0, v3_scale(3, rnd_unit(&seed)), rnd_vec(&seed, 0.3)});
    double from, to = 0, jacobi = NAN;
    for (bool touched; to < 30;) {
      assert_int_equal(skf_flight_step(f, &c, &touched), SKF_OK);
      skf_flight_span(f, &from, &to);
      n += touched;
      if (n == 0 || c.outcome != SKF_OUTCOME_SLIDE || from <= c.t) continue;
      for (int k = 1; k <= 5; k++) {
        skf_state s;
        assert_int_equal(skf_flight_at(f, from + (to - from) * k / 5, &s), SKF_OK);
        double level = skf_world_level(w, 0, s.t, s.position);
        if (level < -1e-12) continue; /* it has taken off */
        skf_invariants is = skf_world_invariants(w, &s);
        if (isnan(jacobi) || touched) jacobi = is.jacobi;
        skf_state seen = skf_world_state_to_body(w, 0, &s);
        skf_vec3 g;
        skf_field_at(field, seen.position, &g);
        check_scaled(level, 0, 1, 1e-14);
        check_scaled(v3_dot(g, seen.velocity), 0, v3_norm(g), 1e-14);
        if (n == 1) check_scaled(is.jacobi, jacobi, is.scale, 1e-11);
        on++;
      }
    }
    assert_true(n > 0 && on > 10);
    skf_flight_free(f);
  }
  drop_world(w, field);
}

/* In the groove of two spheres, and in the corner of three, it comes to rest, or swings without friction along the
   groove, a circle about the line between them. */
static void grooves_and_corners(void **state) {
  (void)state;
  skf_element e[2] = {point_at(0.8, 0, 0, newton), point_at(-0.8, 0, 0, newton)}, pit[3];
  for (int i = 0; i < 3; i++) pit[i] = point_at(0.9 * cos(i * TAU / 3), 0.9 * sin(i * TAU / 3), 0, newton);
  skf_field *fields[3];
  skf_world *w = scene(e, 2, 1, still, fields);
  skf_flight *f = fly(w, rough(0.3), (skf_state){0, {0.1, 0.02, 2}, {0, 0.01, 0}});
  skf_contact c = {0};
  size_t n = 0;
  skf_state s = state_at(f, 20, &n, &c);
  assert_int_equal(c.outcome, SKF_OUTCOME_REST);
  check_scaled(s.position.x, 0, 1, 1e-14);
  check_close(hypot(s.position.y, s.position.z), 0.6, 1e-14);
  check_scaled(v3_norm(s.velocity), 0, 1, 0);
  skf_flight_free(f);
  f = fly(w, smooth, (skf_state){0, {0, 0.1, sqrt(0.36 - 0.01)}, {0, 0, 0}});
  n = 0;
  double E = G * sqrt(0.36 - 0.01);
  for (int i = 1; i <= 3; i++) { /* without friction, down the groove */
    s = state_at(f, 0.1 * i, &n, &c);
    check_scaled(s.position.x, 0, 1, 1e-14);
    check_close(hypot(s.position.y, s.position.z), 0.6, 1e-14);
    check_scaled(energy(&s), E, G, 1e-12);
  }
  skf_flight_free(f);
  drop_scene(w, fields, 2);
  w = scene(pit, 3, 1, still, fields);
  for (int k = 0; k < 4; k++) {
    f = fly(w, (skf_flight_options){.contact = SKF_CONTACT_BOUNCE, .restitution = 0.2 * k, .friction = 0.2},
            (skf_state){0, {0.02, 0.03, 0.6}, {0, 0.03, 0}});
    n = 0, s = state_at(f, 60, &n, &c);
    assert_int_equal(c.outcome, SKF_OUTCOME_REST);
    check_scaled(hypot(s.position.x, s.position.y), 0, 1, k == 0 ? 1e-14 : 0.3);
    for (size_t i = 0; i < 3; i++) assert_true(skf_world_level(w, i, 60, s.position) < 1e-13);
    skf_flight_free(f);
  }
  drop_scene(w, fields, 3);
}

/* Between a ball that turns and one that stands still friction holds it on the one that it meets last. */
static void between_grounds_that_move(void **state) {
  (void)state;
  const skf_element e[2] = {point_at(0.8, 0, 0, newton), point_at(-0.8, 0, 0, newton)};
  const skf_force weight = {.type = SKF_FORCE_PUSH, .push = {0, 0, -G}};
  const skf_spin turning = {{1, 0, 0}, {0.8, 0, 0}, 0.5};
  for (double v = -0.5; v < 0; v += 0.2) {
    skf_field *fields[2] = {field_of(e, 1), field_of(e + 1, 1)};
    const skf_attractor bodies[2] = {{fields[0], 1, 0, turning}, {fields[1], 1, 0, still}};
    skf_world *w;
    assert_int_equal(skf_world_new_with(bodies, 2, &weight, 1, &w), SKF_OK);
    skf_flight *f = fly(w, rough(0.3), (skf_state){0, {0.1, 0.02, 2}, {0, v, 0}});
    skf_contact c = {0};
    size_t n = 0;
    skf_state s = state_at(f, 20, &n, &c);
    assert_in_range(n, 1, 9);
    assert_int_equal(c.outcome, SKF_OUTCOME_REST);
    check_close(hypot(s.position.y, s.position.z), 0.6, 1e-13);
    skf_flight_free(f);
    drop_scene(w, fields, 2);
  }
}

/* A planet 6371 km large, a drop of 3 m: 3.84 m/s upwards, and so on until the ground's own rounding. */
static void bounces_may_be_small(void **state) {
  (void)state;
  double R = 6371000, gm = G * R * R, e = 0.5;
  skf_element point = point_at(0, 0, 0, newton);
  skf_field *field;
  skf_world *w = single(&point, 1, 1 / R, gm, still, &field);
  skf_flight *f = fly(w, (skf_flight_options){.contact = SKF_CONTACT_BOUNCE, .restitution = e},
                      (skf_state){0, {R + 3, 0, 0}, {0, 1, 0}});
  skf_contact c;
  bool touched = false;
  double T = sqrt(2 * 3 / G), when = T;
  for (int n = 0; n < 9; n++) {
    while (skf_flight_step(f, &c, &touched), !touched) {}
    assert_int_equal(c.outcome, SKF_OUTCOME_BOUNCE);
    check_close(c.t, when, 1e-6);
    check_close(c.after.x, sqrt(2 * 3 * G) * pow(e, n + 1), 1e-4);
    when += 2 * T * pow(e, n + 1);
  }
  size_t n = 0;
  skf_state s = state_at(f, 100, &n, &c);
  assert_int_equal(c.outcome, SKF_OUTCOME_SLIDE);
  assert_in_range(n, 1, 4);
  check_close(v3_norm(s.velocity), 1, 1e-4);
  check_close(v3_norm(s.position), R, 1e-15);
  skf_flight_free(f);
  drop_world(w, field);
}

typedef struct ends {
  skf_state *s;
  size_t contacts;
} ends;

static skf_status keep(void *user, double t, const skf_state *states) {
  (void)t;
  memcpy(((ends *)user)->s, states, 200 * sizeof *states);
  return SKF_OK;
}

static skf_status count(void *user, const skf_contact *c) {
  (void)c;
  return ((ends *)user)->contacts++, SKF_OK;
}

/* Particles side by side slide as each does alone: the same bits. */
static void side_by_side_as_alone(void **state) {
  (void)state;
  enum { N = 200 };
  skf_element e[2] = {point_at(0.8, 0, 0, newton), segment_of(v3(-1, -1, 0), v3(-1, 1, 0), newton, 0.4)};
  skf_field *fields[2];
  skf_world *w = scene(e, 2, 1, still, fields);
  skf_state start[N], end[N];
  uint64_t seed = 8;
  for (int i = 0; i < N; i++) start[i] = (skf_state){0, {rnd(&seed, -1.5, 1.5), rnd(&seed, -1, 1), 2}, {0, 0, 0}};
  skf_flight_options o = {.contact = SKF_CONTACT_BOUNCE, .restitution = 0.3, .friction = 0.1};
  skf_run run = {.start = start, .count = N, .t_end = 1.5, .every = 0.5, .flight = o};
  ends kept = {end, 0};
  assert_int_equal(
      skf_run_all(w, &run, &(skf_run_sink){.row = keep, .contact = count, .user = &kept}, NULL, NULL, NULL), SKF_OK);
  size_t n = 0;
  for (int i = 0; i < N; i++) {
    skf_flight *f = fly(w, o, start[i]);
    skf_state s = state_at(f, 1.5, &n, NULL);
    assert_memory_equal(&s, end + i, sizeof s);
    skf_flight_free(f);
  }
  assert_int_equal(n, kept.contacts);
  assert_true(n > N);
  drop_scene(w, fields, 2);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(around_a_sphere_at_constant_speed),
      cmocka_unit_test(off_a_ball_where_it_must),
      cmocka_unit_test(a_bowl_is_a_pendulum),
      cmocka_unit_test(slopes_hold_or_do_not),
      cmocka_unit_test(a_turntable_drags),
      cmocka_unit_test(turning_bodies_carry_no_energy),
      cmocka_unit_test(grooves_and_corners),
      cmocka_unit_test(between_grounds_that_move),
      cmocka_unit_test(bounces_may_be_small),
      cmocka_unit_test(side_by_side_as_alone),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
