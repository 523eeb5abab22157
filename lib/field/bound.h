/* SPDX-License-Identifier: MIT */
/* Bounds of the field of one element in a ball; the ray and surface rooms build theirs on it. */
#ifndef SKF_FIELD_BOUND_H
#define SKF_FIELD_BOUND_H

#include "field/envelope.h"

/* Of strength times the primitive's field, weighted by its profile, in |p - center| <= radius; `fourth` is infinite
 * where a kink may be inside.
 */
skf_bound skf_element_bound(const skf_element *e, skf_vec3 center, double radius);

/* Suprema, over all p at a distance >= d from the primitive, of the primitive's field (strength 1, no profile) and its
   derivatives. Kinks are not looked for: see skf_kernel_kinked. */
skf_envelope skf_element_reach(const skf_element *e, double d);

/* Supremum of the primitive's field (strength 1, no profile) over all p with p . up >= height; `up` is along a
 * coordinate axis, of length 1. */
double skf_element_beyond(const skf_element *e, skf_vec3 up, double height);

#endif
