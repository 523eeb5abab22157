/* SPDX-License-Identifier: MIT */
/* Vector forms: kernels along a segment. The geometry is that of segment_frame.c, its exact branch taken closer to the
   axis: with fused products the plain one loses |d| / h of an ulp only. */
#ifndef SKF_FIELD_BATCH_SEGMENT_H
#define SKF_FIELD_BATCH_SEGMENT_H

#include "field/batch_span.h"

/* n = d x e from the nearer end: w = e x n / L^2 points from the axis to x, h = |n| / L. */
typedef struct segment_view {
  skf_v3d d0, d1, n;
  skf_vd n0, n1, n2; /* squared lengths */
} segment_view;

SKF_INLINE segment_view segment_see(const skf_prepared *e, skf_v3d x) {
  const skf_segment *at = &e->primitive.segment;
  const skf_segment_plan *s = &e->plan.segment;
  skf_v3d from = vd3_set(at->from), to = vd3_set(at->to), axis = vd3_set(s->e);
  segment_view f = {.d0 = vd3_sub(x, from), .d1 = vd3_sub(x, to)};
  f.n0 = vd3_dot(f.d0, f.d0), f.n1 = vd3_dot(f.d1, f.d1);
  skf_vi near1 = f.n1 < f.n0;
  skf_v3d d = vd3_select(near1, f.d1, f.d0);
  f.n = vd3_cross(d, axis);
  f.n2 = vd3_dot(f.n, f.n);
  skf_vi close = vd_set(256) * f.n2 < vd_min(f.n0, f.n1) * vd_set(s->length * s->length);
  if (vi_any(close)) {
    skf_v3d lo = vd3_lost(x, vd3_select(near1, to, from), d);
    f.n = vd3_select(close, vd3_add(f.n, vd3_add(vd3_cross(lo, axis), vd3_cross(d, vd3_set(s->e_lo)))), f.n);
    f.n2 = vd3_dot(f.n, f.n);
  }
  return f;
}

/* grad F = ends a + g w */
SKF_INLINE skf_v3d segment_gradient(const skf_prepared *e, const segment_view *f, skf_vd g, skf_vd ends) {
  const skf_segment_plan *s = &e->plan.segment;
  skf_v3d w = vd3_cross(vd3_set(s->e), f->n);
  return vd3_mad(vd3_scale(ends, vd3_set(s->a)), g * vd_set(1 / (s->length * s->length)), w);
}

/* With S = r0 + r1: F = log((S + L)^2 / D), D = S^2 - L^2 = 2 (r0 r1 + d0 d1) = 2 n^2 / (r0 r1 - d0 d1), whichever does
   not cancel; int g dt = -2 L S / (D r0 r1). */
SKF_INLINE skf_vvalue inverse_segment(const skf_prepared *e, skf_v3d x) {
  segment_view f = segment_see(e, x);
  skf_vd L = vd_set(e->plan.segment.length), r0 = vd_sqrt(f.n0), r1 = vd_sqrt(f.n1), rr = r0 * r1, S = r0 + r1;
  skf_vd dot = vd3_dot(f.d0, f.d1), up = vd_abs(dot) + rr, two = vd_set(2);
  skf_vi between = dot < vd_set(0);
  skf_vd D = vd_select(between, two * f.n2, two * up), per = vd_select(between, up, vd_set(1)); /* D / per */
  skf_vd far = (S + L) * per, F = vd_log_ratio((S + L) * far, D, two * L * far);
  skf_vd sum = -vd3_dot(vd3_add(f.d0, f.d1), vd3_set(e->plan.segment.a)); /* t0 + t1 */
  skf_vd bottom = D * (rr * S), inv = vd_set(1) / bottom;
  skf_vd g = vd_set(-2) * L * (S * S) * per * inv, ends = L * sum * D * inv;
  return (skf_vvalue){F, segment_gradient(e, &f, g, ends), vd_sane(bottom) & vd_sane(D) & vd_sane(far)};
}

/* cauchy.c's segment, the quotients gathered into two. */
SKF_INLINE skf_vvalue cauchy_segment(const skf_prepared *e, skf_v3d x) {
  const skf_segment_plan *s = &e->plan.segment;
  double p = e->kernel.param, L = s->length, p2 = p * p;
  segment_view f = segment_see(e, x);
  skf_vd one = vd_set(1), P2 = vd_fma(vd_set(p2 / (L * L)), f.n2, one), P = vd_sqrt(P2);
  skf_vd W0 = vd_fma(vd_set(p2), f.n0, one), W1 = vd_fma(vd_set(p2), f.n1, one), N = vd_sqrt(W0 * W1);
  skf_vd t0 = -vd3_dot(f.d0, vd3_set(s->a)), t1 = -vd3_dot(f.d1, vd3_set(s->a)), sum = t0 + t1;
  skf_vd tt = vd_set(p2) * t0 * t1;
  span_view a = span_see(vd_set(p * L) * P, P2 + tt, N, P2 - tt, vd_set(p) * P * sum);
  skf_vd per = one / (P * P2), F = vd_set(1 / p) * span_second(&a, a.c) * per;
  skf_vd g = vd_set(-4 * p) * span_fourth(&a, a.c) * (per * per * P);
  skf_vd per_N2 = a.per_N * a.per_N, ends = vd_set(p2 * L) * sum * (W0 + W1) * (per_N2 * per_N2);
  return (skf_vvalue){F, segment_gradient(e, &f, g, ends), a.good & vd_sane(P * P2)};
}

SKF_BATCH_LOOP(inverse_segment)
SKF_BATCH_LOOP(cauchy_segment)

#endif
