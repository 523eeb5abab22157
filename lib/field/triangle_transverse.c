/* SPDX-License-Identifier: MIT */
/* The cone's gradient across a thin triangle: int [h(far side) - h(longest side)] dX, the difference taken before the
   kernel is, in the side edges' own abscissae. */
#include "field/triangle_compact.h"

typedef struct side {
  const skf_triangle_view *g;
  double R, height, Yb; /* Yb: ordinate of the longest side, from p' */
  double start, len;    /* l at the start of the side edge, its length */
  double foot, slope;   /* X = foot - slope l, slope > 0 */
  bool left;            /* the side edge ends where the longest one starts */
} side;

static double rise(const side *s, double l) {
  double R = s->R, X = s->foot - l * s->slope, tau = (l - s->start) / s->len;
  double wide = s->height * (s->left ? 1 - tau : tau), cb = hypot(s->Yb, s->g->z), ct = hypot(s->Yb + wide, s->g->z);
  double rb = hypot(X, cb), rt = hypot(X, ct), ab = 1 - rb / R, at = 1 - rt / R;
  if (ab <= 0) return at <= 0 ? 0 : at * at;
  if (at <= 0) return -ab * ab;
  return -wide * (2 * s->Yb + wide) / ((rb + rt) * R) * (ab + at);
}

static double over(const side *s, double l1, double l2, double delta) {
  double l[SKF_PANEL_NODES], w[SKF_PANEL_NODES], sum = 0;
  skf_panels p = skf_panels_over(l1, l2, fmax(delta, 1e-3 * skf_edge_nearest(l1, l2)));
  for (int k = 0; k < p.count; k++) {
    skf_panel_nodes(&p, k, l, w);
    for (int i = 0; i < SKF_PANEL_NODES; i++) sum += w[i] * rise(s, l[i]);
  }
  return sum;
}

/* Half the chord of a line at distance d from p'. */
static double chord(double R, double d, double z) { return sqrt(fmax((R - fabs(z)) * (R + fabs(z)) - d * d, 0)); }

double skf_cone_transverse(const skf_triangle_view *g, double R) {
  const skf_triangle_plan *T = g->T;
  int i = T->longest;
  double height = T->twice / T->diam, total = 0, bottom = chord(R, g->d[i], g->z), apex = skf_triangle_apex(g);
  for (int step = 1; step <= 2; step++) {
    int j = (i + step) % 3;
    bool left = step == 2;
    side s = {g, R, height, -g->d[i], g->l1[j], T->L[j], -T->s[j] * g->d[j], -T->c[j], left};
    if (!(left ? apex > g->l1[i] : g->l2[i] > apex)) continue;
    double own = chord(R, g->d[j], g->z), delta = fmin(hypot(g->d[j], g->z), hypot(g->d[i], g->z));
    /* breaks: the foot of p on the side edge and on the longest one, the rim on both */
    double at[8] = {g->l1[j], g->l2[j], 0, own, -own};
    for (int k = -1; k <= 1; k++) at[6 + k] = (s.foot - k * bottom) / s.slope;
    for (int k = 2; k < 8; k++) at[k] = fmin(fmax(at[k], g->l1[j]), g->l2[j]);
    for (int a = 1; a < 8; a++)
      for (int b = a; b > 0 && at[b - 1] > at[b]; b--) {
        double swap = at[b];
        at[b] = at[b - 1];
        at[b - 1] = swap;
      }
    for (int k = 0; k < 7; k++)
      if (at[k + 1] > at[k]) total += s.slope * over(&s, at[k], at[k + 1], fmax(delta, 1e-10 * T->diam));
  }
  return total;
}
