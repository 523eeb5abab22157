/* SPDX-License-Identifier: MIT */
/* Joins: where a field's higher derivatives jump, since a kernel ends there or changes its formula. */
#include "motion/world.h"

/* The radii at which a kernel has a join; returns how many. */
static int radii(const skf_kernel *k, double out[2]) {
  if (k->type == SKF_USER_KERNEL) return out[0] = k->user->radius, k->user->radius > 0;
  if (!skf_kernel_get(k->type)->compact) return 0;
  out[0] = k->param, out[1] = k->param / 3;
  return k->type == SKF_METABALL ? 2 : 1;
}

bool skf_world_has_joins(const skf_world *w) {
  double r[2];
  for (size_t i = 0; i < w->n; i++)
    for (size_t k = 0; k < skf_field_size(w->bodies[i].is.field); k++)
      if (w->bodies[i].is.gain != 0 && radii(&skf_field_element(w->bodies[i].is.field, k)->kernel, r)) return true;
  return false;
}

uint64_t skf_world_zone(const skf_world *w, skf_clock t, skf_vec3 p) {
  uint64_t zone = 0;
  for (size_t i = 0; i < w->n; i++) {
    const skf_world_body *b = w->bodies + i;
    skf_turn turn = skf_turn_at(b, t);
    skf_vec3 x = skf_turn_point(&turn, -1, p);
    if (b->is.gain == 0 || v3_dist(x, b->center) > b->reach * (1 + 1e-12)) continue;
    for (size_t k = 0; k < skf_field_size(b->is.field); k++) {
      const skf_element *e = skf_field_element(b->is.field, k);
      double r[2], near = 0, far = 0;
      int n = radii(&e->kernel, r);
      if (n) near = skf_primitive_distance(&e->primitive, x), far = skf_primitive_distance_max(&e->primitive, x);
      uint64_t held = 0;
      for (int j = 0; j < n; j++) held = 4 * held + (near < r[j]) + 2 * (far < r[j]);
      /* places beyond all kernels are one, within the body's reach or not */
      if (held) zone = (zone + (held | k << 4 | (uint64_t)i << 40)) * UINT64_C(1099511628211) + (zone >> 29);
    }
  }
  return zone;
}
