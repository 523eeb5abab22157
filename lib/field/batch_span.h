/* SPDX-License-Identifier: MIT */
/* num/span.h, four at a time: integrals of even powers of cos t and sin t between two angles. */
#ifndef SKF_FIELD_BATCH_SPAN_H
#define SKF_FIELD_BATCH_SPAN_H

#include "field/batch_loop.h"

typedef struct span_view {
  skf_vd delta, sin, cos, versine; /* of delta = t1 - t0 */
  skf_vd c, s;                     /* cos^2, sin^2 of (t0 + t1) / 2 */
  skf_vd gap3, gap5, per_N;
  skf_vi good;
} span_view;

/* x - sin x */
SKF_INLINE skf_vd span_gap3(skf_vd x, skf_vd sin) {
  /* (x - sin x) / x^3 in x^2 up to 1: 3e-19 */
  static const double c[] = {0.16666666666666667,    -0.0083333333333333,   0.00019841269841216566,
                             -2.7557319192011219e-6, 2.5052099244914114e-8, -1.6057701922579787e-10,
                             7.5493717041812434e-13};
  skf_vd y = x * x;
  return vd_select(x > vd_set(1), x - sin, x * y * vd_horner(c, (int)SKF_PICK(7, 5), y));
}

/* 3 x - 4 sin x + sin(2 x) / 2 */
SKF_INLINE skf_vd span_gap5(skf_vd x, skf_vd sin, skf_vd cos) {
  /* over x^5, in x^2 up to 2.25: 2e-18 */
  static const double c[] = {0.099999999999999998,   -0.011904761904761782,   0.00069444444444298447,
                             -2.5553150546482693e-5, 6.5713605853950083e-7,   -1.2526034550385296e-8,
                             1.8422554769880514e-10, -2.1483795670663544e-12, 1.894397855559886e-14};
  skf_vd y = x * x, large = vd_fma(sin, cos - vd_set(4), vd_set(3) * x);
  return vd_select(x > vd_set(1.5), large, x * y * y * vd_horner(c, (int)SKF_PICK(9, 7), y));
}

/* The arguments are N sin delta, N cos delta, N, N cos sigma, N sin sigma with sigma = t0 + t1. */
SKF_INLINE span_view span_see(skf_vd cross, skf_vd dot, skf_vd N, skf_vd cos_sigma, skf_vd sin_sigma) {
  skf_vd A = N + vd_abs(cos_sigma), B = N + vd_abs(dot), half = vd_set(0.5), bottom = N * A * B,
         inv = vd_set(1) / bottom;
  skf_vd per_N = inv * (A * B), near = half * A * per_N, far = half * sin_sigma * sin_sigma * (inv * B);
  skf_vi front = cos_sigma >= vd_set(0);
  span_view a = {.delta = vd_atan2(cross, dot), .sin = cross * per_N, .cos = dot * per_N, .per_N = per_N};
  a.versine = vd_select(dot > vd_set(0), cross * cross * (inv * A), B * per_N);
  a.c = vd_select(front, near, far);
  a.s = vd_select(front, far, near);
  a.gap3 = span_gap3(a.delta, a.sin);
  a.gap5 = span_gap5(a.delta, a.sin, a.cos);
  a.good = vd_sane(bottom) & vd_sane(cross);
  return a;
}

/* int cos^2 for c, int sin^2 for s; the same with fourth powers */
SKF_INLINE skf_vd span_second(const span_view *a, skf_vd c) { return vd_fma(c, a->sin, vd_set(0.5) * a->gap3); }
SKF_INLINE skf_vd span_fourth(const span_view *a, skf_vd c) {
  return vd_fma(c * a->sin, vd_fma(c, a->cos, a->versine), vd_set(0.125) * a->gap5);
}
#endif
