/* SPDX-License-Identifier: MIT */
#include "field/kernel.h"
#include "field/triangle.h"

static void eval(double s, double w, double d[4]) {
  double R2 = s * s, m = (R2 - w) / R2;
  d[0] = d[1] = d[2] = d[3] = 0;
  if (m <= 0) return;
  d[0] = m * m * (5 + 4 * m) / 9;
  d[1] = -m * (10 + 12 * m) / (9 * R2);
  d[2] = (10 + 24 * m) / (9 * R2 * R2);
  d[3] = -24 / (9 * R2 * R2 * R2);
}

const skf_kernel_ops skf_kernel_soft_object = {
    .info = {"soft-object", "1 - 22/9 u^2 + 17/9 u^4 - 4/9 u^6, u = r/R (r <= R), 0",
             "finite support, polynomial in r^2", "R", "L", "radius of its support", true, false},
    .eval = eval,
    .closed[SKF_TRIANGLE] = skf_triangle_soft_object,
};
