/* SPDX-License-Identifier: MIT */
/* Vector forms: kernels of finite support along a segment, as support.c, polynomial.c and metaball.c. */
#ifndef SKF_FIELD_BATCH_SEGMENT_COMPACT_H
#define SKF_FIELD_BATCH_SEGMENT_COMPACT_H

#include "field/batch_segment.h"
#include "num/gauss.h"

/* The part of the segment in the support; T is half the ball's chord. */
typedef struct clip_view {
  skf_vd t0, t1, q0, q1, T, length, gap_lo, gap_hi, h2, h;
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
}

/* The powers of the ends to an ulp or two */
SKF_INLINE clip_view segment_clip(const segment_row *c, const segment_view *f, skf_v3d x) {
  clip_view v;
  clip_begin(c, f, &v);
  v.q0 = power_exact(c->param, x, c->from, f->d0), v.q1 = power_exact(c->param, x, c->to, f->d1);
  v.near = vi_set(0);
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
  s.v = segment_clip(c, &s.f, x);
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

/* Metaballs, in lengths of R: the support holds of the segment what lies from -p to q of the foot of the perpendicular
   from x, the core, r <= 1/3, from -p3 to q3. A piece of the shell between abscissas a and b, with sum = r_a + r_b, v =
   (b - a) / sum, y = v^2, mm = (a + b)^2, 2 atanh v = v (2 + y (2/3 + y A)), has
     int dt / r = 2 atanh v,  int (1 / r - 1) dt = v (2 - sum + y (2/3 + y A)),
     4 int (1 - r)^2 dt = v (sum (2 - sum)^2
                             + y (sum mm / 3 + (sum^2 - mm) (2/3 (2 - sum) + y (2/3 - (1 - y) A)))):
   all terms are positive, so that nothing cancels where r is next to 1, nor in short pieces. Where the core is touched
   the logarithms of both sides are one, and the integrals, which are large, differences between the ends. */
typedef struct metaball_row {
  skf_v3d from, tangent, back, along; /* 1 / R, R and 3/2 of the strength times the direction */
  skf_vd L, per_R2, F, g;             /* L / R; factors of the results */
} metaball_row;

static double *metaball_pack(const skf_prepared *e, double *k) {
  const skf_segment_plan *s = &e->plan.segment;
  const double R = e->kernel.param;
  k = pack3(pack3(k, e->primitive.segment.from), v3_scale(1 / R, s->a));
  k = pack3(pack3(k, v3_scale(R, s->a)), v3_scale(1.5 * e->strength, s->a));
  return pack1(pack1(pack1(pack1(k, s->length / R), 1 / (R * R)), 0.375 * R * e->strength), -3 / R * e->strength);
}

typedef struct metaball_state {
  skf_v3d w;                     /* from the axis to x */
  skf_vd t, u, hh, n0, n1;       /* abscissas of x from `from` and of `to` from x; squared height and distances */
  skf_vd T0, T1, T3;             /* the distance of an end that is in the support, else half its chord; the core's */
  skf_vd sum, mm, v, y, left, A; /* of the piece; left = 1 - y */
  skf_vd F, g, ends;             /* without the logarithm */
  skf_vi closed, good;           /* closed: more than a piece */
} metaball_state;
typedef metaball_state metaball_segment_state, metaball_segment_short_state;

/* Beside the support T0 and T1 are negative. */
SKF_INLINE void metaball_roots(const metaball_row *c, metaball_state *s) {
  /* never 0, so that nor is the distance from an end */
  const skf_vd hh = vd_fma(vd3_dot(s->w, s->w), c->per_R2, vd_set(SKF_PICK(1e-300, 1e-37))), one = vd_set(1),
               TT = one - hh;
  const skf_vd n0 = vd_fma(s->t, s->t, hh), n1 = vd_fma(s->u, s->u, hh);
  s->hh = hh, s->n0 = n0, s->n1 = n1;
  s->T0 = (skf_vd)((skf_vi)vd_sqrt(vd_select(n0 < one, n0, vd_abs(TT))) | vd_sign(TT));
  s->T1 = (skf_vd)((skf_vi)vd_sqrt(vd_select(n1 < one, n1, vd_abs(TT))) | vd_sign(TT));
  s->T3 = vd_sqrt(vd_max(vd_set(1. / 9) - hh, vd_set(0)));
}

SKF_INLINE void metaball_segment_begin(const metaball_row *c, skf_v3d x, metaball_state *s) {
  const skf_v3d d = vd3_sub(x, c->from);
  s->t = vd3_dot(d, c->tangent), s->u = c->L - s->t;
  s->w = vd3_less(d, s->t, c->back);
}
#define metaball_segment_short_begin metaball_segment_begin

/* brief: what is short beside R passes the core's rim at one place, and is a core and a piece; differences between its
   ends are known by its length. */
SKF_INLINE void metaball_parts(const metaball_row *c, metaball_state *s, const bool brief) {
  const skf_vd zero = vd_set(0), one = vd_set(1), third = vd_set(1. / 3), hh = s->hh, T3 = s->T3;
  skf_vd p = vd_min(s->t, s->T0), q = vd_min(s->u, s->T1), len = p + q, mid = q - p;
  skf_vd r0 = vd_select(s->n0 < one, s->T0, one), r1 = vd_select(s->n1 < one, s->T1, one);
  skf_vd r03 = vd_min(r0, third), r13 = vd_min(r1, third), sum = r0 + r1, sum3 = r03 + r13;
  skf_vd rise = r1 - r0, rise3 = r13 - r03;
  skf_vd ap = vd_abs(p), aq = vd_abs(q), ap3 = vd_min(ap, T3), aq3 = vd_min(aq, T3);
  skf_vd p3 = (skf_vd)((skf_vi)ap3 | vd_sign(p)), q3 = (skf_vd)((skf_vi)aq3 | vd_sign(q));
  skf_vd len3 = p3 + q3, mid3 = q3 - p3, mm = mid * mid;
  skf_vi sure = vd_abs(len) > vd_set(0x1p-18); /* that there is something, or nothing */
  len = vd_max(len, zero);
  skf_vi cored = len3 > zero;
  skf_vd top = len;
  s->sum = sum, s->mm = mm, s->closed = cored;
  if (brief) {
    const skf_vd far = vd_max(p, q), near = vd_min(p, q), r_far = vd_max(r0, r1), end = far + T3;
    const skf_vd outer = vd_max(s->n0, s->n1);
    const skf_vi both = outer < one;
    sure |= outer < vd_set(SKF_PICK(1 - 0x1p-36, 1 - 0x1p-20));
    cored = (T3 > zero) & (near > -T3);
    len = vd_select(both, c->L, len);
    rise = vd_select(both, c->L * mid / sum, rise), rise3 = vd_select(r_far < third, rise, rise3);
    top = vd_select(cored, vd_max(far - T3, zero), len);
    s->sum = vd_select(cored, r_far + third, sum), s->mm = vd_select(cored, end * end, mm);
    s->closed = cored & (near > T3);
    sure &= ~s->closed | (c->L > vd_set(SKF_PICK(1. / 32, 1. / 8)));
    len3 = vd_select(s->closed, len3, len - top);
  }
  s->good = s->n0 < vd_set(SKF_PICK(1e200, 1e30));
  if ((int)SKF_PICK(1, 0)) { /* nearest to x it is not next to the support's rim */
    const skf_vd past = vd_max(vd_max(-s->t, -s->u), zero);
    s->good &= vd_abs(one - vd_fma(past, past, hh)) > vd_set(0x1p-9);
  }
  if (brief || (int)SKF_PICK(1, 0)) s->good &= sure;
  skf_vd A = (ap + r0) * (aq + r1), B = (ap3 + r03) * (aq3 + r13);
  s->v = vd_select(s->closed, A - B, top) / vd_select(s->closed, A + B, s->sum);
  skf_vd tr = vd_fma(p, r0, q * r1) - vd_fma(p3, r03, q3 * r13);
  skf_vd rr = vd_fma(third, vd_fma(p, q, mm), hh), rr3 = vd_fma(third, vd_fma(p3, q3, mid3 * mid3), hh);
  s->F = vd_fms(vd_set(4), vd_fma(len, rr, len - tr), len3 * vd_fma(vd_set(12), rr3, vd_set(4. / 3)));
  s->g = vd_fnma(vd_set(3), len3, len);
  if (brief) {
    s->F = vd_select(s->closed, s->F, len3 * vd_fnma(vd_set(8), rr3, vd_set(8. / 3)));
    s->F = (skf_vd)((skf_vi)s->F & cored);
    s->g = vd_select(s->closed, s->g, vd_set(-2) * len3);
  }
  s->g = (skf_vd)((skf_vi)s->g & cored);
  s->ends = vd_fma(rise3 + rise3, sum3, (rise - rise3) * (vd_set(4. / 3) - (sum - sum3)));
}

SKF_INLINE void metaball_series(const metaball_row *c, metaball_state *s) {
  (void)c;
  /* A as a quotient in 1 - y from 1/9 to 1, nearly all of whose terms are positive: 2e-8, 4e-16 */
#ifdef SKF_VEC_FLOAT
  static const double a[] = {0.0056879374256095274686, 0.1834154794053536069, 0.83419408741746492984,
                             0.61761436170313058228, 0.0039989527555858699036};
  static const double b[] = {0.0013131633791968646128, 0.090016383318137310678, 0.91391666772471984721,
                             2.1070307714493987565, 1};
#else
  static const double a[] = {7.7368406002136004094e-6,   0.0012988873261970432431, 0.04601413798045604896,
                             0.542591157033727529,       2.49095146746967628,      4.610706010265615513,
                             3.2170650691523083642,      0.64732604019452191458,   0.0012083176988531864635,
                             -0.000054363751749631798016};
  static const double b[] = {1.3783701159094402762e-6, 0.00037943793029066583537, 0.020156602578206218738,
                             0.35657769445329676173,   2.5566418689245924358,     8.0060544644548692161,
                             10.94716775864467046,     6.0058069451694810974,     1};
#endif
  s->y = s->v * s->v, s->left = vd_set(1) - s->y;
  s->A = vd_horner(a, sizeof a / sizeof *a, s->left) / vd_horner(b, sizeof b / sizeof *b, s->left);
}

SKF_INLINE skf_vvalue metaball_end(const metaball_row *c, const metaball_state *s, const bool brief) {
  const skf_vd two = vd_set(2), thirds = vd_set(2. / 3), v = s->v, y = s->y, sum = s->sum, gap = two - sum;
  skf_vd log = v * vd_fma(y, vd_fma(y, s->A, thirds), vd_select(s->closed, two, gap)), hh2 = s->hh + s->hh;
  skf_vd deep = vd_fma(y, vd_fnma(s->A, s->left, thirds), thirds * gap), rest = (hh2 + hh2) * log;
  skf_vd piece = vd_fma(vd_fms(sum, sum, s->mm), deep, vd_set(1. / 3) * sum * s->mm);
  piece = v * vd_fma(y, piece, sum * gap * gap);
  skf_vd F = brief ? s->F + vd_select(s->closed, -rest, piece) : vd_select(s->closed, s->F - rest, piece);
  return (skf_vvalue){c->F * F, vd3_mad(vd3_scale(s->ends, c->along), c->g * (log - s->g), s->w), s->good};
}

SKF_INLINE void metaball_segment_parts(const metaball_row *c, metaball_state *s) { metaball_parts(c, s, false); }
SKF_INLINE void metaball_segment_short_parts(const metaball_row *c, metaball_state *s) { metaball_parts(c, s, true); }
SKF_INLINE skf_vvalue metaball_segment_end(const metaball_row *c, const metaball_state *s) {
  return metaball_end(c, s, false);
}
SKF_INLINE skf_vvalue metaball_segment_short_end(const metaball_row *c, const metaball_state *s) {
  return metaball_end(c, s, true);
}

/* A segment that is long beside R, from its nearer end: the other one is out of the support. */
typedef struct metaball_long_row {
  metaball_row m;
  skf_v3d to, e, e_lo; /* as segment_row */
  skf_vd per_L2, axis; /* 1 / L^2; the square of how far from the end x may be next to the axis */
  skf_vd rim;          /* from where on, the end next to the support's rim, F / L asks for more of the gradient */
} metaball_long_row;

static double *metaball_long_pack(const skf_prepared *e, double *k) {
  const skf_segment_plan *s = &e->plan.segment;
  const double R = e->kernel.param, L = s->length, axis = 2 * R / L * R;
  k = pack3(pack3(pack3(metaball_pack(e, k), e->primitive.segment.to), s->e), s->e_lo);
  return pack1(pack1(pack1(k, 1 / (L * L)), axis * axis), L > 256 * R ? 1 - 2 * cbrt(0.1 * R / L) : 1);
}

typedef struct metaball_long_state {
  metaball_state m;
  skf_vi second, good; /* second: `to` is the nearer one */
} metaball_long_state;
typedef metaball_long_state metaball_segment_long_state;

/* Returns x from the end. */
SKF_INLINE skf_v3d metaball_look(const metaball_long_row *c, skf_v3d x, metaball_long_state *s) {
  s->second = vd3_dot(vd3_sub(x, c->m.from), c->m.tangent) > vd_set(0.5) * c->m.L;
  const skf_v3d d = vd3_sub(x, vd3_select(s->second, c->to, c->m.from));
  const skf_vd t = vd3_dot(d, c->m.tangent);
  s->m.t = vd_select(s->second, -t, t), s->m.u = c->m.L - s->m.t;
  s->m.w = vd3_less(d, t, c->m.back);
  return d;
}

SKF_INLINE void metaball_segment_long_begin(const metaball_long_row *c, skf_v3d x, metaball_long_state *s) {
  const skf_v3d d = metaball_look(c, x, s);
  s->good = vd3_dot(d, d) < vd_max(vd_set(256) * vd3_dot(s->m.w, s->m.w), c->axis);
  if ((int)SKF_PICK(0, 1)) s->good = vi_set(-1); /* rounding the point does more */
}
SKF_INLINE void metaball_segment_long_roots(const metaball_long_row *c, metaball_long_state *s) {
  metaball_roots(&c->m, &s->m);
  s->good |= (s->m.hh > vd_set(2)) | (s->m.t < vd_set(-2));
  if ((int)SKF_PICK(1, 0)) s->good &= (s->m.n0 < c->rim) | (s->m.n0 >= vd_set(1));
}
SKF_INLINE void metaball_segment_long_parts(const metaball_long_row *c, metaball_long_state *s) {
  metaball_parts(&c->m, &s->m, false);
  s->m.ends = (skf_vd)((skf_vi)s->m.ends ^ (s->second & vi_sign_bit()));
}
SKF_INLINE void metaball_segment_long_series(const metaball_long_row *c, metaball_long_state *s) {
  metaball_series(&c->m, &s->m);
}
SKF_INLINE skf_vvalue metaball_segment_long_end(const metaball_long_row *c, const metaball_long_state *s) {
  skf_vvalue v = metaball_end(&c->m, &s->m, false);
  v.good &= s->good;
  return v;
}

/* Next to the axis, from it by what the points' lower halves tell */
SKF_OUTLINE skf_vvalue metaball_segment_long_close(const metaball_long_row *c, skf_v3d x) {
  metaball_long_state s;
  const skf_v3d d = metaball_look(c, x, &s), lo = vd3_lost(x, vd3_select(s.second, c->to, c->m.from), d);
  const skf_v3d n = vd3_add(vd3_cross(d, c->e), vd3_add(vd3_cross(lo, c->e), vd3_cross(d, c->e_lo)));
  s.m.w = vd3_scale(c->per_L2, vd3_cross(c->e, n)), s.good = vi_set(-1);
  metaball_segment_long_roots(c, &s);
  metaball_segment_long_parts(c, &s);
  metaball_segment_long_series(c, &s);
  return metaball_segment_long_end(c, &s);
}

SKF_BATCH_CROSSED(metaball_segment, metaball, skf_again_none, metaball_roots, metaball_segment_parts, metaball_series)
SKF_BATCH_CROSSED(metaball_segment_short, metaball, skf_again_none, metaball_roots, metaball_segment_short_parts,
                  metaball_series)
SKF_BATCH_CROSSED(metaball_segment_long, metaball_long, metaball_segment_long_close, metaball_segment_long_roots,
                  metaball_segment_long_parts, metaball_segment_long_series)

#endif
