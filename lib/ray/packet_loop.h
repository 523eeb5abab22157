/* SPDX-License-Identifier: MIT */
/* The way through the octree, four lanes in a vector. Included by the units of each instruction set, for one vector and
   for two: VECTORS. */
#include "ray/packet.h"
#include "simd/vec.h"

/* Where the lanes enter and leave a cell; a >= b: not at all. */
typedef struct span {
  skf_vd a[VECTORS], b[VECTORS];
} span;

SKF_INLINE unsigned lanes_of(const skf_packet *p, const span *s) {
  unsigned bits = 0;
  for (int v = 0; v < VECTORS; v++) bits |= (unsigned)vi_bits(s->a[v] < s->b[v]) << (SKF_LANES * v);
  return bits & p->alive;
}

/* Lanes that a bound on the field's largest value along their way does not show to be outside. A blob's value is
   largest where the ray comes nearest to it. */
SKF_INLINE unsigned undecided(const skf_packet *p, const skf_leaf *leaf, const span *s, unsigned lanes) {
  unsigned bits = 0;
  for (int v = 0; v < VECTORS; v++) {
    int at = SKF_LANES * v;
    skf_vd dx = vd_load(p->d[0] + at), dy = vd_load(p->d[1] + at), dz = vd_load(p->d[2] + at), zero = vd_set(0);
    skf_vd a = s->a[v], L = s->b[v] - a, one = vd_set(1);
    skf_vd px = vd_load(p->o[0] + at) + a * dx, py = vd_load(p->o[1] + at) + a * dy,
           pz = vd_load(p->o[2] + at) + a * dz;
    skf_vd most = vd_load(p->shift + at) * vd_set(leaf->slope) + vd_set(leaf->grain - p->tracer->iso);
    for (uint32_t i = 0; i < leaf->count; i++) {
      const skf_blob *b = leaf->blobs + i;
      skf_vd x = px - vd_set(b->at.x), y = py - vd_set(b->at.y), z = pz - vd_set(b->at.z);
      skf_vd w = x * x + y * y + z * z, c = x * dx + y * dy + z * dz, u = vd_max(vd_min(-c, L), zero);
      skf_vd m = vd_max(one - (w + u * (c + c + u)) * vd_set(b->per), zero), h = vd_set(b->strength) * m * m;
      most += leaf->soft ? h * (vd_set(b->c2) + vd_set(b->c3) * m) : h;
    }
    bits |= (unsigned)vi_bits(~(most < zero)) << at;
  }
  return bits & lanes;
}

static void meet_blobs(skf_packet *p, const skf_leaf *leaf, const span *s, unsigned lanes) {
  unsigned left = undecided(p, leaf, s, lanes), clear = lanes & ~left;
  double a[SKF_PACKET], b[SKF_PACKET];
  p->below |= clear, p->above &= ~clear;
  if (!left) return;
  for (int v = 0; v < VECTORS; v++) vd_store(a + SKF_LANES * v, s->a[v]), vd_store(b + SKF_LANES * v, s->b[v]);
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

static void descend(skf_packet *p, skf_branch *branch, const span *s);

static void meet(skf_packet *p, skf_cell c, const span *s, unsigned lanes) {
  switch (c & SKF_CELL_KIND) {
  case SKF_CELL_OUTSIDE: p->below |= lanes, p->above &= ~lanes; break;
  case SKF_CELL_INSIDE: p->above |= lanes, p->below &= ~lanes; break;
  case SKF_CELL_BRANCH: descend(p, skf_cell_branch(c), s); break;
  case SKF_CELL_BLOBS:
    p->cells += (size_t)__builtin_popcount(lanes);
    meet_blobs(p, skf_cell_leaf(c), s, lanes);
    break;
  case SKF_CELL_LEAF: meet_leaf(p, skf_cell_leaf(c), s, lanes); break;
  default: meet_leaf(p, NULL, s, lanes);
  }
}

/* Where the lanes pass a middle along axis i. */
SKF_INLINE void pass(const skf_packet *p, int i, double middle, skf_vd t[VECTORS]) {
  for (int v = 0; v < VECTORS; v++)
    t[v] = (vd_set(middle) - vd_load(p->o[i] + SKF_LANES * v)) * vd_load(p->per[i] + SKF_LANES * v);
}

/* The half of a span before or behind it; returns whether anything is left. */
SKF_INLINE unsigned cut(const skf_packet *p, const span *s, const skf_vd t[VECTORS], bool behind, span *out) {
  for (int v = 0; v < VECTORS; v++) {
    out->a[v] = behind ? vd_max(s->a[v], t[v]) : s->a[v];
    out->b[v] = behind ? s->b[v] : vd_min(s->b[v], t[v]);
  }
  return lanes_of(p, out);
}

/* In the order in which rays that go forwards in all coordinates come to the children. */
static void descend(skf_packet *p, skf_branch *branch, const span *all) {
  skf_octree *tree = p->tracer->tree;
  skf_vd tx[VECTORS], ty[VECTORS], tz[VECTORS];
  pass(p, 0, branch->middle.x, tx), pass(p, 1, branch->middle.y, ty), pass(p, 2, branch->middle.z, tz);
  for (int z = 0; z < 2; z++) {
    span of_z, of_y, s;
    if (!cut(p, all, tz, z, &of_z)) continue;
    for (int y = 0; y < 2; y++) {
      if (!cut(p, &of_z, ty, y, &of_y)) continue;
      for (int x = 0; x < 2; x++) {
        unsigned lanes = cut(p, &of_y, tx, x, &s);
        if (lanes) meet(p, skf_octree_child(tree, branch, (x | y << 1 | z << 2) ^ p->backwards), &s, lanes);
      }
    }
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
