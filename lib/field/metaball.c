/* SPDX-License-Identifier: MIT */
#include "field/kernel.h"
#include "field/triangle.h"

static void eval(double s, double w, double d[4]) {
  double R2 = s * s;
  d[0] = d[1] = d[2] = d[3] = 0;
  if (w >= R2) return;
  if (9 * w <= R2) {
    d[0] = 1 - 3 * w / R2;
    d[1] = -3 / R2;
    return;
  }
  double r = sqrt(w), m = (R2 - w) / (s * (s + r)); /* m = 1 - r/R */
  d[0] = 1.5 * m * m;
  d[1] = -1.5 * m / (s * r);
  d[2] = 0.75 / (s * r * w);
  d[3] = -1.125 / (s * r * w * w);
}

const skf_kernel_ops skf_kernel_metaball = {
    .info = {"metaball", "1 - 3 r^2/R^2 (r <= R/3), 3/2 (1 - r/R)^2 (r <= R), 0",
             "finite support, once differentiable at R/3 and R", "R", "L", "radius of its support", true, false},
    .eval = eval,
    .closed[SKF_TRIANGLE] = skf_triangle_metaball,
};
