/* SPDX-License-Identifier: MIT */
/* Adaptive quadrature of any kernel over any shape: the fallback where there is no closed form, and what the closed
   forms are tested against. */
#ifndef SKF_FIELD_QUADRATURE_H
#define SKF_FIELD_QUADRATURE_H

#include "field/kernel.h"

/* Value, gradient and Hessian by integration of h and its derivatives, graded towards the closest approach; relative
   error about 1e-12, less on smooth pairs. Same meaning as a closed form, same values on singular sets; on a plane,
   inverse and inverse-squared are relative to the references of their closed forms. */
void skf_quadrature(const skf_prepared *e, skf_vec3 x, int order, skf_value *v);

/* The parts that skf_quadrature is made of. */
enum { SKF_QUADRATURE_SIZE = 10 }; /* F, the gradient, the Hessian */
typedef struct skf_integrand {
  void (*at)(const void *context, double u, double out[SKF_QUADRATURE_SIZE]);
  const void *context;
} skf_integrand;

/* Adds the integral between the first and last of n ascending break points to out. */
void skf_integrate(const skf_integrand *f, int n, const double *breaks, double out[SKF_QUADRATURE_SIZE]);

/* Kernel at distance r (r2 = |r|^2), times `scale`, as an integrand's value. */
void skf_integrand_set(const skf_prepared *e, skf_vec3 r, double r2, double scale, double out[SKF_QUADRATURE_SIZE]);

/* Sorts, clips to [lo, hi] and drops duplicates; returns how many stay, with lo and hi among them. */
int skf_breaks(double lo, double hi, int n, double *breaks);

/* int over t in [lo, hi] at distance^2 = h2 + t^2: r = w - t a. Adds to out. */
void skf_quadrature_line(const skf_prepared *e, skf_vec3 w, skf_vec3 a, double h2, double lo, double hi,
                         double out[SKF_QUADRATURE_SIZE]);

void skf_quadrature_triangle(const skf_prepared *e, skf_vec3 x, double out[SKF_QUADRATURE_SIZE]);
void skf_quadrature_plane(const skf_prepared *e, skf_vec3 x, double out[SKF_QUADRATURE_SIZE]);

#endif
