/* SPDX-License-Identifier: MIT */
/* Vector forms: 1 / r along an arc, 1 / r^2 along an arc or a circle, Gaussians along a circle. */
#ifndef SKF_FIELD_BATCH_ARC_SMOOTH_H
#define SKF_FIELD_BATCH_ARC_SMOOTH_H

#include "field/batch_arc.h"
#include "simd/vecspecial.h"

/* cos chi and sin chi at the ends, all with the same sign or none; from the antipode of x where it is behind. */
typedef struct ends_view {
  skf_vd c0, s0, c1, s1;
  skf_vd rise; /* sin^2 chi1 - sin^2 chi0 */
} ends_view;

SKF_INLINE ends_view arc_ends(const arc_row *c, const arc_view *f) {
  skf_vd S = c->S, C = c->C;
  skf_vi behind = f->ux < vd_set(0);
  skf_vd uy = vd_select(behind, -f->uy, f->uy), cb = vd_sqrt(vd_fma(vd_set(0.5), vd_abs(f->ux), vd_set(0.5)));
  skf_vd sb = vd_set(-0.5) * uy / cb, c1 = vd_fma(C, cb, -(S * sb)), s1 = vd_fma(S, cb, C * sb);
  return (ends_view){vd_select(behind, sb, cb), vd_select(behind, -cb, sb), vd_select(behind, s1, c1),
                     vd_select(behind, -c1, s1), S * vd_fma(S, f->ux, -(C * f->uy))};
}

/* int dchi / r = R_F(U1^2, U2^2, U3^2) and int cos^2 chi / r^3 dchi = R_D / 3 + c0 c1 / (r0 r1 U3) with U1 = cs u,
   U2 = ds u, U3 = ns u times da, u the difference of the elliptic arguments at the ends [DLMF 19.29.4, 19.25.35]. The
   addition theorem [DLMF 22.8] gives them for any sweep; beyond a quarter period, where U1 < 0, u is measured from the
   half period. Each is written in two ways, so that terms of one sign are added where the ends are in one quadrant and
   where a multiple of pi / 2 lies between them. */
SKF_INLINE skf_vvalue inverse_arc_by(const arc_row *c, skf_v3d x, int count) {
  arc_view f = arc_see(c, x);
  ends_view t = arc_ends(c, &f);
  skf_vd zero = vd_set(0), al = f.alpha, be = f.beta, spread = vd_set(4) * c->rho * f.k;
  skf_vd r0 = vd_sqrt(vd_fma(al, t.c0 * t.c0, be * (t.s0 * t.s0))),
         r1 = vd_sqrt(vd_fma(al, t.c1 * t.c1, be * (t.s1 * t.s1)));
  skf_vd cc = t.c0 * t.c1, ss = t.s0 * t.s1, up = t.c0 * t.s1, down = t.c1 * t.s0, rr = r0 * r1;
  skf_vi apart = cc * ss < zero;
  skf_vd den = vd_select(apart, vd_fma(up, r0, -(down * r1)), t.rise), per = vd_set(1) / den;
  skf_vd one1 = vd_fma(t.c1 * t.s1, r0, t.c0 * t.s0 * r1), two1 = vd_fma(al, cc, ss * rr);
  skf_vd one2 = vd_fma(up, r1, down * r0), two2 = vd_fma(-spread, cc * ss, rr);
  skf_vd one3 = vd_fma(up, r0, down * r1), two3 = vd_fma(spread, ss * ss, al);
  skf_vd U1 = vd_select(apart, two1, one1) * per, U2 = vd_select(apart, two2, one2) * per,
         U3 = vd_select(apart, two3, one3) * per;
  skf_vcarlson v = vd_carlson(vd_abs(U1), U2, U3, count);
  skf_vi beyond = U1 < zero;
  skf_vd rho2 = c->rho + c->rho, I = v.rf, A = vd_set(1. / 3) * v.rd;
  if (vi_any(beyond)) {
    quarter_view q = arc_quarter(c, &f);
    skf_vd per_rho = vd_set(1) / rho2; /* twice a quarter's */
    I = vd_select(beyond, vd_fma(q.K, per_rho, -I), I);
    A = vd_select(beyond, vd_fma((q.K - q.sin2) / al, per_rho, -A), A);
  }
  A += cc / (rr * U3);
  skf_vd ends = rho2 * rho2 * t.rise / (rr * (r0 + r1));
  skf_vi good = vd_sane(rr) & vd_sane(U2) & vd_sane(U3) & (U2 > zero) & (U3 > zero) & v.good;
  return arc_finish(c, &f, rho2 * I, -(rho2 * A), -rho2 * vd_fma(-al, A, I) / be, ends, good);
}

SKF_OUTLINE skf_vvalue inverse_arc(const arc_row *c, skf_v3d x) { return inverse_arc_by(c, x, 5); }
SKF_OUTLINE skf_vvalue inverse_arc_slow(const arc_row *c, skf_v3d x) { return inverse_arc_by(c, x, 7); }

/* From delta, int cos^2 and int sin^2 of the span in which r^2 = alpha cos^2 chi + beta sin^2 chi is 1. */
SKF_INLINE skf_vvalue squared_gather(const arc_row *c, const arc_view *f, skf_vd per_D, skf_vd delta, skf_vd c2,
                                     skf_vd s2, skf_vd ends, skf_vi good) {
  skf_vd K = (c->rho + c->rho) * per_D, G = vd_set(-2) * K * (per_D * per_D);
  return arc_finish(c, f, K * delta, G * f->beta * c2, G * f->alpha * s2, ends, good);
}

SKF_INLINE skf_vvalue inverse_squared_arc(const arc_row *c, skf_v3d x) {
  arc_view f = arc_see(c, x);
  skf_vd DD = f.alpha * f.beta, D = vd_sqrt(DD), W_sum, sin_mid;
  span_view a = arc_span(c, &f, f.alpha, f.beta, D, &W_sum, &sin_mid);
  skf_vd ends = vd_set(4) * (c->rho * c->rho) * (c->S * sin_mid) * (a.per_N * a.per_N);
  return squared_gather(c, &f, vd_set(1) / D, a.delta, span_second(&a, a.c), span_second(&a, a.s), ends,
                        a.good & vd_sane(DD * D));
}

SKF_INLINE skf_vvalue inverse_squared_circle(const arc_row *c, skf_v3d x) {
  arc_view f = circle_see(c, x);
  skf_vd DD = f.alpha * f.beta, D = vd_sqrt(DD), half = vd_set(SKF_PI / 2);
  return squared_gather(c, &f, vd_set(1) / D, half + half, half, half, vd_set(0), vd_sane(DD * D));
}

/* gaussian.c's circle, b = 2 a^2 rho k. */
SKF_INLINE skf_vvalue gaussian_circle(const arc_row *c, skf_v3d x) {
  arc_view f = circle_see(c, x);
  skf_vd a2 = c->param2, rho = c->rho, b = vd_set(2) * a2 * rho * f.k, y = a2 * f.alpha, zero = vd_set(0), i0, radial;
  skf_vi near = b < vd_set(VD_BESSEL_NEAR), seen = y < vd_set(VD_EXP_MAX - VD_BESSEL_NEAR);
  skf_vi gone = (y > vd_set(VD_EXP_ZERO)) & (f.beta < vd_set(INFINITY));
  skf_vd e = vd_exp(-vd_min(vd_select(near, y + b, y), vd_set(VD_EXP_MAX)));
  e = (skf_vd)((skf_vi)(vd_set(2 * SKF_PI) * rho * e) & seen);
  skf_vbessel v = vd_bessel_near(vd_min(b, vd_set(VD_BESSEL_NEAR)));
  i0 = v.i0, radial = f.k * vd_fnma(a2 * rho, rho * v.other, v.i0);
  if (!vi_all(near)) {
    v = vd_bessel_far(vd_max(b, vd_set(VD_BESSEL_NEAR)));
    i0 = vd_select(near, i0, v.i0);
    radial = vd_select(near, radial, vd_fma(f.inner, v.i0, rho * v.other));
  }
  skf_vd F = e * i0, slope = vd_set(-2) * a2, k = slope * e * radial;
  skf_v3d g = vd3_mad(vd3_scale(k * f.ux, c->e), k * f.uy, c->f);
  /* next to the circle its distance is exact enough for a wide Gaussian */
  f.good |= a2 * (f.outer * f.outer) < vd_set(16);
  return (skf_vvalue){F, vd3_mad(g, slope * F * f.z, c->n), (seen & f.good & (b >= zero)) | gone};
}

SKF_BATCH_FORM(inverse_arc, arc, inverse_arc_slow)
SKF_BATCH_FORM(inverse_squared_arc, arc, skf_again_none)
SKF_BATCH_FORM(inverse_squared_circle, arc, skf_again_none)
SKF_BATCH_FORM(gaussian_circle, arc, skf_again_none)

#endif
