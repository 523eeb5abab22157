/* SPDX-License-Identifier: MIT */
/* skf_panels_over for several edges at once: composite Gauss-Legendre after l = delta sinh t. Each lane has its own
   number of panels; those that are done add nodes of weight 0. */
#ifndef SKF_FIELD_BATCH_PANEL_H
#define SKF_FIELD_BATCH_PANEL_H

#include "field/batch_area.h"

enum { PANEL_NODES = SKF_COUNT(14, 8) };

typedef struct panel_view {
  skf_vd start, step, count, delta, mid, half; /* panels in t; or one in l about `mid` where the edge is short */
  skf_vd sinh[PANEL_NODES / 2], cosh[PANEL_NODES / 2]; /* of the nodes' distances from their panel's middle */
  skf_vd sinh_mid, cosh_mid;                           /* of the panel's */
  skf_vi plain, some, active;
} panel_view;

/* log((l + hypot(l, delta)) / delta), l >= 0, r = hypot(l, delta) */
SKF_INLINE skf_vd panel_asinh(skf_vd l, skf_vd r, skf_vd delta) {
  return vd_log_ratio(l + r, delta, l + (l * l) / (r + delta));
}

/* delta for an integrand singular at distance d from the edge's line */
SKF_INLINE skf_vd panel_scale(skf_vd d, skf_vd l1, skf_vd l2) {
  skf_vd near = vd_max(vd_max(l1, -l2), vd_set(0));
  return vd_max(vd_abs(d), vd_set(1e-3) * near);
}

/* Lanes with l1 < l2 and delta > 0 in `some`; length = l2 - l1. */
SKF_INLINE panel_view panel_over(skf_vd l1, skf_vd l2, skf_vd length, skf_vd delta, skf_vi some) {
  /* (sinh(x) / x - 1) / x^2 and (cosh x - 1) / x^2 */
  static const double s[] = {1. / 6,        1. / 120,         1. / 5040,          1. / 362880,
                             1. / 39916800, 1. / 6227020800., 1. / 1307674368000.};
  static const double c[] = {1. / 2,       1. / 24,        1. / 720,          1. / 40320,
                             1. / 3628800, 1. / 479001600, 1. / 87178291200., 1. / 20922789888000.};
  skf_vd one = vd_set(1), zero = vd_set(0), half = vd_set(0.5);
  l1 = vd_select(some, l1, zero), l2 = vd_select(some, l2, one), delta = vd_select(some, delta, one);
  length = vd_select(some, length, one);
  skf_vd r1 = vd_sqrt(vd_fma(l1, l1, delta * delta)), r2 = vd_sqrt(vd_fma(l2, l2, delta * delta));
  skf_vd A1 = panel_asinh(vd_abs(l1), r1, delta), A2 = panel_asinh(vd_abs(l2), r2, delta);
  skf_vi right = l1 >= zero, left = l2 <= zero;
  skf_vd base = vd_select(right, l1 + r1, r2 - l2), top = length * (one + vd_abs(l1 + l2) / (r1 + r2));
  skf_vi aside = right | left;
  base = vd_select(aside, base, one), top = vd_select(aside, top, one);
  skf_vd T = vd_select(aside, vd_log_ratio(base + top, base, top), A1 + A2);
  panel_view p = {.plain = T < vd_set(0.25), .some = some, .delta = delta, .half = half * length};
  const skf_vd shift = vd_set(SKF_PICK(0x1.8p52, 0x1.8p23));
  p.count = vd_max((vd_fma(T, vd_set(1 / 1.6), vd_set(0.49)) + shift) - shift, one);
  p.count = vd_select(some, vd_select(p.plain, one, p.count), zero);
  p.start = vd_select(l1 < zero, -A1, A1), p.step = T / vd_max(p.count, one), p.mid = half * (l1 + l2);
  const skf_gauss_node *node = skf_gauss_rule(PANEL_NODES) + PANEL_NODES / 2;
  for (int j = 0; j < PANEL_NODES / 2; j++) {
    skf_vd x = half * p.step * vd_set(node[j].x), xx = x * x;
    p.sinh[j] = vd_fma(x * xx, vd_estrin(s, 7, xx), x), p.cosh[j] = vd_fma(xx, vd_estrin(c, 8, xx), one);
  }
  return p;
}

/* Whether there is a panel k; makes it ready. */
SKF_INLINE bool panel_next(panel_view *p, int k) {
  p->active = vd_set(k) < p->count;
  if (!vi_any(p->active)) return false;
  skf_vd half = vd_set(0.5), t = vd_fma((skf_vd)((skf_vi)vd_set(k) & p->active) + half, p->step, p->start);
  skf_vd e = vd_exp(vd_select(p->plain | ~p->active, vd_set(0), t)), inv = vd_set(1) / e;
  p->sinh_mid = half * (e - inv), p->cosh_mid = half * (e + inv);
  return true;
}

/* Node j of the panel that is ready, and its weight. */
SKF_INLINE void panel_node(const panel_view *p, int j, skf_vd *l, skf_vd *w) {
  const int h = PANEL_NODES / 2, i = j < h ? j : j - h;
  const skf_gauss_node *node = skf_gauss_rule(PANEL_NODES) + h;
  skf_vd sign = vd_set(j < h ? 1 : -1), s = sign * p->sinh[i];
  skf_vd sinh = vd_fma(p->sinh_mid, p->cosh[i], p->cosh_mid * s),
         cosh = vd_fma(p->cosh_mid, p->cosh[i], p->sinh_mid * s);
  *l = vd_select(p->plain, vd_fma(p->half, sign * vd_set(node[i].x), p->mid), p->delta * sinh);
  skf_vd weight = vd_set(node[i].w) * vd_select(p->plain, p->half, vd_set(0.5) * p->step * p->delta * cosh);
  *w = (skf_vd)((skf_vi)weight & p->active);
}

#endif
