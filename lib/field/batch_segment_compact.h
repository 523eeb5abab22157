/* SPDX-License-Identifier: MIT */
/* Vector forms: kernels of finite support along a segment, as support.c, polynomial.c and metaball.c. */
#ifndef SKF_FIELD_BATCH_SEGMENT_COMPACT_H
#define SKF_FIELD_BATCH_SEGMENT_COMPACT_H

#include "field/batch_segment.h"
#include "num/gauss.h"

/* The part lo <= t <= hi of the segment in the support; T is half the ball's chord. */
typedef struct clip_view {
  skf_vd t0, t1, q0, q1, T, lo, hi, length, gap_lo, gap_hi, h2, h;
  skf_vi in0, in1, some, near; /* some: not empty; near: R^2 - r^2 of an end or of the line cancels */
} clip_view;

/* In three steps, each up to a root or a quotient */
SKF_INLINE void clip_begin(const segment_row *c, const segment_view *f, clip_view *v) {
  skf_vd R2 = c->param2;
  v->t0 = -vd3_dot(f->d0, c->a), v->t1 = -vd3_dot(f->d1, c->a), v->q0 = R2 - f->n0, v->q1 = R2 - f->n1;
  v->near = vd_set(1024) * vd_min(vd_abs(v->q0), vd_abs(v->q1)) < R2;
  v->h2 = f->n2 * c->per_L2, v->h = vd_sqrt(v->h2);
}

SKF_INLINE void clip_chord(const segment_row *c, clip_view *v) {
  skf_vd R = c->param, R2 = c->param2, zero = vd_set(0);
  v->in0 = v->q0 > zero, v->in1 = v->q1 > zero;
  skf_vd T0 = vd_fma(v->t0, v->t0, v->q0), T1 = vd_fma(v->t1, v->t1, v->q1), Th = (R - v->h) * (R + v->h);
  skf_vd T2 = vd_select(v->in0, T0, vd_select(v->in1, T1, Th));
  v->some = (T2 > zero) & (v->in0 | (v->t0 < zero)) & (v->in1 | (v->t1 > zero));
  v->near |= ~(v->in0 | v->in1) & (vd_set(1024) * vd_abs(Th) < R2);
  v->T = vd_sqrt(vd_select(v->some, T2, R2));
}

SKF_INLINE void clip_end(const segment_row *c, clip_view *v) {
  skf_vd zero = vd_set(0), s0 = v->T + vd_abs(v->t0), s1 = v->T + vd_abs(v->t1), inv = vd_set(1) / (s0 * s1);
  skf_vd k0 = v->q0 * (s1 * inv), k1 = v->q1 * (s0 * inv); /* q = (T - t)(T + t) */
  skf_vi back0 = v->t0 < zero, back1 = v->t1 < zero;
  v->gap_lo = vd_select(v->in0, vd_select(back0, k0, s0), zero);
  v->gap_hi = vd_select(v->in1, vd_select(back1, s1, k1), zero);
  skf_vd above0 = vd_select(back0, s0, k0), below1 = vd_select(back1, k1, s1);
  v->length = vd_select(v->in0, vd_select(v->in1, c->L, above0), vd_select(v->in1, below1, v->T + v->T));
  v->some &= v->length > zero;
  v->lo = vd_select(v->in0, v->t0, -v->T), v->hi = vd_select(v->in1, v->t1, v->T);
}

SKF_INLINE clip_view segment_clip(const segment_row *c, const segment_view *f, skf_v3d x, bool exact) {
  clip_view v;
  clip_begin(c, f, &v);
  if (exact) {
    v.q0 = power_exact(c->param, x, c->from, f->d0), v.q1 = power_exact(c->param, x, c->to, f->d1);
    v.near = vi_set(0);
  }
  clip_chord(c, &v);
  clip_end(c, &v);
  return v;
}

SKF_INLINE skf_vvalue clip_result(const segment_row *c, const segment_view *f, const clip_view *v, skf_vd F, skf_vd g,
                                  skf_vd ends) {
  skf_vi some = v->some;
  F = (skf_vd)((skf_vi)F & some), g = (skf_vd)((skf_vi)g & some), ends = (skf_vd)((skf_vi)ends & some);
  return (skf_vvalue){F, segment_gradient(c, f, g, ends), ~v->near & (f->n0 + f->n1 < vd_set(INFINITY))};
}

#ifdef SKF_VEC_FLOAT
/* In lengths of R, T half the chord that the ball cuts from the segment's line, gap_lo and gap_hi what of it lies
   beyond the segment, half of the rest c long: there m = (A - half s)(B + half s) = p + e s - c s^2, s from -1 to 1,
   whose powers' means M1, M2, M3 are sums of few terms that hardly cancel. That the gaps are differences is what
   rounding the point does, too. */
typedef struct chord_row {
  skf_v3d from, tangent, back, along; /* 1 / R, R and the strength times the direction */
  skf_vd L, per_R2, F, g, ends;       /* L / R; factors of the results */
} chord_row;

static double *chord_pack(const skf_prepared *e, double *k) {
  const skf_segment_plan *s = &e->plan.segment;
  double R = e->kernel.param;
  k = pack3(pack3(k, e->primitive.segment.from), v3_scale(1 / R, s->a));
  k = pack3(pack3(k, v3_scale(R, s->a)), v3_scale(e->strength, s->a));
  k = pack1(pack1(k, s->length / R), 1 / (R * R));
  return pack1(pack1(pack1(k, 2 * R * e->strength), -4 / R * e->strength), -2);
}

typedef struct chord_state {
  skf_v3d w;
  skf_vd t, T2, T; /* t: the foot of the perpendicular from `from` on */
} chord_state;
typedef chord_state quartic_segment_state, soft_object_segment_state;

SKF_INLINE void chord_begin(const chord_row *c, skf_v3d x, chord_state *s) {
  skf_v3d d = vd3_sub(x, c->from);
  s->t = vd3_dot(d, c->tangent);
  s->w = vd3_less(d, s->t, c->back);
  s->T2 = vd_fnma(vd3_dot(s->w, s->w), c->per_R2, vd_set(1));
  s->T = vd_sqrt(vd_max(s->T2, vd_set(0)));
}
#define quartic_segment_begin     chord_begin
#define soft_object_segment_begin chord_begin

/* m^2 (c2 + c3 m) */
SKF_INLINE skf_vvalue chord_end(const chord_row *c, const chord_state *s, bool cubic) {
  const double c2 = cubic ? 5. / 9 : 1, c3 = 4. / 9;
  const skf_vd zero = vd_set(0);
  skf_vd gap_lo = vd_max(s->T - s->t, zero), gap_hi = vd_max((s->T + s->t) - c->L, zero);
  skf_vd half = vd_max(vd_fnma(vd_set(0.5), gap_lo + gap_hi, s->T), zero);
  skf_vi inside = (gap_lo > zero) & (gap_hi > zero); /* it may be short in a large support */
  half = vd_select(inside, vd_set(0.5) * c->L, half);
  skf_vd A = gap_hi + half, B = gap_lo + half, p = A * B, cc = half * half, e = half * (gap_hi - gap_lo), ee = e * e,
         pc = p - cc;
  skf_vd M1 = vd_fnma(vd_set(1. / 3), cc, p), M2 = p * vd_fnma(vd_set(2. / 3), cc, p);
  M2 = vd_fma(vd_set(1. / 3), ee, vd_fma(vd_set(0.2) * cc, cc, M2));
  skf_vd F = vd_set(c2) * M2, g = vd_set(2 * c2) * M1, ends = vd_set(2 * c2) * pc;
  if (cubic) {
    skf_vd M3 = vd_fma(p, vd_fma(p, pc, vd_set(0.6) * cc * cc), ee * vd_fnma(vd_set(0.6), cc, p));
    F = vd_fma(vd_set(c3), vd_fnma(vd_set(1. / 7) * cc * cc, cc, M3), F);
    g = vd_fma(vd_set(3 * c3), M2, g);
    ends = vd_fma(vd_set(c3), vd_fma(vd_set(3) * pc, pc, ee), ends);
  }
  return (skf_vvalue){c->F * half * F, vd3_mad(vd3_scale(c->ends * e * ends, c->along), c->g * half * g, s->w),
                      s->T2 > vd_set(-INFINITY)};
}
SKF_INLINE skf_vvalue quartic_segment_end(const chord_row *c, const chord_state *s) { return chord_end(c, s, false); }
SKF_INLINE skf_vvalue soft_object_segment_end(const chord_row *c, const chord_state *s) {
  return chord_end(c, s, true);
}

SKF_BATCH_WOVEN(quartic_segment, chord, skf_again_none, skf_stage_none, skf_stage_none, skf_stage_none)
SKF_BATCH_WOVEN(soft_object_segment, chord, skf_again_none, skf_stage_none, skf_stage_none, skf_stage_none)
#else
typedef struct compact_segment_state {
  segment_view f;
  clip_view v;
} compact_segment_state;

/* m^2 (c2 + c3 m), m = 1 - r^2 / R^2 */
SKF_INLINE skf_vvalue polynomial_clipped(const segment_row *c, const compact_segment_state *s, double c2, double c3) {
  const segment_view *f = &s->f;
  const clip_view *v = &s->v;
  skf_vd zero = vd_set(0), F = zero, g = zero, ends = zero, C2 = vd_set(c2), C3 = vd_set(c3);
  skf_vd half = vd_set(0.5) * v->length, per_R2 = c->per_param * c->per_param;
  int n = c3 == 0 ? 3 : 4; /* exact */
  const skf_gauss_node *node = skf_gauss_rule(n);
#pragma GCC unroll 4
  for (int j = 0; j < n; j++) {
    skf_vd up = vd_fma(half, vd_set(1 - node[j].x), v->gap_hi), down = vd_fma(half, vd_set(1 + node[j].x), v->gap_lo);
    skf_vd m = up * down * per_R2, wm = vd_set(node[j].w) * m;
    F = vd_fma(wm * m, vd_fma(C3, m, C2), F);
    g = vd_fma(wm, vd_fma(vd_set(3) * C3, m, vd_set(2) * C2), g);
  }
  skf_vd m0 = vd_max(v->q0, zero) * per_R2, m1 = vd_max(v->q1, zero) * per_R2;
  skf_vd dm = vd_select(v->in0 & v->in1, c->L * (v->t0 + v->t1) * per_R2, m0 - m1), sum = m0 + m1;
  ends = dm * vd_fma(C3, vd_fma(sum, sum, -(m0 * m1)), C2 * sum);
  return clip_result(c, f, v, half * F, vd_set(-2) * per_R2 * half * g, ends);
}

/* Next to the axis and to the rim another time */
SKF_INLINE void compact_segment_begin(const segment_row *c, skf_v3d x, compact_segment_state *s) {
  segment_look(c, x, &s->f);
  clip_begin(c, &s->f, &s->v);
  s->v.near |= segment_close(c, &s->f);
}
SKF_INLINE void compact_segment_chord(const segment_row *c, compact_segment_state *s) { clip_chord(c, &s->v); }
SKF_INLINE void compact_segment_clip(const segment_row *c, compact_segment_state *s) { clip_end(c, &s->v); }

SKF_INLINE skf_vvalue polynomial_rim(const segment_row *c, skf_v3d x, double c2, double c3) {
  compact_segment_state s = {.f = segment_see(c, x)};
  s.v = segment_clip(c, &s.f, x, true);
  return polynomial_clipped(c, &s, c2, c3);
}

typedef compact_segment_state quartic_segment_state, soft_object_segment_state;
#define quartic_segment_begin     compact_segment_begin
#define soft_object_segment_begin compact_segment_begin
SKF_INLINE skf_vvalue quartic_segment_end(const segment_row *c, const compact_segment_state *s) {
  return polynomial_clipped(c, s, 1, 0);
}
SKF_INLINE skf_vvalue soft_object_segment_end(const segment_row *c, const compact_segment_state *s) {
  return polynomial_clipped(c, s, 5. / 9, 4. / 9);
}
SKF_OUTLINE skf_vvalue quartic_segment_rim(const segment_row *c, skf_v3d x) { return polynomial_rim(c, x, 1, 0); }
SKF_OUTLINE skf_vvalue soft_object_segment_rim(const segment_row *c, skf_v3d x) {
  return polynomial_rim(c, x, 5. / 9, 4. / 9);
}

SKF_BATCH_STAGED(quartic_segment, segment, quartic_segment_rim, compact_segment_chord, compact_segment_clip,
                 skf_stage_none)
SKF_BATCH_STAGED(soft_object_segment, segment, soft_object_segment_rim, compact_segment_chord, compact_segment_clip,
                 skf_stage_none)
#endif

/* A part of the segment in the metaball's shell: R / 3 <= r <= R from abscissa a to b; gaps to the ends of the chord.
 */
typedef struct shell_view {
  skf_vd a, ra, b, rb, length, gap_lo, gap_hi;
} shell_view;

typedef struct shell_sum {
  skf_vd F, g;
} shell_sum;

/* Where the shell's part is all this near to R the closed form would cancel. */
SKF_INLINE skf_vi shell_thin(const segment_row *c, const clip_view *v, const shell_view *s) {
  skf_vi straddle = (s->a < vd_set(0)) & (s->b > vd_set(0));
  return vd_select(straddle, v->h, vd_min(s->ra, s->rb)) > vd_set(0.8) * c->param;
}

/* Closed, as add_shell in metaball.c. */
SKF_INLINE void shell_closed(const segment_row *c, const clip_view *v, const shell_view *s, shell_sum *out) {
  skf_vd per_R = c->per_param, h2 = v->h2, len = s->length, zero = vd_set(0);
  skf_vi real = (len > zero) & ~shell_thin(c, v, s), right = s->a > zero, left = s->b < zero;
  if (!vi_any(real)) return;
  skf_vd A = s->ra + vd_abs(s->a), B = s->rb + vd_abs(s->b), sum = s->ra + s->rb, mid = s->a + s->b;
  /* r_a + r_b - length = A + h^2 / B, h^2 / A + B or h^2 (1 / A + 1 / B), times the denominators */
  skf_vd den = vd_select(right, B, vd_select(left, A, A * B));
  skf_vd E = vd_select(right | left, vd_fma(A, B, h2), h2 * (A + B)), top = vd_set(2) * len * den;
  E = vd_select(real, E, vd_set(1)), top = (skf_vd)((skf_vi)top & real);
  skf_vd log = vd_log_ratio(E + top, E, top), third = vd_set(1. / 3);
  skf_vd r1 = vd_fma(vd_set(0.25) * len, sum + mid * mid / sum, vd_set(0.5) * h2 * log);
  skf_vd r2 = len * vd_fma(third, vd_fma(mid, mid, -(s->a * s->b)), h2);
  skf_vd F = vd_set(1.5) * vd_fma(per_R, vd_fma(r2, per_R, vd_set(-2) * r1), len);
  skf_vd g = vd_set(-3) * per_R * vd_fnma(len, per_R, log);
  out->F += (skf_vd)((skf_vi)F & real), out->g += (skf_vd)((skf_vi)g & real);
}

/* The thin part by nodes: r is smooth there. */
SKF_INLINE void shell_nodes(const segment_row *c, const clip_view *v, const shell_view *s, shell_sum *out) {
  enum { N = 18 };
  skf_vi thin = (s->length > vd_set(0)) & shell_thin(c, v, s);
  if (!vi_any(thin)) return;
  const skf_gauss_node *node = skf_gauss_rule(N);
  skf_vd half = vd_set(0.5) * s->length, R = c->param, per_R = c->per_param, F = vd_set(0), g = F;
  for (int j = 0; j < N; j++) {
    skf_vd hi = vd_fma(half, vd_set(1 - node[j].x), s->gap_hi), lo = vd_fma(half, vd_set(1 + node[j].x), s->gap_lo);
    skf_vd u = vd_set(0.5) * (lo - hi), rr = vd_fma(u, u, v->h2), r = vd_sqrt(rr);
    skf_vd slope = hi * lo * (per_R / vd_fma(R, r, rr)), m = slope * r, w = vd_set(node[j].w); /* m / r */
    F = vd_fma(w * m, m, F);
    g = vd_fma(w, slope, g);
  }
  F = vd_set(1.5) * half * F, g = vd_set(-3) * per_R * half * g;
  out->F += (skf_vd)((skf_vi)F & thin), out->g += (skf_vd)((skf_vi)g & thin);
}

/* h(r0) - h(r1) as at_ends in metaball.c */
SKF_INLINE skf_vd shell_ends(const segment_row *c, const clip_view *v, skf_vd r0, skf_vd r1) {
  skf_vd per_R = c->per_param, per_R2 = per_R * per_R, R = c->param, zero = vd_set(0), one = vd_set(1),
         three = vd_set(3);
  skf_vi core0 = three * r0 <= R, core1 = three * r1 <= R;
  skf_vd sum = r0 + r1, inv = one / ((R + r0) * (R + r1)), dw = c->L * (v->t0 + v->t1);
  skf_vd n0 = vd_max(v->q0, zero) * ((R + r1) * inv) * per_R, n1 = vd_max(v->q1, zero) * ((R + r0) * inv) * per_R;
  skf_vd h0 = vd_select(core0, vd_fnma(three * per_R2, r0 * r0, one), vd_set(1.5) * n0 * n0);
  skf_vd h1 = vd_select(core1, vd_fnma(three * per_R2, r1 * r1, one), vd_set(1.5) * n1 * n1);
  skf_vd u0 = vd_max(vd_fma(three * per_R, r0, -one), zero), u1 = vd_max(vd_fma(three * per_R, r1, -one), zero);
  skf_vd inner = vd_fma(three * per_R2, dw, vd_set(0.5) * (u0 - u1) * (u0 + u1));
  skf_vd outer = vd_set(1.5) * (n0 + n1) * dw * per_R / sum;
  return vd_select(v->in0 & v->in1, vd_select(core0 | core1, inner, outer), h0 - h1);
}

SKF_INLINE skf_vvalue metaball_clipped(const segment_row *c, skf_v3d x, bool exact) {
  segment_view f = segment_see(c, x);
  clip_view v = segment_clip(c, &f, x, exact);
  skf_vd zero = vd_set(0), R = c->param, per_R = c->per_param, third = R * vd_set(1. / 3);
  shell_sum s = {zero, zero};
  if (!vi_any(v.some)) return clip_result(c, &f, &v, zero, zero, zero);
  skf_vd T2 = (third - v.h) * (third + v.h), r0 = vd_sqrt(f.n0), r1 = vd_sqrt(f.n1);
  skf_vi cored = T2 > zero;
  skf_vd T3 = vd_sqrt(vd_max(T2, zero));
  cored &= (v.lo < T3) & (v.hi > -T3);
  skf_vd left = vd_max(-T3 - v.lo, zero), right = vd_max(v.hi - T3, zero), core = vd_max(v.length - left - right, zero);
  skf_vd a = vd_max(v.lo, -T3), b = vd_min(v.hi, T3), ab = a + b;
  skf_vd square = vd_fma(vd_set(1. / 3), vd_fma(ab, ab, -(a * b)), v.h2);
  s.F = (skf_vd)((skf_vi)(core * vd_fnma(vd_set(3) * per_R * per_R, square, vd_set(1))) & cored);
  s.g = (skf_vd)((skf_vi)(vd_set(-6) * core * per_R * per_R) & cored);
  skf_vd r_lo = vd_select(v.in0, r0, R), r_hi = vd_select(v.in1, r1, R);
  shell_view A = {v.lo,
                  r_lo,
                  vd_select(cored, -T3, v.hi),
                  vd_select(cored, third, r_hi),
                  (skf_vd)((skf_vi)vd_select(cored, left, v.length) & v.some),
                  v.gap_lo,
                  vd_select(cored, v.T + T3, v.gap_hi)};
  shell_view B = {T3, third, v.hi, r_hi, (skf_vd)((skf_vi)right & cored & v.some), v.T + T3, v.gap_hi};
  shell_sum sa = {zero, zero}, sb = sa;
  shell_closed(c, &v, &A, &sa);
  if (vi_any(cored)) shell_closed(c, &v, &B, &sb);
  shell_nodes(c, &v, &A, &sa);
  s.F += sa.F + sb.F, s.g += sa.g + sb.g;
  return clip_result(c, &f, &v, s.F, s.g, shell_ends(c, &v, r0, r1));
}

#ifndef SKF_VEC_FLOAT /* floats leave twice the error that they may */
/* A segment that is not short beside R, lanes that are neither near the rim nor next to the axis: with k_R = (1 - r /
   R)^2 to R, h = 3/2 k_R - 1/2 k_{R/3}, each by its antiderivative at the ends of what of the segment is in its ball;
   the logarithms, int dt / r over the shell, are one. Where all is farther than 0.77 R the terms would cancel. */
typedef struct metaball_segment_state {
  skf_v3d w;                          /* from the axis to x */
  skf_vd t0, t1, r0, r1, h2;          /* r: squares at first */
  skf_vd T, T3, len, len3, F, log, t; /* T, T3: half the chords; set on the way */
  skf_vi some, thin, good;
} metaball_segment_state;

SKF_INLINE void metaball_segment_begin(const segment_row *c, skf_v3d x, metaball_segment_state *s) {
  skf_v3d d0 = vd3_sub(x, c->from), d1 = vd3_sub(x, c->to);
  skf_vd n0 = vd3_dot(d0, d0), n1 = vd3_dot(d1, d1), R2 = c->param2, near = vd_min(n0, n1);
  s->t0 = -vd3_dot(d0, c->a), s->t1 = -vd3_dot(d1, c->a);
  skf_vi second = n1 < n0;
  s->w = vd3_mad(vd3_select(second, d1, d0), vd_select(second, s->t1, s->t0), c->a);
  s->h2 = vd3_dot(s->w, s->w), s->r0 = n0, s->r1 = n1;
  skf_vd Q = R2 - s->h2, q0 = R2 - n0, q1 = R2 - n1, zero = vd_set(0);
  skf_vi in0 = q0 > zero, in1 = q1 > zero;
  s->T = vd_select(in0, vd_fma(s->t0, s->t0, q0), vd_select(in1, vd_fma(s->t1, s->t1, q1), Q));
  s->T3 = vd_fnma(vd_set(8. / 9), R2, Q);
  s->some = (s->T > zero) & (in0 | (s->t0 < zero)) & (in1 | (s->t1 > zero));
  skf_vd beside = vd_max(vd_max(s->t0, -s->t1), zero), nearest = vd_fma(beside, beside, s->h2);
  skf_vi rim = vd_set(1024) * vd_min(vd_abs(q0), vd_abs(q1)) < R2;
  rim |= ~(in0 | in1) & (vd_set(1024) * vd_abs(Q) < R2);
  s->thin = s->some & (nearest > vd_set(0.6) * R2);
  s->good = ~(rim | (s->some & (vd_set(256) * s->h2 <= near))) & (n0 + n1 < vd_set(INFINITY));
}

SKF_INLINE void metaball_segment_roots(const segment_row *c, metaball_segment_state *s) {
  (void)c;
  s->r0 = vd_sqrt(s->r0), s->r1 = vd_sqrt(s->r1);
  s->T = vd_sqrt(vd_max(s->T, vd_set(0))), s->T3 = vd_sqrt(vd_max(s->T3, vd_set(0)));
}

SKF_INLINE void metaball_segment_parts(const segment_row *c, metaball_segment_state *s) {
  skf_vd zero = vd_set(0), one = vd_set(1), R = c->param, per_R = c->per_param, third = R * vd_set(1. / 3), T3 = s->T3;
  skf_vi in0 = s->r0 < R, in1 = s->r1<R, cored = T3> zero;
  skf_vd lo = vd_select(in0, s->t0, -s->T), hi = vd_select(in1, s->t1, s->T);
  skf_vd r_lo = vd_min(s->r0, R), r_hi = vd_min(s->r1, R), mid = lo + hi, len = vd_select(in0 & in1, c->L, hi - lo);
  skf_vd lo3 = vd_max(vd_min(lo, T3), -T3), hi3 = vd_max(vd_min(hi, T3), -T3), mid3 = lo3 + hi3, len3 = hi3 - lo3;
  skf_vi left = lo<zero, right = hi> zero;
  skf_vd r_lo3 = vd_select(vd_abs(lo) < T3, r_lo, third), r_hi3 = vd_select(vd_abs(hi) < T3, r_hi, third);
  /* without a core, from the foot of the perpendicular */
  skf_vd A = vd_abs(lo) + r_lo, B = vd_abs(hi) + r_hi;
  skf_vd A3 = vd_select(cored, vd_abs(lo3) + r_lo3, one);
  skf_vd B3 = vd_select(cored, vd_abs(hi3) + r_hi3, vd_select(left & right, s->h2, one));
  skf_vd top = vd_select(left, A, A3) * vd_select(right, B, B3);
  skf_vd bottom = vd_select(left, A3, A) * vd_select(right, B3, B);
  skf_vlog l = vd_log_parts(vd_select(s->some, top, one), vd_select(s->some, bottom, one),
                            vd_select(s->some, top - bottom, zero));
  s->log = l.count, s->t = l.top / l.bottom;
  /* int r dt but for the logarithm, int r^2 dt */
  skf_vd tr = vd_fma(hi, r_hi, -(lo * r_lo)), tr3 = vd_fma(hi3, r_hi3, -(lo3 * r_lo3)), share = vd_set(1. / 3);
  skf_vd rr = len * vd_fma(share, vd_fnma(lo, hi, mid * mid), s->h2);
  skf_vd rr3 = len3 * vd_fma(share, vd_fnma(lo3, hi3, mid3 * mid3), s->h2);
  skf_vd F = vd_fma(vd_fnma(vd_set(3), rr3, rr), per_R, tr3 - tr);
  s->F = vd_fma(vd_set(1.5), vd_fma(F, per_R, len), vd_set(-0.5) * len3);
  s->len = len, s->len3 = len3;
}

SKF_INLINE skf_vvalue metaball_segment_sum(const segment_row *c, const metaball_segment_state *s, skf_vd F, skf_vd g,
                                           skf_vi good) {
  skf_vd zero = vd_set(0), one = vd_set(1), three = vd_set(3), u0 = c->per_param * s->r0, u1 = c->per_param * s->r1;
  skf_vd n0 = vd_max(one - u0, zero), n1 = vd_max(one - u1, zero);
  skf_vd c0 = vd_max(vd_fnma(three, u0, one), zero), c1 = vd_max(vd_fnma(three, u1, one), zero);
  skf_vd ends = vd_fma(vd_set(1.5) * (n0 - n1), n0 + n1, vd_set(-0.5) * (c0 - c1) * (c0 + c1));
  F = (skf_vd)((skf_vi)F & s->some), g = (skf_vd)((skf_vi)g & s->some), ends = (skf_vd)((skf_vi)ends & s->some);
  return (skf_vvalue){F, vd3_mad(vd3_scale(ends, c->a), g, s->w), good};
}

SKF_INLINE skf_vvalue metaball_segment_end(const segment_row *c, const metaball_segment_state *s) {
  skf_vd per_R = c->per_param, log = vd_log_series(s->log, s->t);
  skf_vd F = vd_fnma(vd_set(1.5) * per_R * s->h2, log, s->F);
  skf_vd g = vd_set(-3) * per_R * vd_fma(per_R, vd_fma(vd_set(3), s->len3, -s->len), log);
  return metaball_segment_sum(c, s, F, g, s->good & ~s->thin);
}

/* Nodes: where all is farther than 0.8 R they leave 2e-16, the gradient 4e-16; in units of R. */
SKF_INLINE skf_vvalue metaball_segment_thin(const segment_row *c, skf_v3d x) {
  enum { NODES = 16 };
  metaball_segment_state s;
  metaball_segment_begin(c, x, &s);
  metaball_segment_roots(c, &s);
  skf_vd one = vd_set(1), half = vd_set(0.5), per_R = c->per_param, hh = s.h2 * (per_R * per_R), F = vd_set(0), g = F;
  skf_vi in0 = s.r0 < c->param, in1 = s.r1 < c->param;
  skf_vd lo = vd_select(in0, s.t0, -s.T), hi = vd_select(in1, s.t1, s.T);
  skf_vd mid = half * (lo + hi) * per_R, by = half * vd_select(in0 & in1, c->L, hi - lo);
  const skf_gauss_node *node = skf_gauss_rule(NODES);
#pragma GCC unroll 4
  for (int j = 0; j < NODES; j++) {
    skf_vd t = vd_fma(by * per_R, vd_set(node[j].x), mid), uu = vd_fma(t, t, hh), u = vd_sqrt(uu);
    skf_vd slope = (one - uu) / (u + uu), w = vd_set(node[j].w) * slope; /* (1 - u) / u */
    F = vd_fma(w, slope * uu, F), g += w;
  }
  return metaball_segment_sum(c, &s, vd_set(1.5) * by * F, vd_set(-3) * per_R * per_R * by * g, s.good & s.thin);
}

SKF_OUTLINE skf_vvalue metaball_segment_short(const segment_row *c, skf_v3d x) { return metaball_clipped(c, x, false); }
SKF_OUTLINE skf_vvalue metaball_segment_rim(const segment_row *c, skf_v3d x) { return metaball_clipped(c, x, true); }
SKF_OUTLINE skf_vvalue metaball_segment_careful(const segment_row *c, skf_v3d x) {
  skf_vvalue v = metaball_segment_thin(c, x);
  if (!vi_all(v.good)) vv_take(&v, metaball_segment_rim(c, x));
  return v;
}
SKF_BATCH_STAGED(metaball_segment, segment, metaball_segment_careful, metaball_segment_roots, metaball_segment_parts,
                 skf_stage_none)
SKF_BATCH_FORM(metaball_segment_short, segment, metaball_segment_rim)
#endif

#endif
