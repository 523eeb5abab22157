/* SPDX-License-Identifier: MIT */
#include "field/arc_frame.h"
#include "field/segment_frame.h"
#include "field/simple.h"
#include "field/triangle.h"
#include "num/span.h"

static void eval(double s, double w, double d[4]) {
  double s2 = s * s, q = 1 / (1 + s2 * w);
  d[0] = q * q;
  d[1] = -2 * s2 * d[0] * q;
  d[2] = -3 * s2 * d[1] * q;
  d[3] = -4 * s2 * d[2] * q;
}

static void point(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  double w, d[4];
  skf_dd3 r = skf_point_delta(e, x, &w);
  eval(e->kernel.param, w, d);
  skf_point_result(d, r, order, v);
}

/* tan u = s t / P, P^2 = 1 + s^2 h^2, turns the integrals over t into those of even powers of cos u.
   [McCormack and Sherstyuk 1998, eq. 11], in a form that does not cancel. */
static void segment(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  skf_segment_frame f;
  skf_segment_place(e, x, &f);
  double s = e->kernel.param, s2 = s * s, P2 = 1 + s2 * f.h2, P = sqrt(P2);
  double W0 = 1 + s2 * f.r0 * f.r0, W1 = 1 + s2 * f.r1 * f.r1, N = sqrt(W0) * sqrt(W1), tt = s2 * f.t0 * f.t1;
  skf_span a = skf_span_new(P * s * f.L, P2 + tt, N, (P2 - tt) / N, P * s * f.sum / N);
  double WW = W0 * W1, dW = s2 * f.dw;
  skf_segment_terms t = {.F = skf_span_c2(&a) / (s * P * P2),
                         .g = -4 * s * skf_span_c4(&a) / (P * P2 * P2),
                         .ends = dW * (1 / W0 + 1 / W1) / WW};
  if (order > 1) {
    t.k_h2 = 24 * s * (s2 * f.h2) * skf_span_c6(&a) / (P * P2 * P2 * P2);
    t.g_ends = -4 * s2 * dW * (1 / (W0 * W0) + 1 / WW + 1 / (W1 * W1)) / WW;
    t.g0 = -4 * s2 / (W0 * W0 * W0);
    t.g1 = -4 * s2 / (W1 * W1 * W1);
  }
  skf_segment_result(&f, &t, order, v);
}

/* The factors of one arc: W = 1 + s^2 r^2 = Pm cos^2 chi + Pp sin^2 chi. */
typedef struct arc_data {
  double s2, Pm, Pp, D, W0, W1;
  skf_span span;
} arc_data;

static arc_data arc_span(double s, const skf_arc_frame *f) {
  arc_data a = {.s2 = s * s, .W0 = 1, .W1 = 1};
  a.Pm = 1 + a.s2 * f->alpha;
  a.Pp = 1 + a.s2 * f->beta;
  a.D = sqrt(a.Pm) * sqrt(a.Pp);
  if (f->full) return a.span = skf_span_half_turn(), a;
  a.W0 = 1 + a.s2 * f->r02;
  a.W1 = 1 + a.s2 * f->r12;
  double N = sqrt(a.W0) * sqrt(a.W1), u = a.Pm * f->c0 * f->c1, v = a.Pp * f->s0 * f->s1;
  a.span = skf_span_new(a.D * f->sin_half, u + v, N, (u - v) / N, a.D * f->sin_mid / N);
  return a;
}

/* int sin u cos^5 u, sin^3 u cos^3 u, sin^5 u cos u over the span; x, y: cos^2 u at its ends; jump = sin delta
   sin sigma. */
static void odd_moments(double jump, double x0, double x1, double y0, double y1, double out[3]) {
  out[0] = jump * (x0 * x0 + x0 * x1 + x1 * x1) / 6;
  out[2] = jump * (y0 * y0 + y0 * y1 + y1 * y1) / 6;
  out[1] = x0 + x1 < 1 ? jump * 0.25 * (x0 + x1) - out[0] : jump * 0.25 * (y0 + y1) - out[2];
}

static void arc_hessian(const arc_data *a, const skf_arc_frame *f, skf_arc_moments *m) {
  double K = 48 * f->rho * a->s2 * a->s2 / a->D, Pm = a->Pm, Pp = a->Pp, c4s2, c2s4;
  skf_span_mixed6(&a->span, &c4s2, &c2s4);
  m->k_c4 = K * (skf_span_c6(&a->span) / Pm + c4s2 / Pp) / (Pm * Pm);
  m->k_c2s2 = K * (c4s2 / Pm + c2s4 / Pp) / (Pm * Pp);
  m->k_s4 = K * (c2s4 / Pm + skf_span_s6(&a->span) / Pp) / (Pp * Pp);
  if (f->full) return;
  double W0 = a->W0, W1 = a->W1, odd[3];
  double x0 = Pm * f->c0 * f->c0 / W0, x1 = Pm * f->c1 * f->c1 / W1;
  double y0 = Pp * f->s0 * f->s0 / W0, y1 = Pp * f->s1 * f->s1 / W1;
  odd_moments(f->sin_half * f->sin_mid / (W0 * W1), x0, x1, y0, y1, odd);
  m->k_c3s = K * a->D * (odd[0] / Pm + odd[1] / Pp) / Pm;
  m->k_cs3 = K * a->D * (odd[1] / Pm + odd[2] / Pp) / Pp;
  m->g_ends = -4 * a->s2 * a->s2 * f->rho * f->turn * (1 / (W0 * W0) + 1 / (W0 * W1) + 1 / (W1 * W1)) / (W0 * W1);
}

/* tan u = sqrt(Pp / Pm) tan chi does the same here, for any sweep, on the axis and on the circle. The literature
   integrates over the angle; this is by arc length. */
static void arc(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  skf_arc_frame f;
  skf_arc_place(e, x, &f);
  arc_data a = arc_span(e->kernel.param, &f);
  double G = -8 * a.s2 * f.rho / a.D, mixed = skf_span_c2s2(&a.span) / (a.Pm * a.Pp);
  skf_arc_moments m = {.F = 2 * f.rho / a.D * (skf_span_c2(&a.span) / a.Pm + skf_span_s2(&a.span) / a.Pp),
                       .g_cc = G * (skf_span_c4(&a.span) / (a.Pm * a.Pm) + mixed),
                       .g_ss = G * (mixed + skf_span_s4(&a.span) / (a.Pp * a.Pp))};
  if (!f.full) m.ends = f.rho * a.s2 * f.turn * (1 / a.W0 + 1 / a.W1) / (a.W0 * a.W1);
  if (order > 1) arc_hessian(&a, &f, &m);
  skf_arc_terms t = skf_arc_gather(&f, &m, order);
  skf_arc_result(&f, &t, order, v);
}

static void plane(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  double s = e->kernel.param, z = skf_plane_height(e, x), ss = s * s, w = ss * z * z, q = 1 + w;
  skf_plane_result(e, SKF_PI / ss / q, -2 * SKF_PI * (z / q) / q, -2 * SKF_PI * (1 - 4 * (w / q)) / q / q, order, v);
}

const skf_kernel_ops skf_kernel_cauchy = {
    .info = {"cauchy", "1 / (1 + s^2 r^2)^2", "smooth, falls like r^-4", "s", "1/L", "1 / s is its width", false,
             false},
    .eval = eval,
    .closed[SKF_POINT] = point,
    .closed[SKF_SEGMENT] = segment,
    .closed[SKF_ARC] = arc,
    .closed[SKF_TRIANGLE] = skf_triangle_cauchy,
    .closed[SKF_PLANE] = plane,
};
