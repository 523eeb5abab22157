/* SPDX-License-Identifier: MIT */
/* A cube around a bounded surface, cut into cells until each is certified to lie outside or inside of it, or the
   surface is nearly flat in it. Rays pass the first two kinds at once; in the third the field's bounds are known
   beforehand, and so are the elements that reach it. Cells are examined when the first ray comes to them. What is found
   there depends on the cell alone, so that neither the order of rays nor the number of threads changes a hit. */
#ifndef SKF_RAY_OCTREE_H
#define SKF_RAY_OCTREE_H

#include "ray/source.h"
#include <stdint.h>

/* A cell that the surface may pass. Within its ball, to rounding: |F - iso - f - g . (p - center)| <= flat; |grad F| <=
   slope, |Hess F| <= bend, |F''''| <= fourth. */
typedef struct skf_leaf {
  skf_vec3 center, g;
  double f, flat;
  double slope, bend, fourth;
  const uint32_t *list; /* the elements in reach */
  uint32_t count;
} skf_leaf;

typedef struct skf_octree skf_octree;

/* For sources of which none is a plane, the i-th made from the i-th element, whose surface F = iso is inside `region`;
   all but the region is borrowed. `noise`: relative rounding of F. */
skf_status skf_octree_new(const skf_field *field, const skf_source *sources, size_t n, double iso, double noise,
                          skf_box region, skf_octree **out);
void skf_octree_free(skf_octree *tree);

/* What a cell is; the branch or the leaf when it is one. SKF_CELL_UNKNOWN: memory is out. */
typedef enum skf_cell_kind {
  SKF_CELL_UNKNOWN,
  SKF_CELL_OUTSIDE,
  SKF_CELL_INSIDE,
  SKF_CELL_BRANCH,
  SKF_CELL_LEAF
} skf_cell_kind;

typedef struct skf_branch skf_branch;
typedef struct skf_cell {
  skf_cell_kind kind;
  union {
    const skf_leaf *leaf;
    skf_branch *branch;
  };
} skf_cell;

/* The whole cube. */
skf_cell skf_octree_root(skf_octree *tree, skf_vec3 *lo, double *size);
/* One of the eight cells of a branch: bits 1, 2, 4 of `k` for the upper halves in x, y, z; `lo` and `size` are its own.
 */
skf_cell skf_octree_child(skf_octree *tree, skf_branch *branch, int k, const double lo[3], double size);

/* Edge of the smallest cells. */
double skf_octree_least(const skf_octree *tree);

#endif
