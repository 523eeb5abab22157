/* SPDX-License-Identifier: MIT */
/* 1 / r: F = sum_i (d_i Lam_i - |z| b_i), J_i = Lam_i, dF/dz = -sgn(z) sum_i b_i. The solid angle comes from the edges,
   not from [van Oosterom, Strackee 1983], whose denominator cancels near an edge. */
#include "field/triangle_parts.h"

static void edges(const skf_triangle_view *g, int order, skf_triangle_sum *s) {
  double az = fabs(g->z), sign = (g->z > 0) - (g->z < 0);
  for (int i = 0; i < 3; i++) {
    double d = g->d[i], l1 = g->l1[i], l2 = g->l2[i], c2 = d * d + g->z * g->z;
    double r1 = g->r[i], r2 = g->r[(i + 1) % 3], sum_l = l1 + l2, L = l2 - l1;
    if (order > 1 && r1 > 0 && r2 > 0) s->jump[i] = -L * sum_l / (r1 * r2 * (r1 + r2));
    if (c2 == 0 && skf_edge_nearest(l1, l2) == 0) continue; /* on the edge: its own term is infinite or 0 */
    double lam = skf_edge_log(l1, l2, c2, r1, r2), b = skf_edge_solid(d, g->z, c2, l1, r1, l2, r2);
    skf_sum_F(s, d * lam - az * b);
    skf_sum_Z(s, -sign * b);
    s->J[i] = lam;
    if (order < 2) continue;
    s->K[i] = l1 < 0 && l2 > 0 ? -(l2 / r2 - l1 / r1) / c2 : -L * sum_l / (r1 * r2 * (l2 * r1 + l1 * r2));
    skf_sum_zz(s, -d * s->K[i]); /* Laplace: the trace is 0 */
  }
}

/* The edges lose (distance / diameter)^2; at 4 the quadrature costs as much. */
#define FAR 4

void skf_triangle_inverse(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  const skf_triangle_plan *T = &e->plan.triangle;
  skf_kernel_eval_fn eval = skf_kernel_row(SKF_INVERSE)->eval;
  skf_triangle_view g;
  skf_triangle_face(T, x, &g);
  if (g.dist >= FAR * T->diam) {
    skf_quad_conical(eval, 0, g.a, T->area, skf_quad_order(g.dist, T->diam), order, v);
    return;
  }
  skf_triangle_look(&g);
  skf_triangle_sum s = {0};
  edges(&g, order, &s);
  skf_triangle_settle(eval, 0, 0, &g, &s, order, v);
}

double skf_triangle_angle(const skf_triangle *triangle, skf_vec3 x) {
  skf_triangle_plan T;
  skf_triangle_view g;
  double sum = 0;
  skf_triangle_prepare(triangle, &T);
  skf_triangle_face(&T, x, &g);
  skf_triangle_look(&g);
  for (int i = 0; i < 3; i++)
    sum += skf_edge_solid(g.d[i], g.z, g.d[i] * g.d[i] + g.z * g.z, g.l1[i], g.r[i], g.l2[i], g.r[(i + 1) % 3]);
  return g.z < 0 ? sum : g.z > 0 ? -sum : 0;
}
