/* SPDX-License-Identifier: MIT */
#include "field/kernel.h"
#include "field/triangle.h"

static void eval(double s, double w, double d[4]) {
  double a2 = s * s;
  d[0] = exp(-a2 * w);
  d[1] = -a2 * d[0];
  d[2] = -a2 * d[1];
  d[3] = -a2 * d[2];
}

const skf_kernel_ops skf_kernel_gaussian = {
    .info = {"gaussian", "exp(-a^2 r^2)", "smooth, falls fastest", "a", "1/L", "1 / a is its width", false, false},
    .eval = eval,
    .closed[SKF_TRIANGLE] = skf_triangle_gaussian,
};
