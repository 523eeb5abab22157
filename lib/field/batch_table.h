/* SPDX-License-Identifier: MIT */
/* All vector forms, for the translation unit of one instruction set:
     const skf_batch_ops NAME = {SKF_BATCH_TABLE}; */
#ifndef SKF_FIELD_BATCH_TABLE_H
#define SKF_FIELD_BATCH_TABLE_H

#include "field/batch_arc.h"
#include "field/batch_arc_compact.h"
#include "field/batch_arc_gaussian.h"
#include "field/batch_arc_metaball.h"
#include "field/batch_arc_open.h"
#include "field/batch_arc_smooth.h"
#include "field/batch_circle.h"
#include "field/batch_area_cauchy.h"
#include "field/batch_area_compact.h"
#include "field/batch_area_gaussian.h"
#include "field/batch_area_metaball.h"
#include "field/batch_area_smooth.h"
#include "field/batch_plane.h"
#include "field/batch_point.h"
#include "field/batch_ring.h"
#include "field/batch_segment.h"
#include "field/batch_segment_compact.h"
#include "field/batch_segment_smooth.h"
#include "field/batch_triangle.h"

#define SKF_BATCH_TABLE_ROW(name, kernel, shape, fits) SKF_BATCH_ENTRY(name)
#define SKF_BATCH_TABLE                                .form = {SKF_BATCH_FORMS(SKF_BATCH_TABLE_ROW)}, .total = batch_total

#endif
