/* SPDX-License-Identifier: MIT */
/* The registry of primitives, and what can be asked of each. */
#include "skeleton/shape.h"

static const skf_shape_ops *const registry[SKF_SHAPE_COUNT] = {
    [SKF_POINT] = &skf_shape_point,       [SKF_SEGMENT] = &skf_shape_segment, [SKF_ARC] = &skf_shape_arc,
    [SKF_TRIANGLE] = &skf_shape_triangle, [SKF_PLANE] = &skf_shape_plane,     [SKF_SOLID] = &skf_shape_solid,
};

const skf_shape_info *skf_shape_get(skf_shape shape) {
  return (unsigned)shape < SKF_SHAPE_COUNT ? &registry[shape]->info : NULL;
}

skf_status skf_primitive_check(const skf_primitive *p, const char **why) {
  const char *ignored;
  if (!why) why = &ignored;
  if ((unsigned)p->shape >= SKF_SHAPE_COUNT) return *why = "unknown shape", SKF_ERR_ARG;
  const skf_shape_ops *ops = registry[p->shape];
  for (int i = 0; i < ops->info.param_count; i++) {
    const skf_param *a = ops->info.params + i;
    if (a->type == SKF_PARAM_SOLID) continue; /* it was checked when it was made */
    const double *x = (const double *)((const char *)p + a->offset);
    bool vector = a->type == SKF_PARAM_VECTOR || a->type == SKF_PARAM_VECTORS;
    for (int k = 0; k < (vector ? 3 * a->count : 1); k++) {
      if (!isfinite(x[k])) return *why = "a number is not finite", SKF_ERR_RANGE;
      if (!vector && !(x[k] > a->above && x[k] <= a->upto)) return *why = a->name, SKF_ERR_RANGE;
    }
  }
  *why = ops->degenerate(p);
  if (*why) return SKF_ERR_DEGENERATE;
  return SKF_OK;
}

double skf_primitive_measure(const skf_primitive *p) { return registry[p->shape]->measure(p); }
double skf_primitive_distance(const skf_primitive *p, skf_vec3 x) { return registry[p->shape]->distance(p, x); }
double skf_primitive_distance_max(const skf_primitive *p, skf_vec3 x) { return registry[p->shape]->distance_max(p, x); }
skf_box skf_primitive_bounds(const skf_primitive *p) { return registry[p->shape]->bounds(p); }
skf_vec3 skf_primitive_point(const skf_primitive *p, double s, double t) { return registry[p->shape]->at(p, s, t); }
