/* SPDX-License-Identifier: MIT */
/* Polynomials of degree n on [0, 1] by Bernstein's coefficients, c[0] at 0 to c[n] at 1. All is inline: it is compiled
   once for each degree that is used. */
#ifndef SKF_RAY_BERNSTEIN_H
#define SKF_RAY_BERNSTEIN_H

#include <math.h>

#define SKF_EACH_DEGREE static inline __attribute__((always_inline))

/* De Casteljau: c becomes the left half, r the right one; returns the value between. */
SKF_EACH_DEGREE double skf_bernstein_halve(const int n, double *c, double *r) {
  for (int k = 0; k <= n; k++) r[k] = c[k];
  for (int k = 1; k <= n; k++) {
    for (int i = 0; i <= n - k; i++) r[i] = 0.5 * (r[i] + r[i + 1]);
    c[k] = r[0];
  }
  return c[n];
}

/* Taylor's coefficients at 0 */
SKF_EACH_DEGREE void skf_bernstein_powers(const int n, const double *c, double *d) {
  for (int k = 0; k <= n; k++) d[k] = c[k];
  for (int k = 1; k <= n; k++)
    for (int i = n; i >= k; i--) d[i] -= d[i - 1];
  for (int k = 1, choose = n; k < n; k++) d[k] *= choose, choose = choose * (n - k) / (k + 1);
}

/* The root in (0, 1) of what has one, by Newton's steps down to one below `least`; the first guess is that of the
   control points' polygon. d: Taylor's coefficients at 0. */
SKF_EACH_DEGREE double skf_bernstein_root(const int n, const double *c, double least, double *d) {
  double lo = 0, hi = 1, x = c[0] / (c[0] - c[n]);
  for (int k = 0; k < n; k++)
    if ((c[k] > 0) != (c[k + 1] > 0)) x = (k + c[k] / (c[k] - c[k + 1])) / n;
  skf_bernstein_powers(n, c, d);
  for (int i = 0; i < 60; i++) {
    double f = d[n], slope = 0;
    for (int k = n - 1; k >= 0; k--) slope = slope * x + f, f = f * x + d[k];
    double next = x - f / slope;
    if (f == 0) return x;
    *((f > 0) == (c[n] > 0) ? &hi : &lo) = x;
    if (!(next > lo && next < hi)) next = 0.5 * (lo + hi);
    if (fabs(next - x) < least) return next;
    x = next;
  }
  return x;
}

#endif
