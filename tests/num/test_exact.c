/* SPDX-License-Identifier: MIT */
/* Error-free transformations, and Gauss-Legendre rules against the integrals that they must give exactly. */
#include "check.h"
#include "num/exact.h"
#include "num/gauss.h"

static void sums_and_products_are_exact(void **state) {
  (void)state;
  uint64_t seed = 1;
  for (int i = 0; i < 1000; i++) {
    double v[2];
    for (int k = 0; k < 2; k++) {
      seed = seed * 6364136223846793005u + 1442695040888963407u;
      v[k] = ldexp((double)(int64_t)seed, -63 + (int)(seed >> 20) % 40);
    }
    skf_dd s = dd_two_sum(v[0], v[1]), p = dd_two_prod(v[0], v[1]);
    assert_true((long double)v[0] + v[1] - s.hi == s.lo || fabs(log2(fabs(v[0] / v[1]))) > 10);
    assert_true(p.hi == v[0] * v[1] && p.lo == fma(v[0], v[1], -p.hi));
  }
}

static void cancelling_cross_product(void **state) {
  (void)state;
  /* (1, 1 + u, 0) x (1 - u, 1, 0): z = 1 - (1 - u^2) = u^2 */
  double u = ldexp(1, -40);
  skf_dd one = {1, 0}, zero = {0, 0};
  skf_dd3 a = {one, {1 + u, 0}, zero}, b = {{1 - u, 0}, one, zero};
  assert_true(dd3_cross(a, b).z.hi == u * u);
  assert_true(dd3_dot(a, b).hi == 2);
}

static void gauss_rules_integrate_powers(void **state) {
  (void)state;
  for (int n = 1; n <= SKF_GAUSS_MAX; n++) {
    const skf_gauss_node *g = skf_gauss_rule(n);
    for (int power = 0; power < 2 * n; power++) {
      double sum = 0;
      for (int i = 0; i < n; i++) sum += g[i].w * pow(g[i].x, power);
      check_scaled(sum, power % 2 ? 0 : 2.0 / (power + 1), 1, 1e-15);
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sums_and_products_are_exact),
      cmocka_unit_test(cancelling_cross_product),
      cmocka_unit_test(gauss_rules_integrate_powers),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
