/* SPDX-License-Identifier: MIT */
/* What a triangle keeps between points. */
#ifndef SKF_FIELD_TRIANGLE_PLAN_H
#define SKF_FIELD_TRIANGLE_PLAN_H

#include "skelfield/skeleton.h"
#include "num/exact.h"

/* Edge i runs from vertex i to vertex i + 1. The sides are taken in double-double: near the surface and for slivers
   plain differences cost up to 8 digits. */
typedef struct skf_triangle_plan {
  skf_vec3 v[3];
  skf_dd3 e[3], N, M[3];                  /* edges; N = e0 x e1; M = e x N, outward */
  double twice, area, diam;               /* |N|, |N| / 2, longest edge */
  double L[3], per_L[3], per_M[3], per_N; /* lengths, 1 / |e|, 1 / |M|, 1 / |N| */
  skf_vec3 n, t[3], m[3];                 /* unit: normal, edge directions, outward edge normals t x n */
  int longest;
  double c[3], s[3]; /* t[i] = c[i] t[longest] + s[i] m[longest], m[i] = -s[i] t[longest] + c[i] m[longest] */
} skf_triangle_plan;

void skf_triangle_prepare(const skf_triangle *triangle, skf_triangle_plan *plan);

#endif
