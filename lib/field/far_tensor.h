/* SPDX-License-Identifier: MIT */
/* Coefficients of products T_a(x) T_b(y) T_c(z) of total degree a + b + c < order, and the loops over them, compiled
   for each instruction set. Rows along c are padded to whole vectors; what is in the padding counts as well. */
#ifndef SKF_FIELD_FAR_TENSOR_H
#define SKF_FIELD_FAR_TENSOR_H

#include "field/batch.h"
#include "field/far_harmonic.h"

/* Doubles in a vector of these loops; points whose polynomials are added at once */
enum { FAR_PAD = 4, FAR_GATHER = 8 };

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

/* What a matrix is applied to: one cell's tensor; those of the cells at a shift and at its opposite, whose matrix
   differs in the sign where i + j is odd; that of the cell at shift 0, whose matrix is 0 there. */
typedef enum far_mode { FAR_ONE, FAR_TWO, FAR_SAME, FAR_MODES } far_mode;

typedef struct far_ops {
  /* out += the matrix along the axis applied to in, total degrees < order; along the last axis FAR_ONE only */
  void (*along[3][FAR_MODES])(const far_layout *l, int order, const far_matrix *m, const double *in,
                              const double *mirror, double *out);
  /* out += products of the polynomials at points; their weights are in x[0] */
  void (*points)(const far_layout *l, double x[3][FAR_GATHER][FAR_ORDER + FAR_PAD], double *out);
  /* F and the gradient of a tensor at n points, a multiple of FAR_PAD up to SKF_BATCH, x in the cube [-1, 1]^3; `per`
     is dx/dp */
  void (*local)(const far_layout *l, const double *tensor, size_t n, double per, const double x[3][SKF_BATCH],
                double out[4][SKF_BATCH]);

  /* The same for solid harmonics: the first n <= FAR_GROUP of `from` times `by` are carried over and added to those of
     `to`; room: 16 times as much as a tensor. */
  void (*transfer)(const far_move *m, far_kind kind, double by, int n, const double *const from[FAR_GROUP],
                   double *const to[FAR_GROUP], double *room);
  /* FAR_OVER from `from[0]`, and from `from[1]` that are as far on the opposite side of the targets; room: 24 times as
     much as a tensor. */
  void (*transfer_both)(const far_move *m, double by, int n, const double *const from[2][FAR_GROUP],
                        double *const to[FAR_GROUP], double *room);
  /* out += R at points, x[3]: their weights */
  void (*gather)(const far_harmonic *h, const double x[4][FAR_GATHER], double *out);
  void (*evaluate)(const far_harmonic *h, const double *tensor, size_t n, double per, const double x[3][SKF_BATCH],
                   double out[4][SKF_BATCH]);
} far_ops;

extern const far_ops skf_far_scalar, skf_far_avx2;

#endif
