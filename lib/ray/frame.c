/* SPDX-License-Identifier: MIT */
#include "ray/frame.h"

static skf_vec3 times(skf_vec3 a, int power) { return v3(ldexp(a.x, power), ldexp(a.y, power), ldexp(a.z, power)); }

/* One coordinate of o + (s + u) d, to rounding of what it is rather than of o: s d is exact in two parts, so is the sum
   of its larger one and o. */
static double along(double o, double s, double u, double d, double *near) {
  double p = s * d, rest = fma(s, d, -p), h = o + p, back = h - o;
  double lost = (o - (h - back)) + (p - back);
  *near = h + (lost + rest);
  return fma(u, d, h) + (lost + rest);
}

/* Begins the ray next to the region that the tracer's surface is in. */
static void begin_near(skf_frame *f) {
  const skf_tracer *t = f->tracer;
  skf_vec3 o = f->ray.origin, d = f->ray.direction, q = o, middle = t->middle;
  int power;
  frexp(fmax(fabs(d.x), fmax(fabs(d.y), fabs(d.z))), &power);
  d = times(d, -power);
  double n2 = v3_norm2(d), n = sqrt(n2), s = v3_dot(v3_sub(middle, o), d) / n2, u = 0;
  if (!(n2 > 0) || !isfinite(s)) return;
  for (int i = 0; i < 3; i++) along(v3_get(o, i), s, 0, v3_get(d, i), v3_at(&q, i));
  u = (v3_dot(v3_sub(middle, q), d) / n - box_diagonal(t->region)) / n;
  if (!(s + u > 0)) return;
  for (int i = 0; i < 3; i++) *v3_at(&f->ray.origin, i) = along(v3_get(o, i), s, u, v3_get(d, i), v3_at(&q, i));
  f->ahead = (s + u) * n;
  f->ray.direction = d;
  f->ray.t_min -= f->ahead, f->ray.t_max -= f->ahead;
}

skf_frame skf_frame_of(const skf_tracer *tracer, const skf_ray *ray) {
  skf_frame f = {.tracer = tracer, .ray = *ray};
  if (!v3_finite(ray->origin) || !v3_finite(ray->direction) || !isfinite(ray->t_min)) return f; /* is refused */
  if (tracer->copy) {
    f.tracer = tracer->copy;
    f.ray.origin = times(ray->origin, tracer->power);
    f.ray.t_min = ldexp(ray->t_min, tracer->power), f.ray.t_max = ldexp(ray->t_max, tracer->power);
    f.lost = !v3_finite(f.ray.origin) || !isfinite(f.ray.t_min);
  }
  if (!f.lost && v3_norm2(v3_sub(f.ray.origin, f.tracer->middle)) > f.tracer->far2) begin_near(&f);
  return f;
}

void skf_frame_leave(const skf_frame *f, const skf_tracer *tracer, skf_hit *hit) {
  hit->t += f->ahead;
  if (f->tracer == tracer) return;
  hit->t = ldexp(hit->t, -tracer->power);
  hit->at = times(hit->at, -tracer->power);
}
