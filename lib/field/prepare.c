/* SPDX-License-Identifier: MIT */
#include "field/kernel.h"

void skf_prepare(const skf_element *e, skf_prepared *out) {
  out->primitive = e->primitive;
  out->kernel = e->kernel;
  out->strength = e->strength;
  if (e->primitive.shape == SKF_TRIANGLE) skf_triangle_prepare(&e->primitive.triangle, &out->plan.triangle);
}
