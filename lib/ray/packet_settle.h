/* SPDX-License-Identifier: MIT */
/* Crossings that wait for the field, four at a time. */
#ifndef SKF_RAY_PACKET_SETTLE_H
#define SKF_RAY_PACKET_SETTLE_H

#include "ray/room.h"
#include "simd/vec.h"
#include <float.h>

/* What the third and the fourth derivatives of a leaf's model may be beside its `bend`, the sum of what the powers
   amount to; in units of half the cell. */
#define THIRD  (SKF_DEGREE - 2.)
#define FOURTH ((SKF_DEGREE - 2.) * (SKF_DEGREE - 3.))
/* Normals that are off by less are right to rounding. */
#define STRAIGHT 1e-14

SKF_INLINE void settle_four(const skf_tracer *tracer, skf_room *r, size_t i, size_t m, const skf_sights *at,
                            bool *done) {
  skf_vd d[3], g[3], x[3], root[3], t = vd_load(r->t + i), f = vd_load(at->F + i), zero = vd_set(0), half = vd_set(0.5);
  for (int k = 0; k < 3; k++) {
    d[k] = vd_load(r->d[k] + i), g[k] = vd_load(at->g[k] + i);
    x[k] = vd_load(r->o[k] + i) + t * d[k];
  }
  skf_vd slope = g[0] * d[0] + g[1] * d[1] + g[2] * d[2], per = vd_set(1) / slope, s = -f * per;
  skf_vd steep = vd_sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  skf_vd eps = vd_set(DBL_EPSILON), grain = eps * vd_max(vd_abs(x[0]), vd_max(vd_abs(x[1]), vd_abs(x[2])));
  skf_vd c2 = vd_load(r->c2 + i), c3 = vd_load(r->c3 + i), bend = vd_load(r->bend + i);
  for (int k = 0; k < 2; k++) s = -(f + s * s * (c2 + s * c3)) * per;
  skf_vd size = vd_abs(s), part = size * vd_load(r->per + i), rest = part * bend;
  skf_vd error = half * (vd_load(r->off + i) + vd_set(0.5 * FOURTH) * part * rest) * s * s;
  skf_vi near = size <= vd_set(4) * grain;
  skf_vi good = (error <= vd_set(2) * eps * vd_load(at->size + i)) | (error <= vd_set(2) * grain * vd_abs(slope));
  skf_vi straight = near | (size * bend <= vd_set(STRAIGHT) * steep);
  skf_vd loose = size * (vd_load(r->loose + i) + vd_set(0.5 * THIRD) * rest);
  skf_vi turned = loose < vd_set(tracer->normals) * steep;
  skf_vd next = t + s, from = vd_load(r->from + i), to = vd_load(r->to + i);
  skf_vi inside = (next >= from) & (next <= to); /* else the bounds do not hold all the way */
  skf_vi end = near | (good & inside & (straight | turned));
  t = next;
  for (int k = 0; k < 3; k++) {
    root[k] = vd_load(r->o[k] + i) + t * d[k];
    g[k] = vd_select(straight, g[k], g[k] + s * vd_load(r->turn[k] + i));
  }
  skf_vd largest = vd_max(vd_abs(g[0]), vd_max(vd_abs(g[1]), vd_abs(g[2])));
  for (int k = 0; k < 3; k++) g[k] = g[k] / largest;
  skf_vd length = vd_sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  vd_store(r->t + i, vd_max(vd_min(t, to), from));
  vd_store(r->c2 + i, zero), vd_store(r->c3 + i, zero); /* beside the next place all is known by its bounds */
  vd_store(r->off + i, bend), vd_store(r->loose + i, bend);
  for (int k = 0; k < 3; k++) vd_store(r->turn[k] + i, zero);
  unsigned ends = (unsigned)vi_bits(end);
  for (size_t k = 0; k < SKF_LANES && i + k < m; k++) {
    done[i + k] = ends >> k & 1;
    if (!done[i + k]) continue;
    skf_vec3 place = {root[0][k], root[1][k], root[2][k]};
    skf_vec3 normal = {-g[0][k] / length[k], -g[1][k] / length[k], -g[2][k] / length[k]};
    *r->hit[i + k] = (skf_hit){t[k], place, normal, r->to_f[i + k] > r->from_f[i + k]};
  }
}

SKF_INLINE void settle_all(const skf_tracer *tracer, skf_room *r, size_t m, const skf_sights *at, bool *done) {
  for (size_t i = 0; i < m; i += SKF_LANES) settle_four(tracer, r, i, m, at, done);
}

#endif
