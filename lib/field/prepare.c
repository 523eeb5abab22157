/* SPDX-License-Identifier: MIT */
#include "field/kernel.h"

void skf_prepare(const skf_element *e, skf_prepared *out) {
  out->primitive = e->primitive;
  out->kernel = e->kernel;
  out->strength = e->strength;
}
