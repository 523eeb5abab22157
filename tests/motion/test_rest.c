/* SPDX-License-Identifier: MIT */
/* Rigid bodies that come to rest on each other, slide and roll: where they must, and never in each other. */
#include "motion/bytes.h"
#include "motion/worlds.h"
#include "skelfield/rigid.h"

/* A body above the plane z = 0, which is the lower half space's; the fields and colliders are the case's own. */
typedef struct scene {
  skf_field *field[2];
  skf_collider *hull[2];
  skf_rigid_body body[4]; /* the ground, and others of one kind */
  size_t n;
  skf_swarm *swarm;
  double energy, size;
} scene;

static void place(scene *s, const skf_element *e, size_t n, double iso) {
  const skf_element flat = {{.shape = SKF_PLANE, .plane = {{0, 0, -1}, {0, 0, 1}}}, newton, 1};
  s->field[0] = field_of(&flat, 1), s->field[1] = field_of(e, n);
  s->body[0] = (skf_rigid_body){.field = s->field[0], .iso = -TAU, .density = 1, .start = {.q = {1, 0, 0, 0}}};
  skf_rigid_body b = {.field = s->field[1], .iso = iso, .density = 1, .mass = 2, .start = {.q = {1, 0, 0, 0}}};
  assert_int_equal(skf_mass_of(b.field, iso, 1e-5, &b.solid), SKF_OK);
  for (int i = 1; i < 4; i++) s->body[i] = b;
  s->n = 2, s->energy = INFINITY;
  assert_int_equal(skf_collider_new(s->field[0], -TAU, &s->hull[0]), SKF_OK);
  assert_int_equal(skf_collider_new(s->field[1], iso, &s->hull[1]), SKF_OK);
}

static void tilt(skf_rigid_body *b, double x, double y, double angle) {
  double s = sin(0.5 * angle) / hypot(x, y);
  b->start.q[0] = cos(0.5 * angle), b->start.q[1] = s * x, b->start.q[2] = s * y;
}

static void begin(scene *s, skf_rigid_options o) {
  assert_int_equal(skf_swarm_new(s->body, s->n, &o, &s->swarm), SKF_OK);
}

static void end(scene *s) {
  skf_swarm_free(s->swarm);
  for (int i = 0; i < 2; i++) skf_collider_free(s->hull[i]), skf_field_free(s->field[i]);
}

static skf_pose pose_of(const scene *s, size_t i) {
  skf_rigid_state a = skf_swarm_state(s->swarm, i);
  skf_pose p = {{0, 0, 0}, {a.q[0], a.q[1], a.q[2], a.q[3]}};
  if (i) p.position = v3_sub(a.position, skf_pose_turn(&p, s->body[i].solid.center));
  return p;
}

/* Goes on to t: nothing overlaps there, and the energy has not grown by more than what holds a gap open. */
static void go(scene *s, double t) {
  assert_int_equal(skf_swarm_run(s->swarm, t, NULL, NULL), SKF_OK);
  for (size_t i = 0; i < s->n; i++)
    for (size_t j = i + 1; j < s->n; j++) {
      skf_pose a = pose_of(s, i), b = pose_of(s, j);
      skf_meet m;
      assert_int_equal(skf_collide(s->hull[i > 0], &a, s->hull[1], &b, &m), SKF_OK);
      assert_int_equal(m.meeting, SKF_MEETING_APART);
    }
  skf_rigid_sums sums = skf_swarm_sums(s->swarm);
  double energy = sums.kinetic + sums.potential;
  assert_true(energy <= s->energy + 1e-11);
  s->energy = energy;
}

/* At rest, and lower by 1e-7 it would overlap: that is the right height. */
static void check_rests(scene *s) {
  assert_true(skf_swarm_is_still(s->swarm));
  skf_pose a = pose_of(s, 0), b = pose_of(s, 1);
  b.position.z -= 1e-7;
  skf_meet m;
  assert_int_equal(skf_collide(s->hull[0], &a, s->hull[1], &b, &m), SKF_OK);
  assert_int_equal(m.meeting, SKF_MEETING_OVERLAP);
  double before = skf_swarm_state(s->swarm, 1).position.z;
  go(s, skf_swarm_time(s->swarm) + 1000);
  check_close(skf_swarm_state(s->swarm, 1).position.z, before, 0);
}

static const skf_vec3 down = {0, 0, -1};

static void a_ball_comes_to_rest(void **state) {
  (void)state;
  skf_element e = point_at(0, 0, 0, newton);
  for (int k = 0; k < 4; k++) {
    scene s = {.n = 0};
    place(&s, &e, 1, 2); /* radius 1/2 */
    s.body[1].start.position = v3(k == 3 ? 1e4 : 0.3, 0.2, 0.5 + 0.3 * k);
    begin(&s, (skf_rigid_options){.gravity = down, .restitution = 0.25 * k, .friction = 0.3, .rolling = 0.01});
    for (int i = 1; i <= 6; i++) go(&s, 3 * i);
    check_scaled(skf_swarm_state(s.swarm, 1).position.z, 0.5, 0.5, k == 3 ? 1e-6 : 2e-8);
    check_rests(&s);
    end(&s);
  }
}

/* A bar of two arms falls over and lies on both; a star of three blobs, from one tilt or another, on all of them. */
static void bars_and_stars_come_to_rest(void **state) {
  (void)state;
  const skf_kernel thin = {SKF_CAUCHY, 6}, round = {SKF_CAUCHY, 2};
  skf_element bar[2] = {segment_of(v3(0, 0, 0), v3(1, 0, 0), thin, 1),
                        segment_of(v3(0, 0, 0), v3(-0.3, 0.9, 0), thin, 1)};
  skf_element star[3] = {point_at(1, 0, 0, round), point_at(-0.5, 0.8660254037844386, 0, round),
                         point_at(-0.5, -0.8660254037844386, 0, round)};
  for (int k = 0; k < 3; k++) {
    scene s = {.n = 0};
    if (k == 0)
      place(&s, bar, 2, 0.1);
    else
      place(&s, star, 3, 0.1);
    s.body[1].start.position.z = 1.7;
    tilt(s.body + 1, 0.6, 0.8, k == 2 ? -0.9 : 0.4);
    begin(&s, (skf_rigid_options){.gravity = down, .restitution = 0.3, .friction = 0.4});
    for (int i = 1; i <= 8; i++) go(&s, i);
    check_rests(&s);
    skf_rigid_state at = skf_swarm_state(s.swarm, 1);
    skf_vec3 up = skf_pose_turn(&(skf_pose){{0, 0, 0}, {at.q[0], at.q[1], at.q[2], at.q[3]}}, v3(0, 0, 1));
    if (k) check_close(fabs(up.z), 1, 1e-12); /* on three equal feet */
    end(&s);
  }
}

/* The height at which a body touches the ground. */
static double touching(const scene *s) {
  double lo = 0, hi = 3;
  for (int i = 0; i < 60; i++) {
    double z = 0.5 * (lo + hi);
    skf_pose a = {{0, 0, 0}, {1, 0, 0, 0}}, b = {{0, 0, z}, {1, 0, 0, 0}};
    skf_meet m;
    assert_int_equal(skf_collide(s->hull[0], &a, s->hull[1], &b, &m), SKF_OK);
    *(m.meeting == SKF_MEETING_APART ? &hi : &lo) = z;
  }
  return hi;
}

/* On an incline whose slope is 1% more or less than the friction: Coulomb's threshold, and the way of what slides. */
static void blocks_on_an_incline(void **state) {
  (void)state;
  const skf_kernel round = {SKF_CAUCHY, 2};
  skf_element feet[4] = {point_at(1, 1, 0, round), point_at(-1, 1, 0, round), point_at(-1, -1, 0, round),
                         point_at(1, -1, 0, round)};
  for (int k = 0; k < 4; k++) {
    scene s = {.n = 0};
    double slope = k < 2 ? 0.5 : 0.1, a = (k % 2 ? 1.01 : 0.99) * slope, mu = tan(slope);
    place(&s, feet, 4, 0.2);
    s.body[1].start.position = s.body[1].solid.center;
    s.body[1].start.position.z += touching(&s) + 5e-9;
    begin(&s, (skf_rigid_options){.gravity = {sin(a), 0, -cos(a)}, .friction = mu});
    for (int i = 1; i <= 10; i++) go(&s, 0.5 * i);
    double way = skf_swarm_state(s.swarm, 1).position.x - s.body[1].start.position.x;
    if (k % 2)
      check_close(way, 0.5 * (sin(a) - mu * cos(a)) * 25, 2e-4); /* it is put down from a bit above */
    else
      check_scaled(way, 0, 1, 1e-8);
    assert_int_equal(skf_swarm_is_still(s.swarm), k % 2 == 0);
    end(&s);
  }
}

/* A ball on an incline rolls with 5/7 of the pull where friction is at least 2/7 of the slope, else it slips; and a
   rolling friction holds it up to its share. */
static void balls_on_an_incline(void **state) {
  (void)state;
  skf_element e = point_at(0, 0, 0, newton);
  const double a = 0.3, mu[4] = {0.1, 0.0885, 0.05, 0.4}, rolling[4] = {0, 0, 0, 0.5 * 0.310};
  for (int k = 0; k < 4; k++) {
    scene s = {.n = 0};
    place(&s, &e, 1, 2);
    s.body[1].start.position.z = 0.5;
    begin(&s, (skf_rigid_options){
                  .gravity = {sin(a), 0, -cos(a)}, .friction = mu[k], .rolling = rolling[k], .restitution = 0.5});
    for (int i = 1; i <= 4; i++) go(&s, i);
    skf_rigid_state at = skf_swarm_state(s.swarm, 1);
    double roll = 5.0 / 7 * sin(a), slip = sin(a) - mu[k] * cos(a), pull = mu[k] < 2.0 / 7 * tan(a) ? slip : roll;
    if (k == 3) pull = 0;
    check_scaled(at.velocity.x, 4 * pull, 1, 2e-6);
    check_scaled(at.position.x, 8 * pull, 1, 1e-5);
    if (pull == roll) check_scaled(at.angular_velocity.y * 0.5, at.velocity.x, 1, 1e-6);
    end(&s);
  }
}

static const skf_rigid_options pile_options = {
    .gravity = {0, 0, -1}, .restitution = 0.2, .friction = 0.5, .rolling = 0.1};

/* Three balls above each other, but not quite. */
static scene pile(void) {
  skf_element e = point_at(0, 0, 0, newton);
  scene s = {.n = 0};
  place(&s, &e, 1, 2);
  s.n = 4;
  for (int i = 1; i < 4; i++) s.body[i].start.position = v3(0.05 * i * i, 0.02 * i, 1.2 * i - 0.6);
  return s;
}

/* A pile of three balls that leans on nothing but itself falls apart; momentum about the vertical is not made, and all
   lie at last. */
static void a_pile_falls_apart(void **state) {
  (void)state;
  scene s = pile();
  begin(&s, pile_options);
  for (int i = 1; i <= 4; i++) go(&s, 4 * i);
  for (size_t i = 1; i < 4; i++) check_scaled(skf_swarm_state(s.swarm, i).position.z, 0.5, 0.5, 1e-7);
  assert_true(skf_swarm_is_still(s.swarm));
  end(&s);
}

/* Held up by two others in a trough of their own weight: pressed through a chain of contacts. */
static void a_column_stands(void **state) {
  (void)state;
  skf_element e = point_at(0, 0, 0, newton);
  scene s = {.n = 0};
  place(&s, &e, 1, 2);
  s.n = 4;
  for (int i = 1; i < 4; i++) s.body[i].start.position = v3(0, 0, 1.0 * i - 0.5 + 0.02 * i);
  begin(&s, (skf_rigid_options){.gravity = down, .restitution = 0.3, .friction = 0.5, .rolling = 0.02});
  for (int i = 1; i <= 6; i++) go(&s, i);
  for (size_t i = 1; i < 4; i++) check_scaled(skf_swarm_state(s.swarm, i).position.z, (double)i - 0.5, 0.5, 1e-7);
  assert_true(skf_swarm_is_still(s.swarm));
  end(&s);
}

/* Put down from a bit above, a ball rolls off as from the incline: what holds the gap open costs it no speed. */
static void a_gap_costs_no_speed(void **state) {
  (void)state;
  skf_element e = point_at(0, 0, 0, newton);
  const double a = 0.3;
  for (int k = 0; k < 3; k++) {
    scene s = {.n = 0};
    place(&s, &e, 1, 2);
    s.body[1].start.position.z = 0.5 + 1e-9 * (k + 1);
    begin(&s, (skf_rigid_options){.gravity = {sin(a), 0, -cos(a)}, .friction = 0.4});
    go(&s, 1);
    skf_rigid_state at = skf_swarm_state(s.swarm, 1);
    check_scaled(at.velocity.x + 0.2 * at.angular_velocity.y, sin(a), 1, 1e-7); /* 2/5 w r: whatever the friction */
    end(&s);
  }
}

/* Two balls meet in space, lean on each other by their gravity and roll: only forces between them act. */
static void a_pair_in_space_keeps_its_momenta(void **state) {
  (void)state;
  skf_element e = point_at(0, 0, 0, newton);
  for (int k = 0; k < 2; k++) {
    scene s = {.n = 0};
    place(&s, &e, 1, 1);
    s.body[1].mass = 1, s.body[2].mass = 1 + k;
    s.body[1].start.position = v3(-1.2, 0, 0), s.body[2].start.position = v3(1.2, 0.3, 0);
    s.body[1].start.velocity = v3(k, 0.1, 0), s.body[2].start.velocity = v3(k, -0.1, 0);
    s.body[1].start.angular_velocity = v3(0.1, 0.2, 1);
    const skf_rigid_options o = {.G = 1, .restitution = 0.3, .friction = 0.5};
    assert_int_equal(skf_swarm_new(s.body + 1, 2, &o, &s.swarm), SKF_OK);
    skf_rigid_sums p = skf_swarm_sums(s.swarm);
    assert_int_equal(skf_swarm_run(s.swarm, 6, NULL, NULL), SKF_OK);
    skf_rigid_sums q = skf_swarm_sums(s.swarm);
    double apart = v3_dist(skf_swarm_state(s.swarm, 0).position, skf_swarm_state(s.swarm, 1).position);
    check_scaled(apart, 2, 2, 1e-7);
    check_scaled(v3_dist(p.momentum, q.momentum), 0, 1, 1e-12);
    check_scaled(v3_dist(p.angular_momentum, q.angular_momentum), 0, 1, 1e-12);
    assert_true(q.kinetic + q.potential < p.kinetic + p.potential);
    end(&s);
  }
}

/* Saved and loaded anywhere between, before the first touch or after the last one, it ends in the same bits. */
static void a_pile_saved_goes_on(void **state) {
  (void)state;
  scene s = pile();
  begin(&s, pile_options);
  bytes last = {0}, t = {0};
  for (int i = 1; i <= 12; i++) {
    t.n = t.at = 0;
    assert_int_equal(skf_swarm_save(s.swarm, put, &t), SKF_OK);
    skf_swarm *again;
    assert_int_equal(skf_swarm_new(s.body, s.n, &pile_options, &again), SKF_OK);
    assert_int_equal(skf_swarm_load(again, get, &t), SKF_OK);
    assert_int_equal(skf_swarm_run(again, 0.4 * i, NULL, NULL), SKF_OK);
    assert_int_equal(skf_swarm_run(s.swarm, 0.4 * i, NULL, NULL), SKF_OK);
    last.n = 0, t.n = 0, t.at = 0;
    assert_int_equal(skf_swarm_save(s.swarm, put, &last), SKF_OK);
    assert_int_equal(skf_swarm_save(again, put, &t), SKF_OK);
    assert_int_equal(t.n, last.n);
    assert_memory_equal(t.data, last.data, t.n);
    skf_swarm_free(again);
  }
  skf_swarm *other;
  assert_int_equal(skf_swarm_new(s.body, s.n, &(skf_rigid_options){.gravity = down}, &other), SKF_OK);
  assert_int_equal(skf_swarm_load(other, get, &last), SKF_ERR_PARSE);
  skf_swarm_free(other);
  free(last.data), free(t.data);
  end(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_ball_comes_to_rest), cmocka_unit_test(bars_and_stars_come_to_rest),
      cmocka_unit_test(blocks_on_an_incline), cmocka_unit_test(balls_on_an_incline),
      cmocka_unit_test(a_pile_falls_apart),   cmocka_unit_test(a_column_stands),
      cmocka_unit_test(a_gap_costs_no_speed), cmocka_unit_test(a_pair_in_space_keeps_its_momenta),
      cmocka_unit_test(a_pile_saved_goes_on),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
