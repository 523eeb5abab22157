/* SPDX-License-Identifier: MIT */
/* Private to triangle_gaussian*.c. */
#ifndef SKF_FIELD_TRIANGLE_GAUSSIAN_H
#define SKF_FIELD_TRIANGLE_GAUSSIAN_H

#include "field/triangle_parts.h"

/* int exp(-a^2 (c2 + l^2)) dl over [l1, l2], relatively accurate into the tail. */
double skf_gaussian_segment(double a, double c2, double l1, double l2);

/* exp(-r2^2) - exp(-r1^2), given d2 = r2^2 - r1^2. */
double skf_gaussian_difference(double r1, double r2, double d2);

/* Slices parallel to the longest edge: a sum of positive terms, for slivers and steep tails. */
void skf_gaussian_strips(double a, const skf_triangle_view *g, int order, skf_value *v);

#endif
