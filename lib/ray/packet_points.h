/* SPDX-License-Identifier: MIT */
/* First crossings in a leaf of points, four lanes in a vector: pieces.c, each lane on a piece of its own. */
#ifndef SKF_RAY_PACKET_POINTS_H
#define SKF_RAY_PACKET_POINTS_H

#include "ray/packet_ways.h"

/* Bernstein coefficients of f on the piece from u to u + h. */
typedef struct skf_piece {
  skf_vd u, h, c[7];
} skf_piece;

/* A blob that some lane meets: of those that do not, the strength is 0; where its support begins and ends. */
typedef struct skf_support {
  skf_vd m0, m1, m2, strength, in, out;
  const skf_blob *blob;
} skf_support;

typedef struct skf_supports {
  uint32_t n;
  skf_support of[SKF_LEAF_BLOBS];
} skf_supports;

/* From where on F may be iso: each of n blobs is below iso / n as long as the tangent to its m, where it begins, is. */
SKF_INLINE skf_vd find_supports(const skf_leaf *leaf, skf_ways *ways, int v, skf_vi on, bool positive,
                                skf_supports *out) {
  skf_vd zero = vd_set(0), L = ways->length[v], never = vd_set(INFINITY), first = positive ? L : zero;
  uint32_t n = 0;
  ways->met[v] = 0;
  for (uint32_t i = 0; i < leaf->count; i++) {
    const skf_blob *b = leaf->blobs + i;
    const skf_way *w = &ways->of[i][v];
    skf_support *s = out->of + n;
    skf_vd half_R2 = vd_set(b->half_R2), D = w->m1 * w->m1 + vd_set(4) * w->m2 * w->m0;
    skf_vd root = vd_sqrt(vd_max(D, zero)), in = vd_max((w->m1 - root) * half_R2, zero);
    skf_vi met = (w->peak > zero) & on;
    s->m0 = w->m0, s->m1 = w->m1, s->m2 = w->m2, s->blob = b;
    s->strength = vd_select(met, vd_set(b->strength), zero);
    s->in = vd_select(met, in, never), s->out = vd_select(met, vd_min((w->m1 + root) * half_R2, L), -never);
    unsigned some = vi_any(met);
    n += some, ways->met[v] |= some << i;
    skf_vd quiet = vd_set(b->quiet), rise = quiet - vd_max(w->m0, zero), slope = vd_select(in > zero, root, w->m1);
    skf_vd until = in + vd_select((rise > zero) & (slope > zero), rise / slope, zero);
    first = vd_select(met & (w->peak > quiet), vd_min(first, until), first);
  }
  out->n = n;
  return first;
}

/* The next end of a support, but no more than `most` away. */
SKF_INLINE skf_vd next_end(const skf_supports *e, skf_vd u, skf_vd most) {
  skf_vd to = u + most;
  for (uint32_t i = 0; i < e->n; i++) {
    const skf_support *s = e->of + i;
    to = vd_select(s->in > u, vd_min(to, s->in), to);
    to = vd_select(s->out > u, vd_min(to, s->out), to);
  }
  return to;
}

SKF_INLINE void add_quartic(skf_vd s, skf_vd q0, skf_vd q1, skf_vd q2, skf_vd *c) {
  skf_vd sq0 = s * q0, sq1 = s * q1, sq2 = s * q2;
  c[0] += sq0 * q0, c[1] += sq0 * q1, c[3] += sq1 * q2, c[4] += sq2 * q2;
  c[2] += (sq0 * q2 + (sq1 + sq1) * q1) * vd_set(1. / 3);
}

SKF_INLINE void add_sextic(const skf_blob *b, skf_vd s, skf_vd q0, skf_vd q1, skf_vd q2, skf_vd *c) {
  skf_vd c2 = vd_set(b->c2), c3 = vd_set(b->c3), h0 = s * (c2 + c3 * q0), h1 = s * (c2 + c3 * q1),
         h2 = s * (c2 + c3 * q2);
  skf_vd m0 = q0 * q0, m1 = q0 * q1, m2 = (q0 * q2 + (q1 + q1) * q1) * vd_set(1. / 3), m3 = q1 * q2, m4 = q2 * q2;
  c[0] += m0 * h0, c[6] += m4 * h2;
  c[1] += (vd_set(2) * m1 * h0 + m0 * h1) * vd_set(1. / 3), c[5] += (m4 * h1 + vd_set(2) * m3 * h2) * vd_set(1. / 3);
  c[2] += (vd_set(6) * m2 * h0 + vd_set(8) * m1 * h1 + m0 * h2) * vd_set(1. / 15);
  c[3] += (m3 * h0 + vd_set(3) * m2 * h1 + m1 * h2) * vd_set(1. / 5);
  c[4] += (m4 * h0 + vd_set(8) * m3 * h1 + vd_set(6) * m2 * h2) * vd_set(1. / 15);
}

SKF_INLINE void expand(const int n, const skf_packet *p, const skf_supports *e, skf_vd u, skf_vd to, skf_piece *out) {
  skf_vd zero = vd_set(0), h = to - u, half = vd_set(0.5) * h, iso = vd_set(-p->tracer->iso);
  out->u = u, out->h = h;
  for (int k = 0; k <= n; k++) out->c[k] = iso;
  for (uint32_t i = 0; i < e->n; i++) {
    const skf_support *w = e->of + i;
    skf_vd m = w->m0 + u * (w->m1 - u * w->m2), q2 = w->m0 + to * (w->m1 - to * w->m2);
    skf_vd q1 = m + half * (w->m1 - (u + u) * w->m2);
    skf_vd s = vd_select((w->in <= u) & (w->out >= to), w->strength, zero);
    if (n == 4)
      add_quartic(s, vd_max(m, zero), q1, vd_max(q2, zero), out->c);
    else
      add_sextic(w->blob, s, vd_max(m, zero), q1, vd_max(q2, zero), out->c);
  }
}

/* What is known of the lanes. */
typedef struct skf_search {
  skf_vd u, most, side; /* the next piece begins at u and is no longer than `most` */
  skf_vi on, hit, clear;
  skf_piece found; /* of lanes that are hit: f changes its sign once on it */
} skf_search;

/* Decides a piece, or halves it: as `judge` in pieces.c. */
SKF_INLINE void judge(const int n, const skf_piece *q, skf_vd L, skf_vd noise, bool first, skf_search *s) {
  skf_vd zero = vd_set(0), one = vd_set(1), first_side = vd_select(q->c[0] > zero, one, -one);
  skf_vi begins = vi_set(0);
  if (first) {
    skf_vi known = s->side != zero;
    begins = ~known & ~(vd_abs(q->c[0]) > noise);
    first_side = vd_select(begins, vd_select(q->c[n] > zero, one, -one), first_side);
    s->side = vd_select(known, s->side, first_side);
  }
  skf_vd before = s->side * q->c[0];
  skf_vi clear = before > noise, crosses = clear, leaves = begins, over = vi_set(0);
  for (int k = 1; k <= n; k++) {
    skf_vd c = s->side * q->c[k];
    skf_vi same = c > noise, other = c < -noise;
    clear &= same, crosses &= (same & ~over) | other, over |= other;
    leaves &= c - before > noise + noise;
    before = c;
  }
  skf_vd end = q->u + q->h;
  crosses &= over & s->on, clear = (clear | leaves) & s->on;
  s->hit |= crosses, s->clear |= clear & (end >= L);
  skf_vi open = s->on & ~(crosses | clear), lost = ~begins & ~(s->side * q->c[0] > noise);
  s->most = vd_select(open, vd_set(0.5) * q->h, L);
  s->u = vd_select(clear, end, s->u);
  s->found.u = vd_select(crosses, q->u, s->found.u), s->found.h = vd_select(crosses, q->h, s->found.h);
  for (int k = 0; k <= n; k++) s->found.c[k] = vd_select(crosses, q->c[k], s->found.c[k]);
  s->on &= ~(crosses | lost | (clear & (end >= L)));
}

/* The root in (0, 1) of what has one, as `root` in pieces.c: Newton's steps between ends that close in. */
SKF_INLINE skf_vd root(const int n, const skf_vd *c, skf_vi on) {
  skf_vd d[7], zero = vd_set(0), lo = zero, hi = vd_set(1), x = polygon_root(n, c);
  skf_vi up = c[n] > zero;
  powers_of(n, c, d);
  for (int i = 0; i < 24 && vi_any(on); i++) {
    skf_vd f = d[n], slope = zero;
    for (int k = n - 1; k >= 0; k--) slope = slope * x + f, f = f * x + d[k];
    skf_vi above = ~((f > zero) ^ up);
    hi = vd_select(above, x, hi), lo = vd_select(above, lo, x);
    skf_vd next = x - f / slope, middle = vd_set(0.5) * (lo + hi);
    next = vd_select((next > lo) & (next < hi), next, middle);
    skf_vi close = ~(vd_abs(next - x) > vd_set(1e-7));
    x = vd_select(on, next, x);
    on &= ~close;
  }
  return x;
}

SKF_INLINE void search(const int n, skf_packet *p, const skf_leaf *leaf, skf_ways *ways, unsigned lanes,
                       skf_search *s) {
  enum { STEPS = 40 };
  skf_supports supports[VECTORS];
  skf_vd zero = vd_set(0);
  unsigned busy = lanes;
  for (int v = 0; v < VECTORS; v++) {
    skf_search *t = s + v;
    t->on = lanes_on(lanes, v), t->hit = t->clear = vi_set(0);
    t->u = find_supports(leaf, ways, v, t->on, p->tracer->iso > 0, supports + v);
    t->most = ways->length[v], t->side = sides_of(p, v);
    t->side = vd_select((t->side == zero) & (t->u > zero), vd_set(-1), t->side);
    t->found.u = t->found.h = vd_set(0);
    for (int k = 0; k <= n; k++) t->found.c[k] = vd_set(0);
  }
  for (int i = 0; i < STEPS && busy; i++) {
    p->looks += (size_t)__builtin_popcount(busy);
    busy = 0;
    for (int v = 0; v < VECTORS; v++) {
      skf_search *t = s + v;
      skf_piece q;
      if (!vi_any(t->on)) continue;
      skf_vd to = next_end(supports + v, t->u, vd_min(t->most, ways->length[v] - t->u));
      expand(n, p, supports + v, t->u, to, &q);
      judge(n, &q, ways->length[v], ways->noise[v], i == 0, t);
      busy |= (unsigned)vi_bits(t->on) << (SKF_LANES * v);
    }
  }
}

#endif
