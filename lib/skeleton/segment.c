/* SPDX-License-Identifier: MIT */
#include "skeleton/shape.h"

static const char *degenerate(const skf_primitive *p) {
  return v3_dist(p->segment.from, p->segment.to) > 0 ? NULL : "segment of zero length";
}

static double measure(const skf_primitive *p) { return v3_dist(p->segment.from, p->segment.to); }

static double distance(const skf_primitive *p, skf_vec3 x) {
  skf_vec3 e = v3_sub(p->segment.to, p->segment.from), d = v3_sub(x, p->segment.from);
  double u = v3_dot(d, e) / v3_norm2(e);
  if (u <= 0) return v3_norm(d);
  if (u >= 1) return v3_dist(x, p->segment.to);
  return v3_norm(v3_cross(d, e)) / v3_norm(e);
}

static double distance_max(const skf_primitive *p, skf_vec3 x) {
  return fmax(v3_dist(x, p->segment.from), v3_dist(x, p->segment.to));
}

static skf_box bounds(const skf_primitive *p) {
  return box_add((skf_box){p->segment.from, p->segment.from}, p->segment.to);
}

static skf_vec3 at(const skf_primitive *p, double s, double t) {
  (void)t;
  return v3_add(v3_scale(1 - s, p->segment.from), v3_scale(s, p->segment.to));
}

static const skf_param params[] = {
    {"from", "L", "one end", SKF_PARAM_VECTOR, 1, offsetof(skf_primitive, segment.from), 0, 0},
    {"to", "L", "the other end", SKF_PARAM_VECTOR, 1, offsetof(skf_primitive, segment.to), 0, 0},
};

const skf_shape_ops skf_shape_segment = {{"segment", "straight segment; its measure is length", "L", params, 2},
                                         degenerate,
                                         measure,
                                         distance,
                                         distance_max,
                                         bounds,
                                         at};
