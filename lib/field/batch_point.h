/* SPDX-License-Identifier: MIT */
/* Vector forms: the kernels at a point. */
#ifndef SKF_FIELD_BATCH_POINT_H
#define SKF_FIELD_BATCH_POINT_H

#include "field/batch_loop.h"

/* s or R, its square, 1 / both; the strength, and its product with s^2 or 1 / R^2 */
typedef struct point_row {
  skf_v3d at;
  skf_vd param, param2, per_param, per_param2, strength, slope;
} point_row;

static double *point_pack(const skf_prepared *e, double *k) {
  double param2 = e->kernel.param * e->kernel.param, strength = e->strength;
  k = pack_parameter(pack3(k, e->primitive.point.at), e);
  return pack1(pack1(k, strength), skf_kernel_get(e->kernel.type)->compact ? strength / param2 : strength * param2);
}

/* From d = at - x (the other way round takes a load more) and w = |d|^2, h and twice its derivative by w, the strength
   in both, the sign of the latter changed. */
SKF_INLINE skf_vvalue point_result(skf_v3d d, skf_vd h, skf_vd slope, skf_vi good) {
  return (skf_vvalue){h, vd3_scale(slope, d), good};
}

SKF_INLINE skf_vvalue inverse_point(const point_row *c, skf_v3d x) {
  skf_v3d d = vd3_sub(c->at, x);
  skf_vd w = vd3_dot(d, d), h = vd_set(1) / vd_sqrt(w), F = c->strength * h;
  return point_result(d, F, (h * h) * F, vd_sane(w));
}

SKF_INLINE skf_vvalue inverse_squared_point(const point_row *c, skf_v3d x) {
  skf_v3d d = vd3_sub(c->at, x);
  skf_vd w = vd3_dot(d, d), h = vd_set(1) / w, F = c->strength * h;
  return point_result(d, F, (h + h) * F, vd_sane(w));
}

SKF_INLINE skf_vvalue cauchy_point(const point_row *c, skf_v3d x) {
  skf_v3d d = vd3_sub(c->at, x);
  skf_vd w = vd3_dot(d, d), y = vd_fma(c->param2, w, vd_set(1)), q = vd_set(1) / y, h = q * q;
  return point_result(d, c->strength * h, (vd_set(4) * c->slope * q) * h, y < vd_set(SKF_PICK(1e70, 1e12)));
}

/* exp(-a^2 w) = 2^(exponent w); from `most` on it is not accurate, from `zero` on 0. */
typedef struct gaussian_row {
  skf_v3d at;
  skf_vd exponent, most, zero, strength, slope;
} gaussian_row;

static double *gaussian_pack(const skf_prepared *e, double *k) {
  double aa = e->kernel.param * e->kernel.param;
  k = pack_exponent(pack3(k, e->primitive.point.at), e->kernel.param);
  k = pack1(pack1(k, VD_EXP_MAX / aa), VD_EXP_ZERO / aa);
  return pack1(pack1(k, e->strength), 2 * aa * e->strength);
}

SKF_INLINE skf_vvalue gaussian_point(const gaussian_row *c, skf_v3d x) {
  skf_v3d d = vd3_sub(c->at, x);
  skf_vd w = vd3_dot(d, d);
  skf_vi inside = w < c->most, beyond = (w > c->zero) & (w < vd_set(INFINITY));
  skf_vd h = (skf_vd)((skf_vi)vd_exp2_product(c->exponent, w) & inside);
  return point_result(d, c->strength * h, c->slope * h, inside | beyond);
}

/* R^2 - |d|^2. Next to the rim the plain difference loses R^2 / q; there d and the squares are taken exactly, but for
   floats, where this is what rounding the point does. */
SKF_INLINE skf_vd point_power(const point_row *c, skf_v3d x, skf_v3d d, skf_vd w) {
  skf_vd R = c->param, R2 = c->param2, q = R2 - w;
  skf_vi rim = vd_set(32) * vd_abs(q) < R2;
  if ((int)SKF_PICK(0, 1) || !vi_any(rim)) return q;
  skf_v3d lo = vd3_lost(c->at, x, d);
  skf_vd pz = d.z * d.z, py = d.y * d.y, px = d.x * d.x;
  skf_vd s = R2 - px, t = s - py, last = t - pz;
  skf_vd low = vd_fms(R, R, R2) + (vd_lost(R2, px, s) + vd_lost(s, py, t) + vd_lost(t, pz, last));
  low -= vd_fms(d.x, d.x, px) + vd_fms(d.y, d.y, py) + vd_fms(d.z, d.z, pz);
  low = vd_fnma(vd_set(2), vd3_dot(d, lo), low);
  return vd_select(rim, last + low, q);
}

/* h = m^2, or m^2 (5 + 4 m) / 9; m = q / R^2, and 0 beyond R */
SKF_INLINE skf_vvalue quartic_of(const point_row *c, skf_v3d d, skf_vd m, skf_vi good) {
  return point_result(d, c->strength * m * m, vd_set(4) * c->slope * m, good);
}
SKF_INLINE skf_vvalue soft_object_of(const point_row *c, skf_v3d d, skf_vd m, skf_vi good) {
  skf_vd h = m * m * vd_fma(vd_set(4. / 9) * c->strength, m, vd_set(5. / 9) * c->strength);
  return point_result(d, h, m * vd_fma(vd_set(8. / 3) * c->slope, m, vd_set(20. / 9) * c->slope), good);
}

/* Whether the plain difference, m times a power of two near 1, is far enough from 0: at 2^-10 it leaves some 5e-13 of
   h. In floats it always is. Without the sign this is a range of half the numbers: one bit after a subtraction. */
SKF_INLINE skf_vi point_off_rim(skf_vd m) {
#ifdef SKF_VEC_FLOAT
  return m > vd_set(-INFINITY);
#else
  return ((skf_vi)m << 1) - ((skf_vi)vd_set(0x1p-10) << 1 ^ vi_sign_bit()) < vi_set(0);
#endif
}

SKF_INLINE skf_vd point_plain(const point_row *c, skf_v3d d, skf_vi *good) {
  skf_vd w = vd3_dot(d, d), m = vd_fnma(w, c->per_param2, vd_set(1));
  *good = point_off_rim(m);
  return vd_max(m, vd_set(0));
}
SKF_INLINE skf_vd point_rim(const point_row *c, skf_v3d x, skf_v3d d, skf_vi *good) {
  skf_vd w = vd3_dot(d, d);
  *good = w < vd_set(INFINITY);
  return vd_max(point_power(c, x, d, w), vd_set(0)) * c->per_param2;
}

#define POLYNOMIAL_POINT(name)                                                                                         \
  SKF_INLINE skf_vvalue name##_point(const point_row *c, skf_v3d x) {                                                  \
    skf_v3d d = vd3_sub(c->at, x);                                                                                     \
    skf_vi good;                                                                                                       \
    skf_vd m = point_plain(c, d, &good);                                                                               \
    return name##_of(c, d, m, good);                                                                                   \
  }                                                                                                                    \
  SKF_INLINE skf_vvalue name##_rim(const point_row *c, skf_v3d x) {                                                    \
    skf_v3d d = vd3_sub(c->at, x);                                                                                     \
    skf_vi good;                                                                                                       \
    skf_vd m = point_rim(c, x, d, &good);                                                                              \
    return name##_of(c, d, m, good);                                                                                   \
  }
POLYNOMIAL_POINT(quartic)
POLYNOMIAL_POINT(soft_object)

SKF_INLINE skf_vvalue metaball_of(const point_row *c, skf_v3d d, skf_vd w, skf_vd power, skf_vi good) {
  skf_vd R = c->param, R2 = c->param2, q = vd_max(power, vd_set(0)), r = vd_sqrt(w);
  skf_vi core = vd_set(9) * w <= R2;
  skf_vd per = c->per_param / vd_select(core, R2, r * (r + R)), m = q * r * per;
  skf_vd h = vd_select(core, vd_fnma(vd_set(3) * c->per_param2, w, vd_set(1)), vd_set(1.5) * m * m);
  skf_vd slope = vd_select(core, vd_set(6) * c->per_param2, vd_set(3) * c->per_param * q * per);
  return point_result(d, c->strength * h, c->strength * slope, good & (w < vd_set(INFINITY)));
}
SKF_INLINE skf_vvalue metaball_point(const point_row *c, skf_v3d x) {
  skf_v3d d = vd3_sub(c->at, x);
  skf_vd w = vd3_dot(d, d), q = c->param2 - w;
  return metaball_of(c, d, w, q, point_off_rim(q * c->per_param2));
}
SKF_INLINE skf_vvalue metaball_rim(const point_row *c, skf_v3d x) {
  skf_v3d d = vd3_sub(c->at, x);
  skf_vd w = vd3_dot(d, d);
  return metaball_of(c, d, w, point_power(c, x, d, w), vi_set(-1));
}

SKF_BATCH_POINT(inverse_point, point, skf_again_none)
SKF_BATCH_POINT(inverse_squared_point, point, skf_again_none)
SKF_BATCH_POINT(cauchy_point, point, skf_again_none)
SKF_BATCH_POINT(gaussian_point, gaussian, skf_again_none)
SKF_BATCH_POINT(quartic_point, point, quartic_rim)
SKF_BATCH_POINT(soft_object_point, point, soft_object_rim)
SKF_BATCH_POINT(metaball_point, point, metaball_rim)

#endif
