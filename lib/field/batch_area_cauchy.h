/* SPDX-License-Identifier: MIT */
/* Vector form: the Cauchy kernel over a triangle in plain geometry, in stages. */
#ifndef SKF_FIELD_BATCH_AREA_CAUCHY_H
#define SKF_FIELD_BATCH_AREA_CAUCHY_H

#include "field/batch_area_smooth.h"

/* A triangle, and what is in widths of the kernel: directions along the first edge, out of it and along the normal
   times s; the edges' lengths and the longest; turns from the first edge to the others; strength / (2 s^2). */
typedef struct cauchy_row {
  area_row area;
  skf_v3d along, out, up;
  skf_vd L[3], diam, c[2], s[2], half;
} cauchy_row;

static double *cauchy_pack(const skf_prepared *e, double *k) {
  const skf_triangle_plan *T = &e->plan.triangle;
  const double s = e->kernel.param;
  k = area_pack(e, k);
  k = pack3(pack3(pack3(k, v3_scale(s, T->t[0])), v3_scale(s, T->m[0])), v3_scale(s, T->n));
  for (int i = 0; i < 3; i++) k = pack1(k, s * T->L[i]);
  k = pack1(k, s * T->diam);
  for (int i = 1; i < 3; i++) k = pack1(k, v3_dot(T->t[i], T->t[0]));
  for (int i = 1; i < 3; i++) k = pack1(k, v3_dot(T->t[i], T->m[0]));
  return pack1(k, e->strength / (2 * s * s));
}

/* As cauchy_edges: with q = 1 + z^2, E^2 = q + d^2 and Q = E^2 + l^2 at an edge's ends, the angle between those seen
   from E has the tangent L E / (E^2 + l1 l2); K is l2 / Q2 - l1 / Q1, T the sum of the sizes of its terms. */
typedef struct cauchy_triangle_state {
  skf_vd d[3], EE[3], E[3], dot[3]; /* dot: then the angles' offsets */
  skf_vd K[3], T[3], t[3];          /* K, T: l1, l2 at first; t: tangents, then the angles */
  skf_vd z, q, size;                /* q: in the end 1 / q; size: not less than any distance */
} cauchy_triangle_state;

/* From d, l1, l2 and the height */
SKF_INLINE void cauchy_triangle_angles(const cauchy_row *c, cauchy_triangle_state *s, skf_vd z) {
  s->z = z, s->q = vd_fma(z, z, vd_set(1));
  for (int i = 0; i < 3; i++) {
    s->EE[i] = vd_fma(s->d[i], s->d[i], s->q);
    s->dot[i] = vd_fma(s->K[i], s->T[i], s->EE[i]);
  }
  s->size = (vd_abs(s->K[0]) + vd_abs(s->d[0])) + (vd_abs(z) + c->diam);
}

SKF_INLINE void cauchy_triangle_begin(const cauchy_row *c, skf_v3d x, cauchy_triangle_state *s) {
  const skf_v3d a = vd3_sub(c->area.T.v[0], x);
  const skf_vd u = vd3_dot(a, c->along), v = vd3_dot(a, c->out), z = vd3_dot(a, c->up), w = u + c->L[0];
  s->K[0] = u, s->T[0] = w, s->d[0] = v;
  s->K[1] = vd_fma(c->c[0], w, c->s[0] * v), s->T[1] = s->K[1] + c->L[1];
  s->d[1] = vd_fms(c->c[0], v, c->s[0] * w);
  s->T[2] = vd_fma(c->c[1], u, c->s[1] * v), s->K[2] = s->T[2] - c->L[2];
  s->d[2] = vd_fms(c->c[1], v, c->s[1] * u);
  cauchy_triangle_angles(c, s, z);
}

SKF_INLINE void cauchy_triangle_roots(const cauchy_row *c, cauchy_triangle_state *s) {
  skf_vd per[3];
  (void)c;
  for (int i = 0; i < 3; i++) per[i] = vd_set(1) / vd_fma(s->K[i], s->K[i], s->EE[i]), s->E[i] = vd_sqrt(s->EE[i]);
  for (int i = 0; i < 3; i++) {
    const skf_vd first = s->K[i] * per[i], second = s->T[i] * per[(i + 1) % 3];
    s->K[i] = second - first, s->T[i] = vd_abs(first) + vd_abs(second);
  }
}

SKF_INLINE void cauchy_triangle_middle(const cauchy_row *c, cauchy_triangle_state *s) {
  for (int i = 0; i < 3; i++) {
    const skf_vangle a = vd_angle_parts(c->L[i] * s->E[i], s->dot[i]);
    s->dot[i] = a.offset, s->t[i] = a.top / a.bottom;
    s->EE[i] = vd_set(1) / s->EE[i];
  }
  s->q = vd_set(1) / s->q;
}

SKF_INLINE void cauchy_triangle_series(const cauchy_row *c, cauchy_triangle_state *s) {
  (void)c;
  for (int i = 0; i < 3; i++) s->t[i] = vd_angle_series(s->dot[i], s->t[i]);
}

/* The sums' errors are a few ulps of what is compared: terms have those of d and l, each up to `size` ulps. */
SKF_INLINE skf_vvalue cauchy_triangle_sum(const cauchy_row *c, const cauchy_triangle_state *s, double most) {
  skf_vd F = vd_set(0), Z = F, all_A = F, all_J = F, J[3];
  for (int i = 0; i < 3; i++) {
    const skf_vd A = s->t[i] * (s->E[i] * s->EE[i]);
    F = vd_fma(s->d[i], A, F), all_A += A;
    J[i] = (s->K[i] + A) * s->EE[i], all_J = vd_fma(s->T[i] + A, s->EE[i], all_J);
    Z = vd_fma(s->d[i], J[i], Z);
  }
  const skf_vd zq = s->z * s->q, q2 = s->q + s->q;
  const skf_vd gu = vd_fma(c->s[0], J[1], c->s[1] * J[2]), gv = vd_fma(c->c[0], J[1], vd_fma(c->c[1], J[2], J[0]));
  Z = zq * vd_fma(q2, F, Z);
  const skf_vd loss = s->size * all_A, lost = vd_fma(vd_abs(zq), vd_fma(q2, loss, s->size * all_J), all_J);
  const skf_vd g = vd_max(vd_max(vd_abs(gu), vd_abs(gv)), vd_abs(Z)), value = (c->half * s->q) * F;
  skf_vi good = (loss < vd_set(most) * F) & (lost < vd_set(most) * g) & (s->size < vd_set(SKF_PICK(32, 1e3)));
  good &= F > vd_set(SKF_PICK(1e-140, 1e-18));
  const skf_vd h = c->half;
  return (skf_vvalue){value, vd3_mad(vd3_less(vd3_scale(h * gu, c->along), h * gv, c->out), h * Z, c->up), good};
}

SKF_INLINE skf_vvalue cauchy_triangle_end(const cauchy_row *c, const cauchy_triangle_state *s) {
  return cauchy_triangle_sum(c, s, SKF_PICK(96, 128));
}

/* The same where it loses more, each edge seen from its nearer end. */
SKF_OUTLINE skf_vvalue cauchy_triangle_near(const cauchy_row *c, skf_v3d x) {
  const area_view f = area_see(&c->area, x);
  const skf_vd s = c->area.param;
  cauchy_triangle_state n;
  for (int i = 0; i < 3; i++) n.d[i] = s * f.d[i], n.K[i] = s * f.l1[i], n.T[i] = s * f.l2[i];
  cauchy_triangle_angles(c, &n, -(s * f.z)); /* towards the plane */
  cauchy_triangle_roots(c, &n);
  cauchy_triangle_middle(c, &n);
  cauchy_triangle_series(c, &n);
  return cauchy_triangle_sum(c, &n, 96);
}

SKF_INLINE skf_vvalue cauchy_triangle_any(const cauchy_row *c, skf_v3d x) {
  skf_vvalue v = cauchy_triangle_near(c, x);
  if (vi_all(v.good)) return v;
  skf_vvalue w = cauchy_careful(&c->area, x);
  if (!vi_all(v.good | w.good)) vv_take(&w, cauchy_middle(&c->area, x));
  vv_take(&v, vv_scale(c->area.T.strength, w));
  return v;
}

SKF_BATCH_LACED(cauchy_triangle, cauchy, cauchy_triangle_any, cauchy_triangle_roots, cauchy_triangle_middle,
                cauchy_triangle_series)

#endif
