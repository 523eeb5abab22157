/* SPDX-License-Identifier: MIT */
/* Collisions of two isosurfaces: against spheres in closed form, and against brute force. */
#include "motion/worlds.h"
#include "random.h"
#include "skelfield/rigid.h"

static const skf_vec3 zero = {0, 0, 0};

typedef struct solid {
  skf_field *field;
  skf_collider *is;
} solid;

static solid solid_of(const skf_element *e, size_t n, double iso) {
  solid s = {field_of(e, n), NULL};
  assert_int_equal(skf_collider_new(s.field, iso, &s.is), SKF_OK);
  return s;
}

static void drop(solid s) {
  skf_collider_free(s.is);
  skf_field_free(s.field);
}

static solid sphere(double R) {
  skf_element e = point_at(0, 0, 0, newton);
  return solid_of(&e, 1, 1 / R);
}

static solid torus(double radius, double iso) {
  skf_element e = ring_of(radius, newton, 1);
  return solid_of(&e, 1, iso);
}

static skf_pose pose_at(skf_vec3 p, skf_vec3 turn) {
  double angle = v3_norm(turn), s = angle > 0 ? sin(0.5 * angle) / angle : 0;
  return (skf_pose){p, {cos(0.5 * angle), s * turn.x, s * turn.y, s * turn.z}};
}

static skf_rigid_motion moving(skf_pose p, skf_vec3 v, skf_vec3 spin) {
  return (skf_rigid_motion){0, p, v, zero, spin};
}

static skf_meet meet(const solid *a, skf_pose pa, const solid *b, skf_pose pb) {
  skf_meet m;
  assert_int_equal(skf_collide(a->is, &pa, b->is, &pb, &m), SKF_OK);
  return m;
}

/* Two spheres at a distance of their radii plus a gap of any sign, far from the origin or not, turned or not. */
static void spheres_at_rest(void **state) {
  (void)state;
  uint64_t seed = 4;
  for (int k = -7; k <= 7; k += 7)
    for (int i = 0; i < 60; i++) {
      double L = pow(10, k), ra = L, rb = 0.3 * L, gap = (i % 2 ? -1 : 1) * pow(10, -(i % 13)) * 0.2;
      solid a = sphere(ra), b = sphere(rb);
      skf_vec3 n = rnd_unit(&seed), at = v3_scale(L, rnd_vec(&seed, 2));
      skf_pose pa = pose_at(at, rnd_vec(&seed, 2)), pb = pose_at(v3_mad(at, ra + rb + gap * L, n), rnd_vec(&seed, 2));
      skf_meet m = meet(&a, pa, &b, pb), w = meet(&b, pb, &a, pa);
      assert_int_equal(m.meeting, gap > 0 ? SKF_MEETING_APART : SKF_MEETING_OVERLAP);
      assert_int_equal(w.meeting, m.meeting);
      assert_in_range(m.cells, 1, 10000);
      if (gap < 0) {
        check_scaled(v3_dist(m.normal, n), 0, 1, 1e-6);
        check_scaled(v3_dist(w.normal, v3_scale(-1, n)), 0, 1, 1e-6);
        check_scaled(m.depth, -gap * L, L, 2 * gap * gap + 1e-13 + (gap < -0.05 ? 0.2 : 0));
        assert_true(v3_dist(m.at, pa.position) <= ra * (1 + 1e-15));
        assert_true(v3_dist(m.at, pb.position) <= rb * (1 + 1e-15));
      }
      drop(a), drop(b);
    }
}

/* |x + v t| = r_a + r_b at the smaller root; past each other by gaps down to rounding. */
static void spheres_in_flight(void **state) {
  (void)state;
  uint64_t seed = 9;
  for (int k = -7; k <= 7; k += 7)
    for (int i = 0; i < 22; i++) {
      double L = pow(10, k), T = pow(10, -k / 2.0), R = 1.3 * L;
      solid a = sphere(L), b = sphere(0.3 * L);
      skf_vec3 n = rnd_unit(&seed), side = v3_perp(n), v = v3_scale(-L / T, n);
      double off = i < 12 ? rnd(&seed, 0, 0.99) : 1 + (i % 2 ? -1 : 1) * pow(10, -2 - i % 10);
      skf_vec3 x = v3_mad(v3_scale(4 * L, n), off * R, side);
      skf_rigid_motion ma = moving(pose_at(zero, rnd_vec(&seed, 1)), v3_scale(0.3, v),
                                   v3_scale(1 / T, rnd_vec(&seed, 1))),
                       mb = moving(pose_at(x, zero), v3_scale(1.3, v), v3_scale(1 / T, rnd_vec(&seed, 1)));
      skf_meet m;
      assert_int_equal(skf_collide_first(a.is, &ma, b.is, &mb, 0, 10 * T, &m), SKF_OK);
      assert_int_equal(m.meeting, off < 1 ? SKF_MEETING_OVERLAP : SKF_MEETING_APART);
      assert_in_range(m.cells, 1, 4000000); /* most where spinning spheres graze */
      if (off < 1) {
        double want = (4 * L - R * sqrt((1 - off) * (1 + off))) / L * T;
        check_close(m.t, want, 1e-12 * fmax(1, 0.01 / (1 - off)));
        skf_vec3 pa = skf_rigid_at(&ma, m.t).position, pb = skf_rigid_at(&mb, m.t).position;
        check_scaled(v3_dist(m.normal, v3_unit(v3_sub(pb, pa))), 0, 1, 1e-7);
        check_close(v3_dist(m.at, pa), L, 1e-12);
      }
      drop(a), drop(b);
    }
}

/* A needle flies through a donut's hole, turning: free as long as the hole lets it; a bit aside it touches. */
static void needle_through_the_hole(void **state) {
  (void)state;
  skf_element bar = segment_of(v3(-0.5, 0, 0), v3(0.5, 0, 0), newton, 1);
  solid ring = torus(1, 7.38278), needle = solid_of(&bar, 1, 4);
  int hits = 0;
  for (int i = 0; i <= 20; i++) {
    double off = 0.05 * i;
    skf_rigid_motion a = moving(pose_at(zero, zero), zero, zero),
                     b = moving(pose_at(v3(off, 0, 3), v3(0, SKF_PI / 2, 0)), v3(0, 0, -1), v3(0, 0, 2));
    skf_meet m;
    assert_int_equal(skf_collide_first(ring.is, &a, needle.is, &b, 0, 6, &m), SKF_OK);
    hits += m.meeting == SKF_MEETING_OVERLAP;
    assert_true(m.meeting ==
                (hits ? SKF_MEETING_OVERLAP : SKF_MEETING_APART)); /* once it touches, it does farther out */
    for (int k = 0; k < 200 && m.meeting == SKF_MEETING_APART; k++) {
      double t = 6.0 * k / 200;
      skf_pose p = skf_rigid_at(&b, t), q = pose_at(zero, zero);
      assert_int_equal(meet(&ring, q, &needle, p).meeting, SKF_MEETING_APART);
    }
  }
  assert_in_range(hits, 5, 18);
  drop(ring), drop(needle);
}

/* A bar, which is a spheroid with the foci at its ends, turning above a plane: its lowest place is at sqrt(A^2 sin^2 +
   B^2 cos^2) below the middle. It begins flat and close, hardly approaching, or falls slowly while it spins, its ends
   passing the plane closer and closer; later touches must not hide the first one. */
static void bars_that_turn(void **state) {
  (void)state;
  skf_element flat = {{.shape = SKF_PLANE, .plane = {{0, 0, 0}, {0, 0, 1}}}, newton, 1};
  skf_element rod = segment_of(v3(-0.5, 0, 0), v3(0.5, 0, 0), newton, 1);
  solid ground = solid_of(&flat, 1, -TAU); /* |z| < 1 */
  for (int i = 0; i < 8; i++) {
    double iso = 3 + i / 2 % 2, A = 0.5 / tanh(0.5 * iso), B = 0.5 / sinh(0.5 * iso), end = i % 2 ? 5.1 : 10;
    double H = B + 1e-3, rate = asin(2 * sqrt((H - B) * (H + B))) / 5, fall = 0;
    if (i >= 4) H = A + 1e-3, rate = SKF_PI / 2, fall = 1e-3 / 5; /* upright at 1, 3, and 5, when it touches */
    solid bar = solid_of(&rod, 1, iso);
    skf_rigid_motion a = moving(pose_at(zero, zero), zero, zero),
                     b = moving(pose_at(v3(0.1, 0.2, 1 + H), zero), v3(0, 0, -fall), v3(0, rate, 0));
    skf_meet m;
    assert_int_equal(skf_collide_first(ground.is, &a, bar.is, &b, 0, end, &m), SKF_OK);
    assert_int_equal(m.meeting, SKF_MEETING_OVERLAP);
    check_close(m.t, 5, i >= 4 ? 3e-10 : 1e-11); /* rounding of places over the speed of approach */
    drop(bar);
  }
  drop(ground);
}

/* Whether some place of a grid over a is inside both. */
static bool grid_says(const solid *a, skf_pose pa, double iso_a, const solid *b, skf_pose pb, double iso_b, double size,
                      int n) {
  for (int i = 0; i < n * n * n; i++) {
    skf_vec3 p = v3(-size + 2 * size * (i % n + 0.5) / n, -size + 2 * size * (i / n % n + 0.5) / n,
                    -size + 2 * size * (i / n / n + 0.5) / n);
    if (skf_field_at(a->field, p, NULL) < iso_a) continue;
    if (skf_field_at(b->field, skf_pose_inverse(&pb, skf_pose_point(&pa, p)), NULL) > iso_b) return true;
  }
  return false;
}

/* Random pairs of rings and crosses, linked, through each other or apart: no grid finds what is certified apart, each
   witness is one, and the time of a first contact has the pair apart before and overlapping after. */
static void brute_force_agrees(void **state) {
  (void)state;
  skf_element bars[2] = {segment_of(v3(-1, 0, 0), v3(1, 0, 0), (skf_kernel){SKF_CAUCHY, 6}, 1),
                         segment_of(v3(0, -1, 0), v3(0, 1, 0), (skf_kernel){SKF_CAUCHY, 6}, 1)};
  solid ring = torus(1, 9), cross = solid_of(bars, 2, 0.1);
  uint64_t seed = 77;
  int apart = 0, overlap = 0, met = 0;
  for (int i = 0; i < 60; i++) {
    skf_pose pa = pose_at(rnd_vec(&seed, 1), rnd_vec(&seed, 3)), pb = pose_at(rnd_vec(&seed, 1.5), rnd_vec(&seed, 3));
    const solid *b = i % 2 ? &ring : &cross;
    double iso_b = i % 2 ? 9 : 0.1;
    skf_meet m = meet(&ring, pa, b, pb);
    bool grid = grid_says(&ring, pa, 9, b, pb, iso_b, 1.5, 40);
    if (grid) assert_int_equal(m.meeting, SKF_MEETING_OVERLAP);
    assert_int_not_equal(m.meeting, SKF_MEETING_UNDECIDED);
    if (m.meeting == SKF_MEETING_OVERLAP) {
      assert_true(skf_field_at(ring.field, skf_pose_inverse(&pa, m.at), NULL) >= 9 * (1 - 1e-14));
      assert_true(skf_field_at(b->field, skf_pose_inverse(&pb, m.at), NULL) >= iso_b * (1 - 1e-14));
      overlap++;
      continue;
    }
    apart++;
    skf_rigid_motion ma = moving(pa, rnd_vec(&seed, 1), rnd_vec(&seed, 1)),
                     mb = moving(pb, rnd_vec(&seed, 1), rnd_vec(&seed, 1));
    assert_int_equal(skf_collide_first(ring.is, &ma, b->is, &mb, 0, 2, &m), SKF_OK);
    assert_int_not_equal(m.meeting, SKF_MEETING_UNDECIDED);
    double end = m.meeting == SKF_MEETING_OVERLAP ? m.t : 2;
    for (int k = 0; k < 60; k++) {
      double t = end * (k + 0.999) / 60;
      assert_int_equal(meet(&ring, skf_rigid_at(&ma, t), b, skf_rigid_at(&mb, t)).meeting, SKF_MEETING_APART);
    }
    if (m.meeting != SKF_MEETING_OVERLAP) continue;
    met++;
    double d = 1e-5;
    assert_int_equal(meet(&ring, skf_rigid_at(&ma, m.t + d), b, skf_rigid_at(&mb, m.t + d)).meeting,
                     SKF_MEETING_OVERLAP);
    skf_pose qa = skf_rigid_at(&ma, m.t), qb = skf_rigid_at(&mb, m.t);
    check_close(skf_field_at(ring.field, skf_pose_inverse(&qa, m.at), NULL), 9, 1e-12);
    check_close(skf_field_at(b->field, skf_pose_inverse(&qb, m.at), NULL), iso_b, 1e-12);
  }
  assert_true(apart >= 10 && overlap >= 10 && met >= 8);
  drop(ring), drop(cross);
}

/* On a plane, which has no bounds: a sphere that falls on it, and bad input. */
static void planes_and_refusals(void **state) {
  (void)state;
  skf_element e = {{.shape = SKF_PLANE, .plane = {{0, 0, 0}, {0, 0, 1}}}, newton, 1};
  solid ground = solid_of(&e, 1, -TAU), ball = sphere(0.5);
  skf_rigid_motion a = moving(pose_at(zero, zero), zero, zero),
                   b = moving(pose_at(v3(3, 4, 5), v3(1, 2, 3)), v3(1, 0, 0), v3(0, 3, 0));
  b.acceleration = v3(0, 0, -2);
  skf_meet m;
  assert_int_equal(skf_collide_first(ground.is, &a, ball.is, &b, 0, 9, &m), SKF_OK);
  assert_int_equal(m.meeting, SKF_MEETING_OVERLAP);
  check_close(m.t, sqrt(3.5), 1e-13);
  check_close(m.normal.z, 1, 1e-13);
  check_close(m.at.z, 1, 1e-13);
  check_close(m.at.x, 3 + sqrt(3.5), 1e-7);
  assert_int_equal(skf_collide_first(ground.is, &a, ground.is, &b, 0, 9, &m), SKF_ERR_UNSUPPORTED);
  assert_int_equal(skf_collide_first(ground.is, &a, ball.is, &b, 9, 0, &m), SKF_ERR_RANGE);
  b.velocity.x = NAN;
  assert_int_equal(skf_collide_first(ground.is, &a, ball.is, &b, 0, 9, &m), SKF_ERR_RANGE);
  skf_collider *none;
  assert_int_equal(skf_collider_new(ball.field, NAN, &none), SKF_ERR_ARG);
  drop(ground), drop(ball);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(spheres_at_rest),         cmocka_unit_test(spheres_in_flight),
      cmocka_unit_test(needle_through_the_hole), cmocka_unit_test(brute_force_agrees),
      cmocka_unit_test(planes_and_refusals),     cmocka_unit_test(bars_that_turn),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
