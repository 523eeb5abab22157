/* SPDX-License-Identifier: MIT */
/* exp(-a^2 r^2): edge integrals by Gauss-Legendre. Owen's T would close them, but libraries give it to 1e-16
   absolutely: 4e-12 relatively for a = 10 near the triangle and nothing in the tail. The gradient is closed. */
#include "field/triangle_parts.h"
#include "field/triangle_gaussian.h"

/* sqrt(pi) exp(u^2) u erfc(u) for u > 20 */
static double erfc_tail(double u) {
  double sum = 1, term = 1, q = 1 / (2 * u * u);
  for (int k = 1; k < 12; k++) {
    term *= -(2 * k - 1) * q;
    sum += term;
  }
  return sum;
}

double skf_gaussian_segment(double a, double c2, double l1, double l2) {
  if (l2 < 0 || (l1 < 0 && -l1 > l2)) {
    double swap = l1;
    l1 = -l2;
    l2 = -swap;
  }
  double len = l2 - l1, a2 = a * a, u1 = a * l1, u2 = a * l2;
  if (a * len * (1 + 2 * fmax(u1, 0)) < 1) { /* erf's difference would cancel */
    const skf_gauss_node *g = skf_gauss_rule(12);
    double sum = 0, mid = 0.5 * (l1 + l2);
    for (int i = 0; i < 12; i++) {
      double l = mid + 0.5 * len * g[i].x;
      sum += g[i].w * exp(-a2 * (c2 + l * l));
    }
    return 0.5 * len * sum;
  }
  const double root_pi = 1.7724538509055160273;
  double scale = root_pi / (2 * a);
  if (u1 <= 0) return scale * exp(-a2 * c2) * (erf(u2) + erf(-u1));
  if (u1 <= 20) return scale * exp(-a2 * c2) * (erfc(u1) - erfc(u2));
  return (exp(-a2 * (c2 + l1 * l1)) / u1 * erfc_tail(u1) - exp(-a2 * (c2 + l2 * l2)) / u2 * erfc_tail(u2)) / (2 * a);
}

/* (1 - exp(-x)) / x */
static double phi1(double x) { return x < 1e-8 ? 1 - 0.5 * x : -expm1(-x) / x; }

/* Over the triangle or near it. exp(-a^2 l^2) < 1e-17 beyond 6.3 / a: only the angle remains. */
static double near_edge(double a, double z, double d, double l1, double l2) {
  double a2 = a * a, cut = 6.3 / a, b1 = fmin(fmax(l1, -cut), cut), b2 = fmax(fmin(l2, cut), -cut), sum = 0, rest = 0;
  if (b2 > b1) {
    const skf_gauss_node *g = skf_gauss_rule(16);
    int count = (int)fmax(1, ceil(a * (b2 - b1) / 2.5));
    double h = (b2 - b1) / count;
    for (int k = 0; k < count; k++)
      for (int i = 0; i < 16; i++) {
        double l = b1 + h * (k + 0.5 + 0.5 * g[i].x);
        sum += g[i].w * phi1(a2 * (d * d + l * l));
      }
    sum *= 0.25 * h * d;
  }
  if (l1 < -cut) rest += skf_edge_angle(d, l1, fmin(l2, -cut));
  if (l2 > cut) rest += skf_edge_angle(d, fmax(l1, cut), l2);
  return exp(-a2 * z * z) * (sum + rest / (2 * a2));
}

/* p' outside, a lat > 1: G-form, cut where the integrand has lost e^-42. */
static double far_edge(double a, double z, double d, double l1, double l2) {
  double a2 = a * a, near = skf_edge_nearest(l1, l2), cut = sqrt(near * near + 42 / a2), sum = 0;
  double b1 = fmax(l1, -cut), b2 = fmin(l2, cut), count = fmax(1, ceil(a * (b2 - b1) / 1.5));
  if (near > 0) count = fmax(count, ceil(a2 * (fmax(b1 * b1, b2 * b2) - near * near) / 8));
  const skf_gauss_node *g = skf_gauss_rule(16);
  double h = (b2 - b1) / count;
  for (int k = 0; k < (int)count; k++)
    for (int i = 0; i < 16; i++) {
      double l = b1 + h * (k + 0.5 + 0.5 * g[i].x), rho2 = d * d + l * l;
      sum += g[i].w * exp(-a2 * (rho2 + z * z)) / rho2;
    }
  return -d * 0.5 * h * sum / (2 * a2);
}

static void edges(const skf_triangle_view *g, double a, int order, skf_triangle_sum *s) {
  double z = g->z, a2 = a * a;
  bool far = !g->inside && a * g->lat > 1;
  for (int i = 0; i < 3; i++) {
    double d = g->d[i], l1 = g->l1[i], l2 = g->l2[i];
    skf_sum_F(s, far ? far_edge(a, z, d, l1, l2) : near_edge(a, z, d, l1, l2));
    s->J[i] = skf_gaussian_segment(a, d * d + z * z, l1, l2);
    if (order < 2) continue;
    double r1 = a * g->r[i], r2 = a * g->r[(i + 1) % 3];
    s->K[i] = -2 * a2 * s->J[i];
    s->jump[i] = skf_gaussian_difference(r1, r2, a2 * (l2 - l1) * (l1 + l2));
  }
  s->Z = -2 * a2 * z * s->F;
  s->absZ = 2 * a2 * fabs(z) * s->absF;
  s->zz = -2 * a2 * (1 - 2 * a2 * z * z) * s->F;
  s->abszz = 2 * a2 * (1 + 2 * a2 * z * z) * s->absF;
}

double skf_gaussian_difference(double r1, double r2, double d2) {
  if (fabs(d2) >= 1) return exp(-r2 * r2) - exp(-r1 * r1);
  return expm1(-d2) * exp(-r1 * r1);
}

void skf_triangle_gaussian(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  const skf_triangle_plan *T = &e->plan.triangle;
  double a = e->kernel.param;
  skf_triangle_view g;
  skf_triangle_face(T, x, &g);
  if (skf_triangle_clear(&g, 27.4 / a)) return; /* exp(-a^2 r^2) < 2^-1074 */
  if (a * T->diam <= 1.5 && a * a * g.dist * T->diam <= 3) {
    /* measured on 400 triangles for each step of the exponent's slope: 3e-14 in the Hessian with one node less */
    int n = (int)fmin(15, 6 + ceil(4 * a * fmax(1, a * g.dist) * T->diam));
    skf_quad_conical(skf_kernel_row(SKF_GAUSSIAN)->eval, a, g.a, T->area, n, order, v);
    return;
  }
  skf_triangle_look(&g);
  if (a * g.dist > 27.4) return;
  skf_triangle_sum s = {0};
  edges(&g, a, order, &s);
  skf_triangle_cond c = skf_triangle_assemble(&g, &s, order, v);
  double loss = 1 + a * a * g.dist * g.dist;
  bool keep = fmax(c.F, 0.1 * c.g) * loss <= SKF_TRIANGLE_COND;
  if (keep && c.h * loss <= SKF_TRIANGLE_COND_HESSIAN) return;
  skf_value strip = {0};
  skf_gaussian_strips(a, &g, order, &strip);
  if (keep) strip.F = v->F, strip.g = v->g; /* the same F and gradient with and without the Hessian */
  *v = strip;
}
