/* SPDX-License-Identifier: MIT */
/* The primitives whose vector forms are timed, each of a size of about 1. */
#ifndef SKF_BENCH_UNITS_H
#define SKF_BENCH_UNITS_H

#include "core/vec3.h"
#include "skelfield/field.h"
#include <math.h>

/* other: a full circle, a plane whose normal is along no axis */
static skf_primitive unit(skf_shape shape, bool other) {
  skf_primitive s = {.shape = shape};
  switch (shape) {
  case SKF_SEGMENT: s.segment = (skf_segment){{-1, 0, 0}, {1, 0.1, 0}}; break;
  case SKF_ARC: s.arc = (skf_arc){{0, 0, 0}, {0, 0, 1}, {cos(1), -sin(1), 0}, 1, other ? 2 * SKF_PI : 2}; break;
  case SKF_TRIANGLE: s.triangle = (skf_triangle){{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0.2}}}; break;
  case SKF_PLANE:
    s.plane = (skf_plane){{0, 0, 0}, {0, 0, 1}};
    if (other) s.plane.normal = v3(0.48, 0.6, 0.64);
    break;
  default: break;
  }
  return s;
}

#endif
