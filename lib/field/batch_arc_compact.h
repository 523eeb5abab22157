/* SPDX-License-Identifier: MIT */
/* Vector forms: quartic and soft object along an arc or a circle. Where h does not vanish the arc is at most two
   windows about the points of the circle that are nearest to x, chi = 0 and pi: each gets one Gauss rule, exact to
   rounding for polynomials in cos 2 chi. */
#ifndef SKF_FIELD_BATCH_ARC_COMPACT_H
#define SKF_FIELD_BATCH_ARC_COMPACT_H

#include "field/batch_arc_smooth.h"
#include "num/gauss.h"

/* With the radius of the support and half the sweep; its sine and cosine are in the arc */
typedef struct compact_arc_row {
  arc_row arc;
  skf_vd R, R2, per_R, half;
} compact_arc_row;

static double *compact_arc_pack(const skf_prepared *e, double *k) {
  double R = e->kernel.param;
  return pack1(pack1(pack1(pack1(arc_pack(e, k), R), R * R), 1 / R), e->plan.arc.half);
}

/* R^2 - r^2 = qa cos^2 chi + qb sin^2 chi; where this is negative on the far side it vanishes at chi = +-rim, else rim
   = pi / 2. near: it cancels next to x. */
typedef struct disc_view {
  skf_vd qa, qb, spread, rim;
  skf_vi some, cut, near;
} disc_view;

SKF_INLINE disc_view arc_disc(const compact_arc_row *c, const arc_view *f) {
  skf_vd zero = vd_set(0), a = vd_sqrt(f->alpha), b = vd_sqrt(f->beta);
  disc_view v = {.qa = (c->R - a) * (c->R + a), .qb = (c->R - b) * (c->R + b)};
  v.spread = vd_set(4) * c->arc.rho * f->k;
  v.cut = v.qb < zero;
  v.some = v.qa > zero;
  v.near = vd_set(1024) * vd_abs(v.qa) < c->R2;
  skf_vd wide = vd_sqrt(vd_max(v.qa, zero)), thin = vd_sqrt(vd_max(-v.qb, zero));
  v.rim = vd_select(v.cut & v.some, vd_atan2(wide, vd_select(v.some, thin, vd_set(1))), vd_set(SKF_PI / 2));
  /* next to the circle the distance from it is exact enough only for a large support */
  v.near |= vd_max(vd_set(1024) * f->alpha, vd_set(4) * c->R2) <= f->outer * f->outer;
  return v;
}

/* The part of the arc from chi0 to chi1 with |chi| < rim, gaps to the rim. */
typedef struct window_view {
  skf_vd mid, half, gap_lo, gap_hi;
  skf_vi some;
} window_view;

SKF_INLINE window_view arc_window(const compact_arc_row *c, const disc_view *d, skf_vd chi0, skf_vd chi1) {
  skf_vd zero = vd_set(0), below = chi0 + d->rim, above = d->rim - chi1;
  skf_vi cut_lo = below < zero, cut_hi = above < zero;
  skf_vd whole = c->half + c->half, part = vd_select(cut_hi, d->rim - chi0, chi1 + d->rim);
  skf_vd length = vd_select(cut_lo & cut_hi, d->rim + d->rim, vd_select(cut_lo | cut_hi, part, vd_set(0.5) * whole));
  skf_vd lo = vd_select(cut_lo, -d->rim, chi0), hi = vd_select(cut_hi, d->rim, chi1);
  return (window_view){vd_set(0.5) * (lo + hi), vd_set(0.5) * length, vd_select(cut_lo, zero, below),
                       vd_select(cut_hi, zero, above), d->some & (hi > lo) & (length > zero)};
}

typedef struct arc_sum {
  skf_vd F, cc, ss; /* int h, int g cos^2, int g sin^2 by units of the caller's */
} arc_sum;

/* m^2 (c2 + c3 m) and minus half its slope, m = (R^2 - r^2) / R^2 */
SKF_INLINE void window_add(skf_vd m, skf_vd w, skf_vd sin, skf_vd cos, double c2, double c3, arc_sum *s) {
  skf_vd wm = w * m;
  s->F = vd_fma(wm * m, vd_fma(vd_set(c3), m, vd_set(c2)), s->F);
  wm *= vd_fma(vd_set(3 * c3), m, vd_set(2 * c2));
  s->cc = vd_fma(wm, cos * cos, s->cc);
  s->ss = vd_fma(wm, sin * sin, s->ss);
}

SKF_INLINE void polynomial_window(const compact_arc_row *c, const disc_view *d, const window_view *w, double c2,
                                  double c3, bool even, arc_sum *sum) {
  if (!vi_any(w->some)) return;
  int n = c3 == 0 ? 18 : 20;
  const skf_gauss_node *node = skf_gauss_rule(n) + n / 2;
  skf_vsincos mid = vd_sincos(w->mid), hi = vd_sincos(w->gap_hi + w->half), lo = vd_sincos(w->gap_lo + w->half);
  skf_vd per_R2 = c->per_R * c->per_R, zero = vd_set(0), qb = d->qb * per_R2, spread = d->spread * per_R2;
  arc_sum s = {zero, zero, zero};
  for (int j = 0; j < n / 2; j++) {
    skf_vsincos v = vd_sincos(w->half * vd_set(node[j].x));
    for (int turn = 0; turn < (even ? 1 : 2); turn++) {
      skf_vd t = turn ? -v.sin : v.sin;
      skf_vd sin = vd_fma(mid.sin, v.cos, mid.cos * t), cos = vd_fma(mid.cos, v.cos, -(mid.sin * t));
      skf_vd up = vd_fma(hi.sin, v.cos, -(hi.cos * t)), down = vd_fma(lo.sin, v.cos, lo.cos * t);
      skf_vd m = vd_select(d->cut, spread * up * down, vd_fma(spread, cos * cos, qb));
      window_add(m, vd_set((even ? 2 : 1) * node[j].w), sin, cos, c2, c3, &s);
    }
  }
  sum->F += (skf_vd)((skf_vi)(w->half * s.F) & w->some);
  sum->cc += (skf_vd)((skf_vi)(w->half * s.cc) & w->some);
  sum->ss += (skf_vd)((skf_vi)(w->half * s.ss) & w->some);
}

SKF_INLINE skf_vvalue compact_finish(const compact_arc_row *c, const arc_view *f, const disc_view *d, const arc_sum *s,
                                     skf_vd slope, skf_vd ends) {
  skf_vd rho2 = c->arc.rho + c->arc.rho, g = rho2 * slope;
  arc_view near = *f;
  near.good = f->beta < vd_set(INFINITY);
  ends = (skf_vd)((skf_vi)ends & d->some);
  return arc_finish(&c->arc, &near, rho2 * s->F, g * s->cc, g * s->ss, ends, ~d->near);
}

/* q0, q1: R^2 - r^2 at the ends; turn = (q0 - q1) / k; and rho (h0 - h1) / k */
typedef struct tips_view {
  skf_vd q0, q1, turn;
} tips_view;

SKF_INLINE tips_view arc_tips(const compact_arc_row *c, const arc_view *f, disc_view *d, skf_vd *chi0) {
  ends_view t = arc_ends(&c->arc, f);
  skf_vd q0 = vd_fma(d->qa, t.c0 * t.c0, d->qb * (t.s0 * t.s0)), q1 = vd_fma(d->qa, t.c1 * t.c1, d->qb * (t.s1 * t.s1));
  d->near |= d->some & (vd_set(1024) * vd_min(vd_abs(q0), vd_abs(q1)) < c->R2);
  *chi0 = vd_set(-0.5) * vd_atan2(f->uy, f->ux);
  return (tips_view){q0, q1, vd_set(4) * c->arc.rho * t.rise};
}

SKF_INLINE skf_vvalue polynomial_arc(const compact_arc_row *c, skf_v3d x, double c2, double c3) {
  arc_view f = arc_see(&c->arc, x);
  disc_view d = arc_disc(c, &f);
  skf_vd zero = vd_set(0), chi0, per_R2 = c->per_R * c->per_R;
  arc_sum s = {zero, zero, zero};
  if (!vi_any(d.some)) return compact_finish(c, &f, &d, &s, vd_set(-2) * per_R2, zero);
  tips_view t = arc_tips(c, &f, &d, &chi0);
  skf_vd chi1 = chi0 + c->half, turn = vd_set(SKF_PI);
  window_view front = arc_window(c, &d, chi0, chi1), back = arc_window(c, &d, chi0 - turn, chi1 - turn);
  polynomial_window(c, &d, &front, c2, c3, false, &s);
  polynomial_window(c, &d, &back, c2, c3, false, &s);
  skf_vi in0 = t.q0 > zero, in1 = t.q1 > zero;
  skf_vd m0 = vd_max(t.q0, zero) * per_R2, m1 = vd_max(t.q1, zero) * per_R2, sum = m0 + m1;
  skf_vd dm = vd_select(in0 & in1, t.turn * per_R2, (m0 - m1) / vd_select(in0 | in1, f.k, vd_set(1)));
  skf_vd ends = c->arc.rho * dm * vd_fma(vd_set(c3), vd_fma(sum, sum, -(m0 * m1)), vd_set(c2) * sum);
  return compact_finish(c, &f, &d, &s, vd_set(-2) * per_R2, ends);
}

SKF_INLINE skf_vvalue polynomial_circle(const compact_arc_row *c, skf_v3d x, double c2, double c3) {
  arc_view f = arc_see(&c->arc, x);
  disc_view d = arc_disc(c, &f);
  skf_vd zero = vd_set(0);
  arc_sum s = {zero, zero, zero};
  window_view w = {zero, d.rim, zero, zero, d.some};
  polynomial_window(c, &d, &w, c2, c3, true, &s);
  return compact_finish(c, &f, &d, &s, vd_set(-2) * c->per_R * c->per_R, zero);
}

#ifndef SKF_VEC_FLOAT
SKF_OUTLINE skf_vvalue quartic_arc(const compact_arc_row *c, skf_v3d x) { return polynomial_arc(c, x, 1, 0); }
SKF_OUTLINE skf_vvalue quartic_circle(const compact_arc_row *c, skf_v3d x) { return polynomial_circle(c, x, 1, 0); }
SKF_OUTLINE skf_vvalue soft_object_arc(const compact_arc_row *c, skf_v3d x) {
  return polynomial_arc(c, x, 5. / 9, 4. / 9);
}
SKF_OUTLINE skf_vvalue soft_object_circle(const compact_arc_row *c, skf_v3d x) {
  return polynomial_circle(c, x, 5. / 9, 4. / 9);
}

SKF_BATCH_FORM(quartic_arc, compact_arc, skf_again_none)
SKF_BATCH_FORM(quartic_circle, compact_arc, skf_again_none)
SKF_BATCH_FORM(soft_object_arc, compact_arc, skf_again_none)
SKF_BATCH_FORM(soft_object_circle, compact_arc, skf_again_none)
#endif

#endif
