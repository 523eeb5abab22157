/* SPDX-License-Identifier: MIT */
#include "field/some.h"
#include "core/vec3.h"

double skf_field_some(const skf_field *field, const uint32_t *which, size_t n, skf_vec3 p, skf_vec3 *g, double *size) {
  const skf_prepared *all = skf_field_prepared(field);
  double F = 0, sum = 0;
  skf_vec3 G = v3(0, 0, 0);
  for (size_t i = 0; i < n; i++) {
    const skf_prepared *e = all + which[i];
    skf_value v = {.F = 0};
    skf_element_value(e, p, 1, &v);
    F += e->strength * v.F, sum += fabs(e->strength * v.F);
    G = v3_mad(G, e->strength, v.g);
  }
  *size = sum;
  *g = G;
  return F;
}
