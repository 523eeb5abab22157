/* SPDX-License-Identifier: MIT */
/* What the closed forms keep of each shape, computed once per field. */
#ifndef SKF_FIELD_PLAN_H
#define SKF_FIELD_PLAN_H

#include "num/exact.h"

/* e + e_lo = to - from exactly, length L = |e|, a = e / L */
typedef struct skf_segment_plan {
  skf_vec3 e, e_lo, a;
  double length;
} skf_segment_plan;

/* Orthonormal axes e (to the start), f, n; the given normal times a power of two, its squared length and rho^2 times
   that in double-double; H is half the sweep. */
typedef struct skf_arc_plan {
  skf_vec3 e, f, n, raw;
  skf_dd raw2, radius2_raw2;
  double raw_length, radius;
  double half, sin_half, cos_half;
  bool full;
} skf_arc_plan;

/* The given normal times a power of two, its length, and the unit normal */
typedef struct skf_plane_plan {
  skf_vec3 raw, unit;
  double length;
} skf_plane_plan;

#endif
