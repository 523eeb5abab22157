/* SPDX-License-Identifier: MIT */
/* Rigid bodies: free rotation, mutual gravity, impacts; what must be conserved is. */
#include "motion/worlds.h"
#include "skelfield/rigid.h"

static const skf_vec3 zero = {0, 0, 0};

/* A body of the elements with a mass of its skeleton's; the field is the caller's to free. */
static skf_rigid_body body_of(const skf_element *e, size_t n, double iso, double density, skf_field **field) {
  skf_rigid_body b = {.iso = iso, .density = density, .start = {.q = {1, 0, 0, 0}}};
  b.field = *field = field_of(e, n);
  assert_int_equal(skf_mass_of(b.field, iso, 1e-6, &b.solid), SKF_OK);
  for (size_t i = 0; i < n; i++) b.mass += density * e[i].strength * skf_element_measure(e + i);
  b.start.position = b.solid.center;
  return b;
}

static skf_swarm *swarm_of(const skf_rigid_body *b, size_t n, skf_rigid_options o) {
  skf_swarm *s;
  assert_int_equal(skf_swarm_new(b, n, &o, &s), SKF_OK);
  return s;
}

static void run(skf_swarm *s, double t) { assert_int_equal(skf_swarm_run(s, t, NULL, NULL), SKF_OK); }

/* Torque-free, far from the principal axes: angular momentum to rounding, energy to 1e-12 over a hundred turns; the
   middle axis is unstable, and flips. */
static void free_rotation(void **state) {
  (void)state;
  const skf_kernel k = {SKF_CAUCHY, 3};
  skf_element e[2] = {segment_of(v3(-1, 0, 0), v3(1, 0, 0), k, 1), segment_of(v3(0, 0, 0), v3(0, 1.2, 0), k, 1)};
  skf_field *f;
  skf_rigid_body b = body_of(e, 2, 0.2, 1, &f);
  b.start.angular_velocity = v3(0.5, 0.8, 0.1);
  skf_swarm *s = swarm_of(&b, 1, (skf_rigid_options){.tolerance = 1e-13});
  skf_rigid_sums a = skf_swarm_sums(s);
  double least = INFINITY, most = -INFINITY;
  for (int i = 1; i <= 300; i++) {
    run(s, 2.0 * i);
    skf_rigid_sums now = skf_swarm_sums(s);
    check_scaled(v3_dist(now.angular_momentum, a.angular_momentum), 0, v3_norm(a.angular_momentum), 1e-14);
    check_close(now.kinetic, a.kinetic, 1e-12);
    skf_rigid_state at = skf_swarm_state(s, 0);
    check_scaled(v3_dist(at.position, b.start.position), 0, 1, 1e-14);
    least = fmin(least, at.angular_velocity.x), most = fmax(most, at.angular_velocity.x);
  }
  assert_true(most - least > 0.05);
  skf_swarm_free(s);
  skf_field_free(f);
}

/* Two bars of different kernels, turning, in each other's field: momentum and angular momentum to rounding, energy to
   the tolerance; two points: Kepler's orbit about their center of mass. */
static void mutual_gravity(void **state) {
  (void)state;
  skf_element a = segment_of(v3(-0.5, 0, 0), v3(0.5, 0, 0), newton, 1),
              c = segment_of(v3(0, -0.4, 0), v3(0, 0.4, 0), newton, 1);
  skf_field *f, *g;
  skf_rigid_body b[2] = {body_of(&a, 1, 5, 2, &f), body_of(&c, 1, 5, 1, &g)};
  b[0].start.position = v3(-1, 0, 0), b[1].start.position = v3(1.5, 0.2, 0.3);
  b[0].start.velocity = v3(0, -0.35, 0.05), b[1].start.velocity = v3(0, 0.75, 0.1);
  b[0].start.angular_velocity = v3(0.3, 0.2, 0.5), b[1].start.angular_velocity = v3(-0.3, 0.1, 0.2);
  skf_swarm *s = swarm_of(b, 2, (skf_rigid_options){.G = 1, .tolerance = 1e-12});
  skf_rigid_sums p = skf_swarm_sums(s);
  run(s, 10);
  skf_rigid_sums q = skf_swarm_sums(s);
  check_scaled(v3_dist(p.momentum, q.momentum), 0, 1, 1e-13);
  check_scaled(v3_dist(p.angular_momentum, q.angular_momentum), 0, v3_norm(p.angular_momentum), 1e-12);
  check_scaled(q.kinetic + q.potential, p.kinetic + p.potential, q.kinetic, 1e-11);
  assert_true(fabs(q.kinetic / p.kinetic - 1) > 1e-3); /* something happened */
  skf_swarm_free(s);
  skf_field_free(f), skf_field_free(g);

  skf_element point = point_at(0, 0, 0, newton);
  skf_rigid_body two[2] = {body_of(&point, 1, 50, 3, &f), body_of(&point, 1, 50, 1, &g)};
  two[0].start.position = v3(-0.25, 0, 0), two[1].start.position = v3(0.75, 0, 0);
  two[0].start.velocity = v3(0, -0.5, 0), two[1].start.velocity = v3(0, 1.5, 0); /* G M = 4, distance 1: a circle */
  s = swarm_of(two, 2, (skf_rigid_options){.G = 1, .tolerance = 1e-13});
  run(s, 10 * TAU / 2);
  check_scaled(v3_dist(skf_swarm_state(s, 1).position, v3(0.75, 0, 0)), 0, 1, 1e-9);
  skf_swarm_free(s);
  skf_field_free(f), skf_field_free(g);
}

typedef struct hits {
  int n;
  skf_rigid_hit last;
  double energy_taken; /* (1 - e^2) / 2 of the closing speed times the normal impulse over (1 + e) */
  double e;
} hits;

static skf_status note(void *user, const skf_rigid_hit *h) {
  hits *l = user;
  l->n++, l->last = *h;
  l->energy_taken += 0.5 * (1 - l->e) * h->closing * v3_dot(h->impulse, h->normal);
  return SKF_OK;
}

/* Two spheres head on and aside: the textbook's velocities. */
static void spheres_collide(void **state) {
  (void)state;
  skf_element e = point_at(0, 0, 0, newton);
  skf_field *f, *g;
  for (int k = 0; k < 3; k++) {
    double rest = 0.5 * k;
    skf_rigid_body b[2] = {body_of(&e, 1, 1, 1, &f), body_of(&e, 1, 2, 2, &g)}; /* radii 1 and 1/2, masses 1 and 2 */
    b[0].start.velocity = v3(1, 0, 0), b[1].start.position = v3(4, 0, 0), b[1].start.velocity = v3(-1, 0, 0);
    skf_swarm *s = swarm_of(b, 2, (skf_rigid_options){.restitution = rest});
    hits log = {.e = rest};
    skf_rigid_sums p = skf_swarm_sums(s);
    assert_int_equal(skf_swarm_run(s, 2, note, &log), SKF_OK);
    skf_rigid_sums q = skf_swarm_sums(s);
    assert_int_equal(log.n, 1);
    check_close(log.last.t, 1.25, 1e-8);
    check_close(log.last.closing, 2, 1e-12);
    double v = -1.0 / 3; /* of the center of mass */
    check_scaled(skf_swarm_state(s, 0).velocity.x, v - rest * 2 * 2 / 3.0, 1, 1e-7);
    check_scaled(skf_swarm_state(s, 1).velocity.x, v + rest * 2 / 3.0, 1, 1e-7);
    check_scaled(v3_dist(p.momentum, q.momentum), 0, 1, 1e-14);
    check_scaled(q.kinetic, p.kinetic - log.energy_taken, p.kinetic, 1e-12);
    skf_swarm_free(s);
    skf_field_free(f), skf_field_free(g);
  }
}

/* A ring and bars that fly at each other, turning, with and without friction: momenta to rounding, the energy lost is
   what restitution says; friction only ever takes more. */
static void odd_bodies_collide(void **state) {
  (void)state;
  skf_element ring = ring_of(1, newton, 1);
  skf_element bars[2] = {segment_of(v3(-1, 0, 0), v3(1, 0, 0), (skf_kernel){SKF_CAUCHY, 6}, 1),
                         segment_of(v3(0, -1, 0), v3(0, 1, 0), (skf_kernel){SKF_CAUCHY, 6}, 1)};
  skf_field *f, *g;
  skf_rigid_body b[2] = {body_of(&ring, 1, 9, 1, &f), body_of(bars, 2, 0.1, 1, &g)};
  b[0].start.velocity = v3(0.5, 0, 0), b[0].start.angular_velocity = v3(0.3, 0.7, 0.2);
  b[1].start.position = v3(3.5, 0.3, 0.2), b[1].start.velocity = v3(-0.7, 0, 0);
  b[1].start.angular_velocity = v3(0.2, -0.4, 0.6);
  for (int k = 0; k < 4; k++) {
    double rest = k % 2 ? 1 : 0.6, mu = k / 2 ? 0.4 : 0;
    skf_swarm *s = swarm_of(b, 2, (skf_rigid_options){.restitution = rest, .friction = mu});
    hits log = {.e = rest};
    skf_rigid_sums p = skf_swarm_sums(s);
    assert_int_equal(skf_swarm_run(s, 3.2, note, &log), SKF_OK);
    skf_rigid_sums q = skf_swarm_sums(s);
    assert_in_range(log.n, 1, 20);
    check_scaled(v3_dist(p.momentum, q.momentum), 0, 1, 1e-13);
    check_scaled(v3_dist(p.angular_momentum, q.angular_momentum), 0, v3_norm(p.angular_momentum), 1e-12);
    if (mu == 0) check_scaled(q.kinetic, p.kinetic - log.energy_taken, p.kinetic, 1e-11);
    assert_true(q.kinetic <= p.kinetic * (1 + 1e-11));
    skf_swarm_free(s);
  }
  skf_field_free(f), skf_field_free(g);
}

/* A ball on a plane that is fixed: bounce heights e^2n. */
static void a_ball_on_the_ground(void **state) {
  (void)state;
  skf_element plane = {{.shape = SKF_PLANE, .plane = {{0, 0, 0}, {0, 0, 1}}}, newton, 1}, e = point_at(0, 0, 0, newton);
  skf_field *f, *g;
  skf_rigid_body ball = body_of(&e, 1, 2, 1, &f), ground = {.iso = -TAU, .density = 1, .start = {.q = {1, 0, 0, 0}}};
  ground.field = g = field_of(&plane, 1);
  ball.start.position = v3(0, 0, 3.5); /* 2 above */
  skf_rigid_body b[2] = {ground, ball};
  skf_swarm *s = swarm_of(b, 2, (skf_rigid_options){.gravity = {0, 0, -1}, .restitution = 0.5});
  hits log = {.e = 0.5};
  assert_int_equal(skf_swarm_run(s, 2.5, note, &log), SKF_OK);
  assert_int_equal(log.n, 1);
  check_close(log.last.t, 2, 1e-7);
  check_close(log.last.closing, 2, 1e-7);
  assert_int_equal(skf_swarm_run(s, 4.2, note, &log), SKF_OK);
  assert_int_equal(log.n, 2);
  check_close(log.last.t, 4, 1e-7);
  check_close(log.last.closing, 1, 1e-7);
  skf_swarm_free(s);
  skf_field_free(f), skf_field_free(g);
}

/* From rest close above the ground, and far from the origin, where places are rounded by more than the gap of a hit:
   every bounce is one. */
static void balls_do_not_fall_through(void **state) {
  (void)state;
  skf_element plane = {{.shape = SKF_PLANE, .plane = {{0, 0, 0}, {0, 0, 1}}}, newton, 1}, e = point_at(0, 0, 0, newton);
  for (int k = 0; k < 4; k++) {
    skf_field *f, *g;
    double x = k % 2 ? 1e5 : 0, high = k < 2 ? 2 : 1e-4, T = sqrt(2 * high);
    skf_rigid_body ball = body_of(&e, 1, 2, 1, &f), ground = {.iso = -TAU, .density = 1, .start = {.q = {1, 0, 0, 0}}};
    ground.field = g = field_of(&plane, 1);
    ball.start.position = v3(x, 0, 1.5 + high);
    skf_swarm *s =
        swarm_of((skf_rigid_body[]){ground, ball}, 2, (skf_rigid_options){.gravity = {0, 0, -1}, .restitution = 1});
    hits log = {.e = 1};
    assert_int_equal(skf_swarm_run(s, 10 * T, note, &log), SKF_OK);
    assert_int_equal(log.n, 5);
    check_close(log.last.t, 9 * T, 1e-4);
    check_close(log.last.closing, T, 1e-4);
    skf_swarm_free(s);
    skf_field_free(f), skf_field_free(g);
  }
}

/* Two balls on Kepler's ellipse about each other, from apoapsis, one spinning: their periapsis is a bit
   less or more than the sum of their radii, by 1e-6 of it. */
static void grazing_passes(void **state) {
  (void)state;
  skf_element e = point_at(0, 0, 0, newton);
  for (int k = 0; k < 4; k++) {
    skf_field *f, *g;
    double q = 2 * (1 + (k % 2 ? 1e-6 : -1e-6)), Q = k < 2 ? 10 : 3, v = sqrt(2 * 4 * q / (Q * (Q + q))); /* G M = 4 */
    double half = 0.5 * TAU * sqrt(pow(0.5 * (Q + q), 3) / 4);
    skf_rigid_body b[2] = {body_of(&e, 1, 1, 3, &f), body_of(&e, 1, 1, 1, &g)};
    b[0].start.position.x = -Q / 4, b[1].start.position.x = 0.75 * Q;
    b[0].start.velocity.y = -v / 4, b[1].start.velocity.y = 0.75 * v;
    b[0].start.angular_velocity = v3(0.3, 0.1, 0.2);
    skf_swarm *s = swarm_of(b, 2, (skf_rigid_options){.G = 1, .restitution = 1});
    hits log = {.e = 1};
    assert_int_equal(skf_swarm_run(s, 1.5 * half, note, &log), SKF_OK);
    assert_int_equal(log.n, k % 2 == 0);
    if (log.n) check_close(log.last.t, half, 0.02);
    skf_swarm_free(s);
    skf_field_free(f), skf_field_free(g);
  }
}

/* Two that overlap and part do not hide what the others do. */
static void pairs_do_not_hide_pairs(void **state) {
  (void)state;
  skf_element e = point_at(0, 0, 0, newton);
  skf_field *f;
  skf_rigid_body ball = body_of(&e, 1, 1, 1, &f), b[4] = {ball, ball, ball, ball};
  b[0].start.velocity.x = -1e-3, b[1].start.velocity.x = 1e-3, b[1].start.position.x = 1.9;
  b[2].start.position.y = 100, b[3].start.position.y = 102.5, b[2].start.velocity.y = 1, b[3].start.velocity.y = -1;
  skf_swarm *s = swarm_of(b, 4, (skf_rigid_options){.restitution = 1});
  hits log = {.e = 1};
  assert_int_equal(skf_swarm_run(s, 10, note, &log), SKF_OK);
  assert_int_equal(log.n, 1);
  check_close(log.last.t, 0.25, 1e-7);
  skf_swarm_free(s);
  skf_field_free(f);
}

static void refusals(void **state) {
  (void)state;
  skf_element e = point_at(0, 0, 0, newton);
  skf_field *f;
  skf_rigid_body b = body_of(&e, 1, 1, 1, &f);
  skf_swarm *s;
  assert_int_equal(skf_swarm_new(&b, 1, &(skf_rigid_options){.restitution = 2}, &s), SKF_ERR_ARG);
  b.start.velocity.x = NAN;
  assert_int_equal(skf_swarm_new(&b, 1, &(skf_rigid_options){.tolerance = 0}, &s), SKF_ERR_RANGE);
  b.start.velocity = zero, b.solid.volume = 0;
  assert_int_equal(skf_swarm_new(&b, 1, &(skf_rigid_options){.tolerance = 0}, &s), SKF_ERR_ARG);
  skf_field_free(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(free_rotation),           cmocka_unit_test(mutual_gravity),
      cmocka_unit_test(spheres_collide),         cmocka_unit_test(odd_bodies_collide),
      cmocka_unit_test(a_ball_on_the_ground),    cmocka_unit_test(balls_do_not_fall_through),
      cmocka_unit_test(pairs_do_not_hide_pairs), cmocka_unit_test(refusals),
      cmocka_unit_test(grazing_passes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
