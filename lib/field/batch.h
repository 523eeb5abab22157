/* SPDX-License-Identifier: MIT */
/* One element at many points: the pairs that have a vector form, in one table for each instruction set. */
#ifndef SKF_FIELD_BATCH_H
#define SKF_FIELD_BATCH_H

#include "field/kernel.h"
#include "simd/isa.h"

/* Points at once; a multiple of every instruction set's lanes. */
enum { SKF_BATCH = 128, SKF_BATCH_PAD = 4 };

/* F and the gradient at n points, a multiple of SKF_BATCH_PAD up to SKF_BATCH: out[0] = F, out[1..3] the gradient,
   strength not in them. What comes out at a point depends on this point alone. Points where the vector form is not
   accurate (next to the body, on singular sets, out of range) are listed in `redo` for the closed form, their number is
   returned. */
typedef size_t (*skf_batch_fn)(const skf_prepared *e, size_t n, const double *const p[3], double *const out[4],
                               unsigned char *redo);

/* Sums over elements, with the rounding errors kept apart: F and the gradient. */
typedef struct skf_batch_sum {
  double s[4][SKF_BATCH], low[4][SKF_BATCH];
} skf_batch_sum;

typedef struct skf_batch_ops {
  skf_batch_fn pair[SKF_KERNEL_COUNT][SKF_SHAPE_COUNT]; /* NULL: the closed form at each point */
  void (*set)(size_t n, double strength, const double v[4][SKF_BATCH], skf_batch_sum *sum);
  void (*add)(size_t n, double strength, const double v[4][SKF_BATCH], skf_batch_sum *sum);
  void (*total)(size_t n, const skf_batch_sum *sum, int column, double *out);
} skf_batch_ops;

extern const skf_batch_ops skf_batch_scalar, skf_batch_avx2;

const skf_batch_ops *skf_batch_get(skf_isa isa);

/* F and the gradient of a sum of elements at n points of structure-of-arrays form; any output may be NULL. */
void skf_batch_eval(const skf_batch_ops *ops, const skf_prepared *elements, size_t count, size_t n,
                    const double *const p[3], double *F, double *const g[3]);

#endif
