/* SPDX-License-Identifier: MIT */
/* A ray through a leaf with a patch, where F - iso is a polynomial to within a certified error. Where all Bernstein
   coefficients are beyond the error on one side, so is F - iso. Where the polynomial rises, or falls, everywhere by
   more than its derivative is off by, F does too: then the signs at the ends tell of one crossing or none. What is
   neither is halved; what a few halvings leave open is left to the walk. */
#include "ray/patch.h"
#include "core/vec3.h"
#include "ray/bernstein.h"
#include "ray/packet.h"

enum { N = SKF_DEGREE, HALVINGS = 10, ROOTS = 32 };

static skf_vec3 gradient(const skf_leaf *leaf, skf_vec3 p) {
  const skf_patch *q = leaf->patch;
  const double *c = q->c;
  int n = q->degree;
  double per = q->per, x = (p.x - leaf->center.x) * per, y = (p.y - leaf->center.y) * per,
         z = (p.z - leaf->center.z) * per, xi[N + 1] = {1}, yi[N + 1] = {1}, zi[N + 1] = {1};
  for (int i = 1; i <= N; i++) xi[i] = xi[i - 1] * x, yi[i] = yi[i - 1] * y, zi[i] = zi[i - 1] * z;
  skf_vec3 g = {0, 0, 0};
  for (int i = 0; i <= n; i++)
    for (int j = 0; i + j <= n; j++) {
      double f = 0, fz = 0;
      for (int k = 0; i + j + k <= n; k++, c++) {
        f += *c * zi[k];
        if (k) fz += *c * k * zi[k - 1];
      }
      if (i) g.x += f * i * xi[i - 1] * yi[j];
      if (j) g.y += f * j * xi[i] * yi[j - 1];
      g.z += fz * xi[i] * yi[j];
    }
  return v3_scale(per, g);
}

skf_vec3 skf_patch_turn(const skf_leaf *leaf, skf_vec3 from, skf_vec3 to) {
  return v3_sub(gradient(leaf, to), gradient(leaf, from));
}

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
static double root_of(const double c[N + 1], double *c2, double *c3) {
  double d[N + 1], x = skf_bernstein_root(N, c, 1e-4, d);
  *c2 = *c3 = 0;
  for (int k = N; k > 1; k--) {
    *c2 = *c2 * x + 0.5 * k * (k - 1) * d[k];
    if (k > 2) *c3 = *c3 * x + k * (k - 1) * (k - 2) / 6. * d[k];
  }
  return x;
}

static bool push(findings *out, const double c[N + 1], double from, double to) {
  double c2, c3, per = 1 / (to - from);
  if (out->count == ROOTS) return false;
  crossing *r = out->roots + out->count++;
  *r = (crossing){from, to, c[0], c[N], from + (to - from) * root_of(c, &c2, &c3), 0, 0};
  r->c2 = c2 * per * per, r->c3 = c3 * per * per * per;
  return true;
}

/* The crossings in order; false: they cannot be told. With `first` one is enough. slope: what the derivative by the
   parameter is off by. */
static bool isolate(const double coefficients[N + 1], double off, double slope, bool first, findings *out) {
  double stack[HALVINGS + 1][N + 1], from = 0, ends[HALVINGS + 1];
  int depth = 0;
  ends[0] = 1;
  for (int k = 0; k <= N; k++) stack[0][k] = coefficients[k];
  if (fabs(coefficients[N]) <= off) return false;
  while (depth >= 0) {
    double *c = stack[depth], to = ends[depth], margin = slope * (to - from) / N + 2 * off * 1e-9;
    int below = 0, above = 0, falls = 0, rises = 0;
    for (int k = 0; k <= N; k++) below += c[k]<-off, above += c[k]> off;
    for (int k = 0; k < N; k++) falls += c[k + 1] - c[k]<-margin, rises += c[k + 1] - c[k]> margin;
    if (below <= N && above <= N && falls < N && rises < N) {
      if (depth == HALVINGS) return false;
      double right[N + 1], middle = 0.5 * (from + to);
      if (fabs(skf_bernstein_halve(N, c, right)) <= off) return false;
      for (int k = 0; k <= N; k++) stack[depth + 1][k] = c[k], c[k] = right[k];
      ends[++depth] = middle;
      continue;
    }
    int sign = c[N] > 0 ? 1 : -1;
    if (out->last && sign != out->last) {
      if (!push(out, c, from, to)) return false;
      if (first) return true;
    }
    out->last = sign, from = to, depth--;
  }
  return true;
}

static void emit(skf_packet *p, int lane, const skf_leaf *leaf, double start, double L, const crossing *r) {
  skf_knot a = {.t = start + r->a * L, .f = r->fa}, b = {.t = start + r->b * L, .f = r->fb};
  double per = 1 / L;
  skf_bow bow = {r->c2 * per * per, r->c3 * per * per * per, leaf->patch->off.bend, 1 / leaf->patch->per};
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
  if (!isolate(c, off, leaf->patch->off.slope * (b - a), p->first, &r)) {
    skf_packet_walk(p, lane, leaf, a, b);
    return;
  }
  for (int i = 0; i < r.count && p->alive & bit; i++) emit(p, lane, leaf, a, b - a, r.roots + i);
  p->below = r.last < 0 ? p->below | bit : p->below & ~bit;
  p->above = r.last > 0 ? p->above | bit : p->above & ~bit;
}
