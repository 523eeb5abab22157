/* SPDX-License-Identifier: MIT */
/* Sums and products without rounding error, and double-double numbers of about 106 bits. Needs -ffp-contract=off. */
#ifndef SKF_NUM_EXACT_H
#define SKF_NUM_EXACT_H

#include "core/vec3.h"

/* The unevaluated sum hi + lo, |lo| <= ulp(hi) / 2. */
typedef struct skf_dd {
  double hi, lo;
} skf_dd;

typedef struct skf_dd3 {
  skf_dd x, y, z;
} skf_dd3;

/* a + b exactly [Knuth]. */
static inline skf_dd dd_two_sum(double a, double b) {
  double s = a + b, t = s - a;
  return (skf_dd){s, (a - (s - t)) + (b - t)};
}

/* a + b exactly when |a| >= |b| or a = 0 [Dekker]. */
static inline skf_dd dd_fast_sum(double a, double b) {
  double s = a + b;
  return (skf_dd){s, b - (s - a)};
}

/* a b exactly; both forms give the same bits. */
static inline skf_dd dd_two_prod(double a, double b) {
  double p = a * b;
#ifdef __FMA__
  return (skf_dd){p, __builtin_fma(a, b, -p)};
#else
  const double split = 134217729.0; /* 2^27 + 1 [Dekker] */
  double t = split * a, ah = t - (t - a), al = a - ah;
  t = split * b;
  double bh = t - (t - b), bl = b - bh;
  return (skf_dd){p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
#endif
}

/* a b - c d, to an ulp or two [Kahan]. */
static inline double dd_det2(double a, double b, double c, double d) {
  skf_dd p = dd_two_prod(a, b), q = dd_two_prod(c, d);
  return (p.hi - q.hi) + (p.lo - q.lo);
}

static inline skf_dd dd_neg(skf_dd a) { return (skf_dd){-a.hi, -a.lo}; }

static inline skf_dd dd_add(skf_dd a, skf_dd b) {
  skf_dd s = dd_two_sum(a.hi, b.hi), t = dd_two_sum(a.lo, b.lo);
  s = dd_fast_sum(s.hi, s.lo + t.hi);
  return dd_fast_sum(s.hi, s.lo + t.lo);
}

static inline skf_dd dd_sub(skf_dd a, skf_dd b) { return dd_add(a, dd_neg(b)); }

static inline skf_dd dd_mul(skf_dd a, skf_dd b) {
  skf_dd p = dd_two_prod(a.hi, b.hi);
  return dd_fast_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

/* a - b exactly, by coordinates. */
static inline skf_dd3 dd3_diff(skf_vec3 a, skf_vec3 b) {
  return (skf_dd3){dd_two_sum(a.x, -b.x), dd_two_sum(a.y, -b.y), dd_two_sum(a.z, -b.z)};
}

static inline skf_dd dd3_dot(skf_dd3 a, skf_dd3 b) {
  return dd_add(dd_add(dd_mul(a.x, b.x), dd_mul(a.y, b.y)), dd_mul(a.z, b.z));
}

static inline skf_dd3 dd3_cross(skf_dd3 a, skf_dd3 b) {
  return (skf_dd3){dd_sub(dd_mul(a.y, b.z), dd_mul(a.z, b.y)), dd_sub(dd_mul(a.z, b.x), dd_mul(a.x, b.z)),
                   dd_sub(dd_mul(a.x, b.y), dd_mul(a.y, b.x))};
}

static inline skf_vec3 dd3_round(skf_dd3 a) { return v3(a.x.hi, a.y.hi, a.z.hi); }

/* R^2 - |d|^2 to an ulp or two of itself, for a difference d of doubles. */
static inline double dd3_power(double R, skf_dd3 d) {
  const skf_dd c[3] = {d.x, d.y, d.z};
  skf_dd sum = dd_two_prod(R, R);
  double low = sum.lo;
  for (int i = 0; i < 3; i++) {
    skf_dd p = dd_two_prod(c[i].hi, c[i].hi), s = dd_two_sum(sum.hi, -p.hi);
    low += s.lo - (p.lo + 2 * c[i].hi * c[i].lo);
    sum.hi = s.hi;
  }
  return sum.hi + low;
}

/* a . b to an ulp or two unless it cancels beyond 1e-30. */
static inline double dd3_dot_round(skf_dd3 a, skf_dd3 b) {
  skf_dd px = dd_two_prod(a.x.hi, b.x.hi), py = dd_two_prod(a.y.hi, b.y.hi), pz = dd_two_prod(a.z.hi, b.z.hi);
  px.lo += a.x.hi * b.x.lo + a.x.lo * b.x.hi;
  py.lo += a.y.hi * b.y.lo + a.y.lo * b.y.hi;
  pz.lo += a.z.hi * b.z.lo + a.z.lo * b.z.hi;
  skf_dd s = dd_two_sum(px.hi, py.hi), t = dd_two_sum(s.hi, pz.hi);
  return t.hi + ((s.lo + t.lo) + (px.lo + py.lo + pz.lo));
}

/* a . b for doubles b, to an ulp or two unless it cancels beyond 1e-30. */
static inline double dd3_dot_d(skf_dd3 a, skf_vec3 b) {
  const skf_dd c[3] = {a.x, a.y, a.z};
  const double e[3] = {b.x, b.y, b.z};
  double sum = 0, low = 0;
  for (int i = 0; i < 3; i++) {
    skf_dd p = dd_two_prod(c[i].hi, e[i]), s = dd_two_sum(sum, p.hi);
    low += s.lo + (p.lo + c[i].lo * e[i]);
    sum = s.hi;
  }
  return sum + low;
}

#endif
