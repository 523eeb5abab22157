/* SPDX-License-Identifier: MIT */
/* Logarithm, arc tangent and exponential of several numbers at once, inline, with two divisions at most. Largest
   relative errors, in halves of an ulp of 1: log 5.2 (3.2 for ratios up to 1.35), atan2 3, exp and exp2 2, for
   doubles and for floats alike. The series begin with exact terms; what follows is interpolated at Chebyshev nodes or a
   quotient, and beside it stands the relative error that it leaves in the result. */
#ifndef SKF_SIMD_VECMATH_H
#define SKF_SIMD_VECMATH_H

#include "simd/vec.h"

/* c[0] + c[1] x + ... */
SKF_INLINE skf_vd vd_horner(const double *c, int n, skf_vd x) {
  skf_vd s = vd_set(c[n - 1]);
  for (int i = n - 2; i >= 0; i--) s = vd_fma(s, x, vd_set(c[i]));
  return s;
}

SKF_INLINE skf_vd vd_poly2(const double *c, int n, skf_vd x) {
  return n < 2 ? vd_set(c[0]) : vd_fma(vd_set(c[1]), x, vd_set(c[0]));
}
SKF_INLINE skf_vd vd_poly4(const double *c, int n, skf_vd x, skf_vd x2) {
  return n <= 2 ? vd_poly2(c, n, x) : vd_fma(vd_poly2(c + 2, n - 2, x), x2, vd_poly2(c, 2, x));
}
SKF_INLINE skf_vd vd_poly8(const double *c, int n, skf_vd x, skf_vd x2, skf_vd x4) {
  return n <= 4 ? vd_poly4(c, n, x, x2) : vd_fma(vd_poly4(c + 4, n - 4, x, x2), x4, vd_poly4(c, 4, x, x2));
}
/* The same for up to 16 coefficients by halves [Estrin 1960]: up to three products more, a third of the latency. */
SKF_INLINE skf_vd vd_estrin(const double *c, int n, skf_vd x) {
  skf_vd x2 = x * x, x4 = x2 * x2;
  if (n <= 8) return vd_poly8(c, n, x, x2, x4);
  return vd_fma(vd_poly8(c + 8, n - 8, x, x2, x4), x4 * x4, vd_poly8(c, 8, x, x2, x4));
}

/* The same, even and odd powers apart: half the latency of Horner's rule for one product more. */
SKF_INLINE skf_vd vd_halves(const double *c, int n, skf_vd x) {
  skf_vd x2 = x * x, even = vd_set(c[(n - 1) / 2 * 2]), odd = vd_set(c[n / 2 * 2 - 1]);
#pragma GCC unroll 16
  for (int i = (n - 1) / 2 * 2 - 2; i >= 0; i -= 2) even = vd_fma(even, x2, vd_set(c[i]));
#pragma GCC unroll 16
  for (int i = n / 2 * 2 - 3; i >= 0; i -= 2) odd = vd_fma(odd, x2, vd_set(c[i]));
  return vd_fma(odd, x, even);
}

/* log(n / d) for normal n >= d > 0, where dif = n - d is known better than n and d. The difference of the bit patterns,
   rounded to whole exponents from 9/16 on, gives k with n' / d = n / (2^k d) in [0.69, 1.5625]: t = top / bottom =
   (n' - d) / (n' + d), t^2 < 0.0482, and k log 2 is at least twice what log(n' / d) takes off it. */
typedef struct skf_vlog {
  skf_vd count, top, bottom; /* count: k VD_LOG_UNIT */
} skf_vlog;
#define VD_LOG_UNIT SKF_PICK(1, 0x1p23) /* as it stands in a float's exponent */

SKF_INLINE skf_vlog vd_log_parts(skf_vd n, skf_vd d, skf_vd dif) {
  skf_vi bits = (skf_vi)n - (skf_vi)d + vi_set(7ll << (SKF_MANTISSA - 4));
#ifdef SKF_VEC_FLOAT
  skf_vi shift = bits & vi_set(-(1ll << SKF_MANTISSA));
  skf_vd count = __builtin_convertvector(shift, skf_vd), near = (skf_vd)((skf_vi)n - shift);
  skf_vi same = near == n; /* compilers make two steps of shift == 0 */
#else
  skf_vi k = (skf_vi)((skf_vu)bits >> SKF_MANTISSA), same = k == vi_set(0);
  skf_vd count = (skf_vd)(k | vi_set(0x4330000000000000)) - vd_set(0x1p52);
  skf_vd near = (skf_vd)((skf_vi)n - (k << SKF_MANTISSA));
#endif
  return (skf_vlog){count, vd_select(same, dif, near - d), near + d};
}

#ifdef SKF_VEC_FLOAT
/* The logarithm times a factor, which is the same for many */
SKF_INLINE skf_vd vd_log_series_by(skf_vd by, skf_vd count, skf_vd t) {
  /* log 2; 2 atanh(t) / t in t^2: 2e-8 */
  static const double c[] = {0.69314718055994531, 2, 0.6666674920097649, 0.39969239603201616, 0.3025211373701086};
  skf_vd tt = t * t, s = by * vd_set(c[4]);
  for (int i = 3; i > 0; i--) s = vd_fma(s, tt, by * vd_set(c[i]));
  return vd_fma(count, by * vd_set(c[0] / VD_LOG_UNIT), s * t);
}
SKF_INLINE skf_vd vd_log_series(skf_vd count, skf_vd t) { return vd_log_series_by(vd_set(1), count, t); }
SKF_INLINE skf_vd vd_log_one_series(skf_vd count, skf_vd t) { return vd_log_series(count, t); }
#else
SKF_INLINE skf_vd vd_log_sum(skf_vd count, skf_vd t, skf_vd rest) {
  const skf_vd twice = t + t, series = vd_fma(twice * (t * t), rest, twice);
  return vd_fma(count, vd_set(0.69314718055994531), series); /* log 2 is off by less than a third of half an ulp */
}
SKF_INLINE skf_vd vd_log_series(skf_vd count, skf_vd t) {
  /* (atanh(t) / t - 1) / t^2: 3e-18 */
  static const double c[] = {0.33333333333333327754,  0.20000000000014813956,  0.14285714279270011385,
                             0.1111111217730151712,   0.090908226632058733025, 0.076960982004333991369,
                             0.065752223845082355045, 0.070110979035245868007};
  return vd_log_sum(count, t, vd_halves(c, sizeof c / sizeof *c, t * t));
}
/* The same after vd_log_one, t^2 < 0.0304: 6e-18 */
SKF_INLINE skf_vd vd_log_one_series(skf_vd count, skf_vd t) {
  static const double c[] = {0.33333333333333353687, 0.19999999999937626005, 0.14285714318388431643,
                             0.1111110470168566039,  0.09091506506334068316, 0.07663838516721432903,
                             0.073327779238463675071};
  return vd_log_sum(count, t, vd_halves(c, sizeof c / sizeof *c, t * t));
}
#endif

SKF_INLINE skf_vd vd_log_ratio(skf_vd n, skf_vd d, skf_vd dif) {
  skf_vlog l = vd_log_parts(n, d, dif);
  return vd_log_series(l.count, l.top / l.bottom);
}

/* The same for log(a), a normal and positive: a = 2^k a', a' in [0.703, 1.407], so that k log 2 is about twice what
   log(a') takes off it. */
SKF_INLINE skf_vlog vd_log_one(skf_vd a) {
  skf_vi bits = (skf_vi)a + vi_set(19ll << (SKF_MANTISSA - 5));
#ifdef SKF_VEC_FLOAT
  skf_vi shift = (bits - vi_set((long long)SKF_BIAS << SKF_MANTISSA)) & vi_set(-(1ll << SKF_MANTISSA));
  skf_vd count = __builtin_convertvector(shift, skf_vd), near = (skf_vd)((skf_vi)a - shift);
#else
  skf_vi k = (skf_vi)((skf_vu)bits >> SKF_MANTISSA);
  skf_vd count = (skf_vd)(k | vi_set(0x4330000000000000)) - vd_set(0x1p52 + SKF_BIAS);
  skf_vi part = bits & vi_set((1ll << SKF_MANTISSA) - 1);
  skf_vd near = (skf_vd)(part + vi_set(((long long)SKF_BIAS << SKF_MANTISSA) - (19ll << (SKF_MANTISSA - 5))));
#endif
  const skf_vd one = vd_held(vd_set(1));
  return (skf_vlog){count, near - one, near + one};
}

/* atan2(y, x) for y >= 0, y and x not both 0, is offset + atan t, |t| = |top / bottom| <= tan(pi / 8); in floats, whose
   series is short, <= 1. */
typedef struct skf_vangle {
  skf_vd offset, top, bottom;
} skf_vangle;

#ifdef SKF_VEC_FLOAT
SKF_INLINE skf_vangle vd_angle_parts(skf_vd y, skf_vd x) {
  skf_vi steep = y > vd_abs(x);
  skf_vd offset = (skf_vd)((skf_vi)vd_set(3.1415926535897932) & (x < vd_set(0)));
  return (skf_vangle){vd_select(steep, vd_set(1.5707963267948966), offset), vd_select(steep, -x, y),
                      vd_select(steep, y, x)};
}
#else
SKF_INLINE skf_vangle vd_angle_parts(skf_vd y, skf_vd x) {
  skf_vd ax = vd_abs(x), low = vd_min(y, ax), high = vd_max(y, ax);
  skf_vi negative = x<vd_set(0), steep = y> ax;
  skf_vi wide = low > vd_set(0.41421356237309505) * high;
  skf_vd top = vd_select(wide, low - high, low), bottom = vd_select(wide, low + high, high);
  skf_vd offset = (skf_vd)((skf_vi)vd_set(0.78539816339744831) & wide);
  offset = vd_select(steep, vd_set(1.5707963267948966) - offset, offset);
  offset = vd_select(negative, vd_set(3.1415926535897932) - offset, offset);
  return (skf_vangle){offset, (skf_vd)((skf_vi)top ^ (vi_sign_bit() & (steep ^ negative))), bottom};
}
#endif

#ifdef SKF_VEC_FLOAT
/* atan(t) / t in t^2 up to 1: 2e-8 */
static const double vd_angle_terms[] = {1,
                                        -0.33333152735496885,
                                        0.19993772823016945,
                                        -0.14211055218589896,
                                        0.10666004309831008,
                                        -0.07552213598200953,
                                        0.043211852838435434,
                                        -0.016367923170877485,
                                        0.0029206910390830593};
#endif

/* atan(t) - t for such a t */
SKF_INLINE skf_vd vd_angle_rest(skf_vd t) {
#ifdef SKF_VEC_FLOAT
  skf_vd tt = t * t;
  return t * tt * vd_horner(vd_angle_terms + 1, 8, tt);
#else
  /* (atan(t) / t - 1) / t^2 in t^2 as a quotient, in fewer steps: 6e-18 */
  static const double p[] = {-14.741484128731191452, -21.743951606571126886, -8.8124881713516473923,
                             -0.84073396818207150867};
  static const double q[] = {44.224452386193603764, 91.766526251410943104, 62.544043529909628945,
                             15.461600818395211201};
  skf_vd tt = t * t,
         bottom = vd_fma(vd_fma(vd_fma(tt + vd_set(q[3]), tt, vd_set(q[2])), tt, vd_set(q[1])), tt, vd_set(q[0]));
  return t * tt * vd_horner(p, 4, tt) / bottom;
#endif
}

SKF_INLINE skf_vd vd_angle_series(skf_vd offset, skf_vd t) {
#ifdef SKF_VEC_FLOAT
  return vd_fma(t, vd_horner(vd_angle_terms, 9, t * t), offset);
#else
  return offset + (t + vd_angle_rest(t));
#endif
}

SKF_INLINE skf_vd vd_angle(skf_vd y, skf_vd x) {
  skf_vangle a = vd_angle_parts(y, x);
  return vd_angle_series(a.offset, a.top / a.bottom);
}

/* atan2(y, x) for y, x not both 0. */
SKF_INLINE skf_vd vd_atan2(skf_vd y, skf_vd x) { return (skf_vd)((skf_vi)vd_angle(vd_abs(y), x) ^ vd_sign(y)); }

/* Where vd_exp is accurate, and from where on exp(-x) is 0 */
#define VD_EXP_MAX  SKF_PICK(700, 86)
#define VD_EXP_ZERO SKF_PICK(800, 110)

/* exp(x) = (1 + part) scale for |x| <= VD_EXP_MAX, scale a power of two. */
typedef struct skf_vexp {
  skf_vd part, scale;
} skf_vexp;

SKF_INLINE skf_vexp vd_exp_parts(skf_vd x) {
  /* (exp(r) - 1 - r) / r^2 for |r| <= log(2) / 2 */
#ifdef SKF_VEC_FLOAT /* 8e-9 */
  static const double c[] = {0.5, 0.16666576989698775683, 0.041666554617204574203, 0.0083631790527225773704,
                             0.0013926183587713494542};
  const skf_vd shift = vd_set(0x1.8p23);
#else /* 1.3e-17 */
  static const double c[] = {0.50000000000000010221,     0.16666666666666667453,   0.041666666666624127873,
                             0.0083333333333300618325,   0.0013888888917213716901, 0.00019841269863053616878,
                             0.000024801521295954375131, 2.7557268459997064772e-6, 2.7620088445409748161e-7,
                             2.5100385495510319078e-8};
  const skf_vd shift = vd_set(0x1.8p52);
#endif
  skf_vd biased = vd_fma(x, vd_set(1.4426950408889634), shift), k = biased - shift;
  skf_vd r = vd_fnma(k, vd_set(SKF_PICK(0x1.62e42fefa39efp-1, 0x1.62e43p-1)), x);
  r = vd_fnma(k, vd_set(SKF_PICK(0x1.abc9e3b39803fp-56, -0x1.05c61p-29)), r);
  skf_vi whole = (skf_vi)biased - (skf_vi)shift;
  return (skf_vexp){vd_fma(r * r, vd_estrin(c, sizeof c / sizeof *c, r), r),
                    (skf_vd)((whole + vi_set(SKF_BIAS)) << SKF_MANTISSA)};
}

/* 2^((c + low) x), the products not rounded, for |c x| <= 1020 (in floats 125): exp(a x) with c = a log2(e), in fewer
   steps than vd_exp takes. In parts, for loops that keep the chains of several vectors apart: 2^(whole + f), |f|
   <= 1/2, whole in its last bits. With y = f log(2) / 2, 2^f = 1 + 2 tanh y / (1 - tanh y): a quotient needs half the
   coefficients, and where polynomials are what takes the time a division is nearly free. */
typedef struct skf_vpower {
  skf_vd whole, f;
  skf_vd part; /* of 2^f, set on the way */
} skf_vpower;

#define VD_EXP2_SHIFT SKF_PICK(0x1.8p52 + 1, 0x1.8p23) /* what is added to `whole`; in doubles 2^f is halved */

SKF_INLINE skf_vpower vd_exp2_begin(skf_vd c, skf_vd x) {
  const skf_vd shift = vd_set(VD_EXP2_SHIFT), whole = vd_fma(c, x, shift);
  return (skf_vpower){whole, vd_fms(c, x, whole - shift), vd_set(0)};
}
SKF_INLINE skf_vpower vd_exp2_begin_low(skf_vd c, skf_vd low, skf_vd x) {
  skf_vpower e = vd_exp2_begin(c, x);
  e.f = vd_fma(low, x, e.f);
  return e;
}

SKF_INLINE void vd_exp2_middle(skf_vpower *e) {
  const skf_vd f = e->f;
#ifdef SKF_VEC_FLOAT
  /* (2^f - 1) / f: 5e-9 */
  static const double p[] = {0.69314718802622878106,   0.24022650760568126945,   0.055503571142190778186,
                             0.0096180825572778514913, 0.0013390863364671234381, 0.00015453162945120690177};
  e->part = vd_horner(p, sizeof p / sizeof *p, f);
#else
  /* 2^f / 2 = 1 / 2 + t / (c p - t), t = f q; p and q are of f^2, which is multiplied by 1, so that a sum takes the
     place of a product: 2e-18 */
  const skf_vd ff = f * f, top = f * vd_fma(ff, ff + vd_set(874.74279004383755337), vd_set(65550.947584495924676));
  e->f = top;
  e->part = vd_fms(vd_set(43.300524563102202267),
                   vd_fma(ff, ff + vd_set(233.17769678877791967), vd_set(4368.077660024972011)), top);
#endif
}
SKF_INLINE void vd_exp2_late(skf_vpower *e) {
#ifndef SKF_VEC_FLOAT
  e->part = e->f / e->part;
#else
  (void)e;
#endif
}

/* Then 2^f, in doubles half of it less 1 / 2, which is added where it need not be waited for; and with `whole` */
SKF_INLINE skf_vd vd_exp2_mantissa(const skf_vpower *e) {
#ifdef SKF_VEC_FLOAT
  return vd_fma(e->part, e->f, vd_set(1));
#else
  return e->part;
#endif
}
SKF_INLINE skf_vd vd_exp2_raise(skf_vd mantissa, skf_vd whole) {
#ifndef SKF_VEC_FLOAT
  mantissa += vd_set(0.5);
#endif
  return (skf_vd)((skf_vi)mantissa + ((skf_vi)whole << SKF_MANTISSA));
}

SKF_INLINE skf_vd vd_exp2_end(const skf_vpower *e) { return vd_exp2_raise(vd_exp2_mantissa(e), e->whole); }

/* The same times a factor, if the product is a normal number */
SKF_INLINE skf_vd vd_exp2_times(const skf_vpower *e, skf_vd by) {
#ifdef SKF_VEC_FLOAT
  return by * vd_exp2_end(e);
#else
  return (skf_vd)((skf_vi)vd_fma(e->part, by, vd_set(0.5) * by) + ((skf_vi)e->whole << SKF_MANTISSA));
#endif
}

/* 2^y of n vectors side by side, stage after stage: so many chains, and no quotients, keep the processor busy where
   nothing else waits; then the fewest products count, not the shortest chain. */
SKF_INLINE void vd_exp2_each(const size_t n, const skf_vd *y, skf_vd *h) {
#ifdef SKF_VEC_FLOAT
  /* 2^f for |f| <= 1/2: 5e-9 */
  static const double p[] = {0.69314718802622878106,   0.24022650760568126945,   0.055503571142190778186,
                             0.0096180825572778514913, 0.0013390863364671234381, 0.00015453162945120690177};
#else
  /* the same: 2e-17 */
  static const double p[] = {0.69314718055994530942,     0.2402265069591009822,    0.055504108664821594339,
                             0.0096181291076068885273,   0.001333355814641693531,  0.00015403530441736050155,
                             0.000015252733829836118394, 1.3215442587921689653e-6, 1.0178062445845773521e-7,
                             7.0725859492692236999e-9,   4.4549605981865183938e-10};
#endif
  const skf_vd shift = vd_set(SKF_PICK(0x1.8p52, 0x1.8p23));
  skf_vd whole[4], f[4];
  SKF_EACH(u, n) whole[u] = y[u] + shift;
  SKF_EACH(u, n) f[u] = y[u] - (whole[u] - shift);
  SKF_EACH(u, n) f[u] = vd_fma(vd_halves(p, sizeof p / sizeof *p, f[u]), f[u], vd_set(1));
  SKF_EACH(u, n) h[u] = (skf_vd)((skf_vi)f[u] + ((skf_vi)whole[u] << SKF_MANTISSA));
}

/* exp(x) for |x| <= VD_EXP_MAX. */
SKF_INLINE skf_vd vd_exp(skf_vd x) {
  skf_vexp e = vd_exp_parts(x);
  return (vd_set(1) + e.part) * e.scale;
}

#endif
