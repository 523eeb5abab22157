/* SPDX-License-Identifier: MIT */
/* Expansions in Chebyshev polynomials. */
#include "core/alloc.h"
#include "field/far_job.h"
#include <stdlib.h>

static void clear(const far_job *j, double *t) { memset(t, 0, j->far->layout.size * sizeof *t); }

/* *out += *in through one matrix for each axis */
static void through(const far_job *j, const far_matrix *const m[3], const double *in, double *out) {
  const far_layout *l = &j->far->layout;
  double *a = far_room(j), *b = a + l->size;
  clear(j, a), clear(j, b);
  j->far->ops->along[0][FAR_ONE](l, l->order, m[0], in, NULL, a);
  j->far->ops->along[1][FAR_ONE](l, l->order, m[1], a, NULL, b);
  j->far->ops->along[2][FAR_ONE](l, l->order, m[2], b, NULL, out);
}

static void collect(const far_job *j, size_t k) {
  const far_source *s = j->far->tree.source + k;
  double *out = far_moments_of(j, k);
  if (!s->split) skf_far_collect(j, k);
  for (int i = 0; i < 8; i++) {
    if (s->child[i] < 0) continue;
    const far_matrix *const m[3] = {&j->to_parent[i & 1], &j->to_parent[i >> 1 & 1], &j->to_parent[i >> 2]};
    through(j, m, far_moments_of(j, (size_t)s->child[i]), out);
  }
}

static void up(const far_job *j, int level) {
  const far_tree *t = &j->far->tree;
#pragma omp parallel for schedule(dynamic, 4)
  for (size_t k = t->source_level[level]; k < t->source_level[level + 1]; k++) collect(j, k);
}

static void down(const far_job *j, int level) {
  const far_tree *t = &j->far->tree;
  size_t from = t->target_level[level - 1], to = t->target_level[level];
#pragma omp parallel for schedule(dynamic, 4)
  for (size_t k = from; k < to; k++)
    for (int i = 0; i < 8 && t->target[k].child >= 0; i++) {
      const far_matrix *const m[3] = {&j->to_child[i & 1], &j->to_child[i >> 1 & 1], &j->to_child[i >> 2]};
      through(j, m, far_tensor_of(j, k), far_tensor_of(j, (size_t)(t->target[k].child + i)));
    }
}

static bool apart(int shift) { return shift < -1 || shift > 1; }

/* What sources of one plane z do to targets at one x. */
typedef struct plane {
  double *apart[AROUND], *close[AROUND]; /* after x, at each y: from sources apart along x, and not */
  double *done, *open;                   /* after y */
  bool has_apart[AROUND], has_close[AROUND], has_done, has_open;
} plane;

/* The block of memory, cleared when it is used for the first time. */
static double *into(const far_job *j, double *t, bool *has) {
  if (!*has) clear(j, t);
  *has = true;
  return t;
}

/* A row of sources, from two cells before the block, goes along an axis to the target t: sources at opposite shifts
   together, into *far those that are apart, into *near, if wanted, the others. */
static void along(const far_job *j, int axis, const far_term *g, const double *const row[AROUND], int t, double *far,
                  bool *has_far, double *near, bool *has_near) {
  for (int shift = 0; shift <= FAR_REACH; shift++) {
    const far_matrix *m = g->along + FAR_REACH;
    const double *plus = NULL, *minus = NULL;
    if (!g->matters[FAR_REACH + shift] || (!apart(shift) && !near)) continue;
    if (far_shift_of(t + shift + BLOCK / 2, t) == shift) plus = row[t + shift + BLOCK / 2];
    if (shift && far_shift_of(t - shift + BLOCK / 2, t) == -shift) minus = row[t - shift + BLOCK / 2];
    if (!plus && !minus) continue;
    double *out = apart(shift) ? into(j, far, has_far) : into(j, near, has_near);
    m += plus ? shift : -shift;
    far_mode mode = shift == 0 ? FAR_SAME : plus && minus ? FAR_TWO : FAR_ONE;
    j->far->ops->along[axis][mode](&j->far->layout, g->order, m, plus ? plus : minus, minus, out);
  }
}

static void along_x(const far_job *j, const far_block *b, const far_term *g, int z, int tx, plane *p) {
  for (int y = 0; y < AROUND; y++) {
    p->has_apart[y] = p->has_close[y] = false;
    along(j, 0, g, b->source[z][y], tx, p->apart[y], &p->has_apart[y], p->close[y], &p->has_close[y]);
  }
}

static void along_y(const far_job *j, const far_term *g, int ty, plane *p) {
  const double *apart[AROUND], *close[AROUND];
  for (int y = 0; y < AROUND; y++) {
    apart[y] = p->has_apart[y] ? p->apart[y] : NULL;
    close[y] = p->has_close[y] ? p->close[y] : NULL;
  }
  p->has_done = p->has_open = false;
  along(j, 1, g, apart, ty, p->done, &p->has_done, p->done, &p->has_done);
  along(j, 1, g, close, ty, p->done, &p->has_done, p->open, &p->has_open);
}

static void along_z(const far_job *j, const far_term *g, int z, const int target[BLOCK], const plane *p) {
  for (int tz = 0; tz < BLOCK; tz++) {
    int shift = far_shift_of(z, tz), k = target[tz];
    if (shift == FAR_SHIFTS || k < 0 || !g->matters[shift + FAR_REACH]) continue;
    const far_layout *l = &j->far->layout;
    const far_matrix *m = g->last + shift + FAR_REACH;
    double *out = far_tensor_of(j, (size_t)k);
    if (p->has_done) j->far->ops->along[2][FAR_ONE](l, g->order, m, p->done, NULL, out);
    if (p->has_open && apart(shift)) j->far->ops->along[2][FAR_ONE](l, g->order, m, p->open, NULL, out);
  }
}

static void across(const far_job *j, int level, const far_block *b) {
  (void)level;
  plane p;
  double *next = far_room(j);
  size_t size = j->far->layout.size;
  for (int y = 0; y < AROUND; y++, next += 2 * size) p.apart[y] = next, p.close[y] = next + size;
  p.done = next, p.open = next + size;
  for (int i = 0; i < j->mixture->count; i++)
    for (int z = 0; z < AROUND; z++)
      for (int x = 0; x < BLOCK; x++) {
        const far_term *g = j->mixture->term + i;
        if (!b->column[x]) continue;
        along_x(j, b, g, z, x, &p);
        for (int y = 0; y < BLOCK; y++) {
          if (!b->row[x][y]) continue;
          along_y(j, g, y, &p);
          along_z(j, g, z, b->target[x][y], &p);
        }
      }
}

static bool ready(const far_job *j, int level) {
  return skf_far_mixture_make(j->elements->kernel, far_side(&j->far->tree, level), j->accuracy, j->mixture) &&
         (level == 1 || j->mixture->order <= j->far->layout.order);
}

static void halves(far_job *j) {
  int n = j->far->layout.order;
  for (int i = 0; i < 2; i++) {
    skf_far_shift_matrix(0.5, (i ? 0.5 : -0.5) / FAR_WIDE, n, j->to_child + i);
    for (int a = 0; a < n; a++)
      for (int b = 0; b < n; b++) j->to_parent[i].m[b][a] = j->to_child[i].m[a][b];
  }
}

skf_status skf_far_chebyshev(far_job *j) {
  j->mixture = skf_alloc(1, sizeof *j->mixture);
  if (!j->mixture) return SKF_ERR_NOMEM;
  if (!ready(j, 1)) return SKF_ERR_UNSUPPORTED;
  j->far->layout = far_layout_new(j->mixture->order);
  j->up = up, j->down = down, j->ready = ready, j->across = across;
  halves(j);
  return SKF_OK;
}
