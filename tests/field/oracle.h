/* SPDX-License-Identifier: MIT */
/* Fields from their definitions, in 113-bit arithmetic: Gauss-Legendre over the primitive, graded towards every
   singularity, of the kernel and its derivatives. Triangles are reduced to their edges by the divergence theorem, each
   edge being integrated numerically. Good to 25 digits or more; a millisecond for each place. */
#ifndef SKF_TESTS_FIELD_ORACLE_H
#define SKF_TESTS_FIELD_ORACLE_H

#include "skelfield/field.h"
#include <math.h>
#include <quadmath.h>
#include <string.h>

typedef __float128 quad;
typedef struct quad3 {
  quad x[3];
} quad3;

/* F, gradient, Hessian (xx, xy, xz, yy, yz, zz). */
typedef struct oracle_value {
  quad F, g[3], h[6];
} oracle_value;

static inline quad3 q3(skf_vec3 a) { return (quad3){{a.x, a.y, a.z}}; }
static inline quad q3_dot(quad3 a, quad3 b) { return a.x[0] * b.x[0] + a.x[1] * b.x[1] + a.x[2] * b.x[2]; }
static inline quad q3_norm(quad3 a) { return sqrtq(q3_dot(a, a)); }
static inline quad3 q3_mad(quad3 a, quad s, quad3 b) {
  return (quad3){{a.x[0] + s * b.x[0], a.x[1] + s * b.x[1], a.x[2] + s * b.x[2]}};
}
static inline quad3 q3_sub(quad3 a, quad3 b) { return q3_mad(a, -1, b); }
static inline quad3 q3_scale(quad s, quad3 a) { return (quad3){{s * a.x[0], s * a.x[1], s * a.x[2]}}; }
static inline quad3 q3_cross(quad3 a, quad3 b) {
  return (quad3){
      {a.x[1] * b.x[2] - a.x[2] * b.x[1], a.x[2] * b.x[0] - a.x[0] * b.x[2], a.x[0] * b.x[1] - a.x[1] * b.x[0]}};
}
/* Smallest |x| on [a, b]. */
static inline quad q_near(quad a, quad b) { return a > 0 ? a : b < 0 ? -b : 0; }

/* h and its first two derivatives with respect to w = r^2. */
static inline void oracle_kernel(int type, quad p, quad w, quad d[3]) {
  quad s2 = p * p, r = sqrtq(w), m = (s2 - w) / s2, q = 1 / (1 + s2 * w), a = m * p / (p + r);
  d[0] = d[1] = d[2] = 0;
  if (type == SKF_CAUCHY)
    d[0] = q * q, d[1] = -2 * s2 * q * d[0], d[2] = -3 * s2 * q * d[1];
  else if (type == SKF_GAUSSIAN)
    d[0] = expq(-s2 * w), d[1] = -s2 * d[0], d[2] = -s2 * d[1];
  else if (type == SKF_INVERSE)
    d[0] = 1 / r, d[1] = -d[0] / (2 * w), d[2] = -3 * d[1] / (2 * w);
  else if (type == SKF_INVERSE_SQUARED)
    d[0] = 1 / w, d[1] = -d[0] / w, d[2] = -2 * d[1] / w;
  else if (m <= 0)
    return;
  else if (type == SKF_QUARTIC)
    d[0] = m * m, d[1] = -2 * m / s2, d[2] = 2 / (s2 * s2);
  else if (type == SKF_SOFT_OBJECT)
    d[0] = m * m * (5 + 4 * m) / 9, d[1] = -m * (10 + 12 * m) / (9 * s2), d[2] = (10 + 24 * m) / (9 * s2 * s2);
  else if (9 * w <= s2)
    d[0] = 1 - 3 * w / s2, d[1] = -3 / s2;
  else
    d[0] = 3 * a * a / 2, d[1] = -3 * a / (2 * p * r), d[2] = 3 / (4 * p * r * w);
}

static inline bool oracle_compact(int type) { return type >= SKF_METABALL; }
static inline bool oracle_polynomial(int type) { return type == SKF_SOFT_OBJECT || type == SKF_QUARTIC; }

/* Adds weight times the kernel at the offset X = x - q. */
static inline void oracle_add(oracle_value *v, quad weight, const quad d[3], quad3 X) {
  quad a = 2 * weight * d[1], b = 4 * weight * d[2];
  v->F += weight * d[0];
  for (int i = 0, k = 0; i < 3; i++) {
    v->g[i] += a * X.x[i];
    for (int j = i; j < 3; j++) v->h[k++] += (i == j ? a : 0) + b * X.x[i] * X.x[j];
  }
}

/* What is integrated, and where it may be: `fits` tells whether one Gauss rule will do for [a, b]. */
typedef struct oracle_line {
  int type;
  quad p, singular; /* parameter; distance of the nearest complex singularity from 0 */
  bool (*fits)(const void *line, quad a, quad b);
  void (*at)(void *line, quad t, quad weight);
} oracle_line;

enum { ORACLE_NODES = 26 };

static inline const quad (*oracle_rule(void))[2] {
  static quad rule[ORACLE_NODES][2];
  for (int i = 0; i < ORACLE_NODES && rule[i][1] == 0; i++) {
    const int n = ORACLE_NODES;
    quad x = cosq(M_PIq * (4 * i + 3) / (4 * n + 2)), slope = 1;
    for (int pass = 0; pass < 30; pass++) {
      quad p0 = 1, p1 = x;
      for (int k = 2; k <= n; k++) {
        quad p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
        p0 = p1, p1 = p2;
      }
      slope = n * (x * p1 - p0) / (x * x - 1);
      x -= p1 / slope;
    }
    rule[i][0] = x, rule[i][1] = 2 / ((1 - x * x) * slope * slope);
  }
  return (const quad(*)[2])rule;
}

static inline void oracle_panel(oracle_line *f, quad a, quad b, int depth) {
  quad mid = (a + b) / 2, half = (b - a) / 2;
  if (!(b > a)) return;
  if (depth > 0 && mid > a && mid < b && !f->fits(f, a, b)) {
    oracle_panel(f, a, mid, depth - 1);
    oracle_panel(f, mid, b, depth - 1);
    return;
  }
  const quad(*rule)[2] = oracle_rule();
  for (int i = 0; i < ORACLE_NODES; i++) f->at(f, mid + half * rule[i][0], half * rule[i][1]);
}

/* Over [lo, hi], cut at those of n places that are within. */
static inline void oracle_integrate(oracle_line *f, quad lo, quad hi, int n, const quad *cuts) {
  while (lo < hi) {
    quad next = hi;
    for (int i = 0; i < n; i++)
      if (cuts[i] > lo && cuts[i] < next) next = cuts[i];
    oracle_panel(f, lo, next, 200);
    lo = next;
  }
}

/* A Gaussian over [a, b]: short beside its width, and the exponent hardly changes. */
static inline bool oracle_calm(quad p, quad a, quad b) {
  quad w = b - a, far = fmaxq(fabsq(a), fabsq(b));
  return p * w <= 1.5Q && p * p * far * w <= 8;
}

static inline bool oracle_apart(quad singular, quad a, quad b) {
  quad near = q_near(a, b), w = b - a;
  return w * w <= near * near + singular * singular;
}

/* Adds +-sqrt(square) to the cuts. */
static inline void oracle_cut(quad square, quad *cuts, int *n) {
  if (!(square > 0)) return;
  cuts[(*n)++] = sqrtq(square);
  cuts[(*n)++] = -sqrtq(square);
}

/* Segments: t is the abscissa of q from the foot of x. */
typedef struct oracle_segment {
  oracle_line f;
  quad3 d, u; /* x - from; direction */
  quad t0, h2;
  oracle_value *v;
} oracle_segment;

static inline bool oracle_segment_fits(const void *line, quad a, quad b) {
  const oracle_line *f = line;
  if (f->type == SKF_GAUSSIAN) return oracle_calm(f->p, a, b);
  return oracle_polynomial(f->type) || oracle_apart(f->singular, a, b);
}

static inline void oracle_segment_at(void *line, quad t, quad weight) {
  oracle_segment *s = line;
  quad d[3];
  oracle_kernel(s->f.type, s->f.p, s->h2 + t * t, d);
  oracle_add(s->v, weight, d, q3_mad(s->d, s->t0 - t, s->u));
}

static inline void oracle_segment_field(const skf_element *e, quad3 x, oracle_value *v) {
  quad3 from = q3(e->primitive.segment.from), side = q3_sub(q3(e->primitive.segment.to), from);
  oracle_segment s = {.f = {(int)e->kernel.type, e->kernel.param, 0, oracle_segment_fits, oracle_segment_at}, .v = v};
  quad L = q3_norm(side), p = s.f.p, cuts[5] = {0};
  int n = 1;
  s.d = q3_sub(x, from);
  s.u = q3_scale(1 / L, side);
  s.t0 = -q3_dot(s.d, s.u);
  quad3 normal = q3_cross(s.d, s.u);
  s.h2 = q3_dot(normal, normal);
  quad lo = s.t0, hi = s.t0 + L, near = q_near(lo, hi);
  s.f.singular = sqrtq(s.h2 + (s.f.type == SKF_CAUCHY ? 1 / (p * p) : 0));
  quad reach2 = s.f.type == SKF_GAUSSIAN ? near * near + 100 / (p * p) : p * p - s.h2;
  if (s.f.type == SKF_GAUSSIAN || oracle_compact(s.f.type)) {
    if (reach2 <= 0) return;
    lo = fmaxq(lo, -sqrtq(reach2)), hi = fminq(hi, sqrtq(reach2));
  }
  if (s.f.type == SKF_METABALL) oracle_cut(p * p / 9 - s.h2, cuts, &n);
  oracle_integrate(&s.f, lo, hi, n, cuts);
}

/* Arcs: t is the azimuth of q from x. r^2 = alpha + spread sin^2(t / 2). */
typedef struct oracle_arc {
  oracle_line f;
  quad rho, k, z, alpha, spread;
  quad3 out, along, n;
  oracle_value *v;
} oracle_arc;

static inline bool oracle_arc_fits(const void *line, quad a, quad b) {
  const oracle_arc *s = line;
  quad turn = 2 * M_PIq * roundq((a + b) / (4 * M_PIq)), near = q_near(a - turn, b - turn), w = b - a;
  if (w > 1) return false;
  if (s->f.type == SKF_GAUSSIAN) return oracle_calm(s->f.p * sqrtq(s->spread) / 2, near, near + w);
  return oracle_polynomial(s->f.type) || w * w <= near * near + s->f.singular * s->f.singular;
}

static inline void oracle_arc_at(void *line, quad t, quad weight) {
  oracle_arc *s = line;
  quad half = sinq(t / 2), d[3];
  oracle_kernel(s->f.type, s->f.p, s->alpha + s->spread * half * half, d);
  quad3 X = q3_scale(s->k - s->rho + 2 * s->rho * half * half, s->out);
  oracle_add(s->v, weight * s->rho, d, q3_mad(q3_mad(X, -s->rho * sinq(t), s->along), s->z, s->n));
}

static inline void oracle_arc_place(oracle_arc *s, const skf_arc *a, quad3 x, quad *azimuth) {
  quad3 n = q3(a->normal), d = q3_sub(x, q3(a->center));
  s->n = q3_scale(1 / q3_norm(n), n);
  quad3 e = q3_mad(q3(a->start), -q3_dot(q3(a->start), s->n), s->n);
  e = q3_scale(1 / q3_norm(e), e);
  quad3 f = q3_cross(s->n, e);
  quad u = q3_dot(d, e), w = q3_dot(d, f);
  s->rho = a->radius, s->k = sqrtq(u * u + w * w), s->z = q3_dot(d, s->n);
  *azimuth = s->k > 0 ? atan2q(w, u) : 0;
  if (s->k > 0) u /= s->k, w /= s->k;
  if (s->k == 0) u = 1, w = 0;
  s->out = q3_mad(q3_scale(u, e), w, f), s->along = q3_mad(q3_scale(-w, e), u, f);
  s->alpha = (s->k - s->rho) * (s->k - s->rho) + s->z * s->z;
  s->spread = 4 * s->rho * s->k;
}

static inline void oracle_arc_field(const skf_element *e, quad3 x, oracle_value *v) {
  oracle_arc s = {.f = {(int)e->kernel.type, e->kernel.param, 100, oracle_arc_fits, oracle_arc_at}, .v = v};
  quad azimuth, p = s.f.p, turn = 2 * M_PIq, cuts[24], reach = turn;
  oracle_arc_place(&s, &e->primitive.arc, x, &azimuth);
  bool full = e->primitive.arc.sweep >= (double)turn;
  quad lo = full ? -M_PIq : -azimuth, hi = full ? M_PIq : e->primitive.arc.sweep - azimuth;
  quad soft = s.alpha + (s.f.type == SKF_CAUCHY ? 1 / (p * p) : 0);
  if (s.spread > 0) s.f.singular = 2 * asinhq(sqrtq(soft / s.spread));
  int n = 0;
  for (int i = -2; i <= 2; i++) cuts[n++] = i * M_PIq;
  for (int i = 1; i <= 3 && oracle_compact(s.f.type); i += 2) {
    quad in = (p / i) * (p / i) - s.alpha;
    if (!(in > 0 && in < s.spread)) continue;
    for (int k = -1; k <= 1; k++) {
      cuts[n++] = k * turn + 2 * asinq(sqrtq(in / s.spread));
      cuts[n++] = k * turn - 2 * asinq(sqrtq(in / s.spread));
    }
  }
  if (s.f.type == SKF_GAUSSIAN) { /* where the exponent has not grown by 100 from its least */
    quad near = fminq(M_PIq, q_near(lo, hi)), end = sinq(near / 2);
    if (hi > turn) near = end = 0;
    if (lo > 0 && hi > M_PIq && hi <= turn) near = fminq(near, turn - hi), end = sinq(near / 2);
    quad most = end * end + 100 / (p * p * s.spread);
    if (most < 1) reach = 2 * asinq(sqrtq(most));
  }
  if (reach > M_PIq) oracle_integrate(&s.f, lo, hi, n, cuts);
  for (int k = -1; k <= 1 && reach <= M_PIq; k++)
    oracle_integrate(&s.f, fmaxq(lo, k * turn - reach), fminq(hi, k * turn + reach), n, cuts);
}

/* int_w^infinity h dw / 2 for the kernels of finite support. */
static inline quad oracle_tail(int type, quad p, quad w) {
  quad s2 = p * p, y = (s2 - w) / s2, u = sqrtq(w) / p, a = y / (1 + u);
  if (y <= 0) return 0;
  if (type == SKF_QUARTIC) return s2 * y * y * y / 6;
  if (type == SKF_SOFT_OBJECT) return s2 * y * y * y * (5 + 3 * y) / 54;
  return 3 * u <= 1 ? s2 / 2 * (13 / 54.Q - u * u + 3 * u * u * u * u / 2) : s2 * a * a * a * (4 - 3 * a) / 8;
}

/* Triangles, edge by edge; t is the abscissa from the foot of x. See field/triangle_parts.h for the two forms. */
typedef struct oracle_edge {
  oracle_line f;
  bool beyond; /* G-form */
  quad d, z, lat2, near;
  quad center[2], G0; /* h and h'/r at x's foot in the plane */
  quad F, J, K, W, V; /* int d (..)/rho^2 dl of the potential, int h dl, int h'/r dl, the former of h and h'/r */
} oracle_edge;

static inline bool oracle_edge_fits(const void *line, quad a, quad b) {
  const oracle_edge *e = line;
  quad p = e->f.p, l = q_near(a, b);
  if (!oracle_apart(e->f.singular, a, b)) return false;
  return e->f.type != SKF_GAUSSIAN || p * p * (l - e->near) * (l + e->near) > 100 || oracle_calm(p, a, b);
}

static inline void oracle_edge_at(void *line, quad l, quad weight) {
  oracle_edge *e = line;
  quad rho2 = e->d * e->d + l * l, z2 = e->z * e->z, r2 = rho2 + z2, p = e->f.p, d[3], G, q = 1 + p * p * z2;
  oracle_kernel(e->f.type, p, r2, d);
  e->J += weight * d[0], e->K += weight * 2 * d[1];
  if (e->d == 0) return;
  if (e->f.type == SKF_CAUCHY)
    G = e->beyond ? 1 / (2 * p * p * (q + p * p * rho2)) : -rho2 / (2 * q * (q + p * p * rho2));
  else if (e->f.type == SKF_GAUSSIAN)
    G = e->beyond ? d[0] / (2 * p * p) : e->center[0] * expm1q(-p * p * rho2) / (2 * p * p);
  else if (e->f.type == SKF_INVERSE)
    G = e->beyond ? sqrtq(e->lat2 + z2) - sqrtq(r2) : -rho2 / (sqrtq(r2) + fabsq(e->z));
  else if (e->f.type == SKF_INVERSE_SQUARED)
    G = -logq(r2 / (e->beyond ? e->lat2 + z2 : z2)) / 2;
  else
    G = oracle_tail(e->f.type, p, r2) - (e->beyond ? 0 : e->G0);
  quad w = weight * e->d / rho2;
  e->F -= w * G;
  e->W += w * (d[0] - (e->beyond ? 0 : e->center[0]));
  e->V += w * (2 * d[1] - (e->beyond ? 0 : e->center[1]));
}

static inline quad oracle_angle(quad d, quad a, quad b) {
  return d == 0 || !(b > a) ? 0 : atan2q(d * (b - a), d * d + a * b);
}

/* The part within the support, and sectors of the disc for the rest. */
static inline void oracle_edge_run(oracle_edge *e, quad l1, quad l2) {
  quad p = e->f.p, z2 = e->z * e->z, rm2 = p * p - z2 - e->d * e->d, lo = l1, hi = l2, cuts[3] = {0};
  int n = 1;
  e->near = q_near(l1, l2);
  if (e->f.type == SKF_METABALL) oracle_cut(p * p / 9 - z2 - e->d * e->d, cuts, &n);
  if (oracle_compact(e->f.type)) {
    quad T = rm2 > 0 ? sqrtq(rm2) : 0, angle;
    lo = fmaxq(l1, -T), hi = fminq(l2, T);
    angle = lo < hi ? oracle_angle(e->d, l1, lo) + oracle_angle(e->d, hi, l2) : oracle_angle(e->d, l1, l2);
    if (!e->beyond) e->F += e->G0 * angle, e->W -= e->center[0] * angle, e->V -= e->center[1] * angle;
  }
  oracle_integrate(&e->f, lo, hi, n, cuts);
}

typedef struct oracle_corner {
  quad3 a, t, m; /* vertex - x; direction of the edge from it and its outward normal */
  quad d, l1, l2;
} oracle_corner;

static inline bool oracle_corners(const skf_triangle *T, quad3 x, oracle_corner c[3], quad3 *n, quad *z, quad *lat2) {
  bool inside = true;
  for (int i = 0; i < 3; i++) c[i].a = q3_sub(q3(T->vertices[i]), x);
  *n = q3_cross(q3_sub(c[1].a, c[0].a), q3_sub(c[2].a, c[0].a));
  *n = q3_scale(1 / q3_norm(*n), *n);
  *lat2 = INFINITY;
  for (int i = 0; i < 3; i++) {
    quad3 a = c[i].a, b = c[(i + 1) % 3].a, e = q3_sub(b, a);
    quad L = q3_norm(e);
    bool first = q3_norm(a) < q3_norm(b);
    c[i].t = q3_scale(1 / L, e);
    c[i].m = q3_cross(c[i].t, *n);
    c[i].d = q3_dot(c[i].m, first ? a : b);
    c[i].l1 = first ? q3_dot(c[i].t, a) : q3_dot(c[i].t, b) - L, c[i].l2 = c[i].l1 + L;
    if (fabsq(c[i].d) < 1e-31Q * L) c[i].d = 0;
    if (c[i].d < 0) inside = false;
    quad l = q_near(c[i].l1, c[i].l2);
    *lat2 = fminq(*lat2, c[i].d * c[i].d + l * l);
    if (i == 0 || first) *z = -q3_dot(*n, a);
    if (fabsq(*z) < 1e-31Q * L) *z = 0;
  }
  if (inside) *lat2 = 0;
  return inside;
}

/* Whether one polynomial in r^2, or a metaball's root far from its branch point, is all that the triangle sees. */
static inline bool oracle_triangle_plain(int type, quad p, const oracle_corner c[3]) {
  quad far = 0, near = INFINITY, diam = 0;
  for (int i = 0; i < 3; i++) {
    quad r = q3_norm(c[i].a);
    far = fmaxq(far, r), near = fminq(near, r), diam = fmaxq(diam, c[i].l2 - c[i].l1);
  }
  if (type != SKF_METABALL || 3 * far <= p) return far <= p;
  return far <= p && near >= 4 * diam && 3 * (near - diam) > p;
}

/* By the rule's square over the corner's square: exact, or to (2 * 3 + sqrt(35))^-52. */
static inline void oracle_triangle_rule(int type, quad p, const oracle_corner c[3], oracle_value *v) {
  const quad(*rule)[2] = oracle_rule();
  quad3 first = q3_sub(c[1].a, c[0].a), second = q3_sub(c[2].a, c[1].a), n = q3_cross(first, second);
  quad area = q3_norm(n), d[3];
  for (int i = 0; i < ORACLE_NODES; i++)
    for (int j = 0; j < ORACLE_NODES; j++) {
      quad s = (1 + rule[i][0]) / 2, t = s * (1 + rule[j][0]) / 2;
      quad3 X = q3_scale(-1, q3_mad(q3_mad(c[0].a, s, first), t, second));
      oracle_kernel(type, p, q3_dot(X, X), d);
      oracle_add(v, area * s * rule[i][1] * rule[j][1] / 4, d, X);
    }
}

static inline void oracle_triangle_field(const skf_element *e, quad3 x, oracle_value *v) {
  oracle_corner c[3];
  quad3 n;
  quad z = 0, lat2, p = e->kernel.param, center[3];
  int type = (int)e->kernel.type;
  bool inside = oracle_corners(&e->primitive.triangle, x, c, &n, &z, &lat2), compact = oracle_compact(type);
  if (compact && z * z >= p * p) return;
  if (compact && oracle_triangle_plain(type, p, c)) {
    oracle_triangle_rule(type, p, c, v);
    return;
  }
  quad lat = sqrtq(lat2), width = compact ? sqrtq(p * p - z * z) / 2 : type < SKF_INVERSE ? 1 / p : fabsq(z);
  oracle_kernel(type, p, z * z, center);
  if (z == 0 && !compact && type >= SKF_INVERSE) center[0] = center[1] = 0;
  for (int k = 0; k < 3; k++) {
    oracle_edge s = {.f = {type, p, fabsq(c[k].d), oracle_edge_fits, oracle_edge_at}, .beyond = !inside && lat > width};
    s.d = c[k].d, s.z = z, s.lat2 = lat2, s.center[0] = center[0], s.center[1] = 2 * center[1];
    if (compact) s.G0 = oracle_tail(type, p, z * z);
    if (s.d == 0) s.f.singular = type < SKF_INVERSE ? 1 / p : oracle_polynomial(type) ? p : fmaxq(fabsq(z), 1e-30Q * p);
    oracle_edge_run(&s, c[k].l1, c[k].l2);
    quad d1[3], d2[3];
    quad3 b = c[(k + 1) % 3].a;
    oracle_kernel(type, p, q3_dot(c[k].a, c[k].a), d1);
    oracle_kernel(type, p, q3_dot(b, b), d2);
    v->F += s.F;
    for (int i = 0, at = 0; i < 3; i++) {
      quad mi = c[k].m.x[i], ti = c[k].t.x[i], ni = n.x[i];
      v->g[i] += ni * z * s.W - mi * s.J;
      for (int j = i; j < 3; j++) {
        quad mj = c[k].m.x[j], tj = c[k].t.x[j], nj = n.x[j];
        v->h[at++] += mi * mj * s.d * s.K + (mi * tj + mj * ti) / 2 * (d2[0] - d1[0]) - (mi * nj + mj * ni) * z * s.K +
                      ni * nj * (s.W + z * z * s.V);
      }
    }
  }
}

static inline void oracle_plane_field(const skf_element *e, quad3 x, oracle_value *v) {
  quad3 n = q3(e->primitive.plane.normal);
  n = q3_scale(1 / q3_norm(n), n);
  quad z = q3_dot(n, q3_sub(x, q3(e->primitive.plane.through))), z2 = z * z, p = e->kernel.param, d[3];
  int type = (int)e->kernel.type;
  oracle_kernel(type, p, z2, d);
  v->F = type == SKF_CAUCHY            ? M_PIq / (p * p * (1 + p * p * z2))
         : type == SKF_GAUSSIAN        ? M_PIq / (p * p) * d[0]
         : type == SKF_INVERSE         ? -2 * M_PIq * fabsq(z)
         : type == SKF_INVERSE_SQUARED ? -2 * M_PIq * logq(fabsq(z))
                                       : 2 * M_PIq * oracle_tail(type, p, z2);
  for (int i = 0, k = 0; i < 3; i++) {
    v->g[i] = -2 * M_PIq * z * d[0] * n.x[i];
    for (int j = i; j < 3; j++) v->h[k++] = -2 * M_PIq * (d[0] + 2 * z2 * d[1]) * n.x[i] * n.x[j];
  }
}

/* Off the singular sets. */
static inline oracle_value oracle(const skf_element *e, skf_vec3 at) {
  oracle_value v;
  quad3 x = q3(at);
  memset(&v, 0, sizeof v);
  switch (e->primitive.shape) {
  case SKF_SEGMENT: oracle_segment_field(e, x, &v); break;
  case SKF_ARC: oracle_arc_field(e, x, &v); break;
  case SKF_TRIANGLE: oracle_triangle_field(e, x, &v); break;
  case SKF_PLANE: oracle_plane_field(e, x, &v); break;
  default: {
    quad d[3];
    quad3 X = q3_sub(x, q3(e->primitive.point.at));
    oracle_kernel((int)e->kernel.type, e->kernel.param, q3_dot(X, X), d);
    oracle_add(&v, 1, d, X);
  }
  }
  return v;
}

#endif
