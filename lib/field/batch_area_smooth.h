/* SPDX-License-Identifier: MIT */
/* Vector forms: the Cauchy kernel and 1 / r^2 over a triangle, as triangle_cauchy.c and triangle_inverse_squared.c. */
#ifndef SKF_FIELD_BATCH_AREA_SMOOTH_H
#define SKF_FIELD_BATCH_AREA_SMOOTH_H

#include "field/batch_area_squared.h"
#include "field/batch_panel.h"

/* From the edges; their integrals of 1 / (E^2 + s^2 l^2)^k by the span of tan phi = s l / E. */
SKF_INLINE skf_vvalue cauchy_edges(const area_row *c, const area_view *f) {
  skf_vd s = c->param, s2 = c->param2, one = vd_set(1), zero = vd_set(0), q = vd_fma(s2, f->zz, one), per_q = one / q;
  area_sum sum = {zero, zero, {zero, zero, zero}, zero, zero};
  skf_vi good = vd_sane(q);
  for (int i = 0; i < 3; i++) {
    skf_vd d = f->d[i], l1 = f->l1[i], l2 = f->l2[i], EE = vd_fma(s2, d * d, q), E = vd_sqrt(EE), ll = s2 * l1 * l2;
    skf_vd N = vd_sqrt(vd_fma(s2, l1 * l1, EE) * vd_fma(s2, l2 * l2, EE));
    span_view a = span_see(s * c->T.L[i] * E, EE + ll, N, EE - ll, s * E * (l1 + l2));
    skf_vd per = one / (s * E * EE), A = a.delta * EE * per, J = span_second(&a, a.c) * per;
    skf_vd F = d * A, Z = d * vd_fma(A, per_q, J);
    sum.F += F, sum.abs_F += vd_abs(F), sum.Z += Z, sum.abs_Z += vd_abs(Z), sum.J[i] = J;
    good &= a.good;
  }
  skf_vd half = vd_set(0.5) * per_q, slope = -(f->z * s2 * per_q);
  sum.F *= half, sum.abs_F *= half, sum.Z *= slope, sum.abs_Z *= vd_abs(slope);
  return area_gather(c, f, &sum, good);
}

SKF_INLINE skf_vd cauchy_reach2(const area_row *c, const area_view *f) { return f->dist2 + c->per_param2; }

SKF_OUTLINE skf_vvalue cauchy_careful(const area_row *c, skf_v3d x) {
  area_view f = area_see(c, x);
  skf_vi far = cauchy_reach2(c, &f) > c->T.far * c->T.far;
  if (!vi_any(far)) return cauchy_edges(c, &f);
  skf_vvalue v = area_rule(AREA_CAUCHY, c, &f, FAR_NODES, f.dist2 * c->param2 < vd_set(SKF_PICK(1e70, 1e9)));
  return vi_all(far) ? v : area_either(far, v, cauchy_edges(c, &f));
}

/* G-form, for a point far outside in terms of the kernel's width. */
SKF_INLINE skf_vvalue cauchy_beyond(const area_row *c, const area_view *f, skf_vi good) {
  skf_vd zero = vd_set(0), s2 = c->param2, q = vd_fma(s2, f->zz, vd_set(1));
  area_sum sum = {zero, zero, {zero, zero, zero}, zero, zero};
  for (int i = 0; i < 3; i++) {
    skf_vd d = f->d[i], F = zero, Z = zero, dd = d * d;
    panel_view p = panel_over(f->l1[i], f->l2[i], c->T.L[i], panel_scale(d, f->l1[i], f->l2[i]), good);
    for (int k = 0; panel_next(&p, k); k++)
      for (int j = 0; j < PANEL_NODES; j++) {
        skf_vd l, w;
        panel_node(&p, j, &l, &w);
        skf_vd rho2 = vd_fma(l, l, dd), Q = vd_fma(s2, rho2, q), inv = vd_set(1) / (rho2 * Q), u = rho2 * inv,
               wu = w * u;
        F = vd_fma(w, inv, F), Z = vd_fma(wu, inv, Z);
        sum.J[i] = vd_fma(wu, u, sum.J[i]);
      }
    F *= vd_set(-0.5) * d * c->per_param2, Z *= f->z * d;
    sum.F += F, sum.abs_F += vd_abs(F), sum.Z += Z, sum.abs_Z += vd_abs(Z);
  }
  return area_gather(c, f, &sum, good);
}

/* Less far than for cauchy_careful, where the edges cancel: with 13 nodes exact to 1e-16 from three halves of the
   diameter on; nearer, for narrow kernels, the G-form. */
SKF_OUTLINE skf_vvalue cauchy_middle(const area_row *c, skf_v3d x) {
  area_view f = area_see(c, x);
  skf_vi middle = cauchy_reach2(c, &f) > vd_set(2.25) * c->diam * c->diam;
  skf_vi beyond = ~middle & (c->param2 * f.lat2 > vd_set(16) * vd_fma(c->param2, f.zz, vd_set(1)));
  skf_vvalue v = {.good = vi_set(0)};
  if (vi_any(middle))
    v = area_rule(AREA_CAUCHY, c, &f, MIDDLE_NODES, f.dist2 * c->param2 < vd_set(SKF_PICK(1e70, 1e9)));
  v.good &= middle;
  return vi_any(beyond) ? area_either(beyond, cauchy_beyond(c, &f, beyond), v) : v;
}

/* From the edges' panels: H-form over the triangle and higher than beside it, else G-form, where any constant may be
   taken from the logarithm. Not next to the triangle, where its geometry must be exact. */
SKF_INLINE skf_vvalue squared_edges(const area_row *c, const area_view *f, skf_vi good) {
  skf_vd zero = vd_set(0), one = vd_set(1);
  area_sum sum = {zero, zero, {zero, zero, zero}, zero, zero};
  skf_vi above = f->inside | (f->zz >= f->lat2);
  skf_vd base = vd_select(above, f->zz, f->dist2), off = vd_select(above, zero, f->lat2);
  skf_vd per_z = vd_set(-1) / vd_select(above, f->z, one);
  good &= vd_set(1 << 16) * f->dist2 > c->diam * c->diam;
  for (int i = 0; i < 3; i++) {
    skf_vd d = f->d[i], l1 = f->l1[i], l2 = f->l2[i], dd = d * d, cc = dd + f->zz, h = vd_sqrt(cc), F = zero, W = zero;
    skf_vd J = vd_atan2(h * c->T.L[i], vd_fma(l1, l2, cc)) / h;
    skf_vd near = vd_select(above, h, vd_abs(d));
    panel_view p = panel_over(l1, l2, c->T.L[i], panel_scale(near, l1, l2), good & (d != zero));
    for (int k = 0; panel_next(&p, k); k++)
      for (int j = 0; j < PANEL_NODES; j++) {
        skf_vd l, w;
        panel_node(&p, j, &l, &w);
        skf_vd rho2 = vd_fma(l, l, dd), rr = rho2 + f->zz, inv = w / (rho2 * rr), dif = vd_max(rho2 - off, zero);
        F = vd_fma(inv * rr, vd_log_ratio(base + dif, base, dif), F), W += inv;
      }
    F *= vd_set(0.5) * d;
    skf_vd Z = d * vd_select(above, J * per_z, f->z * W);
    good &= vd_set(1 << 16) * cc > c->diam * c->diam;
    sum.J[i] = J, sum.F += F, sum.abs_F += vd_abs(F), sum.Z += Z, sum.abs_Z += vd_abs(Z);
  }
  return area_gather(c, f, &sum, good);
}

SKF_INLINE skf_vvalue squared_plain(const area_row *c, const area_view *f, skf_vi far) {
  skf_vvalue v = {.good = vi_set(0)};
  if (vi_any(far)) v = area_rule(AREA_SQUARED, c, f, FAR_NODES, vd_sane(f->dist2));
  return vi_all(far) ? v : area_either(far, v, squared_closed(c, f));
}

SKF_OUTLINE skf_vvalue inverse_squared_triangle_careful(const area_row *c, skf_v3d x) {
  area_view f = area_see(c, x);
  const skf_vi far = f.dist2 > c->T.far * c->T.far, middle = ~far & (f.dist2 > vd_set(2.25) * c->diam * c->diam);
  skf_vvalue v = squared_plain(c, &f, far);
  if (!vi_all(far | v.good)) vv_take(&v, squared_edges(c, &f, ~(far | v.good)));
  if (!vi_any(middle & ~v.good)) return v;
  vv_take(&v, area_rule(AREA_SQUARED, c, &f, MIDDLE_NODES, middle & vd_sane(f.dist2)));
  return v;
}

/* One stage: what for the loop gathers the points that need care. */
typedef struct inverse_squared_triangle_state {
  skf_vvalue v;
} inverse_squared_triangle_state;

SKF_OUTLINE skf_vvalue inverse_squared_triangle_plain(const area_row *c, skf_v3d x) {
  area_view f = area_see(c, x);
  return squared_plain(c, &f, f.dist2 > c->T.far * c->T.far);
}
SKF_INLINE void inverse_squared_triangle_begin(const area_row *c, skf_v3d x, inverse_squared_triangle_state *s) {
  s->v = inverse_squared_triangle_plain(c, x);
}
SKF_INLINE skf_vvalue inverse_squared_triangle_end(const area_row *c, const inverse_squared_triangle_state *s) {
  (void)c;
  return s->v;
}

SKF_BATCH_STAGED(inverse_squared_triangle, area, inverse_squared_triangle_careful, skf_stage_none, skf_stage_none,
                 skf_stage_none)

#endif
