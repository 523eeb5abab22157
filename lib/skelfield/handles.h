/* SPDX-License-Identifier: MIT */
/* Blinn's handles: how thick a primitive is and how softly it blends, instead of kernel parameter and strength
   [Blinn 1982; Sherstyuk 1999, 3.3.2]. */
#ifndef SKELFIELD_HANDLES_H
#define SKELFIELD_HANDLES_H

#include "skelfield/field.h"

#ifdef __cplusplus
extern "C" {
#endif

/* 0 stands for "not given". */
typedef struct skf_handles {
  /* In isolation [L], > 0: where nothing else is around, F = iso at this distance from the primitive, at the place that
     skf_handles_place tells. Elsewhere beside it the surface may be farther or nearer. */
  double radius;
  /* < 0: d ln h / d ln r^2 at the radius. With gaussian this is Blinn's B, h = exp(B r^2 / radius^2). Near 0: soft,
     blends from afar; large: hard, keeps the skeleton's shape. Cauchy has none of -2 or below. */
  double blobbiness;
  /* Depth of influence [L], > radius: the kernel vanishes there (R), or has fallen to SKF_INFLUENCE_SHARE of its peak.
   */
  double influence;
} skf_handles;

#define SKF_INFLUENCE_SHARE 0.01

/* What skf_handles_solve must leave as it is. */
enum { SKF_FIXED_PARAM = 1, SKF_FIXED_STRENGTH = 2 };

/* Where the radius is measured: a point at this distance from the primitive. Point: in the direction of x; segment:
   beside its middle; arc: beside the middle of its sweep, along its normal; triangle: above its incentre; plane: above
   `through`. By symmetry the surface of an isolated point, circle, endless plane has this distance all around (a
   circle's along the normal, on both sides). */
SKF_API skf_vec3 skf_handles_place(const skf_primitive *primitive, double radius);

/* Sets kernel parameter and strength of n elements, pieces of one primitive that share the first one's kernel, such
   that F = iso at the radius beside the largest of them (the first of equals), to rounding of F (the radius is exact to
   1e-14 divided by the slope -d ln F / d ln r, tested to 1e-10 for every pair). Radius, blobbiness, and the kernel's
   width (`influence`, or the parameter as it is with SKF_FIXED_PARAM) are three, two of which give the third, and then
   the strength; a radius and SKF_FIXED_STRENGTH give the parameter; an influence alone gives the parameter and leaves
   the strength. Inverse and inverse-squared have no parameter: the radius gives the strength. SKF_ERR_ARG:
   contradictions and missing handles; SKF_ERR_RANGE: what no parameter and no positive strength can do (iso
   <= 0 for all but the inverse kernels' planes, blobbiness >= 0, radius >= influence). *why, if given, then tells what
   is wrong and what was expected. *out, if given, gets all three handles. */
SKF_API skf_status skf_handles_solve(const skf_handles *given, double iso, unsigned fixed, skf_element *elements,
                                     size_t n, skf_handles *out, const char **why);

/* The handles that n elements of one kernel have: the radius is searched for where skf_handles_solve would put it, to
   rounding; 0 where F stays below iso. Influence and blobbiness are 0 where the kernel has none. */
SKF_API skf_status skf_handles_find(const skf_element *elements, size_t n, double iso, skf_handles *out);

#ifdef __cplusplus
}
#endif
#endif
