/* SPDX-License-Identifier: MIT */
/* The vectors' special functions against series in long double, over their whole range. */
#include "check.h"
#include "random.h"
#include "simd/vecspecial.h"

enum { N = 20000 };
static const long double pi = 3.141592653589793238462643383279502884L;

/* Relative error in halves of an ulp of 1 */
static double ulps(double got, long double want) {
  return (double)(fabsl(got - want) / fabsl(want)) * ldexp(2, SKF_MANTISSA);
}

/* Beyond 8: the continued fraction */
static long double erfc_scaled(long double u) {
  if (u < 8) return 0.5L * sqrtl(pi) * expl(u * u) * erfcl(u);
  long double f = u;
  for (int k = 80; k > 0; k--) f = u + 0.5L * k / f;
  return 0.5L / f;
}

static void test_erfc(void **state) {
  (void)state;
  uint64_t seed = 1;
  double worst = 0, beyond = 0;
  for (int i = 0; i < N; i++) {
    double u = i % 2 ? rnd(&seed, 0, 6) : pow(10, rnd(&seed, -12, 12)), e;
    e = ulps(vd_erfc_scaled(vd_set(u))[i % SKF_LANES], erfc_scaled(u));
    if (u <= 27)
      worst = fmax(worst, e);
    else
      beyond = fmax(beyond, e);
  }
  print_message("erfc: %.2f half ulps, beyond 27 %.2f\n", worst, beyond);
  assert_true(worst <= 9 && beyond <= 30000);
  check_close(vd_erfc_scaled(vd_set(0))[0], 0.88622692545275801365, 4e-16);
}

/* From the left of 0, and from 1 / 2 on: in units of what exp(-u^2) beside them errs by */
static void test_erfc_parts(void **state) {
  (void)state;
  uint64_t seed = 7;
  double near = 0, far = 0;
  for (int i = 0; i < N; i++) {
    const long double root = sqrtl(logl(2));
    double u = i % 2 ? rnd(&seed, -2, 4) : rnd(&seed, -2, 27), by = 1 + (u > 0 ? u * u / 4 : 0);
    skf_real w = (skf_real)((double)(u / root) + VD_ERFC_NEAR);
    double e = ulps(vd_erfc_near(vd_set(w))[i % SKF_LANES], erfc_scaled((w - (long double)VD_ERFC_NEAR) * root));
    near = fmax(near, e / by);
    w = (skf_real)((double)((fabs(u) + 0.5) / root) + VD_ERFC_FAR);
    e = ulps(vd_erfc_far(vd_set(w))[i % SKF_LANES], erfc_scaled((w - (long double)VD_ERFC_FAR) * root));
    far = fmax(far, e / by);
  }
  print_message("erfc from -2 on: %.2f half ulps, from 1/2 on: %.2f\n", near, far);
  assert_true(near <= 9 && far <= 9);
}

static void test_sincos(void **state) {
  (void)state;
  uint64_t seed = 2;
  double worst = 0, tiny = 0;
  for (int i = 0; i < N; i++) {
    double x = i % 2 ? rnd(&seed, -10, 10) : rnd(&seed, -1, 1) * pow(10, rnd(&seed, -20, 0));
    skf_vsincos v = vd_sincos(vd_set(x));
    worst = fmax(worst, ldexp((double)fmaxl(fabsl(v.sin[0] - sinl(x)), fabsl(v.cos[1] - cosl(x))), 53));
    if (fabs(x) < 0.7) tiny = fmax(tiny, ulps(v.sin[2], sinl(x)));
  }
  print_message("sine and cosine: %.2f half ulps of 1; small sines %.2f of themselves\n", worst, tiny);
  assert_true(worst <= 2 && tiny <= 2);
}

/* Both of Carlson's forms by so many duplications that the leading term of the series is enough. */
static long double carlson(long double x, long double y, long double z, long double *rd) {
  long double f = 1, S = 0;
  for (int n = 0; n < 40; n++) {
    long double sx = sqrtl(x), sy = sqrtl(y), sz = sqrtl(z), l = sx * (sy + sz) + sy * sz;
    S += f / (sz * (z + l));
    x = (x + l) / 4, y = (y + l) / 4, z = (z + l) / 4, f /= 4;
  }
  *rd = f / (z * sqrtl(z)) + 3 * S;
  return 1 / sqrtl((x + y + z) / 3);
}

static void test_carlson(void **state) {
  (void)state;
  uint64_t seed = 3;
  double worst_f = 0, worst_d = 0;
  int kept = 0;
  for (int i = 0; i < N; i++) {
    double s = pow(10, rnd(&seed, -20, 20)), x = i % 8 ? s * pow(10, rnd(&seed, -4, 0)) : 0;
    double y = s * pow(10, rnd(&seed, -2, 0)), z = s * pow(10, rnd(&seed, -2, 0));
    skf_vcarlson v = vd_carlson(vd_set(x), vd_set(y), vd_set(z), i % 2 ? 4 : 7);
    assert_true(i % 2 || v.good[0]);
    if (!v.good[1]) continue;
    kept++;
    long double X = x, Y = y, Z = z, rd, rf = carlson(X * X, Y * Y, Z * Z, &rd);
    worst_f = fmax(worst_f, ulps(v.rf[0], rf));
    worst_d = fmax(worst_d, ulps(v.rd[3], rd));
  }
  print_message("Carlson's R_F: %.2f, R_D: %.2f half ulps, %.0f %% done\n", worst_f, worst_d, 100. * kept / N);
  assert_true(worst_f <= 10 && worst_d <= 10);
}

/* exp(-b) I0(b), exp(-b) I1(b) / (b / 2) and exp(-b) (I0(b) - I1(b)), the last by its own series beyond 40 */
static void bessel(long double b, long double out[3]) {
  long double q = b * b / 4, t = 1, u = 1, v = 1, s = 1, r = 1, d = 0;
  if (b < 40) {
    for (int k = 1; k < 200; k++) s += t *= q / (k * k), r += u *= q / (k * (k + 1.0L));
    out[0] = expl(-b) * s, out[1] = expl(-b) * r, out[2] = expl(-b) * (s - b / 2 * r);
    return;
  }
  for (int k = 1; k < 40; k++) {
    long double m = (2.0L * k - 1) * (2.0L * k - 1) / (8 * b * k), n = m - 4 / (8 * b * k);
    t *= m, v *= n, s += t, d += t - v;
  }
  out[0] = s / sqrtl(2 * pi * b), out[2] = d / sqrtl(2 * pi * b), out[1] = (out[0] - out[2]) / (b / 2);
}

static void test_bessel(void **state) {
  (void)state;
  uint64_t seed = 4;
  double worst = 0;
  for (int i = 0; i < N; i++) {
    double b = i % 2 ? rnd(&seed, 0, VD_BESSEL_NEAR) : rnd(&seed, VD_BESSEL_NEAR, 60);
    if (i % 8 == 0) b = VD_BESSEL_NEAR * pow(10, rnd(&seed, 0, 10));
    long double want[3], e = expl(-(long double)b);
    bessel(b, want);
    if (b < VD_BESSEL_NEAR) {
      skf_vbessel v = vd_bessel_near(vd_set(b));
      worst = fmax(worst, fmax(ulps(v.i0[0], want[0] / e), ulps(v.other[1], want[1] / e)));
    } else {
      skf_vbessel v = vd_bessel_far(vd_set(b));
      worst = fmax(worst, fmax(ulps(v.i0[2], want[0]), ulps(v.other[3], want[2])));
    }
  }
  print_message("Bessel functions: %.2f half ulps\n", worst);
  assert_true(worst <= 8);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_erfc), cmocka_unit_test(test_erfc_parts),
                                     cmocka_unit_test(test_sincos), cmocka_unit_test(test_carlson),
                                     cmocka_unit_test(test_bessel)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
