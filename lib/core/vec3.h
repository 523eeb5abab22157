/* SPDX-License-Identifier: MIT */
/* Small vector algebra, inline. */
#ifndef SKF_CORE_VEC3_H
#define SKF_CORE_VEC3_H

#include "skelfield/core.h"
#include <math.h>

#define SKF_PI 3.14159265358979323846

static inline skf_vec3 v3(double x, double y, double z) { return (skf_vec3){x, y, z}; }
static inline skf_vec3 v3_add(skf_vec3 a, skf_vec3 b) { return v3(a.x + b.x, a.y + b.y, a.z + b.z); }
static inline skf_vec3 v3_sub(skf_vec3 a, skf_vec3 b) { return v3(a.x - b.x, a.y - b.y, a.z - b.z); }
static inline skf_vec3 v3_scale(double s, skf_vec3 a) { return v3(s * a.x, s * a.y, s * a.z); }
/* a + s b */
static inline skf_vec3 v3_mad(skf_vec3 a, double s, skf_vec3 b) {
  return v3(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}
static inline double v3_dot(skf_vec3 a, skf_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline skf_vec3 v3_cross(skf_vec3 a, skf_vec3 b) {
  return v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline double v3_norm2(skf_vec3 a) { return v3_dot(a, a); }
static inline double v3_norm(skf_vec3 a) { return sqrt(v3_dot(a, a)); }
static inline double v3_dist(skf_vec3 a, skf_vec3 b) { return v3_norm(v3_sub(a, b)); }
/* a / |a|; the zero vector stays zero. Safe from overflow and underflow. */
static inline skf_vec3 v3_unit(skf_vec3 a) {
  double m = fmax(fabs(a.x), fmax(fabs(a.y), fabs(a.z)));
  if (!(m > 0)) return a;
  a = v3(a.x / m, a.y / m, a.z / m);
  double n = v3_norm(a);
  return v3(a.x / n, a.y / n, a.z / n);
}
static inline bool v3_finite(skf_vec3 a) { return isfinite(a.x) && isfinite(a.y) && isfinite(a.z); }
static inline double *v3_at(skf_vec3 *a, int i) { return i == 0 ? &a->x : i == 1 ? &a->y : &a->z; }
static inline double v3_get(skf_vec3 a, int i) { return i == 0 ? a.x : i == 1 ? a.y : a.z; }
/* A unit vector perpendicular to the unit vector n. */
static inline skf_vec3 v3_perp(skf_vec3 n) {
  skf_vec3 a = fabs(n.x) <= fabs(n.y) && fabs(n.x) <= fabs(n.z) ? v3(1, 0, 0)
               : fabs(n.y) <= fabs(n.z)                         ? v3(0, 1, 0)
                                                                : v3(0, 0, 1);
  return v3_unit(v3_mad(a, -v3_dot(a, n), n));
}

static inline skf_box box_empty(void) {
  return (skf_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}
static inline skf_box box_add(skf_box b, skf_vec3 p) {
  return (skf_box){{fmin(b.lo.x, p.x), fmin(b.lo.y, p.y), fmin(b.lo.z, p.z)},
                   {fmax(b.hi.x, p.x), fmax(b.hi.y, p.y), fmax(b.hi.z, p.z)}};
}
static inline skf_box box_join(skf_box a, skf_box b) {
  return (skf_box){{fmin(a.lo.x, b.lo.x), fmin(a.lo.y, b.lo.y), fmin(a.lo.z, b.lo.z)},
                   {fmax(a.hi.x, b.hi.x), fmax(a.hi.y, b.hi.y), fmax(a.hi.z, b.hi.z)}};
}
static inline skf_box box_grow(skf_box b, double m) {
  return (skf_box){{b.lo.x - m, b.lo.y - m, b.lo.z - m}, {b.hi.x + m, b.hi.y + m, b.hi.z + m}};
}
static inline skf_vec3 box_center(skf_box b) { return v3_scale(0.5, v3_add(b.lo, b.hi)); }
static inline double box_diagonal(skf_box b) { return v3_dist(b.lo, b.hi); }

#endif
