/* SPDX-License-Identifier: MIT */
/* The forms for floats, for the translation unit of one instruction set. */
#ifndef SKF_FIELD_BATCH_F32_TABLE_H
#define SKF_FIELD_BATCH_F32_TABLE_H

#include "field/batch_arc.h"
#include "field/batch_point.h"
#include "field/batch_segment.h"
#include "field/batch_triangle.h"

/* clang-format off */
#define SKF_F32_TABLE                                                                                                  \
  SKF_F32_ENTRY(inverse_point) SKF_F32_ENTRY(inverse_squared_point) SKF_F32_ENTRY(cauchy_point)                        \
  SKF_F32_ENTRY(gaussian_point) SKF_F32_ENTRY(quartic_point) SKF_F32_ENTRY(soft_object_point)                          \
  SKF_F32_ENTRY(metaball_point) SKF_F32_ENTRY(inverse_segment) SKF_F32_ENTRY(cauchy_segment) SKF_F32_ENTRY(cauchy_arc) \
  SKF_F32_ENTRY(cauchy_circle) SKF_F32_ENTRY(inverse_circle) SKF_F32_ENTRY(inverse_triangle) \
  .scale = batch_scale
/* clang-format on */

#endif
