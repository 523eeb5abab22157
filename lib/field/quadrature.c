/* SPDX-License-Identifier: MIT */
#include "field/quadrature.h"
#include "field/arc_frame.h"
#include "field/segment_frame.h"
#include "field/simple.h"
#include "num/gauss.h"

enum { SIZE = SKF_QUADRATURE_SIZE, NODES = 16, DEPTH = 48, PANELS = 4000 };

/* Sizes of value, gradient and Hessian: each is judged by itself. */
typedef struct size3 {
  double s[3];
} size3;

static size3 sizes(const double x[SIZE]) {
  size3 a = {{fabs(x[0]), 0, 0}};
  for (int i = 1; i < SIZE; i++) a.s[i < 4 ? 1 : 2] += fabs(x[i]);
  return a;
}

static size3 panel(const skf_integrand *f, double a, double b, double out[SIZE]) {
  const skf_gauss_node *node = skf_gauss_rule(NODES);
  size3 size = {{0, 0, 0}};
  for (int k = 0; k < SIZE; k++) out[k] = 0;
  for (int j = 0; j < NODES; j++) {
    double y[SIZE], w = 0.5 * (b - a) * node[j].w;
    f->at(f->context, a + 0.5 * (b - a) * (1 + node[j].x), y);
    for (int k = 0; k < SIZE; k++) y[k] *= w, out[k] += y[k];
    size3 s = sizes(y);
    for (int i = 0; i < 3; i++) size.s[i] += s.s[i];
  }
  return size;
}

/* Halves the panel until both halves together agree with it, or the panels are used up. */
static void refine(const skf_integrand *f, double a, double b, const double whole[SIZE], const size3 *scale, int depth,
                   int *panels, double out[SIZE]) {
  double m = 0.5 * (a + b), left[SIZE], right[SIZE], diff[SIZE];
  size3 l = panel(f, a, m, left), r = panel(f, m, b, right);
  for (int k = 0; k < SIZE; k++) diff[k] = whole[k] - (left[k] + right[k]);
  size3 d = sizes(diff);
  bool done = depth == 0 || !(a < m && m < b) || (*panels -= 2) < 0;
  if (!done) {
    done = true;
    for (int i = 0; i < 3; i++) /* the halves are 2^32 times better than what the difference shows */
      if (d.s[i] > fmax(1e-12 * scale->s[i], 1e-14 * (l.s[i] + r.s[i]))) done = false;
  }
  if (done)
    for (int k = 0; k < SIZE; k++) out[k] += left[k] + right[k];
  else {
    refine(f, a, m, left, scale, depth - 1, panels, out);
    refine(f, m, b, right, scale, depth - 1, panels, out);
  }
}

void skf_integrate(const skf_integrand *f, int n, const double *breaks, double out[SIZE]) {
  double y[SIZE];
  size3 scale = {{0, 0, 0}};
  int panels = PANELS;
  for (int pass = 0; pass < 2; pass++)
    for (int i = 0; i + 1 < n; i++) {
      int parts = (int)fmin(64, ceil(breaks[i + 1] - breaks[i]));
      for (int j = 0; j < parts; j++) {
        double step = (breaks[i + 1] - breaks[i]) / parts, a = breaks[i] + j * step;
        double b = j + 1 == parts ? breaks[i + 1] : breaks[i] + (j + 1) * step;
        size3 s = panel(f, a, b, y);
        for (int k = 0; k < 3 && pass == 0; k++) scale.s[k] += s.s[k];
        if (pass == 1) refine(f, a, b, y, &scale, DEPTH, &panels, out);
      }
    }
}

int skf_breaks(double lo, double hi, int n, double *breaks) {
  int m = 0;
  for (int i = 0; i < n; i++)
    if (breaks[i] > lo && breaks[i] < hi) breaks[m++] = breaks[i];
  breaks[m++] = lo, breaks[m++] = hi;
  for (int i = 1; i < m; i++)
    for (int j = i; j > 0 && breaks[j] < breaks[j - 1]; j--) {
      double t = breaks[j];
      breaks[j] = breaks[j - 1], breaks[j - 1] = t;
    }
  int kept = 1;
  for (int i = 1; i < m; i++)
    if (breaks[i] > breaks[kept - 1]) breaks[kept++] = breaks[i];
  return kept;
}

void skf_integrand_set(const skf_prepared *e, skf_vec3 r, double r2, double scale, double out[SIZE]) {
  double d[4];
  skf_kernel_eval(e->kernel, r2, d);
  double g = 2 * scale * d[1], k = 4 * scale * d[2];
  out[0] = scale * d[0];
  out[1] = g * r.x, out[2] = g * r.y, out[3] = g * r.z;
  out[4] = g + k * r.x * r.x, out[5] = k * r.x * r.y, out[6] = k * r.x * r.z;
  out[7] = g + k * r.y * r.y, out[8] = k * r.y * r.z, out[9] = g + k * r.z * r.z;
}

/* Along a line, t = delta sinh u */
typedef struct line {
  const skf_prepared *e;
  skf_vec3 w, a;
  double h2, delta;
  const skf_weight_piece *piece; /* of the weight, between these abscissae; NULL: none */
  double from, to;
} line;

static void line_at(const void *context, double u, double out[SIZE]) {
  const line *c = context;
  double t = c->delta * sinh(u), dt = c->delta * cosh(u), length = c->to - c->from;
  if (c->piece) dt *= skf_weight_at(c->e->weight, c->piece, (t - c->from) / length, (c->to - t) / length);
  skf_integrand_set(c->e, v3_mad(c->w, -t, c->a), c->h2 + t * t, dt, out);
}

static void add_line(const skf_prepared *e, skf_vec3 w, skf_vec3 a, double h2, double lo, double hi,
                     const skf_weight_piece *piece, double out[SIZE]) {
  double nearest = lo > 0 ? lo : hi < 0 ? -hi : 0, far = fmax(fabs(lo), fabs(hi));
  line c = {e, w, a, h2, fmax(fmax(sqrt(h2), 1e-3 * nearest), 1e-15 * far), piece, lo, hi};
  c.delta = fmax(c.delta, fmin(skf_kernel_grain(e->kernel), far));
  double breaks[2 * SKF_KERNEL_BREAKS + 3] = {0}, radii[SKF_KERNEL_BREAKS];
  int n = 1;
  for (int i = skf_kernel_breaks(e->kernel, radii) - 1; i >= 0; i--) {
    double s = radii[i], t = (s - sqrt(h2)) * (s + sqrt(h2));
    if (t > 0) breaks[n++] = asinh(sqrt(t) / c.delta), breaks[n] = -breaks[n - 1], n++;
  }
  n = skf_breaks(asinh(lo / c.delta), asinh(hi / c.delta), n, breaks);
  skf_integrate(&(skf_integrand){line_at, &c}, n, breaks, out);
}

void skf_quadrature_line(const skf_prepared *e, skf_vec3 w, skf_vec3 a, double h2, double lo, double hi,
                         double out[SIZE]) {
  add_line(e, w, a, h2, lo, hi, NULL, out);
}

/* Along a circle, chi = delta sinh u from the nearest point */
typedef struct circle {
  const skf_prepared *e;
  const skf_arc_frame *f;
  double delta, sign;
  const skf_weight_piece *piece; /* of the weight; NULL: none */
  double base, turn, from, to;   /* its azimuth is base + turn chi, between from and to */
} circle;

static void circle_at(const void *context, double u, double out[SIZE]) {
  const circle *c = context;
  const skf_arc_frame *f = c->f;
  double chi = c->delta * sinh(u), cs = cos(chi), sn = c->sign * sin(chi);
  double k = f->inner * cs * cs + f->outer * sn * sn, p = -2 * f->rho * sn * cs;
  skf_vec3 r = v3_mad(v3_mad(v3_scale(k * f->ux - p * f->uy, f->e), k * f->uy + p * f->ux, f->f), f->z, f->n);
  double dq = 2 * f->rho * c->delta * cosh(u), a = c->base + c->turn * chi, length = c->to - c->from;
  if (c->piece) dq *= skf_weight_at(c->e->weight, c->piece, (a - c->from) / length, (c->to - a) / length);
  skf_integrand_set(c->e, r, f->alpha * cs * cs + f->beta * sn * sn, dq, out);
}

/* chi in [lo, hi], a part of [0, pi / 2], on one side of x */
static void quarter(circle c, double lo, double hi, double out[SIZE]) {
  if (!(lo < hi)) return;
  const skf_arc_frame *f = c.f;
  double width = f->spread > f->alpha ? sqrt(f->alpha / f->spread) : 1;
  c.delta = fmax(fmax(width, 1e-3 * lo), 1e-15 * hi);
  c.delta = fmax(c.delta, fmin(skf_kernel_grain(c.e->kernel) / (2 * f->rho), 1));
  double breaks[SKF_KERNEL_BREAKS + 2], radii[SKF_KERNEL_BREAKS];
  int n = 0;
  for (int i = skf_kernel_breaks(c.e->kernel, radii) - 1; i >= 0; i--) {
    double s = radii[i], in = (s - f->da) * (s + f->da), beyond = (f->db - s) * (f->db + s);
    if (in > 0 && beyond > 0) breaks[n++] = asinh(atan2(sqrt(in), sqrt(beyond)) / c.delta);
  }
  n = skf_breaks(asinh(lo / c.delta), asinh(hi / c.delta), n, breaks);
  skf_integrate(&(skf_integrand){circle_at, &c}, n, breaks, out);
}

/* The azimuths lo .. hi, halved, within -pi/2 .. 3 pi/2 from x */
static void add_circle(const skf_prepared *e, const skf_arc_frame *f, double lo, double hi,
                       const skf_weight_piece *piece, double out[SIZE]) {
  const double q = SKF_PI / 2;
  circle c = {.e = e, .f = f, .piece = piece, .from = lo, .to = hi};
  c.base = 0, c.turn = c.sign = -1;
  quarter(c, fmax(0, -hi), fmin(q, -lo), out); /* -pi/2 .. 0 */
  c.turn = c.sign = 1;
  quarter(c, fmax(0, lo), fmin(q, hi), out);
  c.base = 2 * q, c.turn = c.sign = -1;
  quarter(c, fmax(0, 2 * q - hi), fmin(q, 2 * q - lo), out); /* pi/2 .. pi */
  c.turn = c.sign = 1;
  quarter(c, fmax(0, lo - 2 * q), hi - 2 * q, out);
}

static bool arc(const skf_prepared *e, skf_vec3 x, double out[SIZE]) {
  skf_arc_frame f;
  skf_arc_place(e, x, &f);
  double lo = -0.5 * atan2(f.uy, f.ux), hi = lo + e->plan.arc.half, q = SKF_PI / 2;
  if (f.full && !e->weight) lo = -q, hi = q;
  if (f.alpha == 0 && ((lo <= 0 && hi >= 0) || hi >= 2 * q) && skf_kernel_singular(e->kernel)) return false;
  if (!e->weight) add_circle(e, &f, lo, hi, NULL, out);
  for (size_t i = 0; e->weight && i < e->weight->n; i++) {
    const skf_weight_piece *p = e->weight->piece + i;
    add_circle(e, &f, lo + p->a * (hi - lo), lo + p->b * (hi - lo), p, out);
  }
  return true;
}

static bool segment(const skf_prepared *e, skf_vec3 x, double out[SIZE]) {
  skf_segment_frame f;
  skf_segment_place(e, x, &f);
  if (f.h == 0 && f.t0 <= 0 && f.t1 >= 0 && skf_kernel_singular(e->kernel)) return false;
  if (!e->weight) add_line(e, f.w, f.a, f.h2, f.t0, f.t1, NULL, out);
  for (size_t i = 0; e->weight && i < e->weight->n; i++) {
    const skf_weight_piece *p = e->weight->piece + i;
    add_line(e, f.w, f.a, f.h2, f.t0 + p->a * f.L, f.t1 - (1 - p->b) * f.L, p, out);
  }
  return true;
}

static bool point(const skf_prepared *e, skf_vec3 x, double out[SIZE]) {
  double w;
  skf_dd3 d = skf_point_delta(e, x, &w);
  if (w == 0 && skf_kernel_singular(e->kernel)) return false;
  skf_integrand_set(e, dd3_round(d), w, 1, out);
  return true;
}

void skf_quadrature(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  double out[SIZE] = {0};
  bool finite = true;
  switch (e->primitive.shape) {
  case SKF_POINT: finite = point(e, x, out); break;
  case SKF_SEGMENT: finite = segment(e, x, out); break;
  case SKF_ARC: finite = arc(e, x, out); break;
  case SKF_TRIANGLE: skf_quadrature_triangle(e, x, out); break;
  default: skf_quadrature_plane(e, x, out);
  }
  v->F = finite ? out[0] : INFINITY;
  if (!isfinite(v->F)) return;
  v->g = v3(out[1], out[2], out[3]);
  for (int k = 0; k < 6 && order > 1; k++) v->h[k] = out[4 + k];
}
