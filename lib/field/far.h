/* SPDX-License-Identifier: MIT */
/* Large sums of elements of one kernel, 1/r, 1/r^2 or Cauchy, by a fast multipole method: 1/r in solid harmonics
   (far_harmonic.h), the others in Chebyshev polynomials [Fong & Darve 2009], whose kernels between cells are sums of
   Gaussians (far_mixture.h). Everything that depends on the sources alone is computed once: a point adds up the
   elements in the cells near its own by their closed forms, and one expansion for all others. A point outside of
   the root sees the whole as harmonics around its middle or as weighted points. Gaussians that are narrow next to the
   whole have no expansions: those that matter at a point are summed (far_narrow.c); wide ones have polynomials on a
   grid (far_wide.c). */
#ifndef SKF_FIELD_FAR_H
#define SKF_FIELD_FAR_H

#include "field/batch.h"

typedef struct skf_far skf_far;

/* The elements, n of one kernel, are copied. F and the gradient come out within `accuracy` of the sums of |w F_i| and
   of |w| max(|grad F_i|, F_i / r_i). SKF_ERR_UNSUPPORTED where the elements had better be summed directly. */
skf_status skf_far_new(const skf_batch_ops *ops, bool vectors, const skf_prepared *elements, size_t n, double accuracy,
                       skf_far **out);
void skf_far_free(skf_far *far);

/* Adds F and the gradient at n points to F and g, any of which may be NULL. What is added at a point depends on this
   point alone. */
void skf_far_add(const skf_far *far, size_t n, const double *const p[3], double *F, double *const g[3]);

/* The same at one point; order 2: the Hessian too. */
void skf_far_value(const skf_far *far, skf_vec3 p, int order, skf_value *v);

#endif
