/* SPDX-License-Identifier: MIT */
#include "field/kernel.h"
#include "field/triangle.h"

static void eval(double s, double w, double d[4]) {
  double s2 = s * s, q = 1 / (1 + s2 * w);
  d[0] = q * q;
  d[1] = -2 * s2 * d[0] * q;
  d[2] = -3 * s2 * d[1] * q;
  d[3] = -4 * s2 * d[2] * q;
}

const skf_kernel_ops skf_kernel_cauchy = {
    .info = {"cauchy", "1 / (1 + s^2 r^2)^2", "smooth, falls like r^-4", "s", "1/L", "1 / s is its width", false,
             false},
    .eval = eval,
    .closed[SKF_TRIANGLE] = skf_triangle_cauchy,
};
