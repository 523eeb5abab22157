/* SPDX-License-Identifier: MIT */
#include "skeleton/shape.h"

static const char *degenerate(const skf_primitive *p) {
  return v3_norm(v3_unit(p->plane.normal)) > 0 ? NULL : "plane with a zero normal";
}

static double measure(const skf_primitive *p) { return (void)p, INFINITY; }

static double distance(const skf_primitive *p, skf_vec3 x) {
  return fabs(v3_dot(v3_sub(x, p->plane.through), v3_unit(p->plane.normal)));
}

static double distance_max(const skf_primitive *p, skf_vec3 x) { return (void)p, (void)x, INFINITY; }

static skf_box bounds(const skf_primitive *p) {
  skf_vec3 n = p->plane.normal;
  skf_box b = {{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};
  for (int i = 0; i < 3; i++)
    if (v3_get(n, (i + 1) % 3) == 0 && v3_get(n, (i + 2) % 3) == 0)
      *v3_at(&b.lo, i) = *v3_at(&b.hi, i) = v3_get(p->plane.through, i);
  return b;
}

static skf_vec3 at(const skf_primitive *p, double s, double t) { return (void)s, (void)t, p->plane.through; }

static const skf_param params[] = {
    {"through", "L", "a point of the plane", SKF_PARAM_VECTOR, 1, offsetof(skf_primitive, plane.through), 0, 0},
    {"normal", "1", "its normal; it is normalised", SKF_PARAM_VECTOR, 1, offsetof(skf_primitive, plane.normal), 0, 0},
};

const skf_shape_ops skf_shape_plane = {{"plane", "infinite plane; its measure is area", "L^2", params, 2},
                                       degenerate,
                                       measure,
                                       distance,
                                       distance_max,
                                       bounds,
                                       at};
