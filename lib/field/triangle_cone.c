/* SPDX-License-Identifier: MIT */
/* Metaball = 3/2 k_R - 1/2 k_{R/3} with the cone k_R = (1 - r/R)^2: an exact identity, so that no edge is split at R/3.
   Units below: w = |z| / R, u = r / R, a = 1 - u, b = 1 - w; G0 = R^2 b^3 (4 - 3 b) / 12. */
#include "field/triangle_compact.h"

/* What an edge's part in the disc gives: F, W = dF/dz / z, and z^2 int (h'/r)'/r dA. */
typedef struct part {
  double F, W, V;
} part;

/* Antiderivatives; they would cancel where the disc is a small cap of the support. */
static part closed_part(const skf_triangle_view *g, double R, int i, const skf_edge_clip *e, skf_triangle_sum *s) {
  double d = g->d[i], z = g->z, az = fabs(z), c2 = d * d + z * z, b1 = e->b1, b2 = e->b2;
  double r1 = sqrt(c2 + b1 * b1), r2 = sqrt(c2 + b2 * b2), len = e->length, R2 = R * R;
  double lam = skf_edge_log(b1, b2, c2, r1, r2), solid = skf_edge_solid(d, z, c2, b1, r1, b2, r2);
  double th = d * lam - az * solid, int_r = 0.5 * (b2 * r2 - b1 * r1 + c2 * lam);
  double int_l2 = len * (b1 * b1 + b1 * b2 + b2 * b2) / 3;
  s->J[i] = len * (1 + c2 / R2) + int_l2 / R2 - 2 * int_r / R;
  s->K[i] = -2 / R * (lam - len / R);
  part p = {0, -(2 * R * th - d * len) / R2, 2 / R * az * solid};
  p.F = (6 * d * len + 3 * d * ((c2 + z * z) * len + int_l2) / R2 - 8 * d / R * int_r - 8 * z * z / R * th) / 12;
  return p;
}

static part panel_part(const skf_triangle_view *g, const skf_disc *disc, int i, const skf_edge_clip *e, bool beyond,
                       skf_triangle_sum *s) {
  double d = g->d[i], z = g->z, c = hypot(d, z), R = disc->R, w0 = fabs(z) / R, R2 = R * R;
  double b = disc->rm * disc->rm / (R * (R + fabs(z)));
  double l[SKF_PANEL_NODES], w[SKF_PANEL_NODES], near = 1e-3 * skf_edge_nearest(e->b1, e->b2);
  double delta = beyond ? skf_panel_scale(d, e->b1, e->b2) : fmax(fmax(c, near), 1e-12 * e->length);
  skf_panels p = skf_clip_panels(e, delta);
  part sum = {0, 0, 0};
  for (int k = 0; k < p.count; k++) {
    skf_panel_nodes(&p, k, l, w);
    for (int j = 0; j < SKF_PANEL_NODES; j++) {
      double r = sqrt(c * c + l[j] * l[j]), u = r / R, us = u + w0;
      double a = skf_clip_power(e, &p, j, l[j]) / (R2 * (1 + u)), rho2 = d * d + l[j] * l[j];
      s->J[i] += w[j] * a * a;
      s->K[i] -= w[j] * 2 * a / (R * r);
      if (beyond) {
        double q = w[j] * d / rho2;
        sum.F -= q * R2 / 12 * a * a * a * (4 - 3 * a);
        sum.W += q * a * a;
        sum.V -= q * z * z * 2 * a / (R * r);
        continue;
      }
      double H = us > 1 ? (4 * (b * b + a * b + a * a) - 3 * (a + b) * (a * a + b * b)) / (12 * us)
                        : (6 - 8 * (u + w0 * (w0 / us)) + 3 * (u * u + w0 * w0)) / 12;
      sum.F += w[j] * d * H;
      sum.W -= w[j] * d * (a + b) / (us * R2);
      sum.V += w[j] * d * 2 * w0 / (r * R * us);
    }
  }
  return sum;
}

static double jump(const skf_triangle_view *g, const skf_disc *c, int i) {
  double R = c->R, r1 = g->r[i], r2 = g->r[(i + 1) % 3], a1 = fmax(c->power[i], 0) / (R * (R + r1));
  double a2 = fmax(c->power[(i + 1) % 3], 0) / (R * (R + r2));
  if (a1 == 0 || a2 == 0) return a2 * a2 - a1 * a1;
  return -(g->l2[i] - g->l1[i]) * (g->l1[i] + g->l2[i]) / ((r1 + r2) * R) * (a1 + a2);
}

/* `rim`: the disc is a small cap, or is seen from far beyond itself. */
static void edges(const skf_triangle_view *g, const skf_disc *disc, bool beyond, bool rim, int order,
                  skf_triangle_sum *s) {
  double R = disc->R, b = disc->rm * disc->rm / (R * (R + fabs(g->z))), G0 = R * R / 12 * b * b * b * (4 - 3 * b),
         w0 = fabs(g->z) / R;
  for (int i = 0; i < 3; i++) {
    skf_edge_clip e = skf_edge_cut(g, i, disc);
    part p = {0, 0, 0};
    bool on_edge = g->d[i] * g->d[i] + g->z * g->z == 0 && skf_edge_nearest(e.b1, e.b2) == 0; /* or underflows */
    if (e.in) p = rim || on_edge ? panel_part(g, disc, i, &e, beyond, s) : closed_part(g, R, i, &e, s);
    if (!beyond) {
      p.F += G0 * e.out;
      p.W -= b * b * e.out;
      p.V += 2 * w0 * b * e.out;
    }
    skf_sum_F(s, p.F);
    skf_sum_Z(s, g->z * p.W);
    if (order < 2) continue;
    skf_sum_zz(s, p.W);
    skf_sum_zz(s, p.V);
    s->jump[i] = jump(g, disc, i);
  }
}

/* Next to a thin triangle only the gradient's part across it cancels. */
static void mend_gradient(const skf_triangle_view *g, double R, const skf_triangle_sum *s, skf_value *v) {
  const skf_triangle_plan *T = g->T;
  double gt = 0;
  for (int i = 0; i < 3; i++) gt += T->s[i] * s->J[i];
  v->g = v3_add(v3_scale(gt, T->t[T->longest]),
                v3_add(v3_scale(skf_cone_transverse(g, R), T->m[T->longest]), v3_scale(s->Z, T->n)));
}

static void eval(double R, double w, double d[4]) {
  double r = sqrt(w), a = 1 - r / R;
  d[0] = a * a;
  d[1] = -a / (R * r);
  d[2] = 0.5 / (R * r * w);
}

static skf_rim rim_of(const skf_triangle_view *g, const skf_disc *disc) {
  const skf_triangle_plan *T = g->T;
  int k = T->longest;
  double X = g->l1[k];
  skf_rim rim = {disc->rm, {-disc->rm, 0, disc->rm}, 3};
  for (int step = 0; step < 3; step++) {
    int i = (k + step) % 3;
    skf_edge_clip e = skf_edge_cut(g, i, disc);
    if (e.in && e.before > 0) rim.at[rim.count++] = X + T->c[i] * e.before;
    if (e.in && e.after > 0) rim.at[rim.count++] = X + T->c[i] * (T->L[i] - e.after);
    X += T->c[i] * T->L[i];
  }
  return rim;
}

static void cone(const skf_triangle_view *g, double R, int order, skf_value *v) {
  if (g->dist >= R) return;
  skf_disc disc = skf_disc_at(g, R);
  if (disc.all && g->dist >= 1.5 * g->T->diam) {
    skf_compact_cubature(SKF_COMPACT_CONE, &disc, g, skf_quad_order(g->dist, g->T->diam), order, v);
    return;
  }
  bool beyond = !g->inside && g->lat > 0.5 * disc.rm, rim = beyond || 2 * fabs(g->z) > R;
  skf_triangle_sum s = {0};
  edges(g, &disc, beyond, rim, order, &s);
  skf_triangle_cond c = skf_triangle_assemble(g, &s, order, v);
  double limit = rim ? SKF_COMPACT_COND : SKF_TRIANGLE_COND;
  bool keep = c.F <= limit;
  if (keep) {
    if (0.1 * c.g > limit) mend_gradient(g, R, &s, v);
    if (c.h <= SKF_TRIANGLE_COND_HESSIAN) return;
  }
  skf_value rays = {0};
  if (g->dist < 0.5 * R) { /* off the rim */
    skf_rim end = rim_of(g, &disc);
    skf_quad_across(eval, R, 0, g, disc.all ? NULL : &end, order, &rays);
  } else
    skf_compact_polar(SKF_COMPACT_CONE, &disc, g, order, &rays);
  if (keep) rays.F = v->F, rays.g = v->g; /* the same F and gradient with and without the Hessian */
  *v = rays;
}

void skf_triangle_metaball(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  double R = e->kernel.param;
  skf_triangle_view g;
  skf_triangle_face(&e->plan.triangle, x, &g);
  if (3 * g.reach <= R) { /* all within the core: a quadratic, that two nodes integrate exactly */
    skf_quad_conical(skf_kernel_row(SKF_METABALL)->eval, R, g.a, g.T->area, 2, order, v);
    return;
  }
  if (skf_triangle_clear(&g, R)) return;
  skf_triangle_look(&g);
  skf_value outer = {0}, inner = {0};
  cone(&g, R, order, &outer);
  cone(&g, R / 3, order, &inner);
  v->F = 1.5 * outer.F - 0.5 * inner.F;
  v->g = v3_mad(v3_scale(1.5, outer.g), -0.5, inner.g);
  for (int i = 0; i < 6 && order > 1; i++) v->h[i] = 1.5 * outer.h[i] - 0.5 * inner.h[i];
}
