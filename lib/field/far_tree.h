/* SPDX-License-Identifier: MIT */
/* Two octrees over the same grid: cells that hold sources, and cells of targets. A cell of targets is split while the
   cells near it hold too many pieces, and with it those cells are, if sources are in them; so all cells that a cell of
   targets interacts with are there, and none has many pieces to sum one by one. */
#ifndef SKF_FIELD_FAR_TREE_H
#define SKF_FIELD_FAR_TREE_H

#include "core/vec3.h"
#include "field/far_piece.h"

enum { FAR_DEPTH = 18 };

/* Shifts of the cells near a cell: it and its 26 neighbours; for harmonics, which converge slowly there, also the six
   that are two cells away along one axis. */
enum { FAR_NEIGHBOURS = 27, FAR_NEAR = 33 };
extern const signed char skf_far_around[FAR_NEAR][3];

/* At level l the cube with all sources is 2^l cells wide, and the root is three such cubes wide; `at` counts from the
   root's corner. */
typedef struct far_source {
  int at[3], level;
  int child[8];        /* -1: none */
  bool split;          /* its pieces are with its children */
  size_t first, count; /* pieces in and below the cell */
} far_source;

typedef struct far_target {
  int at[3], level;
  int child; /* the first of eight, -1: none */
} far_target;

typedef struct far_tree {
  skf_vec3 lo;        /* corner of the cube with the sources */
  double side;        /* of the cube */
  int levels, around; /* `around`: how many cells are near */
  far_source *source;
  far_target *target;
  size_t source_count, source_capacity, target_count, target_capacity;
  size_t source_level[FAR_DEPTH + 2], target_level[FAR_DEPTH + 2]; /* where each level begins */
  far_pieces pieces;                                               /* in the order of the leaves */
  int *table;                                                      /* of sources by level and place */
  size_t table_size;
} far_tree;

/* `around`: FAR_NEIGHBOURS or FAR_NEAR; `near`: how many pieces a target may have there; at most `most` cells of
   targets. Cells of sources are split at least until their side is <= fine. False when memory is out or the sources are
   no cloud: all in one place, or too far from the origin for their extent. */
bool skf_far_tree_build(const skf_prepared *elements, size_t n, int around, size_t near, size_t most, double fine,
                        far_tree *out);
void skf_far_tree_free(far_tree *tree);

/* The cell of sources there, -1: none. */
int skf_far_tree_find(const far_tree *tree, int level, int x, int y, int z);

static inline double far_side(const far_tree *t, int level) { return ldexp(t->side, -level); }
static inline skf_vec3 far_center(const far_tree *t, int level, const int at[3]) {
  double s = far_side(t, level), whole = ldexp(1, level);
  return v3(t->lo.x + (at[0] + 0.5 - whole) * s, t->lo.y + (at[1] + 0.5 - whole) * s,
            t->lo.z + (at[2] + 0.5 - whole) * s);
}

#endif
