/* SPDX-License-Identifier: MIT */
/* Some of the vector forms in eight lanes, without the instructions of AVX-512: compilers take minutes over all. */
#include "field/batch_arc_open.h"
#include "field/batch_circle.h"
#include "field/batch_point.h"
#include "field/batch_ring.h"
#include "field/batch_segment.h"
#include "field/batch_segment_compact.h"
#include "field/batch_triangle.h"

extern const skf_batch_ops skf_batch_wide;
const skf_batch_ops skf_batch_wide = {
    .form = {SKF_BATCH_ENTRY(cauchy_point) SKF_BATCH_ENTRY(gaussian_point) SKF_BATCH_ENTRY(inverse_point)
                 SKF_BATCH_ENTRY(inverse_squared_point) SKF_BATCH_ENTRY(metaball_point)
                     SKF_BATCH_ENTRY(soft_object_point) SKF_BATCH_ENTRY(quartic_point) SKF_BATCH_ENTRY(inverse_segment)
                         SKF_BATCH_ENTRY(cauchy_segment) SKF_BATCH_ENTRY(cauchy_arc)
                             SKF_BATCH_ENTRY(inverse_squared_arc) SKF_BATCH_ENTRY(cauchy_circle)
                                 SKF_BATCH_ENTRY(inverse_squared_circle) SKF_BATCH_ENTRY(inverse_circle)
                                     SKF_BATCH_ENTRY(inverse_triangle) SKF_BATCH_ENTRY(metaball_segment)
                                         SKF_BATCH_ENTRY(metaball_segment_short) SKF_BATCH_ENTRY(metaball_segment_long)
                                             SKF_BATCH_ENTRY(quartic_segment) SKF_BATCH_ENTRY(soft_object_segment)},
    .total = batch_total};
