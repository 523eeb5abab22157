/* SPDX-License-Identifier: MIT */
/* What a leaf of blobs looks like along rays, four lanes in a vector. */
#ifndef SKF_RAY_PACKET_WAYS_H
#define SKF_RAY_PACKET_WAYS_H

#include "ray/packet.h"
#include "simd/vec.h"

/* At u along the rays m = m0 + u (m1 - m2 u), of a segment beside its line; x = x0 + u x1 along it in units of R. */
typedef struct skf_way {
  skf_vd m0, m1, m2, x0, x1;
  skf_vd peak; /* of a point: the largest m on the way; 0: it is not met */
} skf_way;

typedef struct skf_ways {
  skf_way of[SKF_LEAF_BLOBS][VECTORS];
  unsigned met[VECTORS];                  /* a bit for each blob without which no lane is another */
  skf_vd length[VECTORS], noise[VECTORS]; /* noise: twice what rounding can make of f */
} skf_ways;

SKF_INLINE skf_vd clamped(skf_vd x, skf_vd lo, skf_vd hi) { return vd_max(vd_min(x, hi), lo); }

/* From (x, y, z) in the direction (dx, dy, dz), as far as L; returns an upper bound of F on the way. A point's value is
   largest where the ray comes nearest to it. */
SKF_INLINE skf_vd see_point(const skf_blob *b, skf_vd x, skf_vd y, skf_vd z, skf_vd dx, skf_vd dy, skf_vd dz, skf_vd L,
                            skf_way *out) {
  skf_vd per = vd_set(b->per), zero = vd_set(0);
  x -= vd_set(b->at.x), y -= vd_set(b->at.y), z -= vd_set(b->at.z);
  skf_vd back = x * dx + y * dy + z * dz, m0 = vd_set(1) - (x * x + y * y + z * z) * per,
         m1 = vd_set(-2 * b->per) * back;
  out->m0 = m0, out->m1 = m1, out->m2 = per;
  skf_vd u = clamped(-back, zero, L), m = vd_max(m0 + u * (m1 - u * per), zero), s = vd_set(b->strength) * m * m;
  out->peak = m;
  return b->c3 > 0 ? s * (vd_set(b->c2) + vd_set(b->c3) * m) : s;
}

/* Integrals of (m - t^2)^2 and (m - t^2)^3 from 0 to t; tt = t^2 */
SKF_INLINE skf_vd squares(skf_vd m, skf_vd t, skf_vd tt) {
  return t * (m * m - tt * (vd_set(2. / 3) * m - vd_set(0.2) * tt));
}
SKF_INLINE skf_vd cubes(skf_vd m, skf_vd t, skf_vd tt) {
  return t * (m * m * m - tt * (m * m - tt * (vd_set(0.6) * m - vd_set(1. / 7) * tt)));
}

typedef struct skf_beside {
  skf_vd F, by_m, by_x;
} skf_beside;

/* A segment's field at x along it and at m >= 0, in units of R and of its strength, and its derivatives by m and x. */
SKF_INLINE skf_beside beside(const skf_blob *b, skf_vd x, skf_vd m) {
  skf_vd y = vd_sqrt(m), L = vd_set(b->span), c2 = vd_set(b->c2), c3 = vd_set(b->c3), three = vd_set(3);
  skf_vd lo = vd_min(vd_max(-x, -y), y), hi = vd_max(vd_min(L - x, y), -y), ll = lo * lo, hh = hi * hi;
  skf_vd a = m - ll, b2 = m - hh, square = squares(m, hi, hh) - squares(m, lo, ll);
  skf_vd line = hi * (m - vd_set(1. / 3) * hh) - lo * (m - vd_set(1. / 3) * ll);
  a = vd_max(a, vd_set(0)), b2 = vd_max(b2, vd_set(0));
  if (!(b->c3 > 0)) return (skf_beside){square, vd_set(2) * line, a * a - b2 * b2};
  return (skf_beside){c2 * square + c3 * (cubes(m, hi, hh) - cubes(m, lo, ll)),
                      vd_set(2) * c2 * line + three * c3 * square, a * a * (c2 + c3 * a) - b2 * b2 * (c2 + c3 * b2)};
}

/* Beside its line a segment's value is largest where the ray comes nearest to the line, along it nearest to the middle.
 */
SKF_INLINE skf_vd see_segment(const skf_blob *b, skf_vd x, skf_vd y, skf_vd z, skf_vd dx, skf_vd dy, skf_vd dz,
                              skf_vd L, skf_way *w) {
  skf_vd ax = vd_set(b->axis.x), ay = vd_set(b->axis.y), az = vd_set(b->axis.z), per = vd_set(b->per), zero = vd_set(0);
  x -= vd_set(b->at.x), y -= vd_set(b->at.y), z -= vd_set(b->at.z);
  skf_vd s = x * ax + y * ay + z * az, t = dx * ax + dy * ay + dz * az;
  x -= s * ax, y -= s * ay, z -= s * az, dx -= t * ax, dy -= t * ay, dz -= t * az;
  skf_vd ee = dx * dx + dy * dy + dz * dz, back = x * dx + y * dy + z * dz, per_R = vd_set(b->per_R);
  w->m0 = vd_set(1) - (x * x + y * y + z * z) * per, w->m1 = vd_set(-2 * b->per) * back, w->m2 = ee * per;
  w->x0 = s * per_R, w->x1 = t * per_R;
  skf_vd u = clamped(-back / ee, zero, L), m = vd_max(w->m0 + u * (w->m1 - u * w->m2), zero);
  if (!vi_any(m > zero)) return zero;
  skf_vd from = w->x0, to = w->x0 + L * w->x1;
  return vd_set(b->moment) * beside(b, clamped(vd_set(0.5 * b->span), vd_min(from, to), vd_max(from, to)), m).F;
}

/* The leaf's blobs along the lanes; returns those that are not outside all the way. */
SKF_INLINE unsigned look_along(const skf_packet *p, const skf_leaf *leaf, const skf_vd *from, const skf_vd *to,
                               unsigned lanes, skf_ways *out) {
  unsigned bits = 0;
  for (int v = 0; v < VECTORS; v++) {
    if (!(lanes >> (SKF_LANES * v) & 15)) continue;
    int at = SKF_LANES * v;
    skf_vd dx = vd_load(p->d[0] + at), dy = vd_load(p->d[1] + at), dz = vd_load(p->d[2] + at), a = from[v];
    skf_vd x = vd_load(p->o[0] + at) + a * dx, y = vd_load(p->o[1] + at) + a * dy, z = vd_load(p->o[2] + at) + a * dz;
    skf_vd L = to[v] - a, noise = vd_load(p->shift + at) * vd_set(leaf->slope) + vd_set(leaf->grain);
    skf_vd most = noise - vd_set(p->tracer->iso);
    for (uint32_t i = 0; i < leaf->count; i++) {
      const skf_blob *b = leaf->blobs + i;
      skf_way *w = &out->of[i][v];
      most += b->length > 0 ? see_segment(b, x, y, z, dx, dy, dz, L, w) : see_point(b, x, y, z, dx, dy, dz, L, w);
    }
    out->length[v] = L, out->noise[v] = noise + noise;
    bits |= (unsigned)vi_bits(~(most < vd_set(0))) << at;
  }
  return bits & lanes;
}

/* How far each blob of n is certainly below iso / n. */
SKF_INLINE skf_vd quiet_until(const skf_leaf *leaf, const skf_ways *ways, int v) {
  skf_vd zero = vd_set(0), first = ways->length[v];
  for (uint32_t i = 0; i < leaf->count; i++) {
    const skf_way *w = &ways->of[i][v];
    skf_vd m0 = w->m0 - vd_set(leaf->blobs[i].quiet), D = w->m1 * w->m1 + vd_set(4) * w->m2 * m0;
    skf_vi comes = (w->m1 > zero) & (D > zero), is = m0 >= zero;
    skf_vd at = vd_set(-2) * m0 / (w->m1 + vd_sqrt(vd_max(D, zero)));
    first = vd_select(is, zero, vd_select(comes, vd_min(first, at), first));
  }
  return first;
}

/* As in bernstein.h: Taylor's coefficients at 0, and where the control points' polygon has its root. */
SKF_INLINE void powers_of(const int n, const skf_vd *c, skf_vd *d) {
  for (int k = 0; k <= n; k++) d[k] = c[k];
  for (int k = 1; k <= n; k++)
    for (int i = n; i >= k; i--) d[i] -= d[i - 1];
  for (int k = 1, choose = n; k < n; k++) d[k] *= vd_set(choose), choose = choose * (n - k) / (k + 1);
}

SKF_INLINE skf_vd polygon_root(const int n, const skf_vd *c) {
  skf_vd zero = vd_set(0), top = c[0], drop = c[0] - c[n], from = zero;
  for (int k = 0; k < n; k++) {
    skf_vi here = (c[k] > zero) ^ (c[k + 1] > zero);
    top = vd_select(here, c[k], top), drop = vd_select(here, c[k] - c[k + 1], drop);
    from = vd_select(here, vd_set(k), from);
  }
  return (from + top / drop) * vd_set(1. / n);
}

SKF_INLINE skf_vi lanes_on(unsigned lanes, int v) {
  const skf_vi bits = {1, 2, 4, 8};
  return (skf_vi)((vi_set(lanes >> (SKF_LANES * v)) & bits) == bits);
}

SKF_INLINE skf_vd sides_of(const skf_packet *p, int v) {
  skf_vd up = vd_select(lanes_on(p->above, v), vd_set(1), vd_set(0));
  return up - vd_select(lanes_on(p->below, v), vd_set(1), vd_set(0));
}

#endif
