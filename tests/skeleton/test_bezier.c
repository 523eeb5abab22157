/* SPDX-License-Identifier: MIT */
/* Bezier curves as chains of arcs: near the curve, as long as it, joined, whatever the scale. */
#include "check.h"
#include "random.h"
#include "skelfield/skeleton.h"

enum { MOST = 20000 };
static skf_primitive pieces[MOST];

static skf_vec3 point_of(const skf_vec3 q[4], double t) {
  double u = 1 - t;
  skf_vec3 a = v3_add(v3_scale(u * u * u, q[0]), v3_scale(3 * u * u * t, q[1]));
  return v3_add(a, v3_add(v3_scale(3 * u * t * t, q[2]), v3_scale(t * t * t, q[3])));
}

static double hull(const skf_vec3 q[4]) { return v3_dist(q[0], q[1]) + v3_dist(q[1], q[2]) + v3_dist(q[2], q[3]); }

/* The length by Simpson's rule on |B'|. */
static double length_of(const skf_vec3 q[4]) {
  enum { N = 4000 };
  double sum = 0;
  for (int i = 0; i <= N; i++) {
    double t = (double)i / N, u = 1 - t;
    skf_vec3 d = v3_add(v3_scale(u * u, v3_sub(q[1], q[0])), v3_scale(2 * u * t, v3_sub(q[2], q[1])));
    d = v3_add(d, v3_scale(t * t, v3_sub(q[3], q[2])));
    sum += v3_norm(d) * (i == 0 || i == N ? 1 : i % 2 ? 4 : 2);
  }
  return sum / N;
}

static size_t cut(const char *name, const skf_vec3 q[4], double tolerance) {
  size_t n, again;
  if (skf_bezier_cut(q, tolerance, NULL, 0, &n)) fail_msg("%s is refused", name);
  assert_in_range(n, 1, MOST);
  assert_int_equal(skf_bezier_cut(q, tolerance, pieces, n - 1, &again), SKF_ERR_CAPACITY);
  assert_int_equal(again, n);
  assert_int_equal(skf_bezier_cut(q, tolerance, pieces, MOST, &again), SKF_OK);
  assert_int_equal(again, n);
  return n;
}

/* Curve and pieces lie within the tolerance of each other, and the pieces join from end to end. */
static size_t check_curve(const char *name, const skf_vec3 q[4], double tolerance) {
  size_t n = cut(name, q, tolerance);
  double worst = 0, size = hull(q);
  if (tolerance == 0) tolerance = SKF_BEZIER_TOLERANCE * size;
  for (int k = 0; k <= 1000; k++) {
    double best = INFINITY;
    for (size_t i = 0; i < n; i++) best = fmin(best, skf_primitive_distance(pieces + i, point_of(q, k / 1000.0)));
    worst = fmax(worst, best);
  }
  if (!(worst <= tolerance)) fail_msg("%s: the curve is %g from its pieces, allowed %g", name, worst, tolerance);
  skf_vec3 end = q[0];
  for (size_t i = 0; i < n; i++) {
    assert_int_equal(skf_primitive_check(pieces + i, NULL), SKF_OK);
    check_scaled(v3_dist(end, skf_primitive_point(pieces + i, 0, 0)), 0, tolerance + 1e-13 * size, 0.01);
    end = skf_primitive_point(pieces + i, 1, 0);
  }
  check_scaled(v3_dist(end, q[3]), 0, tolerance + 1e-13 * size, 0.01);
  return n;
}

static double length_of_pieces(size_t n) {
  double sum = 0;
  for (size_t i = 0; i < n; i++) sum += skf_primitive_measure(pieces + i);
  return sum;
}

/* The middles of the pieces are on the curve: their distance to 20000 points of it. */
static void check_back(const char *name, const skf_vec3 q[4], size_t n, double tolerance) {
  enum { N = 20000 };
  for (size_t i = 0; i < n; i++) {
    skf_vec3 x = skf_primitive_point(pieces + i, 0.5, 0);
    double best = INFINITY, step = 0;
    for (int k = 0; k < N; k++) {
      skf_primitive s = {.shape = SKF_SEGMENT,
                         .segment = {point_of(q, (double)k / N), point_of(q, (double)(k + 1) / N)}};
      best = fmin(best, skf_primitive_distance(&s, x));
      step = fmax(step, skf_primitive_measure(&s));
    }
    if (!(best <= tolerance + step * step)) fail_msg("%s: piece %zu is %g from the curve", name, i, best);
  }
}

static void random_curves(void **state) {
  (void)state;
  uint64_t seed = 21;
  for (int round = 0; round < 60; round++) {
    skf_vec3 q[4];
    for (int k = 0; k < 4; k++) q[k] = rnd_vec(&seed, 1);
    size_t n = check_curve("a random curve", q, 0);
    check_scaled(length_of_pieces(n), length_of(q), hull(q), 3e-6);
    if (round < 3) check_back("a random curve", q, n, 1e-6 * hull(q));
    check_curve("loosely", q, 0.01 * hull(q));
    for (int up = 0; up < 2; up++) { /* scaled and turned about the origin: as many pieces */
      double scale = up ? 0x1p24 : 0x1p-24;
      skf_vec3 s[4];
      for (int k = 0; k < 4; k++) s[k] = v3_scale(scale, v3(q[k].y, q[k].z, q[k].x));
      assert_int_equal(check_curve("scaled", s, 0), n);
    }
  }
}

static void special_curves(void **state) {
  (void)state;
  static const struct {
    const char *name;
    skf_vec3 q[4];
  } all[] = {
      {"a cusp", {{0, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}}},
      {"a cusp off the middle", {{0, 0, 0}, {1, 1, 0}, {-0.2, 1, 0}, {1.3, 0.1, 0}}},
      {"a loop", {{0, 0, 0}, {3, 2, 0}, {-2, 2, 0}, {1, 0, 0}}},
      {"a closed curve", {{0, 0, 0}, {1, 1, 0.3}, {-1, 1, 0}, {0, 0, 0}}},
      {"an S", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}},
      {"no first handle", {{0, 0, 0}, {0, 0, 0}, {1, 1, 0}, {2, 0, 1}}},
      {"no handles", {{1, 2, 3}, {1, 2, 3}, {2, 0, 1}, {2, 0, 1}}},
      {"three equal points", {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {2, 0, 1}}},
      {"there and back", {{0, 0, 0}, {3, 0, 0}, {-2, 0, 0}, {1, 0, 0}}},
      {"far away", {{1e6, 0, 0}, {1e6 + 1, 1, 0}, {1e6 + 2, 0, 1}, {1e6 + 3, 0, 0}}},
      {"almost straight", {{0, 0, 0}, {1, 1e-5, 0}, {2, 0, 1e-5}, {3, 0, 0}}},
  };
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
    size_t n = check_curve(all[i].name, all[i].q, 0);
    check_scaled(length_of_pieces(n), length_of(all[i].q), hull(all[i].q), 1e-5);
    check_curve(all[i].name, all[i].q, 0.1 * hull(all[i].q));
  }
}

static void straight_curves_are_segments(void **state) {
  (void)state;
  const skf_vec3 q[4] = {{0, 0, 0}, {1, 2, 3}, {2, 4, 6}, {3, 6, 9}};
  assert_int_equal(cut("straight", q, 0), 1);
  assert_int_equal(pieces[0].shape, SKF_SEGMENT);
  check_close(skf_primitive_measure(pieces), sqrt(126), 1e-15);
}

/* Third order: a thousandth of the tolerance takes ten times the pieces. */
static void order(void **state) {
  (void)state;
  const skf_vec3 q[4] = {{0, 0, 0}, {1, 2, 0}, {3, 1, 2}, {2, 0, 1}};
  size_t coarse = cut("coarse", q, 1e-5), fine = cut("fine", q, 1e-8);
  assert_in_range(coarse, 20, 120);
  assert_in_range(fine, 7 * coarse, 14 * coarse);
  check_curve("fine", q, 1e-8);
  for (size_t i = 0; i < fine; i++) assert_int_equal(pieces[i].shape, SKF_ARC);
  check_close(length_of_pieces(fine), length_of(q), 1e-9);
}

static void refused(void **state) {
  (void)state;
  const skf_vec3 one[4] = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}}, bad[4] = {{NAN, 0, 0}};
  const skf_vec3 good[4] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}};
  size_t n = 7;
  assert_int_equal(skf_bezier_cut(one, 0, pieces, MOST, &n), SKF_ERR_DEGENERATE);
  assert_int_equal(n, 0);
  assert_int_equal(skf_bezier_cut(bad, 0, pieces, MOST, &n), SKF_ERR_RANGE);
  assert_int_equal(skf_bezier_cut(good, 1e-11, pieces, MOST, &n), SKF_ERR_RANGE);
  assert_int_equal(skf_bezier_cut(good, 1, pieces, MOST, &n), SKF_ERR_RANGE);
  assert_int_equal(skf_bezier_cut(good, -1, pieces, MOST, &n), SKF_ERR_RANGE);
  assert_int_equal(skf_bezier_cut(good, NAN, pieces, MOST, &n), SKF_ERR_RANGE);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(random_curves), cmocka_unit_test(special_curves), cmocka_unit_test(straight_curves_are_segments),
      cmocka_unit_test(order),         cmocka_unit_test(refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
