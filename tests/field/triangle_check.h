/* SPDX-License-Identifier: MIT */
/* What the tests of the triangle's fields share. */
#ifndef SKF_TESTS_FIELD_TRIANGLE_CHECK_H
#define SKF_TESTS_FIELD_TRIANGLE_CHECK_H

#include "check.h"
#include "field/triangle.h"
#include <string.h>

typedef struct tri_case {
  skf_kernel kernel;
  skf_triangle triangle;
  skf_vec3 x;
} tri_case;

static inline skf_value tri_eval(const tri_case *c, int order) {
  skf_element e = {.kernel = c->kernel, .strength = 1};
  e.primitive.shape = SKF_TRIANGLE;
  e.primitive.triangle = c->triangle;
  skf_prepared p;
  skf_prepare(&e, &p);
  skf_value v;
  memset(&v, 0, sizeof v);
  skf_kernel_row(c->kernel.type)->closed[SKF_TRIANGLE](&p, c->x, order, &v);
  return v;
}

/* The largest of |F|, |g|, |h| differences, each over its own scale. */
static inline double tri_diff_g(skf_vec3 a, skf_vec3 b, double scale) { return v3_norm(v3_sub(a, b)) / scale; }

static inline double tri_norm_h(const double h[6]) {
  return sqrt(h[0] * h[0] + h[3] * h[3] + h[5] * h[5] + 2 * (h[1] * h[1] + h[2] * h[2] + h[4] * h[4]));
}

static inline double tri_diff_h(const double a[6], const double b[6], double scale) {
  double d[6];
  for (int i = 0; i < 6; i++) d[i] = a[i] - b[i];
  return tri_norm_h(d) / scale;
}

/* max(diameter, distance) of a case. */
static inline double tri_size(const tri_case *c) {
  const skf_vec3 *v = c->triangle.vertices;
  skf_primitive p = {.shape = SKF_TRIANGLE, .triangle = c->triangle};
  double diam = fmax(v3_dist(v[0], v[1]), fmax(v3_dist(v[1], v[2]), v3_dist(v[2], v[0])));
  return fmax(diam, skf_primitive_distance(&p, c->x));
}

#endif
