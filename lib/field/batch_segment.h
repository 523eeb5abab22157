/* SPDX-License-Identifier: MIT */
/* Vector forms: kernels along a segment. The geometry is that of segment_frame.c, its exact branch taken closer to the
   axis: with fused products the plain one loses |d| / h of an ulp only. */
#ifndef SKF_FIELD_BATCH_SEGMENT_H
#define SKF_FIELD_BATCH_SEGMENT_H

#include "field/batch_span.h"

/* As skf_segment_plan; per_L2 = 1 / L^2; the kernel's parameter, its square and inverse; the strength, for those that
   have it inside. */
typedef struct segment_row {
  skf_v3d from, to, e, e_lo, a;
  skf_vd L, L2, per_L2, param, param2, per_param, strength;
} segment_row;

static double *segment_pack(const skf_prepared *e, double *k) {
  const skf_segment *at = &e->primitive.segment;
  const skf_segment_plan *s = &e->plan.segment;
  double L2 = s->length * s->length, param = e->kernel.param;
  k = pack3(pack3(pack3(pack3(pack3(k, at->from), at->to), s->e), s->e_lo), s->a);
  k = pack1(pack1(pack1(k, s->length), L2), 1 / L2);
  k = pack1(pack1(pack1(k, param), param * param), 1 / param);
  return pack1(k, e->strength);
}

/* n = d x e from the nearer end: w = e x n / L^2 points from the axis to x, h = |n| / L. */
typedef struct segment_view {
  skf_v3d d0, d1, n;
  skf_vd n0, n1, n2; /* squared lengths */
} segment_view;

/* Returns whether the end is the nearer one. */
SKF_INLINE skf_vi segment_look(const segment_row *c, skf_v3d x, segment_view *f) {
  skf_v3d d0 = vd3_sub(x, c->from), d1 = vd3_sub(x, c->to);
  skf_vd n0 = vd3_dot(d0, d0), n1 = vd3_dot(d1, d1);
  skf_vi near1 = n1 < n0;
  skf_v3d n = vd3_cross(vd3_select(near1, d1, d0), c->e);
  f->d0 = d0, f->d1 = d1, f->n = n, f->n0 = n0, f->n1 = n1, f->n2 = vd3_dot(n, n);
  return near1;
}

/* Where n needs the points' lower halves; in floats the point is rounded by more. */
SKF_INLINE skf_vi segment_close(const segment_row *c, const segment_view *f) {
  skf_vi close = vd_set(256) * f->n2 < vd_min(f->n0, f->n1) * c->L2;
  return (int)SKF_PICK(1, 0) ? close : vi_set(0);
}

SKF_INLINE segment_view segment_see(const segment_row *c, skf_v3d x) {
  segment_view f;
  skf_vi near1 = segment_look(c, x, &f), close = segment_close(c, &f);
  if (vi_any(close)) {
    skf_v3d d = vd3_select(near1, f.d1, f.d0), lo = vd3_lost(x, vd3_select(near1, c->to, c->from), d);
    f.n = vd3_select(close, vd3_add(f.n, vd3_add(vd3_cross(lo, c->e), vd3_cross(d, c->e_lo))), f.n);
    f.n2 = vd3_dot(f.n, f.n);
  }
  return f;
}

/* grad F = ends a + g w */
SKF_INLINE skf_v3d segment_gradient(const segment_row *c, const segment_view *f, skf_vd g, skf_vd ends) {
  return vd3_mad(vd3_scale(ends, c->a), g * c->per_L2, vd3_cross(c->e, f->n));
}

/* With S = r0 + r1: F = log((S + L)^2 / D), D = S^2 - L^2 = 2 (r0 r1 + d0 d1), grad F = -2 L / D (d0 / r0 + d1 / r1).
   Seen from x the ends are less than 165 degrees apart, else D loses too much. */
#ifdef SKF_VEC_FLOAT
/* In floats without what rounding the point hides: d1 as d0 - e; half of the logarithm's arguments, so that nothing is
   doubled; the strength in the series. */
typedef struct inverse_segment_state {
  skf_v3d d0;
  skf_vd r0, r1, dot, count, t;
  skf_vi good;
} inverse_segment_state;

SKF_INLINE void inverse_segment_begin(const segment_row *c, skf_v3d x, inverse_segment_state *s) {
  skf_v3d d1 = vd3_sub(x, c->to);
  s->d0 = vd3_sub(x, c->from);
  s->r0 = vd_sqrt(vd3_dot(s->d0, s->d0)), s->r1 = vd_sqrt(vd3_dot(d1, d1));
  s->dot = vd3_dot(s->d0, d1);
}

SKF_INLINE void inverse_segment_middle(const segment_row *c, inverse_segment_state *s) {
  const skf_vd root = vd_set(0.70710678118654752);
  skf_vd rr = s->r0 * s->r1, near = rr + s->dot, far = vd_fma(root, s->r0 + s->r1, root * c->L);
  skf_vlog l = vd_log_parts(far * far, near, (root + root) * c->L * far);
  /* more than rr / 64, and neither is tiny or huge: near is twice rr at most */
  s->good = near > vd_fma(rr, vd_fma(rr, vd_set(1e-18), vd_set(1. / 64)), vd_set(1e-18));
  s->dot = -(c->strength * c->L) / (near * rr);
  s->t = l.top / l.bottom, s->count = l.count;
}

SKF_INLINE skf_vvalue inverse_segment_end(const segment_row *c, const inverse_segment_state *s) {
  skf_vd w = s->dot, F = vd_log_series_by(c->strength, s->count, s->t);
  return (skf_vvalue){F, vd3_less(vd3_scale(w * (s->r0 + s->r1), s->d0), w * s->r0, c->e), s->good};
}
#else
typedef struct inverse_segment_state {
  skf_v3d d0, d1;
  skf_vd r0, r1, dot; /* dot: then w of the gradient */
  skf_vd count, t;    /* of the logarithm, set in the middle */
  skf_vi good;
} inverse_segment_state;

SKF_INLINE void inverse_segment_begin(const segment_row *c, skf_v3d x, inverse_segment_state *s) {
  s->d0 = vd3_sub(x, c->from), s->d1 = vd3_sub(x, c->to);
  s->r0 = vd_sqrt(vd3_dot(s->d0, s->d0)), s->r1 = vd_sqrt(vd3_dot(s->d1, s->d1));
  s->dot = vd3_dot(s->d0, s->d1);
}

SKF_INLINE void inverse_segment_middle(const segment_row *c, inverse_segment_state *s) {
  skf_vd rr = s->r0 * s->r1, near = rr + s->dot, far = (s->r0 + s->r1) + c->L;
  skf_vlog l = vd_log_parts(far * far, near + near, (c->L + c->L) * far);
  s->good = (vd_set(32) * near > rr) & vd_sane(rr);
  s->dot = -(c->strength * c->L) / (near * rr);
  s->t = l.top / l.bottom, s->count = l.count;
}

SKF_INLINE skf_vvalue inverse_segment_end(const segment_row *c, const inverse_segment_state *s) {
  skf_vd w = s->dot, F = c->strength * vd_log_series(s->count, s->t);
  return (skf_vvalue){F, vd3_mad(vd3_scale(w * s->r1, s->d0), w * s->r0, s->d1), s->good};
}
#endif

/* D = 2 n^2 / (r0 r1 - d0 d1) where the sum cancels; int g dt = -2 L S / (D r0 r1). */
SKF_INLINE skf_vvalue inverse_segment_close(const segment_row *c, skf_v3d x) {
  segment_view f = segment_see(c, x);
  skf_vd L = c->L, r0 = vd_sqrt(f.n0), r1 = vd_sqrt(f.n1), rr = r0 * r1, S = r0 + r1;
  skf_vd dot = vd3_dot(f.d0, f.d1), up = vd_abs(dot) + rr, two = vd_set(2);
  skf_vi between = dot < vd_set(0);
  skf_vd D = vd_select(between, two * f.n2, two * up), per = vd_select(between, up, vd_set(1)); /* D / per */
  skf_vd far = (S + L) * per, F = vd_log_ratio((S + L) * far, D, two * L * far);
  skf_vd sum = -vd3_dot(vd3_add(f.d0, f.d1), c->a); /* t0 + t1 */
  skf_vd bottom = D * (rr * S), inv = vd_set(1) / bottom;
  skf_vd g = vd_set(-2) * L * (S * S) * per * inv, ends = L * sum * D * inv;
  skf_vvalue v = {F, segment_gradient(c, &f, g, ends), vd_sane(bottom) & vd_sane(D) & vd_sane(far)};
  return vv_scale(c->strength, v);
}

/* With abscissae T = s t from the foot of the perpendicular, P^2 = 1 + s^2 h^2, W = P^2 + T^2 and the angle delta
   between the ends, tan u = T / P: int dT / W = delta / P, int dT / W^2 = (delta / P + [T / W]) / (2 P^2), int dT / W^3
   = ([T / W^2] + 3 int dT / W^2) / (4 P^2), the brackets, differences between the ends, written without cancellation.
   They are negative beyond an end; where they would cancel the rest, more than 60 degrees from the perpendicular in u,
   and on the axis of a thin body, where w is not known well enough, the other form decides. */
typedef struct cauchy_span_row {
  segment_row at;
  skf_v3d tangent, back, along; /* s, 1 / s and the strength times the direction */
  skf_vd L, thin, F, g;         /* s times the length; where W is too large beside P^2; factors of the results */
} cauchy_span_row;

static double *cauchy_span_pack(const skf_prepared *e, double *k) {
  const skf_segment_plan *s = &e->plan.segment;
  double p = e->kernel.param, L = p * s->length, axis = 4 / L;
  k = segment_pack(e, k);
  k = pack3(pack3(pack3(k, v3_scale(p, s->a)), v3_scale(1 / p, s->a)), v3_scale(e->strength, s->a));
  k = pack1(pack1(k, L), fmin(axis * axis, 1e100) - 256);
  return pack1(pack1(k, e->strength / (2 * p)), -p * e->strength);
}

#ifdef SKF_VEC_FLOAT
/* In floats: what is too far away for a check at the start is so for that of W^2 P^2 at the end, too. */
typedef struct cauchy_segment_state {
  skf_v3d w;
  skf_vd T0, P2, WW;
  skf_vd P, per_WW, per_P2, offset, angle; /* set on the way; P: then its inverse */
} cauchy_segment_state;

SKF_INLINE void cauchy_segment_begin(const cauchy_span_row *c, skf_v3d x, cauchy_segment_state *s) {
  skf_v3d d = vd3_sub(x, c->at.from);
  skf_vd T = vd3_dot(d, c->tangent), T1 = c->L - T;
  skf_v3d w = vd3_less(d, T, c->back);
  skf_vd P2 = vd_fma(c->at.param2, vd3_dot(w, w), vd_set(1));
  s->w = w, s->T0 = -T, s->P2 = P2, s->WW = vd_fma(T, T, P2) * vd_fma(T1, T1, P2);
}
#else
typedef struct cauchy_segment_state {
  skf_v3d w;
  skf_vd T0, P2, W_sum, WW;
  skf_vd P, per_WW, per_P2, offset, angle; /* set on the way; angle: then delta / P */
  skf_vi good;
} cauchy_segment_state;

SKF_INLINE void cauchy_segment_begin(const cauchy_span_row *c, skf_v3d x, cauchy_segment_state *s) {
  skf_v3d d = vd3_sub(x, c->at.from);
  skf_vd T = vd3_dot(d, c->tangent), T1 = c->L - T;
  skf_v3d w = vd3_less(d, T, c->back);
  skf_vd P2 = vd_fma(c->at.param2, vd3_dot(w, w), vd_set(1)), W0 = vd_fma(T, T, P2), W1 = vd_fma(T1, T1, P2);
  s->w = w, s->T0 = -T, s->P2 = P2, s->W_sum = W0 + W1, s->WW = W0 * W1;
  s->good = vd_fma(vd_set(257), P2, c->thin) > W0; /* t^2 < 256 h^2 + (4 / (s^2 L))^2 */
}
#endif

SKF_INLINE void cauchy_segment_turn(const cauchy_span_row *c, cauchy_segment_state *s) {
  (void)c;
  s->P = vd_sqrt(s->P2), s->per_WW = vd_set(1) / s->WW, s->per_P2 = vd_set(1) / s->P2;
}

SKF_INLINE void cauchy_segment_middle(const cauchy_span_row *c, cauchy_segment_state *s) {
  skf_vangle a = vd_angle_parts(c->L * s->P, vd_fma(s->T0, s->T0 + c->L, s->P2));
  s->offset = a.offset, s->angle = a.top / a.bottom;
  s->P *= s->per_P2;
}

#ifdef SKF_VEC_FLOAT
SKF_INLINE void cauchy_segment_series(const cauchy_span_row *c, cauchy_segment_state *s) {
  (void)c;
  s->angle = vd_angle_series(s->offset, s->angle);
}

SKF_INLINE skf_vvalue cauchy_segment_end(const cauchy_span_row *c, const cauchy_segment_state *s) {
  skf_vd T0 = s->T0, T1 = T0 + c->L, P2 = s->P2, per_P2 = s->per_P2, TT = T0 * T1, sum = T0 + T1;
  skf_vd L_WW = c->L * s->per_WW, L_WW2 = L_WW * s->per_WW, ends1 = (P2 - TT) * L_WW;
  skf_vd both = vd_fma(s->angle, s->P, ends1), I2 = both * per_P2, wide = vd_fma(sum, sum, (P2 + P2) - TT);
  skf_vd ends2 = vd_fms(P2, P2, TT * wide) * L_WW2, g = c->g * per_P2 * vd_fma(vd_set(1.5), I2, ends2);
  skf_vi good = (vd_fma(vd_set(0.25), ends1, both) > vd_set(0)) & (vd_fma(vd_set(1.25), I2, ends2) > vd_set(0)) &
                (s->per_WW * per_P2 > vd_set(1e-15));
  return (skf_vvalue){c->F * I2, vd3_mad(vd3_scale(sum * (wide - TT) * L_WW2, c->along), g, s->w), good};
}
#else
SKF_INLINE void cauchy_segment_series(const cauchy_span_row *c, cauchy_segment_state *s) {
  (void)c;
  s->angle = vd_angle_series(s->offset, s->angle) * s->P;
}

SKF_INLINE skf_vvalue cauchy_segment_end(const cauchy_span_row *c, const cauchy_segment_state *s) {
  skf_vd T0 = s->T0, T1 = T0 + c->L, P2 = s->P2, per_P2 = s->per_P2, TT = T0 * T1, sum = T0 + T1;
  skf_vd L_WW = c->L * s->per_WW, L_WW2 = L_WW * s->per_WW, ends1 = (P2 - TT) * L_WW, both = s->angle + ends1;
  skf_vd I2 = both * per_P2, wide = vd_fma(sum, sum, (P2 + P2) - TT); /* twice the integral */
  skf_vd ends2 = vd_fms(P2, P2, TT * wide) * L_WW2, g = c->g * per_P2 * vd_fma(vd_set(1.5), I2, ends2);
  skf_vi good = (both + ends1 > vd_set(0)) & (ends2 + I2 > vd_set(0)) & (s->per_WW * per_P2 > vd_set(1e-140));
  return (skf_vvalue){c->F * I2, vd3_mad(vd3_scale(sum * s->W_sum * L_WW2, c->along), g, s->w), good & s->good};
}
#endif

/* cauchy.c's segment, the quotients gathered into two. */
SKF_INLINE skf_vvalue cauchy_segment_beyond(const cauchy_span_row *row, skf_v3d x) {
  const segment_row *c = &row->at;
  skf_vd p = c->param, p2 = c->param2, L = c->L;
  segment_view f = segment_see(c, x);
  skf_vd one = vd_set(1), P2 = vd_fma(p2 * c->per_L2, f.n2, one), P = vd_sqrt(P2);
  skf_vd W0 = vd_fma(p2, f.n0, one), W1 = vd_fma(p2, f.n1, one), N = vd_sqrt(W0 * W1);
  skf_vd t0 = -vd3_dot(f.d0, c->a), t1 = -vd3_dot(f.d1, c->a), sum = t0 + t1;
  skf_vd tt = p2 * t0 * t1;
  span_view a = span_see(p * L * P, P2 + tt, N, P2 - tt, p * P * sum);
  skf_vd per = one / (P * P2), F = c->per_param * span_second(&a, a.c) * per;
  skf_vd g = vd_set(-4) * p * span_fourth(&a, a.c) * (per * per * P);
  skf_vd per_N2 = a.per_N * a.per_N, ends = p2 * L * sum * (W0 + W1) * (per_N2 * per_N2);
  return vv_scale(c->strength, (skf_vvalue){F, segment_gradient(c, &f, g, ends), a.good & vd_sane(P * P2)});
}

SKF_BATCH_WOVEN(inverse_segment, segment, inverse_segment_close, inverse_segment_middle, skf_stage_none, skf_stage_none)
SKF_BATCH_CROSSED(cauchy_segment, cauchy_span, cauchy_segment_beyond, cauchy_segment_turn, cauchy_segment_middle,
                  cauchy_segment_series)

#endif
