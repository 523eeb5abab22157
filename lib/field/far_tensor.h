/* SPDX-License-Identifier: MIT */
/* Coefficients of products T_a(x) T_b(y) T_c(z) of total degree a + b + c < order, and the loops over them, compiled
   for each instruction set. Rows along c are padded to whole vectors; what is in the padding counts as well. */
#ifndef SKF_FIELD_FAR_TENSOR_H
#define SKF_FIELD_FAR_TENSOR_H

#include "field/batch.h"
#include "field/far_mixture.h"

/* Doubles in a vector of these loops */
enum { FAR_PAD = 4 };

typedef struct far_layout {
  int order;
  size_t size;                              /* of a tensor */
  unsigned short row[FAR_ORDER][FAR_ORDER]; /* where c = 0 is, a + b < order */
} far_layout;

static inline far_layout far_layout_new(int order) {
  far_layout l = {.order = order};
  for (int a = 0; a < order; a++)
    for (int b = 0; a + b < order; b++) {
      l.row[a][b] = (unsigned short)l.size;
      l.size += (size_t)(order - a - b + FAR_PAD - 1) / FAR_PAD * FAR_PAD;
    }
  return l;
}

typedef struct far_ops {
  /* out += the matrix along the axis applied to in, total degrees < order */
  void (*along[3])(const far_layout *l, int order, const far_matrix *m, const double *in, double *out);
  /* F and the gradient of a tensor at n points, a multiple of FAR_PAD up to SKF_BATCH, x in the cube [-1, 1]^3; `per`
     is dx/dp */
  void (*local)(const far_layout *l, const double *tensor, size_t n, double per, const double x[3][SKF_BATCH],
                double out[4][SKF_BATCH]);
} far_ops;

extern const far_ops skf_far_scalar, skf_far_avx2;

#endif
