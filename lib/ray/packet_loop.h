/* SPDX-License-Identifier: MIT */
/* The way through the octree, four lanes in a vector. Included by the units of each instruction set, for one vector and
   for two: VECTORS. */
#include "ray/packet_blobs.h"
#include "ray/packet_patches.h"

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

static void meet_patch(skf_packet *p, const skf_leaf *leaf, const span *s, unsigned lanes) {
  if (leaf->patch->degree == SKF_DEGREE)
    in_full_patch(p, leaf, s, lanes);
  else
    in_low_patch(p, leaf, s, lanes);
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

/* The part of a span before it passes a middle at t, or behind. */
SKF_INLINE span halved(const span *s, const skf_vd *t, unsigned behind) {
  span out = *s;
  for (int v = 0; v < VECTORS; v++)
    if (behind)
      out.a[v] = vd_max(s->a[v], t[v]);
    else
      out.b[v] = vd_min(s->b[v], t[v]);
  return out;
}

/* The children in the order in which rays that go forwards in all coordinates come to them; a half or a quarter into
   which no lane goes is passed over as a whole. */
static void descend(skf_packet *p, skf_branch *branch, const span *at) {
  skf_octree *tree = p->tracer->tree;
  span all = *at;
  skf_vd tx[VECTORS], ty[VECTORS], tz[VECTORS];
  pass(p, 0, branch->middle.x, tx), pass(p, 1, branch->middle.y, ty), pass(p, 2, branch->middle.z, tz);
  unsigned outside = atomic_load_explicit(&branch->outside, memory_order_relaxed), turn = (unsigned)p->backwards;
#pragma GCC unroll 2
  for (unsigned z = 0; z < 8; z += 4) {
    span half = halved(&all, tz, z);
    if (!lanes_of(p, &half)) continue;
#pragma GCC unroll 2
    for (unsigned y = 0; y < 4; y += 2) {
      span quarter = halved(&half, ty, y);
      if (!lanes_of(p, &quarter)) continue;
#pragma GCC unroll 2
      for (unsigned x = 0; x < 2; x++) {
        unsigned k = (x | y | z) ^ turn, lanes;
        if (outside >> k & 1) continue;
        span s = halved(&quarter, tx, x);
        if ((lanes = lanes_of(p, &s))) meet(p, skf_octree_child(tree, branch, (int)k), &s, lanes);
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
