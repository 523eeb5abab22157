/* SPDX-License-Identifier: MIT */
#include "field/arc_frame.h"
#include "field/segment_frame.h"
#include "field/simple.h"
#include "field/solid.h"
#include "field/triangle.h"
#include "num/elliptic.h"
#include "num/gauss.h"

static void eval(double s, double w, double d[4]) {
  (void)s;
  d[0] = 1 / sqrt(w);
  d[1] = -0.5 * d[0] / w;
  d[2] = -1.5 * d[1] / w;
  d[3] = -2.5 * d[2] / w;
}

static void infinite(skf_value *v) { v->F = INFINITY; }

static void point(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  double w, d[4];
  skf_dd3 r = skf_point_delta(e, x, &w);
  if (w == 0) return infinite(v);
  eval(0, w, d);
  skf_point_result(d, r, order, v);
}

/* 1/r0 - 1/r1 and 1/r0^3 - 1/r1^3 from r1^2 - r0^2 = dw */
static double inverse_step(double dw, double r0, double r1) { return dw / (r0 * r1 * (r0 + r1)); }
static double inverse_cube_step(double dw, double r0, double r1) {
  return inverse_step(dw, r0, r1) * (1 / (r0 * r0) + 1 / (r0 * r1) + 1 / (r1 * r1));
}

/* log1p(2 L / (r0 + r1 - L)) is exact where atanh(L / (r0 + r1)) and the difference of two logarithms are not. */
static void segment(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  skf_segment_frame f;
  skf_segment_place(e, x, &f);
  double E = skf_segment_excess(f.t0, f.r0, f.t1, f.r1, f.h2), r0 = f.r0, r1 = f.r1;
  if (E == 0) return infinite(v);
  skf_segment_terms t = {.F = log1p(2 * f.L / E),
                         .g = -2 * f.L * (r0 + r1) / (E * (E + 2 * f.L) * r0 * r1),
                         .ends = inverse_step(f.dw, r0, r1)};
  if (order > 1) {
    t.g_ends = -inverse_cube_step(f.dw, r0, r1);
    t.g0 = -1 / (r0 * r0 * r0);
    t.g1 = -1 / (r1 * r1 * r1);
    t.k_h2 = -2 * t.g - skf_segment_moment(&f, &t); /* 1/r is harmonic */
  }
  skf_segment_result(&f, &t, order, v);
}

/* The three integrals of 1/r and cos^2 chi / r^3 over the pieces by Carlson's two-limit form [DLMF 19.29.4, 19.29.7];
   false on the arc itself. */
static bool partial(const skf_arc_frame *f, double *I, double *A) {
  skf_arc_piece piece[4];
  int n = skf_arc_pieces(f, false, piece);
  *I = *A = 0;
  for (int i = 0; i < n; i++) {
    const skf_arc_piece *p = piece + i;
    double ra = sqrt(f->alpha * p->ca * p->ca + f->beta * p->sa * p->sa);
    double rb = sqrt(f->alpha * p->cb * p->cb + f->beta * p->sb * p->sb), rd;
    if (ra == 0 || rb == 0) return false;
    double u = (p->cb * p->sb * ra + p->ca * p->sa * rb) / p->rise;
    double v = (p->ca * p->sb * rb + p->cb * p->sa * ra) / p->rise;
    double w = (p->ca * p->sb * ra + p->cb * p->sa * rb) / p->rise;
    *I += skf_carlson(u * u, v * v, w * w, &rd);
    *A += rd / 3 + p->ca * p->cb / (ra * rb * w);
  }
  return true;
}

/* int c^4/r^5, c^2 s^2/r^5, s^4/r^5 by Gauss where r hardly changes along the arc: its square by a seventh at most,
   so that 14 nodes leave 1e-17. */
static void smooth_moments(const skf_arc_frame *f, double *c4, double *c2s2, double *s4) {
  enum { N = 14 };
  const skf_gauss_node *node = skf_gauss_rule(N);
  skf_arc_piece piece[4];
  int n = skf_arc_pieces(f, true, piece);
  *c4 = *c2s2 = *s4 = 0;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < N; j++) {
      double chi = piece[i].xa + 0.5 * piece[i].length * (1 + node[j].x), s = sin(chi), c = cos(chi);
      double cc = c * c, ss = s * s, r2 = f->alpha * cc + f->beta * ss;
      double w = 0.5 * piece[i].weight * piece[i].length * node[j].w / (r2 * r2 * sqrt(r2));
      *c4 += w * cc * cc, *c2s2 += w * cc * ss, *s4 += w * ss * ss;
    }
}

/* The same from A = int c^2/r^3 and B = int s^2/r^3 by parts: [s c / r^3] = A - B - 3 (beta - alpha) int c^2 s^2/r^5.
 */
static void parted_moments(const skf_arc_frame *f, double A, double B, double *c4, double *c2s2, double *s4) {
  double jump = 0;
  if (!f->full) {
    double u = 1 / (f->r02 * f->r0), v = 1 / (f->r12 * f->r1), sc0 = f->s0 * f->c0, sc1 = f->s1 * f->c1;
    double step = inverse_cube_step(f->k * f->turn, f->r0, f->r1);
    if (fabs(sc0) * u + fabs(sc1) * v < f->sin_half * (u + v))
      jump = sc1 * v - sc0 * u; /* near an end */
    else
      jump = 0.5 * (f->cos_mid * f->sin_half * (u + v) - f->sin_mid * f->cos_half * step);
  }
  *c2s2 = (A - B - jump) / (3 * f->spread);
  *c4 = f->alpha > 0 ? (A - f->beta * *c2s2) / f->alpha : 0; /* only alpha times it counts */
  *s4 = (B - f->alpha * *c2s2) / f->beta;
}

/* int c^3 s/r^5 and int c s^3/r^5: elementary, with beta - alpha divided out where it is small. */
static void odd_moments(const skf_arc_frame *f, double *c3s, double *cs3) {
  double a = f->alpha, b = f->beta, q = f->r0 * f->r1, d = f->spread;
  double cc0 = f->c0 * f->c0, cc1 = f->c1 * f->c1, ss0 = f->s0 * f->s0, ss1 = f->s1 * f->s1;
  double jump = f->sin_half * f->sin_mid / ((f->r0 + f->r1) * q * q * q), c, cd = d * cc0 * cc1;
  if (2 * q < b)
    c = (b * (f->r02 + q + f->r12) / 3 - q * q) / d;
  else
    c = b / 3 * ((cc0 + cc1) * (2 - b / (b + q)) + cd / (b + q)) - cd;
  *c3s = jump * c;
  double sd = d * ss0 * ss1;
  *cs3 = jump * (a / 3 * ((ss0 + ss1) * (2 - a / (q + a)) - sd / (q + a)) + sd);
}

static void arc_hessian(const skf_arc_frame *f, double A, double B, skf_arc_moments *m) {
  double c4, c2s2, s4, c3s = 0, cs3 = 0, K = 6 * f->rho;
  if (8 * f->spread < f->beta) /* by parts loses beta / (beta - alpha) */
    smooth_moments(f, &c4, &c2s2, &s4);
  else
    parted_moments(f, A, B, &c4, &c2s2, &s4);
  m->k_c4 = K * c4, m->k_c2s2 = K * c2s2, m->k_s4 = K * s4;
  if (f->full) return;
  odd_moments(f, &c3s, &cs3);
  m->k_c3s = K * c3s, m->k_cs3 = K * cs3;
  m->g_ends = -f->rho * inverse_cube_step(f->turn, f->r0, f->r1);
}

static void arc(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  skf_arc_frame f;
  skf_arc_place(e, x, &f);
  double I, A, B; /* int 1/r, cos^2 chi / r^3, sin^2 chi / r^3 */
  skf_arc_moments m = {.F = 0};
  if (f.full) {
    double K, C, S;
    if (f.alpha == 0) return infinite(v);
    skf_elliptic_complete(f.da / f.db, f.spread / (f.db * (f.da + f.db)), &K, &C, &S);
    I = 2 * K / f.db, A = 2 * C / (f.db * f.alpha), B = 2 * S / (f.db * f.beta);
  } else {
    if (!partial(&f, &I, &A)) return infinite(v);
    B = (I - f.alpha * A) / f.beta;
    m.ends = f.rho * inverse_step(f.turn, f.r0, f.r1);
  }
  m.F = 2 * f.rho * I, m.g_cc = -2 * f.rho * A, m.g_ss = -2 * f.rho * B;
  if (order > 1) arc_hessian(&f, A, B, &m);
  skf_arc_terms t = skf_arc_gather(&f, &m, order);
  skf_arc_result(&f, &t, order, v);
}

/* Relative to 0 on the plane, where the two-sided mean of the gradient is returned. */
static void plane(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  double z = skf_plane_height(e, x);
  skf_plane_result(e, -2 * SKF_PI * fabs(z), z > 0 ? -2 * SKF_PI : z < 0 ? 2 * SKF_PI : 0, 0, order, v);
}

const skf_kernel_ops skf_kernel_inverse = {
    .info = {"inverse", "1 / r", "Newtonian potential", NULL, NULL, NULL, false, true},
    .eval = eval,
    .closed[SKF_POINT] = point,
    .closed[SKF_SEGMENT] = segment,
    .closed[SKF_ARC] = arc,
    .closed[SKF_TRIANGLE] = skf_triangle_inverse,
    .closed[SKF_PLANE] = plane,
    .closed[SKF_SOLID] = skf_solid_inverse,
    .singular[SKF_POINT] = "the point itself: F = +infinity, gradient 0",
    .singular[SKF_SEGMENT] = "the segment with its ends: F = +infinity, gradient 0",
    .singular[SKF_ARC] = "the arc with its ends: F = +infinity, gradient 0",
    .singular[SKF_TRIANGLE] = "on it F is finite and the gradient jumps across: the mean; on an edge the gradient is "
                              "infinite and the edge's own term is left out",
    .singular[SKF_PLANE] = "on it the gradient jumps: F = 0 and the mean gradient, 0",
    .singular[SKF_SOLID] =
        "nowhere for F and its gradient; the Hessian jumps across faces by 4 pi: the mean; on an edge "
        "it is infinite and the edge's own term is left out",
};
