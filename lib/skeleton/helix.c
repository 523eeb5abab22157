/* SPDX-License-Identifier: MIT */
/* Helices, conical helices, plane spirals. */
#include "skeleton/curve.h"

/* The helix about the axis n at a power of two of its size. */
typedef struct course {
  skf_vec3 center;
  skf_arc_axes axes;
  double angle, rise; /* in all */
  double r0, r1, growth;
  bool logarithmic;
} course;

static void at(const void *user, double t, int side, skf_vec3 *x, skf_vec3 *direction) {
  (void)side;
  const course *c = user;
  double phi = t * c->angle, r = c->r0 + t * (c->r1 - c->r0), slope = c->r1 - c->r0;
  if (c->logarithmic) r = c->r0 * exp(t * c->growth), slope = r * c->growth;
  double cs = cos(phi), sn = sin(phi);
  skf_vec3 out = v3_mad(v3_scale(cs, c->axes.e), sn, c->axes.f),
           ahead = v3_mad(v3_scale(cs, c->axes.f), -sn, c->axes.e);
  *x = v3_mad(v3_mad(c->center, r, out), t * c->rise, c->axes.n);
  *direction = v3_mad(v3_mad(v3_scale(slope, out), r * c->angle, ahead), c->rise, c->axes.n);
}

static skf_status check(const skf_helix *h) {
  skf_vec3 n = v3_unit(h->axis), s = v3_unit(h->start);
  if (!v3_finite(h->center) || !v3_finite(h->axis) || !v3_finite(h->start)) return SKF_ERR_RANGE;
  if (!(h->radius >= 0 && h->end_radius >= 0) || !isfinite(h->radius + h->end_radius + h->pitch)) return SKF_ERR_RANGE;
  if (!(h->turns > 0 && h->turns <= SKF_HELIX_TURNS)) return SKF_ERR_RANGE;
  if (h->logarithmic && !(h->radius > 0 && h->end_radius > 0)) return SKF_ERR_RANGE;
  if (!(v3_norm(n) > 0) || !(v3_norm(v3_cross(n, s)) > 1e-12)) return SKF_ERR_DEGENERATE;
  if (!(fmax(h->radius, h->end_radius) > 0)) return SKF_ERR_DEGENERATE;
  return h->pitch == 0 && h->radius == h->end_radius && h->turns > 1 ? SKF_ERR_DEGENERATE : SKF_OK;
}

skf_status skf_helix_cut(const skf_helix *h, double tolerance, skf_primitive *pieces, size_t capacity, size_t *count) {
  *count = 0;
  skf_status s = check(h);
  if (s) return s;
  int power;
  double size = fmax(h->radius, h->end_radius);
  frexp(fmax(size, fabs(h->pitch) * h->turns), &power);
  if (power < -1000 || power > 1000 || !isfinite(h->pitch * h->turns)) return SKF_ERR_RANGE;
  if (tolerance == 0) tolerance = SKF_CURVE_TOLERANCE * size;
  if (!(tolerance >= 1e-10 * size && tolerance <= 0.1 * size)) return SKF_ERR_RANGE;
  double in = ldexp(1, -power);
  course c = {.center = v3_scale(in, h->center),
              .axes = skf_arc_frame(&(skf_arc){.normal = h->axis, .start = h->start}),
              .angle = 2 * SKF_PI * h->turns,
              .rise = in * h->pitch * h->turns,
              .r0 = in * h->radius,
              .r1 = in * h->end_radius,
              .growth = h->logarithmic ? log(h->end_radius / h->radius) : 0,
              .logarithmic = h->logarithmic};
  return skf_curve_cut_scaled(&(skf_curve){at, &c, (int)ceil(4 * h->turns)}, in * tolerance, power, pieces, capacity,
                              count);
}
