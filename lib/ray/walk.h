/* SPDX-License-Identifier: MIT */
/* The walk along one ray: cells, their certificates, roots. */
#ifndef SKF_RAY_WALK_H
#define SKF_RAY_WALK_H

#include "ray/octree.h"
#include "simd/isa.h"
#include "skelfield/ray.h"

struct skf_tracer {
  const skf_field *field; /* borrowed */
  double iso;
  /* The strengths of one sign each, when there are both signs or planes that are linear along the ray; else NULL. */
  skf_field *plus, *minus;
  size_t n, linear; /* sources; the first `linear` of them are planes of the inverse kernel */
  skf_source *sources;
  skf_status reach; /* SKF_OK: surface inside `region`; SKF_ERR_EMPTY: none; SKF_ERR_UNBOUNDED */
  skf_box region;
  skf_blob *blobs;  /* of the sources; see skf_octree_new */
  skf_octree *tree; /* of the region, or NULL */
  skf_isa isa;
  double normals; /* see skf_tracer_options */
  double noise;   /* relative rounding error of F against the sum of the elements' magnitudes */
  /* Where powers of the lengths leave the range of doubles, rays are answered by a copy, all lengths times 2^power. */
  skf_tracer *copy;
  skf_field *copied;
  int power;
  skf_vec3 middle; /* of the region */
  double far2;     /* rays that start farther than this from it, squared, are begun next to it; INFINITY: no region */
};

/* The field at one place of the ray. */
typedef struct skf_knot {
  double t, f, slope; /* f = F - iso and its derivative */
  double size;        /* sum of magnitudes that F is made of, and |iso| */
  double noise;       /* |f| below this has no sign */
  skf_vec3 at, gradient;
  bool known; /* else only t is set */
} skf_knot;

/* The model of a leaf along a ray at a root of it: half the second derivative, a sixth of the third; how far the
   field's second derivatives may be from the model's; how the model's gradient changes along the ray, and how far from
   it the field's may: by all that it can where the model was not asked, turn = 0. */
typedef struct skf_bow {
  double c2, c3, off;
  skf_vec3 turn;
  double loose;
} skf_bow;

typedef struct skf_walk {
  const skf_tracer *tracer;
  skf_vec3 origin, direction; /* unit */
  int last;                   /* sign of f just before the current cell; 0: the ray starts on the surface */
  const double *side;         /* of the linear planes on this piece: +1 or -1 */
  const skf_leaf *leaf;       /* the cell of the octree that the walk is in, whose bounds hold; or NULL */
  const skf_bow *bow;         /* of a crossing that a model has found, at the guess; or NULL */
  skf_ray_report report;
} skf_walk;

/* Called with each crossing, in order; returns whether to go on. */
typedef bool skf_crossing_fn(void *user, skf_walk *w, const skf_knot *a, const skf_knot *b, double guess);

/* All crossings in (a.t, b] in order; *a becomes the knot at b. Returns false when `found` asked to stop. */
bool skf_walk_piece(skf_walk *w, skf_knot *a, double b, skf_crossing_fn *found, void *user);

void skf_walk_look(skf_walk *w, double t, skf_knot *out);

/* The root between two knots to rounding: |f| <= 2 eps size, or nothing better in the coordinates' precision. */
skf_knot skf_walk_polish(skf_walk *w, const skf_knot *a, const skf_knot *b, double guess);

/* Whether f provably keeps its sign on [t, infinity). */
bool skf_walk_tail_clear(const skf_walk *w, double t);

#endif
