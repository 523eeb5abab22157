/* SPDX-License-Identifier: MIT */
#include "field/kernel.h"
#include "field/triangle.h"

static void eval(double s, double w, double d[4]) {
  double R2 = s * s, m = (R2 - w) / R2;
  d[0] = d[1] = d[2] = d[3] = 0;
  if (m <= 0) return;
  d[0] = m * m;
  d[1] = -2 * m / R2;
  d[2] = 2 / (R2 * R2);
}

const skf_kernel_ops skf_kernel_quartic = {
    .info = {"quartic", "(1 - r^2/R^2)^2 (r <= R), 0", "finite support, polynomial in r^2", "R", "L",
             "radius of its support", true, false},
    .eval = eval,
    .closed[SKF_TRIANGLE] = skf_triangle_quartic,
};
