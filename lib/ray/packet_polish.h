/* SPDX-License-Identifier: MIT */
/* Hits among blobs polished side by side, as skf_walk_polish does it. */
#ifndef SKF_RAY_PACKET_POLISH_H
#define SKF_RAY_PACKET_POLISH_H

#include "num/gauss.h"
#include "ray/packet_ways.h"
#include <float.h>

typedef struct skf_view {
  skf_vd F, size, x, y, z, gx, gy, gz;
} skf_view;

/* Adds a segment at p - at: by Gauss nodes, which are exact for the polynomial, as field/polynomial.c. */
SKF_INLINE void add_segment(const skf_blob *b, skf_vd x, skf_vd y, skf_vd z, skf_view *s) {
  skf_vd ax = vd_set(b->axis.x), ay = vd_set(b->axis.y), az = vd_set(b->axis.z), zero = vd_set(0), half = vd_set(0.5);
  skf_vd along = x * ax + y * ay + z * az, c2 = vd_set(b->c2), c3 = vd_set(b->c3), F = zero, by_m = zero;
  x -= along * ax, y -= along * ay, z -= along * az, along *= vd_set(b->per_R);
  skf_vd m = vd_max(vd_set(1) - (x * x + y * y + z * z) * vd_set(b->per), zero), T = vd_sqrt(m);
  skf_vd lo = vd_min(vd_max(-along, -T), T), hi = vd_max(vd_min(vd_set(b->span) - along, T), -T);
  skf_vd long_half = half * (hi - lo), middle = half * (hi + lo);
  int n = b->c3 > 0 ? 4 : 3;
  const skf_gauss_node *node = skf_gauss_rule(n);
  for (int j = 0; j < n; j++) {
    skf_vd t = middle + long_half * vd_set(node[j].x), q = vd_max((T - t) * (T + t), zero), w = vd_set(node[j].w) * q;
    F += w * q * (c2 + c3 * q), by_m += w * (vd_set(2) * c2 + vd_set(3) * c3 * q);
  }
  skf_vd q0 = vd_max((T - lo) * (T + lo), zero), q1 = vd_max((T - hi) * (T + hi), zero), w = vd_set(b->moment);
  skf_vd ends = vd_set(b->strength) * (q0 * q0 * (c2 + c3 * q0) - q1 * q1 * (c2 + c3 * q1));
  F *= w * long_half, by_m *= w * long_half;
  s->F += F, s->size += by_m;
  skf_vd k = vd_set(-2 * b->per) * by_m;
  s->gx += k * x + ends * ax, s->gy += k * y + ends * ay, s->gz += k * z + ends * az;
}

SKF_INLINE skf_view view_at(const skf_packet *p, const skf_leaf *leaf, const skf_ways *ways, int v, skf_vd t) {
  int at = SKF_LANES * v;
  skf_vd zero = vd_set(0), one = vd_set(1), two = vd_set(2), three = vd_set(3);
  skf_view s = {.F = zero, .size = zero, .gx = zero, .gy = zero, .gz = zero};
  s.x = vd_load(p->o[0] + at) + t * vd_load(p->d[0] + at), s.y = vd_load(p->o[1] + at) + t * vd_load(p->d[1] + at);
  s.z = vd_load(p->o[2] + at) + t * vd_load(p->d[2] + at);
  for (unsigned left = ways->met[v]; left; left &= left - 1) {
    int i = __builtin_ctz(left);
    const skf_blob *b = leaf->blobs + i;
    skf_vd x = s.x - vd_set(b->at.x), y = s.y - vd_set(b->at.y), z = s.z - vd_set(b->at.z);
    if (b->length > 0) {
      add_segment(b, x, y, z, &s);
      continue;
    }
    skf_vd m = vd_max(one - (x * x + y * y + z * z) * vd_set(b->per), zero), k, value;
    m = vd_select(ways->of[i][v].peak > zero, m, zero);
    skf_vd sm = vd_set(b->strength) * m;
    if (leaf->soft) {
      skf_vd c2 = vd_set(b->c2), c3m = vd_set(b->c3) * m;
      value = sm * m * (c2 + c3m), k = vd_set(-2 * b->per) * sm * (two * c2 + three * c3m);
    } else {
      value = sm * m, k = vd_set(-4 * b->per) * sm;
    }
    s.F += value, s.size += sm;
    s.gx += k * x, s.gy += k * y, s.gz += k * z;
  }
  return s;
}

typedef struct skf_polished {
  skf_vd t, at[3], normal[3];
  skf_vi done;
} skf_polished;

SKF_INLINE skf_vi polish_step(const skf_packet *p, const skf_leaf *leaf, const skf_ways *ways, int v, skf_vd lo,
                              skf_vd hi, skf_vi on, skf_vd *t, skf_polished *out) {
  int at = SKF_LANES * v;
  skf_view s = view_at(p, leaf, ways, v, *t);
  skf_vd dx = vd_load(p->d[0] + at), dy = vd_load(p->d[1] + at), dz = vd_load(p->d[2] + at);
  skf_vd iso = vd_set(p->tracer->iso), f = s.F - iso, size = s.size + vd_abs(iso), eps = vd_set(DBL_EPSILON);
  skf_vd newton = f / (s.gx * dx + s.gy * dy + s.gz * dz), next = *t - newton;
  skf_vd grain = vd_set(4) * eps * vd_max(vd_abs(s.x), vd_max(vd_abs(s.y), vd_abs(s.z)));
  skf_vi small = vd_abs(newton) <= grain, inside = (next >= lo) & (next <= hi);
  skf_vi done = on & (small | (vd_abs(f) <= vd_set(2) * eps * size));
  skf_vi last = done & small & inside; /* what is left is rounding; a last step costs nothing and centres it */
  skf_vd place[3] = {s.x, s.y, s.z}, g[3] = {-s.gx, -s.gy, -s.gz}, d[3] = {dx, dy, dz};
  skf_vd m = vd_max(vd_abs(g[0]), vd_max(vd_abs(g[1]), vd_abs(g[2])));
  for (int i = 0; i < 3; i++) g[i] = g[i] / m;
  skf_vd n = vd_sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  out->t = vd_select(done, vd_select(last, next, *t), out->t);
  for (int i = 0; i < 3; i++) {
    skf_vd moved = vd_load(p->o[i] + at) + next * d[i];
    out->at[i] = vd_select(done, vd_select(last, moved, place[i]), out->at[i]);
    out->normal[i] = vd_select(done, g[i] / n, out->normal[i]);
  }
  out->done |= done;
  *t = vd_select(on & ~done & inside, next, *t);
  return on & ~done & inside;
}

/* Those that come to an end in a few steps. */
SKF_INLINE skf_vi polish(skf_packet *p, const skf_leaf *leaf, const skf_ways *ways, int v, skf_vd lo, skf_vd hi,
                         skf_vd t, skf_vi on, skf_polished *out) {
  enum { STEPS = 4 };
  skf_vd zero = vd_set(0);
  *out = (skf_polished){.t = zero, .at = {zero, zero, zero}, .normal = {zero, zero, zero}, .done = vi_set(0)};
  for (int i = 0; i < STEPS && vi_any(on); i++) {
    p->looks += (size_t)__builtin_popcount((unsigned)vi_bits(on));
    on = polish_step(p, leaf, ways, v, lo, hi, on, &t, out);
  }
  return out->done;
}

#endif
