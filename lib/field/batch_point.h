/* SPDX-License-Identifier: MIT */
/* Vector forms: the kernels at a point. */
#ifndef SKF_FIELD_BATCH_POINT_H
#define SKF_FIELD_BATCH_POINT_H

#include "field/batch_loop.h"

/* From d and w = |d|^2, h and twice its derivative by w. */
SKF_INLINE skf_vvalue point_result(skf_v3d d, skf_vd h, skf_vd slope, skf_vi good) {
  return (skf_vvalue){h, vd3_scale(slope, d), good};
}

SKF_INLINE skf_v3d point_delta(const skf_prepared *e, skf_v3d x) { return vd3_sub(x, vd3_set(e->primitive.point.at)); }

SKF_INLINE skf_vvalue inverse_point(const skf_prepared *e, skf_v3d x) {
  skf_v3d d = point_delta(e, x);
  skf_vd w = vd3_dot(d, d), h = vd_set(1) / vd_sqrt(w);
  return point_result(d, h, -(h * h) * h, vd_sane(w));
}

SKF_INLINE skf_vvalue inverse_squared_point(const skf_prepared *e, skf_v3d x) {
  skf_v3d d = point_delta(e, x);
  skf_vd w = vd3_dot(d, d), h = vd_set(1) / w;
  return point_result(d, h, vd_set(-2) * h * h, vd_sane(w));
}

SKF_INLINE skf_vvalue cauchy_point(const skf_prepared *e, skf_v3d x) {
  double s2 = e->kernel.param * e->kernel.param;
  skf_v3d d = point_delta(e, x);
  skf_vd w = vd3_dot(d, d), y = vd_fma(vd_set(s2), w, vd_set(1)), q = vd_set(1) / y, h = q * q;
  return point_result(d, h, vd_set(-4 * s2) * h * q, y < vd_set(1e70));
}

SKF_INLINE skf_vvalue gaussian_point(const skf_prepared *e, skf_v3d x) {
  double a2 = e->kernel.param * e->kernel.param;
  skf_v3d d = point_delta(e, x);
  skf_vd y = vd_set(a2) * vd3_dot(d, d);
  skf_vi inside = y < vd_set(700), beyond = (y > vd_set(800)) & (y < vd_set(INFINITY));
  skf_vd h = (skf_vd)((skf_vi)vd_exp(-vd_min(y, vd_set(700))) & inside);
  return point_result(d, h, vd_set(-2 * a2) * h, inside | beyond);
}

/* R^2 - |d|^2. Next to the rim the plain difference loses R^2 / q; there d and the squares are taken exactly. */
SKF_INLINE skf_vd point_power(const skf_prepared *e, skf_v3d x, skf_v3d d, skf_vd w) {
  skf_vd R = vd_set(e->kernel.param), R2 = R * R, q = R2 - w;
  skf_vi rim = vd_set(32) * vd_abs(q) < R2;
  if (!vi_any(rim)) return q;
  skf_v3d lo = vd3_lost(x, vd3_set(e->primitive.point.at), d);
  skf_vd pz = d.z * d.z, py = d.y * d.y, px = d.x * d.x;
  skf_vd a = R2 - px, b = a - py, c = b - pz;
  skf_vd low = vd_fms(R, R, R2) + (vd_lost(R2, px, a) + vd_lost(a, py, b) + vd_lost(b, pz, c));
  low -= vd_fms(d.x, d.x, px) + vd_fms(d.y, d.y, py) + vd_fms(d.z, d.z, pz);
  low = vd_fnma(vd_set(2), vd3_dot(d, lo), low);
  return vd_select(rim, c + low, q);
}

/* m^2 (c2 + c3 m), m = q / R^2 */
SKF_INLINE skf_vvalue polynomial_point(const skf_prepared *e, skf_v3d x, double c2, double c3) {
  double R2 = e->kernel.param * e->kernel.param;
  skf_v3d d = point_delta(e, x);
  skf_vd w = vd3_dot(d, d), m = vd_max(point_power(e, x, d, w), vd_set(0)) * vd_set(1 / R2);
  skf_vd h = m * m * vd_fma(vd_set(c3), m, vd_set(c2));
  skf_vd slope = vd_set(-2 / R2) * m * vd_fma(vd_set(3 * c3), m, vd_set(2 * c2));
  return point_result(d, h, slope, w < vd_set(INFINITY));
}

SKF_INLINE skf_vvalue quartic_point(const skf_prepared *e, skf_v3d x) { return polynomial_point(e, x, 1, 0); }
SKF_INLINE skf_vvalue soft_object_point(const skf_prepared *e, skf_v3d x) {
  return polynomial_point(e, x, 5. / 9, 4. / 9);
}

SKF_INLINE skf_vvalue metaball_point(const skf_prepared *e, skf_v3d x) {
  double R = e->kernel.param, R2 = R * R;
  skf_v3d d = point_delta(e, x);
  skf_vd w = vd3_dot(d, d), q = vd_max(point_power(e, x, d, w), vd_set(0)), r = vd_sqrt(w);
  skf_vi core = vd_set(9) * w <= vd_set(R2);
  skf_vd per = vd_set(1 / R) / vd_select(core, vd_set(R2), r * (r + vd_set(R))), m = q * r * per;
  skf_vd h = vd_select(core, vd_fnma(vd_set(3 / R2), w, vd_set(1)), vd_set(1.5) * m * m);
  return point_result(d, h, vd_select(core, vd_set(-6 / R2), vd_set(-3 / R) * q * per), w < vd_set(INFINITY));
}

SKF_BATCH_LOOP(inverse_point)
SKF_BATCH_LOOP(inverse_squared_point)
SKF_BATCH_LOOP(cauchy_point)
SKF_BATCH_LOOP(gaussian_point)
SKF_BATCH_LOOP(quartic_point)
SKF_BATCH_LOOP(soft_object_point)
SKF_BATCH_LOOP(metaball_point)

#endif
