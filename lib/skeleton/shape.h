/* SPDX-License-Identifier: MIT */
/* The row that each primitive's file gives to the registry. */
#ifndef SKF_SKELETON_SHAPE_H
#define SKF_SKELETON_SHAPE_H

#include "skelfield/skeleton.h"
#include "core/vec3.h"

typedef struct skf_shape_ops {
  skf_shape_info info;
  /* NULL, or what is degenerate; the numbers are finite and in range */
  const char *(*degenerate)(const skf_primitive *p);
  double (*measure)(const skf_primitive *p);
  double (*distance)(const skf_primitive *p, skf_vec3 x);
  double (*distance_max)(const skf_primitive *p, skf_vec3 x);
  skf_box (*bounds)(const skf_primitive *p);
  skf_vec3 (*at)(const skf_primitive *p, double s, double t);
} skf_shape_ops;

extern const skf_shape_ops skf_shape_point, skf_shape_segment, skf_shape_arc, skf_shape_triangle, skf_shape_plane,
    skf_shape_solid;

/* Orthonormal frame of an arc: e to its start, n its axis, f = n x e. */
typedef struct skf_arc_axes {
  skf_vec3 e, f, n;
} skf_arc_axes;

skf_arc_axes skf_arc_frame(const skf_arc *a);

#endif
