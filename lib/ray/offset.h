/* SPDX-License-Identifier: MIT */
/* One hard surface around one primitive. */
#ifndef SKF_RAY_OFFSET_H
#define SKF_RAY_OFFSET_H

#include "skelfield/render.h"
#include "core/vec3.h"

typedef struct skf_hull {
  skf_primitive primitive;
  double radius, size; /* size: of the whole hull [L] */
  size_t item;
  skf_box box;
} skf_hull;

/* The nearest place of the hull's surface on o + t d, d a unit vector, with t > from and t < *t; the normal points away
   from the primitive, of flat triangles towards o. */
bool skf_hull_hit(const skf_hull *h, skf_vec3 o, skf_vec3 d, double from, double *t, skf_vec3 *normal);

/* Real roots of t^4 + p t^2 + q t + r in [-reach, reach], ascending: how many. */
int skf_quartic(double p, double q, double r, double reach, double roots[4]);

#endif
