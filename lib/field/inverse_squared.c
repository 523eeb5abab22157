/* SPDX-License-Identifier: MIT */
#include "field/kernel.h"
#include "field/triangle.h"

static void eval(double s, double w, double d[4]) {
  (void)s;
  d[0] = 1 / w;
  d[1] = -d[0] / w;
  d[2] = -2 * d[1] / w;
  d[3] = -3 * d[2] / w;
}

const skf_kernel_ops skf_kernel_inverse_squared = {
    .info = {"inverse-squared", "1 / r^2", "harder than gravity near, softer far", NULL, NULL, NULL, false, true},
    .eval = eval,
    .closed[SKF_TRIANGLE] = skf_triangle_inverse_squared,
};
