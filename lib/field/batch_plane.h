/* SPDX-License-Identifier: MIT */
/* Vector forms: the kernels over a plane, as in each kernel's file: functions of the height z over it. */
#ifndef SKF_FIELD_BATCH_PLANE_H
#define SKF_FIELD_BATCH_PLANE_H

#include "field/batch_loop.h"

/* The height of x is unit . x - offset, rounded from exact ones; slack, near: see plane_sure, plane_near; axis: that
   of the normal, or -1 where it is along none, and its coordinate of `through`; along: the normal times -2 pi and the
   strength, for Gaussians times -2 / log2(e), for 1 / r^2 the unit normal; s or R, its square, 1 / both; the strength
   times pi s^-2 or pi R^2, and times -2 pi. Which side is above does not matter: along an axis it is where its
   coordinate is larger. */
typedef struct plane_row {
  skf_v3d through, raw, unit, along;
  skf_vd offset, offset2, slack, near, axis, at, per_length, param, param2, per_param, per_param2, exponent, F, slope;
} plane_row;

/* Heights are taken with care where their partial sums are PLANE_CANCEL^(1/2) times as large, if that is also some 250
   times as large as the kernel is wide. */
enum { PLANE_CANCEL = 250000 };

/* The unit normal, rounded once, and what n . through is exactly, rounded twice */
static double plane_offset(const skf_prepared *e, skf_vec3 *unit) {
  const skf_vec3 n = e->plan.plane.raw, zero = {0, 0, 0};
  const long double x = n.x, y = n.y, z = n.z, length = sqrtl(x * x + y * y + z * z);
  const double at = dd3_dot_d(dd3_diff(e->primitive.plane.through, zero), n);
  *unit = v3((double)(x / length), (double)(y / length), (double)(z / length));
  return (double)(at / length);
}

/* Above this the whole part of a Gaussian's exponent is such that F times it is a normal number */
static double plane_near(double F) {
  const double size = fabs(F), shift = VD_EXP2_SHIFT, least = SKF_PICK(-1009, -123);
  if ((int)SKF_PICK(0, 1)) return shift + least;
  return size > 1e-280 && size < 1e280 ? shift + fmax(least, -1015 - ilogb(F)) : INFINITY;
}

static double *plane_pack(const skf_prepared *e, double *k) {
  const skf_plane_plan *p = &e->plan.plane;
  const skf_kernel_type type = e->kernel.type;
  const double aa = e->kernel.param * e->kernel.param, pi = SKF_PI * e->strength;
  const bool aligned = (p->raw.x != 0) + (p->raw.y != 0) + (p->raw.z != 0) == 1,
             compact = skf_kernel_get(type)->compact;
  const int axis = p->raw.x != 0 ? 0 : p->raw.y != 0 ? 1 : 2;
  const double exponent = (double)exponent_of(e->kernel.param), at = v3_get(e->primitive.plane.through, axis);
  const double width2 = compact ? aa : type == SKF_CAUCHY || type == SKF_GAUSSIAN ? 1 / aa : 0;
  const double F = compact ? pi * aa : pi / aa;
  skf_vec3 unit;
  double offset = plane_offset(e, &unit);
  if (aligned) unit = v3(axis == 0, axis == 1, axis == 2), offset = at;
  offset = offset == 0 ? -0. : offset; /* x - offset is never -0 */
  k = pack3(pack3(pack3(k, e->primitive.plane.through), p->raw), unit);
  k = pack3(k, v3_scale(type == SKF_INVERSE_SQUARED ? 1 : type == SKF_GAUSSIAN ? -2 * aa / exponent : -2 * pi, unit));
  k = pack1(pack1(pack1(k, offset), offset * offset), PLANE_CANCEL / 4. * width2);
  k = pack1(k, plane_near(F));
  k = pack1(pack1(k, aligned ? axis : -1), aligned ? offset : at);
  k = pack1(pack_parameter(pack1(k, 1 / p->length), e), exponent);
  return pack1(pack1(k, F), -2 * pi);
}

/* raw . (x - through) as if in twice the digits */
SKF_INLINE skf_vd plane_careful(const plane_row *c, skf_v3d x) {
  const skf_v3d d = vd3_sub(x, c->through), lo = vd3_lost(x, c->through, d), n = c->raw;
  const skf_vd px = d.x * n.x, py = d.y * n.y, pz = d.z * n.z, s = px + py, t = s + pz;
  skf_vd low = vd_lost(px, -py, s) + vd_lost(s, -pz, t) + vd3_dot(lo, n);
  low += vd_fms(d.x, n.x, px) + vd_fms(d.y, n.y, py) + vd_fms(d.z, n.z, pz);
  return t + low;
}

/* Heights of n vectors, and offset^2 and the squares of their partial sums, for each */
SKF_INLINE void plane_heights(const plane_row *c, size_t n, const skf_v3d *x, skf_vd *z, skf_vd *sum) {
  SKF_EACH(u, n) z[u] = vd_fms(x[u].x, c->unit.x, c->offset);
  SKF_EACH(u, n) sum[u] = vd_fma(z[u], z[u], c->offset2);
  SKF_EACH(u, n) z[u] = vd_fma(x[u].y, c->unit.y, z[u]);
  SKF_EACH(u, n) sum[u] = vd_fma(z[u], z[u], sum[u]);
  SKF_EACH(u, n) z[u] = vd_fma(x[u].z, c->unit.z, z[u]);
}

/* The lanes where no height loses more in what cancels than field.h grants, nor is NaN. An error of a small part of the
   kernel's width changes nothing, wherever x is. For floats rounding x does more. */
SKF_INLINE skf_vi plane_sure(const plane_row *c, size_t n, const skf_vd *z, const skf_vd *sum) {
  skf_vi sure = vi_set(-1);
  if ((int)SKF_PICK(0, 1)) return sure;
  SKF_EACH(u, n) sure &= sum[u] < vd_fma(vd_set(PLANE_CANCEL) * z[u], z[u], c->slack);
  return sure;
}
/* The same for Gaussians, of which nothing is left at heights of some widths, so that they need not be compared: where
   all sums together are small enough, each is. */
SKF_INLINE skf_vi plane_sure_near(const plane_row *c, size_t n, const skf_vd *sum) {
  if ((int)SKF_PICK(0, 1)) return vi_set(-1);
  return vd_total(n, sum) < c->slack;
}

/* Signed height. Where the normal is along an axis it is exact but for the last rounding. Else the plain sum may lose
   some ulps of what cancels in it, less than eight ulps of x change: careful ones are taken where that is too much. */
SKF_INLINE skf_vi plane_aligned(const plane_row *c) { return c->axis > vd_set(-0.5); }
SKF_INLINE skf_vd plane_measure_by(const plane_row *c, bool near, skf_v3d x) {
  const skf_vd zero = vd_set(0);
  const skf_vi aligned = plane_aligned(c);
  skf_vd z, sum; /* what plane_gauge does not read is 0 */
  x.x = vd_select(aligned & (c->unit.x == zero), zero, x.x);
  x.y = vd_select(aligned & (c->unit.y == zero), zero, x.y);
  x.z = vd_select(aligned & (c->unit.z == zero), zero, x.z);
  plane_heights(c, 1, &x, &z, &sum);
  const skf_vi sure = aligned | (near ? plane_sure_near(c, 1, &sum) : plane_sure(c, 1, &z, &sum));
  return vi_all(sure) ? z : vd_select(sure, z, plane_careful(c, x) * c->per_length);
}
SKF_INLINE skf_vi plane_gauge_by(const plane_row *c, bool near, int mode, size_t n, const skf_v3d *x, skf_vd *z) {
  if (mode == SKF_PLAIN) {
    SKF_EACH(u, n) z[u] = x[u].x - c->at;
    return vi_set(-1);
  }
  skf_vd sum[4];
  plane_heights(c, n, x, z, sum);
  return near ? plane_sure_near(c, n, sum) : plane_sure(c, n, z, sum);
}
#define plane_measure(row, x)                plane_measure_by(row, false, x)
#define plane_gauge(row, mode, n, x, z)      plane_gauge_by(row, false, mode, n, x, z)
#define near_plane_measure(row, x)           plane_measure_by(row, true, x)
#define near_plane_gauge(row, mode, n, x, z) plane_gauge_by(row, true, mode, n, x, z)
#define plane_early                          true
#define near_plane_early                     false /* its chains are short: registers matter more */
#define near_plane_mode(row)                 plane_mode(row)
#define near_plane_first(row, p)             plane_first(row, p)
#define near_plane_along(row, k, q)          plane_along(row, k, q)
#define plane_mode(row)                      (vi_all(plane_aligned(row)) ? SKF_PLAIN : SKF_MIXED)
#define plane_first(row, p)                  ((p)[vi_all(plane_aligned(row)) ? (int)(row)->axis[0] : 0])
#define plane_along(row, k, q)               ((row)->along.k)

/* Where all are finite: 0 times them, added, is 0 */
SKF_INLINE skf_vi plane_finite(size_t n, const skf_vd *z) {
  const skf_vd zero = vd_set(0);
  skf_vd sum = z[0] * zero;
  for (size_t u = 1; u < n; u++) sum = vd_fma(z[u], zero, sum);
  return sum == zero;
}

/* slope = z h, for Gaussians z F times the exponent */
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

typedef struct gaussian_plane_state {
  skf_vd y; /* z times the exponent */
  skf_vpower h;
} gaussian_plane_state;
SKF_INLINE void gaussian_plane_begin(const plane_row *c, skf_vd z, gaussian_plane_state *s) {
  s->y = c->exponent * z, s->h = vd_exp2_begin(s->y, z);
}
SKF_INLINE void gaussian_plane_middle(const plane_row *c, gaussian_plane_state *s) {
  (void)c;
  vd_exp2_middle(&s->h);
}
SKF_INLINE void gaussian_plane_late(const plane_row *c, gaussian_plane_state *s) {
  (void)c;
  vd_exp2_late(&s->h);
}
SKF_INLINE skf_vi gaussian_plane_end(const plane_row *c, const gaussian_plane_state *s, skf_vd *F, skf_vd *slope) {
  *F = vd_exp2_times(&s->h, c->F), *slope = s->y * *F;
  return s->h.whole > c->near;
}
SKF_INLINE skf_vvalue gaussian_plane_gone(const plane_row *c, skf_v3d x) {
  const skf_vd zero = vd_set(0), z = near_plane_measure(c, x);
  return (skf_vvalue){zero, {zero, zero, zero}, vd_gaussian_gone(c->exponent * z, z)};
}

SKF_INLINE skf_vi inverse_plane_of(const plane_row *c, size_t n, const skf_vd *z, skf_vd *F, skf_vd *slope) {
  const skf_vd zero = vd_set(0);
  SKF_EACH(u, n) F[u] = c->slope * vd_abs(z[u]);
  SKF_EACH(u, n) slope[u] = vd_select(z[u] == zero, zero, (skf_vd)((skf_vi)vd_set(1) ^ vd_sign(z[u])));
  return plane_finite(n, z);
}

typedef struct inverse_squared_plane_state {
  skf_vd z;   /* then the slope */
  skf_vlog l; /* top: then the quotient */
} inverse_squared_plane_state;
SKF_INLINE void inverse_squared_plane_begin(const plane_row *c, skf_vd z, inverse_squared_plane_state *s) {
  (void)c;
  s->z = z, s->l = vd_log_one(vd_abs(z));
}
SKF_INLINE void inverse_squared_plane_middle(const plane_row *c, inverse_squared_plane_state *s) {
  s->l.top = s->l.top / s->l.bottom;
  s->z = c->slope / s->z;
}
SKF_INLINE void inverse_squared_plane_late(const plane_row *c, inverse_squared_plane_state *s) {
  s->l.top = c->slope * vd_log_one_series(s->l.count, s->l.top);
}
SKF_INLINE skf_vi inverse_squared_plane_end(const plane_row *c, const inverse_squared_plane_state *s, skf_vd *F,
                                            skf_vd *slope) {
  (void)c;
  const skf_vd count = s->l.count; /* of what is tiny, huge or NaN, large */
  *F = s->l.top, *slope = s->z;
  return vd_abs(count) < vd_set(SKF_PICK(460, 60) * VD_LOG_UNIT);
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
  skf_vd m[4], mm[4];
  SKF_EACH(u, n) m[u] = vd_max((c->param - z[u]) * (c->param + z[u]), vd_set(0)) * c->per_param2;
  SKF_EACH(u, n) mm[u] = m[u] * m[u];
  SKF_EACH(u, n) {
    const skf_vd cubes = vd_set(c2 / 3) * c->F;
    F[u] = mm[u] * m[u] * (c3 != 0 ? vd_fma(vd_set(c3 / 4) * c->F, m[u], cubes) : cubes);
  }
  SKF_EACH(u, n) slope[u] = z[u] * (c3 != 0 || c2 != 1 ? mm[u] * vd_fma(vd_set(c3), m[u], vd_set(c2)) : mm[u]);
  return plane_finite(n, z);
}

SKF_INLINE skf_vi quartic_plane_of(const plane_row *c, size_t n, const skf_vd *z, skf_vd *F, skf_vd *slope) {
  return polynomial_plane(c, n, z, F, slope, 1, 0);
}
SKF_INLINE skf_vi soft_object_plane_of(const plane_row *c, size_t n, const skf_vd *z, skf_vd *F, skf_vd *slope) {
  return polynomial_plane(c, n, z, F, slope, 5. / 9, 4. / 9);
}

SKF_BATCH_MEASURED(cauchy_plane, plane, plane, skf_again_none)
SKF_BATCH_PIPED(gaussian_plane, plane, near_plane, gaussian_plane_gone)
SKF_BATCH_MEASURED(inverse_plane, plane, plane, skf_again_none)
SKF_BATCH_PIPED(inverse_squared_plane, plane, plane, skf_again_none)
SKF_BATCH_MEASURED(metaball_plane, plane, plane, skf_again_none)
SKF_BATCH_MEASURED(soft_object_plane, plane, plane, skf_again_none)
SKF_BATCH_MEASURED(quartic_plane, plane, plane, skf_again_none)

#endif
