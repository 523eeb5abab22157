/* SPDX-License-Identifier: MIT */
/* Sums of Gaussians without what lies below the accuracy, decided for each point by itself. Its greatest lower bound of
   the sum of magnitudes that any one piece gives is W exp(-s^2 d^2), d its largest distance. Cells with a weight w at
   least r away are at most w exp(-s^2 r^2) (1 + 2 s^2 r^2), F and, in units of s and s^2, its derivatives. They are
   passed over where that, per w, is below the accuracy times the lower bound per weight of the whole: all of them
   together then stay below the accuracy. */
#include "core/alloc.h"
#include "field/far_parts.h"
#include <string.h>

/* A part of the accuracy: for arcs, whose derivatives may be smaller than distances and F suggest. */
#define SHARE (1.0 / 16)

static double fill(skf_far *f, const skf_prepared *elements, int source) {
  const far_source *s = f->tree.source + source;
  far_narrow *out = f->narrow + source;
  double weight = 0;
  *out = (far_narrow){0, box_empty(), s->first, s->count};
  for (size_t i = s->first; i < s->first + s->count && !s->split; i++) {
    const far_piece *p = f->tree.pieces.at + i;
    double measure = p->primitive.shape == SKF_POINT ? 1 : skf_primitive_measure(&p->primitive);
    double mine = fabs(elements[p->element].strength) * measure;
    skf_box box = skf_primitive_bounds(&p->primitive);
    weight += mine;
    out->box = box_join(out->box, box);
    f->ball[i] = (far_ball){log(mine), 0.5 * box_diagonal(box), box_center(box)};
  }
  for (int i = 0; i < 8; i++) {
    if (s->child[i] < 0) continue;
    weight += fill(f, elements, s->child[i]);
    out->box = box_join(out->box, f->narrow[s->child[i]].box);
  }
  return out->weight = log(weight), weight;
}

skf_status skf_far_narrow(skf_far *f, const skf_prepared *elements, double accuracy) {
  double s = elements->kernel.param;
  f->narrow = skf_alloc(f->tree.source_count, sizeof *f->narrow);
  f->ball = skf_alloc(f->tree.pieces.count, sizeof *f->ball);
  if (!f->narrow || !f->ball) return SKF_ERR_NOMEM;
  f->s2 = s * s;
  f->limit = log(SHARE * accuracy) - log(fill(f, elements, 0));
  return isfinite(f->limit) && f->s2 > 0 && isfinite(f->s2) ? SKF_OK : SKF_ERR_UNSUPPORTED;
}

/* The squared distance from the nearest point of a box */
static double away(const skf_box *b, double x, double y, double z) {
  double u = fmax(b->lo.x - x, x - b->hi.x), v = fmax(b->lo.y - y, y - b->hi.y), w = fmax(b->lo.z - z, z - b->hi.z);
  u = u > 0 ? u : 0, v = v > 0 ? v : 0, w = w > 0 ? w : 0;
  return u * u + v * v + w * w;
}

/* The log of the greatest lower bound, at least `best`. */
static double surely(const skf_far *f, int source, skf_vec3 x, double best) {
  const far_source *s = f->tree.source + source;
  const far_narrow *w = f->narrow + source;
  if (!(w->weight - f->s2 * away(&w->box, x.x, x.y, x.z) > best)) return best;
  for (size_t i = w->first; i < w->first + w->count && !s->split; i++) {
    const far_ball *b = f->ball + i;
    double d = v3_dist(b->center, x) + b->radius, bound = b->weight - f->s2 * d * d;
    best = bound > best ? bound : best;
  }
  skf_vec3 c = far_center(&f->tree, s->level, s->at);
  int near = (x.x >= c.x) | (x.y >= c.y) << 1 | (x.z >= c.z) << 2;
  for (int i = 0; i < 8; i++) /* the nearest child first */
    if (s->child[i ^ near] >= 0) best = surely(f, s->child[i ^ near], x, best);
  return best;
}

/* The squared distance from which on cells are passed over: u = (s r)^2 > 1/2 where log(1 + 2 u) - u is the limit. */
static double reach(const skf_far *f, skf_vec3 x) {
  double limit = -(f->limit + surely(f, 0, x, -INFINITY)), u = limit;
  if (!(limit < 1e300)) return INFINITY;
  for (int i = 0; i < 12; i++) u = limit + log1p(2 * fmax(u, 1));
  return fmax(u * (1 + 1e-9), 0.5) / f->s2;
}

/* A cell's batch is added to some of the points. */
static void add_some(const skf_batch *b, far_points *all, const unsigned char *which, size_t n) {
  far_points some = {.n = n, .padded = (n + SKF_BATCH_PAD - 1) / SKF_BATCH_PAD * SKF_BATCH_PAD};
  for (size_t i = 0; i < some.padded; i++) {
    size_t from = which[i < n ? i : n - 1];
    for (int k = 0; k < 3; k++) some.p[k][i] = all->p[k][from];
    for (int k = 0; k < 4; k++) some.sum.s[k][i] = all->sum.s[k][from], some.sum.low[k][i] = all->sum.low[k][from];
  }
  const double *const p[3] = {some.p[0], some.p[1], some.p[2]};
  skf_batch_add(b, n, some.padded, p, &some.sum, false);
  for (int k = 0; k < 4; k++)
    for (size_t i = 0; i < n; i++)
      all->sum.s[k][which[i]] = some.sum.s[k][i], all->sum.low[k][which[i]] = some.sum.low[k][i];
}

_Static_assert(SKF_BATCH <= 256, "points of a block are counted in bytes");

static void visit(const skf_far *f, int source, far_points *b, const double *d2, const unsigned char *which, size_t n) {
  const far_source *s = f->tree.source + source;
  unsigned char mine[SKF_BATCH];
  size_t m = 0;
  for (size_t i = 0; i < n; i++) {
    size_t k = which[i];
    mine[m] = which[i];
    m += !(away(&f->narrow[source].box, b->p[0][k], b->p[1][k], b->p[2][k]) >= d2[k]);
  }
  if (m == 0) return;
  if (!s->split) return add_some(f->batch + s->first, b, mine, m);
  for (int i = 0; i < 8; i++)
    if (s->child[i] >= 0) visit(f, s->child[i], b, d2, mine, m);
}

void skf_far_narrow_add(const skf_far *f, far_points *b) {
  double d2[SKF_BATCH];
  unsigned char all[SKF_BATCH];
  for (size_t i = 0; i < b->n; i++) {
    all[i] = (unsigned char)i;
    d2[i] = reach(f, v3(b->p[0][i], b->p[1][i], b->p[2][i]));
  }
  visit(f, 0, b, d2, all, b->n);
}

static void add_hessian(const skf_far *f, int source, skf_vec3 p, double d2, double h[6]) {
  const far_source *s = f->tree.source + source;
  const far_narrow *w = f->narrow + source;
  if (away(&w->box, p.x, p.y, p.z) >= d2) return;
  for (size_t i = w->first; i < w->first + w->count && !s->split; i++) {
    skf_value one = {.F = 0};
    skf_element_value(f->prepared + i, p, 2, &one);
    for (int m = 0; m < 6; m++) h[m] += f->prepared[i].strength * one.h[m];
  }
  for (int i = 0; i < 8; i++)
    if (s->child[i] >= 0) add_hessian(f, s->child[i], p, d2, h);
}

void skf_far_narrow_hessian(const skf_far *f, skf_vec3 p, double h[6]) { add_hessian(f, 0, p, reach(f, p), h); }

static size_t count(const skf_far *f, int source, skf_vec3 x, double d2) {
  const far_source *s = f->tree.source + source;
  if (away(&f->narrow[source].box, x.x, x.y, x.z) >= d2) return 0;
  size_t n = s->split ? 0 : s->count;
  for (int i = 0; i < 8; i++)
    if (s->child[i] >= 0) n += count(f, s->child[i], x, d2);
  return n;
}

/* By what is summed next to some of the pieces. */
bool skf_far_narrow_pays(const skf_far *f) {
  enum { SAMPLES = 64 };
  size_t n = f->tree.pieces.count, step = n / SAMPLES + 1, all = 0, summed = 0;
  for (size_t i = 0; i < n; i += step, all += n) {
    skf_vec3 x = v3_add(f->ball[i].center, v3(f->ball[i].radius, 0, 0));
    summed += count(f, 0, x, reach(f, x));
  }
  return 4 * summed < all;
}
