/* SPDX-License-Identifier: MIT */
/* Sums of elements at many points: blocks of points, and for each block one element after the other. */
#include "field/batch.h"
#include <omp.h>
#include <string.h>

typedef struct job {
  const skf_batch_ops *ops;
  const skf_prepared *elements;
  size_t count;
  const double *const *p;
  double *F, *const *g;
} job;

static void at_point(const skf_prepared *e, const double *const p[3], size_t i, double v[4][SKF_BATCH]) {
  skf_value value = {.F = 0};
  skf_element_value(e, v3(p[0][i], p[1][i], p[2][i]), 1, &value);
  v[0][i] = value.F, v[1][i] = value.g.x, v[2][i] = value.g.y, v[3][i] = value.g.z;
}

/* n points; where they are padded, `padded` is their number with the padding. */
static void add_element(const job *j, const skf_prepared *e, size_t n, size_t padded, const double *const p[3],
                        skf_batch_sum *sum) {
  double v[4][SKF_BATCH], *const out[4] = {v[0], v[1], v[2], v[3]};
  skf_batch_fn form = j->ops->pair[e->kernel.type][e->primitive.shape];
  if (form) {
    unsigned char redo[SKF_BATCH];
    size_t bad = form(e, padded, p, out, redo);
    for (size_t i = 0; i < bad; i++)
      if (redo[i] < n) at_point(e, p, redo[i], v);
  } else
    for (size_t i = 0; i < n; i++) at_point(e, p, i, v);
  (e == j->elements ? j->ops->set : j->ops->add)(n, e->strength, v, sum);
}

static void block(const job *j, size_t from, size_t n) {
  skf_batch_sum sum;
  double pad[3][SKF_BATCH];
  const double *p[3] = {j->p[0] + from, j->p[1] + from, j->p[2] + from};
  size_t padded = (n + SKF_BATCH_PAD - 1) / SKF_BATCH_PAD * SKF_BATCH_PAD;
  for (int k = 0; k < 3 && padded > n; k++) { /* the last point again */
    memcpy(pad[k], p[k], n * sizeof(double));
    for (size_t i = n; i < padded; i++) pad[k][i] = p[k][n - 1];
    p[k] = pad[k];
  }
  if (j->count == 0) memset(&sum, 0, sizeof sum);
  for (size_t i = 0; i < j->count; i++) add_element(j, j->elements + i, n, padded, p, &sum);
  if (j->F) j->ops->total(n, &sum, 0, j->F + from);
  for (int k = 0; j->g && k < 3; k++)
    if (j->g[k]) j->ops->total(n, &sum, k + 1, j->g[k] + from);
}

void skf_batch_eval(const skf_batch_ops *ops, const skf_prepared *elements, size_t count, size_t n,
                    const double *const p[3], double *F, double *const g[3]) {
  job j = {ops, elements, count, p, F, g};
  if (n * count < 2048) { /* waking threads would cost more than the work, even to find one thread only: 0.4 us */
    for (size_t from = 0; from < n; from += SKF_BATCH) block(&j, from, n - from < SKF_BATCH ? n - from : SKF_BATCH);
    return;
  }
  /* blocks for every thread; their size changes no result */
  size_t share = n / (2 * (size_t)omp_get_max_threads()) / SKF_BATCH_PAD * SKF_BATCH_PAD;
  size_t step = share < SKF_BATCH_PAD ? SKF_BATCH_PAD : share < SKF_BATCH ? share : SKF_BATCH;
#pragma omp parallel for schedule(static)
  for (size_t from = 0; from < n; from += step) block(&j, from, n - from < step ? n - from : step);
}
