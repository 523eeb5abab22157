/* SPDX-License-Identifier: MIT */
/* Bounds of a solid's field: its volume is thought to lie as near as it can. */
#include "field/solid.h"
#include "field/bound.h"

/* int dV / r^k over the shell d <= r <= e that holds the volume: e^3 = d^3 + cube. Inside at a distance d from the
   surface the ball of radius d is full: its field is a paraboloid with the Hessian -4 pi / 3. The strongest pull of any
   body of this volume is (3 / 5) 5^(1/3) times that of a ball at its surface. */
skf_envelope skf_solid_envelope(double volume, double d, double d_out) {
  double cube = 3 * volume / (4 * SKF_PI), a = d_out, e = cbrt(a * a * a + cube);
  double thick = cube / (e * e + e * a + a * a);
  skf_envelope v = {2 * SKF_PI * thick * (e + a), fmin(4 * SKF_PI * thick, 4.2977 * cbrt(cube)), INFINITY, INFINITY};
  if (!(d > 0)) return v;
  e = cbrt(d * d * d + cube), thick = cube / (e * e + e * d + d * d);
  v.bend = 8 * SKF_PI / 3 * log1p(cube / (d * d * d)) + (d_out > 0 ? 0 : 4 * SKF_PI / 3);
  v.fourth = 48 * SKF_PI * thick * (e + d) / (d * d * e * e);
  return v;
}

/* At each place p the solid is cut by a ball of radius D about p that no edge enters. What is outside gives 8 pi int
   dr / r; what is inside is bounded by a part of the sphere, which gives at most 4 pi, and by whole discs, each of
   which gives n n' times its solid angle. */
double skf_solid_bend(const skf_solid *s, skf_vec3 center, double radius) {
  enum { MOST = 64 };
  double D = skf_solid_to_edges(s, center, s->radius) * (1 - 1e-12) - radius;
  if (!(D > 0)) return INFINITY;
  size_t discs = skf_solid_faces_within(s, center, (D + radius) * (1 + 1e-12), MOST);
  if (discs == MOST) return INFINITY;
  double cube = 3 * s->info.volume / (4 * SKF_PI);
  return 4 * SKF_PI + 2 * SKF_PI * (double)discs + 8 * SKF_PI / 3 * log1p(cube / (D * D * D));
}

skf_envelope skf_solid_around(const skf_solid *s, skf_vec3 center, double radius) {
  double surface = skf_solid_to_surface(s, center), slack = 1e-12 * (s->radius + v3_dist(center, s->info.center));
  bool inside = skf_solid_contains(s, center);
  double d = fmax(surface - radius - slack, 0);
  skf_envelope v = skf_solid_envelope(s->info.volume, d, inside ? 0 : d);
  if (d == 0) v.bend = skf_solid_bend(s, center, radius + slack);
  return v;
}
