/* SPDX-License-Identifier: MIT */
/* Sums of elements at many points. Elements of one form are gathered in tiles, their constants side by side, so that a
   form may be evaluated with points as lanes (each constant broadcast) or with elements as lanes (constants loaded). */
#ifndef SKF_FIELD_BATCH_H
#define SKF_FIELD_BATCH_H

#include "field/batch_forms.h"
#include "field/some.h"
#include "field/sparse.h"
#include "simd/isa.h"

/* Points in a block; points are padded to SKF_BATCH_PAD, a multiple of every instruction set's lanes, as is SKF_TILE,
   the elements in a tile; constants of an element at most. */
enum { SKF_BATCH = 128, SKF_BATCH_PAD = 8, SKF_TILE = 8, SKF_ROW_MAX = 128 };

/* Up to SKF_TILE elements of one form. column: constant k of element j at [k * SKF_TILE + j], first the strength, or 1
   where the row has it; the last element is repeated with strength 0. NULL when there is no form. */
typedef struct skf_tile {
  skf_form form;
  size_t count;
  double *column;
  const skf_prepared *element[SKF_TILE];
  skf_box reach; /* outside of it all elements are 0; set in a sparse batch */
} skf_tile;

/* Sums over elements with their rounding errors kept apart: F and the gradient. */
typedef struct skf_batch_sum {
  double s[4][SKF_BATCH], low[4][SKF_BATCH];
} skf_batch_sum;

/* The same at one point, each lane of a tile for itself. */
typedef struct skf_point_sum {
  double s[4][SKF_TILE], low[4][SKF_TILE];
} skf_point_sum;

/* One form's loops. n is a multiple of SKF_BATCH_PAD. What comes out at a point depends on this point alone. */
typedef struct skf_batch_form {
  size_t columns;                                         /* constants of an element, strength included */
  double *(*pack)(const skf_prepared *e, double *column); /* writes them but the strength; returns the end */
  /* strength times F and the gradient of the tile's first element: out[0] = F, out[1..3] */
  void (*one)(const skf_tile *t, size_t n, const double *const p[3], double *const out[4]);
  /* adds all elements; first: the sum is not set yet */
  void (*add)(const skf_tile *t, size_t n, const double *const p[3], skf_batch_sum *sum, bool first);
  /* the same at one point, elements being lanes: with `exact` each element is added without loss to its lane's sum,
     else to lane 0 what `add` adds, so that it comes to the same bits */
  void (*at)(const skf_tile *t, skf_vec3 p, bool exact, skf_point_sum *sum);
  /* all there is to one point of a batch of this tile only, to the same bits: out[0] = F, out[1..3] */
  void (*lone)(const skf_tile *t, const skf_vec3 *p, double out[4]);
  /* the same in registers, from (x, y, z, 0) to the gradient and F: only for callers of the same instruction set */
  skf_four (*quick)(const skf_tile *t, skf_four p);
  bool inner; /* the strength is among the constants that `pack` writes, which saves products */
} skf_batch_form;

typedef struct skf_batch_ops {
  skf_batch_form form[SKF_FORM_COUNT]; /* zero: none */
  /* column k of the sum: infinities stay, and where F is not finite the gradient is 0 */
  void (*total)(size_t n, const skf_batch_sum *sum, int k, double *out);
} skf_batch_ops;

extern const skf_batch_ops skf_batch_scalar, skf_batch_avx2, skf_batch_avx512;

const skf_batch_ops *skf_batch_get(skf_isa isa);

/* The form of an element, SKF_FORM_COUNT when there is none. */
skf_form skf_batch_form_of(const skf_batch_ops *ops, const skf_prepared *e);

/* Tiles in a group */
enum { SKF_GROUP = 16 };

/* Elements in tiles, form after form; the elements must live as long. */
typedef struct skf_batch {
  const skf_batch_ops *ops;
  skf_tile *tile;
  size_t tiles, elements;
  double *columns;
  skf_box *group; /* the reach of each group; NULL unless tiles may be passed over */
} skf_batch;

skf_status skf_batch_new(const skf_batch_ops *ops, const skf_prepared *elements, size_t count, skf_batch *out);
void skf_batch_free(skf_batch *b);

/* Whether elements as lanes save time. */
static inline bool skf_batch_full(const skf_tile *t) { return t->column && t->count >= SKF_TILE / 4; }

/* F and the gradient at one point: out[0] = F, out[1..3]. With `exact` no sum loses anything, and tiles that are not
   full are left to the closed forms; without, the bits are those of skf_batch_eval. */
void skf_batch_at(const skf_batch *b, skf_vec3 p, bool exact, double out[4]);

/* F and the gradient at n points of structure-of-arrays form; any output may be NULL. */
void skf_batch_eval(const skf_batch *b, size_t n, const double *const p[3], double *F, double *const g[3]);
/* The same, to the same bits, in the order of the points and on the calling thread alone */
void skf_batch_serial(const skf_batch *b, size_t n, const double *const p[3], double *const out[4]);

/* Adds all tiles to a sum that is set, or sets it first; n points and what they are padded to. */
void skf_batch_add(const skf_batch *b, size_t n, size_t padded, const double *const p[3], skf_batch_sum *sum,
                   bool first);

#endif
