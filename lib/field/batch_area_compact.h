/* SPDX-License-Identifier: MIT */
/* Vector forms: quartic and soft object over a triangle, as triangle_compact.c, whose H-form with its exact Gauss rules
   serves all points but those far beside the triangle in terms of the disc that the support cuts from its plane. */
#ifndef SKF_FIELD_BATCH_AREA_COMPACT_H
#define SKF_FIELD_BATCH_AREA_COMPACT_H

#include "field/batch_area.h"

/* Half chord of an edge's line in the disc of squared radius rm2, and the edge's part b1..b2 in it. */
typedef struct cut_view {
  skf_vd chord, b1, b2, out; /* out: angle of the rest */
  skf_vi in;
} cut_view;

SKF_INLINE skf_vd edge_angle(skf_vd d, skf_vd l1, skf_vd l2, skf_vd length) {
  return (skf_vd)((skf_vi)vd_atan2(d * length, vd_fma(d, d, l1 * l2)) & (d != vd_set(0)));
}

SKF_INLINE cut_view area_cut(const area_row *c, const area_view *f, int i, const skf_vd power[3], skf_vd rm) {
  skf_vd d = f->d[i], l1 = f->l1[i], l2 = f->l2[i], zero = vd_set(0), ad = vd_abs(d);
  skf_vi first = vd_abs(l1) < vd_abs(l2);
  skf_vd l = vd_select(first, l1, l2), c2 = vd_fma(l, l, vd_select(first, power[i], power[(i + 1) % 3]));
  c2 = vd_select(vd_abs(l) > c->param, (rm - ad) * (rm + ad), c2);
  cut_view v = {.chord = vd_sqrt(vd_max(c2, zero))};
  v.b1 = vd_max(l1, -v.chord), v.b2 = vd_min(l2, v.chord);
  v.in = (c2 > zero) & (v.b1 < v.b2);
  skf_vi low = v.in & (l1 < -v.chord), high = v.in & (l2 > v.chord), all = ~v.in;
  skf_vd to = vd_select(low, -v.chord, l2), from = vd_select(high, v.chord, l1);
  v.out = zero;
  if (vi_any(low | all)) {
    skf_vd angle = edge_angle(d, l1, to, vd_select(low, to - l1, c->T.L[i]));
    v.out = (skf_vd)((skf_vi)angle & (low | all));
  }
  if (vi_any(high)) v.out += (skf_vd)((skf_vi)edge_angle(d, from, l2, l2 - from) & high);
  return v;
}

typedef struct disc_terms {
  skf_vd H, D; /* (G0 - G) / rho^2, -R^2 (h - h0) / rho^2 */
} disc_terms;

SKF_INLINE disc_terms disc_at(bool soft, skf_vd y, skf_vd y0) {
  skf_vd sum = y0 + y, s2 = vd_fma(sum, sum, -(y0 * y));
  if (!soft) return (disc_terms){vd_set(1. / 6) * s2, sum};
  skf_vd s3 = sum * vd_fma(y0, y0, y * y);
  return (disc_terms){vd_fma(vd_set(5. / 54), s2, vd_set(1. / 18) * s3),
                      vd_fma(vd_set(5. / 9), sum, vd_set(4. / 9) * s2)};
}

SKF_INLINE skf_vd disc_h(bool soft, skf_vd y) {
  return soft ? y * y * vd_fma(vd_set(4. / 9), y, vd_set(5. / 9)) : y * y;
}

SKF_INLINE skf_vvalue disc_edges(bool soft, const area_row *c, const area_view *f, const skf_vd power[3], skf_vi good) {
  skf_vd zero = vd_set(0), R = c->param, per_R2 = c->per_param2, az = vd_abs(f->z);
  skf_vi first = f->r2[0] < f->r2[1], third = f->r2[2] < vd_min(f->r2[0], f->r2[1]);
  skf_vd near2 = vd_min(vd_min(f->r2[0], f->r2[1]), f->r2[2]), lat2 = vd_max(near2 - f->zz, zero);
  skf_vd near_power = vd_select(third, power[2], vd_select(first, power[0], power[1]));
  skf_vd rm2 = vd_max(vd_select(lat2 < f->zz, near_power + lat2, (R - az) * (R + az)), zero), rm = vd_sqrt(rm2);
  skf_vd y0 = rm2 * per_R2, h0 = disc_h(soft, y0), y3 = y0 * y0 * y0;
  skf_vd G0 = rm2 * y0 * y0 * vd_set(1. / 6);
  if (soft) G0 = c->param2 * y3 * vd_fma(vd_set(3. / 54), y0, vd_set(5. / 54));
  area_sum sum = {zero, zero, {zero, zero, zero}, zero, zero};
  int n = soft ? 4 : 3; /* exact */
  const skf_gauss_node *node = skf_gauss_rule(n);
  for (int i = 0; i < 3; i++) {
    cut_view e = area_cut(c, f, i, power, rm);
    skf_vd half = vd_set(0.5) * (e.b2 - e.b1), mid = vd_set(0.5) * (e.b1 + e.b2), J = zero, H = zero, D = zero;
    for (int j = 0; j < n; j++) {
      skf_vd l = vd_fma(half, vd_set(node[j].x), mid), w = vd_set(node[j].w),
             y = (e.chord - l) * (e.chord + l) * per_R2;
      disc_terms t = disc_at(soft, y, y0);
      J = vd_fma(w, disc_h(soft, y), J), H = vd_fma(w, t.H, H), D = vd_fma(w, t.D, D);
    }
    half = (skf_vd)((skf_vi)half & e.in);
    skf_vd dh = f->d[i] * half, F = vd_fma(dh, H, G0 * e.out), Z = -f->z * vd_fma(dh * per_R2, D, h0 * e.out);
    sum.J[i] = half * J;
    sum.F += F, sum.abs_F += vd_abs(F), sum.Z += Z, sum.abs_Z += vd_abs(Z);
  }
  good &= f->inside | (vd_set(4) * f->lat2 <= rm2);
  return area_gather(c, f, &sum, good);
}

SKF_INLINE skf_vvalue disc_triangle(bool soft, const area_row *c, skf_v3d x) {
  area_view f = area_see(c, x);
  skf_vd zero = vd_set(0), R2 = c->param2, power[3], least = R2;
  skf_vi finite = f.r2[0] + f.r2[1] + f.r2[2] < vd_set(INFINITY);
  for (int i = 0; i < 3; i++) power[i] = R2 - f.r2[i], least = vd_min(least, power[i]);
  skf_vi off = f.dist2 > R2 * vd_set(1 + SKF_PICK(1e-3, 1e-2)), within = least > R2 * vd_set(1. / 512);
  skf_vvalue v = {zero, {zero, zero, zero}, off & finite};
  if (vi_any(within))
    v = area_either(within, area_rule(soft ? AREA_SOFT : AREA_QUARTIC, c, &f, soft ? 4 : 3, finite), v);
  skf_vi edges = ~(off | within);
  if (!vi_any(edges)) return v;
  skf_vi clear = f.dist2 < R2 * vd_set(1 - 1e-3); /* and no vertex at the rim */
  for (int i = 0; i < 3; i++) clear &= vd_set(1024) * vd_abs(power[i]) > R2;
  return area_either(edges, disc_edges(soft, c, &f, power, finite & clear), v);
}

SKF_INLINE skf_vvalue quartic_triangle(const area_row *c, skf_v3d x) { return disc_triangle(false, c, x); }
SKF_INLINE skf_vvalue soft_object_triangle(const area_row *c, skf_v3d x) { return disc_triangle(true, c, x); }

SKF_BATCH_FORM(quartic_triangle, area, skf_again_none)
SKF_BATCH_FORM(soft_object_triangle, area, skf_again_none)

#endif
