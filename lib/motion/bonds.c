/* SPDX-License-Identifier: MIT */
/* Which bodies are near each other, and where: places found once by cells, then followed by Newton's method as long as
   the margin of the search covers what the bodies move. */
#include "motion/swarm.h"
#include "core/alloc.h"
#include <string.h>

#define NARROW 0.004 /* least margin of a search, of the body's size */
#define FIRST  0.02  /* the one when nothing is known yet */
#define SAME   0.02  /* of the size: a place that has moved by less since the last search is the same one */
#define MERGED 1e-3
#define FOLLOW 0.05 /* no place goes further in one step */

static const skf_mover *mover(const skf_swarm *s, size_t i) { return s->bodies + i; }

double skf_mover_reach(const skf_mover *m) { return m->hull->radius + v3_dist(m->hull->center, m->center); }

bool skf_swarm_close(const skf_swarm *s, size_t i, size_t j, double way) {
  const skf_mover *a = mover(s, i), *b = mover(s, j);
  if (!a->hull->bounded || !b->hull->bounded) return true;
  skf_attitude p = skf_mover_at(s, s->y, i), q = skf_mover_at(s, s->y, j);
  return v3_dist(p.x, q.x) <= (skf_mover_reach(a) + skf_mover_reach(b) + way) * (1 + 1e-12);
}

bool skf_bonds_room(skf_bonds *b, size_t n) {
  if (n <= b->capacity) return true;
  skf_bond *more = skf_realloc(b->bond, 2 * n, sizeof *more);
  if (!more) return false;
  b->bond = more, b->capacity = 2 * n;
  return true;
}

void skf_bonds_clear(skf_bonds *b) {
  for (size_t k = 0; k < b->n; k++) skf_free(b->bond[k].leaves.cell);
  b->n = 0;
}

static skf_duel duel_of(const skf_swarm *s, const double *y, const skf_bond *b) {
  skf_attitude p = skf_mover_at(s, y, b->a), q = skf_mover_at(s, y, b->b);
  skf_duel d = {mover(s, b->a)->hull, mover(s, b->b)->hull, {.pose = {.position = p.x}}, {.pose = {.position = q.x}}};
  memcpy(d.ma.pose.q, p.q, sizeof p.q), memcpy(d.mb.pose.q, q.q, sizeof q.q);
  return d;
}

/* A bound of the speed by which the materials of two bodies move against each other; a plane does not. */
static double fastest(const skf_swarm *s, const double *y, const skf_bond *b) {
  skf_attitude p = skf_mover_at(s, y, b->a), q = skf_mover_at(s, y, b->b);
  double turn = 0;
  if (mover(s, b->a)->free) turn += v3_norm(p.w) * skf_mover_reach(mover(s, b->a));
  if (mover(s, b->b)->free) turn += v3_norm(q.w) * skf_mover_reach(mover(s, b->b));
  return v3_dist(p.v, q.v) + turn;
}

/* By how much a body turns from one state to the other [rad], bound. */
static double turned(const skf_attitude *a, const skf_attitude *b) {
  double back[4] = {a->q[0], -a->q[1], -a->q[2], -a->q[3]}, turn[4];
  quat_times(b->q, back, turn);
  return 2 * atan2(sqrt(turn[1] * turn[1] + turn[2] * turn[2] + turn[3] * turn[3]), fabs(turn[0])) * (1 + 1e-12);
}

/* How far the materials move against each other from s->y to y. */
static double way(const skf_swarm *s, const double *y, const skf_bond *b) {
  skf_attitude pa = skf_mover_at(s, s->y, b->a), qa = skf_mover_at(s, y, b->a), pb = skf_mover_at(s, s->y, b->b),
               qb = skf_mover_at(s, y, b->b);
  double d = v3_dist(v3_sub(qa.x, pa.x), v3_sub(qb.x, pb.x));
  if (mover(s, b->a)->free) d += turned(&pa, &qa) * skf_mover_reach(mover(s, b->a));
  if (mover(s, b->b)->free) d += turned(&pb, &qb) * skf_mover_reach(mover(s, b->b));
  return d;
}

/* What the solver left at the places of the last search goes to those of this one. */
static void inherit(const skf_bond *old, skf_bond *b, double radius) {
  for (int i = 0; i < b->n; i++) {
    const skf_spot *best = NULL;
    for (int k = 0; old && k < old->n; k++)
      if (!best || v3_dist(old->spot[k].p, b->spot[i].p) < v3_dist(best->p, b->spot[i].p)) best = old->spot + k;
    if (!best || v3_dist(best->p, b->spot[i].p) > SAME * radius) continue;
    b->spot[i].push = best->push, b->spot[i].twist = best->twist;
  }
}

/* Looks for the places of a bond again; `need`: how far the bodies are going to move in the next step. */
static skf_status search(const skf_swarm *s, skf_bond *b, const skf_bond *old, double need) {
  skf_duel d = duel_of(s, s->y, b);
  double margin = FIRST * b->size, gap = INFINITY;
  for (int i = 0; old && i < old->n; i++) gap = fmin(gap, old->spot[i].gap);
  if (old) margin = old->n ? fmax(NARROW * b->size, 0.5 * gap) : 4 * old->wide;
  margin = fmax(2 * need, margin);
  for (int tries = 0;; tries++, margin *= 0.25) {
    skf_status bad = skf_near_find(&d, margin, b->spot, &b->n, &b->leaves);
    if (bad == SKF_ERR_CONVERGENCE && tries < 6) continue;
    b->clear = b->wide = margin, b->stale = false;
    if (!bad) inherit(old, b, d.a->radius);
    return bad;
  }
}

static skf_bond *find(const skf_bonds *all, size_t a, size_t b) {
  for (size_t i = 0; i < all->n; i++)
    if (all->bond[i].a == a && all->bond[i].b == b) return all->bond + i;
  return NULL;
}

static double acceleration(const skf_swarm *s, const double *slope, size_t i) {
  const double *d = slope + i * SKF_MOVER_STATE + 3;
  return mover(s, i)->free ? v3_norm(v3(d[0], d[1], d[2])) : 0;
}

static double size_of(const skf_swarm *s, size_t i, size_t j) {
  const skf_mover *a = mover(s, i), *b = mover(s, j);
  return fmin(a->free ? a->hull->radius : INFINITY, b->free ? b->hull->radius : INFINITY);
}

skf_status skf_bonds_make(skf_swarm *s, const double *slope, double h) {
  skf_bonds *old = &s->here, *now = &s->spare;
  now->n = 0;
  for (size_t i = 0; i < s->n; i++)
    for (size_t j = i + 1; j < s->n; j++) {
      if (!mover(s, i)->free && !mover(s, j)->free) continue;
      const skf_collider *p = mover(s, i)->hull, *q = mover(s, j)->hull;
      bool swap = !p->bounded || (q->bounded && q->radius < p->radius);
      skf_bond b = {.a = swap ? j : i, .b = swap ? i : j, .size = size_of(s, i, j)};
      double fall = 2 * h * h * (acceleration(s, slope, i) + acceleration(s, slope, j));
      double go = 1.5 * h * fastest(s, s->y, &b) + fall;
      if (!skf_swarm_close(s, i, j, go)) continue;
      if (!skf_bonds_room(now, now->n + 1)) return SKF_ERR_NOMEM;
      now->bond[now->n++] = b;
    }
  int worst = SKF_OK;
#pragma omp parallel for schedule(dynamic) reduction(max : worst) if (now->n > 3)
  for (size_t k = 0; k < now->n; k++) {
    skf_bond *b = now->bond + k;
    skf_bond *was = find(old, b->a, b->b);
    double go =
        1.5 * h * fastest(s, s->y, b) + 2 * h * h * (acceleration(s, slope, b->a) + acceleration(s, slope, b->b));
    if (was && !was->stale && was->clear >= go) {
      *b = *was;
      was->leaves.cell = NULL;
      continue;
    }
    skf_status bad = search(s, b, was, go);
    if ((int)bad > worst) worst = (int)bad;
  }
  skf_bonds new = *now;
  skf_bonds_clear(old);
  s->spare = *old, s->here = new;
  return (skf_status)worst;
}

/* One place in other poses; false when it is lost. */
static bool track(const skf_duel *d, const skf_spot *from, skf_spot *to) {
  skf_kiss k;
  *to = *from;
  if (!skf_kiss_at(d, 0, from->p, FOLLOW * d->a->radius, &k) || !k.summit) return false;
  to->p = k.p, to->at = k.at, to->normal = k.normal, to->gap = -k.depth;
  return true;
}

bool skf_bonds_follow(const skf_swarm *s, const skf_bonds *from, double h, const double *y, skf_bonds *to) {
  bool clear = true;
  to->n = from->n;
  for (size_t k = 0; k < from->n; k++) {
    const skf_bond *b = from->bond + k;
    skf_bond *c = to->bond + k;
    skf_duel d = duel_of(s, y, b);
    *c = *b;
    double moved = h < 0 ? 0 : fmax(way(s, y, b), h * fmax(fastest(s, s->y, b), fastest(s, y, b)));
    c->clear = b->clear - moved;
    if (c->clear < 0) clear = false;
    for (int i = 0; i < b->n; i++) {
      skf_spot *at = c->spot + i;
      at->lost = b->spot[i].lost || !track(&d, b->spot + i, at);
      for (int j = 0; j < i && !at->lost; j++)
        at->lost = !c->spot[j].lost && v3_dist(c->spot[j].p, at->p) < MERGED * d.a->radius;
      c->stale = c->stale || at->lost;
    }
  }
  return clear;
}

skf_status skf_bonds_check(const skf_swarm *s, const double *y, skf_bonds *to, double *least) {
  int worst = SKF_OK;
  double lowest = INFINITY;
#pragma omp parallel for schedule(dynamic) reduction(min : lowest) reduction(max : worst) if (to->n > 3)
  for (size_t k = 0; k < to->n; k++) {
    skf_bond *b = to->bond + k;
    skf_duel d = duel_of(s, y, b);
    int n = b->n;
    double step = s->here.bond[k].clear - b->clear;
    skf_status bad = skf_near_check(&d, &b->leaves, b->wide - b->clear, step, 0.25 * b->wide, b->spot, &b->n);
    if ((int)bad > worst) worst = (int)bad;
    for (int i = n; i < b->n; i++) lowest = fmin(lowest, b->spot[i].gap / b->size);
  }
  *least = lowest;
  return (skf_status)worst;
}

void skf_bonds_tidy(skf_bonds *b) {
  for (size_t k = 0; k < b->n; k++) {
    int n = 0;
    for (int i = 0; i < b->bond[k].n; i++)
      if (!b->bond[k].spot[i].lost) b->bond[k].spot[n++] = b->bond[k].spot[i];
    b->bond[k].n = n;
  }
}
