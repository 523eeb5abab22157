/* SPDX-License-Identifier: MIT */
/* The vector functions against long double, over their whole range. Compiled without vector instructions; those only
   change the speed, see test_lanes.c. */
#include "check.h"
#include "random.h"
#include "simd/vecmath.h"

#ifndef N
enum { N = 20000 };
#endif

/* Relative error in halves of an ulp of 1 */
static double ulps(double got, long double want) {
  return want == 0 ? (got == 0 ? 0 : INFINITY) : (double)(fabsl(got - want) / fabsl(want)) * ldexp(2, SKF_MANTISSA);
}

static double power(uint64_t *seed, double lo, double hi) { return pow(10, rnd(seed, lo, hi)); }

static void test_log_ratio(void **state) {
  (void)state;
  uint64_t seed = 1;
  double worst = 0;
  for (int i = 0; i < N; i++) {
    double range = SKF_PICK(100, 12), far = SKF_PICK(50, 12);
    skf_real d = (skf_real)power(&seed, -range, range), dif = (skf_real)(d * power(&seed, -20, i % 2 ? 1 : far)),
             n = d + dif;
    double got = vd_log_ratio(vd_set(n), vd_set(d), vd_set(dif))[i % SKF_LANES];
    long double want = n == d || dif < d ? log1pl((long double)dif / d) : logl((long double)n / d);
    worst = fmax(worst, ulps(got, want));
  }
  print_message("log: %.2f half ulps\n", worst);
  assert_true(worst <= 4);
}

static void test_log_one(void **state) {
  (void)state;
  uint64_t seed = 5;
  double worst = 0, range = SKF_PICK(300, 36);
  for (int i = 0; i < 4 * N; i++) {
    const skf_real a = (skf_real)(i % 2 ? rnd(&seed, 0.4, 2.5) : power(&seed, -range, range));
    const skf_vlog l = vd_log_one(vd_set(a));
    worst = fmax(worst, ulps(vd_log_series(l.count, l.top / l.bottom)[i % SKF_LANES], logl(a)));
  }
  print_message("log of one: %.2f half ulps\n", worst);
  assert_true(worst <= 4);
}

/* Where log(n' / d) takes most off k log 2 */
static void test_log_cancels(void **state) {
  (void)state;
  uint64_t seed = 4;
  double worst = 0;
  for (int i = 0; i < 10 * N; i++) {
    skf_real d = (skf_real)rnd(&seed, 1, 2), n = (skf_real)(d * rnd(&seed, 1, 3)), dif = n - d;
    worst = fmax(worst, ulps(vd_log_ratio(vd_set(n), vd_set(d), vd_set(dif))[0], log1pl(((long double)n - d) / d)));
  }
  print_message("log of 1 to 3: %.2f half ulps\n", worst);
  assert_true(worst <= 5.5);
}

static void test_atan2(void **state) {
  (void)state;
  uint64_t seed = 2;
  double worst = 0;
  for (int i = 0; i < N; i++) {
    skf_real x = (skf_real)rnd(&seed, -1, 1),
             y = (skf_real)(rnd(&seed, -1, 1) * (i % 2 ? power(&seed, -1, 1) : power(&seed, -30, 30)));
    worst = fmax(worst, ulps(vd_atan2(vd_set(y), vd_set(x))[i % SKF_LANES], atan2l(y, x)));
  }
  print_message("atan2: %.2f half ulps\n", worst);
  assert_true(worst <= 3);
  assert_true(vd_atan2(vd_set(0), vd_set(2))[0] == 0);
  assert_true(vd_atan2(vd_set(0), vd_set(-2))[1] == (skf_real)3.14159265358979323846);
  assert_true(vd_atan2(vd_set(-2), vd_set(0))[2] == (skf_real)-1.57079632679489661923);
}

static skf_vpower binary(skf_vd c, skf_vd x) {
  skf_vpower e = vd_exp2_begin(c, x);
  vd_exp2_middle(&e);
  vd_exp2_late(&e);
  return e;
}

static void test_exp(void **state) {
  (void)state;
  uint64_t seed = 3;
  double worst = 0, range = VD_EXP_MAX;
  for (int i = 0; i < N; i++) {
    skf_real x = (skf_real)(i % 2 ? rnd(&seed, -range, range) : rnd(&seed, -1, 1));
    worst = fmax(worst, ulps(vd_exp(vd_set(x))[i % SKF_LANES], expl(x)));
  }
  print_message("exp: %.2f half ulps\n", worst);
  assert_true(worst <= 2);
  worst = 0;
  for (int i = 0; i < N; i++) {
    skf_real c = (skf_real)rnd(&seed, -3, 3), x = (skf_real)(rnd(&seed, -1, 1) * (i % 2 ? range / 3 : 1));
    const skf_vpower e = binary(vd_set(c), vd_set(x));
    const long double want = exp2l((long double)c * x);
    worst = fmax(worst, ulps(vd_exp2_end(&e)[i % SKF_LANES], want));
    worst = fmax(worst, ulps(vd_exp2_times(&e, vd_set(0.5))[i % SKF_LANES], want / 2));
  }
  print_message("exp2: %.2f half ulps\n", worst);
  assert_true(worst <= 2);
  worst = 0;
  for (int i = 0; i < N; i++) {
    const double exact = rnd(&seed, -3, 3);
    const skf_real c = (skf_real)exact, low = (skf_real)((exact - (double)c) + rnd(&seed, -1, 1) * 1e-16 * fabs(exact));
    skf_real x = (skf_real)(rnd(&seed, -1, 1) * (i % 2 ? range / 3 : 1));
    skf_vpower e = vd_exp2_begin_low(vd_set(c), vd_set(low), vd_set(x));
    assert_true(fabs((double)(e.whole[0] - VD_EXP2_SHIFT) - (double)c * x) <= 0.5 + 1e-6);
    vd_exp2_middle(&e);
    vd_exp2_late(&e);
    worst = fmax(worst, ulps(vd_exp2_end(&e)[i % SKF_LANES], exp2l(((long double)c + low) * x)));
  }
  print_message("exp2 with a low part: %.2f half ulps\n", worst);
  assert_true(worst <= 2);
  const skf_vpower none = binary(vd_set(2), vd_set(0));
  assert_true(vd_exp2_end(&none)[1] == 1);
  worst = 0;
  for (int i = 0; i < N; i++) {
    const skf_real y = (skf_real)(rnd(&seed, -1, 1) * (i % 2 ? range : 1));
    const skf_vd in[3] = {vd_set(y), vd_set(0), vd_set(y)};
    skf_vd h[3];
    vd_exp2_each(3, in, h);
    worst = fmax(worst, ulps(h[i % 2 * 2][i % SKF_LANES], exp2l(y)));
    assert_true(h[1][i % SKF_LANES] == 1);
  }
  print_message("exp2 of several: %.2f half ulps\n", worst);
  assert_true(worst <= 2);
  assert_true(vd_exp(vd_set(0))[2] == 1);
}

/* The helpers that do not map to one operation of the compiler's */
static void test_helpers(void **state) {
  (void)state;
  double c[16];
  for (int i = 0; i < 16; i++) c[i] = 1 + i % 3;
  for (int n = 1; n <= 16; n++) assert_true(vd_estrin(c, n, vd_set(0.5))[0] == vd_horner(c, n, vd_set(0.5))[0]);
  skf_vd v = vd_set(-0.0);
  assert_true(signbit(v[1]) && vi_bits(vd_set(1) > v) == (1 << SKF_LANES) - 1 && vi_bits(v > vd_set(1)) == 0);
  v[SKF_LANES - 1] = (skf_real)NAN;
  assert_true(vi_bits(v == v) == (1 << (SKF_LANES - 1)) - 1 && !vi_all(v == v) && vi_any(v != v));
  assert_true(vi_all(vd_sane(vd_set(-3))) && !vi_any(vd_sane(vd_set(0))) && !vi_any(vd_sane(vd_set(NAN))));
  assert_true(vd_select(v == v, vd_set(1), vd_set(2))[0] == 1 && vd_select(v == v, v, vd_set(2))[SKF_LANES - 1] == 2);
  assert_true(signbit(vd_abs(vd_set(-3))[0]) == 0 && vd_abs(vd_set(-3))[0] == 3 && vd_sqrt(vd_set(9))[0] == 3);
  assert_true(vd_fms(vd_set(2), vd_set(3), vd_set(7))[0] == -1 && vd_fnma(vd_set(2), vd_set(3), vd_set(7))[0] == 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_log_ratio),   cmocka_unit_test(test_log_one),
                                     cmocka_unit_test(test_log_cancels), cmocka_unit_test(test_atan2),
                                     cmocka_unit_test(test_exp),         cmocka_unit_test(test_helpers)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
