/* SPDX-License-Identifier: MIT */
/* Sums of many elements of finite support: neighbours come side by side, and tiles out of reach, which would add
   nothing, not in the last bit, are passed over. */
#ifndef SKF_FIELD_SPARSE_H
#define SKF_FIELD_SPARSE_H

#include "core/vec3.h"
#include "field/kernel.h"
#include <stdint.h>

/* Fewer elements of finite support are not worth it. */
enum { SKF_SPARSE_LEAST = 64 };

/* A place in a list, and its place along a curve that fills space. */
typedef struct skf_sparse_key {
  uint64_t code;
  size_t index;
} skf_sparse_key;

/* Where e is not exactly 0: everywhere unless its support is finite. */
skf_box skf_sparse_reach(const skf_prepared *e);

/* Sorts n keys by code, then by index. */
void skf_sparse_sort(skf_sparse_key *keys, size_t n);
/* The place of p in the box; 0 where that has no answer. */
uint64_t skf_sparse_code(skf_vec3 p, const skf_box *box);

/* n keys in the order in which the elements are to be gathered: their own unless `sorted` is asked for and tiles may be
   passed over, which goes to *sparse. NULL: out of memory. */
skf_sparse_key *skf_sparse_order(const skf_prepared *elements, size_t n, bool sorted, bool *sparse);

/* False where NaN leaves it open. */
static inline bool skf_sparse_apart(const skf_box *a, const skf_box *b) {
  return a->lo.x > b->hi.x || a->lo.y > b->hi.y || a->lo.z > b->hi.z || a->hi.x < b->lo.x || a->hi.y < b->lo.y ||
         a->hi.z < b->lo.z;
}

/* How much of a box is within reach */
double skf_sparse_share(const skf_box *reach, const skf_box *box);

/* The box of n points; all of space when one of them is not finite. */
skf_box skf_sparse_around(size_t n, const double *const p[3]);

#endif
