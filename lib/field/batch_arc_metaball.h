/* SPDX-License-Identifier: MIT */
/* Vector forms: the metaball along an arc or a circle. Integrals of h and of g times squares of cos chi and sin chi are
   even in chi and have the period pi: folded into [0, pi / 2], where r grows, an arc is the sum or the difference of
   two intervals. Each has a part in the core, r < R / 3, where antiderivatives are elementary, and one in the shell, up
   to R, for a Gauss rule. */
#ifndef SKF_FIELD_BATCH_ARC_METABALL_H
#define SKF_FIELD_BATCH_ARC_METABALL_H

#include "field/batch_arc_compact.h"
#include "field/batch_span.h"
#include "num/gauss.h"

/* An angle in [0, pi / 2] */
typedef struct angle_view {
  skf_vd s, c;
} angle_view;

SKF_INLINE skf_vd angle_gap(angle_view a, angle_view b) { return vd_fms(b.s, a.c, a.s * b.c); }
SKF_INLINE angle_view angle_select(skf_vi m, angle_view a, angle_view b) {
  return (angle_view){vd_select(m, a.s, b.s), vd_select(m, a.c, b.c)};
}
SKF_INLINE angle_view angle_min(angle_view a, angle_view b) { return angle_select(angle_gap(a, b) < vd_set(0), b, a); }
SKF_INLINE angle_view angle_max(angle_view a, angle_view b) { return angle_select(angle_gap(a, b) < vd_set(0), a, b); }

/* The disc with the angles where r = R / 3 and r = R: 0 where all is farther, pi / 2 where all is nearer */
typedef struct shells_view {
  disc_view disc;
  angle_view core, rim;
  skf_vi cored;
} shells_view;

SKF_INLINE shells_view arc_shells(const compact_arc_row *c, const arc_view *f) {
  skf_vd zero = vd_set(0), one = vd_set(1), third2 = c->R2 * vd_set(1. / 9);
  shells_view v = {.disc = arc_disc(c, f)};
  skf_vd in = third2 - f->alpha, out = f->beta - third2;
  skf_vi whole = out <= zero, split = (in > zero) & ~whole;
  v.cored = v.disc.some & (whole | (in > zero));
  /* sums of these differences, not `spread`, so that the squares add up to 1 in a large support, too */
  skf_vd per = one / vd_select(split, in + out, one), per_rim = one / vd_select(v.disc.cut, v.disc.qa - v.disc.qb, one);
  v.core.s = vd_select(split, vd_sqrt(vd_max(in, zero) * per), (skf_vd)((skf_vi)one & whole));
  v.core.c = vd_select(split, vd_sqrt(vd_max(out, zero) * per), (skf_vd)((skf_vi)one & ~whole));
  v.rim.s = vd_select(v.disc.cut, vd_sqrt(vd_max(v.disc.qa, zero) * per_rim), one);
  v.rim.c = vd_select(v.disc.cut, vd_sqrt(vd_max(-v.disc.qb, zero) * per_rim), zero);
  return v;
}

/* What is not in `some` may be infinite. */
SKF_INLINE void arc_sum_add(arc_sum *sum, const arc_sum *part, skf_vd by, skf_vi some) {
  sum->F += (skf_vd)((skf_vi)(by * part->F) & some);
  sum->cc += (skf_vd)((skf_vi)(by * part->cc) & some);
  sum->ss += (skf_vd)((skf_vi)(by * part->ss) & some);
}

/* An interval in the core, `by` times: h = 1 - 3 r^2 / R^2 */
SKF_INLINE void core_add(const compact_arc_row *c, const arc_view *f, const shells_view *v, angle_view lo,
                         angle_view hi, skf_vd by, arc_sum *sum) {
  skf_vd zero = vd_set(0), half = vd_set(0.5), one = vd_set(1);
  hi = angle_min(hi, v->core);
  skf_vd sin = angle_gap(lo, hi);
  skf_vi some = v->cored & (sin > zero);
  if (!vi_any(some)) return;
  skf_vd cos = vd_fma(hi.c, lo.c, hi.s * lo.s), both = vd_fms(hi.c, lo.c, hi.s * lo.s),
         across = hi.s * lo.c + hi.c * lo.s;
  skf_vd delta = vd_atan2(vd_max(sin, zero), vd_select(some, cos, one)), base = half * span_gap3(delta, sin);
  /* the squared cosine and sine of their mean */
  skf_vd most = half + half * vd_abs(both), least = half * half * across * across / most;
  skf_vi front = both >= zero;
  skf_vd cc = vd_fma(sin, vd_select(front, most, least), base), ss = vd_fma(sin, vd_select(front, least, most), base);
  skf_vd per_R2 = c->per_R * c->per_R;
  arc_sum part = {vd_fnma(vd_set(3) * per_R2, vd_fma(f->alpha, cc, f->beta * ss), delta), cc + cc, ss + ss};
  arc_sum_add(sum, &part, by, some);
}

/* An interval in the shell, `by` times: h = 3/2 m^2, m = 1 - r / R. With tan chi = N / D, N and D linear in t from -1
   to 1, dchi = const dt / (N^2 + D^2); the ratio of the ends' weights, a free choice, keeps r = 0 and tan chi = +-i,
   where this is not smooth, far off: mostly less than 1e-16 is left, 4e-16 at worst. */
typedef struct shell_view {
  skf_vd N0, N1, D0, D1, U0, U1, V0, V1, by;
  skf_vi some;
} shell_view;

SKF_INLINE shell_view arc_shell(const arc_view *f, const shells_view *v, angle_view lo, angle_view hi, skf_vd by) {
  const disc_view *d = &v->disc;
  lo = angle_max(lo, v->core), hi = angle_min(hi, v->rim);
  skf_vd zero = vd_set(0), one = vd_set(1), gap = angle_gap(lo, hi);
  shell_view w = {.some = d->some & (gap > zero)};
  skf_vd low2 = vd_fma(f->alpha, lo.c * lo.c, f->beta * (lo.s * lo.s));
  skf_vd high2 = vd_fma(f->alpha, hi.c * hi.c, f->beta * (hi.s * hi.s));
  skf_vd scale = vd_fma(vd_set(0.47), low2 / vd_select(w.some, high2, one), vd_set(0.53));
  hi.s *= scale, hi.c *= scale;
  /* cut: R^2 - r^2 = spread sin(rim - chi) sin(rim + chi) */
  skf_vd below = vd_max(angle_gap(lo, v->rim), zero), beside = vd_max(angle_gap(hi, v->rim), zero);
  skf_vd sum_lo = vd_fma(v->rim.s, lo.c, v->rim.c * lo.s), sum_hi = vd_fma(v->rim.s, hi.c, v->rim.c * hi.s);
  w.N0 = lo.s + hi.s, w.N1 = hi.s - lo.s, w.D0 = lo.c + hi.c, w.D1 = hi.c - lo.c;
  w.U0 = below + beside, w.U1 = beside - below;
  w.V0 = (sum_lo + sum_hi) * d->spread, w.V1 = (sum_hi - sum_lo) * d->spread;
  w.by = by * (gap + gap) * scale;
  return w;
}

/* A node's tan chi = N / D: N^2, D^2, r p where p = N^2 + D^2, and what is made of them */
enum { SHELL_NODES = SKF_COUNT(24, 12) };
typedef struct shell_node {
  skf_vd NN, DD, rp, e;
} shell_node;

SKF_INLINE void shell_root(const arc_view *f, const shell_view *w, double at, shell_node *n) {
  skf_vd t = vd_set(at), N = vd_fma(t, w->N1, w->N0), D = vd_fma(t, w->D1, w->D0);
  n->NN = N * N, n->DD = D * D;
  n->rp = vd_sqrt(vd_fma(f->alpha, n->DD, f->beta * n->NN) * (n->NN + n->DD));
}

SKF_INLINE void shell_quotient(const compact_arc_row *c, const disc_view *d, const shell_view *w, double at,
                               shell_node *n) {
  skf_vd t = vd_set(at), p = n->NN + n->DD, uncut = vd_fma(d->qa, n->DD, d->qb * n->NN);
  skf_vd q = vd_select(d->cut, vd_fma(t, w->U1, w->U0) * vd_fma(t, w->V1, w->V0), uncut); /* p (R^2 - r^2) */
  n->e = q / (vd_fma(c->R, p, n->rp) * (n->rp * p));
}

SKF_INLINE void shell_sum(double weight, const shell_node *n, arc_sum *s) {
  skf_vd w = vd_set(weight), we = w * n->e, up = n->e * n->rp;
  s->F = vd_fma(w * (n->NN + n->DD), up * up, s->F);
  s->cc = vd_fma(we, n->DD, s->cc), s->ss = vd_fma(we, n->NN, s->ss);
}

SKF_INLINE void shell_end(const compact_arc_row *c, const shell_view *w, arc_sum *s, arc_sum *sum) {
  s->F *= vd_set(1.5) * c->per_R * c->per_R;
  arc_sum_add(sum, s, w->by, w->some);
}

/* Loop after loop: what waits for roots and quotients would fill the scheduler. */
SKF_INLINE void shells_add(const compact_arc_row *c, const arc_view *f, const disc_view *d, const shell_view *a,
                           const shell_view *b, arc_sum *sum) {
  const skf_gauss_node *node = skf_gauss_rule(SHELL_NODES);
  shell_node n[SHELL_NODES], m[SHELL_NODES];
  const skf_vd zero = vd_set(0);
  arc_sum s = {zero, zero, zero}, t = s;
  SKF_ROLLED for (int j = 0; j < SHELL_NODES; j++) shell_root(f, a, node[j].x, n + j);
  SKF_ROLLED for (int j = 0; j < SHELL_NODES; j++) shell_quotient(c, d, a, node[j].x, n + j);
  if (!b) {
    SKF_ROLLED for (int j = 0; j < SHELL_NODES; j++) shell_sum(node[j].w, n + j, &s);
    shell_end(c, a, &s, sum);
    return;
  }
  SKF_ROLLED for (int j = 0; j < SHELL_NODES; j++) {
    shell_root(f, b, node[j].x, m + j);
    shell_sum(node[j].w, n + j, &s);
  }
  SKF_ROLLED for (int j = 0; j < SHELL_NODES; j++) shell_quotient(c, d, b, node[j].x, m + j);
  SKF_ROLLED for (int j = 0; j < SHELL_NODES; j++) shell_sum(node[j].w, m + j, &t);
  shell_end(c, a, &s, sum), shell_end(c, b, &t, sum);
}

/* What an arc comes to in [0, pi / 2]: from a to b `first` times and from c to d `second` times. */
typedef struct fold_view {
  angle_view a, b, c, d;
  skf_vd first, second;
} fold_view;

SKF_INLINE fold_view arc_fold(const ends_view *t) {
  skf_vd zero = vd_set(0), one = vd_set(1);
  const angle_view none = {zero, one}, right = {one, zero};
  skf_vi turned = (skf_vi)(vd_sign(t->c0)); /* chi0 between -pi / 2 and pi / 2, chi1 less than pi beyond */
  skf_vd s0 = (skf_vd)((skf_vi)t->s0 ^ turned), s1 = (skf_vd)((skf_vi)t->s1 ^ turned);
  skf_vd c1 = (skf_vd)((skf_vi)t->c1 ^ turned);
  const angle_view p = {vd_abs(s0), vd_abs(t->c0)}, q = {vd_abs(s1), vd_abs(c1)};
  skf_vi below = s0 < zero, down = s1 < zero, back = c1 < zero;
  /* the quarters are -1 or 0 for chi0, from there to 2 for chi1 */
  skf_vi at_0 = below & ~back & ~down, at_right = ~below & back & ~down,
         same = (below & ~back & down) | (~below & ~back & ~down);
  skf_vi once = at_0 | at_right, apart = ~once;
  fold_view v;
  v.a = angle_select(apart, angle_min(p, q), angle_select(at_0, none, p));
  v.b = angle_select(apart, angle_max(p, q), angle_select(at_0, p, right));
  v.c = angle_select(at_right, q, none);
  v.d = angle_select(at_0, q, right);
  v.first = vd_select(once | same, one, -one);
  v.second = vd_select(once, one, vd_select(same, zero, one + one));
  return v;
}

/* rho (h(r0) - h(r1)) / k as arc_ends in metaball.c; near: where R^2 - r^2 of an end cancels */
SKF_INLINE skf_vd arc_shell_ends(const compact_arc_row *c, const arc_view *f, shells_view *v, const ends_view *t) {
  disc_view *d = &v->disc;
  skf_vd zero = vd_set(0), one = vd_set(1), three = vd_set(3), R = c->R, per_R = c->per_R, per_R2 = per_R * per_R;
  skf_vd q0 = vd_fma(d->qa, t->c0 * t->c0, d->qb * (t->s0 * t->s0));
  skf_vd q1 = vd_fma(d->qa, t->c1 * t->c1, d->qb * (t->s1 * t->s1));
  d->near |= d->some & (vd_set(1024) * vd_min(vd_abs(q0), vd_abs(q1)) < c->R2);
  skf_vd r0 = vd_sqrt(vd_fma(f->alpha, t->c0 * t->c0, f->beta * (t->s0 * t->s0)));
  skf_vd r1 = vd_sqrt(vd_fma(f->alpha, t->c1 * t->c1, f->beta * (t->s1 * t->s1)));
  skf_vd turn = vd_set(4) * c->arc.rho * t->rise, sum = r0 + r1, inv = one / ((R + r0) * (R + r1));
  skf_vd m0 = vd_max(q0, zero) * ((R + r1) * inv) * per_R, m1 = vd_max(q1, zero) * ((R + r0) * inv) * per_R;
  skf_vd u0 = vd_max(vd_fma(three * per_R, r0, -one), zero), u1 = vd_max(vd_fma(three * per_R, r1, -one), zero);
  skf_vd slope = turn * per_R / sum, most = three * vd_abs(slope) * f->k,
         per_k = one / vd_select(f->k > zero, f->k, one);
  skf_vi core0 = u0 <= zero, core1 = u1 <= zero;
  skf_vd h0 = vd_select(core0, vd_fnma(three * per_R2, r0 * r0, one), vd_set(1.5) * m0 * m0);
  skf_vd h1 = vd_select(core1, vd_fnma(three * per_R2, r1 * r1, one), vd_set(1.5) * m1 * m1);
  u0 = vd_min(u0, most), u1 = vd_min(u1, most);
  skf_vd inner = vd_fma(three * per_R2, turn, vd_set(0.5) * (u0 - u1) * per_k * (u0 + u1));
  skf_vd outer = vd_set(1.5) * (m0 + m1) * slope;
  skf_vd both = vd_select(core0 | core1, inner, outer);
  return c->arc.rho * vd_select((q0 > zero) & (q1 > zero), both, (h0 - h1) * per_k);
}

SKF_OUTLINE skf_vvalue metaball_arc(const compact_arc_row *c, skf_v3d x) {
  arc_view f = arc_see(&c->arc, x);
  shells_view v = arc_shells(c, &f);
  skf_vd zero = vd_set(0), slope = vd_set(-3) * c->per_R * c->per_R;
  arc_sum s = {zero, zero, zero};
  if (!vi_any(v.disc.some)) return compact_finish(c, &f, &v.disc, &s, slope, zero);
  ends_view t = arc_ends(&c->arc, &f);
  fold_view w = arc_fold(&t);
  if (vi_any(v.cored)) core_add(c, &f, &v, w.a, w.b, w.first, &s), core_add(c, &f, &v, w.c, w.d, w.second, &s);
  shell_view first = arc_shell(&f, &v, w.a, w.b, w.first), second = arc_shell(&f, &v, w.c, w.d, w.second);
  shells_add(c, &f, &v.disc, &first, &second, &s);
  return compact_finish(c, &f, &v.disc, &s, slope, arc_shell_ends(c, &f, &v, &t));
}

SKF_OUTLINE skf_vvalue metaball_circle(const compact_arc_row *c, skf_v3d x) {
  arc_view f = circle_see(&c->arc, x);
  shells_view v = arc_shells(c, &f);
  skf_vd zero = vd_set(0), one = vd_set(1), slope = vd_set(-3) * c->per_R * c->per_R;
  arc_sum s = {zero, zero, zero};
  const angle_view none = {zero, one}, right = {one, zero};
  if (vi_any(v.cored)) core_add(c, &f, &v, none, right, vd_set(2), &s);
  shell_view shell = arc_shell(&f, &v, none, right, vd_set(2));
  if (vi_any(shell.some)) shells_add(c, &f, &v.disc, &shell, NULL, &s);
  return compact_finish(c, &f, &v.disc, &s, slope, zero);
}

SKF_BATCH_FORM(metaball_arc, compact_arc, skf_again_none)
SKF_BATCH_FORM(metaball_circle, compact_arc, skf_again_none)

#endif
