/* SPDX-License-Identifier: MIT */
#include "skeleton/shape.h"

static skf_vec3 normal2(const skf_primitive *p) { /* twice the area, as a vector */
  const skf_vec3 *v = p->triangle.vertices;
  return v3_cross(v3_sub(v[1], v[0]), v3_sub(v[2], v[0]));
}

static const char *degenerate(const skf_primitive *p) {
  const skf_vec3 *v = p->triangle.vertices;
  double longest = fmax(v3_dist(v[0], v[1]), fmax(v3_dist(v[1], v[2]), v3_dist(v[2], v[0])));
  /* three collinear vertices rarely give an exact zero: a height below rounding of the longest side is none */
  return v3_norm(normal2(p)) > 8e-16 * longest * longest ? NULL : "triangle of zero area";
}

static double measure(const skf_primitive *p) { return 0.5 * v3_norm(normal2(p)); }

static double to_edge(skf_vec3 a, skf_vec3 b, skf_vec3 x) {
  skf_primitive s = {.shape = SKF_SEGMENT, .segment = {a, b}};
  return skf_shape_segment.distance(&s, x);
}

static double distance(const skf_primitive *p, skf_vec3 x) {
  const skf_vec3 *v = p->triangle.vertices;
  skf_vec3 n = v3_unit(normal2(p));
  bool inside = true;
  double edge = INFINITY;
  for (int i = 0; i < 3; i++) {
    skf_vec3 a = v[i], b = v[(i + 1) % 3];
    if (v3_dot(v3_cross(v3_sub(b, a), v3_sub(x, a)), n) < 0) inside = false;
    edge = fmin(edge, to_edge(a, b, x));
  }
  return inside ? fabs(v3_dot(v3_sub(x, v[0]), n)) : edge;
}

static double distance_max(const skf_primitive *p, skf_vec3 x) {
  const skf_vec3 *v = p->triangle.vertices;
  return fmax(v3_dist(x, v[0]), fmax(v3_dist(x, v[1]), v3_dist(x, v[2])));
}

static skf_box bounds(const skf_primitive *p) {
  const skf_vec3 *v = p->triangle.vertices;
  return box_add(box_add((skf_box){v[0], v[0]}, v[1]), v[2]);
}

static skf_vec3 at(const skf_primitive *p, double s, double t) { /* uniform in area */
  const skf_vec3 *v = p->triangle.vertices;
  double r = sqrt(s);
  return v3_add(v3_scale(1 - r, v[0]), v3_add(v3_scale(r * (1 - t), v[1]), v3_scale(r * t, v[2])));
}

static const skf_param params[] = {
    {"vertices", "L", "its three corners", SKF_PARAM_VECTORS, 3, offsetof(skf_primitive, triangle.vertices), 0, 0},
};

const skf_shape_ops skf_shape_triangle = {{"triangle", "flat triangle; its measure is area", "L^2", params, 1},
                                          degenerate,
                                          measure,
                                          distance,
                                          distance_max,
                                          bounds,
                                          at};
