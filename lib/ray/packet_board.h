/* SPDX-License-Identifier: MIT */
/* Rays made ready side by side, with the bits of `begin` in ask.c. */
#ifndef SKF_RAY_PACKET_BOARD_H
#define SKF_RAY_PACKET_BOARD_H

#include "ray/packet.h"
#include "simd/vec.h"
#include <float.h>

SKF_INLINE skf_vd largest_of(skf_vd x, skf_vd y, skf_vd z) { return vd_max(vd_abs(x), vd_max(vd_abs(y), vd_abs(z))); }

/* One of its coordinates, of four rays that follow each other. */
SKF_INLINE skf_vd coordinate(const double *first) {
  enum { STRIDE = sizeof(skf_ray) / sizeof(double) };
  double x[SKF_LANES];
  for (int k = 0; k < SKF_LANES; k++) x[k] = first[STRIDE * k];
  return vd_load(x);
}

/* Cuts the rays off at the region's walls across axis i. */
SKF_INLINE skf_vi clip_axis(const skf_tracer *t, int i, skf_vd o, skf_vd d, skf_vd *from, skf_vd *to) {
  skf_vd zero = vd_set(0), lo = vd_set(v3_get(t->region.lo, i)) - o, hi = vd_set(v3_get(t->region.hi, i)) - o;
  skf_vd slack = vd_set(4 * DBL_EPSILON) * vd_abs(o), per = vd_set(1) / d, enter = (lo - slack) * per,
         leave = (hi + slack) * per;
  skf_vi flat = d == zero;
  *from = vd_select(flat, *from, vd_max(*from, vd_min(enter, leave)));
  *to = vd_select(flat, *to, vd_min(*to, vd_max(enter, leave)));
  return ~(flat & ((lo > zero) | (hi < zero)));
}

/* Four rays into the lanes from `at`: those that miss the region, and those that the octree takes. */
SKF_INLINE void board_four(skf_packet *p, int at, const skf_ray *rays, unsigned *missed, unsigned *on,
                           unsigned backwards[3]) {
  const skf_tracer *t = p->tracer;
  const double *r = &rays->origin.x;
  skf_vd o[3], d[3], zero = vd_set(0), from = coordinate(&rays->t_min), to = coordinate(&rays->t_max), huge;
  for (int i = 0; i < 3; i++) o[i] = coordinate(r + i), d[i] = coordinate(r + 3 + i);
  huge = vd_set(DBL_MAX);
  skf_vd m = largest_of(d[0], d[1], d[2]), far = largest_of(o[0], o[1], o[2]);
  /* NaNs fail one of these: their sums are NaN */
  skf_vd sums = o[0] + o[1] + o[2] + d[0] + d[1] + d[2];
  skf_vi valid =
      (m > zero) & (m <= huge) & (far <= huge) & (vd_abs(sums) <= huge) & (vd_abs(from) <= huge) & (to == to);
  for (int i = 0; i < 3; i++) d[i] = d[i] / m;
  skf_vd n = vd_sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  for (int i = 0; i < 3; i++) d[i] = d[i] / n;
  skf_vi meets = ~(from > to);
  for (int i = 0; i < 3; i++) meets &= clip_axis(t, i, o[i], d[i], &from, &to);
  meets &= from <= to;
  skf_vd size = far + largest_of(o[0] + to * d[0], o[1] + to * d[1], o[2] + to * d[2]);
  skf_vd shift = vd_set(8 * DBL_EPSILON) * size;
  skf_vi fits = vd_set(2) * shift < vd_set(1e-8 * skf_octree_least(t->tree));
  for (int i = 0; i < 3; i++) {
    skf_vd big = vd_set(1e300),
           per = vd_select(vd_abs(d[i]) > vd_set(1e-300), vd_set(1) / d[i], vd_select(d[i] < zero, -big, big));
    vd_store(p->o[i] + at, o[i]), vd_store(p->d[i] + at, d[i]), vd_store(p->per[i] + at, per);
    backwards[i] |= (unsigned)vi_bits(d[i] < zero) << at;
  }
  vd_store(p->from + at, from), vd_store(p->to + at, to), vd_store(p->shift + at, shift);
  *missed |= (unsigned)vi_bits(valid & ~meets) << at, *on |= (unsigned)vi_bits(valid & meets & fits) << at;
}

/* Takes eight rays on board if those that go through the octree go the same way; false: they must be asked one by one,
   or in other company. */
SKF_INLINE bool board_all(skf_packet *p, const skf_ray *rays) {
  unsigned missed = 0, on = 0, backwards[3] = {0, 0, 0};
  for (int v = 0; v < SKF_PACKET / SKF_LANES; v++)
    board_four(p, SKF_LANES * v, rays + SKF_LANES * v, &missed, &on, backwards);
  if ((missed | on) != (1u << SKF_PACKET) - 1) return false;
  p->backwards = 0;
  for (int i = 0; i < 3; i++) {
    unsigned b = backwards[i] & on;
    if (b && b != on) return false;
    p->backwards |= (b != 0) << i;
  }
  p->alive = on;
  return true;
}

#endif
