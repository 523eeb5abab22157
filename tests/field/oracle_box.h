/* SPDX-License-Identifier: MIT */
/* Boxes along the axes as solids: their 1/r field by the closed form over the corners, in 113 bits [MacMillan 1930]. */
#ifndef SKF_TESTS_FIELD_ORACLE_BOX_H
#define SKF_TESTS_FIELD_ORACLE_BOX_H

#include "field/cases.h"

/* ln(a + r) less what cancels among the corners, rest2 = r^2 - a^2. */
static inline quad oracle_box_log(quad a, quad r, quad rest2) {
  if (a >= 0) return a + r > 0 ? logq(a + r) : 0;
  return rest2 > 0 ? logq(rest2 / (r - a)) : 0;
}

static inline quad oracle_box_angle(quad yz, quad xr) { return yz == 0 || xr == 0 ? 0 : atanq(yz / xr); }

static inline oracle_value oracle_box(const skf_element *e, skf_vec3 at) {
  skf_box box = skf_solid_get(e->primitive.solid)->bounds;
  oracle_value v;
  memset(&v, 0, sizeof v);
  for (int i = 0; i < 8; i++) {
    quad x = (quad)(i & 1 ? box.hi.x : box.lo.x) - at.x, y = (quad)(i & 2 ? box.hi.y : box.lo.y) - at.y,
         z = (quad)(i & 4 ? box.hi.z : box.lo.z) - at.z, xx = x * x, yy = y * y, zz = z * z, r = sqrtq(xx + yy + zz);
    quad lx = oracle_box_log(x, r, yy + zz), ly = oracle_box_log(y, r, xx + zz), lz = oracle_box_log(z, r, xx + yy);
    quad ax = oracle_box_angle(y * z, x * r), ay = oracle_box_angle(z * x, y * r), az = oracle_box_angle(x * y, z * r);
    int s = (i & 1 ? 1 : -1) * (i & 2 ? 1 : -1) * (i & 4 ? 1 : -1);
    v.F += s * (x * y * lz + y * z * lx + z * x * ly - (xx * ax + yy * ay + zz * az) / 2);
    const quad g[3] = {x * ax - y * lz - z * ly, y * ay - z * lx - x * lz, z * az - x * ly - y * lx};
    const quad h[6] = {-ax, lz, ly, -ay, lx, -az};
    for (int k = 0; k < 3; k++) v.g[k] += s * g[k];
    for (int k = 0; k < 6; k++) v.h[k] += s * h[k];
  }
  return v;
}

static inline skf_solid *box_solid(skf_vec3 lo, skf_vec3 hi) {
  static const unsigned face[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                       {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  skf_vec3 v[8];
  skf_solid *solid;
  for (int i = 0; i < 8; i++) v[i] = v3(i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z);
  return skf_solid_new(v, 8, face, 12, &solid, NULL) ? NULL : solid;
}

/* A cube, a box or a slab down to a tenth as thick as it is long, and a place off its faces. The caller frees the
   solid. */
static inline bool case_box(uint64_t *s, case_region r, field_case *c) {
  double scale = rnd_one_in(s, 3) ? rnd_power(s, -7, 7) : 1, thin = rnd_one_in(s, 3) ? 1 : rnd_power(s, -1, 0);
  skf_vec3 lo = v3_scale(scale * (rnd_one_in(s, 4) ? 1e3 : 1), rnd_vec(s, 1)), hi = lo;
  for (int k = 0; k < 3; k++) *v3_at(&hi, k) += scale * (k == (int)rnd(s, 0, 3) ? thin : 1);
  memset(c, 0, sizeof *c);
  c->element = (skf_element){.kernel.type = SKF_INVERSE, .strength = 1, .primitive.shape = SKF_SOLID};
  double off = r == CASE_MIDDLE ? rnd_power(s, -1, 1) : r == CASE_FAR ? rnd_power(s, 1, 6) : rnd_power(s, -9, -1);
  skf_vec3 x = v3(rnd(s, lo.x, hi.x), rnd(s, lo.y, hi.y), rnd(s, lo.z, hi.z));
  int pinned = r == CASE_NEAR ? 1 : r == CASE_EDGE ? 2 : r == CASE_RIM ? 3 : r == CASE_LINE, first = (int)rnd(s, 0, 3);
  for (int k = first; k < first + pinned; k++) *v3_at(&x, k % 3) = v3_get(rnd_one_in(s, 2) ? lo : hi, k % 3);
  c->x = v3_mad(x, scale * off, rnd_unit(s));
  for (int k = 0; k < 3; k++) {
    double a = v3_get(c->x, k);
    if (a == v3_get(lo, k) || a == v3_get(hi, k)) return false;
  }
  c->element.primitive.solid = box_solid(lo, hi);
  c->size = scale, c->distance = c->element.primitive.solid ? skf_primitive_distance(&c->element.primitive, c->x) : 0;
  return c->element.primitive.solid != NULL;
}

#endif
