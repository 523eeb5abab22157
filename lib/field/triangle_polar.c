/* SPDX-License-Identifier: MIT */
/* Kernels of finite support where the edge sums cancel: rays from the pole, the triangle's point nearest to p.
   Distances from p grow along each ray, so that the support cuts it once, and R^2 - r^2 comes from its value at the
   pole: a sum of terms of one sign, exact at the rim too. Along a ray q = pole + s w, s in [0, 1], w from the pole to a
   point of an edge: r^2 = dist^2 + 2 s b + s^2 |w|^2, b = w . (pole - p) >= 0,  R^2 y = P - 2 s b - s^2 |w|^2,  dA = d
   dl s ds. */
#include "field/triangle_compact.h"

/* An edge seen from the pole: its distance, the abscissae of its ends, b = b0 + b1 l. */
typedef struct ray_edge {
  double d, l1, l2, b0, b1;
} ray_edge;

typedef struct polar {
  const skf_triangle_view *g;
  skf_compact_kind kind;
  int order;
  double R, P, dist; /* P: R^2 y at the pole */
  skf_vec3 a;        /* pole - p */
  skf_value *v;
  ray_edge e;
  skf_vec3 t, m; /* of the edge */
  bool clipped;  /* the rays end at the rim */
} polar;

static void node(const polar *c, double w, double s, double y, skf_vec3 ray) {
  skf_vec3 X = v3_mad(c->a, s, ray);
  skf_compact_node n = skf_compact_at(c->kind, y, c->kind == SKF_COMPACT_CONE ? v3_norm(X) : 0, c->R);
  skf_quad_add(c->v, w, (double[]){n.h, 0.5 * n.g, 0.25 * n.k, 0}, X, c->order);
}

/* One ray, in steps that the cone's kink at r = 0 allows; polynomials need one. */
static void ray(void *context, double l, double weight) {
  const polar *c = context;
  double R2 = c->R * c->R, b = fmax(0, c->e.b0 + c->e.b1 * l), w2 = c->e.d * c->e.d + l * l;
  double B = b + sqrt(b * b + w2 * c->P), rim = c->P / B, end = c->clipped ? rim : 1, kink = c->dist / sqrt(w2);
  skf_vec3 w = v3_mad(v3_scale(c->e.d, c->m), l, c->t);
  bool one = c->kind != SKF_COMPACT_CONE || kink < 1e-12 * end;
  for (double s0 = 0, s1; s0 < end; s0 = s1) {
    double far = hypot(s0, kink);
    s1 = one || s0 + 1.5 * far >= end ? end : s0 + far;
    int n = one ? 4 : skf_quad_order(far, s1 - s0);
    const skf_gauss_node *rule = skf_gauss_rule(n);
    double half = 0.5 * (s1 - s0);
    for (int i = 0; i < n; i++) {
      double s = s0 + half * (1 + rule[i].x), to_rim = rim - s;
      if (c->clipped && s1 == end) to_rim = half * (1 - rule[i].x);
      double y = c->clipped ? to_rim * (w2 * s + B) / R2 : (c->P - s * (2 * b + s * w2)) / R2;
      if (y > 0) node(c, weight * c->e.d * half * rule[i].w * s, s, y, w);
    }
  }
}

/* Rays to [l1, l2] of the edge. Those that end at the rim are singular in l where b^2 + |w|^2 P = 0, and where w = 0
   unless b > 0 there; the others, for the cone, where r = 0 at the edge. */
static void fan(polar *c, double l1, double l2, double foot, double c_edge, bool clipped) {
  if (!(l2 > l1)) return;
  const ray_edge *e = &c->e;
  double q = c->P + e->b1 * e->b1;
  skf_place rim = {-e->b0 * e->b1 / q, sqrt(c->P * (e->b0 * e->b0 + e->d * e->d * q)) / q};
  c->clipped = clipped;
  if (!clipped && c->kind != SKF_COMPACT_CONE) {
    const skf_gauss_node *rule = skf_gauss_rule(4); /* exact */
    double half = 0.5 * (l2 - l1);
    for (int i = 0; i < 4; i++) ray(c, l1 + half * (1 + rule[i].x), half * rule[i].w);
  } else {
    skf_place at[2] = {clipped ? rim : (skf_place){foot, c_edge}, {0, e->d}};
    skf_quad_graded(at, clipped && !(e->b0 > 0) ? 2 : 1, l1, l2, ray, c);
  }
}

static void edge(polar *c, const skf_disc *disc, int j, double d, double l1, double l2) {
  const skf_triangle_view *g = c->g;
  if (!(d > 0 && l2 > l1)) return;
  c->t = g->T->t[j], c->m = g->T->m[j];
  c->e = (ray_edge){d, l1, l2, d * v3_dot(c->a, c->m), v3_dot(c->a, c->t)};
  if (g->inside) c->e.b0 = c->e.b1 = 0;
  skf_edge_clip in = skf_edge_cut(g, j, disc);
  double foot = l1 - g->l1[j], c_edge = hypot(g->d[j], g->z);
  double from = in.in ? l1 + in.before : l2, to = in.in ? l2 - in.after : l2;
  fan(c, l1, fmin(from, l2), foot, c_edge, true);
  if (!in.in) return;
  fan(c, from, to, foot, c_edge, false);
  fan(c, fmax(to, l1), l2, foot, c_edge, true);
}

/* Where the pole is on edge i between its ends. */
static void from_edge(polar *c, const skf_disc *disc, int i) {
  const skf_triangle_view *g = c->g;
  const skf_triangle_plan *T = g->T;
  int j = (i + 1) % 3, k = (i + 2) % 3;
  double ahead = g->l2[i], behind = -g->l1[i], tj = T->c[i] * T->c[j] + T->s[i] * T->s[j];
  double tk = T->c[i] * T->c[k] + T->s[i] * T->s[k];
  c->P = skf_disc_chord2(disc, g, i);
  c->a = v3_sub(v3_scale(g->d[i], T->m[i]), v3_scale(g->z, T->n));
  edge(c, disc, j, T->twice * T->per_L[j] * (ahead * T->per_L[i]), ahead * tj, ahead * tj + T->L[j]);
  edge(c, disc, k, T->twice * T->per_L[k] * (behind * T->per_L[i]), -behind * tk - T->L[k], -behind * tk);
}

static void from_vertex(polar *c, const skf_disc *disc, int k) {
  const skf_triangle_plan *T = c->g->T;
  int j = (k + 1) % 3;
  double before = dd3_dot_round(T->e[k], T->e[j]) * T->per_L[j];
  double after = -dd3_dot_round(T->e[(k + 2) % 3], T->e[j]) * T->per_L[j];
  c->P = disc->power[k];
  c->a = c->g->a[k];
  edge(c, disc, j, T->twice * T->per_L[j], before, after);
}

void skf_compact_polar(skf_compact_kind kind, const skf_disc *disc, const skf_triangle_view *g, int order,
                       skf_value *v) {
  polar c = {.g = g, .kind = kind, .order = order, .R = disc->R, .dist = g->dist, .v = v};
  if (g->inside) {
    c.P = disc->rm * disc->rm;
    c.a = v3_scale(-g->z, g->T->n);
    for (int j = 0; c.P > 0 && j < 3; j++) edge(&c, disc, j, g->d[j], g->l1[j], g->l2[j]);
    return;
  }
  int on = -1;
  for (int i = 0; i < 3; i++)
    if (g->d[i] < 0 && g->l1[i] < 0 && g->l2[i] > 0 && (on < 0 || g->d[i] > g->d[on])) on = i;
  if (on >= 0 && -g->d[on] <= g->lat * (1 + 1e-12))
    from_edge(&c, disc, on);
  else
    from_vertex(&c, disc, g->nearest);
}
