/* SPDX-License-Identifier: MIT */
#include "field/kernel.h"
#include "field/triangle.h"

static void eval(double s, double w, double d[4]) {
  (void)s;
  d[0] = 1 / sqrt(w);
  d[1] = -0.5 * d[0] / w;
  d[2] = -1.5 * d[1] / w;
  d[3] = -2.5 * d[2] / w;
}

const skf_kernel_ops skf_kernel_inverse = {
    .info = {"inverse", "1 / r", "Newtonian potential", NULL, NULL, NULL, false, true},
    .eval = eval,
    .closed[SKF_TRIANGLE] = skf_triangle_inverse,
};
