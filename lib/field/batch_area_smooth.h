/* SPDX-License-Identifier: MIT */
/* Vector forms: the Cauchy kernel over a triangle, as triangle_cauchy.c. */
#ifndef SKF_FIELD_BATCH_AREA_SMOOTH_H
#define SKF_FIELD_BATCH_AREA_SMOOTH_H

#include "field/batch_area.h"

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

SKF_INLINE skf_vvalue cauchy_triangle(const area_row *c, skf_v3d x) {
  area_view f = area_see(c, x);
  skf_vi far = cauchy_reach2(c, &f) > c->T.far * c->T.far;
  if (!vi_any(far)) return cauchy_edges(c, &f);
  skf_vvalue v = area_rule(AREA_CAUCHY, c, &f, FAR_NODES, f.dist2 * c->param2 < vd_set(SKF_PICK(1e70, 1e9)));
  return vi_all(far) ? v : area_either(far, v, cauchy_edges(c, &f));
}

/* Less far, where the edges cancel; with 12 nodes exact to 1e-16 from three halves of the diameter on. */
SKF_INLINE skf_vvalue cauchy_triangle_middle(const area_row *c, skf_v3d x) {
  area_view f = area_see(c, x);
  skf_vi middle = cauchy_reach2(c, &f) > vd_set(2.25) * c->diam * c->diam;
  if (!vi_any(middle)) return (skf_vvalue){.good = vi_set(0)};
  return area_rule(AREA_CAUCHY, c, &f, 13, middle & (f.dist2 * c->param2 < vd_set(SKF_PICK(1e70, 1e9))));
}

SKF_BATCH_FORM(cauchy_triangle, area, cauchy_triangle_middle)

#endif
