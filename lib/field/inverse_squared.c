/* SPDX-License-Identifier: MIT */
#include "field/arc_frame.h"
#include "field/segment_frame.h"
#include "field/simple.h"
#include "field/triangle.h"
#include "num/span.h"

static void eval(double s, double w, double d[4]) {
  (void)s;
  d[0] = 1 / w;
  d[1] = -d[0] / w;
  d[2] = -2 * d[1] / w;
  d[3] = -3 * d[2] / w;
}

static void infinite(skf_value *v) { v->F = INFINITY; }

static void point(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  double w, d[4];
  skf_dd3 r = skf_point_delta(e, x, &w);
  if (w == 0) return infinite(v);
  eval(0, w, d);
  skf_point_result(d, r, order, v);
}

/* Integrals of even powers of cosine and sine divided by powers of a length D that may vanish: cos^2 / D^3, cos^4 /
   D^5, cos^2 sin^2 / D^3, sin^4 / D. With sin delta = D gamma and sin sigma = D omega the D's cancel; this form is for
   short spans, delta < 1/2. */
typedef struct reduced {
  double c2, c4, c2s2, s4;
} reduced;

static reduced reduce(const skf_span *a, double D, double gamma, double omega) {
  double g2 = gamma * gamma, C = a->cos_delta, v = g2 / (1 + C); /* (1 - cos delta) / D^2 */
  double c = a->cos_sigma < 0 ? 0.5 * omega * omega / (1 - a->cos_sigma) : a->c / (D * D);
  reduced r;
  r.c2 = 0.5 * g2 * gamma * skf_span_gap3(a) + c * gamma;
  r.c4 = g2 * g2 * gamma * skf_span_gap5(a) / 8 + c * gamma * (v + c * C);
  r.c2s2 = (g2 * gamma * skf_span_double_gap3(a) + 4 * gamma * C * omega * omega) / 16;
  double D2 = D * D;
  r.s4 = D2 * D2 * g2 * g2 * gamma * skf_span_gap5(a) / 8 + a->s * gamma * (D2 * v + a->s * C);
  return r;
}

static const double short_span = 0.5;

/* F = angle of view / h; D is h, which cancels beyond the ends. */
static void segment(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  skf_segment_frame f;
  skf_segment_place(e, x, &f);
  double w0 = f.r0 * f.r0, w1 = f.r1 * f.r1, N = f.r0 * f.r1, tt = f.t0 * f.t1, h = f.h;
  if (N == 0 || (h == 0 && tt <= 0)) return infinite(v);
  skf_span a = skf_span_new(h * f.L, f.h2 + tt, N, (f.h2 - tt) / N, h * f.sum / N);
  skf_segment_terms t = {.F = h > 0 ? a.delta / h : f.L / tt, .ends = f.dw / (N * N)};
  if (a.delta < short_span && tt > f.h2) {
    reduced r = reduce(&a, h, f.L / N, f.sum / N);
    t.g = -2 * r.c2;
    t.k_h2 = 8 * r.c4 * f.h2;
  } else {
    t.g = -2 * skf_span_c2(&a) / (h * f.h2);
    t.k_h2 = 8 * skf_span_c4(&a) / (h * f.h2);
  }
  if (order > 1) {
    t.g_ends = -2 * t.ends * (1 / w0 + 1 / w1);
    t.g0 = -2 / (w0 * w0);
    t.g1 = -2 / (w1 * w1);
  }
  skf_segment_result(&f, &t, order, v);
}

/* Over the span: int c^2/r^4, s^2/r^4, c^4/r^6, c^2 s^2/r^6, s^4/r^6 */
typedef struct even {
  double I, cc, ss, c4, c2s2, s4;
} even;

static even long_span(const skf_span *a, double D, const skf_arc_frame *f) {
  double al = f->alpha, be = f->beta;
  return (even){a->delta / D,
                skf_span_c2(a) / (D * al),
                skf_span_s2(a) / (D * be),
                skf_span_c4(a) / (D * al * al),
                skf_span_c2s2(a) / (D * al * be),
                skf_span_s4(a) / (D * be * be)};
}

static even near_span(const skf_span *a, double D, const skf_arc_frame *f) {
  double N = f->r0 * f->r1, gamma = f->sin_half / N, be = f->beta;
  reduced r = reduce(a, D, gamma, f->sin_mid / N);
  double ss = (0.5 * D * D * gamma * gamma * gamma * skf_span_gap3(a) + a->s * gamma) / be;
  return (even){D > 0 ? a->delta / D : gamma, r.c2 * be, ss, r.c4 * be * be, r.c2s2, r.s4 / (be * be)};
}

/* tan u = sqrt(beta / alpha) tan chi, as for cauchy with W = r^2; D^2 = alpha beta. */
static bool arc_even(const skf_arc_frame *f, even *out) {
  double D = f->da * f->db;
  if (f->full) {
    skf_span turn = skf_span_half_turn();
    return *out = long_span(&turn, D, f), D > 0;
  }
  double N = f->r0 * f->r1, u = f->alpha * f->c0 * f->c1, v = f->beta * f->s0 * f->s1;
  if (N == 0 || (D == 0 && u + v <= 0)) return false;
  skf_span a = skf_span_new(D * f->sin_half, u + v, N, (u - v) / N, D * f->sin_mid / N);
  *out = (a.delta < short_span ? near_span : long_span)(&a, D, f);
  return true;
}

static void arc(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  skf_arc_frame f;
  even s;
  skf_arc_place(e, x, &f);
  if (!arc_even(&f, &s)) return infinite(v);
  double G = -4 * f.rho, K = 16 * f.rho;
  skf_arc_moments m = {.F = 2 * f.rho * s.I,
                       .g_cc = G * s.cc,
                       .g_ss = G * s.ss,
                       .k_c4 = K * s.c4,
                       .k_c2s2 = K * s.c2s2,
                       .k_s4 = K * s.s4};
  if (!f.full) {
    m.ends = f.rho * f.turn / (f.r02 * f.r12);
    if (order > 1) { /* int sin u cos^3 u is a difference of fourth powers */
      double odd = 0.25 * K * f.sin_half * f.sin_mid / (f.r02 * f.r12);
      m.k_c3s = odd * (f.c0 * f.c0 / f.r02 + f.c1 * f.c1 / f.r12);
      m.k_cs3 = odd * (f.s0 * f.s0 / f.r02 + f.s1 * f.s1 / f.r12);
      m.g_ends = -2 * m.ends * (1 / f.r02 + 1 / f.r12);
    }
  }
  skf_arc_terms t = skf_arc_gather(&f, &m, order);
  skf_arc_result(&f, &t, order, v);
}

/* Relative to 0 at unit height. */
static void plane(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  double z = skf_plane_height(e, x);
  if (z == 0) return infinite(v);
  skf_plane_result(e, -2 * SKF_PI * log(fabs(z)), -2 * SKF_PI / z, 2 * SKF_PI / (z * z), order, v);
}

const skf_kernel_ops skf_kernel_inverse_squared = {
    .info = {"inverse-squared", "1 / r^2", "harder than gravity near, softer far", NULL, NULL, NULL, false, true},
    .eval = eval,
    .closed[SKF_POINT] = point,
    .closed[SKF_SEGMENT] = segment,
    .closed[SKF_ARC] = arc,
    .closed[SKF_TRIANGLE] = skf_triangle_inverse_squared,
    .closed[SKF_PLANE] = plane,
    .singular[SKF_POINT] = "the point itself: F = +infinity, gradient 0",
    .singular[SKF_SEGMENT] = "the segment with its ends: F = +infinity, gradient 0",
    .singular[SKF_ARC] = "the arc with its ends: F = +infinity, gradient 0",
    .singular[SKF_TRIANGLE] = "the triangle with its edges: F = +infinity, gradient 0",
    .singular[SKF_PLANE] = "the plane: F = +infinity, gradient 0",
};
