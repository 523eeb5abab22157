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

/* Of the Hessian alone, without a profile, from how triangles and segments can fill the shells around p: INFINITY where
   that tells nothing. The triangle's is proportional to the angle in which it may be seen from within its plane. */
double skf_compact_bend(skf_shape shape, skf_kernel k, double d);

/* Supremum of the primitive's field (strength 1, no profile) over all p with p . up >= height; `up` is along a
 * coordinate axis, of length 1. */
double skf_element_beyond(const skf_element *e, skf_vec3 up, double height);

#endif
