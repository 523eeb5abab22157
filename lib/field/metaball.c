/* SPDX-License-Identifier: MIT */
#include "field/simple.h"
#include "field/support.h"
#include "field/triangle.h"
#include "num/gauss.h"
#include "num/span.h"

/* From q = R^2 - w, which carries the relative accuracy near the rim. */
static void eval_power(double R, double w, double q, double d[4]) {
  double R2 = R * R;
  d[0] = d[1] = d[2] = d[3] = 0;
  if (!(q > 0)) return;
  if (9 * w <= R2) {
    d[0] = 1 - 3 * w / R2;
    d[1] = -3 / R2;
    return;
  }
  double r = sqrt(w), m = q / (R * (R + r)); /* m = 1 - r/R */
  d[0] = 1.5 * m * m;
  d[1] = -1.5 * m / (R * r);
  d[2] = 0.75 / (R * r * w);
  d[3] = -1.125 / (R * r * w * w);
}

static void eval(double R, double w, double d[4]) { eval_power(R, w, R * R - w, d); }

static void point(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  double w, d[4], R = e->kernel.param;
  skf_dd3 r = skf_point_delta(e, x, &w);
  eval_power(R, w, dd3_power(R, r), d);
  skf_point_result(d, r, order, v);
}

/* What the two ends of a segment or an arc contribute. */
typedef struct ends {
  double h, g, g0, g1; /* h0 - h1, g0 - g1, g0, g1; g = h'/r */
} ends;

/* Differences from dw = r1^2 - r0^2. Both in the shell: each factor is exact. Across R/3 or R the law changes. */
static ends at_ends(double R, double r0, double r1, double q0, double q1, double dw) {
  double a[4], b[4], R2 = R * R;
  eval_power(R, r0 * r0, q0, a);
  eval_power(R, r1 * r1, q1, b);
  ends s = {a[0] - b[0], 2 * (a[1] - b[1]), 2 * a[1], 2 * b[1]};
  if (q0 <= 0 || q1 <= 0) return s;
  double u = fmax(0, 3 * r0 / R - 1), v = fmax(0, 3 * r1 / R - 1);
  if (u == 0 || v == 0) { /* an end in the core: the other is no farther out of it than from this one */
    double most = 3 * fabs(dw) / (R * (r0 + r1));
    u = fmin(u, most), v = fmin(v, most);
    s.h = 3 * dw / R2 + 0.5 * (u - v) * (u + v);
    s.g = 3 / R * (u / r0 - v / r1);
    return s;
  }
  double n = q0 / (R * (R + r0)) + q1 / (R * (R + r1));
  s.h = 1.5 * n * dw / (R * (r0 + r1));
  s.g = -3 * dw / (R * r0 * r1 * (r0 + r1));
  return s;
}

/* A part of a segment between abscissas a and b. */
typedef struct stretch {
  double a, ra, b, rb, length, gap_lo, gap_hi; /* gaps to the ends of the chord of radius R */
} stretch;

/* R/3 <= r <= R: closed while r is not close to R everywhere, there Gauss on n = (T - t)(T + t) / (R (R + r)). */
static void add_shell(double R, double h2, const stretch *s, skf_segment_terms *t) {
  if (!(s->length > 0)) return;
  double sum = s->ra + s->rb, mid = s->a + s->b, nearest = s->a < 0 && s->b > 0 ? sqrt(h2) : fmin(s->ra, s->rb);
  double E = skf_segment_excess(s->a, s->ra, s->b, s->rb, h2);
  t->k_h2 += h2 * 3 / R * 2 * s->length * sum / (E * (E + 2 * s->length) * s->ra * s->rb);
  if (1 - nearest / R >= 0.3) { /* here the closed form loses at most 130 roundings */
    double log = log1p(2 * s->length / E), r1 = 0.25 * s->length * (sum + mid * mid / sum) + 0.5 * h2 * log;
    double r2 = s->length * (h2 + (s->a * s->a + s->a * s->b + s->b * s->b) / 3);
    t->F += 1.5 * (s->length - 2 * r1 / R + r2 / (R * R));
    t->g -= 3 / R * (log - s->length / R);
    return;
  }
  int n = s->a < 0 && s->b > 0 ? 24 : 16;
  const skf_gauss_node *node = skf_gauss_rule(n);
  double half = 0.5 * s->length;
  for (int i = 0; i < n; i++) {
    double hi = s->gap_hi + half * (1 - node[i].x), lo = s->gap_lo + half * (1 + node[i].x), u = 0.5 * (lo - hi);
    double r = sqrt(h2 + u * u), m = hi * lo / (R * (R + r)), w = half * node[i].w;
    t->F += w * 1.5 * m * m;
    t->g -= w * 3 * m / (R * r);
  }
}

static void segment(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  skf_segment_frame f;
  skf_segment_clip c;
  double R = e->kernel.param;
  skf_segment_place(e, x, &f);
  if (!skf_segment_support(&f, R, &c)) return;
  ends s = at_ends(R, f.r0, f.r1, c.q0, c.q1, f.dw);
  skf_segment_terms t = {.ends = s.h, .g_ends = s.g, .g0 = s.g0, .g1 = s.g1};
  double T3 = f.h < R / 3 ? sqrt((R / 3 - f.h) * (R / 3 + f.h)) : -1;
  stretch whole = {c.lo, c.r_lo, c.hi, c.r_hi, c.length, c.gap_lo, c.gap_hi};
  if (T3 < 0 || c.lo >= T3 || c.hi <= -T3)
    add_shell(R, f.h2, &whole, &t);
  else {
    double left = fmax(0, -T3 - c.lo), right = fmax(0, c.hi - T3), core = fmax(0, c.length - left - right);
    double a = fmax(c.lo, -T3), b = fmin(c.hi, T3);
    t.F += core * (1 - 3 * (f.h2 + (a * a + a * b + b * b) / 3) / (R * R));
    t.g -= 6 * core / (R * R);
    add_shell(R, f.h2, &(stretch){c.lo, c.r_lo, -T3, R / 3, left, c.gap_lo, c.T + T3}, &t);
    add_shell(R, f.h2, &(stretch){T3, R / 3, c.hi, c.r_hi, right, c.T + T3, c.gap_hi}, &t);
  }
  skf_segment_result(&f, &t, order, v);
}

/* chi where r = R/3; below 0: nowhere, above pi/2: everywhere */
static double core_end(double R, const skf_arc_frame *f) {
  double s = R / 3;
  if (f->da >= s) return -1;
  if (f->db <= s) return 4;
  return atan2(sqrt((s - f->da) * (s + f->da)), sqrt((f->db - s) * (f->db + s)));
}

/* r <= R/3 over chi from a, for `length`: elementary. */
static void add_core(double R, const skf_arc_frame *f, double a, double length, double weight, skf_arc_moments *m) {
  double s = sin(length), sm = sin(a + 0.5 * length), cm = cos(a + 0.5 * length), base = 0.5 * skf_sine_gap3(length);
  double cc = base + s * cm * cm, ss = base + s * sm * sm, w = 2 * f->rho * weight, g = -6 * w / (R * R);
  m->F += w * (length - 3 * (f->alpha * cc + f->beta * ss) / (R * R));
  m->g_cc += g * cc;
  m->g_ss += g * ss;
}

/* Nodes for r and 1/r over chi from a: by the ellipse with foci at the ends through r = 0 at
   chi = i asinh sqrt(alpha / spread); its smallest size here is 1.98. */
static int shell_nodes(const skf_arc_frame *f, double a, double length) {
  double y = f->spread > 0 ? asinh(f->da / sqrt(f->spread)) : 20, half = 0.5 * length, u = a / half + 1;
  double s = 0.5 * (hypot(u - 1, y / half) + hypot(u + 1, y / half)), size = s + sqrt((s - 1) * (s + 1));
  return size > 4.5 ? 14 : size > 3 ? 18 : size > 2.3 ? 24 : 32;
}

static void add_arc_shell(double R, const skf_arc_frame *f, const skf_arc_clip *c, const skf_arc_piece *p, double gap,
                          double a, double length, skf_arc_moments *m) {
  int n = shell_nodes(f, a, length);
  const skf_gauss_node *node = skf_gauss_rule(n);
  for (int j = 0; j < n; j++) {
    double chi = a + 0.5 * length * (1 + node[j].x), s = sin(chi), co = cos(chi), ss = s * s, cc = co * co;
    double r2 = f->alpha * cc + f->beta * ss, r = sqrt(r2), w = p->weight * f->rho * length * node[j].w;
    double u = skf_arc_power(f, c, chi, co, gap, 0.5 * length * (1 - node[j].x)) / (R * (R + r));
    double g = -3 * w * u / (R * r), k = 3 * w / (R * r * r2), odd = p->sign * s * co;
    m->F += w * 1.5 * u * u;
    m->g_cc += g * cc, m->g_ss += g * ss;
    m->k_c4 += k * cc * cc, m->k_c2s2 += k * cc * ss, m->k_s4 += k * ss * ss;
    m->k_c3s += k * cc * odd, m->k_cs3 += k * ss * odd;
  }
}

static void arc_ends(double R, const skf_arc_frame *f, const skf_arc_clip *c, skf_arc_moments *m) {
  if (f->k > 0) {
    ends s = at_ends(R, f->r0, f->r1, c->q0, c->q1, f->turn * f->k);
    m->ends = f->rho * s.h / f->k, m->g_ends = f->rho * s.g / f->k;
    return;
  }
  double d[4]; /* on the axis: by derivatives */
  eval_power(R, f->r02, c->q0, d);
  m->ends = -f->rho * d[1] * f->turn, m->g_ends = -2 * f->rho * d[2] * f->turn;
}

/* The shell needs elliptic integrals of both kinds that cancel near R; Gauss is more accurate. */
static void arc(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  skf_arc_frame f;
  skf_arc_clip c;
  double R = e->kernel.param, gap;
  skf_arc_place(e, x, &f);
  if (!skf_arc_support(&f, R, &c)) return;
  skf_arc_moments m = {.F = 0};
  skf_arc_piece piece[4];
  int n = skf_arc_pieces(&f, true, piece);
  double end = core_end(R, &f);
  for (int i = 0; i < n; i++) {
    skf_arc_piece *p = piece + i;
    if (!skf_arc_clip_piece(&c, p, &gap)) continue;
    double core = end < p->xa ? 0 : fmin(p->length, end - p->xa), shell = p->length - core;
    if (core > 0) add_core(R, &f, p->xa, core, p->weight, &m);
    if (shell > 0) add_arc_shell(R, &f, &c, p, gap, p->xa + core, shell, &m);
  }
  if (!f.full) arc_ends(R, &f, &c, &m);
  skf_arc_terms t = skf_arc_gather(&f, &m, order);
  skf_arc_result(&f, &t, order, v);
}

static void plane(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  double R = e->kernel.param, z = skf_plane_height(e, x), a = fabs(z), m = (R - a) / R, u = a * a / (R * R), d[4];
  if (a >= R) return;
  eval_power(R, z * z, (R - a) * (R + a), d);
  double F = 3 * a <= R ? 13. / 54 - u * (1 - 1.5 * u) : m * m * m * (1 - 0.75 * m);
  skf_plane_result(e, SKF_PI * R * R * F, -2 * SKF_PI * z * d[0], -2 * SKF_PI * (d[0] + 2 * z * z * d[1]), order, v);
}

const skf_kernel_ops skf_kernel_metaball = {
    .info = {"metaball", "1 - 3 r^2/R^2 (r <= R/3), 3/2 (1 - r/R)^2 (r <= R), 0",
             "finite support, once differentiable at R/3 and R", "R", "L", "radius of its support", true, false},
    .eval = eval,
    .power = eval_power,
    .closed[SKF_POINT] = point,
    .closed[SKF_SEGMENT] = segment,
    .closed[SKF_ARC] = arc,
    .closed[SKF_TRIANGLE] = skf_triangle_metaball,
    .closed[SKF_PLANE] = plane,
};
