/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "random.h"
#include "ray/cubic.h"

/* Bernstein coefficients of c (x - r0)(x - r1)(x - r2). */
static void from_roots(double c, const double r[3], double b[4]) {
  double e1 = r[0] + r[1] + r[2], e2 = r[0] * r[1] + r[1] * r[2] + r[2] * r[0], e3 = r[0] * r[1] * r[2];
  b[0] = -c * e3;
  b[1] = c * (e2 / 3 - e3);
  b[2] = c * (2 * e2 - e1 - 3 * e3) / 3;
  b[3] = c * (1 - e1 + e2 - e3);
}

static void known_roots(void **unused) {
  (void)unused;
  uint64_t state = 5;
  for (int trial = 0; trial < 20000; trial++) {
    double r[3], b[4], found[3], gap = 1e-4;
    for (int i = 0; i < 3; i++) r[i] = rnd(&state, -1, 2);
    if (fabs(r[0] - r[1]) < gap || fabs(r[1] - r[2]) < gap || fabs(r[2] - r[0]) < gap) continue;
    from_roots(rnd(&state, 0, 1) < 0.5 ? rnd(&state, 1e-3, 1e3) : -1e-7, r, b);
    int inside = 0, n = skf_cubic_roots(b, found);
    for (int i = 0; i < 3; i++) {
      if (fabs(r[i]) < 1e-9 || fabs(r[i] - 1) < 1e-9) goto next;
      if (r[i] <= 0 || r[i] >= 1) continue;
      double best = INFINITY;
      for (int k = 0; k < n; k++) best = fmin(best, fabs(found[k] - r[i]));
      assert_true(best < 1e-7);
      inside++;
    }
    assert_int_equal(n, inside);
    if ((b[0] > 0) != (b[3] > 0)) {
      double x = skf_cubic_root(b);
      assert_true(x >= 0 && x <= 1);
      check_scaled(skf_cubic_at(b, x), 0, fabs(b[0]) + fabs(b[1]) + fabs(b[2]) + fabs(b[3]), 1e-12);
    }
  next:;
  }
}

static void range_and_slope(void **unused) {
  (void)unused;
  uint64_t state = 6;
  for (int trial = 0; trial < 3000; trial++) {
    double b[4], lo, hi, least = INFINITY, most = -INFINITY, flat = INFINITY, steep = -INFINITY;
    for (int i = 0; i < 4; i++) b[i] = rnd(&state, -1, 1);
    skf_cubic_range(b, &lo, &hi);
    for (int i = 0; i <= 200; i++) {
      double x = i / 200.0, y = 1 - x, f = skf_cubic_at(b, x);
      double d = 3 * (y * y * (b[1] - b[0]) + 2 * x * y * (b[2] - b[1]) + x * x * (b[3] - b[2]));
      least = fmin(least, f), most = fmax(most, f), flat = fmin(flat, d), steep = fmax(steep, d);
    }
    assert_true(lo <= least + 1e-15 && hi >= most - 1e-15 && least - lo < 1e-3 && hi - most < 1e-3);
    double margin = rnd(&state, 0, 0.5), away = flat > 0 ? flat : steep < 0 ? -steep : -1;
    if (fabs(away - margin) > 1e-3) assert_int_equal(skf_cubic_steep(b, margin), away > margin);
  }
}

static void touching(void **unused) {
  (void)unused;
  double b[4], found[3];
  from_roots(1, (double[]){0.5, 0.5, 3}, b);
  assert_int_equal(skf_cubic_roots(b, found), 0);
  from_roots(1, (double[]){0.5, 0.5, 0.75}, b);
  assert_int_equal(skf_cubic_roots(b, found), 1);
  check_close(found[0], 0.75, 1e-12);
}

/* Roots that are double, triple, or so close that rounding may take them for that: an even number of them may be lost
   or found twice, what is found is near them, and where the ends differ in sign there is a root. */
static void close_roots(void **unused) {
  (void)unused;
  uint64_t state = 7;
  for (int trial = 0; trial < 20000; trial++) {
    double x = rnd(&state, 0.05, 0.95), gap = trial % 4 ? pow(10, -rnd(&state, 3, 17)) : 0, b[4], found[3];
    bool triple = trial % 3 == 0;
    double r[3] = {x, x + gap, triple ? x - gap : rnd(&state, 0, 1) < 0.5 ? -1 : rnd(&state, 0.05, 0.95)};
    if (!triple && fabs(r[2] - x) < 0.01) continue;
    from_roots(rnd(&state, 1e-3, 1e3), r, b);
    int inside = 0, n = skf_cubic_roots(b, found);
    for (int i = 0; i < 3; i++) inside += r[i] > 0 && r[i] < 1;
    assert_int_equal(n & 1, inside & 1);
    for (int k = 0; k < n; k++) {
      double best = INFINITY;
      for (int i = 0; i < 3; i++) best = fmin(best, fabs(found[k] - r[i]));
      assert_true(best < (triple ? 2e-5 : 1e-6));
      assert_true(k == 0 || found[k] >= found[k - 1]);
    }
    if (gap > 1e-4) assert_int_equal(n, inside);
    if ((b[0] > 0) != (b[3] > 0)) assert_true(n > 0);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(known_roots), cmocka_unit_test(range_and_slope),
                                     cmocka_unit_test(touching), cmocka_unit_test(close_roots)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
