/* SPDX-License-Identifier: MIT */
/* Moments of the cells of sources, upwards; polynomials of the cells of targets, downwards. */
#include "core/alloc.h"
#include "field/far_parts.h"
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* Targets are worked on in blocks of BLOCK^3, which share what their sources do along x and y. */
enum { BLOCK = 4, AROUND = BLOCK + 4, ROOM = 2 * AROUND + 2 };

typedef struct job {
  skf_far *far;
  const skf_prepared *elements;
  double accuracy, *moments, *work; /* work: ROOM tensors for each thread */
  far_mixture *mixture;
  far_matrix up[2], down[2]; /* to and from the lower and upper half of the parent */
} job;

static double *moments_of(const job *j, size_t source) { return j->moments + source * j->far->layout.size; }
static double *tensor_of(const job *j, size_t target) { return j->far->tensors + target * j->far->layout.size; }
static double *room(const job *j) { return j->work + (size_t)omp_get_thread_num() * ROOM * j->far->layout.size; }

static void clear(const job *j, double *t) { memset(t, 0, j->far->layout.size * sizeof *t); }

/* *out += *in through one matrix for each axis */
static void through(const job *j, const far_matrix *const m[3], const double *in, double *out) {
  const far_layout *l = &j->far->layout;
  double *a = room(j), *b = a + l->size;
  clear(j, a), clear(j, b);
  j->far->ops->along[0][FAR_ONE](l, l->order, m[0], in, NULL, a);
  j->far->ops->along[1][FAR_ONE](l, l->order, m[1], a, NULL, b);
  j->far->ops->along[2][FAR_ONE](l, l->order, m[2], b, NULL, out);
}

static void collect(const job *j, size_t k) {
  const far_tree *t = &j->far->tree;
  const far_source *s = t->source + k;
  double *out = moments_of(j, k), side = far_side(t, s->level);
  skf_vec3 center = far_center(t, s->level, s->at);
  if (!s->split)
    skf_far_moments(j->far->ops, &j->far->layout, t->pieces.at + s->first, s->count, j->elements, center,
                    2 / (FAR_WIDE * side), side, 0.1 * j->accuracy, out);
  for (int i = 0; i < 8; i++) {
    if (s->child[i] < 0) continue;
    const far_matrix *const m[3] = {&j->up[i & 1], &j->up[i >> 1 & 1], &j->up[i >> 2]};
    through(j, m, moments_of(j, (size_t)s->child[i]), out);
  }
}

static void upwards(const job *j) {
  const far_tree *t = &j->far->tree;
  for (int l = t->levels - 1; l >= 0; l--) {
#pragma omp parallel for schedule(dynamic, 4)
    for (size_t k = t->source_level[l]; k < t->source_level[l + 1]; k++) collect(j, k);
  }
}

/* A block's targets and the moments around them; -1, NULL: none. */
typedef struct block {
  int target[BLOCK][BLOCK][BLOCK];
  const double *source[AROUND][AROUND][AROUND]; /* [z][y][x], from two cells before the block */
  bool column[BLOCK], row[BLOCK][BLOCK];        /* whether any target is at [x], at [x][y] */
} block;

/* How many cells away the source `s` of the region is from target `t` of the block, FAR_SHIFTS when it is none of the
   children of the parent's neighbours. */
static int shift_of(int s, int t) {
  int shift = s - BLOCK / 2 - t;
  return shift >= (t % 2 ? -3 : -2) && shift <= (t % 2 ? 2 : 3) ? shift : FAR_SHIFTS;
}
static bool apart(int shift) { return shift < -1 || shift > 1; }

static void look_around(const job *j, int level, const int origin[3], block *b) {
  for (int z = 0; z < AROUND; z++)
    for (int y = 0; y < AROUND; y++)
      for (int x = 0; x < AROUND; x++) {
        int k = skf_far_tree_find(&j->far->tree, level, origin[0] + x - 2, origin[1] + y - 2, origin[2] + z - 2);
        b->source[z][y][x] = k < 0 ? NULL : moments_of(j, (size_t)k);
      }
}

/* What sources of one plane z do to targets at one x. */
typedef struct plane {
  double *apart[AROUND], *close[AROUND]; /* after x, at each y: from sources apart along x, and not */
  double *done, *open;                   /* after y */
  bool has_apart[AROUND], has_close[AROUND], has_done, has_open;
} plane;

/* The block of memory, cleared when it is used for the first time. */
static double *into(const job *j, double *t, bool *has) {
  if (!*has) clear(j, t);
  *has = true;
  return t;
}

/* A row of sources, from two cells before the block, goes along an axis to the target t: sources at opposite shifts
   together, into *far those that are apart, into *near, if wanted, the others. */
static void along(const job *j, int axis, const far_term *g, const double *const row[AROUND], int t, double *far,
                  bool *has_far, double *near, bool *has_near) {
  for (int shift = 0; shift <= FAR_REACH; shift++) {
    const far_matrix *m = g->along + FAR_REACH;
    const double *plus = NULL, *minus = NULL;
    if (!g->matters[FAR_REACH + shift] || (!apart(shift) && !near)) continue;
    if (shift_of(t + shift + BLOCK / 2, t) == shift) plus = row[t + shift + BLOCK / 2];
    if (shift && shift_of(t - shift + BLOCK / 2, t) == -shift) minus = row[t - shift + BLOCK / 2];
    if (!plus && !minus) continue;
    double *out = apart(shift) ? into(j, far, has_far) : into(j, near, has_near);
    m += plus ? shift : -shift;
    far_mode mode = shift == 0 ? FAR_SAME : plus && minus ? FAR_TWO : FAR_ONE;
    j->far->ops->along[axis][mode](&j->far->layout, g->order, m, plus ? plus : minus, minus, out);
  }
}

static void along_x(const job *j, const block *b, const far_term *g, int z, int tx, plane *p) {
  for (int y = 0; y < AROUND; y++) {
    p->has_apart[y] = p->has_close[y] = false;
    along(j, 0, g, b->source[z][y], tx, p->apart[y], &p->has_apart[y], p->close[y], &p->has_close[y]);
  }
}

static void along_y(const job *j, const far_term *g, int ty, plane *p) {
  const double *apart[AROUND], *close[AROUND];
  for (int y = 0; y < AROUND; y++) {
    apart[y] = p->has_apart[y] ? p->apart[y] : NULL;
    close[y] = p->has_close[y] ? p->close[y] : NULL;
  }
  p->has_done = p->has_open = false;
  along(j, 1, g, apart, ty, p->done, &p->has_done, p->done, &p->has_done);
  along(j, 1, g, close, ty, p->done, &p->has_done, p->open, &p->has_open);
}

static void along_z(const job *j, const far_term *g, int z, const int target[BLOCK], const plane *p) {
  for (int tz = 0; tz < BLOCK; tz++) {
    int shift = shift_of(z, tz), k = target[tz];
    if (shift == FAR_SHIFTS || k < 0 || !g->matters[shift + FAR_REACH]) continue;
    const far_layout *l = &j->far->layout;
    const far_matrix *m = g->last + shift + FAR_REACH;
    double *out = tensor_of(j, (size_t)k);
    if (p->has_done) j->far->ops->along[2][FAR_ONE](l, g->order, m, p->done, NULL, out);
    if (p->has_open && apart(shift)) j->far->ops->along[2][FAR_ONE](l, g->order, m, p->open, NULL, out);
  }
}

static void across(const job *j, const block *b) {
  plane p;
  double *next = room(j);
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

/* A target and the block it is in */
typedef struct member {
  int block[3], target;
} member;

static int by_block(const void *a, const void *b) {
  const member *x = a, *y = b;
  for (int k = 2; k >= 0; k--)
    if (x->block[k] != y->block[k]) return x->block[k] < y->block[k] ? -1 : 1;
  return x->target < y->target ? -1 : x->target > y->target;
}

static bool same_block(const member *a, const member *b) { return !memcmp(a->block, b->block, sizeof a->block); }

static void do_block(const job *j, int level, const member *m, size_t n) {
  block b;
  int origin[3];
  for (int k = 0; k < 3; k++) origin[k] = m->block[k] * BLOCK;
  memset(b.target, -1, sizeof b.target);
  memset(b.column, 0, sizeof b.column);
  memset(b.row, 0, sizeof b.row);
  for (size_t i = 0; i < n; i++) {
    const int *at = j->far->tree.target[m[i].target].at;
    int x = at[0] - origin[0], y = at[1] - origin[1];
    b.target[x][y][at[2] - origin[2]] = m[i].target;
    b.column[x] = b.row[x][y] = true;
  }
  look_around(j, level, origin, &b);
  across(j, &b);
}

static void from_parents(const job *j, int level) {
  const far_tree *t = &j->far->tree;
  size_t from = t->target_level[level - 1], to = t->target_level[level];
#pragma omp parallel for schedule(dynamic, 4)
  for (size_t k = from; k < to; k++)
    for (int i = 0; i < 8 && t->target[k].child >= 0; i++) {
      const far_matrix *const m[3] = {&j->down[i & 1], &j->down[i >> 1 & 1], &j->down[i >> 2]};
      through(j, m, tensor_of(j, k), tensor_of(j, (size_t)(t->target[k].child + i)));
    }
}

static skf_status do_level(const job *j, int level) {
  const far_tree *t = &j->far->tree;
  size_t from = t->target_level[level], n = t->target_level[level + 1] - from, blocks = 0;
  member *m = skf_alloc(n, sizeof *m);
  size_t *start = skf_alloc(n + 1, sizeof *start);
  if (m && start) {
    from_parents(j, level);
    for (size_t i = 0; i < n; i++) {
      m[i].target = (int)(from + i);
      for (int k = 0; k < 3; k++) m[i].block[k] = t->target[from + i].at[k] / BLOCK;
    }
    qsort(m, n, sizeof *m, by_block);
    for (size_t i = 0; i < n; i++)
      if (i == 0 || !same_block(m + i, m + i - 1)) start[blocks++] = i;
    start[blocks] = n;
#pragma omp parallel for schedule(dynamic, 1)
    for (size_t i = 0; i < blocks; i++) do_block(j, level, m + start[i], start[i + 1] - start[i]);
  }
  bool ok = m && start;
  skf_free(m), skf_free(start);
  return ok ? SKF_OK : SKF_ERR_NOMEM;
}

static skf_status downwards(job *j, skf_kernel kernel) {
  const far_tree *t = &j->far->tree;
  skf_status s = SKF_OK;
  for (int level = 1; level < t->levels && !s; level++) {
    if (!skf_far_mixture_make(kernel, far_side(t, level), j->accuracy, j->mixture) ||
        j->mixture->order > j->far->layout.order)
      return SKF_ERR_UNSUPPORTED;
    s = do_level(j, level);
  }
  return s;
}

static void halves(job *j) {
  int n = j->far->layout.order;
  for (int i = 0; i < 2; i++) {
    skf_far_shift_matrix(0.5, (i ? 0.5 : -0.5) / FAR_WIDE, n, j->down + i);
    for (int a = 0; a < n; a++)
      for (int b = 0; b < n; b++) j->up[i].m[b][a] = j->down[i].m[a][b];
  }
}

skf_status skf_far_expand(skf_far *f, const skf_prepared *elements, double accuracy, double *whole) {
  job *j = skf_alloc(1, sizeof *j);
  skf_status s = SKF_ERR_NOMEM;
  if (!j) return s;
  *j = (job){.far = f, .elements = elements, .accuracy = accuracy};
  j->mixture = skf_alloc(1, sizeof *j->mixture);
  if (j->mixture && f->tree.levels > 1) {
    s = SKF_ERR_UNSUPPORTED;
    if (skf_far_mixture_make(elements->kernel, far_side(&f->tree, 1), accuracy, j->mixture)) {
      f->layout = far_layout_new(j->mixture->order);
      f->tensors = skf_alloc(f->tree.target_count * f->layout.size, sizeof(double));
      j->moments = skf_alloc(f->tree.source_count * f->layout.size, sizeof(double));
      j->work = skf_alloc((size_t)omp_get_max_threads() * ROOM * f->layout.size, sizeof(double));
      s = f->tensors && j->moments && j->work ? SKF_OK : SKF_ERR_NOMEM;
    }
  } else if (j->mixture)
    s = SKF_ERR_UNSUPPORTED;
  if (!s) {
    halves(j);
    upwards(j);
    s = downwards(j, elements->kernel);
    memcpy(whole, j->moments, f->layout.size * sizeof *whole);
  }
  skf_free(j->mixture), skf_free(j->moments), skf_free(j->work), skf_free(j);
  return s;
}
