/* SPDX-License-Identifier: MIT */
/* The vector forms, compiled for AVX2 and FMA. */
#include "field/batch_add.h"
#include "field/batch_arc.h"
#include "field/batch_point.h"
#include "field/batch_segment.h"
#include "field/batch_triangle.h"

const skf_batch_ops skf_batch_avx2 = {
    .set = batch_set,
    .add = batch_add,
    .total = batch_vector_total,
    .pair[SKF_CAUCHY][SKF_POINT] = batch_cauchy_point,
    .pair[SKF_GAUSSIAN][SKF_POINT] = batch_gaussian_point,
    .pair[SKF_INVERSE][SKF_POINT] = batch_inverse_point,
    .pair[SKF_INVERSE_SQUARED][SKF_POINT] = batch_inverse_squared_point,
    .pair[SKF_METABALL][SKF_POINT] = batch_metaball_point,
    .pair[SKF_SOFT_OBJECT][SKF_POINT] = batch_soft_object_point,
    .pair[SKF_QUARTIC][SKF_POINT] = batch_quartic_point,
    .pair[SKF_CAUCHY][SKF_SEGMENT] = batch_cauchy_segment,
    .pair[SKF_CAUCHY][SKF_ARC] = batch_cauchy_arc,
    .pair[SKF_INVERSE][SKF_ARC] = batch_inverse_arc,
    .pair[SKF_INVERSE][SKF_TRIANGLE] = batch_inverse_triangle,
    .pair[SKF_INVERSE][SKF_SEGMENT] = batch_inverse_segment,
};
