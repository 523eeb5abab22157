/* SPDX-License-Identifier: MIT */
/* A leaf with a patch, four lanes in a vector. First crossings that the patch tells at once go to the waiting room;
   what it does not decide so is left to skf_packet_patch. */
#ifndef SKF_RAY_PACKET_PATCHES_H
#define SKF_RAY_PACKET_PATCHES_H

#include "ray/packet_ways.h"
#include "ray/room.h"

enum { PLACES = 4 }; /* at a time; 4 + 4 or 3 + 3 */

/* Where the lanes enter and leave a cell; a >= b: not at all. */
typedef struct span {
  skf_vd a[VECTORS], b[VECTORS];
} span;

/* Without vectors it makes nothing quicker and takes the compiler long. */
#ifdef SKF_MM
#define UNROLLED _Pragma("GCC unroll 8")
#else
#define UNROLLED _Pragma("GCC unroll 1")
#endif

/* The patch's values at `many` places x, y, z each, in units of half the cell: Horner's scheme in each of them. Several
   at a time, as it takes as long to fetch a coefficient as to use it. */
SKF_INLINE void patch_at(const int n, const int many, const double *c, const skf_vd *x, const skf_vd *y,
                         const skf_vd *z, skf_vd *out) {
  const double *last = c + (n + 1) * (n + 2) * (n + 3) / 6 - 1;
  for (int m = 0; m < many; m++) out[m] = vd_set(0);
  UNROLLED
  for (int i = n; i >= 0; i--) {
    skf_vd row[PLACES];
    for (int m = 0; m < many; m++) row[m] = vd_set(0);
    UNROLLED
    for (int j = n - i; j >= 0; j--) {
      skf_vd line[PLACES], first = vd_set(*last--);
      for (int m = 0; m < many; m++) line[m] = first;
      UNROLLED
      for (int k = n - i - j; k > 0; k--) {
        skf_vd next = vd_set(*last--);
        for (int m = 0; m < many; m++) line[m] = vd_fma(line[m], z[m], next);
      }
      for (int m = 0; m < many; m++) row[m] = vd_fma(row[m], y[m], line[m]);
    }
    for (int m = 0; m < many; m++) out[m] = vd_fma(out[m], x[m], row[m]);
  }
}

/* One more coefficient of a polynomial at x: its value, its derivative and half its second derivative. */
SKF_INLINE void raise(skf_vd x, skf_vd c, skf_vd *f, skf_vd *f1, skf_vd *f2) {
  if (f2) *f2 = vd_fma(*f2, x, *f1);
  if (f1) *f1 = vd_fma(*f1, x, *f);
  *f = vd_fma(*f, x, c);
}

/* How the patch's gradient changes in the direction d: its second derivatives times d. */
SKF_INLINE void patch_turn(const int n, const double *c, const skf_vd at[3], const skf_vd d[3], skf_vd out[3]) {
  skf_vd zero = vd_set(0), x = at[0], y = at[1], z = at[2], two = vd_set(2);
  skf_vd s = zero, sx = zero, sxx = zero, sy = zero, sxy = zero, syy = zero, sz = zero, sxz = zero, syz = zero,
         szz = zero;
  const double *last = c + (n + 1) * (n + 2) * (n + 3) / 6 - 1;
#pragma GCC unroll 1
  for (int i = n; i >= 0; i--) {
    skf_vd r = zero, ry = zero, ryy = zero, rz = zero, ryz = zero, rzz = zero;
    for (int j = n - i; j >= 0; j--) {
      skf_vd l = vd_set(*last--), lz = zero, lzz = zero;
      for (int k = n - i - j; k > 0; k--) raise(z, vd_set(*last--), &l, &lz, &lzz);
      raise(y, l, &r, &ry, &ryy), raise(y, lz, &rz, &ryz, NULL), raise(y, lzz, &rzz, NULL, NULL);
    }
    raise(x, r, &s, &sx, &sxx), raise(x, ry, &sy, &sxy, NULL), raise(x, rz, &sz, &sxz, NULL);
    raise(x, ryy, &syy, NULL, NULL), raise(x, ryz, &syz, NULL, NULL), raise(x, rzz, &szz, NULL, NULL);
  }
  out[0] = two * sxx * d[0] + sxy * d[1] + sxz * d[2];
  out[1] = sxy * d[0] + two * syy * d[1] + syz * d[2];
  out[2] = sxz * d[0] + syz * d[1] + two * szz * d[2];
}

/* Four lanes in a patch: the way through it and F - iso along it, by Bernstein's coefficients, to within `off`. */
typedef struct way_through {
  skf_vd at[3], step[3]; /* where it starts, and all of it, in units of half the cell */
  skf_vd a, b, off, c[SKF_DEGREE + 1];
} way_through;

SKF_INLINE void step_in(const skf_packet *p, const skf_leaf *leaf, const span *s, int v, way_through *w) {
  int lane = SKF_LANES * v;
  skf_vd per = vd_set(leaf->patch->per);
  w->a = s->a[v], w->b = s->b[v];
  w->off = vd_set(leaf->patch->off.value) + vd_load(p->shift + lane) * vd_set(leaf->slope);
  for (int k = 0; k < 3; k++) {
    skf_vd d = vd_load(p->d[k] + lane);
    w->at[k] = (vd_load(p->o[k] + lane) + w->a * d - vd_set(v3_get(leaf->center, k))) * per;
    w->step[k] = (w->b - w->a) * per * d;
  }
}

SKF_INLINE skf_vd dot(const skf_vd a[3], const skf_vd b[3]) {
  return vd_fma(a[2], b[2], vd_fma(a[1], b[1], a[0] * b[0]));
}

/* Lanes that the terms up to the second order do not show to be on one side. */
SKF_INLINE unsigned beyond_quadric(const skf_leaf *leaf, const way_through *w, int v, unsigned *above) {
  const skf_patch *q = leaf->patch;
  skf_vd end[3], g[3], u[3], n[3], xx = vd_set(q->bow[0]), yy = vd_set(q->bow[1]), zz = vd_set(q->bow[2]);
  skf_vd xy = vd_set(q->bow[3]), xz = vd_set(q->bow[4]), yz = vd_set(q->bow[5]), c0 = vd_set(q->c[0]);
  for (int k = 0; k < 3; k++) end[k] = w->at[k] + w->step[k], g[k] = vd_set(q->lean[k]);
  const skf_vd *x = w->at;
  u[0] = vd_fma(xz, x[2], vd_fma(xy, x[1], xx * x[0])), u[1] = vd_fma(yz, x[2], vd_fma(yy, x[1], xy * x[0]));
  u[2] = vd_fma(zz, x[2], vd_fma(yz, x[1], xz * x[0])), x = end;
  n[0] = vd_fma(xz, x[2], vd_fma(xy, x[1], xx * x[0])), n[1] = vd_fma(yz, x[2], vd_fma(yy, x[1], xy * x[0]));
  n[2] = vd_fma(zz, x[2], vd_fma(yz, x[1], xz * x[0]));
  skf_vd ga = dot(g, w->at), gb = dot(g, end), half = vd_set(0.5), off = w->off + vd_set(q->beyond);
  skf_vd fa = c0 + ga + dot(u, w->at), fb = c0 + gb + dot(n, end), middle = c0 + half * (ga + gb) + dot(u, end);
  skf_vd lo = vd_min(fa, vd_min(fb, middle)), hi = vd_max(fa, vd_max(fb, middle));
  unsigned over = (unsigned)vi_bits(lo > off) << (SKF_LANES * v), under = (unsigned)vi_bits(hi < -off)
                                                                          << (SKF_LANES * v);
  *above |= over;
  return ~(over | under);
}

SKF_INLINE void go_through(const int n, const skf_packet *p, const skf_leaf *leaf, way_through *w) {
  const skf_chebyshev *table = skf_octree_table(p->tracer->tree);
  const skf_restriction *t = n == SKF_DEGREE ? &table->full : &table->low;
  skf_vd f[SKF_DEGREE + 1];
  const int many = (n + 1) / 2;
#pragma GCC unroll 1
  for (int i = 0; i <= n; i += many) {
    skf_vd x[3][PLACES];
    for (int m = 0; m < many; m++)
      for (int k = 0; k < 3; k++) x[k][m] = vd_fma(vd_set(t->place[i + m]), w->step[k], w->at[k]);
    patch_at(n, many, leaf->patch->c, x[0], x[1], x[2], f + i);
  }
  w->c[0] = f[0], w->c[n] = f[n];
  for (int i = 1; i < n; i++) {
    skf_vd sum = vd_set(t->bernstein[i][0]) * f[0];
    for (int k = 1; k <= n; k++) sum = vd_fma(vd_set(t->bernstein[i][k]), f[k], sum);
    w->c[i] = sum;
  }
}

/* Where F rises or falls all the way as the patch does, the signs at the ends tell of one crossing or none. */
typedef struct decision {
  skf_vi clear, hit;
  skf_vd side; /* of the end */
} decision;

SKF_INLINE decision decide(const int n, const skf_leaf *leaf, const way_through *w) {
  skf_vd margin = vd_set(leaf->patch->off.slope / n) * (w->b - w->a) + vd_set(2e-9) * w->off;
  skf_vi falls = vi_set(-1), rises = falls;
  for (int k = 0; k < n; k++) {
    skf_vd d = w->c[k + 1] - w->c[k];
    falls &= d<-margin, rises &= d> margin;
  }
  skf_vi sure = (falls | rises) & (vd_abs(w->c[0]) > w->off) & (vd_abs(w->c[n]) > w->off);
  skf_vi same = (w->c[0] > vd_set(0)) == (w->c[n] > vd_set(0));
  return (decision){sure & same, sure & ~same, w->c[n]};
}

/* Along the way, on [0, 1]: the place of the root and two of Taylor's coefficients there. */
typedef struct patch_root {
  skf_vd x, c2, c3;
  skf_vi found;
} patch_root;

/* As root_of in patch.c; found: those that Newton's steps have brought there. */
SKF_INLINE patch_root root_in_patch(const int n, const skf_vd *c, skf_vi hit) {
  enum { STEPS = 5 };
  skf_vd zero = vd_set(0), one = vd_set(1), d[SKF_DEGREE + 1];
  patch_root r = {.x = polygon_root(n, c), .found = vi_set(0)};
  powers_of(n, c, d);
  for (int i = 0; i < STEPS && vi_any(hit & ~r.found); i++) {
    skf_vd f = d[n], slope = zero;
    for (int k = n - 1; k >= 0; k--) raise(r.x, d[k], &f, &slope, NULL);
    skf_vd next = vd_max(vd_min(r.x - f / slope, one), zero);
    skf_vi near = vd_abs(next - r.x) < vd_set(1e-4);
    r.x = vd_select(r.found, r.x, next);
    r.found |= near;
  }
  skf_vd f = d[n], f1 = zero;
  r.c2 = r.c3 = zero;
  for (int k = n - 1; k >= 0; k--) {
    r.c3 = vd_fma(r.c3, r.x, r.c2);
    raise(r.x, d[k], &f, &f1, &r.c2);
  }
  r.found &= hit;
  return r;
}

/* Hands out crossings: the first ones to the waiting room, without a way through each lane's walk. */
SKF_INLINE void hand_out(const int n, skf_packet *p, const skf_leaf *leaf, int v, const way_through *w,
                         const patch_root *root, unsigned lanes) {
  int first = SKF_LANES * v;
  skf_vd L = w->b - w->a, per = vd_set(1) / L, c2 = root->c2 * per * per, c3 = root->c3 * per * per * per;
  skf_vd t = w->a + root->x * L, scale = vd_set(leaf->patch->per), turn[3] = {vd_set(0), vd_set(0), vd_set(0)}, d[3],
         at[3];
  double off = leaf->patch->off.bend;
  bool turns = p->tracer->normals > 0;
  for (int k = 0; k < 3; k++)
    at[k] = vd_fma(root->x, w->step[k], w->at[k]), d[k] = vd_load(p->d[k] + first) * scale * scale;
  if (turns) patch_turn(n, leaf->patch->c, at, d, turn);
  for (; lanes; lanes &= lanes - 1) {
    int k = __builtin_ctz(lanes), lane = first + k;
    skf_bow bow = {c2[k], c3[k], off, {turn[0][k], turn[1][k], turn[2][k]}, turns ? off : leaf->bend};
    skf_knot a = {.t = w->a[k], .f = w->c[0][k]}, b = {.t = w->b[k], .f = w->c[n][k]};
    skf_walk quick = {.origin = {p->o[0][lane], p->o[1][lane], p->o[2][lane]},
                      .direction = {p->d[0][lane], p->d[1][lane], p->d[2][lane]},
                      .leaf = leaf,
                      .bow = &bow};
    if (p->first) {
      const skf_answer *to = p->user[lane];
      skf_room_add(to->room, to->hit, &quick, &a, &b, t[k]);
      continue;
    }
    skf_packet_lane(p, lane)->bow = &bow;
    skf_packet_found(p, lane, leaf, &a, &b, t[k]);
    p->walk[lane].bow = NULL;
  }
}

/* Those of the lanes of vector v that are not decided. */
SKF_INLINE unsigned decide_patch(const int n, skf_packet *p, const skf_leaf *leaf, int v, const way_through *w,
                                 unsigned lanes, unsigned *above) {
  int at = SKF_LANES * v;
  decision o = decide(n, leaf, w);
  unsigned clear = (unsigned)vi_bits(o.clear) << at & lanes, hit = (unsigned)vi_bits(o.hit) << at & lanes;
  *above |= (unsigned)vi_bits(o.side > vd_set(0)) << at & lanes;
  if (!hit) return lanes & ~clear;
  patch_root r = root_in_patch(n, w->c, lanes_on(hit, v));
  hit = (unsigned)vi_bits(r.found) << at;
  if (p->exact || !p->first) hand_out(n, p, leaf, v, w, &r, hit >> at);
  if (p->first) {
    for (unsigned k = hit; k; k &= k - 1) *((const skf_answer *)p->user[__builtin_ctz(k)])->found = true;
    p->alive &= ~hit;
  }
  return lanes & ~(clear | hit);
}

SKF_INLINE void in_patch(const int n, skf_packet *p, const skf_leaf *leaf, const span *s, unsigned lanes) {
  unsigned above = 0, all = 0;
  for (int v = 0; v < VECTORS; v++) {
    way_through w;
    int at = SKF_LANES * v;
    unsigned left = lanes & (((1u << SKF_LANES) - 1) << at);
    if (!left) continue;
    step_in(p, leaf, s, v, &w);
    left &= beyond_quadric(leaf, &w, v, &above);
    if (!left) continue;
    go_through(n, p, leaf, &w);
    skf_vd lo = w.c[0], hi = w.c[0];
    for (int i = 1; i <= n; i++) lo = vd_min(lo, w.c[i]), hi = vd_max(hi, w.c[i]);
    unsigned over = (unsigned)vi_bits(lo > w.off) << at, under = (unsigned)vi_bits(hi < -w.off) << at;
    above |= over & left, left &= ~(over | under);
    if (left) left = decide_patch(n, p, leaf, v, &w, left, &above);
    for (all |= left; left; left &= left - 1) {
      double own[SKF_DEGREE + 1];
      int lane = __builtin_ctz(left), k = lane - at;
      for (int i = 0; i <= n; i++) own[i] = w.c[i][k];
      skf_packet_patch(p, lane, leaf, w.a[k], w.b[k], own, w.off[k]);
    }
  }
  unsigned clear = lanes & ~all;
  p->below = (p->below & ~clear) | (clear & ~above), p->above = (p->above & ~clear) | (clear & above);
}

static __attribute__((noinline)) void in_full_patch(skf_packet *p, const skf_leaf *leaf, const span *s,
                                                    unsigned lanes) {
  in_patch(SKF_DEGREE, p, leaf, s, lanes);
}

static __attribute__((noinline)) void in_low_patch(skf_packet *p, const skf_leaf *leaf, const span *s, unsigned lanes) {
  in_patch(SKF_LOW_DEGREE, p, leaf, s, lanes);
}

#endif
