/* SPDX-License-Identifier: MIT */
/* Moments of the inside of an isosurface. The octree tells which cells lie inside; in one that the surface passes, one
   coordinate is found along which the field rises or falls, so that each line of this direction is cut at
   most once, and Gauss's rule is used across [Saye, SIAM J. Sci. Comput. 37 (2015) A993]: the lines' ends depend
   smoothly on where they are, but for the curves in which the surface leaves through the cell's two ends, and these are
   cut out in the same way in a second coordinate, and the ends of those curves in the third. */
#include "core/alloc.h"
#include "field/some.h"
#include "num/gauss.h"
#include "ray/ball.h"
#include "ray/walk.h"
#include "skelfield/rigid.h"

enum { ORDER = 8, RULES = 6, DEPTH = 12, MOMENTS = 10 };
/* Pairs: each one is tried where the one before does not suffice. */
static const int orders[RULES] = {2, 3, 4, 5, 6, ORDER};

typedef struct moments {
  double m[MOMENTS]; /* 1, x, y, z, xx, xy, xz, yy, yz, zz */
} moments;

typedef struct rule {
  int n;
  double node[ORDER], weight[ORDER]; /* on [0, 1] */
} rule;

typedef struct job {
  const skf_tracer *tracer;
  skf_vec3 origin; /* of the moments */
  double tolerance, size;
  moments sum;
  double error; /* of the volume */
  rule rules[RULES];
} job;

/* A cell that the surface passes. */
typedef struct cell {
  double lo[3], edge;
  const uint32_t *list;
  uint32_t count;
  double bend; /* of F in it */
  int i, j, k; /* outer, inner, and the direction of the lines */
  bool cut[2]; /* whether the surface may leave through the ends lo, hi of k */
} cell;

static double F(const job *w, const cell *c, const double x[3], double g[3]) {
  skf_vec3 grad;
  double made_of, f = skf_field_some(w->tracer->field, c->list, c->count, v3(x[0], x[1], x[2]), &grad, &made_of);
  if (g) g[0] = grad.x, g[1] = grad.y, g[2] = grad.z;
  return f - w->tracer->iso;
}

/* The root along coordinate d between lo and hi, where F has the values a and b of different signs; x[d] is used up. */
static double root(const job *w, const cell *c, double x[3], int d, double lo, double hi, double a, double b) {
  double g[3], t = lo - a * (hi - lo) / (b - a);
  for (int i = 0; i < 60; i++) {
    if (!(t > lo && t < hi)) t = 0.5 * (lo + hi);
    if (!(t > lo && t < hi)) break;
    x[d] = t;
    double f = F(w, c, x, g), step = f / g[d];
    if ((f < 0) == (a < 0))
      lo = t;
    else
      hi = t;
    if (f == 0 || fabs(step) <= 1e-15 * w->size) return t - (fabs(step) < 1e-14 * w->size ? step : 0);
    t -= step;
  }
  return t;
}

/* Where a function along coordinate d changes sign in the cell; *n such places are added to `at`. */
static void cut(const job *w, const cell *c, double x[3], int d, double *at, int *n) {
  double lo = c->lo[d], hi = lo + c->edge, a, b;
  x[d] = lo, a = F(w, c, x, NULL);
  x[d] = hi, b = F(w, c, x, NULL);
  if ((a < 0) != (b < 0)) at[(*n)++] = root(w, c, x, d, lo, hi, a, b);
}

static void sort(double *at, int n) {
  for (int i = 1; i < n; i++)
    for (int k = i; k > 0 && at[k] < at[k - 1]; k--) {
      double s = at[k];
      at[k] = at[k - 1], at[k - 1] = s;
    }
}

/* The part of a line that is inside, with its weight. */
static void line(const job *w, const cell *c, double x[3], double weight, moments *out) {
  int k = c->k;
  double lo = c->lo[k], hi = lo + c->edge, a, b, from = lo, to = hi;
  x[k] = lo, a = F(w, c, x, NULL);
  x[k] = hi, b = F(w, c, x, NULL);
  if (a < 0 && b < 0) return;
  if ((a < 0) != (b < 0)) *(a < 0 ? &from : &to) = root(w, c, x, k, lo, hi, a, b);
  double L = weight * (to - from), o[3] = {w->origin.x, w->origin.y, w->origin.z}, m1[3], m2[3];
  from -= o[k], to -= o[k];
  for (int d = 0; d < 3; d++) m1[d] = x[d] - o[d], m2[d] = m1[d] * m1[d];
  m1[k] = 0.5 * (from + to), m2[k] = (from * from + from * to + to * to) / 3;
  const double part[MOMENTS] = {1,     m1[0],         m1[1], m1[2], m2[0], m1[0] * m1[1], m1[0] * m1[2],
                                m2[1], m1[1] * m1[2], m2[2]};
  for (int n = 0; n < MOMENTS; n++) out->m[n] += L * part[n];
}

static void inner(const job *w, const cell *c, const rule *r, double x[3], double weight, moments *out) {
  double at[4] = {c->lo[c->j]};
  int n = 1;
  for (int end = 0; end < 2; end++) {
    x[c->k] = c->lo[c->k] + end * c->edge;
    if (c->cut[end]) cut(w, c, x, c->j, at, &n);
  }
  at[n] = c->lo[c->j] + c->edge;
  sort(at, n);
  for (int s = 0; s < n; s++)
    for (int q = 0; q < r->n; q++) {
      double L = at[s + 1] - at[s];
      x[c->j] = at[s] + r->node[q] * L;
      line(w, c, x, weight * r->weight[q] * L, out);
    }
}

static moments integrate(const job *w, const cell *c, const rule *r) {
  moments sum = {{0}};
  double at[6] = {c->lo[c->i]}, x[3];
  int n = 1;
  for (int e = 0; e < 4; e++) {
    if (!c->cut[e & 1]) continue;
    x[c->k] = c->lo[c->k] + (e & 1) * c->edge, x[c->j] = c->lo[c->j] + (e >> 1) * c->edge;
    cut(w, c, x, c->i, at, &n);
  }
  at[n] = c->lo[c->i] + c->edge;
  sort(at, n);
  for (int s = 0; s < n; s++)
    for (int q = 0; q < r->n; q++) {
      double L = at[s + 1] - at[s];
      x[c->i] = at[s] + r->node[q] * L;
      inner(w, c, r, x, r->weight[q] * L, &sum);
    }
  return sum;
}

/* Chooses the coordinates; false where none is certain. */
static bool arrange(const job *w, cell *c) {
  double half = 0.5 * c->edge, x[3], g[3], face[2][3];
  for (int d = 0; d < 3; d++) x[d] = c->lo[d] + half;
  F(w, c, x, g);
  c->k = fabs(g[0]) >= fabs(g[1]) && fabs(g[0]) >= fabs(g[2]) ? 0 : fabs(g[1]) >= fabs(g[2]) ? 1 : 2;
  if (!(fabs(g[c->k]) > c->bend * 1.7320508075688772 * half)) return false;
  int a = (c->k + 1) % 3, b = (c->k + 2) % 3;
  double best[2] = {INFINITY, INFINITY};
  for (int end = 0; end < 2; end++) {
    x[c->k] = c->lo[c->k] + end * c->edge;
    double f = F(w, c, x, face[end]);
    c->cut[end] = fabs(f) <= (fabs(face[end][a]) + fabs(face[end][b])) * half + c->bend * half * half;
    for (int d = 0; d < 2 && c->cut[end]; d++) best[d] = fmin(best[d], fabs(face[end][d ? b : a]));
  }
  c->j = best[0] >= best[1] ? a : b, c->i = c->j == a ? b : a;
  if (!c->cut[0] && !c->cut[1]) return true;
  if (!(fmax(best[0], best[1]) > c->bend * 1.4142135623730951 * half)) return false;
  for (int e = 0; e < 4; e++) { /* the edges along i: at most one cut in each */
    if (!c->cut[e & 1]) continue;
    x[c->k] = c->lo[c->k] + (e & 1) * c->edge, x[c->j] = c->lo[c->j] + (e >> 1) * c->edge, x[c->i] = c->lo[c->i] + half;
    double f = F(w, c, x, g), slope = fabs(g[c->i]);
    bool clear = fabs(f) > slope * half + 0.5 * c->bend * half * half;
    if (!clear && !(slope > c->bend * half)) return false;
  }
  return true;
}

static void add_box(job *w, const double lo[3], double edge, double share) {
  double V = edge * edge * edge * share, o[3] = {w->origin.x, w->origin.y, w->origin.z}, m[3];
  for (int d = 0; d < 3; d++) m[d] = lo[d] + 0.5 * edge - o[d];
  double s = edge * edge / 12;
  const double part[MOMENTS] = {
      1, m[0], m[1], m[2], m[0] * m[0] + s, m[0] * m[1], m[0] * m[2], m[1] * m[1] + s, m[1] * m[2], m[2] * m[2] + s};
  for (int n = 0; n < MOMENTS; n++) w->sum.m[n] += V * part[n];
}

/* How far the gradient at the corners differs from that at the middle. Twice that stands for the bound of the second
   derivatives, which is several times too large: in a cell of the octree the field is nearly flat, for sure, and what
   is judged wrong shows in the difference of the rules. */
static double turn(const job *w, const cell *c, const double g[3]) {
  double most = 0;
  for (int n = 0; n < 8; n++) {
    double x[3], h[3], d2 = 0;
    for (int d = 0; d < 3; d++) x[d] = c->lo[d] + (n >> d & 1 ? c->edge : 0);
    F(w, c, x, h);
    for (int d = 0; d < 3; d++) d2 += (h[d] - g[d]) * (h[d] - g[d]);
    most = fmax(most, d2);
  }
  return sqrt(most);
}

static void halve(job *w, const cell *c, int depth);

static void pass(job *w, cell *c, int depth) {
  double half = 0.5 * c->edge, V = c->edge * c->edge * c->edge, radius = 1.7320508075688772 * half * (1 + 1e-12);
  skf_vec3 middle = v3(c->lo[0] + half, c->lo[1] + half, c->lo[2] + half);
  skf_ball ball = {.list = c->list, .count = c->count};
  skf_outlook o = skf_octree_enclose(w->tracer->tree, &ball, middle, radius);
  double iso = w->tracer->iso, x[3] = {middle.x, middle.y, middle.z}, g[3];
  if (o.hi < iso) return;
  if (o.lo > iso) return add_box(w, c->lo, c->edge, 1);
  double f = F(w, c, x, g), most = (fabs(g[0]) + fabs(g[1]) + fabs(g[2])) * half + 0.5 * o.bend * radius * radius;
  if (fabs(f) > most) {
    if (f > 0) add_box(w, c->lo, c->edge, 1);
    return;
  }
  c->bend = fmin(o.bend, 2 * turn(w, c, g) / radius);
  bool fine = arrange(w, c);
  if (depth == 0 && !fine) { /* by what its middle tells */
    add_box(w, c->lo, c->edge, fmin(fmax(0.5 + 0.5 * f / most, 0), 1));
    w->error += 0.5 * V;
    return;
  }
  if (!fine) return halve(w, c, depth);
  moments good, poor;
  double off = INFINITY;
  for (int n = 0; n + 1 < RULES && off > w->tolerance * V; n += 2) {
    poor = integrate(w, c, w->rules + n), good = integrate(w, c, w->rules + n + 1);
    off = fabs(good.m[0] - poor.m[0]) / V;
    off *= cbrt(off) * V; /* errors fall like rho^-2n: the better rule's is at most the 4/3rd power of the other's */
  }
  if (off > w->tolerance * V && depth > 0) return halve(w, c, depth);
  for (int n = 0; n < MOMENTS; n++) w->sum.m[n] += good.m[n];
  w->error += 8 * off; /* spheres show up to 6 times */
}

static void halve(job *w, const cell *c, int depth) {
  double half = 0.5 * c->edge;
  for (int n = 0; n < 8; n++) {
    cell part = *c;
    part.edge = half;
    for (int d = 0; d < 3; d++) part.lo[d] += n >> d & 1 ? half : 0;
    pass(w, &part, depth - 1);
  }
}

static void descend(job *w, skf_branch *b, int k) {
  skf_cell is = skf_octree_child(w->tracer->tree, b, k);
  double h = b->half,
         lo[3] = {b->middle.x - (k & 1 ? 0 : h), b->middle.y - (k & 2 ? 0 : h), b->middle.z - (k & 4 ? 0 : h)};
  if ((is & SKF_CELL_KIND) == SKF_CELL_INSIDE) add_box(w, lo, h, 1);
  if ((is & SKF_CELL_KIND) == SKF_CELL_BRANCH)
    for (int n = 0; n < 8; n++) descend(w, skf_cell_branch(is), n);
  if (is && !skf_cell_is_leaf(is)) return;
  cell c = {.lo = {lo[0], lo[1], lo[2]}, .edge = h, .list = b->list, .count = b->count};
  if (is) c.list = skf_cell_leaf(is)->list, c.count = skf_cell_leaf(is)->count;
  pass(w, &c, DEPTH);
}

/* Moments about the center, and the inertia tensor of them. */
static void finish(const job *w, skf_mass *out) {
  const double *m = w->sum.m;
  double V = m[0], x = m[1] / V, y = m[2] / V, z = m[3] / V;
  double xx = m[4] - V * x * x, yy = m[7] - V * y * y, zz = m[9] - V * z * z;
  *out = (skf_mass){.volume = V, .center = v3_add(w->origin, v3(x, y, z)), .error = w->error / V};
  out->inertia[0] = yy + zz, out->inertia[3] = xx + zz, out->inertia[5] = xx + yy;
  out->inertia[1] = V * x * y - m[5], out->inertia[2] = V * x * z - m[6], out->inertia[4] = V * y * z - m[8];
}

static void prepare(rule *r, int n) {
  const skf_gauss_node *g = skf_gauss_rule(n);
  r->n = n;
  for (int i = 0; i < n; i++) r->node[i] = 0.5 + 0.5 * g[i].x, r->weight[i] = 0.5 * g[i].w;
}

skf_status skf_mass_of(const skf_field *field, double iso, double tolerance, skf_mass *out) {
  *out = (skf_mass){.volume = 0};
  if (tolerance == 0) tolerance = 1e-9;
  if (!(tolerance >= 1e-13 && tolerance <= 0.1)) return SKF_ERR_RANGE;
  if (!(iso > 0)) return isfinite(iso) ? SKF_ERR_UNBOUNDED : SKF_ERR_ARG;
  skf_tracer *t;
  skf_status s = skf_tracer_new(field, iso, &t);
  if (s) return s;
  if (t->reach != SKF_OK || !t->tree) {
    s = t->reach == SKF_ERR_EMPTY ? SKF_ERR_EMPTY : SKF_ERR_UNBOUNDED;
    return skf_tracer_free(t), s;
  }
  job w = {.tracer = t, .origin = box_center(t->region), .tolerance = tolerance, .size = box_diagonal(t->region)};
  for (int n = 0; n < RULES; n++) prepare(w.rules + n, orders[n]);
  descend(&w, skf_octree_top(t->tree), 0);
  skf_tracer_free(t);
  if (!(w.sum.m[0] > 0)) return SKF_ERR_EMPTY;
  return finish(&w, out), SKF_OK;
}
