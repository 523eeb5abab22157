/* SPDX-License-Identifier: MIT */
/* The forms for floats, for the translation unit of one instruction set. */
#ifndef SKF_FIELD_BATCH_F32_TABLE_H
#define SKF_FIELD_BATCH_F32_TABLE_H

#include "field/batch_arc.h"
#include "field/batch_arc_compact.h"
#include "field/batch_arc_gaussian.h"
#include "field/batch_arc_metaball.h"
#include "field/batch_arc_open.h"
#include "field/batch_arc_smooth.h"
#include "field/batch_area_cauchy.h"
#include "field/batch_area_compact.h"
#include "field/batch_area_gaussian.h"
#include "field/batch_area_metaball.h"
#include "field/batch_circle.h"
#include "field/batch_plane.h"
#include "field/batch_point.h"
#include "field/batch_ring.h"
#include "field/batch_segment.h"
#include "field/batch_segment_compact.h"
#include "field/batch_segment_smooth.h"
#include "field/batch_triangle.h"

/* clang-format off */
#define SKF_F32_TABLE                                                                                                  \
  SKF_F32_ENTRY(inverse_point) SKF_F32_ENTRY(inverse_squared_point) SKF_F32_ENTRY(cauchy_point)                        \
  SKF_F32_ENTRY(gaussian_point) SKF_F32_ENTRY(quartic_point) SKF_F32_ENTRY(soft_object_point)                          \
  SKF_F32_ENTRY(metaball_point) SKF_F32_ENTRY(inverse_segment) SKF_F32_ENTRY(cauchy_segment)                           \
  SKF_F32_ENTRY(gaussian_segment) SKF_F32_ENTRY(gaussian_segment_long) SKF_F32_ENTRY(gaussian_segment_short)           \
  SKF_F32_ENTRY(inverse_squared_segment)                                                                               \
  SKF_F32_ENTRY(quartic_segment) SKF_F32_ENTRY(soft_object_segment) SKF_F32_ENTRY(cauchy_arc)                          \
  SKF_F32_ENTRY(cauchy_circle) SKF_F32_ENTRY(inverse_arc) SKF_F32_ENTRY(inverse_circle)                                \
  SKF_F32_ENTRY(inverse_squared_arc) SKF_F32_ENTRY(inverse_squared_circle) SKF_F32_ENTRY(gaussian_circle)              \
  SKF_F32_ENTRY(inverse_triangle) SKF_F32_ENTRY(cauchy_triangle) SKF_F32_ENTRY(inverse_squared_triangle)               \
  SKF_F32_ENTRY(gaussian_triangle) SKF_F32_ENTRY(quartic_triangle) SKF_F32_ENTRY(soft_object_triangle)                 \
  SKF_F32_ENTRY(inverse_plane) SKF_F32_ENTRY(inverse_squared_plane) SKF_F32_ENTRY(cauchy_plane)                        \
  SKF_F32_ENTRY(gaussian_plane) SKF_F32_ENTRY(metaball_plane) SKF_F32_ENTRY(soft_object_plane)                         \
  SKF_F32_ENTRY(quartic_plane) SKF_F32_ENTRY(gaussian_arc_brief) SKF_F32_ENTRY(gaussian_arc_wide)                      \
  SKF_F32_ENTRY(quartic_arc) SKF_F32_ENTRY(quartic_circle) SKF_F32_ENTRY(soft_object_arc)                              \
  SKF_F32_ENTRY(soft_object_circle) SKF_F32_ENTRY(metaball_arc) SKF_F32_ENTRY(metaball_circle)                         \
  SKF_F32_ENTRY(metaball_triangle) SKF_F32_ENTRY(metaball_segment) SKF_F32_ENTRY(metaball_segment_short)               \
  SKF_F32_ENTRY(metaball_segment_long)                                                                                 \
  .keep = batch_keep, .gather = batch_gather
/* clang-format on */

#endif
