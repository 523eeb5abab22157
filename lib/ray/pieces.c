/* SPDX-License-Identifier: MIT */
/* A ray through a leaf of points. Between the places where it enters and leaves their supports, F - iso is a polynomial
   of degree 4, with soft objects 6. By Bernstein coefficients it has no root where they have one sign, and exactly one
   where their sign changes once; else it is halved. What rounding leaves open is left to the walk. */
#include "ray/bernstein.h"
#include "ray/packet.h"
#include <float.h>

enum { BREAKS = 2 * SKF_LEAF_BLOBS + 2, DEGREE = 6, HALVINGS = 24, ROOTS = 64 };

/* m = m0 + u (m1 - per u) at u behind the start, from `from` to `to`, where it is not negative. */
typedef struct arch {
  double m0, m1, per, from, to;
  const skf_blob *blob;
} arch;

typedef struct pieces {
  int n, breaks;
  double iso, noise;
  arch arch[SKF_LEAF_BLOBS];
  double at[BREAKS];
} pieces;

/* A place where f changes its sign once, with f at its ends. */
typedef struct bracket {
  double a, b, fa, fb, guess;
} bracket;

static void insert(pieces *p, double u) {
  int i = p->breaks++;
  for (; i > 0 && p->at[i - 1] > u; i--) p->at[i] = p->at[i - 1];
  p->at[i] = u;
}

static void cut(pieces *p, const skf_leaf *leaf, skf_vec3 start, skf_vec3 d, double L) {
  p->at[0] = 0, p->at[1] = L, p->breaks = 2;
  for (uint32_t i = 0; i < leaf->count; i++) {
    const skf_blob *b = leaf->blobs + i;
    skf_vec3 v = v3_sub(start, b->at);
    double c = v3_dot(v, d), w = v3_norm2(v), q = b->R * b->R - w, D = c * c + q;
    if (!(D > 0)) continue;
    double s = sqrt(D), from = -c - s, to = s - c;
    if (!(from < L && to > 0)) continue;
    from = from > 0 ? from : 0, to = to < L ? to : L;
    if (!(from < to)) continue;
    if (from > 0) insert(p, from);
    if (to < L) insert(p, to);
    p->arch[p->n++] = (arch){1 - w * b->per, -2 * c * b->per, b->per, from, to, b};
  }
}

/* c of f on [a, b] */
SKF_EACH_DEGREE void expand(const int n, const pieces *p, double a, double b, double c[DEGREE + 1]) {
  double L = b - a;
  for (int k = 0; k <= n; k++) c[k] = -p->iso;
  for (int i = 0; i < p->n; i++) {
    const arch *r = p->arch + i;
    if (r->from > a || r->to < b) continue;
    double q0 = r->m0 + a * (r->m1 - r->per * a), q2 = r->m0 + b * (r->m1 - r->per * b), s = r->blob->strength;
    double q1 = q0 + 0.5 * L * (r->m1 - 2 * r->per * a);
    q0 = q0 > 0 ? q0 : 0, q2 = q2 > 0 ? q2 : 0;
    double m[5] = {q0 * q0, q0 * q1, (q0 * q2 + 2 * q1 * q1) * (1. / 3), q1 * q2, q2 * q2};
    if (n == 4) {
      for (int k = 0; k < 5; k++) c[k] += s * m[k];
      continue;
    }
    double c2 = r->blob->c2, c3 = r->blob->c3, h0 = c2 + c3 * q0, h1 = c2 + c3 * q1, h2 = c2 + c3 * q2;
    c[0] += s * m[0] * h0;
    c[1] += s * (2 * m[1] * h0 + m[0] * h1) / 3;
    c[2] += s * (6 * m[2] * h0 + 8 * m[1] * h1 + m[0] * h2) / 15;
    c[3] += s * (m[3] * h0 + 3 * m[2] * h1 + m[1] * h2) / 5;
    c[4] += s * (m[4] * h0 + 8 * m[3] * h1 + 6 * m[2] * h2) / 15;
    c[5] += s * (m[4] * h1 + 2 * m[3] * h2) / 3;
    c[6] += s * m[4] * h2;
  }
}

typedef enum verdict { CLEAR, CROSSING, OPEN } verdict;

/* `fresh`: f at the start may be 0, from where the ray comes. */
SKF_EACH_DEGREE verdict judge(const int n, const double *c, double noise, bool fresh) {
  int below = 0, above = 0, changes = 0;
  for (int k = 0; k <= n; k++) below += c[k]<-noise, above += c[k]> noise;
  if (below == n + 1 || above == n + 1) return CLEAR;
  if (below + above == n + 1) {
    for (int k = 0; k < n; k++) changes += (c[k] > 0) != (c[k + 1] > 0);
    return changes == 1 ? CROSSING : OPEN;
  }
  if (fabs(c[0]) > noise || !fresh) return OPEN;
  for (int k = 0; k < n; k++) /* leaves its root and does not come back */
    if (!((c[k + 1] - c[k]) * (c[n] > 0 ? 1 : -1) > 2 * noise)) return OPEN;
  return CLEAR;
}

/* Roots found so far, and the sign of f at the end. */
typedef struct findings {
  int count, last;
  bracket roots[ROOTS];
} findings;

/* Adds the roots on [a, b], in order; false: they cannot be told. With `first` one is enough. */
SKF_EACH_DEGREE bool isolate(const int n, const pieces *p, double a, double b, bool fresh, bool first, findings *out) {
  double stack[HALVINGS + 1][DEGREE + 1], from = a, ends[HALVINGS + 1];
  int depth = 0;
  ends[0] = b;
  expand(n, p, a, b, stack[0]);
  if (fabs(stack[0][n]) <= p->noise || (fabs(stack[0][0]) <= p->noise && !fresh)) return false;
  while (depth >= 0) {
    double *c = stack[depth], to = ends[depth];
    verdict v = judge(n, c, p->noise, fresh);
    if (v == OPEN) {
      if (depth == HALVINGS) return false;
      double right[DEGREE + 1], middle = 0.5 * (from + to);
      if (fabs(skf_bernstein_halve(n, c, right)) <= p->noise) return false;
      for (int k = 0; k <= n; k++) stack[depth + 1][k] = c[k], c[k] = right[k];
      ends[++depth] = middle;
      continue;
    }
    if (v == CROSSING) {
      if (out->count == ROOTS) return false;
      double d[DEGREE + 1], x = skf_bernstein_root(n, c, 1e-7, d);
      out->roots[out->count++] = (bracket){from, to, c[0], c[n], from + (to - from) * x};
      if (first) return true;
    }
    out->last = c[n] > 0 ? 1 : -1;
    from = to, fresh = false;
    depth--;
  }
  return true;
}

SKF_EACH_DEGREE bool find(const int n, const pieces *p, bool fresh, bool first, findings *out) {
  for (int i = 0; i + 1 < p->breaks; i++) {
    if (!(p->at[i] < p->at[i + 1])) continue;
    if (!isolate(n, p, p->at[i], p->at[i + 1], fresh, first, out)) return false;
    if (first && out->count) return true;
    fresh = false;
  }
  return true;
}

static bool find_quartic(const pieces *p, bool fresh, bool first, findings *out) {
  return find(4, p, fresh, first, out);
}
static bool find_sextic(const pieces *p, bool fresh, bool first, findings *out) {
  return find(6, p, fresh, first, out);
}

void skf_packet_found(skf_packet *p, int lane, const skf_leaf *leaf, const skf_knot *a, const skf_knot *b,
                      double guess) {
  skf_walk *w = skf_packet_lane(p, lane);
  w->leaf = leaf;
  if (!p->found(p->user[lane], w, a, b, guess)) p->alive &= ~(1u << lane);
  w->leaf = NULL;
}

void skf_packet_blobs(skf_packet *p, int lane, const skf_leaf *leaf, double a, double b) {
  if (leaf->segments) {
    skf_packet_walk(p, lane, leaf, a, b);
    return;
  }
  pieces q;
  findings r;
  const skf_walk *w = skf_packet_lane(p, lane);
  unsigned bit = 1u << lane;
  bool fresh = !((p->below | p->above) & bit);
  q.n = 0, q.iso = p->tracer->iso, q.noise = leaf->grain + leaf->slope * p->shift[lane];
  r.count = r.last = 0;
  cut(&q, leaf, v3_mad(w->origin, a, w->direction), w->direction, b - a);
  if (!(leaf->soft ? find_sextic : find_quartic)(&q, fresh, p->first, &r)) {
    skf_packet_walk(p, lane, leaf, a, b);
    return;
  }
  for (int i = 0; i < r.count && p->alive & bit; i++) {
    const bracket *k = r.roots + i;
    skf_knot from = {.t = a + k->a, .f = k->fa}, to = {.t = a + k->b, .f = k->fb};
    skf_packet_found(p, lane, leaf, &from, &to, a + k->guess);
  }
  p->below = r.last < 0 ? p->below | bit : p->below & ~bit;
  p->above = r.last > 0 ? p->above | bit : p->above & ~bit;
}
