/* SPDX-License-Identifier: MIT */
/* A point's cell, the cell's polynomial, and the elements around it. Points of a batch are sorted by cell, so that a
   cell's data are read once. */
#include "core/alloc.h"
#include "field/far_parts.h"
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* The leaf that holds the point, the last one outside of the root. */
static size_t find(const skf_far *f, skf_vec3 p) {
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

static void sum_block(const skf_far *f, size_t leaf, far_points *b) {
  const far_leaf *l = f->leaf + leaf;
  b->padded = (b->n + SKF_BATCH_PAD - 1) / SKF_BATCH_PAD * SKF_BATCH_PAD;
  for (int k = 0; k < 3; k++)
    for (size_t i = b->n; i < b->padded; i++) b->p[k][i] = b->p[k][b->n - 1];
  if (l->tensor) {
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
    for (int k = 0; k < 4; k++) memset(b->sum.low[k], 0, b->padded * sizeof(double));
  } else
    memset(&b->sum, 0, sizeof b->sum);
  if (f->narrow) return skf_far_narrow_add(f, b);
  const double *const p[3] = {b->p[0], b->p[1], b->p[2]};
  for (size_t i = 0; i < l->count; i++)
    skf_batch_add(f->batch + f->list[l->first + i], b->n, b->padded, p, &b->sum, false);
}

typedef struct job {
  const skf_far *far;
  const double *const *p;
  double *out[4];
} job;

/* Points from `from` on in the order of `index`, NULL: as they are. */
static void do_block(const job *j, size_t leaf, const unsigned *index, size_t from, size_t n) {
  far_points b = {.n = n};
  double v[SKF_BATCH];
  for (int k = 0; k < 3; k++)
    for (size_t i = 0; i < n; i++) b.p[k][i] = j->p[k][index ? index[from + i] : from + i];
  sum_block(j->far, leaf, &b);
  for (int k = 0; k < 4; k++) {
    if (!j->out[k]) continue;
    j->far->batch_ops->total(n, &b.sum, k, v);
    for (size_t i = 0; i < n; i++) j->out[k][index ? index[from + i] : from + i] += v[i];
  }
}

enum { CHUNK = 1 << 20 }; /* points sorted at once: 20 MB */

typedef struct run {
  unsigned leaf, from, n;
} run;

/* Sorts the points of a chunk by leaf and cuts them into blocks; how many there are. */
static size_t sort(const skf_far *f, size_t n, unsigned *leaf, unsigned *index, unsigned *count, run *runs) {
  size_t blocks = 0;
  memset(count, 0, (f->leaves + 1) * sizeof *count);
  for (size_t i = 0; i < n; i++) count[leaf[i] + 1]++;
  for (size_t k = 0; k < f->leaves; k++) count[k + 1] += count[k];
  for (size_t k = 0; k < f->leaves; k++)
    for (unsigned from = count[k]; from < count[k + 1]; from += SKF_BATCH) {
      unsigned left = count[k + 1] - from;
      runs[blocks++] = (run){(unsigned)k, from, left < SKF_BATCH ? left : SKF_BATCH};
    }
  for (size_t i = 0; i < n; i++) index[count[leaf[i]]++] = (unsigned)i;
  return blocks;
}

static bool do_chunk(const job *j, size_t n) {
  const skf_far *f = j->far;
  size_t most = n / SKF_BATCH + (n < f->leaves ? n : f->leaves);
  unsigned *leaf = skf_alloc(2 * n + f->leaves + 1, sizeof *leaf), *index = leaf + n;
  run *runs = skf_alloc(most, sizeof *runs);
  bool ok = leaf && runs;
  if (ok) {
#pragma omp parallel for schedule(static) if (n > 1024)
    for (size_t i = 0; i < n; i++) leaf[i] = (unsigned)find(f, v3(j->p[0][i], j->p[1][i], j->p[2][i]));
    size_t blocks = sort(f, n, leaf, index, index + n, runs);
#pragma omp parallel for schedule(dynamic, 1) if (blocks > 1)
    for (size_t i = 0; i < blocks; i++) do_block(j, runs[i].leaf, index, runs[i].from, runs[i].n);
  }
  skf_free(leaf), skf_free(runs);
  return ok;
}

void skf_far_add(const skf_far *f, size_t n, const double *const p[3], double *F, double *const g[3]) {
  for (size_t from = 0; from < n; from += CHUNK) {
    const double *const q[3] = {p[0] + from, p[1] + from, p[2] + from};
    job j = {f, q, {F ? F + from : NULL, NULL, NULL, NULL}};
    for (int k = 0; k < 3; k++) j.out[k + 1] = g && g[k] ? g[k] + from : NULL;
    size_t m = n - from < CHUNK ? n - from : CHUNK;
    if (m > 1 && do_chunk(&j, m)) continue;
#pragma omp parallel for schedule(static) if (m > 1)
    for (size_t i = 0; i < m; i++) /* no memory to sort them: the same values, one by one */
      do_block(&j, find(f, v3(q[0][i], q[1][i], q[2][i])), NULL, i, 1);
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
  far_points b = {.n = 1, .p = {{p.x}, {p.y}, {p.z}}};
  size_t leaf = find(f, p);
  double out[4];
  sum_block(f, leaf, &b);
  for (int k = 0; k < 4; k++) f->batch_ops->total(1, &b.sum, k, out + k);
  v->F += out[0];
  v->g = v3_add(v->g, v3(out[1], out[2], out[3]));
  if (order < 2) return;
  const far_leaf *l = f->leaf + leaf;
  double h[6] = {0};
  if (l->tensor && f->harmonic)
    harmonic_hessian(f, l, p, h);
  else if (l->tensor)
    local_hessian(f, l, p, h);
  if (f->narrow) skf_far_narrow_hessian(f, p, h);
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
