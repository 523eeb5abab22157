/* SPDX-License-Identifier: MIT */
/* The sides of a mesh's triangles, sorted by edge. */
#ifndef SKF_SURFACE_EDGES_H
#define SKF_SURFACE_EDGES_H

#include "core/alloc.h"
#include "skelfield/surface.h"

/* One side of a triangle: from corner `side % 3` of triangle `side / 3` to the next corner. */
typedef struct skf_side {
  unsigned lo, hi; /* its vertices, sorted */
  size_t side;
  bool forward; /* runs from lo to hi */
} skf_side;

/* All 3 n sides by (lo, hi, side); the caller frees them with skf_free. */
skf_status skf_sides_sorted(const skf_mesh *mesh, skf_side **out);

/* Disjoint sets over 0 .. n - 1. */
size_t skf_root_of(unsigned *parent, size_t i);
void skf_join(unsigned *parent, size_t a, size_t b);

#endif
