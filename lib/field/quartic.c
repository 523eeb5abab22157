/* SPDX-License-Identifier: MIT */
#include "field/polynomial.h"
#include "field/triangle.h"

/* m^2 */
static const skf_polynomial law = {1, 0};

static void eval(double R, double w, double d[4]) { skf_polynomial_eval(law, R, R * R - w, d); }

static void power(double R, double w, double q, double d[4]) {
  (void)w;
  skf_polynomial_eval(law, R, q, d);
}

static void point(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  skf_polynomial_point(law, e, x, order, v);
}

static void segment(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  skf_polynomial_segment(law, e, x, order, v);
}

static void arc(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) { skf_polynomial_arc(law, e, x, order, v); }

static void plane(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  skf_polynomial_plane(law, e, x, order, v);
}

const skf_kernel_ops skf_kernel_quartic = {
    .info = {"quartic", "(1 - r^2/R^2)^2 (r <= R), 0", "finite support, polynomial in r^2", "R", "L",
             "radius of its support", true, false},
    .eval = eval,
    .power = power,
    .closed[SKF_POINT] = point,
    .closed[SKF_SEGMENT] = segment,
    .closed[SKF_ARC] = arc,
    .closed[SKF_TRIANGLE] = skf_triangle_quartic,
    .closed[SKF_PLANE] = plane,
};
