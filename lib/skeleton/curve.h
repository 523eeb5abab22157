/* SPDX-License-Identifier: MIT */
/* Any curve as a chain of arcs. */
#ifndef SKF_SKELETON_CURVE_H
#define SKF_SKELETON_CURVE_H

#include "skeleton/shape.h"

/* skf_curve_cut for a curve of about the size 1, which 2^power brings to its own; the tolerance is in units of the
   curve as it is given here. */
skf_status skf_curve_cut_scaled(const skf_curve *curve, double tolerance, int power, skf_primitive *pieces,
                                size_t capacity, size_t *count);

#endif
