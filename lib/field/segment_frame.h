/* SPDX-License-Identifier: MIT */
/* A point seen from a segment, and the gradient and Hessian of any kernel from a few integrals along it.
   F = int h(r) dt over t = t0..t1, the abscissa of q - x along the axis a; g = h'/r, k = g'/r. Then
     grad F = [h(r0) - h(r1)] a + w int g dt
     Hess F = int g dt (I - a a^T) + w w^T int k dt + [g(r0) - g(r1)] (a w^T + w a^T)
              + [t1 g(r1) - t0 g(r0)] a a^T. */
#ifndef SKF_FIELD_SEGMENT_FRAME_H
#define SKF_FIELD_SEGMENT_FRAME_H

#include "field/kernel.h"

typedef struct skf_segment_frame {
  skf_vec3 a, w;  /* unit axis; from the foot of the perpendicular to x */
  skf_dd3 d0, d1; /* x - from, x - to, exact */
  double L, h, h2, t0, t1, r0, r1;
  double sum; /* t0 + t1 */
  double dw;  /* r1^2 - r0^2, without cancellation */
} skf_segment_frame;

void skf_segment_place(const skf_prepared *e, skf_vec3 x, skf_segment_frame *f);

typedef struct skf_segment_terms {
  double F;
  double g;              /* int g dt */
  double k_h2;           /* h^2 int k dt */
  double ends;           /* h(r0) - h(r1) */
  double g_ends, g0, g1; /* g(r0) - g(r1) without cancellation, g(r0), g(r1) */
} skf_segment_terms;

/* The Hessian's terms are read for order 2 only. */
void skf_segment_result(const skf_segment_frame *f, const skf_segment_terms *t, int order, skf_value *v);

/* t1 g(r1) - t0 g(r0) without cancellation. */
double skf_segment_moment(const skf_segment_frame *f, const skf_segment_terms *t);

/* r_a + r_b - (t_b - t_a) without cancellation; 0 exactly when x is on the piece. int dt/r = log1p(2 L / it). */
double skf_segment_excess(double ta, double ra, double tb, double rb, double h2);

#endif
