/* SPDX-License-Identifier: MIT */
/* Sums over some of a field's elements. */
#ifndef SKF_FIELD_SOME_H
#define SKF_FIELD_SOME_H

#include "field/kernel.h"
#include <stdint.h>

const skf_prepared *skf_field_prepared(const skf_field *field);

/* Value and gradient at p of n elements of a field; *size: the sum of their magnitudes. Plain sums: the rounding is
   that of n additions. */
double skf_field_some(const skf_field *field, const uint32_t *which, size_t n, skf_vec3 p, skf_vec3 *g, double *size);

#endif
