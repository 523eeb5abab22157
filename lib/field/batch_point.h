/* SPDX-License-Identifier: MIT */
/* Vector forms: the kernels at a point. */
#ifndef SKF_FIELD_BATCH_POINT_H
#define SKF_FIELD_BATCH_POINT_H

#include "field/batch_loop.h"

/* s or R, its square, 1 / both; the strength, and its product with s^2 or 1 / R^2, Cauchy's and the quartic's four
   times as they need it */
typedef struct point_row {
  skf_v3d at;
  skf_vd param, param2, per_param, per_param2, strength, slope;
} point_row;

static double *point_pack(const skf_prepared *e, double *k) {
  const skf_kernel_type type = e->kernel.type;
  double param2 = e->kernel.param * e->kernel.param, strength = e->strength;
  double slope = skf_kernel_get(type)->compact ? strength / param2 : strength * param2;
  k = pack_parameter(pack3(k, e->primitive.point.at), e);
  return pack1(pack1(k, strength), type == SKF_CAUCHY || type == SKF_QUARTIC ? 4 * slope : slope);
}

/* h and minus twice its derivative by w, both times the strength */
SKF_INLINE skf_vi inverse_point_of(const point_row *c, size_t n, const skf_vd *w, skf_vd *F, skf_vd *slope) {
  skf_vi good = vi_set(-1);
  SKF_EACH(u, n) good &= vd_sane(w[u]);
  SKF_EACH(u, n) slope[u] = vd_sqrt(w[u]);
  SKF_EACH(u, n) slope[u] = vd_set(1) / slope[u];
  SKF_EACH(u, n) F[u] = c->strength * slope[u];
  SKF_EACH(u, n) slope[u] = (slope[u] * slope[u]) * F[u];
  return good;
}

SKF_INLINE skf_vi inverse_squared_point_of(const point_row *c, size_t n, const skf_vd *w, skf_vd *F, skf_vd *slope) {
  skf_vi good = vi_set(-1);
  SKF_EACH(u, n) good &= vd_sane(w[u]);
  SKF_EACH(u, n) slope[u] = vd_set(1) / w[u];
  SKF_EACH(u, n) F[u] = c->strength * slope[u];
  SKF_EACH(u, n) slope[u] = (slope[u] + slope[u]) * F[u];
  return good;
}

SKF_INLINE skf_vi cauchy_point_of(const point_row *c, size_t n, const skf_vd *w, skf_vd *F, skf_vd *slope) {
  skf_vi good = vi_set(-1);
  skf_vd h[4];
  SKF_EACH(u, n) slope[u] = vd_fma(c->param2, w[u], vd_set(1));
  SKF_EACH(u, n) good &= slope[u] < vd_set(SKF_PICK(1e70, 1e12));
  SKF_EACH(u, n) slope[u] = vd_set(1) / slope[u];
  SKF_EACH(u, n) h[u] = slope[u] * slope[u];
  SKF_EACH(u, n) F[u] = c->strength * h[u];
  SKF_EACH(u, n) slope[u] = (c->slope * slope[u]) * h[u];
  return good;
}

/* exp(-a^2 w) = 2^((exponent + low) w); in floats low is the shift, whose lift the strengths have in them */
typedef struct gaussian_row {
  skf_v3d at;
  skf_vd exponent, low, strength, slope;
} gaussian_row;

static double *gaussian_pack(const skf_prepared *e, double *k) {
  double aa = e->kernel.param * e->kernel.param, strength = e->strength;
  k = pack_exponent_low(pack3(k, e->primitive.point.at), e->kernel.param);
#ifdef SKF_VEC_FLOAT /* down to where neither F nor the gradient matters: narrow kernels among many are mostly far */
  const int lift = (int)fmin(fmax(4 + log2(fabs(strength) * (1 + e->kernel.param)), 0), 120);
  k[-1] = (double)VD_EXP2_SHIFT + lift, strength = ldexp(strength, -lift);
#endif
  return pack1(pack1(k, strength), 2 * aa * strength);
}

typedef skf_vpower gaussian_point_state;
SKF_INLINE void gaussian_point_begin(const gaussian_row *c, skf_vd w, skf_vpower *s) {
#ifdef SKF_VEC_FLOAT
  *s = vd_gaussian_begin(c->exponent, w, c->low);
#else
  *s = vd_exp2_begin_low(c->exponent, c->low, w);
#endif
}
SKF_INLINE void gaussian_point_middle(const gaussian_row *c, skf_vpower *s) {
  (void)c;
  vd_exp2_middle(s);
}
SKF_INLINE void gaussian_point_late(const gaussian_row *c, skf_vpower *s) {
  (void)c;
  vd_exp2_late(s);
}
SKF_INLINE skf_vi gaussian_point_end(const gaussian_row *c, const skf_vpower *s, skf_vd *F, skf_vd *slope) {
  skf_vd h;
  const skf_vi good = vd_gaussian_end(s, &h);
  *F = c->strength * h, *slope = c->slope * h;
  return good;
}
SKF_INLINE skf_vvalue gaussian_point_gone(const gaussian_row *c, skf_v3d x) {
  const skf_v3d d = vd3_sub(c->at, x);
  const skf_vd zero = vd_set(0);
  return (skf_vvalue){zero, {zero, zero, zero}, vd_gaussian_gone(c->exponent, vd3_dot(d, d))};
}

/* R^2 - |d|^2. Next to the rim the plain difference loses R^2 / q, but for floats, where this is what rounding the
   point does. */
SKF_INLINE skf_vd point_power(const point_row *c, skf_v3d x, skf_v3d d, skf_vd w) {
  skf_vd q = c->param2 - w;
  skf_vi rim = vd_set(32) * vd_abs(q) < c->param2;
  if ((int)SKF_PICK(0, 1) || !vi_any(rim)) return q;
  return vd_select(rim, power_exact(c->param, c->at, x, d), q);
}

/* Whether all the plain differences, m times a power of two near 1, are far enough from 0: at 2^-10 they leave some
   5e-13 of h. In floats they always are. (NaN is.) */
SKF_INLINE skf_vi point_off_rim(size_t n, const skf_vd *m) {
  skf_vd least = vd_set(1);
  SKF_EACH(u, n) least = vd_min(vd_abs(m[u]), least);
  return (int)SKF_PICK(0, 1) ? vi_set(-1) : (skf_vi)(least > vd_set(0x1p-10));
}

/* h = m^2, or m^2 (5 + 4 m) / 9; m = q / R^2, and 0 beyond R */
SKF_INLINE void quartic_from(const point_row *c, size_t n, const skf_vd *m, skf_vd *F, skf_vd *slope) {
  SKF_EACH(u, n) F[u] = c->strength * m[u] * m[u];
  SKF_EACH(u, n) slope[u] = c->slope * m[u];
}
SKF_INLINE void soft_object_from(const point_row *c, size_t n, const skf_vd *m, skf_vd *F, skf_vd *slope) {
  SKF_EACH(u, n)
  F[u] = m[u] * m[u] * vd_fma(vd_set(4. / 9) * c->strength, m[u], vd_set(5. / 9) * c->strength);
  SKF_EACH(u, n) slope[u] = m[u] * vd_fma(vd_set(8. / 3) * c->slope, m[u], vd_set(20. / 9) * c->slope);
}

SKF_INLINE skf_vi point_plain(const point_row *c, size_t n, const skf_vd *w, skf_vd *m) {
  SKF_EACH(u, n) m[u] = vd_fnma(w[u], c->per_param2, vd_set(1));
  const skf_vi good = point_off_rim(n, m);
  SKF_EACH(u, n) m[u] = vd_max(m[u], vd_set(0));
  return good;
}

#define POLYNOMIAL_POINT(name)                                                                                         \
  SKF_INLINE skf_vi name##_point_of(const point_row *c, size_t n, const skf_vd *w, skf_vd *F, skf_vd *slope) {         \
    skf_vd m[4];                                                                                                       \
    const skf_vi good = point_plain(c, n, w, m);                                                                       \
    name##_from(c, n, m, F, slope);                                                                                    \
    return good;                                                                                                       \
  }                                                                                                                    \
  SKF_INLINE skf_vvalue name##_rim(const point_row *c, skf_v3d x) {                                                    \
    const skf_v3d d = vd3_sub(c->at, x);                                                                               \
    const skf_vd w = vd3_dot(d, d), m = vd_max(point_power(c, x, d, w), vd_set(0)) * c->per_param2;                    \
    skf_vd F, slope;                                                                                                   \
    name##_from(c, 1, &m, &F, &slope);                                                                                 \
    return (skf_vvalue){F, vd3_scale(slope, d), w < vd_set(INFINITY)};                                                 \
  }
POLYNOMIAL_POINT(quartic)
POLYNOMIAL_POINT(soft_object)

#ifdef SKF_VEC_FLOAT
/* As it is written: m = 1 - r / R, of which rounding the point takes as much as this. */
SKF_INLINE void metaball_from(const point_row *c, size_t n, const skf_vd *w, const skf_vd *power, skf_vd *F,
                              skf_vd *slope) {
  const skf_vd third = vd_set(1. / 9) * c->param2, steep = vd_set(3) * c->per_param * c->strength;
  skf_vd r[4], m[4];
  (void)power;
  SKF_EACH(u, n) r[u] = vd_sqrt(w[u]);
  SKF_EACH(u, n) m[u] = vd_max(vd_fnma(r[u], c->per_param, vd_set(1)), vd_set(0));
  SKF_EACH(u, n) r[u] = steep * m[u] / r[u];
  SKF_EACH(u, n) {
    const skf_vi core = w[u] <= third;
    F[u] = vd_select(core, vd_fnma(vd_set(3) * c->slope, w[u], c->strength), vd_set(1.5) * c->strength * m[u] * m[u]);
    slope[u] = vd_select(core, vd_set(6) * c->slope, r[u]);
  }
}
#else
SKF_INLINE void metaball_from(const point_row *c, size_t n, const skf_vd *w, const skf_vd *power, skf_vd *F,
                              skf_vd *slope) {
  const skf_vd R = c->param, R2 = c->param2;
  SKF_EACH(u, n) {
    const skf_vd q = vd_max(power[u], vd_set(0)), r = vd_sqrt(w[u]);
    const skf_vi core = vd_set(9) * w[u] <= R2;
    const skf_vd per = c->per_param / vd_select(core, R2, r * (r + R)), m = q * r * per;
    const skf_vd h = vd_select(core, vd_fnma(vd_set(3) * c->per_param2, w[u], vd_set(1)), vd_set(1.5) * m * m);
    F[u] = c->strength * h;
    slope[u] = c->strength * vd_select(core, vd_set(6) * c->per_param2, vd_set(3) * c->per_param * q * per);
  }
}
#endif
SKF_INLINE skf_vi metaball_point_of(const point_row *c, size_t n, const skf_vd *w, skf_vd *F, skf_vd *slope) {
  skf_vd q[4], m[4];
  SKF_EACH(u, n) q[u] = c->param2 - w[u];
  SKF_EACH(u, n) m[u] = q[u] * c->per_param2;
  const skf_vi good = point_off_rim(n, m) & (vd_total(n, w) < vd_set(INFINITY));
  metaball_from(c, n, w, q, F, slope);
  return good;
}
SKF_INLINE skf_vvalue metaball_rim(const point_row *c, skf_v3d x) {
  const skf_v3d d = vd3_sub(c->at, x);
  const skf_vd w = vd3_dot(d, d), q = point_power(c, x, d, w);
  skf_vd F, slope;
  metaball_from(c, 1, &w, &q, &F, &slope);
  return (skf_vvalue){F, vd3_scale(slope, d), w < vd_set(INFINITY)};
}

SKF_BATCH_MEASURED(inverse_point, point, point, skf_again_none)
SKF_BATCH_MEASURED(inverse_squared_point, point, point, skf_again_none)
SKF_BATCH_MEASURED(cauchy_point, point, point, skf_again_none)
SKF_BATCH_PIPED(gaussian_point, gaussian, point, gaussian_point_gone)
SKF_BATCH_MEASURED(quartic_point, point, point, quartic_rim)
SKF_BATCH_MEASURED(soft_object_point, point, point, soft_object_rim)
SKF_BATCH_MEASURED(metaball_point, point, point, metaball_rim)

#endif
