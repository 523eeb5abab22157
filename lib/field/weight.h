/* SPDX-License-Identifier: MIT */
/* Profiles made ready: cubics in Bernstein's form, piece by piece, or sin^2. */
#ifndef SKF_FIELD_WEIGHT_H
#define SKF_FIELD_WEIGHT_H

#include "skelfield/field.h"

/* Between the parts a and b of the primitive. */
typedef struct skf_weight_piece {
  double a, b, c[4]; /* sum of c_k binom(3, k) u^k v^(3-k), u = (t - a) / (b - a), v = 1 - u */
} skf_weight_piece;

typedef struct skf_weight {
  skf_profile profile; /* its own copy, knots and all */
  bool sine;           /* one piece without coefficients */
  double from, to;     /* of the profile */
  size_t n;
  skf_weight_piece *piece;
} skf_weight;

/* The profile has been checked. */
skf_status skf_weight_new(const skf_profile *profile, skf_weight **out);
void skf_weight_free(const skf_weight *w);

/* u + v = 1, both known without cancellation */
double skf_weight_at(const skf_weight *w, const skf_weight_piece *p, double u, double v);

typedef struct skf_weight_range {
  double lo, hi;
} skf_weight_range;

/* Bounds of strength times profile; both are the strength where there is no profile. */
skf_weight_range skf_element_weights(const skf_element *e);

/* Weight times a bound; the bound may be infinite where the weight is 0. */
static inline double skf_weight_times(double w, double bound) { return w == 0 ? 0 : w * bound; }

#endif
