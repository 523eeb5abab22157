/* SPDX-License-Identifier: MIT */
/* A point's cell, the cell's polynomial, and the elements around it. Points of a batch are sorted by cell, so that a
   cell's data are read once. */
#include "core/alloc.h"
#include "field/far_parts.h"
#include <omp.h>
#include <stdlib.h>
#include <string.h>

static size_t find_in_grid(const skf_far *f, skf_vec3 p) {
  const far_grid *g = &f->wide;
  size_t cell = 0;
  for (int k = 2; k >= 0; k--) {
    double u = (v3_get(p, k) - v3_get(g->lo, k)) / g->side;
    if (!(u >= 0 && u < g->width)) return f->leaves - 1;
    cell = cell * (size_t)g->width + (size_t)u;
  }
  return g->leaf[cell] ? g->leaf[cell] - 1 : f->leaves - 1;
}

/* The leaf that holds the point, the last one outside of the root. */
static size_t find(const skf_far *f, skf_vec3 p) {
  if (f->wide.width) return find_in_grid(f, p);
  const far_tree *t = &f->tree;
  long at[3];
  for (int k = 0; k < 3; k++) {
    double u = (v3_get(p, k) - v3_get(t->lo, k)) / t->side + 1;
    if (!(u >= 0 && u < 3)) return f->leaves - 1;
    at[k] = (long)ldexp(u, FAR_DEPTH);
  }
  size_t cell = (size_t)((at[0] >> FAR_DEPTH) + 3 * (at[1] >> FAR_DEPTH) + 9 * (at[2] >> FAR_DEPTH));
  for (int bit = FAR_DEPTH - 1; t->target[cell].child >= 0; bit--)
    cell = (size_t)(t->target[cell].child + ((at[0] >> bit & 1) | (at[1] >> bit & 1) << 1 | (at[2] >> bit & 1) << 2));
  return f->leaf_of[cell];
}

/* The harmonics' sum G at x / r^2 = u / r, x in sides of the cube, and its gradient there, make F = G / r and its own.
   No distance is squared: it may be anything. */
static void outside(const skf_far *f, const far_leaf *l, far_points *b, double u[3][SKF_BATCH]) {
  double r[SKF_BATCH], x[3][SKF_BATCH], out[4][SKF_BATCH];
  for (size_t i = 0; i < b->padded; i++) {
    r[i] = hypot(hypot(u[0][i], u[1][i]), u[2][i]);
    for (int k = 0; k < 3; k++) u[k][i] /= r[i], x[k][i] = u[k][i] / r[i];
  }
  f->ops->evaluate(f->harmonic, l->tensor, b->padded, 1, (const double(*)[SKF_BATCH])x, out);
  for (size_t i = 0; i < b->padded; i++) {
    double along = 0;
    for (int k = 0; k < 3; k++) along += out[1 + k][i] * u[k][i];
    double F = out[0][i] / r[i], by = l->per / r[i], turn = F + 2 * along / r[i] / r[i];
    b->sum.s[0][i] = F;
    for (int k = 0; k < 3; k++) b->sum.s[1 + k][i] = by * (out[1 + k][i] / r[i] / r[i] - turn * u[k][i]);
  }
}

/* What the leaf's expansion gives to n points, or the narrow sum. */
static void begin(const skf_far *f, const far_leaf *l, far_points *b) {
  b->padded = (b->n + SKF_BATCH_PAD - 1) / SKF_BATCH_PAD * SKF_BATCH_PAD;
  for (int k = 0; k < 3; k++)
    for (size_t i = b->n; i < b->padded; i++) b->p[k][i] = b->p[k][b->n - 1];
  memset(&b->sum, 0, sizeof b->sum);
  if (f->narrow && !l->tensor) skf_far_narrow_add(f, b);
  if (!l->tensor) return;
  double x[3][SKF_BATCH];
  for (int k = 0; k < 3; k++)
    for (size_t i = 0; i < b->padded; i++) x[k][i] = (b->p[k][i] - v3_get(l->center, k)) * l->per;
  const double(*at)[SKF_BATCH] = (const double(*)[SKF_BATCH])x;
  if (l->tensor == f->whole)
    outside(f, l, b, x);
  else if (f->harmonic)
    f->ops->evaluate(f->harmonic, l->tensor, b->padded, l->per, at, b->sum.s);
  else
    f->ops->local(&f->layout, l->tensor, b->padded, l->per, at, b->sum.s);
}

static void sum_bunch(const skf_far *f, far_bunch *b) {
  far_points q;
  for (int i = 0; i < b->leaves; i++)
    for (size_t from = b->from[i], end = b->from[i + 1]; from < end; from += q.n) {
      q.n = end - from < SKF_BATCH ? end - from : SKF_BATCH;
      for (int k = 0; k < 3; k++) memcpy(q.p[k], b->p[k] + from, q.n * sizeof(double));
      begin(f, f->leaf + b->leaf[i], &q);
      for (int k = 0; k < 4; k++) {
        memcpy(b->s[k] + from, q.sum.s[k], q.n * sizeof(double));
        memcpy(b->low[k] + from, q.sum.low[k], q.n * sizeof(double));
      }
    }
  if (!f->narrow) skf_far_near(f, b);
}

/* Column k of the sums */
static void total(const skf_far *f, const far_bunch *b, int k, double *out) {
  skf_batch_sum sum;
  for (size_t from = 0, end = b->from[b->leaves], n; from < end; from += n) {
    n = end - from < SKF_BATCH ? end - from : SKF_BATCH;
    for (int c = 0; c < 4; c++) {
      if (c && c != k) continue;
      memcpy(sum.s[c], b->s[c] + from, n * sizeof(double));
      memcpy(sum.low[c], b->low[c] + from, n * sizeof(double));
    }
    f->batch_ops->total(n, &sum, k, out + from);
  }
}

typedef struct job {
  const skf_far *far;
  const double *const *p;
  double *out[4];
  unsigned *leaf, *index; /* of each point; the points leaf by leaf */
} job;

/* Points from `from` on in the order of `index` */
static void do_bunch(const job *j, size_t from, size_t n) {
  far_bunch b;
  double v[FAR_POINTS];
  b.leaves = 0;
  for (size_t i = 0; i < n; i++) {
    size_t at = j->index[from + i], leaf = j->leaf[at];
    if (i == 0 || leaf != b.leaf[b.leaves - 1]) b.leaf[b.leaves] = leaf, b.from[b.leaves++] = i;
    for (int k = 0; k < 3; k++) b.p[k][i] = j->p[k][at];
  }
  b.from[b.leaves] = n;
  sum_bunch(j->far, &b);
  for (int k = 0; k < 4; k++) {
    if (!j->out[k]) continue;
    total(j->far, &b, k, v);
    for (size_t i = 0; i < n; i++) j->out[k][j->index[from + i]] += v[i];
  }
}

enum { CHUNK = 1 << 20 }; /* points sorted at once: 20 MB */

typedef struct run {
  unsigned from, n;
} run;

/* Sorts the points of a chunk by leaf and cuts them into bunches of `most` points; how many there are. */
static size_t sort(const job *j, size_t n, size_t most, unsigned *count, run *runs) {
  size_t leaves = j->far->leaves, bunches = 0, open = FAR_LEAVES;
  memset(count, 0, (leaves + 1) * sizeof *count);
  for (size_t i = 0; i < n; i++) count[j->leaf[i] + 1]++;
  for (size_t k = 0; k < leaves; k++) count[k + 1] += count[k];
  for (size_t k = 0; k < leaves; k++)
    for (unsigned from = count[k], take; from < count[k + 1]; from += take, open++) {
      if (open == FAR_LEAVES || runs[bunches - 1].n == most) runs[bunches++] = (run){from, 0}, open = 0;
      run *r = runs + bunches - 1;
      take = count[k + 1] - from < most - r->n ? count[k + 1] - from : (unsigned)most - r->n;
      r->n += take;
    }
  for (size_t i = 0; i < n; i++) j->index[count[j->leaf[i]]++] = (unsigned)i;
  return bunches;
}

/* Points in a bunch: so many that all threads have some */
static size_t bunch_size(size_t n) {
  size_t each = n / (8 * (size_t)omp_get_max_threads());
  return each < 32 ? 32 : each < FAR_POINTS ? each : FAR_POINTS;
}

static bool do_chunk(job *j, size_t n) {
  const skf_far *f = j->far;
  size_t most = bunch_size(n), runs_most = n / most + (n < f->leaves ? n : f->leaves) + 1;
  j->leaf = skf_alloc(2 * n + f->leaves + 1, sizeof *j->leaf), j->index = j->leaf + n;
  run *runs = skf_alloc(runs_most, sizeof *runs);
  bool ok = j->leaf && runs;
  if (ok) {
#pragma omp parallel for schedule(static) if (n > 1024)
    for (size_t i = 0; i < n; i++) j->leaf[i] = (unsigned)find(f, v3(j->p[0][i], j->p[1][i], j->p[2][i]));
    size_t bunches = sort(j, n, most, j->index + n, runs);
#pragma omp parallel for schedule(dynamic, 1) if (bunches > 1)
    for (size_t i = 0; i < bunches; i++) do_bunch(j, runs[i].from, runs[i].n);
  }
  skf_free(j->leaf), skf_free(runs);
  return ok;
}

static void do_one(const skf_far *f, skf_vec3 p, double out[4]) {
  far_bunch b; /* not cleared: it is large */
  b.leaves = 1, b.leaf[0] = find(f, p), b.from[0] = 0, b.from[1] = 1;
  b.p[0][0] = p.x, b.p[1][0] = p.y, b.p[2][0] = p.z;
  sum_bunch(f, &b);
  for (int k = 0; k < 4; k++) total(f, &b, k, out + k);
}

void skf_far_add(const skf_far *f, size_t n, const double *const p[3], double *F, double *const g[3]) {
  for (size_t from = 0; from < n; from += CHUNK) {
    const double *const q[3] = {p[0] + from, p[1] + from, p[2] + from};
    job j = {.far = f, .p = q, .out = {F ? F + from : NULL}};
    for (int k = 0; k < 3; k++) j.out[k + 1] = g && g[k] ? g[k] + from : NULL;
    size_t m = n - from < CHUNK ? n - from : CHUNK;
    if (m > 1 && do_chunk(&j, m)) continue;
#pragma omp parallel for schedule(static) if (m > 1)
    for (size_t i = 0; i < m; i++) { /* no memory to sort them: the same values, one by one */
      double out[4];
      do_one(f, v3(q[0][i], q[1][i], q[2][i]), out);
      for (int k = 0; k < 4; k++)
        if (j.out[k]) j.out[k][i] += out[k];
    }
  }
}

/* T, T', T'' */
static void polynomials(double x, int n, double T[3][FAR_ORDER]) {
  memset(T, 0, 3 * sizeof *T);
  T[0][0] = 1, T[0][1] = x, T[1][1] = 1;
  for (int i = 2; i < n; i++) {
    T[0][i] = 2 * x * T[0][i - 1] - T[0][i - 2];
    T[1][i] = 2 * T[0][i - 1] + 2 * x * T[1][i - 1] - T[1][i - 2];
    T[2][i] = 4 * T[1][i - 1] + 2 * x * T[2][i - 1] - T[2][i - 2];
  }
}

static void local_hessian(const skf_far *f, const far_leaf *l, skf_vec3 p, double h[6]) {
  static const int order[6][3] = {{2, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 2, 0}, {0, 1, 1}, {0, 0, 2}};
  double T[3][3][FAR_ORDER];
  int n = f->layout.order;
  for (int k = 0; k < 3; k++) polynomials((v3_get(p, k) - v3_get(l->center, k)) * l->per, n, T[k]);
  for (int m = 0; m < 6; m++) h[m] = 0;
  for (int a = 0; a < n; a++)
    for (int b = 0; a + b < n; b++) {
      const double *row = l->tensor + f->layout.row[a][b];
      double s[3] = {0, 0, 0};
      for (int c = 0; a + b + c < n; c++)
        for (int k = 0; k < 3; k++) s[k] += row[c] * T[2][k][c];
      for (int m = 0; m < 6; m++) h[m] += T[0][order[m][0]][a] * T[1][order[m][1]][b] * s[order[m][2]];
    }
  for (int m = 0; m < 6; m++) h[m] *= l->per * l->per;
}

/* Multiplies by (l - m)! (l + m)!, or divides. */
static void by_factorials(int order, bool divide, double *c) {
  for (int l = 0; l < order; l++)
    for (int m = 0; m <= l; m++) {
      double f = tgamma(l - m + 1) * tgamma(l + m + 1), by = divide ? 1 / f : f;
      c[far_cosine(l, m)] *= by;
      if (m) c[far_sine(l, m)] *= by;
    }
}

/* The coefficients' derivatives. */
static void harmonic_hessian(const skf_far *f, const far_leaf *l, skf_vec3 p, double h[6]) {
  enum { MOST = (FAR_DEGREES + 2) * (FAR_DEGREES + 2) };
  double R[MOST], c[MOST], once[MOST], twice[MOST], x[3], r = 1;
  const bool out = l->tensor == f->whole;
  const int n = f->harmonic->order, first = out ? n + 1 : n - 1, second = out ? n + 2 : n - 2;
  for (int k = 0; k < 3; k++) x[k] = (v3_get(p, k) - v3_get(l->center, k)) * l->per;
  if (out) {
    r = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    for (int k = 0; k < 3; k++) x[k] = x[k] / r / r;
  }
  skf_far_regular(second, x, R);
  memcpy(c, l->tensor, (size_t)(n * n) * sizeof *c);
  if (out) by_factorials(n, true, c), by_factorials(second, false, R);
  for (int i = 0, m = 0; i < 3; i++) {
    skf_far_derive(n, out, i, c, once);
    for (int k = i; k < 3; k++, m++) {
      double s = 0;
      skf_far_derive(first, out, k, once, twice);
      for (int a = 0; a < second * second; a++) s += twice[a] * R[a];
      h[m] = s * l->per * l->per / r;
    }
  }
}

void skf_far_value(const skf_far *f, skf_vec3 p, int order, skf_value *v) {
  double out[4];
  do_one(f, p, out);
  v->F += out[0];
  v->g = v3_add(v->g, v3(out[1], out[2], out[3]));
  if (order < 2) return;
  const far_leaf *l = f->leaf + find(f, p);
  double h[6] = {0};
  if (l->tensor && f->harmonic)
    harmonic_hessian(f, l, p, h);
  else if (l->tensor)
    local_hessian(f, l, p, h);
  if (f->narrow && !l->tensor) skf_far_narrow_hessian(f, p, h);
  for (size_t i = 0; i < l->count; i++) {
    const skf_batch *sources = f->batch + f->list[l->first + i];
    for (size_t t = 0; t < sources->tiles; t++)
      for (size_t k = 0; k < sources->tile[t].count; k++) {
        const skf_prepared *e = sources->tile[t].element[k];
        skf_value one = {.F = 0};
        skf_element_value(e, p, 2, &one);
        for (int m = 0; m < 6; m++) h[m] += e->strength * one.h[m];
      }
  }
  for (int m = 0; m < 6; m++) v->h[m] += h[m];
}
