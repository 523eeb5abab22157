/* SPDX-License-Identifier: MIT */
/* Where two solids come close to each other: cells of space as in collide.c, kept as soon as the margin is what makes
   them unsure, and Newton's method from each of them. */
#include "core/alloc.h"
#include "motion/collider.h"
#include <float.h>

#define MERGED 0.02 /* of a's radius: spots that close are one */
#define SEED   0.05 /* of a's radius: cells from which no more than one place is looked for are no larger */
#define DEEP   0.1  /* of a's radius: no smaller cells within one of the solids, which only overlaps reach */

enum { MOST_CELLS = 400000, MOST_FOUND = 256 };

typedef struct search {
  const skf_duel *duel;
  skf_pose pa, pb;
  double margin, far;
  size_t cells;
  int count;
  skf_spot *found; /* MOST_FOUND */
  skf_leaves *leaves;
  skf_status status;
} search;

typedef enum verdict { DISMISSED, CUT, KEPT } verdict;

/* A ball of radius r about c, frame of a. */
static verdict examine(const search *s, skf_vec3 c, double r) {
  double far = s->far + v3_norm(c), rho = r + s->margin;
  skf_guess a = skf_collider_guess(s->duel->a, c, r, far);
  if (a.side < 0) return DISMISSED;
  skf_guess b = skf_collider_guess(s->duel->b, skf_pose_inverse(&s->pb, skf_pose_point(&s->pa, c)), rho, far);
  if (b.side < 0) return DISMISSED;
  verdict unsure = r > 0.125 * fmax(s->margin, 1e-3 * s->duel->a->radius) ? CUT : KEPT;
  if (a.side > 0 || b.side > 0) return r > DEEP * s->duel->a->radius ? CUT : KEPT;
  if (a.vague || b.vague) return unsure;
  double na = v3_norm(a.g), nb = v3_norm(b.g);
  if (!(na > 0 && nb > 0)) return unsure;
  skf_vec3 gb = quat_turn(s->pa.q, -1, quat_turn(s->pb.q, 1, b.g));
  double rough = a.rough / na + b.rough / nb;
  double space = v3_norm(v3_add(v3_scale(1 / na, a.g), v3_scale(1 / nb, gb))) * r + 0.5 * a.bend / na * r * r +
                 0.5 * b.bend / nb * r * r;
  double moved = s->margin + 0.5 * b.bend / nb * (rho * rho - r * r);
  if (a.f / na + b.f / nb + space + moved + rough < 0) return DISMISSED;
  return space < moved && r < SEED * s->duel->a->radius ? KEPT : unsure;
}

static void keep(search *s, const skf_kiss *k) {
  skf_spot spot = {.p = k->p, .at = k->at, .normal = k->normal, .gap = -k->depth};
  for (int i = 0; i < s->count; i++)
    if (v3_dist(s->found[i].p, k->p) < MERGED * s->duel->a->radius) return;
  if (s->count < MOST_FOUND) s->found[s->count++] = spot;
}

/* The nearest place from a cell, unless it is known. */
static void settle(search *s, skf_vec3 c, double r) {
  skf_kiss k;
  for (int i = 0; i < s->count; i++)
    if (v3_dist(s->found[i].p, c) < fmin(r, MERGED * s->duel->a->radius)) return;
  if (!skf_kiss_at(s->duel, 0, c, 4 * r, &k) || !k.summit || k.depth < -4 * s->margin) return;
  keep(s, &k);
}

static void note(search *s, skf_vec3 c, double r) {
  skf_leaves *l = s->leaves;
  if (l->n == l->capacity) {
    size_t capacity = 2 * l->capacity + 64;
    skf_leaf_cell *more = skf_realloc(l->cell, capacity, sizeof *more);
    if (!more) {
      s->status = SKF_ERR_NOMEM;
      return;
    }
    l->cell = more, l->capacity = capacity;
  }
  l->cell[l->n++] = (skf_leaf_cell){c, r, -1};
}

static void refine(search *s, skf_vec3 c, double half) {
  double r = 0.8660254037844387 * 2 * half * (1 + 1e-12);
  if (++s->cells > MOST_CELLS || s->status) return;
  verdict v = examine(s, c, r);
  if (v == KEPT) settle(s, c, r), note(s, c, r);
  if (v != CUT) return;
  double h = 0.5 * half;
  for (int k = 0; k < 8; k++) refine(s, v3(c.x + (k & 1 ? h : -h), c.y + (k & 2 ? h : -h), c.z + (k & 4 ? h : -h)), h);
}

/* The closest one, and then again and again the one that is farthest from all that are chosen. */
static int choose(search *s, skf_spot *out) {
  int n = 0;
  double apart[MOST_FOUND];
  for (int i = 0; i < s->count; i++) apart[i] = INFINITY;
  while (n < SKF_SPOTS && n < s->count) {
    int best = -1;
    for (int i = 0; i < s->count; i++) {
      bool better = best < 0 || (n == 0 ? s->found[i].gap < s->found[best].gap : apart[i] > apart[best]);
      if (apart[i] > 0 && better) best = i;
    }
    out[n] = s->found[best];
    for (int i = 0; i < s->count; i++) apart[i] = fmin(apart[i], v3_dist(s->found[i].p, out[n].p));
    apart[best] = 0, n++;
  }
  return n;
}

static search begin(const skf_duel *d, double margin) {
  search s = {.duel = d, .pa = skf_rigid_at(&d->ma, 0), .pb = skf_rigid_at(&d->mb, 0), .margin = margin};
  const skf_collider *a = d->a;
  s.far = v3_norm(s.pa.position) + v3_dist(a->center, a->origin) + a->radius + v3_norm(s.pb.position) + margin;
  s.found = skf_alloc(MOST_FOUND, sizeof *s.found);
  if (!s.found) s.status = SKF_ERR_NOMEM;
  return s;
}

skf_status skf_near_find(const skf_duel *d, double margin, skf_spot *spots, int *count, skf_leaves *leaves) {
  search s = begin(d, margin);
  const skf_collider *a = d->a;
  skf_vec3 size = v3_sub(a->box.hi, a->box.lo);
  s.leaves = leaves, leaves->n = 0, *count = 0;
  if (s.status) return s.status;
  refine(&s, v3_sub(box_center(a->box), a->origin), 0.5 * fmax(size.x, fmax(size.y, size.z)) * (1 + 1e-12));
  *count = choose(&s, spots);
  skf_free(s.found);
  return s.status ? s.status : s.cells > MOST_CELLS ? SKF_ERR_CONVERGENCE : SKF_OK;
}

skf_status skf_near_check(const skf_duel *d, skf_leaves *leaves, double moved, double step, double ahead,
                          skf_spot *spots, int *count) {
  search s = begin(d, 0);
  if (s.status) return s.status;
  for (int i = 0; i < *count; i++)
    if (!spots[i].lost) s.found[s.count++] = spots[i];
  int known = s.count;
  for (size_t i = 0; i < leaves->n; i++) {
    skf_leaf_cell *c = leaves->cell + i;
    if (moved <= c->until) continue;
    s.margin = ahead;
    if (examine(&s, c->center, c->radius) == DISMISSED) {
      c->until = moved + ahead - 2 * step;
      continue;
    }
    s.margin = 0;
    if (examine(&s, c->center, c->radius) == DISMISSED) continue;
    s.margin = SEED * d->a->radius; /* how far a place may be apart to be of interest */
    settle(&s, c->center, c->radius);
  }
  for (int i = known; i < s.count && *count < SKF_SPOTS; i++) spots[(*count)++] = s.found[i];
  skf_free(s.found);
  return SKF_OK;
}
