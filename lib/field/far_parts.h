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

/* Gaussians exp(-s^2 r^2), without expansions: what a cell of sources has, and each piece, in a ball. `weight`: log of
   the integral of |strength|. */
typedef struct far_narrow {
  double weight;
  skf_box box;
  size_t first, count; /* of the pieces, where the cell has no children */
} far_narrow;

typedef struct far_ball {
  double weight, radius;
  skf_vec3 center;
} far_ball;

/* Wide Gaussians: a grid of cells of targets, width 0: none. leaf: 0, or one more than the tensor's number. */
typedef struct far_grid {
  int width; /* cells along each axis */
  double side;
  skf_vec3 lo;
  unsigned *leaf;
  size_t count;
} far_grid;

/* Points, to which one batch after the other is added */
typedef struct far_points {
  size_t n, padded;
  double p[3][SKF_BATCH];
  skf_batch_sum sum;
} far_points;

/* Points of some leaves, leaf after leaf, so that neighbours' sources are read once: those of the i-th leaf are from[i]
   to from[i + 1] - 1. */
enum { FAR_POINTS = 512, FAR_LEAVES = 16 };
typedef struct far_bunch {
  int leaves;
  size_t leaf[FAR_LEAVES], from[FAR_LEAVES + 1];
  double p[3][FAR_POINTS], s[4][FAR_POINTS], low[4][FAR_POINTS];
} far_bunch;

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
  far_narrow *narrow; /* of each cell of sources; NULL: there are expansions */
  far_ball *ball;     /* of each piece */
  double s2, limit;   /* s^2; log of the accuracy over the whole's weight */
  far_grid wide;      /* Gaussians that have polynomials */
};

/* The tree is there; fills tensors and the whole's moments (layout.size). */
skf_status skf_far_expand(skf_far *far, const skf_prepared *elements, double accuracy, double *whole);

/* Adds to each point the sources around its leaf, always in the same order. */
void skf_far_near(const skf_far *far, far_bunch *b);

/* What Gaussian cells hold; whether it saves anything to pass over some. */
skf_status skf_far_narrow(skf_far *far, const skf_prepared *elements, double accuracy);
bool skf_far_narrow_pays(const skf_far *far);
/* Polynomials of wide Gaussians, in at most `most` bytes, after skf_far_narrow. UNSUPPORTED: they are not wide. */
skf_status skf_far_wide(skf_far *far, const skf_prepared *elements, double accuracy, size_t most);
/* The side of cells of sources that they take, INFINITY where the elements are not wide. */
double skf_far_wide_side(const skf_prepared *elements, size_t n, double accuracy);
/* Adds what matters at each point to its sum; at one point, to the Hessian. */
void skf_far_narrow_add(const skf_far *far, far_points *points);
void skf_far_narrow_hessian(const skf_far *far, skf_vec3 p, double h[6]);

#endif
