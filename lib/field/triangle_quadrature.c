/* SPDX-License-Identifier: MIT */
/* Quadratures over the triangle's area: far away, and where the edge sums cancel. */
#include "field/triangle_parts.h"

void skf_quad_add(skf_value *v, double w, const double d[4], skf_vec3 X, int order) {
  double w1 = 2 * w * d[1];
  v->F += w * d[0];
  v->g = v3_mad(v->g, -w1, X);
  if (order < 2) return;
  double w2 = 4 * w * d[2];
  v->h[0] += w1 + w2 * X.x * X.x;
  v->h[1] += w2 * X.x * X.y;
  v->h[2] += w2 * X.x * X.z;
  v->h[3] += w1 + w2 * X.y * X.y;
  v->h[4] += w2 * X.y * X.z;
  v->h[5] += w1 + w2 * X.z * X.z;
}

/* The rule converges like (x + sqrt(1 + x^2))^(-2 n), x = far / (diam / 2); 37 = -ln(1e-16). */
int skf_quad_order(double far, double diam) {
  int n = (int)ceil(18.5 / asinh(2 * far / diam)) + 2;
  return n < 3 ? 3 : n > SKF_GAUSS_MAX ? SKF_GAUSS_MAX : n;
}

void skf_quad_conical(skf_kernel_eval_fn eval, double param, const skf_vec3 a[3], double area, int n, int order,
                      skf_value *v) {
  const skf_gauss_node *g = skf_gauss_rule(n);
  skf_vec3 base = v3_sub(a[2], a[1]);
  double d[4];
  for (int i = 0; i < n; i++) {
    double xi = 0.5 * (1 + g[i].x), wi = 0.5 * area * g[i].w * xi;
    skf_vec3 start = v3_add(v3_scale(1 - xi, a[0]), v3_scale(xi, a[1]));
    for (int j = 0; j < n; j++) {
      skf_vec3 X = v3_mad(start, 0.5 * xi * (1 + g[j].x), base);
      eval(param, v3_norm2(X), d);
      skf_quad_add(v, wi * g[j].w, d, X, order);
    }
  }
}

#define GRADED_DEPTH 60

static void graded(const skf_place *at, int count, double lo, double hi, int depth,
                   void (*f)(void *context, double x, double weight), void *context) {
  double far = INFINITY;
  for (int i = 0; i < count; i++) far = fmin(far, hypot(skf_edge_nearest(lo - at[i].x, hi - at[i].x), at[i].y));
  if (hi - lo > far && depth > 0) {
    double mid = 0.5 * (lo + hi);
    graded(at, count, lo, mid, depth - 1, f, context);
    graded(at, count, mid, hi, depth - 1, f, context);
    return;
  }
  int n = skf_quad_order(far, hi - lo);
  const skf_gauss_node *rule = skf_gauss_rule(n);
  double half = 0.5 * (hi - lo);
  for (int i = 0; i < n; i++) f(context, lo + half * (1 + rule[i].x), half * rule[i].w);
}

void skf_quad_graded(const skf_place *at, int count, double lo, double hi,
                     void (*f)(void *context, double x, double weight), void *context) {
  if (hi > lo) graded(at, count, lo, hi, GRADED_DEPTH, f, context);
}

/* The triangle between an end of its longest side and the foot of its apex. */
typedef struct across {
  skf_kernel_eval_fn eval;
  double param, width;
  const skf_triangle_view *g;
  int order;
  skf_value *v;
  double start, slope; /* height over the longest side is slope |x - start| */
  double weight;
  const skf_rim *rim;
  skf_vec3 base; /* of the slice: foot of p on its line, from p */
} across;

static void across_node(void *context, double Y, double weight) {
  const across *c = context;
  skf_vec3 X = v3_mad(c->base, -Y, c->g->T->m[c->g->T->longest]);
  double d[4];
  c->eval(c->param, v3_norm2(X), d);
  skf_quad_add(c->v, c->weight * weight, d, X, c->order);
}

/* The slice at x: Y from *lo, length *len, cut to the rim's circle; false when nothing is left. */
static bool across_span(const across *c, double x, double *lo, double *len, bool *cut) {
  *lo = -c->g->d[c->g->T->longest], *len = c->slope * fabs(x - c->start), *cut = false;
  if (c->rim) {
    double R = c->rim->radius, chord = fabs(x) < R ? sqrt((R - x) * (R + x)) : 0, hi = *lo + *len;
    *cut = *lo < -chord || hi > chord;
    if (*cut) *lo = fmax(*lo, -chord), *len = fmin(hi, chord) - *lo;
  }
  return *len > 0;
}

static void across_slice(void *context, double x, double weight) {
  across *c = context;
  const skf_triangle_plan *T = c->g->T;
  double z = c->g->z, lo, len;
  bool cut;
  if (!across_span(c, x, &lo, &len, &cut)) return;
  double line = sqrt(x * x + z * z + c->width * c->width), far = hypot(skf_edge_nearest(lo, lo + len), line);
  c->weight = weight;
  c->base = v3_sub(v3_scale(x, T->t[T->longest]), v3_scale(z, T->n));
  if (len > far) {
    skf_quad_graded(&(skf_place){0, line}, 1, lo, lo + len, across_node, c);
    return;
  }
  int n = skf_quad_order(far, len);
  const skf_gauss_node *rule = skf_gauss_rule(n);
  for (int i = 0; i < n; i++) across_node(c, lo + 0.5 * len * (1 + rule[i].x), 0.5 * len * rule[i].w);
}

/* From one break to the next; a chord that cuts the slices ends like a root. */
static void across_part(across *c, skf_place foot, double lo, double hi) {
  const skf_rim *rim = c->rim;
  for (int i = 0; rim && i < rim->count; i++) {
    double at = rim->at[i];
    if (!(at > lo && at < hi)) continue;
    across_part(c, foot, lo, at);
    across_part(c, foot, at, hi);
    return;
  }
  double Y, len;
  bool cut;
  if (!across_span(c, 0.5 * (lo + hi), &Y, &len, &cut)) return;
  skf_place at[2] = {foot};
  if (cut) at[1] = (skf_place){copysign(rim->radius, lo + hi), 1e-9 * rim->radius};
  skf_quad_graded(at, cut ? 2 : 1, lo, hi, across_slice, c);
}

void skf_quad_across(skf_kernel_eval_fn eval, double param, double width, const skf_triangle_view *g,
                     const skf_rim *rim, int order, skf_value *v) {
  const skf_triangle_plan *T = g->T;
  int i = T->longest, j = (i + 1) % 3, k = (i + 2) % 3;
  double left = -T->c[k] * T->L[k], right = -T->c[j] * T->L[j], height = T->twice * T->per_L[i];
  double Y = skf_edge_nearest(-g->d[i], height - g->d[i]), l1 = g->l1[i], l2 = g->l2[i];
  skf_place foot = {0, sqrt(Y * Y + g->z * g->z + width * width)};
  across c = {eval, param, width, g, order, v, .start = l1, .slope = height / left, .rim = rim};
  if (left > 0) across_part(&c, foot, l1, l1 + left);
  c.start = l2, c.slope = height / right;
  if (right > 0) across_part(&c, foot, l2 - right, l2);
}

void skf_triangle_settle(skf_kernel_eval_fn eval, double param, double width, const skf_triangle_view *g,
                         const skf_triangle_sum *s, int order, skf_value *v) {
  skf_triangle_cond c = skf_triangle_assemble(g, s, order, v);
  bool keep = fmax(c.F, 0.1 * c.g) <= SKF_TRIANGLE_COND;
  if (keep && c.h <= SKF_TRIANGLE_COND_HESSIAN) return;
  if (!(hypot(g->dist, width) > 1e-13 * g->T->diam)) return; /* on it: the edges' terms are all there is */
  skf_value sum = {0};
  skf_quad_across(eval, param, width, g, NULL, order, &sum);
  if (keep) sum.F = v->F, sum.g = v->g; /* the same F and gradient with and without the Hessian */
  *v = sum;
}
