/* SPDX-License-Identifier: MIT */
/* Decreasing functions of r that stay above a kernel and its derivatives. */
#ifndef SKF_FIELD_ENVELOPE_H
#define SKF_FIELD_ENVELOPE_H

#include "skelfield/field.h"

/* A field of the same elements with the opposite strengths, to be freed. */
skf_status skf_field_negative(const skf_field *field, skf_field **out);

skf_envelope skf_kernel_envelope(skf_kernel kernel, double a);

/* The same for an infinite plane of sources, whose field depends on the distance z alone: suprema over z >= a of F (for
   inverse and inverse-squared: F(a)), |F'|, |F''|, |F''''|. */
skf_envelope skf_plane_envelope(skf_kernel kernel, double a);

/* Whether a derivative of h up to the fourth jumps for some r in [a, b] (b = INFINITY is fine). */
bool skf_kernel_kinked(skf_kernel kernel, double a, double b);

/* Length over which h changes: 1/s, 1/a, R, a user's; 0 for the kernels without a scale. */
double skf_kernel_width(skf_kernel kernel);

#endif
