/* SPDX-License-Identifier: MIT */
/* 1 / (1 + s^2 r^2)^2. With q = 1 + s^2 z^2, E_i^2 = q + s^2 d_i^2 and A_i = int dl / (E_i^2 + s^2 l^2):
   F = sum_i d_i A_i / (2 q), dF/dz = -(z s^2 / q) (2 F + sum_i d_i J_i). Edge by edge this is [Sherstyuk 1999], with
   one arc tangent where he takes two. */
#include "field/triangle_parts.h"

static void near_edges(const skf_triangle_view *g, double s, int order, skf_triangle_sum *sum) {
  double z = g->z, s2 = s * s, q = 1 + s2 * z * z, zz2 = s2 * z * z, power[3];
  for (int i = 0; i < 3; i++) {
    double d = g->d[i], E = sqrt(q + s2 * d * d);
    skf_edge_powers(E, s, g->l1[i], g->l2[i], order > 1 ? 3 : 2, power);
    double both = d * (power[0] / q + power[1]);
    skf_sum_F(sum, d * power[0] / (2 * q));
    skf_sum_Z(sum, -z * s2 / q * both);
    sum->J[i] = power[1];
    if (order < 2) continue;
    sum->K[i] = -4 * s2 * power[2];
    double lead = s2 / (q * q) * both, tail = -zz2 / q * d * sum->K[i];
    sum->zz += (3 * zz2 - 1) * lead + tail;
    sum->abszz += (3 * zz2 + 1) * fabs(lead) + fabs(tail);
  }
}

/* G-form: p' outside, where F ~ (s r)^-4 would cancel (s r)^2 above. */
static void far_edges(const skf_triangle_view *g, double s, int order, skf_triangle_sum *sum) {
  double z = g->z, s2 = s * s, q = 1 + s2 * z * z, l[SKF_PANEL_NODES], w[SKF_PANEL_NODES];
  for (int i = 0; i < 3; i++) {
    double d = g->d[i], F = 0, W = 0, V = 0;
    skf_panels p = skf_panels_over(g->l1[i], g->l2[i], skf_panel_scale(d, g->l1[i], g->l2[i]));
    for (int k = 0; k < p.count; k++) {
      skf_panel_nodes(&p, k, l, w);
      for (int j = 0; j < SKF_PANEL_NODES; j++) {
        double rho2 = d * d + l[j] * l[j], u = 1 / (q + s2 * rho2), h = w[j] * u * u;
        F -= d * w[j] * u / (2 * s2 * rho2);
        W += d * h / rho2;
        V -= d * 4 * s2 * h * u / rho2;
        sum->J[i] += h;
        sum->K[i] -= 4 * s2 * h * u;
      }
    }
    skf_sum_F(sum, F);
    skf_sum_Z(sum, z * W);
    if (order > 1) skf_sum_zz(sum, W), skf_sum_zz(sum, z * z * V);
  }
}

static void jumps(const skf_triangle_view *g, double s, skf_triangle_sum *sum) {
  for (int i = 0; i < 3; i++) {
    double r1 = s * g->r[i], r2 = s * g->r[(i + 1) % 3], q1 = 1 + r1 * r1, q2 = 1 + r2 * r2;
    sum->jump[i] = -s * s * (g->l2[i] - g->l1[i]) * (g->l1[i] + g->l2[i]) * (q1 + q2) / (q1 * q1 * q2 * q2);
  }
}

void skf_triangle_cauchy(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  const skf_triangle_plan *T = &e->plan.triangle;
  double s = e->kernel.param;
  skf_kernel_eval_fn eval = skf_kernel_row(SKF_CAUCHY)->eval;
  skf_triangle_view g;
  skf_triangle_face(T, x, &g);
  double far = hypot(g.dist, 1 / s);
  if (far >= 1.5 * T->diam) {
    skf_quad_conical(eval, s, g.a, T->area, skf_quad_order(far, T->diam), order, v);
    return;
  }
  skf_triangle_look(&g);
  skf_triangle_sum sum = {0};
  if (!g.inside && s * g.lat > 4 * hypot(1, s * g.z))
    far_edges(&g, s, order, &sum);
  else
    near_edges(&g, s, order, &sum);
  if (order > 1) jumps(&g, s, &sum);
  skf_triangle_settle(eval, s, 1 / s, &g, &sum, order, v);
}
