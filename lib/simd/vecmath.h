/* SPDX-License-Identifier: MIT */
/* Logarithm, arc tangent and exponential of four doubles at once, inline, one division each or none, to two ulps. The
   coefficients interpolate at Chebyshev nodes; beside each stands its largest relative error. */
#ifndef SKF_SIMD_VECMATH_H
#define SKF_SIMD_VECMATH_H

#include "simd/vec.h"

/* c[0] + c[1] x + ... */
SKF_INLINE skf_vd vd_horner(const double *c, int n, skf_vd x) {
  skf_vd s = vd_set(c[n - 1]);
  for (int i = n - 2; i >= 0; i--) s = vd_fma(s, x, vd_set(c[i]));
  return s;
}

/* log(n / d) for normal n >= d > 0, where dif = n - d is known better than n and d. The difference of the bit patterns,
   rounded to whole exponents, gives k with n / (2^k d) in [2/3, 3/2]: t = (n' - d) / (n' + d), t^2 <= 0.04. */
SKF_INLINE skf_vd vd_log_ratio(skf_vd n, skf_vd d, skf_vd dif) {
  /* atanh(t) / t in t^2 up to 0.0418: 1.9e-19 */
  static const double c[] = {1.0,
                             0.33333333333333261,
                             0.20000000000045908,
                             0.14285714274464187,
                             0.11111112490189396,
                             0.09090814324879619,
                             0.076961198084308583,
                             0.065778920849028674,
                             0.069786914382512646};
  skf_vi k = (skf_vi)(((skf_vi)n - (skf_vi)d) + vi_set(1ll << 51));
  k = (skf_vi)((__typeof__(0ull) __attribute__((vector_size(32))))k >> 52);
  skf_vd count = (skf_vd)(k | vi_set(0x4330000000000000)) - vd_set(0x1p52), near = (skf_vd)((skf_vi)n - (k << 52));
  skf_vd top = vd_select(k == vi_set(0), dif, near - d), t = top / (near + d);
  skf_vd series = (t + t) * vd_horner(c, 9, t * t);
  return vd_fma(count, vd_set(0x1.62e42fefa39efp-1), vd_fma(count, vd_set(0x1.abc9e3b39803fp-56), series));
}

/* atan2(y, x) for y, x not both 0: reduced to |t| <= tan(pi / 8). */
SKF_INLINE skf_vd vd_atan2(skf_vd y, skf_vd x) {
  /* atan(t) / t in t^2: 1.3e-18 */
  static const double c[] = {1.0,
                             -0.33333333333333121,
                             0.19999999999940891,
                             -0.14285714279250245,
                             0.11111110744919658,
                             -0.090908968090640271,
                             0.07692045330902225,
                             -0.066629518136291901,
                             0.058468782973308725,
                             -0.050351024566015518,
                             0.037965257453865936,
                             -0.017805397205419445};
  skf_vi negative = x < vd_set(0), sign = vd_sign(y);
  skf_vd ay = vd_abs(y), ax = vd_abs(x);
  skf_vi steep = ay > ax;
  skf_vd low = vd_select(steep, ax, ay), high = vd_select(steep, ay, ax);
  skf_vi wide = low > vd_set(0.41421356237309505) * high;
  skf_vd t = vd_select(wide, low - high, low) / vd_select(wide, low + high, high);
  skf_vd a = t * vd_horner(c, 12, t * t);
  a += (skf_vd)((skf_vi)vd_set(0.78539816339744831) & wide);
  a = vd_select(steep, vd_set(1.5707963267948966) - a, a);
  a = vd_select(negative, vd_set(3.1415926535897932) - a, a);
  return (skf_vd)((skf_vi)a ^ sign);
}

/* exp(x) for |x| <= 700. */
SKF_INLINE skf_vd vd_exp(skf_vd x) {
  /* exp(r) for |r| <= log(2) / 2: 3.2e-18 */
  static const double c[] = {1.0,
                             1.0,
                             0.50000000000000186,
                             0.16666666666666681,
                             0.041666666666486661,
                             0.0083333333333194903,
                             0.0013888888952696516,
                             0.00019841269890340665,
                             2.4801485074105117e-5,
                             2.7557240604663896e-6,
                             2.7632790542117181e-7,
                             2.5110153646928931e-8};
  const skf_vd shift = vd_set(0x1.8p52);
  skf_vd biased = vd_fma(x, vd_set(1.4426950408889634), shift), k = biased - shift;
  skf_vd r = vd_fnma(k, vd_set(0x1.abc9e3b39803fp-56), vd_fnma(k, vd_set(0x1.62e42fefa39efp-1), x));
  skf_vi whole = (skf_vi)biased - (skf_vi)shift;
  return vd_horner(c, 12, r) * (skf_vd)((whole + vi_set(1023)) << 52);
}

#endif
