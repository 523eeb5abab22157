/* SPDX-License-Identifier: MIT */
/* One element as the ray solver sees it: a quick distance, and what its field can be at that distance. */
#ifndef SKF_RAY_SOURCE_H
#define SKF_RAY_SOURCE_H

#include "field/envelope.h"
#include "field/weight.h"
#include "skelfield/field.h"
#include <stdatomic.h>

/* Suprema of the primitive's field and its derivatives over all places at a distance >= d from it, and the infimum of
   the field over all places at a distance <= d. Strength is not in them. */
typedef struct skf_grade {
  skf_envelope above;
  double below;
} skf_grade;

typedef struct skf_source {
  skf_element element;
  double weight;         /* strength */
  double least, most;    /* of strength times profile: weight without one */
  double measure, reach; /* of the primitive; a ball around `middle` holds it */
  skf_vec3 middle;
  double end; /* at this distance from the middle and beyond there is no field */
  /* frame of the distance: segment: from, direction, length; arc: e, f, n; plane: through, normal */
  skf_vec3 a, b, c;
  double length, cosine;
  bool whole, disc, sheet; /* a full circle; skf_source_disc, skf_source_steepness are of use */
  bool bulk;               /* a solid: skf_source_bulk is of use */
  bool aside;              /* a triangle of a compact kernel: skf_source_aside is of use */
  double edge[3];          /* its edges' lines are v . x = edge, v = a, b, c, which point away from it in its plane */
  /* grades at unit, ... growing by eighths of octaves, made when they are first asked for; none of points and planes */
  size_t grades;
  double unit;
  _Atomic(skf_grade *) grade;
} skf_source;

void skf_source_init(const skf_element *element, skf_source *out);
void skf_source_free(skf_source *s);

/* Distance from x, to rounding. */
double skf_source_distance(const skf_source *s, skf_vec3 x);

/* Cosine between a unit direction and a plane's normal; 0 where rounding of the direction cannot tell it from 0. */
double skf_source_descent(const skf_source *s, skf_vec3 direction);

/* Bounds at distances within [near, far] from the primitive. For planes all of `above` and `below` are signed values of
   F. `fourth` is infinite where a kink of the kernel may be met. */
skf_grade skf_source_grade(const skf_source *s, double near, double far);

/* For triangles of the inverse-squared kernel, which is infinite on them: a lower bound of the field within `radius` of
   x, that of the disc around the foot of x inside the triangle. */
double skf_source_disc(const skf_source *s, skf_vec3 x, double radius);

/* For triangles of the inverse kernel, whose gradient jumps across them: an upper bound of its length within `radius`
   of x. It is at most 2 pi across, and along the triangle the sum of the integrals of 1 / r over the edges. */
double skf_source_steepness(const skf_source *s, skf_vec3 x, double radius);

/* For triangles of compact kernels: an upper bound of the Hessian within `radius` of x, where they are at a distance
   >= near: beside an edge only a part of the directions lead to the triangle. */
double skf_source_aside(const skf_source *s, skf_vec3 x, double radius, double near);

/* For solids, whose derivatives depend on the distance from the surface, inside too: suprema within `radius` of x. */
skf_envelope skf_source_bulk(const skf_source *s, skf_vec3 x, double radius);

#endif
