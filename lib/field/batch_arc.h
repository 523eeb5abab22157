/* SPDX-License-Identifier: MIT */
/* Vector forms: kernels along an arc or a circle. The geometry is that of arc_frame.c; points next to the circle, where
   it needs double-double, are left to the closed form. */
#ifndef SKF_FIELD_BATCH_ARC_H
#define SKF_FIELD_BATCH_ARC_H

#include "field/batch_span.h"

typedef struct arc_view {
  skf_vd k, z, ux, uy, inner, outer, alpha, beta;
  skf_vi good;
} arc_view;

SKF_INLINE arc_view arc_see(const skf_prepared *e, skf_v3d x) {
  const skf_arc_plan *a = &e->plan.arc;
  skf_v3d d = vd3_sub(x, vd3_set(e->primitive.arc.center));
  skf_vd u = vd3_dot(d, vd3_set(a->e)), v = vd3_dot(d, vd3_set(a->f)), rho = vd_set(a->radius), zero = vd_set(0);
  arc_view f = {.k = vd_sqrt(vd_fma(u, u, v * v)), .z = vd3_dot(d, vd3_set(a->n))};
  skf_vi off = f.k > zero; /* the axis */
  skf_vd per = vd_set(1) / vd_select(off, f.k, rho);
  f.ux = vd_select(off, u * per, vd_set(1));
  f.uy = vd_select(off, v * per, zero);
  f.inner = f.k - rho, f.outer = f.k + rho;
  f.alpha = vd_fma(f.inner, f.inner, f.z * f.z);
  f.beta = vd_fma(f.outer, f.outer, f.z * f.z);
  f.good = (vd_set(1024) * f.alpha > f.outer * f.outer) & vd_sane(f.beta);
  return f;
}

/* From int h, int g cos^2 chi, int g sin^2 chi and the ends' share, as skf_arc_gather and skf_arc_result. */
SKF_INLINE skf_vvalue arc_finish(const skf_prepared *e, const arc_view *f, skf_vd F, skf_vd cc, skf_vd ss, skf_vd ends,
                                 skf_vi good) {
  const skf_arc_plan *a = &e->plan.arc;
  skf_vd k = vd_fma(f->inner, cc, f->outer * ss);
  skf_v3d g = vd3_scale(vd_fma(k, f->ux, -(ends * f->uy)), vd3_set(a->e));
  g = vd3_mad(g, vd_fma(k, f->uy, ends * f->ux), vd3_set(a->f));
  return (skf_vvalue){F, vd3_mad(g, f->z * (cc + ss), vd3_set(a->n)), good & f->good};
}

/* The span of an arc that is no circle, N and W = 1 + s^2 r^2 at its ends; from the antipode of x cos and sin change
   places. */
SKF_INLINE span_view arc_span(const skf_prepared *e, const arc_view *f, skf_vd Pm, skf_vd Pp, skf_vd D, skf_vd *W_sum,
                              skf_vd *sin_mid) {
  const skf_arc_plan *a = &e->plan.arc;
  skf_vd S = vd_set(a->sin_half), C = vd_set(a->cos_half);
  skf_vi behind = f->ux < vd_set(0);
  skf_vd uy = vd_select(behind, -f->uy, f->uy), cb = vd_sqrt(vd_fma(vd_set(0.5), vd_abs(f->ux), vd_set(0.5)));
  skf_vd sb = vd_set(-0.5) * uy / cb, c1 = vd_fma(C, cb, -(S * sb)), s1 = vd_fma(S, cb, C * sb);
  skf_vd P = vd_select(behind, Pp, Pm), Q = vd_select(behind, Pm, Pp); /* W = P cos^2 + Q sin^2 */
  skf_vd W0 = vd_fma(P, cb * cb, Q * (sb * sb)), W1 = vd_fma(P, c1 * c1, Q * (s1 * s1));
  skf_vd u = P * (cb * c1), v = Q * (sb * s1), cos_sigma = u - v;
  *W_sum = W0 + W1;
  *sin_mid = vd_fma(S, f->ux, -(C * f->uy));
  return span_see(D * S, u + v, vd_sqrt(W0 * W1), vd_select(behind, -cos_sigma, cos_sigma), D * *sin_mid);
}

SKF_INLINE skf_vvalue cauchy_arc(const skf_prepared *e, skf_v3d x) {
  double s2 = e->kernel.param * e->kernel.param, rho = e->plan.arc.radius;
  arc_view f = arc_see(e, x);
  skf_vd one = vd_set(1), Pm = vd_fma(vd_set(s2), f.alpha, one), Pp = vd_fma(vd_set(s2), f.beta, one), PP = Pm * Pp;
  skf_vd D = vd_sqrt(PP), per_D = one / D, per = per_D * per_D, im = Pp * per, ip = Pm * per;
  skf_vd c2 = vd_set(SKF_PI / 2), sq = c2, c4 = vd_set(3 * SKF_PI / 8), s4 = c4, mixed = vd_set(SKF_PI / 8);
  skf_vd ends = vd_set(0);
  skf_vi good = vd_sane(PP);
  if (!e->plan.arc.full) {
    skf_vd W_sum, sin_mid;
    span_view a = arc_span(e, &f, Pm, Pp, D, &W_sum, &sin_mid);
    c2 = span_second(&a, a.c), sq = span_second(&a, a.s);
    c4 = span_fourth(&a, a.c), s4 = span_fourth(&a, a.s), mixed = span_mixed(&a);
    skf_vd per_N2 = a.per_N * a.per_N;
    ends = vd_set(4 * rho * rho * s2 * e->plan.arc.sin_half) * sin_mid * W_sum * (per_N2 * per_N2);
    good &= a.good;
  }
  skf_vd G = vd_set(-8 * s2 * rho) * per_D, F = vd_set(2 * rho) * per_D * vd_fma(c2, im, sq * ip);
  return arc_finish(e, &f, F, G * im * vd_fma(c4, im, mixed * ip), G * ip * vd_fma(mixed, im, s4 * ip), ends, good);
}

/* A circle, by the arithmetic-geometric mean of skf_elliptic_complete: da / db >= 1/33, so that five steps are
   enough. */
SKF_INLINE skf_vvalue inverse_circle(const skf_prepared *e, skf_v3d x) {
  double rho = e->plan.arc.radius;
  arc_view f = arc_see(e, x);
  skf_vd da = vd_sqrt(f.alpha), db = vd_sqrt(f.beta), one = vd_set(1), half = vd_set(0.5), per_db = one / db;
  skf_vd kp = da * per_db, rest = vd_set(4 * rho) * f.k * per_db / (da + db); /* 1 - kp */
  skf_vd a = half * (one + kp), g = vd_sqrt(kp), c = half * rest, E = vd_set(0.25) * rest / (one + kp), t = one;
  skf_vd S = half + E;
  for (int i = 0; i < 5; i++) {
    skf_vd next = half * (a + g), q = vd_set(0.25) * c / next;
    g = vd_sqrt(a * g);
    a = next;
    E *= q * q;
    c *= q;
    t += t;
    S = vd_fma(t, E, S);
  }
  skf_vd K = vd_set(SKF_PI * 2 * rho) * per_db / a, sin2 = K * S; /* 4 rho / db times the integrals */
  skf_vd cc = (sin2 - K) / f.alpha, ss = -(sin2 * (per_db * per_db));
  return arc_finish(e, &f, K, cc, ss, vd_set(0), vd_sane(f.alpha));
}

SKF_BATCH_LOOP(cauchy_arc)
SKF_BATCH_LOOP(inverse_circle)

/* Other arcs need Carlson's forms. */
static size_t batch_inverse_arc(const skf_prepared *e, size_t n, const double *const p[3], double *const out[4],
                                unsigned char *redo) {
  if (e->plan.arc.full) return batch_inverse_circle(e, n, p, out, redo);
  for (size_t i = 0; i < n; i++) redo[i] = (unsigned char)i;
  return n;
}

#endif
