/* SPDX-License-Identifier: MIT */
#include "field/arc_frame.h"
#include "field/segment_frame.h"
#include "field/simple.h"
#include "field/triangle.h"
#include "num/gauss.h"
#include "num/gaussian.h"

static void eval(double s, double w, double d[4]) {
  double a2 = s * s;
  d[0] = exp(-a2 * w);
  d[1] = -a2 * d[0];
  d[2] = -a2 * d[1];
  d[3] = -a2 * d[2];
}

static void point(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  double w, d[4];
  skf_dd3 r = skf_point_delta(e, x, &w);
  eval(e->kernel.param, w, d);
  skf_point_result(d, r, order, v);
}

/* exp(-a2 w0) - exp(-a2 w1), dw = w1 - w0 */
static double step(double a2, double w0, double w1, double dw) {
  double y = a2 * dw;
  return y >= 0 ? -exp(-a2 * w0) * expm1(-y) : exp(-a2 * w1) * expm1(y);
}

/* The literature lacks the factor sqrt(pi) / 2a, and adds error functions that cancel beyond the ends. */
static void segment(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  skf_segment_frame f;
  skf_segment_place(e, x, &f);
  double a = e->kernel.param, a2 = a * a, w0 = f.r0 * f.r0, w1 = f.r1 * f.r1;
  skf_segment_terms t = {.F = exp(-a2 * f.h2) * skf_gaussian_span(a * f.t0, a * f.t1, a * f.L) / a,
                         .ends = step(a2, w0, w1, f.dw)};
  t.g = -2 * a2 * t.F;
  if (order > 1) {
    t.k_h2 = 4 * a2 * (a2 * f.h2) * t.F;
    t.g_ends = -2 * a2 * t.ends;
    t.g0 = -2 * a2 * exp(-a2 * w0);
    t.g1 = -2 * a2 * exp(-a2 * w1);
  }
  skf_segment_result(&f, &t, order, v);
}

/* Modified Bessel functions of b = 2 a^2 rho k; j: int of h cos^i psi. */
static void circle(double a2, const skf_arc_frame *f, int order, skf_value *v) {
  double b = 0.5 * a2 * f->spread, i0, gap, ratio, area = 2 * SKF_PI * f->rho * exp(-a2 * f->alpha);
  skf_bessel_scaled(b, &i0, &gap, &ratio);
  double ss = 0.5 * gap, c2s2 = 0.125 * ratio, g = -2 * a2 * area, k = 4 * a2 * a2 * area;
  skf_arc_moments m = {.F = area * i0,
                       .g_cc = g * (i0 - ss),
                       .g_ss = g * ss,
                       .k_c4 = k * (i0 - ss - c2s2),
                       .k_c2s2 = k * c2s2,
                       .k_s4 = k * (ss - c2s2)};
  skf_arc_terms t = skf_arc_gather(f, &m, order);
  /* near the axis I0 - I1 would cost a digit for each of a rho / k */
  if (b < 30) t.k = g * f->k * (i0 - a2 * f->rho * f->rho * ratio);
  skf_arc_result(f, &t, order, v);
}

/* Nodes for exp(-range sin^2) over at most a quarter turn: measured to leave 1e-14 for every start and length. */
static int nodes(double range) {
  static const struct {
    double upto;
    int n;
  } rule[] = {{0.3, 10}, {1, 12}, {2, 14}, {4, 16}, {10, 20}, {20, 24}, {INFINITY, 30}};
  int i = 0;
  while (range >= rule[i].upto) i++;
  return rule[i].n;
}

/* Where the exponent has grown by 38 (e^-38 is below rounding) the piece ends. Fourth powers need more nodes. */
static void add_piece(double a2, const skf_arc_frame *f, const skf_arc_piece *p, int order, skf_arc_moments *m) {
  double B = a2 * f->spread, range = B * p->rise, length = p->length;
  double scale = exp(-a2 * (f->alpha + f->spread * p->sa * p->sa));
  if (scale == 0) return; /* else the piece starts within its width of the nearest point: no cancellation below */
  if (range > 38) {
    length = fmin(length, asin(sqrt(fmin(1, p->sa * p->sa + 38 / B))) - p->xa);
    range = 38;
  }
  for (int pass = 1; pass <= order; pass++) {
    int n = pass == 1 ? nodes(range) : nodes(range) + 4 < SKF_GAUSS_MAX ? nodes(range) + 4 : SKF_GAUSS_MAX;
    const skf_gauss_node *node = skf_gauss_rule(n);
    double g = -2 * a2, k = 4 * a2 * a2;
    for (int j = 0; j < n; j++) {
      double u = 0.5 * length * (1 + node[j].x), s = sin(p->xa + u), c = cos(p->xa + u), ss = s * s, cc = c * c;
      double h = f->rho * length * scale * node[j].w * exp(-B * sin(u) * sin(u + 2 * p->xa)), odd = p->sign * s * c;
      if (pass == 1) {
        m->F += h;
        m->g_cc += g * h * cc;
        m->g_ss += g * h * ss;
        continue;
      }
      m->k_c4 += k * h * cc * cc;
      m->k_c2s2 += k * h * cc * ss;
      m->k_s4 += k * h * ss * ss;
      m->k_c3s += k * h * cc * odd;
      m->k_cs3 += k * h * ss * odd;
    }
  }
}

/* An incomplete Bessel function has no closed form: Gauss on at most four pieces, the error bounded beforehand. */
static void arc(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  skf_arc_frame f;
  skf_arc_place(e, x, &f);
  double a2 = e->kernel.param * e->kernel.param;
  if (f.full) return circle(a2, &f, order, v);
  skf_arc_piece piece[4];
  int n = skf_arc_pieces(&f, true, piece);
  skf_arc_moments m = {.F = 0};
  for (int i = 0; i < n; i++) add_piece(a2, &f, piece + i, order, &m);
  double y = a2 * f.turn * f.k, near = exp(-a2 * fmin(f.r02, f.r12));
  m.ends = f.rho * a2 * f.turn * near * (fabs(y) > 1e-300 ? -expm1(-fabs(y)) / fabs(y) : 1);
  m.g_ends = -2 * a2 * m.ends;
  skf_arc_terms t = skf_arc_gather(&f, &m, order);
  skf_arc_result(&f, &t, order, v);
}

static void plane(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  double a = e->kernel.param, z = skf_plane_height(e, x), d[4];
  eval(a, z * z, d);
  skf_plane_result(e, SKF_PI * d[0] / (a * a), -2 * SKF_PI * z * d[0], -2 * SKF_PI * (d[0] + 2 * z * z * d[1]), order,
                   v);
}

const skf_kernel_ops skf_kernel_gaussian = {
    .info = {"gaussian", "exp(-a^2 r^2)", "smooth, falls fastest", "a", "1/L", "1 / a is its width", false, false},
    .eval = eval,
    .closed[SKF_POINT] = point,
    .closed[SKF_SEGMENT] = segment,
    .closed[SKF_ARC] = arc,
    .closed[SKF_TRIANGLE] = skf_triangle_gaussian,
    .closed[SKF_PLANE] = plane,
};
