/* SPDX-License-Identifier: MIT */
/* Lengths whose powers leave the range of doubles. */
#ifndef SKF_FIELD_EXTREME_H
#define SKF_FIELD_EXTREME_H

#include "field/kernel.h"

/* Every length of the element is within 1e-50 .. 1e50, or a coordinate that is smaller. */
bool skf_moderate(const skf_element *e);

/* What skf_element_value gives instead where the element or the point is not moderate, or the closed form is not
   finite: the field of everything times a power of two, of a point where the body is 1e-50 of the distance. No NaN for
   finite points: next to a singular set, where the gradient overflows on its way, F = +infinity and the rest 0. */
void skf_extreme_value(const skf_prepared *e, skf_vec3 x, int order, skf_value *v);

/* Every length times 2^power: places, radii, the kernel's parameter; neither strengths nor solids nor users' kernels.
 */
void skf_element_scale(skf_element *e, int power);
/* F of everything c times as large is c^this times F, the strength being the same. */
int skf_element_dimension(const skf_element *e);

#endif
