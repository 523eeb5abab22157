/* SPDX-License-Identifier: MIT */
/* The way through the octree, four lanes in a vector. Included by the units of each instruction set, for one vector and
   for two: VECTORS. */
#include "ray/packet_blobs.h"

/* Where the lanes enter and leave a cell; a >= b: not at all. */
typedef struct span {
  skf_vd a[VECTORS], b[VECTORS];
} span;

SKF_INLINE unsigned lanes_of(const skf_packet *p, const span *s) {
  unsigned bits = 0;
  for (int v = 0; v < VECTORS; v++) bits |= (unsigned)vi_bits(s->a[v] < s->b[v]) << (SKF_LANES * v);
  return bits & p->alive;
}

/* Cells that are known to be outside are passed over: who has come here past one is outside. Who has been in a leaf and
   still has no sign is on the surface. */
SKF_INLINE void settle(skf_packet *p, const span *s, unsigned lanes) {
  unsigned open = lanes & ~(p->below | p->above | p->walking), past = 0;
  if (!open) return;
  for (int v = 0; v < VECTORS; v++)
    past |= (unsigned)vi_bits(s->a[v] > vd_load(p->from + SKF_LANES * v)) << (SKF_LANES * v);
  p->below |= open & past;
}

static void meet_blobs(skf_packet *p, const skf_leaf *leaf, const span *s, unsigned lanes) {
  double a[SKF_PACKET], b[SKF_PACKET];
  unsigned left = lanes, hit;
  skf_vd from[VECTORS], hi[VECTORS];
  for (int v = 0; v < VECTORS; v++) from[v] = s->a[v];
  if (p->first)
    left = first_in_blobs(p, leaf, from, s->b, lanes, &hit, hi);
  else if (leaf->segments)
    left = all_in_blobs(p, leaf, from, s->b, lanes);
  if (!left) return;
  for (int v = 0; v < VECTORS; v++) vd_store(a + SKF_LANES * v, from[v]), vd_store(b + SKF_LANES * v, s->b[v]);
  for (; left; left &= left - 1) {
    int lane = __builtin_ctz(left);
    skf_packet_blobs(p, lane, leaf, a[lane], b[lane]);
  }
}

static void meet_leaf(skf_packet *p, const skf_leaf *leaf, const span *s, unsigned lanes) {
  double a[SKF_PACKET], b[SKF_PACKET];
  for (int v = 0; v < VECTORS; v++) vd_store(a + SKF_LANES * v, s->a[v]), vd_store(b + SKF_LANES * v, s->b[v]);
  for (; lanes; lanes &= lanes - 1) {
    int lane = __builtin_ctz(lanes);
    skf_packet_walk(p, lane, leaf, a[lane], b[lane]);
  }
}

/* The model's value at x, y, z: Horner's scheme in each of them. */
SKF_INLINE skf_vd patch_at(const int degree, const double *c, skf_vd x, skf_vd y, skf_vd z) {
  skf_vd sum = vd_set(0);
  const double *last = c + (degree + 1) * (degree + 2) * (degree + 3) / 6 - 1;
#pragma GCC unroll 8
  for (int i = degree; i >= 0; i--) {
    skf_vd row = vd_set(0);
#pragma GCC unroll 8
    for (int j = degree - i; j >= 0; j--) {
      skf_vd line = vd_set(*last--);
#pragma GCC unroll 8
      for (int k = degree - i - j; k > 0; k--) line = line * z + vd_set(*last--);
      row = row * y + line;
    }
    sum = sum * x + row;
  }
  return sum;
}

/* Lanes that the linear part does not show to be on one side. */
SKF_INLINE unsigned beyond_plane(const skf_packet *p, const skf_leaf *leaf, const span *s, int v, unsigned *above) {
  int at = SKF_LANES * v;
  skf_vd dx = vd_load(p->d[0] + at), dy = vd_load(p->d[1] + at), dz = vd_load(p->d[2] + at), a = s->a[v];
  skf_vd gx = vd_set(leaf->g.x), gy = vd_set(leaf->g.y), gz = vd_set(leaf->g.z), flat = vd_set(leaf->flat);
  skf_vd fa = vd_set(leaf->f) + gx * (vd_load(p->o[0] + at) + a * dx - vd_set(leaf->center.x)) +
              gy * (vd_load(p->o[1] + at) + a * dy - vd_set(leaf->center.y)) +
              gz * (vd_load(p->o[2] + at) + a * dz - vd_set(leaf->center.z));
  skf_vd fb = fa + (s->b[v] - a) * (gx * dx + gy * dy + gz * dz);
  flat += vd_load(p->shift + at) * vd_set(leaf->slope);
  unsigned over = (unsigned)vi_bits((fa > flat) & (fb > flat)) << at;
  unsigned under = (unsigned)vi_bits((fa < -flat) & (fb < -flat)) << at;
  *above |= over;
  return ~(over | under) & (((1u << SKF_LANES) - 1) << at);
}

/* The patch along four lanes; returns a bit for those that it does not show to be on one side. */
SKF_INLINE unsigned along_patch(const skf_packet *p, const skf_leaf *leaf, const span *s, int v, skf_vd off,
                                double c[SKF_DEGREE + 1][SKF_PACKET], unsigned *above) {
  const skf_chebyshev *t = skf_octree_table(p->tracer->tree);
  const skf_patch *patch = leaf->patch;
  int at = SKF_LANES * v;
  skf_vd per = vd_set(patch->per), a = s->a[v], L = s->b[v] - a, f[SKF_DEGREE + 1], lo, hi;
  skf_vd dx = vd_load(p->d[0] + at), dy = vd_load(p->d[1] + at), dz = vd_load(p->d[2] + at);
  skf_vd x = (vd_load(p->o[0] + at) + a * dx - vd_set(leaf->center.x)) * per;
  skf_vd y = (vd_load(p->o[1] + at) + a * dy - vd_set(leaf->center.y)) * per;
  skf_vd z = (vd_load(p->o[2] + at) + a * dz - vd_set(leaf->center.z)) * per;
  for (int i = 0; i <= SKF_DEGREE; i++) {
    skf_vd u = L * per * vd_set(t->place[i]);
    if (patch->degree == SKF_DEGREE)
      f[i] = patch_at(SKF_DEGREE, patch->c, x + u * dx, y + u * dy, z + u * dz);
    else
      f[i] = patch_at(SKF_LOW_DEGREE, patch->c, x + u * dx, y + u * dy, z + u * dz);
  }
  lo = hi = f[0];
  vd_store(c[0] + at, f[0]);
  for (int i = 1; i <= SKF_DEGREE; i++) {
    skf_vd sum = vd_set(t->bernstein[i][0]) * f[0];
    for (int k = 1; k <= SKF_DEGREE; k++) sum += vd_set(t->bernstein[i][k]) * f[k];
    vd_store(c[i] + at, sum);
    lo = vd_min(lo, sum), hi = vd_max(hi, sum);
  }
  unsigned over = (unsigned)vi_bits(lo > off) << at, under = (unsigned)vi_bits(hi < -off) << at;
  *above |= over;
  return ~(over | under) & (((1u << SKF_LANES) - 1) << at);
}

static void meet_patch(skf_packet *p, const skf_leaf *leaf, const span *s, unsigned lanes) {
  double c[SKF_DEGREE + 1][SKF_PACKET], a[SKF_PACKET], b[SKF_PACKET], off[SKF_PACKET], own[SKF_DEGREE + 1];
  unsigned left = 0, above = 0;
  for (int v = 0; v < VECTORS; v++) {
    unsigned open = lanes & beyond_plane(p, leaf, s, v, &above);
    if (!open) continue;
    skf_vd wide = vd_set(leaf->patch->off.value) + vd_load(p->shift + SKF_LANES * v) * vd_set(leaf->slope);
    vd_store(off + SKF_LANES * v, wide);
    vd_store(a + SKF_LANES * v, s->a[v]), vd_store(b + SKF_LANES * v, s->b[v]);
    left |= open & along_patch(p, leaf, s, v, wide, c, &above);
  }
  unsigned clear = lanes & ~left;
  p->below = (p->below & ~clear) | (clear & ~above), p->above = (p->above & ~clear) | (clear & above);
  for (left &= lanes; left; left &= left - 1) {
    int lane = __builtin_ctz(left);
    for (int i = 0; i <= SKF_DEGREE; i++) own[i] = c[i][lane];
    skf_packet_patch(p, lane, leaf, a[lane], b[lane], own, off[lane]);
  }
}

static void descend(skf_packet *p, skf_branch *branch, const span *s);

static void meet(skf_packet *p, skf_cell c, const span *s, unsigned lanes) {
  switch (c & SKF_CELL_KIND) {
  case SKF_CELL_OUTSIDE: p->below |= lanes, p->above &= ~lanes; break;
  case SKF_CELL_INSIDE: p->above |= lanes, p->below &= ~lanes; break;
  case SKF_CELL_BRANCH: descend(p, skf_cell_branch(c), s); break;
  case SKF_CELL_BLOBS:
    settle(p, s, lanes);
    p->cells += (size_t)__builtin_popcount(lanes);
    meet_blobs(p, skf_cell_leaf(c), s, lanes);
    break;
  case SKF_CELL_LEAF:
    settle(p, s, lanes);
    if (!skf_cell_leaf(c)->patch) {
      meet_leaf(p, skf_cell_leaf(c), s, lanes);
      break;
    }
    p->cells += (size_t)__builtin_popcount(lanes);
    meet_patch(p, skf_cell_leaf(c), s, lanes);
    break;
  default: settle(p, s, lanes), meet_leaf(p, NULL, s, lanes);
  }
}

/* Where the lanes pass a middle along axis i. */
SKF_INLINE void pass(const skf_packet *p, int i, double middle, skf_vd t[VECTORS]) {
  for (int v = 0; v < VECTORS; v++)
    t[v] = (vd_set(middle) - vd_load(p->o[i] + SKF_LANES * v)) * vd_load(p->per[i] + SKF_LANES * v);
}

/* The part of a span in the k-th child of a branch whose middles it passes at t. */
SKF_INLINE void enter(const span *all, const skf_vd *tx, const skf_vd *ty, const skf_vd *tz, int k, span *out) {
  for (int v = 0; v < VECTORS; v++) {
    skf_vd a = all->a[v], b = all->b[v];
    a = k & 1 ? vd_max(a, tx[v]) : a, b = k & 1 ? b : vd_min(b, tx[v]);
    a = k & 2 ? vd_max(a, ty[v]) : a, b = k & 2 ? b : vd_min(b, ty[v]);
    a = k & 4 ? vd_max(a, tz[v]) : a, b = k & 4 ? b : vd_min(b, tz[v]);
    out->a[v] = a, out->b[v] = b;
  }
}

/* The children in the order in which rays that go forwards in all coordinates come to them. */
static void descend(skf_packet *p, skf_branch *branch, const span *at) {
  skf_octree *tree = p->tracer->tree;
  span all = *at, s;
  skf_vd tx[VECTORS], ty[VECTORS], tz[VECTORS];
  pass(p, 0, branch->middle.x, tx), pass(p, 1, branch->middle.y, ty), pass(p, 2, branch->middle.z, tz);
  unsigned outside = atomic_load_explicit(&branch->outside, memory_order_relaxed), turn = (unsigned)p->backwards;
#pragma GCC unroll 8
  for (unsigned k = 0; k < 8; k++) {
    unsigned lanes;
    if (outside >> (k ^ turn) & 1) continue;
    enter(&all, tx, ty, tz, (int)k, &s);
    if ((lanes = lanes_of(p, &s))) meet(p, skf_octree_child(tree, branch, (int)(k ^ turn)), &s, lanes);
  }
}

static void through(skf_packet *p) {
  span s;
  for (int v = 0; v < VECTORS; v++) {
    s.a[v] = vd_load(p->from + SKF_LANES * v);
    s.b[v] = vd_load(p->to + SKF_LANES * v);
  }
  unsigned lanes = lanes_of(p, &s);
  if (lanes) meet(p, skf_octree_child(p->tracer->tree, skf_octree_top(p->tracer->tree), 0), &s, lanes);
}
