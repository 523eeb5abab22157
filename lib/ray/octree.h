/* SPDX-License-Identifier: MIT */
/* A cube around a bounded surface, cut into cells until each is certified to lie outside or inside of it, or the
   surface is nearly flat in it. Rays pass the first two kinds at once; in the third the field's bounds are known
   beforehand, and so are the elements that reach it. Cells are examined when the first ray comes to them. What is found
   there depends on the cell alone, so that neither the order of rays nor the number of threads changes a hit. */
#ifndef SKF_RAY_OCTREE_H
#define SKF_RAY_OCTREE_H

#include "ray/blob.h"
#include "ray/smooth.h"
#include <stdatomic.h>
#include <stdint.h>

/* Blobs in a leaf at most. */
enum { SKF_LEAF_BLOBS = 16 };

/* A cell that the surface may pass. Within it, to rounding: |grad F| <= slope, |Hess F| <= bend, |F''''| <= fourth, and
   where there are no blobs |F - iso - f - g . (p - center)| <= flat. */
typedef struct skf_leaf {
  skf_vec3 center, g;
  double f, flat;
  double slope, bend, fourth;
  const uint32_t *list; /* the elements in reach */
  uint32_t count;
  bool soft, segments;    /* a blob has c3; one is a segment */
  const skf_blob *blobs;  /* the same elements, or NULL where one of them is none */
  const skf_patch *patch; /* or NULL */
  double grain;           /* by which rounding may change F along a ray, but for the rounding of places */
} skf_leaf;

typedef struct skf_octree skf_octree;

/* For sources of which none is a plane, the i-th source and blob made from the i-th element, whose surface F = iso is
   inside `region`; all but the region is borrowed. `noise`: relative rounding of F. */
skf_status skf_octree_new(const skf_field *field, const skf_source *sources, const skf_blob *blobs, size_t n,
                          double iso, double noise, skf_box region, skf_octree **out);
void skf_octree_free(skf_octree *tree);

/* A cell is a pointer to a leaf or a branch with its kind in the low bits, or its kind alone; 0: not examined yet, or
   memory was out. */
enum { SKF_CELL_OUTSIDE = 1, SKF_CELL_INSIDE, SKF_CELL_BRANCH, SKF_CELL_LEAF, SKF_CELL_BLOBS, SKF_CELL_KIND = 7 };
typedef uintptr_t skf_cell;

typedef struct skf_branch {
  _Atomic(skf_cell) child[8]; /* bits 1, 2, 4 for the upper halves in x, y, z */
  atomic_uint outside;        /* a bit for each child that is known to be outside */
  skf_vec3 middle;
  double half;        /* edge of its children */
  double slope, bend; /* of F in all of them */
  const uint32_t *list;
  uint32_t count;
  int level;
  const skf_far_part *far; /* of smooth fields */
} skf_branch;

static inline bool skf_cell_is_leaf(skf_cell c) {
  return (c & SKF_CELL_KIND) == SKF_CELL_LEAF || (c & SKF_CELL_KIND) == SKF_CELL_BLOBS;
}
static inline const skf_leaf *skf_cell_leaf(skf_cell c) { return (const skf_leaf *)(c & ~(skf_cell)SKF_CELL_KIND); }
static inline skf_branch *skf_cell_branch(skf_cell c) { return (skf_branch *)(c - SKF_CELL_BRANCH); }

/* The branch whose child 0 is the whole cube. */
skf_branch *skf_octree_top(const skf_octree *tree);
skf_cell skf_octree_explore(skf_octree *tree, skf_branch *branch, int k);

static inline skf_cell skf_octree_child(skf_octree *tree, skf_branch *branch, int k) {
  skf_cell c = atomic_load_explicit(branch->child + k, memory_order_acquire);
  return c ? c : skf_octree_explore(tree, branch, k);
}

/* What is known of F in a ball. */
typedef struct skf_outlook {
  double lo, hi;              /* of F */
  double slope, bend, fourth; /* upper bounds of |grad F|, |Hess F|, |F''''| */
} skf_outlook;

/* Adds what the i-th element can be within `radius` of c; returns whether it is in reach. */
bool skf_octree_add(const skf_octree *tree, uint32_t i, skf_vec3 c, double radius, skf_outlook *o);

/* -1 or 1: beyond the cube everything is outside, or inside, of the surface. */
int skf_octree_beyond(const skf_octree *tree);

/* Of smooth fields. */
const skf_chebyshev *skf_octree_table(const skf_octree *tree);

/* Edge of the smallest cells. */
double skf_octree_least(const skf_octree *tree);

#endif
