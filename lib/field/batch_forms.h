/* SPDX-License-Identifier: MIT */
/* The registry of vector forms: name, kernel, shape, and which elements of this pair it serves. The first row that fits
   an element is taken; elements that no row fits have their closed form at each point. How a form is written:
   batch_loop.h; each header of forms is included by batch_table.h. */
#ifndef SKF_FIELD_BATCH_FORMS_H
#define SKF_FIELD_BATCH_FORMS_H

#include "field/kernel.h"

static inline bool skf_form_any(const skf_prepared *e) { return e != NULL; }
static inline bool skf_form_circle(const skf_prepared *e) { return e->plan.arc.full; }
static inline bool skf_form_open_arc(const skf_prepared *e) { return !e->plan.arc.full; }
/* Angles are differences there, good to 2^-53 each. */
static inline bool skf_form_long_arc(const skf_prepared *e) { return !e->plan.arc.full && e->plan.arc.half > 0.05; }
/* 2 a^2 rho k up to which the rules of batch_arc_gaussian.h, of few nodes or of many, are exact for half a sweep. */
static inline double skf_gaussian_arc_most(double half, bool many) {
  static const struct {
    double half, few, many;
  } most[] = {{0.4, 12.9, 59.8},  {0.5, 8.6, 47.9},  {0.625, 4.9, 38.5}, {0.75, 3, 32.2},
              {0.875, 1.9, 26.1}, {1, 1.28, 19.5},   {1.25, 0.58, 11.7}, {1.5, 0.27, 7.4},
              {2, 0.06, 3.4},     {2.5, 0.013, 1.7}, {SKF_PI, 0, 0.8}};
  int i = 0;
  if (half <= 0.25) return (many ? 23.9 : 5) / half;
  while (i < 10 && half > most[i].half) i++;
  return many ? most[i].many : most[i].few;
}
/* Beyond 4.5 widths from its circle what an arc adds is 1e-9 of what it adds there. */
static inline bool skf_form_gaussian_arc(const skf_prepared *e, bool many) {
  double width = e->kernel.param * e->plan.arc.radius;
  return !e->plan.arc.full && 2 * width * (width + 4.5) < skf_gaussian_arc_most(e->plan.arc.half, many);
}
static inline bool skf_form_brief_arc(const skf_prepared *e) { return skf_form_gaussian_arc(e, false); }
static inline bool skf_form_wide_arc(const skf_prepared *e) { return skf_form_gaussian_arc(e, true); }
/* In widths of the kernel: so far to the left of 0 reaches vd_erfc_near; much longer, and powers of abscissae
   overflow. */
static inline bool skf_form_segment_of(const skf_prepared *e, double least, double most) {
  double width = e->kernel.param * e->plan.segment.length;
  return width > least && width < most;
}
static inline bool skf_form_medium_segment(const skf_prepared *e) { return skf_form_segment_of(e, 1, 4); }
static inline bool skf_form_long_segment(const skf_prepared *e) { return skf_form_segment_of(e, 1, 1e15); }
/* Beside the support: of what is shorter, differences between the ends would lose more than they need; of what is
   longer one end is in it at most. */
static inline bool skf_form_short_segment(const skf_prepared *e) {
  return 4 * e->plan.segment.length <= e->kernel.param;
}
static inline bool skf_form_wide_segment(const skf_prepared *e) {
  return e->plan.segment.length <= 2 * e->kernel.param;
}

#define SKF_BATCH_FORMS(X)                                                                                             \
  X(cauchy_point, SKF_CAUCHY, SKF_POINT, skf_form_any)                                                                 \
  X(gaussian_point, SKF_GAUSSIAN, SKF_POINT, skf_form_any)                                                             \
  X(inverse_point, SKF_INVERSE, SKF_POINT, skf_form_any)                                                               \
  X(inverse_squared_point, SKF_INVERSE_SQUARED, SKF_POINT, skf_form_any)                                               \
  X(metaball_point, SKF_METABALL, SKF_POINT, skf_form_any)                                                             \
  X(soft_object_point, SKF_SOFT_OBJECT, SKF_POINT, skf_form_any)                                                       \
  X(quartic_point, SKF_QUARTIC, SKF_POINT, skf_form_any)                                                               \
  X(cauchy_plane, SKF_CAUCHY, SKF_PLANE, skf_form_any)                                                                 \
  X(gaussian_plane, SKF_GAUSSIAN, SKF_PLANE, skf_form_any)                                                             \
  X(inverse_plane, SKF_INVERSE, SKF_PLANE, skf_form_any)                                                               \
  X(inverse_squared_plane, SKF_INVERSE_SQUARED, SKF_PLANE, skf_form_any)                                               \
  X(metaball_plane, SKF_METABALL, SKF_PLANE, skf_form_any)                                                             \
  X(soft_object_plane, SKF_SOFT_OBJECT, SKF_PLANE, skf_form_any)                                                       \
  X(quartic_plane, SKF_QUARTIC, SKF_PLANE, skf_form_any)                                                               \
  X(inverse_segment, SKF_INVERSE, SKF_SEGMENT, skf_form_any)                                                           \
  X(cauchy_segment, SKF_CAUCHY, SKF_SEGMENT, skf_form_any)                                                             \
  X(gaussian_segment, SKF_GAUSSIAN, SKF_SEGMENT, skf_form_medium_segment)                                              \
  X(gaussian_segment_long, SKF_GAUSSIAN, SKF_SEGMENT, skf_form_long_segment)                                           \
  X(gaussian_segment_short, SKF_GAUSSIAN, SKF_SEGMENT, skf_form_any)                                                   \
  X(inverse_squared_segment, SKF_INVERSE_SQUARED, SKF_SEGMENT, skf_form_any)                                           \
  X(quartic_segment, SKF_QUARTIC, SKF_SEGMENT, skf_form_any)                                                           \
  X(soft_object_segment, SKF_SOFT_OBJECT, SKF_SEGMENT, skf_form_any)                                                   \
  X(metaball_segment_short, SKF_METABALL, SKF_SEGMENT, skf_form_short_segment)                                         \
  X(metaball_segment, SKF_METABALL, SKF_SEGMENT, skf_form_wide_segment)                                                \
  X(metaball_segment_long, SKF_METABALL, SKF_SEGMENT, skf_form_any)                                                    \
  X(cauchy_arc, SKF_CAUCHY, SKF_ARC, skf_form_open_arc)                                                                \
  X(cauchy_circle, SKF_CAUCHY, SKF_ARC, skf_form_circle)                                                               \
  X(inverse_circle, SKF_INVERSE, SKF_ARC, skf_form_circle)                                                             \
  X(inverse_arc, SKF_INVERSE, SKF_ARC, skf_form_open_arc)                                                              \
  X(inverse_squared_arc, SKF_INVERSE_SQUARED, SKF_ARC, skf_form_open_arc)                                              \
  X(inverse_squared_circle, SKF_INVERSE_SQUARED, SKF_ARC, skf_form_circle)                                             \
  X(gaussian_circle, SKF_GAUSSIAN, SKF_ARC, skf_form_circle)                                                           \
  X(gaussian_arc_brief, SKF_GAUSSIAN, SKF_ARC, skf_form_brief_arc)                                                     \
  X(gaussian_arc_wide, SKF_GAUSSIAN, SKF_ARC, skf_form_wide_arc)                                                       \
  X(quartic_arc, SKF_QUARTIC, SKF_ARC, skf_form_long_arc)                                                              \
  X(quartic_circle, SKF_QUARTIC, SKF_ARC, skf_form_circle)                                                             \
  X(soft_object_arc, SKF_SOFT_OBJECT, SKF_ARC, skf_form_long_arc)                                                      \
  X(soft_object_circle, SKF_SOFT_OBJECT, SKF_ARC, skf_form_circle)                                                     \
  X(metaball_arc, SKF_METABALL, SKF_ARC, skf_form_long_arc)                                                            \
  X(metaball_circle, SKF_METABALL, SKF_ARC, skf_form_circle)                                                           \
  X(cauchy_triangle, SKF_CAUCHY, SKF_TRIANGLE, skf_form_any)                                                           \
  X(quartic_triangle, SKF_QUARTIC, SKF_TRIANGLE, skf_form_any)                                                         \
  X(soft_object_triangle, SKF_SOFT_OBJECT, SKF_TRIANGLE, skf_form_any)                                                 \
  X(inverse_squared_triangle, SKF_INVERSE_SQUARED, SKF_TRIANGLE, skf_form_any)                                         \
  X(gaussian_triangle, SKF_GAUSSIAN, SKF_TRIANGLE, skf_form_any)                                                       \
  X(metaball_triangle, SKF_METABALL, SKF_TRIANGLE, skf_form_any)                                                       \
  X(inverse_triangle, SKF_INVERSE, SKF_TRIANGLE, skf_form_any)

typedef enum skf_form {
#define X(name, kernel, shape, fits) SKF_FORM_##name,
  SKF_BATCH_FORMS(X)
#undef X
      SKF_FORM_COUNT /* none: the closed form */
} skf_form;

#endif
