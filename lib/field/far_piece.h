/* SPDX-License-Identifier: MIT */
/* Pieces of primitives, each small enough for a cell. */
#ifndef SKF_FIELD_FAR_PIECE_H
#define SKF_FIELD_FAR_PIECE_H

#include "field/far_tensor.h"

typedef struct far_piece {
  skf_primitive primitive;
  size_t element;
} far_piece;

typedef struct far_pieces {
  far_piece *at;
  size_t count, capacity;
} far_pieces;

/* False when memory is out. */
bool skf_far_piece_add(far_pieces *list, const far_piece *piece);

/* Cuts a primitive that reaches to both sides of the plane x[axis] = where. Returns how many parts there are, at most
   three; 0 where it cannot be cut. */
int skf_far_piece_cut(const skf_primitive *p, int axis, double where, skf_primitive parts[3]);

/* Adds the elements' strengths times the integrals of the polynomials, or of the harmonics R if there are any, over n
   pieces of them, x = per (q - center), to a relative error of the field of `accuracy` at all distances >= gap. */
void skf_far_moments(const far_ops *ops, const far_layout *l, const far_harmonic *harmonic, const far_piece *piece,
                     size_t n, const skf_prepared *elements, skf_vec3 center, double per, double gap, double accuracy,
                     double *tensor);

#endif
