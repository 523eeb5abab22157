/* SPDX-License-Identifier: MIT */
/* Vector forms: the kernels over a plane, as in each kernel's file. */
#ifndef SKF_FIELD_BATCH_PLANE_H
#define SKF_FIELD_BATCH_PLANE_H

#include "field/batch_loop.h"

typedef struct plane_row {
  skf_v3d through, raw, unit;
  skf_vd per_length, param, param2, per_param, per_param2; /* s or R, its square, 1 / both */
} plane_row;

static double *plane_pack(const skf_prepared *e, double *k) {
  const skf_plane_plan *p = &e->plan.plane;
  k = pack3(pack3(pack3(k, e->primitive.plane.through), p->raw), p->unit);
  return pack_parameter(pack1(k, 1 / p->length), e);
}

/* Signed height over the plane to a few ulps, however far x is from the plane's point. */
SKF_INLINE skf_vd plane_height(const plane_row *c, skf_v3d x) {
  skf_v3d d = vd3_sub(x, c->through), lo = vd3_lost(x, c->through, d), n = c->raw;
  skf_vd px = d.x * n.x, py = d.y * n.y, pz = d.z * n.z, s = px + py, t = s + pz;
  skf_vd low = vd_lost(px, -py, s) + vd_lost(s, -pz, t) + vd3_dot(lo, n);
  low += vd_fms(d.x, n.x, px) + vd_fms(d.y, n.y, py) + vd_fms(d.z, n.z, pz);
  return (t + low) * c->per_length;
}

/* From F and h; the slope is -2 pi z h. */
SKF_INLINE skf_vvalue plane_result(const plane_row *c, skf_vd z, skf_vd F, skf_vd h, skf_vi good) {
  return (skf_vvalue){F, vd3_scale(vd_set(-2 * SKF_PI) * z * h, c->unit), good & (z - z == vd_set(0))};
}

SKF_INLINE skf_vvalue cauchy_plane(const plane_row *c, skf_v3d x) {
  skf_vd z = plane_height(c, x), W = vd_fma(c->param2, z * z, vd_set(1)), q = vd_set(1) / W;
  return plane_result(c, z, vd_set(SKF_PI) * c->per_param2 * q, q * q, vd_sane(W));
}

SKF_INLINE skf_vvalue gaussian_plane(const plane_row *c, skf_v3d x) {
  skf_vd z = plane_height(c, x), y = c->param2 * z * z, most = vd_set(VD_EXP_MAX);
  skf_vi inside = y<most, beyond = y> vd_set(VD_EXP_ZERO);
  skf_vd h = (skf_vd)((skf_vi)vd_exp(-vd_min(y, most)) & inside);
  return plane_result(c, z, vd_set(SKF_PI) * c->per_param2 * h, h, inside | beyond);
}

SKF_INLINE skf_vvalue inverse_plane(const plane_row *c, skf_v3d x) {
  skf_vd z = plane_height(c, x), sign = vd_select(z > vd_set(0), vd_set(1), vd_select(z < vd_set(0), vd_set(-1), z));
  return plane_result(c, sign, vd_set(-2 * SKF_PI) * vd_abs(z), vd_set(1), z - z == vd_set(0));
}

SKF_INLINE skf_vvalue inverse_squared_plane(const plane_row *c, skf_v3d x) {
  skf_vd z = plane_height(c, x), a = vd_abs(z), one = vd_set(1), n = vd_max(a, one), d = vd_min(a, one);
  skf_vd log = vd_log_ratio(n, d, n - d), F = vd_set(2 * SKF_PI) * vd_select(a > one, -log, log);
  return plane_result(c, one / z, F, one, vd_sane(z));
}

SKF_INLINE skf_vvalue metaball_plane(const plane_row *c, skf_v3d x) {
  skf_vd z = plane_height(c, x), a = vd_abs(z), R = c->param, m = vd_max(R - a, vd_set(0)) * c->per_param;
  skf_vd one = vd_set(1), u = a * a * c->per_param2, three = vd_set(3);
  skf_vi core = three * a <= R;
  skf_vd inner = vd_fnma(u, vd_fnma(vd_set(1.5), u, one), vd_set(13. / 54)), outer = m * m * m;
  skf_vd F = vd_select(core, inner, outer * vd_fnma(vd_set(0.75), m, one));
  skf_vd h = vd_select(core, vd_fnma(three, u, one), vd_set(1.5) * m * m);
  return plane_result(c, z, vd_set(SKF_PI) * c->param2 * F, h, vi_set(-1));
}

/* m^2 (c2 + c3 m), m = 1 - r^2 / R^2 */
SKF_INLINE skf_vvalue polynomial_plane(const plane_row *c, skf_v3d x, double c2, double c3) {
  skf_vd z = plane_height(c, x), R = c->param, q = (R - z) * (R + z), m = vd_max(q, vd_set(0)) * c->per_param2;
  skf_vd mm = m * m, F = mm * m * vd_fma(vd_set(c3 / 4), m, vd_set(c2 / 3));
  return plane_result(c, z, vd_set(SKF_PI) * c->param2 * F, mm * vd_fma(vd_set(c3), m, vd_set(c2)), vi_set(-1));
}

SKF_INLINE skf_vvalue quartic_plane(const plane_row *c, skf_v3d x) { return polynomial_plane(c, x, 1, 0); }
SKF_INLINE skf_vvalue soft_object_plane(const plane_row *c, skf_v3d x) {
  return polynomial_plane(c, x, 5. / 9, 4. / 9);
}

SKF_BATCH_FORM(cauchy_plane, plane, skf_again_none)
SKF_BATCH_FORM(gaussian_plane, plane, skf_again_none)
SKF_BATCH_FORM(inverse_plane, plane, skf_again_none)
SKF_BATCH_FORM(inverse_squared_plane, plane, skf_again_none)
SKF_BATCH_FORM(metaball_plane, plane, skf_again_none)
SKF_BATCH_FORM(soft_object_plane, plane, skf_again_none)
SKF_BATCH_FORM(quartic_plane, plane, skf_again_none)

#endif
