/* SPDX-License-Identifier: MIT */
/* Hard surfaces around primitives, against closed forms and against the distance to the primitives. */
#include "check.h"
#include "ray/offset.h"

/* Places on the ray where the nearest primitive is at its radius, by marching with the distance, which never oversteps.
 */
static double march(const skf_offset *items, size_t n, skf_vec3 o, skf_vec3 d, double far) {
  double t = 0;
  for (int k = 0; k < 4000 && t < far; k++) {
    skf_vec3 p = v3_mad(o, t, d);
    double near = INFINITY;
    for (size_t i = 0; i < n; i++) near = fmin(near, skf_primitive_distance(&items[i].primitive, p) - items[i].radius);
    if (near < 1e-11) return t;
    t += near;
  }
  return INFINITY;
}

static double least_gap(const skf_offset *items, size_t n, skf_vec3 p) {
  double near = INFINITY;
  for (size_t i = 0; i < n; i++) near = fmin(near, skf_primitive_distance(&items[i].primitive, p) - items[i].radius);
  return near;
}

static const skf_offset kinds[] = {
    {{.shape = SKF_POINT, .point = {{0.2, 0.1, 0}}}, 0.5},
    {{.shape = SKF_SEGMENT, .segment = {{-1, 0, 0.3}, {0.8, 0.4, 0}}}, 0.3},
    {{.shape = SKF_ARC, .arc = {{0, 0, 0}, {0, 1, 3}, {1, 0, 0}, 1, 4}}, 0.25},
    {{.shape = SKF_ARC, .arc = {{0, 0.2, 0}, {1, 1, 1}, {1, -1, 0}, 0.3, 2 * SKF_PI}}, 0.45}, /* a spindle: no hole */
    {{.shape = SKF_TRIANGLE, .triangle = {{{-1, -1, 0}, {1, -0.5, 0.3}, {0, 1, 0}}}}, 0.2},
    {{.shape = SKF_PLANE, .plane = {{0, 0, -1.5}, {0.1, 0.2, 1}}}, 0.1},
};
enum { KINDS = sizeof kinds / sizeof *kinds };

static void check_rays(const skf_offset *items, size_t n, double scale, int rays, unsigned seed) {
  skf_offsets *o;
  assert_int_equal(skf_offsets_new(items, n, &o), SKF_OK);
  unsigned long state = seed;
  int hits = 0;
  for (int k = 0; k < rays; k++) {
    double u[6];
    for (int i = 0; i < 6; i++)
      state = state * 6364136223846793005ul + 1442695040888963407ul, u[i] = (double)(state >> 33) / 2147483648.0 - 0.5;
    skf_vec3 from = v3_scale(8 * scale, v3(u[0], u[1], u[2] + 0.2)), to = v3_scale(2.5 * scale, v3(u[3], u[4], u[5]));
    if (least_gap(items, n, from) < 1e-3) continue;
    skf_ray ray = {from, v3_sub(to, from), 0, INFINITY};
    skf_hit hit;
    size_t item;
    skf_vec3 d = v3_unit(ray.direction);
    double want = march(items, n, from, d, 20 * scale);
    bool found = skf_offsets_first(o, &ray, &hit, &item);
    if (isinf(want) && found && hit.t < 20 * scale) { /* touched: the march may stop short of it for ever */
      assert_true(fabs(v3_dot(hit.normal, d)) < 1e-3);
      continue;
    }
    if (isinf(want)) continue;
    hits++;
    if (!found) { /* or it came very near */
      double gap = INFINITY;
      for (double t = want - 1e-3; t < want + 1e-3; t += 1e-6) gap = fmin(gap, least_gap(items, n, v3_mad(from, t, d)));
      assert_true(gap > -1e-9);
      continue;
    }
    double slope = fmax(-v3_dot(hit.normal, d), 1e-6);
    if (fabs(hit.t - want) * slope > 1e-8) fail_msg("ray %d: %.17g, marched %.17g", k, hit.t, want);
    assert_true(fabs(least_gap(items, n, hit.at)) < 1e-9 * scale);
    assert_true(v3_dot(hit.normal, d) < 0 && hit.entering);
    /* the normal leads away from the primitive */
    double h = 1e-4 * items[item].radius;
    double out = skf_primitive_distance(&items[item].primitive, v3_mad(hit.at, h, hit.normal)) - items[item].radius;
    check_close(out / h, 1.0, 1e-5);
    /* from the surface outwards nothing of a convex hull is met again; no ray meets its own start */
    skf_ray next = {hit.at, v3_sub(v3_scale(2 * v3_dot(hit.normal, d), hit.normal), d), 0, INFINITY};
    next.direction = v3_scale(-1, next.direction);
    if (n == 1 && items[0].primitive.shape != SKF_ARC)
      assert_false(skf_offsets_first(o, &next, &hit, NULL));
    else if (skf_offsets_first(o, &next, &hit, NULL))
      assert_true(hit.t > 1e-9 * scale);
  }
  assert_true(hits > rays / 50);
  skf_offsets_free(o);
}

static void each_kind(void **state) {
  (void)state;
  for (int k = 0; k < KINDS; k++) check_rays(kinds + k, 1, 1, 1500, (unsigned)k + 1);
}

static void unions(void **state) {
  (void)state;
  check_rays(kinds, KINDS, 1, 3000, 77);
  enum { N = 120 };
  skf_offset many[N];
  for (int i = 0; i < N; i++) {
    skf_vec3 a = v3(sin(i), cos(2.3 * i), sin(0.7 * i + 1)),
             b = v3(sin(i + 0.3), cos(2.3 * i + 0.4), sin(0.7 * i + 1.2));
    many[i] = (skf_offset){{.shape = SKF_SEGMENT, .segment = {a, b}}, 0.03 + 0.001 * (i % 7)};
  }
  check_rays(many, N, 1, 1500, 5);
}

static void capsule_in_numbers(void **state) {
  (void)state;
  const skf_offset item = {{.shape = SKF_SEGMENT, .segment = {{-1, 0, 0}, {1, 0, 0}}}, 0.25};
  for (double s = 1e-7; s < 1e8; s *= 1e7) {
    skf_offset i = item;
    i.primitive.segment = (skf_segment){{-s, 0, 0}, {s, 0, 0}}, i.radius = 0.25 * s;
    skf_offsets *o;
    assert_int_equal(skf_offsets_new(&i, 1, &o), SKF_OK);
    skf_hit hit;
    assert_true(skf_offsets_first(o, &(skf_ray){{0.3 * s, -5 * s, 0.15 * s}, {0, 2, 0}, 0, INFINITY}, &hit, NULL));
    check_close(hit.t, 4.8 * s, 1e-14);
    check_close(hit.normal.y, -0.8, 1e-13);
    assert_true(skf_offsets_first(o, &(skf_ray){{9 * s, 0, 0}, {-1, 0, 0}, 0, INFINITY}, &hit, NULL)); /* along it */
    check_close(hit.t, 7.75 * s, 1e-14);
    assert_true(skf_offsets_first(o, &(skf_ray){{0, 0, 0}, {1, 0, 0}, 0, INFINITY}, &hit, NULL)); /* from within */
    check_close(hit.t, 1.25 * s, 1e-14);
    assert_false(hit.entering);
    assert_false(skf_offsets_first(o, &(skf_ray){{0, 0.26 * s, 0}, {1, 0, 0}, 0, INFINITY}, &hit, NULL));
    assert_false(skf_offsets_first(o, &(skf_ray){{9 * s, 0, 0}, {-1, 0, 0}, 0, 7 * s}, &hit, NULL));
    skf_offsets_free(o);
  }
}

/* Two balls that overlap: a ray from within the union, in one ball or in both, meets its outside alone. */
static void union_from_within(void **state) {
  (void)state;
  const skf_offset items[] = {{{.shape = SKF_POINT, .point = {{0, 0, 0}}}, 1},
                              {{.shape = SKF_POINT, .point = {{1.5, 0, 0}}}, 1}};
  skf_offsets *o;
  assert_int_equal(skf_offsets_new(items, 2, &o), SKF_OK);
  for (double x = -0.9; x < 2.45; x += 0.1)
    for (int side = -1; side <= 1; side += 2) { /* back and forth along a line: the union is met twice */
      skf_hit hit;
      size_t item;
      assert_true(skf_offsets_first(o, &(skf_ray){{x, 0, 0}, {side, 0, 0}, 0, INFINITY}, &hit, &item));
      check_close(hit.t, side < 0 ? x + 1 : 2.5 - x, 1e-13);
      assert_true(!hit.entering && item == (side > 0) && hit.normal.x * side > 0.999);
      assert_false(skf_offsets_first(o, &(skf_ray){hit.at, {side, 0, 0}, 0, INFINITY}, &hit, NULL));
    }
  skf_hit hit;
  const double want[] = {4, 7.5};
  double from = 0;
  for (int k = 0; k < 2; k++, from = hit.t) {
    assert_true(skf_offsets_first(o, &(skf_ray){{-5, 0, 0}, {1, 0, 0}, from, INFINITY}, &hit, NULL));
    check_close(hit.t, want[k], 1e-14);
    assert_true(hit.entering == !k);
  }
  assert_false(skf_offsets_first(o, &(skf_ray){{-5, 0, 0}, {1, 0, 0}, from, INFINITY}, &hit, NULL));
  skf_offsets_free(o);
}

/* Four along a line through a ring, in the places that a circle's radii tell. */
static void ring_in_numbers(void **state) {
  (void)state;
  const skf_offset item = {{.shape = SKF_ARC, .arc = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 3, 2 * SKF_PI}}, 0.5};
  skf_offsets *o;
  assert_int_equal(skf_offsets_new(&item, 1, &o), SKF_OK);
  const double want[] = {6.5, 7.5, 12.5, 13.5};
  skf_hit hit;
  double from = 0;
  for (int k = 0; k < 4; k++) {
    assert_true(skf_offsets_first(o, &(skf_ray){{10, 0, 0}, {-1, 0, 0}, from, INFINITY}, &hit, NULL));
    check_close(hit.t, want[k], 1e-14);
    assert_true(hit.entering == (k % 2 == 0));
    from = hit.t;
  }
  assert_false(skf_offsets_first(o, &(skf_ray){{10, 0, 0}, {-1, 0, 0}, from, INFINITY}, &hit, NULL));
  assert_false(skf_offsets_first(o, &(skf_ray){{0, 0, 9}, {0, 0, -1}, 0, INFINITY}, &hit, NULL));
  skf_offsets_free(o);
}

/* (t - a)(t - b)(t - c)(t + a + b + c) has no cubic term. */
static void quartics(void **state) {
  (void)state;
  for (int i = 0; i < 400; i++) {
    double a = sin(i), b = a + 1e-3 + fabs(cos(3.0 * i)), c = b + 1e-3 + fabs(sin(1.7 * i)), d = -(a + b + c);
    double p = a * b + a * c + a * d + b * c + b * d + c * d, q = -(a * b * c + a * b * d + a * c * d + b * c * d);
    double roots[4], want[4] = {d, a, b, c};
    for (int x = 0; x < 3; x++)
      for (int y = 0; y < 3; y++)
        if (want[y] > want[y + 1]) {
          double swap = want[y];
          want[y] = want[y + 1], want[y + 1] = swap;
        }
    double gap = fmin(want[1] - want[0], fmin(want[2] - want[1], want[3] - want[2]));
    if (gap < 1e-3) continue;
    assert_int_equal(skf_quartic(p, q, a * b * c * d, 20, roots), 4);
    for (int k = 0; k < 4; k++) assert_true(fabs(roots[k] - want[k]) < 1e-9);
  }
  double roots[4];
  assert_int_equal(skf_quartic(1, 0, 1, 10, roots), 0);
  assert_int_equal(skf_quartic(0, 0, -1, 10, roots), 2);
}

static void refused(void **state) {
  (void)state;
  skf_offsets *o;
  skf_offset i = kinds[1];
  i.radius = 0;
  assert_int_equal(skf_offsets_new(&i, 1, &o), SKF_ERR_RANGE);
  i.radius = NAN;
  assert_int_equal(skf_offsets_new(&i, 1, &o), SKF_ERR_RANGE);
  i = kinds[4], i.radius = 0; /* a flat triangle is fine */
  assert_int_equal(skf_offsets_new(&i, 1, &o), SKF_OK);
  skf_hit hit;
  assert_true(skf_offsets_first(o, &(skf_ray){{0, -0.2, 5}, {0, 0, -1}, 0, INFINITY}, &hit, NULL));
  assert_true(skf_primitive_distance(&i.primitive, hit.at) < 1e-12 && hit.normal.z > 0);
  assert_false(skf_offsets_first(o, &(skf_ray){{0.9, 0.9, 5}, {0, 0, -1}, 0, INFINITY}, &hit, NULL));
  skf_offsets_free(o);
  assert_int_equal(skf_offsets_new(NULL, 0, &o), SKF_OK);
  assert_false(skf_offsets_first(o, &(skf_ray){{0, 0, 0}, {0, 0, -1}, 0, INFINITY}, &hit, NULL));
  skf_offsets_free(o);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(each_kind),         cmocka_unit_test(unions),   cmocka_unit_test(capsule_in_numbers),
      cmocka_unit_test(ring_in_numbers),   cmocka_unit_test(quartics), cmocka_unit_test(refused),
      cmocka_unit_test(union_from_within),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
