/* SPDX-License-Identifier: MIT */
/* Cubic Bezier curves. */
#include "skeleton/curve.h"

static double hull_length(const skf_vec3 q[4]) {
  return v3_dist(q[0], q[1]) + v3_dist(q[1], q[2]) + v3_dist(q[2], q[3]);
}

/* Direction in which the curve leaves q[0]: to the first control point that is elsewhere. */
static skf_vec3 leaving(const skf_vec3 q[4]) {
  double nothing = 1e-9 * hull_length(q); /* a shorter handle bends less than any tolerance notices */
  int k = 1;
  while (k < 3 && !(v3_dist(q[0], q[k]) > nothing)) k++;
  return v3_sub(q[k], q[0]);
}

static skf_vec3 mix(skf_vec3 a, skf_vec3 b, double t) { return v3_add(v3_scale(1 - t, a), v3_scale(t, b)); }

/* By the parts before and behind t [de Casteljau], whose handles give the tangents of cusps, too. */
static void at(const void *user, double t, int side, skf_vec3 *x, skf_vec3 *direction) {
  const skf_vec3 *q = user;
  skf_vec3 a = mix(q[0], q[1], t), b = mix(q[1], q[2], t), c = mix(q[2], q[3], t);
  skf_vec3 ab = mix(a, b, t), bc = mix(b, c, t);
  *x = mix(ab, bc, t);
  if (side > 0)
    *direction = leaving((const skf_vec3[4]){*x, bc, c, q[3]});
  else
    *direction = v3_scale(-1, leaving((const skf_vec3[4]){*x, ab, a, q[0]}));
}

skf_status skf_bezier_cut(const skf_vec3 p[4], double tolerance, skf_primitive *pieces, size_t capacity,
                          size_t *count) {
  skf_box box = box_empty();
  *count = 0;
  for (int k = 0; k < 4; k++) {
    if (!v3_finite(p[k])) return SKF_ERR_RANGE;
    box = box_add(box, p[k]);
  }
  int power;
  double extent = fmax(box.hi.x - box.lo.x, fmax(box.hi.y - box.lo.y, box.hi.z - box.lo.z));
  if (!(extent > 0)) return SKF_ERR_DEGENERATE;
  frexp(extent, &power);
  if (!isfinite(extent) || power < -1000 || power > 1000) return SKF_ERR_RANGE;
  skf_vec3 q[4];
  for (int k = 0; k < 4; k++) q[k] = v3_scale(ldexp(1, -power), p[k]);
  double size = hull_length(q), within = tolerance == 0 ? SKF_CURVE_TOLERANCE * size : ldexp(tolerance, -power);
  if (!(within >= 1e-10 * size && within <= 0.1 * size)) return SKF_ERR_RANGE;
  return skf_curve_cut_scaled(&(skf_curve){at, q, 1}, within, power, pieces, capacity, count);
}
