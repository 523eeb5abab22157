/* SPDX-License-Identifier: MIT */
/* Rays against the surface F = iso of a field. */
#ifndef SKELFIELD_RAY_H
#define SKELFIELD_RAY_H

#include "skelfield/field.h"

#ifdef __cplusplus
extern "C" {
#endif

/* p(t) = origin + t direction for t_min <= t <= t_max; direction need not be a unit vector on input, t counts in units
   of length [L]. t_max may be INFINITY. */
typedef struct skf_ray {
  skf_vec3 origin, direction;
  double t_min, t_max;
} skf_ray;

typedef struct skf_hit {
  double t;        /* [L] along the normalised direction */
  skf_vec3 at;     /* [L] */
  skf_vec3 normal; /* outward unit normal -grad F / |grad F| */
  bool entering;   /* F - iso changes from negative to positive */
} skf_hit;

/* What a query cost and what it left undecided; queries add to it. */
typedef struct skf_ray_report {
  size_t cells, subdivisions, evaluations;
  size_t grazing; /* cells that touch the surface too closely to decide at the floor of subdivision */
} skf_ray_report;

/* A field with an iso value, ready for rays: immutable, safe to share between threads. Borrows the field. iso may have
   any sign, strengths too; surfaces may be unbounded. SKF_ERR_ARG if iso is not finite, SKF_ERR_RANGE if a primitive
   goes beyond 3e153 in a coordinate, SKF_ERR_UNSUPPORTED if an element has no bounds (skf_field_has_bound). */
typedef struct skf_tracer skf_tracer;

SKF_API skf_status skf_tracer_new(const skf_field *field, double iso, skf_tracer **out);

/* normals: by how much those of smooth fields (below) may be off, 0 to 1e-3. Default 0: rounding. Pictures can do with
   1e-8, which saves a quarter to a half of the evaluations of the field. Places are the same. */
typedef struct skf_tracer_options {
  double normals;
} skf_tracer_options;

/* skf_tracer_new with options (NULL: defaults); SKF_ERR_ARG also for those out of range. */
SKF_API skf_status skf_tracer_new_with(const skf_field *field, double iso, const skf_tracer_options *options,
                                       skf_tracer **out);
SKF_API void skf_tracer_free(skf_tracer *tracer);

/* What is certified. A crossing is a place where F - iso changes sign; a surface that is touched from one side is not
   crossed. The ray is cut into cells. A cell is passed when bounds on F, or the cubic through values and slopes at its
   ends with a bound on its error, keep iso out of it; it holds exactly one crossing when its ends have different signs
   and the cubic's slope stays away from 0 by more than its error. Any other cell is halved, down to the rounding of F
   and of the coordinates; what is left there is counted as `grazing`. So with grazing = 0 no crossing is missed and
   none is invented, up to rounding of F. (The bounds: field/envelope.h.)

   Where all kernels are smooth (Cauchy, 1 / r, 1 / r^2, Gaussian) polynomials take the place of the field in the cells
   of an octree, with bounds of what they, their slopes and second derivatives are off by: such a cell is passed, or
   holds one crossing, when that is so for every function within those bounds. (lib/ray/model.h.) Cells are modelled
   when the first ray comes to them: the first frame costs more than those after it.

   A hit is polished until |F - iso| is rounding of F or the coordinates cannot tell more, by the field itself or by a
   certified correction from the field beside it. Normals are those of the field's gradient to rounding, or as the
   options say. A ray that starts on the surface, to rounding, does not hit its own start: its first hit is the next
   crossing.

   All functions: SKF_ERR_ARG if the direction is zero or a number is not finite (t_max may be infinite). The report may
   be NULL. */

/* Every crossing with t in [t_min, t_max], in order of t: at most `capacity` go to hits, *count is the true number. */
SKF_API skf_status skf_tracer_all(const skf_tracer *tracer, const skf_ray *ray, size_t capacity, skf_hit *hits,
                                  size_t *count, skf_ray_report *report);

/* The first crossing; *found tells whether there is one. The ray beyond it is not looked at. */
SKF_API skf_status skf_tracer_first(const skf_tracer *tracer, const skf_ray *ray, skf_hit *hit, bool *found,
                                    skf_ray_report *report);

/* A stretch of a ray on which F > iso, from `in` to `out`. Where the ray starts (ends) inside, `in` (`out`) is its
   start (end), without a normal: (0, 0, 0). */
typedef struct skf_span {
  skf_hit in, out;
  bool starts_inside, ends_inside;
} skf_span;

/* All of them, in order and apart from each other, for set operations between bodies: at most `capacity` go to spans,
 *count is the true number. A ray that starts on the surface is inside if it goes inwards. */
SKF_API skf_status skf_tracer_spans(const skf_tracer *tracer, const skf_ray *ray, size_t capacity, skf_span *spans,
                                    size_t *count, skf_ray_report *report);

/* Only whether there is a crossing: cheaper, it is not polished. */
SKF_API skf_status skf_tracer_occluded(const skf_tracer *tracer, const skf_ray *ray, bool *occluded,
                                       skf_ray_report *report);

/* The same for n rays, bit for bit, on all threads and several rays at once: quickest where rays that follow each other
   are neighbours that go the same way, as those of a row of pixels. hits[i] is set where found[i]. What is wrong with
   one ray is returned, and nothing is found on it; the others are answered. */
SKF_API skf_status skf_tracer_first_many(const skf_tracer *tracer, size_t n, const skf_ray *rays, skf_hit *hits,
                                         bool *found, skf_ray_report *report);
SKF_API skf_status skf_tracer_occluded_many(const skf_tracer *tracer, size_t n, const skf_ray *rays, bool *occluded,
                                            skf_ray_report *report);

#ifdef __cplusplus
}
#endif
#endif
