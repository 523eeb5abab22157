/* SPDX-License-Identifier: MIT */
/* Points whose kernel is a polynomial in r^2 up to its end: along a ray their field is piecewise a polynomial. */
#ifndef SKF_RAY_BLOB_H
#define SKF_RAY_BLOB_H

#include "core/vec3.h"
#include "skelfield/field.h"

/* strength m^2 (c2 + c3 m) where m = 1 - r^2 / R^2 > 0; c2 + c3 = 1, neither is negative. A cache line. */
typedef struct skf_blob {
  skf_vec3 at;
  double per; /* 1 / R^2; 0: no such point */
  double strength, c2, c3, R;
} skf_blob;

/* per = 0 unless the element is a point of the quartic kernel or the soft object, of positive strength, and products
   of its numbers keep their accuracy. */
skf_blob skf_blob_of(const skf_element *e);

static inline double skf_blob_law(const skf_blob *b, double m) { return m > 0 ? m * m * (b->c2 + b->c3 * m) : 0; }

/* Value and gradient at p of n of them, summed plainly; *size: sum of strength times m, which is at least the value and
   to which its rounding is relative: less than 12 eps of it, and what the rounding of p makes. */
static inline double skf_blob_sum(const skf_blob *b, size_t n, skf_vec3 p, skf_vec3 *g, double *size) {
  double F = 0, sum = 0;
  skf_vec3 G = {0, 0, 0};
  for (size_t i = 0; i < n; i++, b++) {
    skf_vec3 d = v3_sub(p, b->at);
    double m = 1 - v3_norm2(d) * b->per;
    if (!(m > 0)) continue;
    double sm = b->strength * m;
    F += sm * m * (b->c2 + b->c3 * m), sum += sm;
    G = v3_mad(G, -2 * b->per * sm * (2 * b->c2 + 3 * b->c3 * m), d);
  }
  *size = sum, *g = G;
  return F;
}

#endif
