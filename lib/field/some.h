/* SPDX-License-Identifier: MIT */
/* Fields for the rooms next door: sums over some of the elements, one point in a hurry. */
#ifndef SKF_FIELD_SOME_H
#define SKF_FIELD_SOME_H

#include "field/kernel.h"
#include "simd/isa.h"
#include <stdint.h>

const skf_prepared *skf_field_prepared(const skf_field *field);

/* Value and gradient at p of n elements of a field; *size: the sum of their magnitudes. Plain sums: the rounding is
   that of n additions. */
double skf_field_some(const skf_field *field, const uint32_t *which, size_t n, skf_vec3 p, skf_vec3 *g, double *size);

/* Many points at once on the calling thread, of fields without solids and far sums; outputs may be NULL. What comes out
   at a point depends on this point alone. */
bool skf_field_is_direct(const skf_field *field);
/* All elements, with the bits of skf_field_eval. */
void skf_field_serial(const skf_field *field, size_t points, const double *const p[3], double *const out[4]);
/* The value of n elements; allocates. */
skf_status skf_field_some_many(const skf_field *field, const uint32_t *which, size_t n, size_t points,
                               const double *const p[3], double *F);

/* A value and gradient, and the sum of the magnitudes of what the value is made of */
typedef struct skf_made {
  double F, size;
  skf_vec3 g;
} skf_made;

/* Where the field has the vector forms of its elements, for skf_field_some_eight; SKF_NOWHERE: of those without one. */
#define SKF_NOWHERE UINT32_MAX
void skf_field_places(const skf_field *field, uint32_t *place);
/* skf_field_some at eight points by vector forms, which all n elements must have. What comes out at a point depends on
   this point alone. */
void skf_field_some_eight(const skf_field *field, const uint32_t *place, const uint32_t *which, size_t n,
                          const skf_vec3 p[8], skf_made out[8]);

/* F and the gradient at one point, out[0] and out[1..3], with the bits of skf_field_eval; for callers that have one
   point at a time, and no time: a sum of up to eight elements of one form costs little more than its formula. */
void skf_field_point(const skf_field *field, const skf_vec3 *p, double out[4]);

/* The same without a way through memory where a call costs as much as the formula: a function of the tile and (x, y, z,
   0) that returns the gradient and F. */
typedef double skf_four __attribute__((vector_size(32)));
struct skf_tile;
typedef skf_four skf_quick(const struct skf_tile *tile, skf_four p);
/* That of a field, if it has one, for callers that are compiled for the instruction set `isa` (SKF_ISA_SCALAR: none),
   since these pass vectors each in its own way; else NULL. */
skf_quick *skf_field_quick(const skf_field *field, skf_isa isa, const struct skf_tile **tile);

#endif
