/* SPDX-License-Identifier: MIT */
/* Sources near leaves. Leaves next to each other have most of the cells around them in common: each cell's batch is
   added at once to all points that it is near to, a few hundred, for which the loops over a batch's elements pay best.
 */
#include "field/far_parts.h"
#include <limits.h>
#include <string.h>

/* Points of a bunch that see the same cell: runs, and how many in all. */
typedef struct seen {
  int runs;
  size_t n, from[FAR_LEAVES], count[FAR_LEAVES];
} seen;

static void add_run(seen *s, size_t from, size_t end) {
  if (s->runs && s->from[s->runs - 1] + s->count[s->runs - 1] == from)
    s->count[s->runs - 1] += end - from;
  else
    s->from[s->runs] = from, s->count[s->runs++] = end - from;
  s->n += end - from;
}

/* n of these points from the `skip`-th on, to q or back from there */
static void copy(const seen *s, size_t skip, bool back, far_bunch *b, far_points *q) {
  size_t done = 0;
  for (int r = 0; r < s->runs && done < q->n; r++) {
    if (skip >= s->count[r]) {
      skip -= s->count[r];
      continue;
    }
    size_t n = s->count[r] - skip < q->n - done ? s->count[r] - skip : q->n - done, from = s->from[r] + skip;
    size_t bytes = n * sizeof(double);
    for (int k = 0; k < 3 && !back; k++) memcpy(q->p[k] + done, b->p[k] + from, bytes);
    for (int k = 0; k < 4 && !back; k++) memcpy(q->sum.s[k] + done, b->s[k] + from, bytes);
    for (int k = 0; k < 4 && !back; k++) memcpy(q->sum.low[k] + done, b->low[k] + from, bytes);
    for (int k = 0; k < 4 && back; k++) memcpy(b->s[k] + from, q->sum.s[k] + done, bytes);
    for (int k = 0; k < 4 && back; k++) memcpy(b->low[k] + from, q->sum.low[k] + done, bytes);
    done += n, skip = 0;
  }
}

static size_t whole_vectors(size_t n) { return (n + SKF_BATCH_PAD - 1) / SKF_BATCH_PAD * SKF_BATCH_PAD; }

static void add_batch(const skf_batch *sources, const seen *s, far_bunch *b) {
  far_points q;
  const double *const p[3] = {q.p[0], q.p[1], q.p[2]};
  size_t parts = (s->n + SKF_BATCH - 1) / SKF_BATCH, each = whole_vectors((s->n + parts - 1) / parts);
  for (size_t from = 0; from < s->n; from += q.n) {
    q.n = s->n - from < each ? s->n - from : each, q.padded = whole_vectors(q.n);
    copy(s, from, false, b, &q);
    for (size_t i = q.n; i < q.padded; i++) {
      for (int k = 0; k < 3; k++) q.p[k][i] = q.p[k][q.n - 1];
      for (int k = 0; k < 4; k++) q.sum.s[k][i] = q.sum.low[k][i] = 0;
    }
    skf_batch_add(sources, q.n, q.padded, p, &q.sum, false);
    copy(s, from, true, b, &q);
  }
}

/* The least batch of those that leaves' lists have from at[leaf] on, UINT_MAX: none */
static unsigned least(const skf_far *f, const far_bunch *b, const size_t *at) {
  unsigned next = UINT_MAX;
  for (int i = 0; i < b->leaves; i++) {
    const far_leaf *l = f->leaf + b->leaf[i];
    if (at[i] < l->count && f->list[l->first + at[i]] < next) next = f->list[l->first + at[i]];
  }
  return next;
}

/* Asks for a batch that is added next. */
static inline __attribute__((always_inline)) void expect(const skf_batch *sources) {
  if (!sources->tiles) return;
  const skf_tile *last = sources->tile + sources->tiles - 1;
  const char *end = (const char *)(last + 1), *columns = (const char *)sources->columns;
  for (const char *a = (const char *)sources->tile; a < end; a += 64) __builtin_prefetch(a, 0, 2);
  if (!last->column) return;
  end = (const char *)(last->column + SKF_TILE * sources->ops->form[last->form].columns);
  for (const char *a = columns; a < end; a += 64) __builtin_prefetch(a, 0, 2);
}

/* Each leaf's list of batches ascends: they are added in that order to all leaves. */
void skf_far_near(const skf_far *f, far_bunch *b) {
  size_t at[FAR_LEAVES] = {0};
  for (unsigned next = least(f, b, at), after; next != UINT_MAX; next = after) {
    seen s;
    s.runs = 0, s.n = 0;
    for (int i = 0; i < b->leaves; i++) {
      const far_leaf *l = f->leaf + b->leaf[i];
      if (at[i] == l->count || f->list[l->first + at[i]] != next) continue;
      at[i]++;
      add_run(&s, b->from[i], b->from[i + 1]);
    }
    after = least(f, b, at);
    if (after != UINT_MAX) expect(f->batch + after);
    add_batch(f->batch + next, &s, b);
  }
}
