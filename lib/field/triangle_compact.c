/* SPDX-License-Identifier: MIT */
/* Quartic and soft object: polynomials in y = 1 - r^2 / R^2. Three or four Gauss nodes on an edge are its exact
   antiderivative, with terms of one sign. */
#include "field/triangle_compact.h"

skf_disc skf_disc_at(const skf_triangle_view *g, double R) {
  skf_disc c = {R, {0}, 0, true};
  for (int i = 0; i < 3; i++) {
    c.power[i] = dd3_power(R, g->a2[i]);
    if (c.power[i] < 0) c.all = false;
  }
  /* rm^2 = power + (distance of the vertex from p')^2; best where that is the smaller part of r */
  int k = g->nearest;
  double lat2 = g->d[k] * g->d[k] + g->l1[k] * g->l1[k], z2 = g->z * g->z;
  double rm2 = lat2 < z2 ? c.power[k] + lat2 : (R - fabs(g->z)) * (R + fabs(g->z));
  c.rm = sqrt(fmax(rm2, 0));
  return c;
}

double skf_disc_chord2(const skf_disc *disc, const skf_triangle_view *g, int edge) {
  double d = fabs(g->d[edge]), l1 = g->l1[edge], l2 = g->l2[edge];
  bool first = fabs(l1) < fabs(l2);
  double l = first ? l1 : l2;
  if (fabs(l) > disc->R) return (disc->rm - d) * (disc->rm + d);
  return disc->power[first ? edge : (edge + 1) % 3] + l * l;
}

/* int d dl / (d^2 + l^2) over [l1, l2], whose length is known better */
static double angle(double d, double l1, double l2, double length) {
  return d == 0 ? 0 : atan2(d * length, d * d + l1 * l2);
}

skf_edge_clip skf_edge_cut(const skf_triangle_view *g, int edge, const skf_disc *disc) {
  double d = g->d[edge], l1 = g->l1[edge], l2 = g->l2[edge], L = g->T->L[edge];
  double q1 = disc->power[edge], q2 = disc->power[(edge + 1) % 3];
  double c2 = q1 > 0 ? q1 + l1 * l1 : q2 > 0 ? q2 + l2 * l2 : skf_disc_chord2(disc, g, edge);
  bool in1 = q1 > 0, in2 = q2 > 0;
  skf_edge_clip c = {.in = c2 > 0 && (in1 || l1 < 0) && (in2 || l2 > 0)};
  if (!c.in) {
    c.out = angle(d, l1, l2, L);
    return c;
  }
  double T = c.chord = sqrt(c2); /* q = (T - l) (T + l) */
  c.b1 = in1 ? l1 : -T, c.b2 = in2 ? l2 : T;
  c.gap1 = !in1 ? 0 : l1 < 0 ? q1 / (T - l1) : T + l1;
  c.gap2 = !in2 ? 0 : l2 > 0 ? q2 / (T + l2) : T - l2;
  double above1 = l1 > 0 ? q1 / (T + l1) : T - l1, below2 = l2 < 0 ? q2 / (T - l2) : T + l2;
  c.length = in1 && in2 ? L : in1 ? above1 : in2 ? below2 : 2 * T;
  c.before = in1 ? 0 : -q1 / (T - l1), c.after = in2 ? 0 : -q2 / (T + l2);
  if (!in1) c.out += angle(d, l1, -T, c.before);
  if (!in2) c.out += angle(d, T, l2, c.after);
  return c;
}

skf_panels skf_clip_panels(const skf_edge_clip *e, double delta) {
  skf_panels p = skf_panels_over(e->b1, e->b2, delta);
  if (p.plain) p.step = e->length;
  return p;
}

double skf_clip_power(const skf_edge_clip *e, const skf_panels *p, int node, double l) {
  double x = skf_gauss_rule(SKF_PANEL_NODES)[node].x, half = 0.5 * e->length;
  if (p->plain) return (e->gap1 + half * (1 + x)) * (e->gap2 + half * (1 - x));
  return (e->gap1 + (l - e->b1)) * (e->gap2 + (e->b2 - l));
}

skf_compact_node skf_compact_at(skf_compact_kind kind, double y, double r, double R) {
  double R2 = R * R;
  if (kind == SKF_COMPACT_QUARTIC) return (skf_compact_node){y * y, -4 * y / R2, 8 / (R2 * R2)};
  if (kind == SKF_COMPACT_SOFT)
    return (skf_compact_node){y * y * (5 + 4 * y) / 9, -y * (20 + 24 * y) / (9 * R2), (40 + 96 * y) / (9 * R2 * R2)};
  double a = y / (1 + r / R);
  return (skf_compact_node){a * a, -2 * a / (R * r), 2 / (R * r * r * r)};
}

/* With y0 = y at p': (G0 - G) / rho^2, G / R^2, R^2 (h - h0) / rho^2, R^4 (g - g0) / rho^2 for g = h'/r. */
typedef struct terms {
  double H, G, D, V;
} terms;

static terms terms_at(skf_compact_kind kind, double y, double y0) {
  double s2 = y0 * y0 + y0 * y + y * y, s3 = (y0 + y) * (y0 * y0 + y * y);
  if (kind == SKF_COMPACT_QUARTIC) return (terms){s2 / 6, y * y * y / 6, -(y0 + y), 4};
  return (terms){(5 * s2 + 3 * s3) / 54, y * y * y * (5 + 3 * y) / 54, -(5 * (y0 + y) + 4 * s2) / 9,
                 (20 + 24 * (y0 + y)) / 9};
}

typedef struct polynomial {
  skf_disc disc;
  skf_compact_kind kind;
  double y0, G0;
  skf_compact_node center;
} polynomial;

static void edge_inside(const polynomial *c, const skf_triangle_view *g, int i, const skf_edge_clip *e,
                        skf_triangle_sum *s, double zw[2], double *F, bool sum_terms) {
  int n = c->kind == SKF_COMPACT_QUARTIC ? 3 : 4;
  const skf_gauss_node *rule = skf_gauss_rule(n);
  double half = 0.5 * e->length, R = c->disc.R, R2 = R * R, d = g->d[i];
  for (int j = 0; j < n; j++) {
    double w = half * rule[j].w;
    double y = (e->gap1 + half * (1 + rule[j].x)) * (e->gap2 + half * (1 - rule[j].x)) / R2;
    skf_compact_node p = skf_compact_at(c->kind, y, 0, R);
    s->J[i] += w * p.h;
    s->K[i] += w * p.g;
    if (!sum_terms) continue;
    terms t = terms_at(c->kind, y, c->y0);
    *F += d * w * t.H;
    zw[0] += d * w * t.D / R2;
    zw[1] += d * w * t.V / (R2 * R2);
  }
}

/* G-form, for p' far outside in terms of rm: only the part of the support's rim that is seen counts. */
static void edge_beyond(const polynomial *c, const skf_triangle_view *g, int i, const skf_edge_clip *e, double zw[2],
                        double *F) {
  double l[SKF_PANEL_NODES], w[SKF_PANEL_NODES], R = c->disc.R, R2 = R * R, d = g->d[i];
  skf_panels p = skf_clip_panels(e, skf_panel_scale(d, e->b1, e->b2));
  for (int k = 0; k < p.count; k++) {
    skf_panel_nodes(&p, k, l, w);
    for (int j = 0; j < SKF_PANEL_NODES; j++) {
      double y = skf_clip_power(e, &p, j, l[j]) / R2, q = d * w[j] / (d * d + l[j] * l[j]);
      skf_compact_node n = skf_compact_at(c->kind, y, 0, R);
      *F -= q * R2 * terms_at(c->kind, y, c->y0).G;
      zw[0] += q * n.h;
      zw[1] += q * n.g;
    }
  }
}

/* Rise of h along the edge, 0 beyond the support. */
static double jump(const polynomial *c, const skf_triangle_view *g, int i) {
  double R = c->disc.R, y1 = c->disc.power[i] / (R * R), y2 = c->disc.power[(i + 1) % 3] / (R * R),
         dy = -(g->l2[i] - g->l1[i]) * (g->l1[i] + g->l2[i]) / (R * R);
  if (y1 <= 0) return y2 <= 0 ? 0 : skf_compact_at(c->kind, y2, 0, R).h;
  if (y2 <= 0) return -skf_compact_at(c->kind, y1, 0, R).h;
  if (c->kind == SKF_COMPACT_QUARTIC) return dy * (y1 + y2);
  return dy * (5 * (y1 + y2) + 4 * (y1 * y1 + y1 * y2 + y2 * y2)) / 9;
}

static void edges(const polynomial *c, const skf_triangle_view *g, bool beyond, int order, skf_triangle_sum *s) {
  for (int i = 0; i < 3; i++) {
    skf_edge_clip e = skf_edge_cut(g, i, &c->disc);
    double F = 0, zw[2] = {0, 0};
    if (e.in) edge_inside(c, g, i, &e, s, zw, &F, !beyond);
    if (e.in && beyond) edge_beyond(c, g, i, &e, zw, &F);
    if (!beyond) {
      F += c->G0 * e.out;
      zw[0] -= c->center.h * e.out;
      zw[1] -= c->center.g * e.out;
    }
    skf_sum_F(s, F);
    skf_sum_Z(s, g->z * zw[0]);
    if (order < 2) continue;
    skf_sum_zz(s, zw[0]);
    skf_sum_zz(s, g->z * g->z * zw[1]);
    s->jump[i] = jump(c, g, i);
  }
}

void skf_compact_cubature(skf_compact_kind kind, const skf_disc *disc, const skf_triangle_view *g, int n, int order,
                          skf_value *v) {
  const skf_gauss_node *rule = skf_gauss_rule(n);
  int k = g->nearest;
  skf_vec3 a = g->a[k], e1 = dd3_round(g->T->e[k]), e2 = dd3_round(g->T->e[(k + 2) % 3]);
  double R = disc->R, R2 = R * R;
  for (int i = 0; i < n; i++) {
    double xi = 0.5 * (1 + rule[i].x), wi = 0.5 * g->T->area * rule[i].w * xi;
    for (int j = 0; j < n; j++) {
      double eta = 0.5 * (1 + rule[j].x);
      skf_vec3 D = v3_sub(v3_scale(xi * (1 - eta), e1), v3_scale(xi * eta, e2)), X = v3_add(a, D);
      double y = (disc->power[k] - v3_dot(v3_mad(D, 2, a), D)) / R2;
      skf_compact_node p = skf_compact_at(kind, y, kind == SKF_COMPACT_CONE ? v3_norm(X) : 0, R);
      skf_quad_add(v, wi * rule[j].w, (double[]){p.h, 0.5 * p.g, 0.25 * p.k, 0}, X, order);
    }
  }
}

static void field(skf_compact_kind kind, const skf_prepared *prepared, skf_vec3 x, int order, skf_value *v) {
  double R = prepared->kernel.param;
  skf_triangle_view g;
  skf_triangle_face(&prepared->plan.triangle, x, &g);
  if (skf_triangle_clear(&g, R)) return;
  skf_triangle_look(&g);
  if (g.dist >= R) return;
  polynomial c = {.kind = kind, .disc = skf_disc_at(&g, R)};
  if (c.disc.all) { /* the integrand is a polynomial and the cubature exact */
    skf_compact_cubature(kind, &c.disc, &g, kind == SKF_COMPACT_QUARTIC ? 3 : 4, order, v);
    return;
  }
  double rm = c.disc.rm, y0 = rm * rm / (R * R);
  c = (polynomial){c.disc, kind, y0, R * R * terms_at(kind, y0, 0).G, skf_compact_at(kind, y0, 0, R)};
  skf_triangle_sum s = {0};
  edges(&c, &g, !g.inside && g.lat > 0.5 * rm, order, &s);
  skf_triangle_cond cond = skf_triangle_assemble(&g, &s, order, v);
  bool keep = fmax(cond.F, 0.1 * cond.g) <= SKF_COMPACT_COND;
  if (keep && cond.h <= SKF_TRIANGLE_COND_HESSIAN) return;
  skf_value rays = {0};
  skf_compact_polar(kind, &c.disc, &g, order, &rays);
  if (keep) rays.F = v->F, rays.g = v->g; /* the same F and gradient with and without the Hessian */
  *v = rays;
}

void skf_triangle_quartic(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  field(SKF_COMPACT_QUARTIC, e, x, order, v);
}

void skf_triangle_soft_object(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  field(SKF_COMPACT_SOFT, e, x, order, v);
}
