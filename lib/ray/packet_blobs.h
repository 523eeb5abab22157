/* SPDX-License-Identifier: MIT */
/* First crossings in a leaf of blobs. What does not come to an end, or depends on rounding, is left to
   skf_packet_blobs. */
#ifndef SKF_RAY_PACKET_BLOBS_H
#define SKF_RAY_PACKET_BLOBS_H

#include "ray/packet_points.h"
#include "ray/packet_polish.h"
#include "ray/packet_segments.h"

/* Lanes that are done with the leaf, and for a crossing what brackets it. */
typedef struct skf_outcome {
  unsigned hit, below, above;
  skf_vd lo[VECTORS], hi[VECTORS], f[VECTORS], u[VECTORS]; /* f: at lo */
} skf_outcome;

SKF_INLINE void set_outcome(skf_outcome *o, int v, skf_vi hit, skf_vi clear, skf_vd side) {
  unsigned sure = (unsigned)vi_bits(clear), up = (unsigned)vi_bits(side > vd_set(0));
  o->hit |= (unsigned)vi_bits(hit) << (SKF_LANES * v);
  o->below |= (sure & ~up) << (SKF_LANES * v), o->above |= (sure & up) << (SKF_LANES * v);
}

SKF_INLINE void in_segments(skf_packet *p, const skf_leaf *leaf, skf_ways *ways, unsigned lanes, skf_outcome *o) {
  skf_course c;
  follow(p, leaf, ways, lanes, &c);
  for (int v = 0; v < VECTORS; v++) {
    set_outcome(o, v, c.hit[v], c.clear[v], c.side[v]);
    o->lo[v] = c.lo[v], o->hi[v] = c.hi[v], o->f[v] = c.f[v], o->u[v] = c.u[v];
    ways->met[v] = (1u << leaf->count) - 1;
  }
}

SKF_INLINE void in_points(const int n, skf_packet *p, const skf_leaf *leaf, skf_ways *ways, unsigned lanes,
                          skf_outcome *o) {
  skf_search s[VECTORS];
  search(n, p, leaf, ways, lanes, s);
  for (int v = 0; v < VECTORS; v++) {
    const skf_piece *q = &s[v].found;
    set_outcome(o, v, s[v].hit, s[v].clear, s[v].side);
    o->lo[v] = q->u, o->hi[v] = q->u + q->h, o->f[v] = q->c[0], o->u[v] = q->u;
    if (vi_any(s[v].hit)) o->u[v] += q->h * root(n, q->c, s[v].hit);
  }
}

/* Polishes hits; returns those that are finished. */
SKF_INLINE unsigned finish_hits(skf_packet *p, const skf_leaf *leaf, const skf_ways *ways, const skf_vd *from,
                                const skf_outcome *o) {
  unsigned finished = 0;
  for (int v = 0; v < VECTORS; v++) {
    unsigned mine = o->hit >> (SKF_LANES * v) & ((1u << SKF_LANES) - 1);
    double t[SKF_LANES], at[3][SKF_LANES], normal[3][SKF_LANES], f[SKF_LANES];
    skf_polished q;
    if (!mine) continue;
    skf_vi done =
        polish(p, leaf, ways, v, from[v] + o->lo[v], from[v] + o->hi[v], from[v] + o->u[v], lanes_on(o->hit, v), &q);
    mine &= (unsigned)vi_bits(done);
    vd_store(t, q.t), vd_store(f, o->f[v]);
    for (int i = 0; i < 3; i++) vd_store(at[i], q.at[i]), vd_store(normal[i], q.normal[i]);
    finished |= mine << (SKF_LANES * v);
    for (; mine; mine &= mine - 1) {
      int k = __builtin_ctz(mine);
      skf_answer *a = p->user[SKF_LANES * v + k];
      *a->found = true;
      *a->hit = (skf_hit){t[k], {at[0][k], at[1][k], at[2][k]}, {normal[0][k], normal[1][k], normal[2][k]}, f[k] < 0};
    }
  }
  p->alive &= ~finished;
  return finished;
}

static void take_hits(skf_packet *p, const skf_leaf *leaf, const skf_ways *ways, const skf_vd *from,
                      const skf_outcome *c) {
  enum { LANES = VECTORS * SKF_LANES };
  double t[LANES], u[LANES], lo[LANES], hi[LANES], f[LANES];
  unsigned hits = c->hit;
  if (p->exact) hits &= ~finish_hits(p, leaf, ways, from, c);
  if (!hits) return;
  for (int v = 0; v < VECTORS; v++) {
    int at = SKF_LANES * v;
    vd_store(t + at, from[v]), vd_store(u + at, c->u[v]), vd_store(f + at, c->f[v]);
    vd_store(lo + at, c->lo[v]), vd_store(hi + at, c->hi[v]);
  }
  for (; hits; hits &= hits - 1) {
    int k = __builtin_ctz(hits);
    p->crossed = f[k] < 0 ? p->crossed | 1u << k : p->crossed & ~(1u << k);
    skf_packet_found(p, k, leaf, &(skf_knot){.t = t[k] + lo[k], .f = f[k]}, &(skf_knot){.t = t[k] + hi[k], .f = -f[k]},
                     t[k] + u[k]);
  }
}

/* The first crossing of each lane in a leaf. Returns those lanes that are left to others; *hi: where those that cross
   are beyond. */
SKF_INLINE unsigned first_in_blobs(skf_packet *p, const skf_leaf *leaf, const skf_vd *from, const skf_vd *to,
                                   unsigned lanes, unsigned *hit, skf_vd *hi) {
  skf_ways ways;
  skf_outcome o;
  unsigned left = look_along(p, leaf, from, to, lanes, &ways);
  o.hit = o.above = 0, o.below = lanes & ~left;
  if (left && leaf->segments)
    in_segments(p, leaf, &ways, left, &o);
  else if (left && leaf->soft)
    in_points(6, p, leaf, &ways, left, &o);
  else if (left)
    in_points(4, p, leaf, &ways, left, &o);
  p->below = (p->below | o.below) & ~o.above, p->above = (p->above | o.above) & ~o.below;
  *hit = o.hit;
  if (o.hit) take_hits(p, leaf, &ways, from, &o);
  for (int v = 0; v < VECTORS; v++) hi[v] = from[v] + (o.hit ? o.hi[v] : vd_set(0));
  return left & ~(o.hit | o.below | o.above);
}

/* Every crossing: from beyond each on to the next. The same. */
static unsigned all_in_blobs(skf_packet *p, const skf_leaf *leaf, skf_vd *from, const skf_vd *to, unsigned lanes) {
  unsigned left = 0, hit;
  while (lanes) {
    skf_vd hi[VECTORS];
    left |= first_in_blobs(p, leaf, from, to, lanes, &hit, hi);
    lanes = hit & p->alive;
    for (int v = 0; v < VECTORS; v++) from[v] = vd_select(lanes_on(lanes, v), hi[v], from[v]);
    unsigned inside = p->crossed & lanes;
    p->above = (p->above & ~lanes) | inside, p->below = (p->below & ~lanes) | (lanes & ~inside);
  }
  return left;
}

#endif
