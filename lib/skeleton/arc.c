/* SPDX-License-Identifier: MIT */
#include "skeleton/shape.h"

skf_arc_axes skf_arc_frame(const skf_arc *a) {
  skf_arc_axes x;
  x.n = v3_unit(a->normal);
  skf_vec3 s = v3_unit(a->start);
  x.e = v3_unit(v3_mad(s, -v3_dot(s, x.n), x.n));
  x.f = v3_cross(x.n, x.e);
  return x;
}

skf_arc skf_arc_circle(skf_vec3 center, skf_vec3 normal, double radius) {
  return (skf_arc){center, normal, v3_perp(v3_unit(normal)), radius, 2 * SKF_PI};
}

static const char *degenerate(const skf_primitive *p) {
  skf_vec3 n = v3_unit(p->arc.normal), s = v3_unit(p->arc.start);
  if (!(v3_norm(n) > 0)) return "arc with a zero normal";
  if (!(v3_norm(s) > 0)) return "arc with a zero start direction";
  if (!(v3_norm(v3_cross(n, s)) > 1e-12)) return "arc whose start is parallel to its normal";
  return NULL;
}

static double measure(const skf_primitive *p) { return p->arc.radius * p->arc.sweep; }

static skf_vec3 at(const skf_primitive *p, double s, double t) {
  (void)t;
  const skf_arc *a = &p->arc;
  skf_arc_axes x = skf_arc_frame(a);
  double phi = s * a->sweep;
  return v3_mad(v3_mad(a->center, a->radius * cos(phi), x.e), a->radius * sin(phi), x.f);
}

/* Nearest (sign = 1) or farthest (sign = -1) distance: the extremum of the circle where the arc has it, else an end. */
static double extreme(const skf_primitive *p, skf_vec3 q, double sign) {
  const skf_arc *a = &p->arc;
  skf_arc_axes x = skf_arc_frame(a);
  skf_vec3 d = v3_sub(q, a->center);
  double dx = v3_dot(d, x.e), dy = v3_dot(d, x.f), dz = v3_dot(d, x.n), k = hypot(dx, dy);
  double phi = atan2(sign * dy, sign * dx);
  if (phi < 0) phi += 2 * SKF_PI;
  if (phi <= a->sweep) return hypot(k - sign * a->radius, dz);
  double d0 = v3_dist(q, at(p, 0, 0)), d1 = v3_dist(q, at(p, 1, 0));
  return sign > 0 ? fmin(d0, d1) : fmax(d0, d1);
}

static double distance(const skf_primitive *p, skf_vec3 q) { return extreme(p, q, 1); }
static double distance_max(const skf_primitive *p, skf_vec3 q) { return extreme(p, q, -1); }

static skf_box bounds(const skf_primitive *p) {
  const skf_arc *a = &p->arc;
  skf_arc_axes x = skf_arc_frame(a);
  skf_vec3 p0 = at(p, 0, 0);
  skf_box b = box_add((skf_box){p0, p0}, at(p, 1, 0));
  for (int i = 0; i < 3; i++) {
    double top = atan2(v3_get(x.f, i), v3_get(x.e, i)); /* where coordinate i is largest */
    for (int k = 0; k < 2; k++) {
      double phi = top + k * SKF_PI;
      if (phi < 0) phi += 2 * SKF_PI;
      if (phi <= a->sweep) b = box_add(b, at(p, phi / a->sweep, 0));
    }
  }
  return b;
}

static const skf_param params[] = {
    {"center", "L", "centre of the circle", SKF_PARAM_VECTOR, 1, offsetof(skf_primitive, arc.center), 0, 0},
    {"normal", "1", "axis; it is normalised", SKF_PARAM_VECTOR, 1, offsetof(skf_primitive, arc.normal), 0, 0},
    {"start", "1", "direction from the centre to the start; projected onto the plane and normalised", SKF_PARAM_VECTOR,
     1, offsetof(skf_primitive, arc.start), 0, 0},
    {"radius", "L", "radius of the circle", SKF_PARAM_NUMBER, 1, offsetof(skf_primitive, arc.radius), 0, INFINITY},
    {"sweep", "deg", "turn about the normal by the right-hand rule; 360 is the full circle", SKF_PARAM_ANGLE, 1,
     offsetof(skf_primitive, arc.sweep), 0, 2 * SKF_PI},
};

const skf_shape_ops skf_shape_arc = {{"arc", "circular arc; its measure is length", "L", params, 5},
                                     degenerate,
                                     measure,
                                     distance,
                                     distance_max,
                                     bounds,
                                     at};
