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

/* Cosine and sine of an angle. */
typedef struct turn {
  double c, s;
} turn;

/* What all nodes of an arc share. */
typedef struct law_at {
  skf_polynomial p;
  double per_R2;
  int order;
  turn rim; /* by chi where the ball cuts the circle */
} law_at;

/* Adds a node of weight w at chi; odd is the sign of the quadrant times sin chi cos chi. */
static void add_node(const law_at *l, double q, double w, double cc, double ss, double odd, skf_arc_moments *m) {
  double u = q * l->per_R2;
  if (!(u > 0)) return;
  double g = -2 * w * l->per_R2 * u * (2 * l->p.c2 + 3 * l->p.c3 * u);
  m->F += w * u * u * (l->p.c2 + l->p.c3 * u);
  m->g_cc += g * cc, m->g_ss += g * ss;
  if (l->order < 2) return;
  double k = 4 * w * l->per_R2 * l->per_R2 * (2 * l->p.c2 + 6 * l->p.c3 * u);
  m->k_c4 += k * cc * cc, m->k_c2s2 += k * cc * ss, m->k_s4 += k * ss * ss;
  m->k_c3s += k * cc * odd, m->k_cs3 += k * ss * odd;
}

/* |x| <= pi / 4: (sin(x) / x - 1) / x^2 to 8e-17 and (cos(x) - 1 + x^2 / 2) / x^4 to 1e-17 in x^2 */
static turn small_turn(double x) {
  static const double s[] = {-0.16666666666666664498,  0.0083333333333308266943,  -0.00019841269836575245027,
                             2.7557316007933251255e-6, -2.5051112223400198837e-8, 1.5916722686286470476e-10};
  static const double c[] = {0.04166666666666666531,    -0.0013888888888887321048, 2.4801587298651001295e-5,
                             -2.7557317212537512799e-7, 2.0876133993327845762e-9,  -1.1381752459316456189e-11};
  double y = x * x, y2 = y * y, y4 = y2 * y2;
  double a = s[0] + s[1] * y + y2 * (s[2] + s[3] * y) + y4 * (s[4] + s[5] * y);
  double b = c[0] + c[1] * y + y2 * (c[2] + c[3] * y) + y4 * (c[4] + c[5] * y);
  return (turn){1 - 0.5 * y + y2 * b, x + x * y * a};
}

static turn turn_by(double x) { return x <= SKF_PI / 4 ? small_turn(x) : (turn){cos(x), sin(x)}; }
static turn turn_on(turn a, turn b) { return (turn){a.c * b.c - a.s * b.s, a.s * b.c + a.c * b.s}; }
static turn turn_back(turn a, turn b) { return (turn){a.c * b.c + a.s * b.s, a.s * b.c - a.c * b.s}; }

/* h is a polynomial of degree 2 or 3 in cos 2 chi: Gauss to rounding, fewer nodes on shorter pieces. The nodes lie
   symmetrically about the piece's middle: one sine and cosine serve two. */
static void add_piece(const law_at *l, const skf_arc_frame *f, const skf_arc_clip *c, skf_arc_piece t,
                      skf_arc_moments *m) {
  double gap;
  if (!skf_arc_clip_piece(c, &t, &gap)) return;
  int n = t.length > 0.8 ? 14 : t.length > 0.4 ? 10 : 8;
  const skf_gauss_node *node = skf_gauss_rule(n) + n / 2;
  double half = 0.5 * t.length, weight = t.weight * f->rho * t.length;
  turn mid = turn_on((turn){t.ca, t.sa}, small_turn(half)), left = {0, 0}, right = left;
  if (c->cut) left = turn_on(l->rim, mid), right = turn_by(gap + half); /* R^2 - r^2 = spread sin sin */
  for (int j = 0; j < n / 2; j++) {
    turn by = small_turn(half * node[j].x);
    for (int side = 0; side < 2; side++, by.s = -by.s) {
      turn at = turn_on(mid, by);
      double q = c->cut ? f->spread * turn_on(left, by).s * turn_back(right, by).s : c->qb + f->spread * at.c * at.c;
      add_node(l, q, weight * node[j].w, at.c * at.c, at.s * at.s, t.sign * at.s * at.c, m);
    }
  }
}

void skf_polynomial_arc(skf_polynomial p, const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  skf_arc_frame f;
  skf_arc_clip c;
  double R = e->kernel.param;
  skf_arc_place(e, x, &f);
  if (!skf_arc_support(&f, R, &c)) return;
  skf_arc_moments m = {.F = 0};
  const law_at l = {p, 1 / (R * R), order, c.cut ? turn_by(c.chi) : (turn){0, 1}};
  if (f.full && !c.cut) { /* the trapezoidal rule with four points is exact */
    double w = 0.5 * SKF_PI * f.rho;
    add_node(&l, c.qa, w, 1, 0, 0, &m);
    add_node(&l, 0.5 * (c.qa + c.qb), 2 * w, 0.5, 0.5, 0, &m);
    add_node(&l, c.qb, w, 0, 1, 0, &m);
  } else {
    skf_arc_piece piece[4];
    int n = skf_arc_pieces(&f, true, piece);
    for (int i = 0; i < n; i++) add_piece(&l, &f, &c, piece[i], &m);
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
