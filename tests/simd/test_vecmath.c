/* SPDX-License-Identifier: MIT */
/* The vector functions against long double: two ulps, over their whole range. Compiled without vector instructions;
   those only change the speed, see vec.h. */
#include "check.h"
#include "random.h"
#include "simd/vecmath.h"
#include <float.h>

enum { N = 20000 };

static double ulps(double got, long double want) {
  return want == 0 ? (got == 0 ? 0 : INFINITY) : (double)(fabsl(got - want) / (fabsl(want) * (DBL_EPSILON / 2)));
}

static void test_log_ratio(void **state) {
  (void)state;
  uint64_t seed = 1;
  double worst = 0;
  for (int i = 0; i < N; i++) {
    double d = pow(10, rnd(&seed, -100, 100)), dif = d * pow(10, rnd(&seed, -20, i % 2 ? 1 : 50)), n = d + dif;
    double got = vd_log_ratio(vd_set(n), vd_set(d), vd_set(dif))[i % 4];
    long double want = n == d || dif < d ? log1pl((long double)dif / d) : logl((long double)n / d);
    worst = fmax(worst, ulps(got, want));
  }
  print_message("log: %.2f half ulps\n", worst);
  assert_true(worst <= 4);
}

static void test_atan2(void **state) {
  (void)state;
  uint64_t seed = 2;
  double worst = 0;
  for (int i = 0; i < N; i++) {
    double x = rnd(&seed, -1, 1), y = rnd(&seed, -1, 1) * pow(10, rnd(&seed, i % 2 ? -1 : -30, i % 2 ? 1 : 30));
    worst = fmax(worst, ulps(vd_atan2(vd_set(y), vd_set(x))[i % 4], atan2l(y, x)));
  }
  print_message("atan2: %.2f half ulps\n", worst);
  assert_true(worst <= 4);
  assert_true(vd_atan2(vd_set(0), vd_set(2))[0] == 0);
  check_close(vd_atan2(vd_set(0), vd_set(-2))[1], 3.14159265358979323846, 1e-16);
}

static void test_exp(void **state) {
  (void)state;
  uint64_t seed = 3;
  double worst = 0;
  for (int i = 0; i < N; i++) {
    double x = i % 2 ? rnd(&seed, -700, 700) : rnd(&seed, -1, 1);
    worst = fmax(worst, ulps(vd_exp(vd_set(x))[i % 4], expl(x)));
  }
  print_message("exp: %.2f half ulps\n", worst);
  assert_true(worst <= 4);
  assert_true(vd_exp(vd_set(0))[2] == 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_log_ratio), cmocka_unit_test(test_atan2),
                                     cmocka_unit_test(test_exp)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
