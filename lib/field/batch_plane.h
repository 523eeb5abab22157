/* SPDX-License-Identifier: MIT */
/* Vector forms: the kernels over a plane, as in each kernel's file: functions of the height z over it. */
#ifndef SKF_FIELD_BATCH_PLANE_H
#define SKF_FIELD_BATCH_PLANE_H

#include "field/batch_loop.h"

/* aligned: 1 where the normal is along an axis, else 0; along: the normal times -2 pi and the strength, for Gaussians
   by the exponent, too; s or R, its square, 1 / both; the strength times pi s^-2 or pi R^2, and times -2 pi */
typedef struct plane_row {
  skf_v3d through, raw, unit, along;
  skf_vd aligned, per_length, param, param2, per_param, per_param2, exponent, F, slope;
} plane_row;

static double *plane_pack(const skf_prepared *e, double *k) {
  const skf_plane_plan *p = &e->plan.plane;
  const double aa = e->kernel.param * e->kernel.param, pi = SKF_PI * e->strength;
  double exponent;
  pack_exponent(&exponent, e->kernel.param);
  k = pack3(pack3(pack3(k, e->primitive.plane.through), p->raw), p->unit);
  k = pack3(k, v3_scale(-2 * pi / (e->kernel.type == SKF_GAUSSIAN ? exponent : 1), p->unit));
  k = pack1(k, (p->raw.x != 0) + (p->raw.y != 0) + (p->raw.z != 0) == 1);
  k = pack1(pack_parameter(pack1(k, 1 / p->length), e), exponent);
  return pack1(pack1(k, skf_kernel_get(e->kernel.type)->compact ? pi * aa : pi / aa), -2 * pi);
}

/* unit . (x - through): exact but for its last rounding where the normal is along an axis */
SKF_INLINE void plane_plain(const plane_row *c, size_t n, const skf_v3d *x, skf_vd *z) {
  SKF_EACH(u, n) z[u] = (x[u].x - c->through.x) * c->unit.x;
  SKF_EACH(u, n) z[u] = vd_fma(x[u].y - c->through.y, c->unit.y, z[u]);
  SKF_EACH(u, n) z[u] = vd_fma(x[u].z - c->through.z, c->unit.z, z[u]);
}

/* raw . (x - through) as if in twice the digits */
SKF_INLINE skf_vd plane_careful(const plane_row *c, skf_v3d x) {
  const skf_v3d d = vd3_sub(x, c->through), lo = vd3_lost(x, c->through, d), n = c->raw;
  const skf_vd px = d.x * n.x, py = d.y * n.y, pz = d.z * n.z, s = px + py, t = s + pz;
  skf_vd low = vd_lost(px, -py, s) + vd_lost(s, -pz, t) + vd3_dot(lo, n);
  low += vd_fms(d.x, n.x, px) + vd_fms(d.y, n.y, py) + vd_fms(d.z, n.z, pz);
  return t + low;
}

/* Signed height to a few ulps, however far x is from the plane's point; for floats, what rounding x leaves. Where the
   normal is along an axis nothing is lost. Else plain sums may lose an ulp or two of the distance from this point:
   careful ones are taken where it is, in the sum of coordinates, more than 32 heights. (By a call, and with a copy of
   the row, so that the loops keep their registers.) */
static __attribute__((noinline)) void plane_again(const plane_row *c, const skf_v3d *x, const skf_vi *enough,
                                                  skf_vd *z) {
  *z = vd_select(*enough, *z, plane_careful(c, *x) * c->per_length);
}
SKF_INLINE skf_vi plane_aligned(const plane_row *c) { return c->aligned > vd_set(SKF_PICK(0.5, -1)); }
/* Positive where a plain height is enough */
SKF_INLINE skf_vd plane_enough(const plane_row *c, skf_v3d x, skf_vd z) {
  const skf_v3d d = vd3_sub(x, c->through);
  return vd_fms(vd_set(32), vd_abs(z), vd_abs(d.x) + vd_abs(d.y) + vd_abs(d.z));
}
SKF_INLINE void plane_measure(const plane_row *c, int mode, size_t n, const skf_v3d *x, skf_vd *z) {
  skf_vd enough[4], least = vd_set(INFINITY);
  plane_plain(c, n, x, z);
  if (mode == SKF_PLAIN) return;
  SKF_EACH(u, n) enough[u] = plane_enough(c, x[u], z[u]);
  SKF_EACH(u, n) least = u ? vd_min(enough[u], least) : enough[u];
  if (vi_all((least > vd_set(0)) | plane_aligned(c))) return;
  SKF_EACH(u, n) {
    const skf_vi keep = (enough[u] > vd_set(0)) | plane_aligned(c);
    if (vi_all(keep)) continue;
    const plane_row row = *c;
    const skf_v3d at = x[u];
    skf_vd height = z[u];
    plane_again(&row, &at, &keep, &height);
    z[u] = height;
  }
}
#define plane_mode(row)        (vi_all(plane_aligned(row)) ? SKF_PLAIN : SKF_MIXED)
#define plane_along(row, k, q) ((row)->along.k)

SKF_INLINE skf_vi plane_finite(size_t n, const skf_vd *z) {
  skf_vi good = vi_set(-1);
  SKF_EACH(u, n) good &= z[u] - z[u] == vd_set(0);
  return good;
}

/* slope = z h, for Gaussians times the exponent */
SKF_INLINE skf_vi cauchy_plane_of(const plane_row *c, size_t n, const skf_vd *z, skf_vd *F, skf_vd *slope) {
  skf_vi good = vi_set(-1);
  skf_vd q[4];
  SKF_EACH(u, n) q[u] = vd_fma(c->param2, z[u] * z[u], vd_set(1));
  SKF_EACH(u, n) good &= q[u] < vd_set(SKF_PICK(1e140, 1e18));
  SKF_EACH(u, n) q[u] = vd_set(1) / q[u];
  SKF_EACH(u, n) F[u] = c->F * q[u];
  SKF_EACH(u, n) slope[u] = z[u] * (q[u] * q[u]);
  return good;
}

SKF_INLINE skf_vi gaussian_plane_of(const plane_row *c, size_t n, const skf_vd *z, skf_vd *F, skf_vd *slope) {
  skf_vd y[4], h[4];
  SKF_EACH(u, n) y[u] = c->exponent * z[u];
  const skf_vi good = vd_gaussians(n, y, z, h);
  SKF_EACH(u, n) F[u] = c->F * h[u];
  SKF_EACH(u, n) slope[u] = y[u] * h[u];
  return good;
}

SKF_INLINE skf_vi inverse_plane_of(const plane_row *c, size_t n, const skf_vd *z, skf_vd *F, skf_vd *slope) {
  const skf_vd zero = vd_set(0);
  SKF_EACH(u, n) F[u] = c->slope * vd_abs(z[u]);
  SKF_EACH(u, n) slope[u] = vd_select(z[u] == zero, zero, (skf_vd)((skf_vi)vd_set(1) ^ vd_sign(z[u])));
  return plane_finite(n, z);
}

SKF_INLINE skf_vi inverse_squared_plane_of(const plane_row *c, size_t n, const skf_vd *z, skf_vd *F, skf_vd *slope) {
  skf_vd powers = vd_set(0); /* of two: what is tiny, huge or NaN has large ones */
  skf_vlog l[4];
  SKF_EACH(u, n) l[u] = vd_log_one(vd_abs(z[u]));
  SKF_EACH(u, n) powers = vd_fma(l[u].count, l[u].count, powers);
  SKF_EACH(u, n) l[u].top = l[u].top / l[u].bottom;
  SKF_EACH(u, n) slope[u] = vd_set(1) / z[u];
  SKF_EACH(u, n) F[u] = c->slope * vd_log_series(l[u].count, l[u].top);
  return powers < vd_set(SKF_PICK(460 * 460, 60 * 60) * VD_LOG_UNIT * VD_LOG_UNIT);
}

SKF_INLINE skf_vi metaball_plane_of(const plane_row *c, size_t n, const skf_vd *z, skf_vd *F, skf_vd *slope) {
  const skf_vd one = vd_set(1), three = vd_set(3), R = c->param;
  SKF_EACH(u, n) {
    const skf_vd a = vd_abs(z[u]), m = vd_max(R - a, vd_set(0)) * c->per_param, s = a * a * c->per_param2;
    const skf_vi core = three * a <= R;
    const skf_vd inner = vd_fnma(s, vd_fnma(vd_set(1.5), s, one), vd_set(13. / 54)), outer = m * m * m;
    F[u] = c->F * vd_select(core, inner, outer * vd_fnma(vd_set(0.75), m, one));
    slope[u] = z[u] * vd_select(core, vd_fnma(three, s, one), vd_set(1.5) * m * m);
  }
  return plane_finite(n, z);
}

/* m^2 (c2 + c3 m), m = 1 - r^2 / R^2 */
SKF_INLINE skf_vi polynomial_plane(const plane_row *c, size_t n, const skf_vd *z, skf_vd *F, skf_vd *slope, double c2,
                                   double c3) {
  skf_vd m[4];
  SKF_EACH(u, n) m[u] = vd_max((c->param - z[u]) * (c->param + z[u]), vd_set(0)) * c->per_param2;
  SKF_EACH(u, n) F[u] = c->F * (m[u] * m[u] * m[u] * vd_fma(vd_set(c3 / 4), m[u], vd_set(c2 / 3)));
  SKF_EACH(u, n) slope[u] = z[u] * (m[u] * m[u] * vd_fma(vd_set(c3), m[u], vd_set(c2)));
  return plane_finite(n, z);
}

SKF_INLINE skf_vi quartic_plane_of(const plane_row *c, size_t n, const skf_vd *z, skf_vd *F, skf_vd *slope) {
  return polynomial_plane(c, n, z, F, slope, 1, 0);
}
SKF_INLINE skf_vi soft_object_plane_of(const plane_row *c, size_t n, const skf_vd *z, skf_vd *F, skf_vd *slope) {
  return polynomial_plane(c, n, z, F, slope, 5. / 9, 4. / 9);
}

SKF_BATCH_MEASURED(cauchy_plane, plane, plane, skf_again_none)
SKF_BATCH_MEASURED(gaussian_plane, plane, plane, skf_again_none)
SKF_BATCH_MEASURED(inverse_plane, plane, plane, skf_again_none)
SKF_BATCH_MEASURED(inverse_squared_plane, plane, plane, skf_again_none)
SKF_BATCH_MEASURED(metaball_plane, plane, plane, skf_again_none)
SKF_BATCH_MEASURED(soft_object_plane, plane, plane, skf_again_none)
SKF_BATCH_MEASURED(quartic_plane, plane, plane, skf_again_none)

#endif
