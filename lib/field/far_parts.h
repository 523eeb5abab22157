/* SPDX-License-Identifier: MIT */
/* What far_build.c makes and far.c reads. */
#ifndef SKF_FIELD_FAR_PARTS_H
#define SKF_FIELD_FAR_PARTS_H

#include "field/far.h"
#include "field/far_tree.h"

/* A cell of targets without children, and the batches of sources around it: batch[list[first]] ... */
typedef struct far_leaf {
  skf_vec3 center;
  double per; /* coordinates of the polynomials per length */
  const double *tensor;
  size_t first, count;
} far_leaf;

struct skf_far {
  far_layout layout;
  far_harmonic *harmonic; /* NULL: the tensors are of polynomials */
  double *whole;          /* with harmonics, of all that is outside */
  const far_ops *ops;
  const skf_batch_ops *batch_ops;
  far_tree tree;
  double *tensors;        /* of all targets */
  skf_prepared *prepared; /* the pieces, then the weighted points for what is outside */
  size_t prepared_count;
  skf_batch *batch; /* of each cell of sources without children; the last one: the weighted points */
  size_t batches;
  unsigned *list, *leaf_of; /* leaf_of: of each target */
  far_leaf *leaf;           /* the last one stands for all that is outside */
  size_t leaves, list_count;
};

/* The tree is there; fills tensors and the whole's moments (layout.size). */
skf_status skf_far_expand(skf_far *far, const skf_prepared *elements, double accuracy, double *whole);

#endif
