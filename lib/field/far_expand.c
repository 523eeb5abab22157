/* SPDX-License-Identifier: MIT */
/* Moments of the cells of sources, upwards; polynomials of the cells of targets, downwards. */
#include "core/alloc.h"
#include "field/far_job.h"
#include <stdint.h>
#include <stdlib.h>

void skf_far_collect(const far_job *j, size_t k) {
  const skf_far *f = j->far;
  const far_source *s = f->tree.source + k;
  double side = far_side(&f->tree, s->level), per = f->harmonic ? 1 / side : 2 / (FAR_WIDE * side);
  skf_far_moments(f->ops, &f->layout, f->harmonic, f->tree.pieces.at + s->first, s->count, j->elements,
                  far_center(&f->tree, s->level, s->at), per, side, 0.1 * j->accuracy, far_moments_of(j, k));
}

static void look_around(const far_job *j, int level, const int origin[3], far_block *b) {
  for (int z = 0; z < AROUND; z++)
    for (int y = 0; y < AROUND; y++)
      for (int x = 0; x < AROUND; x++) {
        int k = skf_far_tree_find(&j->far->tree, level, origin[0] + x - 2, origin[1] + y - 2, origin[2] + z - 2);
        b->source[z][y][x] = k < 0 ? NULL : far_moments_of(j, (size_t)k);
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

static void do_block(const far_job *j, int level, const member *m, size_t n) {
  far_block b;
  const int *origin = b.origin;
  for (int k = 0; k < 3; k++) b.origin[k] = m->block[k] * BLOCK;
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
  j->across(j, level, &b);
}

static skf_status do_level(const far_job *j, int level) {
  const far_tree *t = &j->far->tree;
  size_t from = t->target_level[level], n = t->target_level[level + 1] - from, blocks = 0;
  member *m = skf_alloc(n, sizeof *m);
  size_t *start = skf_alloc(n + 1, sizeof *start);
  if (m && start) {
    j->down(j, level);
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

static skf_status make(far_job *j, double *whole) {
  skf_far *f = j->far;
  const far_tree *t = &f->tree;
  skf_status s = t->levels < 2                             ? SKF_ERR_UNSUPPORTED
                 : j->elements->kernel.type == SKF_INVERSE ? skf_far_harmonics(j)
                                                           : skf_far_chebyshev(j);
  if (s) return s;
  f->tensors = skf_alloc(t->target_count * f->layout.size, sizeof(double));
  j->moments = skf_alloc(t->source_count * f->layout.size, sizeof(double));
  j->work = skf_alloc((size_t)omp_get_max_threads() * FAR_ROOM * f->layout.size + 8, sizeof(double));
  if (!f->tensors || !j->moments || !j->work) return SKF_ERR_NOMEM;
  j->room = j->work + (64 - (uintptr_t)j->work % 64) / sizeof(double);
  for (int level = t->levels - 1; level >= 0; level--) j->up(j, level);
  for (int level = 1; level < t->levels && !s; level++)
    s = j->ready(j, level) ? do_level(j, level) : SKF_ERR_UNSUPPORTED;
  memcpy(whole, j->moments, f->layout.size * sizeof *whole);
  return s;
}

skf_status skf_far_expand(skf_far *f, const skf_prepared *elements, double accuracy, double *whole) {
  far_job *j = skf_alloc(1, sizeof *j);
  if (!j) return SKF_ERR_NOMEM;
  *j = (far_job){.far = f, .elements = elements, .accuracy = accuracy};
  skf_status s = make(j, whole);
  if (f->harmonic) skf_far_harmonic_free_ways(f->harmonic);
  skf_free(j->mixture), skf_free(j->moments), skf_free(j->work), skf_free(j);
  return s;
}
