/* SPDX-License-Identifier: MIT */
/* Points and segments whose kernel is a polynomial in r^2 up to its end. Along a ray a point's field is piecewise a
   polynomial, and a segment's one in the square root of one. */
#ifndef SKF_RAY_BLOB_H
#define SKF_RAY_BLOB_H

#include "core/vec3.h"
#include "skelfield/field.h"

/* strength m^2 (c2 + c3 m) where m = 1 - r^2 / R^2 > 0, or its integral along a segment; c2 + c3 = 1, neither is
   negative. */
typedef struct skf_blob {
  skf_vec3 at; /* or the segment's start */
  double per;  /* 1 / R^2; 0: no such element */
  double strength, c2, c3, R;
  skf_vec3 axis;                       /* unit */
  double length;                       /* 0: a point */
  double half_R2, per_R, span, moment; /* R^2 / 2, 1 / R, length / R, strength R */
  double quiet;                        /* in a leaf of n blobs: up to this m its field is below iso / n */
} skf_blob;

/* per = 0 unless the element is a point or a segment without a profile, of the quartic kernel or the soft object, of
   positive strength, and products of its numbers keep their accuracy. */
skf_blob skf_blob_of(const skf_element *e);

/* Up to which m its field is below iso > 0; of n blobs this divided by sqrt(n) is safe for iso / n. */
double skf_blob_quiet(const skf_blob *b, double iso);

/* A cube, the distance of its corners from the center. */
typedef struct skf_cube {
  skf_vec3 center;
  double half, radius;
} skf_cube;

/* Adds bounds of a segment's field in the cube; false when it is out of reach. */
bool skf_segment_range(const skf_blob *b, const skf_cube *c, double *lo, double *hi);

/* The length along a segment that a ball of radius R can hold, 1 for a point: bounds of the kernel's derivatives times
   it are those of the field's. */
static inline double skf_blob_measure(const skf_blob *b) {
  return b->length > 0 ? (b->length < 2 * b->R ? b->length : 2 * b->R) : 1;
}

/* Upper bound of the field's second derivatives. Along a quartic segment the integral of 8 r^2 / R^4 is at most
   7.55 / R, of the soft object's 5.4 / R^2 at most 10.8 / R. */
static inline double skf_blob_bend(const skf_blob *b) {
  if (!(b->length > 0)) return 8 * b->strength * b->per;
  double most = (b->c3 > 0 ? 1.35 : 0.944) * b->R;
  return 8 * b->strength * b->per * (b->length < most ? b->length : most);
}

static inline double skf_blob_law(const skf_blob *b, double m) { return m > 0 ? m * m * (b->c2 + b->c3 * m) : 0; }

/* By how much |a - b| is more than h, without a branch. */
static inline double skf_beyond(double a, double b, double h) {
  double d = fabs(a - b) - h;
  return 0.5 * (d + fabs(d));
}

/* The same of any blob; a point's are those at the nearest and the farthest place. */
static inline bool skf_blob_range(const skf_blob *b, const skf_cube *c, double *lo, double *hi) {
  if (b->length > 0) return skf_segment_range(b, c, lo, hi);
  double h = c->half, x = skf_beyond(c->center.x, b->at.x, h), y = skf_beyond(c->center.y, b->at.y, h),
         z = skf_beyond(c->center.z, b->at.z, h), most = 1 - (x * x + y * y + z * z) * b->per * (1 - 1e-12);
  if (!(most > 0)) return false;
  x = fabs(c->center.x - b->at.x) + h, y = fabs(c->center.y - b->at.y) + h, z = fabs(c->center.z - b->at.z) + h;
  double least = 1 - (x * x + y * y + z * z) * b->per * (1 + 1e-12);
  *lo += b->strength * skf_blob_law(b, least), *hi += b->strength * skf_blob_law(b, most);
  return true;
}

/* Value and gradient at p of n points, summed plainly; *size: sum of strength times m, which is at least the value and
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
