/* SPDX-License-Identifier: MIT */
/* The largest F - iso on a path, by branch and bound: a piece is dismissed when its bounds keep it below the best place
   so far, and looked at in one place when F is monotone on it. */
#include "motion/view.h"
#include <float.h>

/* PATIENCE: places looked at in one step, before F is believed to be the same along it, as on a circular orbit: it
   would take some 1e7 of them. */
enum { DEPTH = 50, PATIENCE = 20000 };

static void consider(const skf_view *v, double s, skf_sight *best) {
  skf_sight at = skf_view_at(v, s);
  if (at.f > best->f) *best = at;
}

static void climb(const skf_view *v, double a, double b, int depth, int *left, skf_sight *best) {
  double half = 0.5 * (b - a), middle = a + half;
  skf_glance m = skf_view_place(v, middle, half);
  if (!skf_view_measure(v, &m, half, best->f)) { /* below it, or all inside: then any place is as good */
    if (m.lo > 0 && best->f < m.lo) consider(v, middle, best);
    return;
  }
  if (m.f > best->f) consider(v, middle, best);
  if (m.hi <= best->f + 2 * m.rough || depth == 0 || --*left < 0) return;
  if (fabs(m.slope) > m.second * half) return consider(v, m.slope > 0 ? b : a, best);
  bool upper = m.slope > 0;
  climb(v, upper ? middle : a, upper ? b : middle, depth - 1, left, best);
  climb(v, upper ? a : middle, upper ? middle : b, depth - 1, left, best);
}

/* The slope's zero nearby: the value alone tells the place to the root of its precision only. */
static void refine(const skf_view *v, double a, double b, skf_sight *best) {
  for (double d = 1e-7 * (b - a); d < b - a; d *= 16) {
    skf_sight l = skf_view_at(v, fmax(a, best->s - d)), r = skf_view_at(v, fmin(b, best->s + d)), c = *best;
    if (!(l.slope > 0 && r.slope < 0)) continue;
    for (int i = 0; i < 60 && r.s - l.s > 4 * DBL_EPSILON * fabs(r.s); i++) {
      double s = l.s + (r.s - l.s) * l.slope / (l.slope - r.slope), m = 0.5 * (l.s + r.s);
      if (i % 2 || !(s > l.s && s < r.s)) s = m;
      if (!(s > l.s && s < r.s)) break;
      c = skf_view_at(v, s);
      *(c.slope > 0 ? &l : &r) = c;
      if (c.slope == 0) break;
    }
    if (c.f >= best->f - 4 * c.rough) *best = c;
    return;
  }
}

void skf_view_summit(const skf_view *v, double a, double b, skf_sight *best) {
  double before = best->f;
  int left = PATIENCE;
  consider(v, a, best);
  consider(v, b, best);
  climb(v, a, b, DEPTH, &left, best);
  if (best->f > before && best->s > a && best->s < b) refine(v, a, b, best);
}
