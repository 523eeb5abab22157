/* SPDX-License-Identifier: MIT */
/* Vector forms: quartic and soft object over a triangle: batch_area_flat.h, and for lanes that need more care as
   triangle_compact.c, whose H-form has exact Gauss rules; points far beside the triangle in terms of the disc that the
   support cuts from its plane have the G-form, by panels. */
#ifndef SKF_FIELD_BATCH_AREA_COMPACT_H
#define SKF_FIELD_BATCH_AREA_COMPACT_H

#include "field/batch_area_flat.h"
#include "field/batch_panel.h"

/* Half chord of an edge's line in the disc of squared radius rm2, and the edge's part b1..b2 in it. */
typedef struct cut_view {
  skf_vd chord, b1, b2, out; /* out: angle of the rest */
  skf_vi in, rough;          /* rough: the edge's line is not known well enough for so small a disc */
} cut_view;

SKF_INLINE cut_view area_cut(const area_row *c, const area_view *f, int i, const skf_vd power[3], skf_vd rm, skf_vd R) {
  skf_vd d = f->d[i], l1 = f->l1[i], l2 = f->l2[i], zero = vd_set(0), ad = vd_abs(d);
  skf_vi first = vd_abs(l1) < vd_abs(l2);
  skf_vd l = vd_select(first, l1, l2), c2 = vd_fma(l, l, vd_select(first, power[i], power[(i + 1) % 3]));
  c2 = vd_select(vd_abs(l) > R, (rm - ad) * (rm + ad), c2);
  cut_view v = {.chord = vd_sqrt(vd_max(c2, zero))};
  v.b1 = vd_max(l1, -v.chord), v.b2 = vd_min(l2, v.chord);
  v.in = (c2 > zero) & (v.b1 < v.b2);
  v.rough = v.in & (vd_set(256) * R * R < vd_min(f->r2[i], f->r2[(i + 1) % 3]));
  /* from l1 on and up to l2, or all at once, which is less than pi together */
  skf_vd to = vd_select(v.in, v.b1, l2), from = vd_select(v.in, v.b2, l2), dd = d * d;
  skf_vd re1 = vd_fma(l1, to, dd), im1 = d * vd_select(v.in, to - l1, c->T.L[i]);
  skf_vd re2 = vd_fma(l2, from, dd), im2 = d * (l2 - from);
  skf_vd im = vd_fma(re1, im2, re2 * im1), re = vd_fma(re1, re2, -(im1 * im2));
  v.out = (skf_vd)((skf_vi)vd_angle(vd_abs(im), re) & (im != vd_set(0)));
  v.out = (skf_vd)((skf_vi)v.out ^ vd_sign(d));
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

/* The disc about the foot of the perpendicular. */
typedef struct disc_area {
  skf_vd power[3], rm2, rm, y0, h0, G0;
  skf_vi beyond; /* the foot is far outside the triangle */
} disc_area;

SKF_INLINE disc_area disc_see(bool soft, const area_row *c, const area_view *f) {
  skf_vd zero = vd_set(0), R = c->param, az = vd_abs(f->z);
  disc_area v;
  for (int i = 0; i < 3; i++) v.power[i] = c->param2 - f->r2[i];
  skf_vd near2 = vd_min(vd_min(f->r2[0], f->r2[1]), f->r2[2]), lat2 = vd_max(near2 - f->zz, zero);
  skf_vd rm2 = vd_select(lat2 < f->zz, c->param2 - near2 + lat2, (R - az) * (R + az));
  v.rm2 = vd_max(rm2, zero), v.rm = vd_sqrt(v.rm2);
  v.y0 = v.rm2 * c->per_param2, v.h0 = disc_h(soft, v.y0);
  v.G0 = v.rm2 * v.y0 * v.y0 * vd_set(1. / 6);
  if (soft) v.G0 = v.rm2 * v.y0 * v.y0 * vd_fma(vd_set(3. / 54), v.y0, vd_set(5. / 54));
  v.beyond = ~f->inside & (vd_set(4) * f->lat2 > v.rm2);
  return v;
}

/* int G / (R^2 rho^2) and int h / rho^2 over an edge's part in the disc */
SKF_INLINE disc_terms disc_panels(bool soft, const area_row *c, skf_vd d, const cut_view *e, skf_vi some) {
  disc_terms sum = {vd_set(0), vd_set(0)};
  panel_view p = panel_over(e->b1, e->b2, e->b2 - e->b1, panel_scale(d, e->b1, e->b2), some & e->in & (d != vd_set(0)));
  for (int k = 0; panel_next(&p, k); k++)
    for (int j = 0; j < PANEL_NODES; j++) {
      skf_vd l, w;
      panel_node(&p, j, &l, &w);
      skf_vd y = (e->chord - l) * (e->chord + l) * c->per_param2, q = w / vd_fma(d, d, l * l);
      skf_vd G = soft ? vd_fma(vd_set(3. / 54), y, vd_set(5. / 54)) : vd_set(1. / 6);
      sum.H = vd_fma(q * y * y, y * G, sum.H), sum.D = vd_fma(q, disc_h(soft, y), sum.D);
    }
  return sum;
}

/* What R^2 - r^2 has lost, in 16 ulps. */
SKF_INLINE skf_vd rim_loss(skf_vd R2, const area_view *f) {
  return vd_max(vd_set(1), vd_set(1. / 16) * R2 / (R2 - f->dist2));
}

SKF_INLINE skf_vvalue disc_edges(bool soft, bool beyond, const area_row *c, const area_view *f, const disc_area *disc,
                                 skf_vi good) {
  skf_vd zero = vd_set(0), per_R2 = c->per_param2;
  area_sum sum = {zero, zero, {zero, zero, zero}, zero, zero};
  int n = soft ? 4 : 3; /* exact */
  const skf_gauss_node *node = skf_gauss_rule(n);
  for (int i = 0; i < 3; i++) {
    skf_vd d = f->d[i], J = zero, H = zero, D = zero, F, Z;
    cut_view e = area_cut(c, f, i, disc->power, disc->rm, c->param);
    skf_vd half = vd_set(0.5) * (e.b2 - e.b1), mid = vd_set(0.5) * (e.b1 + e.b2);
    for (int j = 0; j < n; j++) {
      skf_vd l = vd_fma(half, vd_set(node[j].x), mid), w = vd_set(node[j].w),
             y = (e.chord - l) * (e.chord + l) * per_R2;
      disc_terms t = disc_at(soft, y, disc->y0);
      J = vd_fma(w, disc_h(soft, y), J), H = vd_fma(w, t.H, H), D = vd_fma(w, t.D, D);
    }
    half = (skf_vd)((skf_vi)half & e.in);
    sum.J[i] = half * J;
    good &= ~e.rough;
    if (beyond) {
      disc_terms t = disc_panels(soft, c, d, &e, good);
      F = -(d * c->param2 * t.H), Z = f->z * d * t.D;
    } else
      F = vd_fma(d * half, H, disc->G0 * e.out), Z = -f->z * vd_fma(d * half * per_R2, D, disc->h0 * e.out);
    sum.F += F, sum.abs_F += vd_abs(F), sum.Z += Z, sum.abs_Z += vd_abs(Z);
  }
  return area_gather_lossy(c, f, &sum, rim_loss(c->param2, f), 0, good);
}

/* Not at the rim, where the plain differences of squares cancel. */
SKF_INLINE skf_vi disc_clear(const area_row *c, const area_view *f, const disc_area *disc) {
  skf_vi clear = f->dist2 < c->param2 * vd_set(1 - 1e-3);
  for (int i = 0; i < 3; i++) clear &= vd_set(1024) * vd_abs(disc->power[i]) > c->param2;
  return clear;
}

/* The lanes that are done are passed over. */
SKF_INLINE skf_vvalue disc_triangle(bool soft, const area_row *c, skf_v3d x, skf_vi done) {
  area_view f = area_see(c, x);
  skf_vd zero = vd_set(0), R2 = c->param2, reach2 = vd_max(vd_max(f.r2[0], f.r2[1]), f.r2[2]);
  skf_vi finite = reach2 < vd_set(INFINITY);
  skf_vi off = f.dist2 > R2 * vd_set(1 + SKF_PICK(1e-3, 1e-2)), within = R2 - reach2 > R2 * vd_set(1. / 512);
  within &= ~done;
  skf_vvalue v = {zero, {zero, zero, zero}, off & finite};
  if (vi_any(within))
    v = area_either(within, area_rule(soft ? AREA_SOFT : AREA_QUARTIC, c, &f, soft ? 4 : 3, finite), v);
  skf_vi edges = ~(off | within | done);
  if (!vi_any(edges)) return v;
  disc_area disc = disc_see(soft, c, &f);
  skf_vi good = finite & disc_clear(c, &f, &disc);
  return area_either(edges, disc_edges(soft, false, c, &f, &disc, good), v);
}

SKF_INLINE skf_vvalue disc_triangle_beyond(bool soft, const area_row *c, skf_v3d x, skf_vi done) {
  area_view f = area_see(c, x);
  disc_area disc = disc_see(soft, c, &f);
  skf_vi good = disc_clear(c, &f, &disc) & disc.beyond & ~done;
  if (!vi_any(good)) return (skf_vvalue){.good = good};
  return disc_edges(soft, true, c, &f, &disc, good);
}

/* For doubles, whose frame may not be enough, the triangle as it is, too */
typedef struct compact_row {
  flat_row flat;
#ifndef SKF_VEC_FLOAT
  area_row area;
#endif
} compact_row;

static double *compact_pack(const skf_prepared *e, double *k) {
  k = flat_pack(e, k);
#ifndef SKF_VEC_FLOAT
  k = area_pack(e, k);
#endif
  return k;
}

SKF_INLINE skf_vvalue compact_careful(bool soft, const compact_row *c, skf_v3d x) {
  skf_vvalue v = flat_careful(soft, &c->flat, x);
#ifndef SKF_VEC_FLOAT
  const skf_vd by = c->area.T.strength;
  if (!vi_all(v.good)) vv_take(&v, vv_scale(by, disc_triangle(soft, &c->area, x, v.good)));
  if (!vi_all(v.good)) vv_take(&v, vv_scale(by, disc_triangle_beyond(soft, &c->area, x, v.good)));
#endif
  return v;
}

#define SKF_COMPACT_TRIANGLE(name, soft)                                                                               \
  typedef flat_state name##_state;                                                                                     \
  SKF_OUTLINE skf_vvalue name##_careful(const compact_row *c, skf_v3d x) { return compact_careful(soft, c, x); }       \
  SKF_INLINE void name##_begin(const compact_row *c, skf_v3d x, flat_state *s) { flat_begin(&c->flat, x, s); }         \
  SKF_INLINE void name##_middle(const compact_row *c, flat_state *s) { flat_middle(&c->flat, s); }                     \
  SKF_INLINE skf_vvalue name##_end(const compact_row *c, const flat_state *s) { return flat_end(soft, &c->flat, s); }  \
  SKF_BATCH_SCALED(name, compact, name##_careful, name##_middle, skf_stage_none, skf_stage_none)

SKF_COMPACT_TRIANGLE(quartic_triangle, false)
SKF_COMPACT_TRIANGLE(soft_object_triangle, true)

#endif
