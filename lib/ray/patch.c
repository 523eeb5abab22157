/* SPDX-License-Identifier: MIT */
/* A ray through a leaf with a patch, where F - iso is a polynomial to within a certified error. Where all Bernstein
   coefficients are beyond the error on one side, so is F - iso. Where the polynomial rises, or falls, everywhere by
   more than its derivative is off by, F does too: then the signs at the ends tell of one crossing or none. What is
   neither is halved; what a few halvings leave open is left to the walk. */
#include "ray/bernstein.h"
#include "ray/packet.h"

enum { N = SKF_DEGREE, HALVINGS = 10, ROOTS = 32 };

/* A crossing in (a, b), both in [0, 1], f there, the polynomial's root and two of its Taylor coefficients there. */
typedef struct crossing {
  double a, b, fa, fb, root, c2, c3;
} crossing;

typedef struct findings {
  int count, last; /* the sign of f just before the next piece, 0: on the surface */
  crossing roots[ROOTS];
} findings;

/* The root in (0, 1) of c, which rises or falls, to some 1e-8, and Taylor's coefficients there. The field is looked at
   there, and goes on from what it is: a step below 1e-4 is good enough. */
static double root_of(int n, const double c[N + 1], double *c2, double *c3) {
  double d[N + 1], x = skf_bernstein_root(n, c, 1e-4, d);
  *c2 = *c3 = 0;
  for (int k = n; k > 1; k--) {
    *c2 = *c2 * x + 0.5 * k * (k - 1) * d[k];
    if (k > 2) *c3 = *c3 * x + k * (k - 1) * (k - 2) / 6. * d[k];
  }
  return x;
}

static bool push(findings *out, int n, const double c[N + 1], double from, double to) {
  double c2, c3, per = 1 / (to - from);
  if (out->count == ROOTS) return false;
  crossing *r = out->roots + out->count++;
  *r = (crossing){from, to, c[0], c[n], from + (to - from) * root_of(n, c, &c2, &c3), 0, 0};
  r->c2 = c2 * per * per, r->c3 = c3 * per * per * per;
  return true;
}

/* The crossings in order of a polynomial of degree n; false: they cannot be told. With `first` one is enough. slope:
   what the derivative by the parameter is off by. */
static bool isolate(int n, const double coefficients[N + 1], double off, double slope, bool first, findings *out) {
  double stack[HALVINGS + 1][N + 1], from = 0, ends[HALVINGS + 1];
  int depth = 0;
  ends[0] = 1;
  for (int k = 0; k <= n; k++) stack[0][k] = coefficients[k];
  if (fabs(coefficients[n]) <= off) return false;
  while (depth >= 0) {
    double *c = stack[depth], to = ends[depth], margin = slope * (to - from) / n + 2 * off * 1e-9;
    int below = 0, above = 0, falls = 0, rises = 0;
    for (int k = 0; k <= n; k++) below += c[k]<-off, above += c[k]> off;
    for (int k = 0; k < n; k++) falls += c[k + 1] - c[k]<-margin, rises += c[k + 1] - c[k]> margin;
    if (below <= n && above <= n && falls < n && rises < n) {
      if (depth == HALVINGS) return false;
      double right[N + 1], middle = 0.5 * (from + to);
      if (fabs(skf_bernstein_halve(n, c, right)) <= off) return false;
      for (int k = 0; k <= n; k++) stack[depth + 1][k] = c[k], c[k] = right[k];
      ends[++depth] = middle;
      continue;
    }
    int sign = c[n] > 0 ? 1 : -1;
    if (out->last && sign != out->last) {
      if (!push(out, n, c, from, to)) return false;
      if (first) return true;
    }
    out->last = sign, from = to, depth--;
  }
  return true;
}

static void emit(skf_packet *p, int lane, const skf_leaf *leaf, double start, double L, const crossing *r) {
  skf_knot a = {.t = start + r->a * L, .f = r->fa}, b = {.t = start + r->b * L, .f = r->fb};
  double per = 1 / L;
  skf_bow bow = {r->c2 * per * per, r->c3 * per * per * per, leaf->patch->off.bend, .loose = leaf->bend};
  skf_packet_lane(p, lane)->bow = &bow;
  skf_packet_found(p, lane, leaf, &a, &b, start + r->root * L);
  p->walk[lane].bow = NULL;
}

/* The sign of f at a, where the model does not tell it: what has come before, or the field; 0 on the surface. */
static int sign_at(skf_packet *p, int lane, const skf_leaf *leaf, double a) {
  int last = (int)(p->above >> lane & 1) - (int)(p->below >> lane & 1);
  if (last) return last;
  skf_walk *w = skf_packet_lane(p, lane);
  skf_knot *k = p->knot + lane;
  w->leaf = leaf;
  if (!k->known || k->t != a) skf_walk_look(w, a, k);
  w->leaf = NULL;
  return fabs(k->f) > k->noise ? (k->f > 0 ? 1 : -1) : 0;
}

void skf_packet_patch(skf_packet *p, int lane, const skf_leaf *leaf, double a, double b, const double c[N + 1],
                      double off) {
  findings r;
  unsigned bit = 1u << lane;
  r.count = 0, r.last = c[0] > off ? 1 : c[0] < -off ? -1 : sign_at(p, lane, leaf, a);
  if (!isolate(leaf->patch->degree, c, off, leaf->patch->off.slope * (b - a), p->first, &r)) {
    skf_packet_walk(p, lane, leaf, a, b);
    return;
  }
  for (int i = 0; i < r.count && p->alive & bit; i++) emit(p, lane, leaf, a, b - a, r.roots + i);
  p->below = r.last < 0 ? p->below | bit : p->below & ~bit;
  p->above = r.last > 0 ? p->above | bit : p->above & ~bit;
}
