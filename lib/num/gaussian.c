/* SPDX-License-Identifier: MIT */
#include "num/gaussian.h"
#include "core/vec3.h"
#include "num/gauss.h"

double skf_gaussian_span(double u0, double u1, double width) {
  const double c = 0.88622692545275801365; /* sqrt(pi) / 2 */
  if (u0 < 0 && u1 > 0 && width > 1) return c * (erf(u1) + erf(-u0));
  if (u1 <= 0) {
    double t = -u0;
    u0 = -u1, u1 = t;
  }
  /* beyond this the difference loses less than two bits */
  if (u0 >= 0 && width * (u0 + u1) > 1) return c * (u0 < 0.5 ? erf(u1) - erf(u0) : erfc(u0) - erfc(u1));
  const skf_gauss_node *node = skf_gauss_rule(8);
  double mid = 0.5 * (u0 + u1), half = 0.5 * width, sum = 0;
  for (int i = 0; i < 8; i++) {
    double x = half * node[i].x;
    sum += node[i].w * exp(-x * (2 * mid + x));
  }
  return half * sum * exp(-mid * mid);
}

/* Power series, all terms positive. */
static void small(double b, double *i0, double *gap, double *ratio) {
  double q = 0.25 * b * b, t = 1, u = 1, s = 1, r = 1, e = exp(-b);
  for (int k = 1; k < 100 && t > 1e-17 * s; k++) {
    t *= q / (k * k);
    u *= q / (k * (k + 1));
    s += t, r += u;
  }
  *i0 = e * s;
  *ratio = e * r;
  *gap = e * (s - 0.5 * b * r);
}

/* Asymptotic series [DLMF 10.40.1]: the difference term by term. */
static void large(double b, double *i0, double *gap, double *ratio) {
  double u = 1, v = 1, s = 1, d = 0, r = 1 / (8 * b);
  for (int k = 1; k < 60 && u > 1e-18; k++) {
    double m = (2. * k - 1) * (2. * k - 1);
    u *= m * r / k;
    v *= (m - 4) * r / k;
    d += u - v;
    s += u;
  }
  double c = 1 / sqrt(2 * SKF_PI * b);
  *i0 = c * s;
  *gap = c * d;
  *ratio = (*i0 - *gap) / (0.5 * b);
}

void skf_bessel_scaled(double b, double *i0, double *gap, double *ratio) {
  (b < 30 ? small : large)(b, i0, gap, ratio);
}
