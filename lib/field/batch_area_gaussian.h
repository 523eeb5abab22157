/* SPDX-License-Identifier: MIT */
/* Vector forms: Gaussians over a triangle, as triangle_gaussian.c. */
#ifndef SKF_FIELD_BATCH_AREA_GAUSSIAN_H
#define SKF_FIELD_BATCH_AREA_GAUSSIAN_H

#include "field/batch_area_slices.h"
#include "field/batch_segment_smooth.h"

/* Moments of gaussian_span_row for any width up to 1, else those of width 0. */
SKF_INLINE void gaussian_moments(skf_vd width, skf_vd m[GAUSSIAN_MOMENTS]) {
  static const double per_factorial[GAUSSIAN_MOMENTS] = {1,          1. / 2,       1. / 24,       1. / 720,
                                                         1. / 40320, 1. / 3628800, 1. / 479001600};
  skf_vd pp = (skf_vd)((skf_vi)(vd_set(0.5) * width * width) & (width <= vd_set(1))), s = vd_set(1. / 27);
  for (int n = 12; n >= 0; n--) {
    s = vd_fma(pp, s, vd_set(1)) * vd_set(1. / (2 * n + 1));
    if (n < GAUSSIAN_MOMENTS) m[n] = s * vd_set(per_factorial[n]);
  }
}

SKF_INLINE skf_vd vd_ceil(skf_vd x) {
  const skf_vd shift = vd_set(SKF_PICK(0x1.8p52, 0x1.8p23));
  return ((x + vd_set(0.5)) + shift) - shift;
}

/* An edge's part of F over exp(-a^2 z^2) / 2 a^2 near the triangle (H-form), over -1 / 2 a^2 beside it (G-form), in
   units of d: both between b1 and b2 by panels of 16 nodes. */
typedef struct gaussian_cut {
  skf_vd b1, b2, count;
} gaussian_cut;

SKF_INLINE gaussian_cut gaussian_edge_cut(const area_row *c, skf_vd l1, skf_vd l2, skf_vi beside) {
  skf_vd zero = vd_set(0), one = vd_set(1), near = vd_max(vd_max(l1, -l2), zero), a = c->param;
  skf_vd cut = vd_select(beside, vd_sqrt(vd_fma(near, near, vd_set(42) * c->per_param2)), vd_set(6.3) * c->per_param);
  gaussian_cut v = {vd_min(vd_max(l1, -cut), cut), vd_max(vd_min(l2, cut), -cut), one};
  skf_vd panels = a * (v.b2 - v.b1) * vd_select(beside, vd_set(1 / 1.5), vd_set(1 / 2.5));
  skf_vd steep = c->param2 * (vd_max(v.b1 * v.b1, v.b2 * v.b2) - near * near) * vd_set(0.125);
  panels = vd_max(panels, vd_select(beside & (near > zero), steep, zero));
  v.count = vd_select(v.b2 > v.b1, vd_max(vd_ceil(panels), one), zero);
  return v;
}

/* int (1 - exp(-a^2 rho^2)) / rho^2 dl, or int exp(-a^2 r^2) / rho^2 dl beside */
SKF_INLINE skf_vd gaussian_edge(const area_row *c, const area_view *f, int i, skf_vi some, skf_vi beside,
                                const gaussian_cut *e) {
  enum { N = SKF_COUNT(16, 8) };
  const skf_gauss_node *node = skf_gauss_rule(N);
  skf_vd zero = vd_set(0), half = vd_set(0.5), count = (skf_vd)((skf_vi)e->count & some), sum = zero;
  skf_vd h = (e->b2 - e->b1) / vd_max(count, vd_set(1)), dd = f->d[i] * f->d[i], extra = vd_select(beside, f->zz, zero);
  for (int k = 0;; k++) {
    skf_vi active = vd_set(k) < count;
    if (!vi_any(active)) break;
    skf_vd mid = vd_fma(vd_set(k + 0.5), h, e->b1), part = zero;
    mid = vd_select(active, mid, e->b1);
    for (int j = 0; j < N; j++) {
      skf_vd l = vd_fma(half * h, vd_set(node[j].x), mid), rho2 = vd_fma(l, l, dd);
      skf_vexp p = vd_exp_parts(-vd_min(c->param2 * (rho2 + extra), vd_set(VD_EXP_MAX)));
      skf_vd top = vd_select(beside, (vd_set(1) + p.part) * p.scale, -vd_exp_less_1(p));
      /* (1 - exp(-a^2 rho^2)) / rho^2 at rho = 0 */
      skf_vd inner = vd_select(rho2 > vd_set(SKF_PICK(1e-280, 1e-30)), top / rho2, c->param2);
      part = vd_fma(vd_set(node[j].w), inner, part);
    }
    sum += (skf_vd)((skf_vi)part & active);
  }
  return half * h * sum;
}

SKF_INLINE skf_vvalue gaussian_edges(const area_row *c, const area_view *f, skf_vi good) {
  skf_vd zero = vd_set(0), a = c->param, a2 = c->param2, least = vd_set(INFINITY), most = vd_set(VD_EXP_MAX);
  area_sum sum = {zero, zero, {zero, zero, zero}, zero, zero};
  skf_vi beside = a2 * f->lat2 > vd_set(1);
  skf_vd over = vd_exp(-vd_min(a2 * f->zz, most)), cut = vd_set(6.3) * c->per_param;
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3;
    skf_vd d = f->d[i], l1 = f->l1[i], l2 = f->l2[i], dd = d * d, m[GAUSSIAN_MOMENTS];
    gaussian_view w = gaussian_see(a2 * f->r2[i], a2 * f->r2[j], a2 * (dd + f->zz), a * l1, a * l2, a * c->T.L[i]);
    gaussian_moments(w.width, m);
    gaussian_value J = gaussian_between(&w, m);
    sum.J[i] = (skf_vd)((skf_vi)(c->per_param * J.F) & (J.least < most)), least = vd_min(least, J.least);
    gaussian_cut e = gaussian_edge_cut(c, l1, l2, beside);
    skf_vd F = d * gaussian_edge(c, f, i, good, beside, &e);
    skf_vi low = ~beside & (l1 < -cut), high = ~beside & (l2 > cut);
    if (vi_any(low | high)) { /* only the angle remains */
      skf_vd to = vd_min(l2, -cut), from = vd_max(l1, cut), none = vd_set(1);
      skf_vd A = vd_atan2(d * (to - l1), vd_select(low, vd_fma(d, d, l1 * to), none));
      skf_vd B = vd_atan2(d * (l2 - from), vd_select(high, vd_fma(d, d, l2 * from), none));
      F += (skf_vd)((skf_vi)A & low) + (skf_vd)((skf_vi)B & high);
    }
    F *= vd_set(0.5) * c->per_param2 * vd_select(beside, vd_set(-1), over);
    sum.F += F, sum.abs_F += vd_abs(F);
  }
  skf_vd slope = vd_set(-2) * a2 * f->z, loss = vd_fma(a2, f->dist2, vd_set(1));
  sum.Z = slope * sum.F, sum.abs_Z = vd_abs(slope) * sum.abs_F;
  good &= (a2 * f->dist2 < vd_set(GAUSSIAN_SEEN)) & (sum.abs_F * loss <= vd_set(1000) * sum.F);
  return area_gather(c, f, &sum, good);
}

/* (a diam)^2 max(1, (a dist)^2): how much the exponent changes over the triangle */
SKF_INLINE skf_vd gaussian_change2(const area_row *c, const area_view *f) {
  return c->param2 * (c->diam * c->diam) * vd_max(vd_set(1), c->param2 * f->dist2);
}

SKF_OUTLINE skf_vvalue gaussian_triangle(const gaussian_area_row *row, skf_v3d x) {
  const area_row *c = &row->area;
  area_view f = area_see(c, x);
  skf_vd zero = vd_set(0), y = c->param2 * f.dist2;
  skf_vi gone = (y > vd_set(VD_EXP_ZERO)) & (y < vd_set(INFINITY));
  skf_vi even = (gaussian_change2(c, &f) < vd_set(0.5)) & (y < vd_set(GAUSSIAN_SEEN)), edges = ~(gone | even);
  skf_vvalue v = {zero, {zero, zero, zero}, gone};
  if (vi_any(even)) v = area_either(even, area_rule(AREA_GAUSSIAN, c, &f, SKF_COUNT(9, 5), even), v);
  if (!vi_any(edges)) return v;
  skf_vvalue s = gaussian_slices(row, &f);
  v = area_either(edges & s.good, s, v), edges &= ~s.good;
  return vi_any(edges) ? area_either(edges, gaussian_edges(c, &f, edges), v) : v;
}

/* Small triangles where the edges cancel */
SKF_OUTLINE skf_vvalue gaussian_triangle_small(const gaussian_area_row *row, skf_v3d x) {
  const area_row *c = &row->area;
  area_view f = area_see(c, x);
  skf_vi even = (gaussian_change2(c, &f) < vd_set(9)) & (c->param2 * c->diam * c->diam < vd_set(2.25));
  even &= c->param2 * f.dist2 < vd_set(GAUSSIAN_SEEN);
  return vi_any(even) ? area_rule(AREA_GAUSSIAN, c, &f, SKF_COUNT(15, 8), even) : (skf_vvalue){.good = vi_set(0)};
}

SKF_BATCH_FORM(gaussian_triangle, gaussian_area, gaussian_triangle_small)

#endif
