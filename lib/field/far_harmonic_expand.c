/* SPDX-License-Identifier: MIT */
/* Expansions in solid harmonics. */
#include "field/far_job.h"

/* Up to FAR_GROUP cells that go the same way */
typedef struct group {
  const far_job *j;
  const far_move *move;
  far_kind kind;
  double by;
  int n;
  const double *from[FAR_GROUP];
  double *to[FAR_GROUP];
} group;

static void go(group *g) {
  if (g->n) g->j->far->ops->transfer(g->move, g->kind, g->by, g->n, g->from, g->to, far_room(g->j));
  g->n = 0;
}

static void add(group *g, const double *from, double *to) {
  g->from[g->n] = from, g->to[g->n++] = to;
  if (g->n == FAR_GROUP) go(g);
}

/* The same from two cells each, on both sides of the target */
typedef struct group_both {
  const far_job *j;
  const far_move *move;
  double by;
  int n;
  const double *from[2][FAR_GROUP];
  double *to[FAR_GROUP];
} group_both;

static void go_both(group_both *g) {
  const double *const(*from)[FAR_GROUP] = (const double *const(*)[FAR_GROUP])g->from;
  if (g->n) g->j->far->ops->transfer_both(g->move, g->by, g->n, from, g->to, far_room(g->j));
  g->n = 0;
}

static void add_both(group_both *g, const double *from, const double *opposite, double *to) {
  g->from[0][g->n] = from, g->from[1][g->n] = opposite, g->to[g->n++] = to;
  if (g->n == FAR_GROUP) go_both(g);
}

static void scale(const far_harmonic *h, double *t) {
  for (size_t k = 0; k < h->size; k++) t[k] *= h->norm[k];
}

/* Sources are taken eight by eight, whatever the number of threads. */
static void up(const far_job *j, int level) {
  const far_tree *t = &j->far->tree;
  const far_harmonic *h = j->far->harmonic;
  size_t first = t->source_level[level], end = t->source_level[level + 1];
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t k0 = first; k0 < end; k0 += FAR_GROUP) {
    size_t k1 = k0 + FAR_GROUP < end ? k0 + FAR_GROUP : end;
    for (size_t k = k0; k < k1; k++)
      if (!t->source[k].split) skf_far_collect(j, k), scale(h, far_moments_of(j, k));
    for (int i = 0; i < 8; i++) {
      group g = {.j = j, .move = h->child + i, .kind = FAR_UP, .by = 1};
      for (size_t k = k0; k < k1; k++) {
        int child = t->source[k].child[i];
        if (child >= 0) add(&g, far_moments_of(j, (size_t)child), far_moments_of(j, k));
      }
      go(&g);
    }
  }
}

static void down(const far_job *j, int level) {
  const far_tree *t = &j->far->tree;
  size_t first = t->target_level[level - 1], end = t->target_level[level];
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t k0 = first; k0 < end; k0 += FAR_GROUP)
    for (int i = 0; i < 8; i++) {
      group g = {.j = j, .move = j->far->harmonic->child + i, .kind = FAR_DOWN, .by = 1};
      for (size_t k = k0; k < k0 + FAR_GROUP && k < end; k++)
        if (t->target[k].child >= 0) add(&g, far_tensor_of(j, k), far_tensor_of(j, (size_t)(t->target[k].child + i)));
      go(&g);
    }
}

static bool ready(const far_job *j, int level) {
  (void)j, (void)level;
  return true;
}

/* Rounded down */
static int half(int i) { return i >= 0 ? i / 2 : -((1 - i) / 2); }

/* Whether a source at a shift is the business of the block's target: its parent is near the target's, it is not near
   itself. */
static bool concerns(const int shift[3], const int target[3]) {
  int parent[3];
  for (int k = 0; k < 3; k++) parent[k] = half(target[k] + shift[k]) - half(target[k]);
  return far_is_near(parent);
}

/* The moments at a place counted from the block's corner; NULL: none. */
static const double *source_at(const far_job *j, int level, const int origin[3], const int at[3]) {
  int k = skf_far_tree_find(&j->far->tree, level, origin[0] + at[0], origin[1] + at[1], origin[2] + at[2]);
  return k < 0 ? NULL : far_moments_of(j, (size_t)k);
}

/* The moments at a shift from the block's target that are its business; NULL: none. */
static const double *moments_at(const far_job *j, int level, const far_block *b, const int t[3], const int shift[3]) {
  if (!concerns(shift, t)) return NULL;
  const int at[3] = {t[0] + shift[0], t[1] + shift[1], t[2] + shift[2]};
  bool inside = true;
  for (int k = 0; k < 3; k++) inside = inside && at[k] >= -2 && at[k] < AROUND - 2;
  return inside ? b->source[at[2] + 2][at[1] + 2][at[0] + 2] : source_at(j, level, b->origin, at);
}

static const far_move *move_from(const far_harmonic *h, const int shift[3]) {
  return &h->over[FAR_LONG - shift[0]][FAR_LONG - shift[1]][FAR_LONG - shift[2]];
}

/* From a shift and the opposite one */
static void from_shifts(const far_job *j, int level, const far_block *b, const int shift[3]) {
  const far_harmonic *h = j->far->harmonic;
  const int opposite[3] = {-shift[0], -shift[1], -shift[2]};
  const double by = 1 / far_side(&j->far->tree, level);
  group one = {.j = j, .move = move_from(h, shift), .kind = FAR_OVER, .by = by};
  group other = {.j = j, .move = move_from(h, opposite), .kind = FAR_OVER, .by = by};
  group_both both = {.j = j, .move = one.move, .by = by};
  for (int i = 0; i < BLOCK * BLOCK * BLOCK; i++) {
    const int t[3] = {i % BLOCK, i / BLOCK % BLOCK, i / BLOCK / BLOCK}, target = b->target[t[0]][t[1]][t[2]];
    if (target < 0) continue;
    const double *from[2] = {moments_at(j, level, b, t, shift), moments_at(j, level, b, t, opposite)};
    double *to = far_tensor_of(j, (size_t)target);
    if (from[0] && from[1])
      add_both(&both, from[0], from[1], to);
    else if (from[0])
      add(&one, from[0], to);
    else if (from[1])
      add(&other, from[1], to);
  }
  go_both(&both), go(&one), go(&other);
}

/* Each shift with the opposite one, so the first half of them all */
static void across(const far_job *j, int level, const far_block *b) {
  for (int i = 0; i < FAR_WAYS * FAR_WAYS * FAR_WAYS / 2; i++) {
    const int shift[3] = {i % FAR_WAYS - FAR_LONG, i / FAR_WAYS % FAR_WAYS - FAR_LONG,
                          i / FAR_WAYS / FAR_WAYS - FAR_LONG};
    if (move_from(j->far->harmonic, shift)->order) from_shifts(j, level, b, shift);
  }
}

skf_status skf_far_harmonics(far_job *j) {
  far_harmonic *h = skf_far_harmonic_new(j->accuracy);
  if (!h) return SKF_ERR_NOMEM;
  j->far->harmonic = h;
  j->far->layout = (far_layout){.order = h->order, .size = h->size};
  j->up = up, j->down = down, j->ready = ready, j->across = across;
  return SKF_OK;
}
