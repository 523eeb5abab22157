/* SPDX-License-Identifier: MIT */
#include "field/simple.h"

/* h += a I + b d d^T */
static void add_isotropic(double a, double b, skf_vec3 d, double h[6]) {
  h[0] += a + b * d.x * d.x, h[1] += b * d.x * d.y, h[2] += b * d.x * d.z;
  h[3] += a + b * d.y * d.y, h[4] += b * d.y * d.z, h[5] += a + b * d.z * d.z;
}

void skf_point_result(const double h[4], skf_dd3 d, int order, skf_value *v) {
  skf_vec3 r = dd3_round(d);
  v->F = h[0];
  v->g = v3_scale(2 * h[1], r);
  if (order > 1) add_isotropic(2 * h[1], 4 * h[2], r, v->h);
}

skf_vec3 skf_plane_seen(const skf_prepared *e, skf_vec3 x, skf_vec3 rest) {
  const skf_vec3 n = e->plan.plane.raw;
  if ((n.x != 0) + (n.y != 0) + (n.z != 0) != 1) return x;
  return v3(n.x != 0 ? x.x : rest.x, n.y != 0 ? x.y : rest.y, n.z != 0 ? x.z : rest.z);
}

double skf_plane_height(const skf_prepared *e, skf_vec3 x) {
  return dd3_dot_d(dd3_diff(x, e->primitive.plane.through), e->plan.plane.raw) / e->plan.plane.length;
}

void skf_plane_result(const skf_prepared *e, double F, double slope, double curvature, int order, skf_value *v) {
  v->F = F;
  v->g = v3_scale(slope, e->plan.plane.unit);
  if (order > 1) add_isotropic(0, curvature, e->plan.plane.unit, v->h);
}
