/* SPDX-License-Identifier: MIT */
/* How expansions are made: far_expand.c goes through the tree, far_chebyshev.c and far_harmonic_expand.c know what the
   coefficients are. */
#ifndef SKF_FIELD_FAR_JOB_H
#define SKF_FIELD_FAR_JOB_H

#include "field/far_parts.h"
#include <omp.h>
#include <string.h>

/* Targets are worked on in blocks of BLOCK^3, which share what their sources do along x and y. FAR_ROOM: tensors that a
   thread may work in. */
enum { BLOCK = 4, AROUND = BLOCK + 4, FAR_ROOM = 3 * AROUND + 2 };

/* A block's targets and the moments around them; -1, NULL: none. */
typedef struct far_block {
  int origin[3];
  int target[BLOCK][BLOCK][BLOCK];
  const double *source[AROUND][AROUND][AROUND]; /* [z][y][x], from two cells before the block */
  bool column[BLOCK], row[BLOCK][BLOCK];        /* whether any target is at [x], at [x][y] */
} far_block;

typedef struct far_job far_job;
struct far_job {
  skf_far *far;
  const skf_prepared *elements;
  double accuracy, *moments, *work, *room; /* room: where whole vectors begin in `work` */
  /* Moments of a level's sources from their pieces or their children; what the targets of a level get from their
     parents; makes ready for a level; what a block's targets get from the sources at a distance. */
  void (*up)(const far_job *j, int level);
  void (*down)(const far_job *j, int level);
  bool (*ready)(const far_job *j, int level);
  void (*across)(const far_job *j, int level, const far_block *b);
  far_mixture *mixture;
  far_matrix to_parent[2], to_child[2]; /* the lower and upper half of the parent */
};

/* Chooses the coefficients and sets far->layout. */
skf_status skf_far_chebyshev(far_job *j);
skf_status skf_far_harmonics(far_job *j);

static inline double *far_moments_of(const far_job *j, size_t k) { return j->moments + k * j->far->layout.size; }
static inline double *far_tensor_of(const far_job *j, size_t k) { return j->far->tensors + k * j->far->layout.size; }
static inline double *far_room(const far_job *j) {
  return j->room + (size_t)omp_get_thread_num() * FAR_ROOM * j->far->layout.size;
}

/* How many cells away the source `s` of the region is from target `t` of the block, FAR_SHIFTS when it is none of the
   children of the parent's neighbours. */
static inline int far_shift_of(int s, int t) {
  int shift = s - BLOCK / 2 - t;
  return shift >= (t % 2 ? -3 : -2) && shift <= (t % 2 ? 2 : 3) ? shift : FAR_SHIFTS;
}

/* The moments of a source without children. */
void skf_far_collect(const far_job *j, size_t source);

#endif
