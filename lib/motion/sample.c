/* SPDX-License-Identifier: MIT */
/* Contacts by samples of F and its slope along a path: quick where fields are dear, but blind to what is thin. */
#include "motion/view.h"

/* Where the cubic through values and slopes of two places peaks between them; NAN where it does not. */
static double peak(const skf_sight *a, const skf_sight *b) {
  double L = b->s - a->s, p = L * a->slope, q = L * b->slope, d = b->f - a->f;
  double c3 = p + q - 2 * d, c2 = 3 * d - 2 * p - q; /* f = a.f + p u + c2 u^2 + c3 u^3 */
  double D = c2 * c2 - 3 * c3 * p;
  if (!(D >= 0) || !(p > 0)) return NAN;
  double u = p / (sqrt(D) - c2); /* the root of the derivative where it falls */
  return u > 0 && u < 1 ? a->s + L * u : NAN;
}

/* The entry between two samples of which the first is outside or in doubt; false when there is none. */
static bool between(const skf_view *v, const skf_sight *a, const skf_sight *b, double *s) {
  double inside = b->s;
  if (!(b->f > b->rough)) {
    double top = peak(a, b);
    if (!(top > a->s)) return false;
    skf_sight c = skf_view_at(v, top);
    if (!(c.f > c.rough)) return false;
    inside = top;
  }
  *s = a->f < 0 ? skf_view_polish(v, a->s, inside) : a->s;
  return true;
}

bool skf_view_sample(const skf_view *v, double a, double b, int pieces, int *side, double *s) {
  skf_sight last = skf_view_at(v, a);
  if (*side == 0) *side = last.f > last.rough ? 1 : -1;
  for (int i = 1; i <= pieces; i++) {
    skf_sight next = skf_view_at(v, i < pieces ? a + (b - a) / pieces * i : b);
    if (*side < 0 && between(v, &last, &next, s)) return true;
    if (fabs(next.f) > next.rough) *side = next.f > 0 ? 1 : -1;
    last = next;
  }
  return false;
}
