/* SPDX-License-Identifier: MIT */
#include "field/polynomial.h"
#include "field/simple.h"
#include "field/support.h"
#include "num/gauss.h"

void skf_polynomial_eval(skf_polynomial p, double R, double q, double d[4]) {
  double R2 = R * R, m = q / R2;
  d[0] = d[1] = d[2] = d[3] = 0;
  if (!(m > 0)) return;
  d[0] = m * m * (p.c2 + p.c3 * m);
  d[1] = -m * (2 * p.c2 + 3 * p.c3 * m) / R2;
  d[2] = (2 * p.c2 + 6 * p.c3 * m) / (R2 * R2);
  d[3] = -6 * p.c3 / (R2 * R2 * R2);
}

void skf_polynomial_point(skf_polynomial p, const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  double w, d[4], R = e->kernel.param;
  skf_dd3 r = skf_point_delta(e, x, &w);
  skf_polynomial_eval(p, R, dd3_power(R, r), d);
  skf_point_result(d, r, order, v);
}

/* Differences and sum at the two ends per unit of dw = r1^2 - r0^2 (scaled by the caller's divisor). */
typedef struct ends {
  double h, g, g0, g1; /* h0 - h1, g0 - g1, g0, g1; g = h'/r */
} ends;

/* dw: r1^2 - r0^2 divided by `per`; the differences are divided by it too. */
static ends at_ends(skf_polynomial p, double R, double q0, double q1, double dw, double per) {
  double R2 = R * R, m0 = fmax(0, q0 / R2), m1 = fmax(0, q1 / R2);
  double dm = q0 > 0 && q1 > 0 ? dw / R2 : q0 > 0 || q1 > 0 ? (m0 - m1) / per : 0;
  return (ends){dm * (p.c2 * (m0 + m1) + p.c3 * (m0 * m0 + m0 * m1 + m1 * m1)),
                -2 * dm * (2 * p.c2 + 3 * p.c3 * (m0 + m1)) / R2, -2 * m0 * (2 * p.c2 + 3 * p.c3 * m0) / R2,
                -2 * m1 * (2 * p.c2 + 3 * p.c3 * m1) / R2};
}

void skf_polynomial_segment(skf_polynomial p, const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  skf_segment_frame f;
  skf_segment_clip c;
  double R = e->kernel.param, d[4];
  skf_segment_place(e, x, &f);
  if (!skf_segment_support(&f, R, &c)) return;
  int n = p.c3 == 0 ? 3 : 4; /* degrees 4 and 6 in t */
  const skf_gauss_node *node = skf_gauss_rule(n);
  double h = 0, g = 0, k = 0, half = 0.5 * c.length;
  for (int j = 0; j < n; j++) {
    double q = (c.gap_hi + half * (1 - node[j].x)) * (c.gap_lo + half * (1 + node[j].x)), w = half * node[j].w;
    skf_polynomial_eval(p, R, q, d);
    h += w * d[0], g += w * 2 * d[1], k += w * 4 * d[2];
  }
  ends s = at_ends(p, R, c.q0, c.q1, f.dw, 1);
  skf_segment_terms t = {h, g, k * f.h2, s.h, s.g, s.g0, s.g1};
  skf_segment_result(&f, &t, order, v);
}

/* Adds a node of weight w at chi; odd is the sign of the quadrant times sin chi cos chi. */
static void add_node(skf_polynomial p, double R, double q, double w, double cc, double ss, double odd,
                     skf_arc_moments *m) {
  double d[4];
  skf_polynomial_eval(p, R, q, d);
  double g = 2 * w * d[1], k = 4 * w * d[2];
  m->F += w * d[0];
  m->g_cc += g * cc, m->g_ss += g * ss;
  m->k_c4 += k * cc * cc, m->k_c2s2 += k * cc * ss, m->k_s4 += k * ss * ss;
  m->k_c3s += k * cc * odd, m->k_cs3 += k * ss * odd;
}

/* h is a polynomial of degree 2 or 3 in cos 2 chi: Gauss to rounding, fewer nodes on shorter pieces. */
static void add_piece(skf_polynomial p, double R, const skf_arc_frame *f, const skf_arc_clip *c, skf_arc_piece t,
                      skf_arc_moments *m) {
  double gap;
  if (!skf_arc_clip_piece(c, &t, &gap)) return;
  int n = t.length > 0.8 ? 14 : t.length > 0.4 ? 10 : 8;
  const skf_gauss_node *node = skf_gauss_rule(n);
  for (int j = 0; j < n; j++) {
    double chi = t.xa + 0.5 * t.length * (1 + node[j].x), s = sin(chi), co = cos(chi);
    double q = skf_arc_power(f, c, chi, co, gap, 0.5 * t.length * (1 - node[j].x));
    add_node(p, R, q, t.weight * f->rho * t.length * node[j].w, co * co, s * s, t.sign * s * co, m);
  }
}

void skf_polynomial_arc(skf_polynomial p, const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  skf_arc_frame f;
  skf_arc_clip c;
  double R = e->kernel.param;
  skf_arc_place(e, x, &f);
  if (!skf_arc_support(&f, R, &c)) return;
  skf_arc_moments m = {.F = 0};
  if (f.full && !c.cut) { /* the trapezoidal rule with four points is exact */
    double w = 0.5 * SKF_PI * f.rho;
    add_node(p, R, c.qa, w, 1, 0, 0, &m);
    add_node(p, R, 0.5 * (c.qa + c.qb), 2 * w, 0.5, 0.5, 0, &m);
    add_node(p, R, c.qb, w, 0, 1, 0, &m);
  } else {
    skf_arc_piece piece[4];
    int n = skf_arc_pieces(&f, true, piece);
    for (int i = 0; i < n; i++) add_piece(p, R, &f, &c, piece[i], &m);
  }
  if (!f.full) {
    ends s = at_ends(p, R, c.q0, c.q1, f.turn, f.k);
    m.ends = f.rho * s.h, m.g_ends = f.rho * s.g;
  }
  skf_arc_terms t = skf_arc_gather(&f, &m, order);
  skf_arc_result(&f, &t, order, v);
}

/* F = pi int_0^q h dq' */
void skf_polynomial_plane(skf_polynomial p, const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  double R = e->kernel.param, z = skf_plane_height(e, x), q = (R - z) * (R + z), m = q / (R * R), d[4];
  if (q <= 0) return;
  skf_polynomial_eval(p, R, q, d);
  skf_plane_result(e, SKF_PI * R * R * m * m * m * (p.c2 / 3 + p.c3 * m / 4), -2 * SKF_PI * z * d[0],
                   -2 * SKF_PI * (d[0] + 2 * z * z * d[1]), order, v);
}
