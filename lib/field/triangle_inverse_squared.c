/* SPDX-License-Identifier: MIT */
/* 1 / r^2: J_i = atan2(c L, c^2 + l1 l2) / c; the potential needs one quadrature per edge of a smooth function (its
   closed form has twelve dilogarithms that cancel like (|z| / L)^2). */
#include "field/triangle_parts.h"

/* log(1 + a / b), also where the ratio overflows */
static double log_1_plus(double a, double b) { return a > 1e17 * b ? log(a) - log(b) : log1p(a / b); }

/* Over the triangle, or higher than beside it: H-form, dF/dz = -(1/z) sum_i d_i J_i. */
static void high(const skf_triangle_view *g, int i, double c, skf_triangle_sum *s) {
  double d = g->d[i], l1 = g->l1[i], l2 = g->l2[i], z2 = g->z * g->z, F = 0, l[SKF_PANEL_NODES], w[SKF_PANEL_NODES];
  skf_panels p = skf_panels_over(l1, l2, fmax(c, 1e-3 * skf_edge_nearest(l1, l2)));
  for (int k = 0; k < p.count; k++) {
    skf_panel_nodes(&p, k, l, w);
    for (int j = 0; j < SKF_PANEL_NODES; j++) {
      double rho2 = d * d + l[j] * l[j];
      F += w[j] * log_1_plus(rho2, z2) / rho2;
    }
  }
  skf_sum_F(s, 0.5 * d * F);
  skf_sum_Z(s, -d * s->J[i] / g->z);
  skf_sum_zz(s, d * s->J[i] / (g->z * g->z));
}

/* Beside it: G-form. The angles add up to 0, so any constant may be taken from the logarithm. */
static void low(const skf_triangle_view *g, int i, skf_triangle_sum *s) {
  double d = g->d[i], l1 = g->l1[i], l2 = g->l2[i], z2 = g->z * g->z, lat2 = g->lat * g->lat;
  double F = 0, W = 0, l[SKF_PANEL_NODES], w[SKF_PANEL_NODES];
  skf_panels p = skf_panels_over(l1, l2, skf_panel_scale(d, l1, l2));
  for (int k = 0; k < p.count; k++) {
    skf_panel_nodes(&p, k, l, w);
    for (int j = 0; j < SKF_PANEL_NODES; j++) {
      double rho2 = d * d + l[j] * l[j];
      F += w[j] * log1p((rho2 - lat2) / (z2 + lat2)) / rho2;
      W += w[j] / (rho2 * (rho2 + z2));
    }
  }
  skf_sum_F(s, 0.5 * d * F);
  s->absF += 0.5 * fabs(skf_edge_angle(d, l1, l2)); /* rho2 - lat2 has an ulp of rho2 at least */
  skf_sum_Z(s, g->z * d * W);
  skf_sum_zz(s, -d * W);
}

static void edges(const skf_triangle_view *g, int order, skf_triangle_sum *s) {
  bool above = g->inside || fabs(g->z) >= g->lat;
  for (int i = 0; i < 3; i++) {
    double d = g->d[i], l1 = g->l1[i], l2 = g->l2[i], c = hypot(d, g->z), power[3];
    skf_edge_powers(c, 1, l1, l2, order > 1 ? 2 : 1, power);
    s->J[i] = power[0];
    if (order > 1) {
      double r1 = g->r[i], r2 = g->r[(i + 1) % 3];
      s->K[i] = -2 * power[1];
      s->jump[i] = -(l2 - l1) * (l1 + l2) / (r1 * r1 * r2 * r2);
      skf_sum_zz(s, -d * s->K[i]); /* the Laplacian of 1/r^2 is 2/r^4 = -h'/r */
    }
    if (d == 0) continue;
    if (above)
      high(g, i, c, s);
    else
      low(g, i, s);
  }
}

void skf_triangle_inverse_squared(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  const skf_triangle_plan *T = &e->plan.triangle;
  skf_kernel_eval_fn eval = skf_kernel_row(SKF_INVERSE_SQUARED)->eval;
  skf_triangle_view g;
  skf_triangle_face(T, x, &g);
  if (g.dist >= 1.5 * T->diam) {
    skf_quad_conical(eval, 0, g.a, T->area, skf_quad_order(g.dist, T->diam), order, v);
    return;
  }
  skf_triangle_look(&g);
  if (g.dist == 0) {
    v->F = INFINITY;
    return;
  }
  skf_triangle_sum s = {0};
  edges(&g, order, &s);
  skf_triangle_settle(eval, 0, 0, &g, &s, order, v);
}
