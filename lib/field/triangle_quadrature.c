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

/* Measured maximum over needles down to 1e-6: 2300 parts. */
#define MAX_PARTS 6000

typedef struct bisection {
  skf_kernel_eval_fn eval;
  double param, width;
  int order, parts;
  skf_value *v;
} bisection;

static bool bisect(bisection *b, const skf_vec3 a[3], double area) {
  double len2[3], far = hypot(skf_triangle_distance(a), b->width);
  int k = 0;
  for (int i = 0; i < 3; i++) {
    len2[i] = v3_norm2(v3_sub(a[(i + 1) % 3], a[i]));
    if (len2[i] > len2[k]) k = i;
  }
  double diam = sqrt(len2[k]);
  if (diam <= 0.8 * far) {
    skf_quad_conical(b->eval, b->param, a, area, skf_quad_order(far, diam), b->order, b->v);
    return true;
  }
  if (++b->parts > MAX_PARTS) return false;
  skf_vec3 p = a[k], q = a[(k + 1) % 3], apex = a[(k + 2) % 3], mid = v3_scale(0.5, v3_add(p, q));
  return bisect(b, (skf_vec3[]){p, mid, apex}, 0.5 * area) && bisect(b, (skf_vec3[]){mid, q, apex}, 0.5 * area);
}

bool skf_quad_bisect(skf_kernel_eval_fn eval, double param, double width, const skf_triangle_view *g, int order,
                     skf_value *v) {
  if (!(hypot(g->dist, width) > 1e-13 * g->T->diam)) return false;
  skf_value sum = {0};
  bisection b = {eval, param, width, order, 0, &sum};
  if (!bisect(&b, g->a, g->T->area)) return false;
  *v = sum;
  return true;
}

void skf_triangle_settle(skf_kernel_eval_fn eval, double param, double width, const skf_triangle_view *g,
                         const skf_triangle_sum *s, int order, skf_value *v) {
  skf_triangle_cond c = skf_triangle_assemble(g, s, order, v);
  bool keep = fmax(c.F, 0.1 * c.g) <= SKF_TRIANGLE_COND;
  if (keep && c.h <= SKF_TRIANGLE_COND_HESSIAN) return;
  skf_value sum = *v;
  if (!skf_quad_bisect(eval, param, width, g, order, &sum)) return;
  if (keep) sum.F = v->F, sum.g = v->g; /* the same F and gradient with and without the Hessian */
  *v = sum;
}
