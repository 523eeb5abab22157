/* SPDX-License-Identifier: MIT */
/* Cells of fields that are smooth all around the surface. A branch keeps a polynomial of the elements that are far
   enough for it, and a list of the others; a leaf is a cell in which a polynomial is as good for all of them. */
#ifndef SKF_RAY_SMOOTH_H
#define SKF_RAY_SMOOTH_H

#include "ray/model.h"
#include <stdint.h>

/* F - iso in a leaf, by powers of (p - center) / half. */
typedef struct skf_patch {
  double c[SKF_TERMS];
  int degree;
  double per; /* 1 / half */
  skf_margin off;
  /* The terms of the first order, x, y, z, and of the second, xx, yy, zz and half of xy, xz, yz; what the others can
     amount to */
  double lean[3], bow[6], beyond;
} skf_patch;

/* What is known of a branch beside its place. */
typedef struct skf_far_part {
  skf_model model;
  uint32_t count;
  uint32_t list[]; /* the elements that are not in the model */
} skf_far_part;

typedef struct skf_smooth {
  const skf_field *field;
  const skf_source *sources;
  double iso, noise; /* noise: relative rounding of F */
  bool few;          /* elements are summed sooner than high powers */
  skf_chebyshev table;
} skf_smooth;

/* A cell: the cube of its model, slightly larger than itself; which child of the branch above; whether it must not be
   cut any more. */
typedef struct skf_smooth_cell {
  skf_vec3 center;
  double half;
  int child;
  bool last;
} skf_smooth_cell;

typedef enum skf_smooth_kind {
  SKF_SMOOTH_LOST, /* memory is out */
  SKF_SMOOTH_OUTSIDE,
  SKF_SMOOTH_INSIDE,
  SKF_SMOOTH_BARE, /* a last cell in which the field cannot be bounded */
  SKF_SMOOTH_LEAF,
  SKF_SMOOTH_BRANCH
} skf_smooth_kind;

/* Finds out what a cell is: *patch is set for a leaf; for a branch *model and the list kept[0..*keep), with room for
   above->count. */
skf_smooth_kind skf_smooth_examine(const skf_smooth *s, const skf_smooth_cell *cell, const skf_far_part *above,
                                   skf_patch *patch, skf_model *model, uint32_t *kept, uint32_t *keep);

#endif
