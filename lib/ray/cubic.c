/* SPDX-License-Identifier: MIT */
#include "ray/cubic.h"
#include <math.h>

void skf_cubic_hermite(double f0, double d0, double f1, double d1, double b[4]) {
  b[0] = f0;
  b[1] = f0 + d0 / 3;
  b[2] = f1 - d1 / 3;
  b[3] = f1;
}

double skf_cubic_at(const double b[4], double x) {
  double y = 1 - x;
  double a0 = y * b[0] + x * b[1], a1 = y * b[1] + x * b[2], a2 = y * b[2] + x * b[3];
  return y * (y * a0 + x * a1) + x * (y * a1 + x * a2);
}

static double slope_at(const double b[4], double x) {
  double y = 1 - x;
  return 3 * (y * y * (b[1] - b[0]) + 2 * x * y * (b[2] - b[1]) + x * x * (b[3] - b[2]));
}

/* Where the derivative vanishes inside (0, 1), in order. */
static int turns(const double b[4], double x[2]) {
  double q0 = b[1] - b[0], q1 = b[2] - b[1], q2 = b[3] - b[2];
  double A = q0 - 2 * q1 + q2, B = q1 - q0, C = q0, D = B * B - A * C; /* A x^2 + 2 B x + C */
  if (!(D > 0)) return 0;
  double r = -(B + copysign(sqrt(D), B)), y[2] = {r != 0 ? C / r : NAN, A != 0 ? r / A : NAN};
  int n = 0;
  for (int i = 0; i < 2; i++)
    if (y[i] > 0 && y[i] < 1) x[n++] = y[i];
  if (n == 2 && x[0] > x[1]) {
    double t = x[0];
    x[0] = x[1], x[1] = t;
  }
  return n;
}

void skf_cubic_range(const double b[4], double *lo, double *hi) {
  double x[2];
  *lo = fmin(b[0], b[3]), *hi = fmax(b[0], b[3]);
  if (b[1] >= *lo && b[1] <= *hi && b[2] >= *lo && b[2] <= *hi) return;
  for (int i = turns(b, x); i-- > 0;) {
    double f = skf_cubic_at(b, x[i]);
    *lo = fmin(*lo, f), *hi = fmax(*hi, f);
  }
}

bool skf_cubic_steep(const double b[4], double margin) {
  double q0 = 3 * (b[1] - b[0]), q1 = 3 * (b[2] - b[1]), q2 = 3 * (b[3] - b[2]), s = q0 > 0 ? 1 : -1;
  q0 *= s, q1 *= s, q2 *= s;
  if (!(q0 > margin && q2 > margin)) return false;
  if (q1 > margin) return true;
  /* the lowest point of the parabola, when it is inside */
  double A = q0 - 2 * q1 + q2, x = (q0 - q1) / A;
  if (!(A > 0 && x > 0 && x < 1)) return true;
  return (q0 * q2 - q1 * q1) / A > margin;
}

/* Bisection with Newton steps, between lo and hi where the signs differ. */
static double bracketed(const double b[4], double lo, double hi) {
  bool up = skf_cubic_at(b, hi) > 0;
  double x = 0.5 * (lo + hi);
  for (int i = 0; i < 200; i++) {
    double f = skf_cubic_at(b, x), d = slope_at(b, x), next = x - f / d;
    if (f == 0) return x;
    *((f > 0) == up ? &hi : &lo) = x;
    if (!(next > lo && next < hi)) next = 0.5 * (lo + hi);
    if (fabs(next - x) <= 0x1p-53 * fabs(next) || next == lo || next == hi) return next;
    x = next;
  }
  return x;
}

double skf_cubic_root(const double b[4]) {
  double f0 = b[0], f1 = b[3], x = f0 / (f0 - f1); /* Newton from the chord's root: two steps are mostly enough */
  for (int i = 0; i < 4; i++) {
    double next = x - skf_cubic_at(b, x) / slope_at(b, x);
    if (!(next >= 0 && next <= 1)) break;
    if (fabs(next - x) < 1e-7) return next;
    x = next;
  }
  return bracketed(b, 0, 1);
}

int skf_cubic_roots(const double b[4], double roots[3]) {
  double x[4] = {0};
  int n = turns(b, x + 1), count = 0;
  x[n + 1] = 1;
  for (int i = 0; i <= n; i++) {
    double f0 = skf_cubic_at(b, x[i]), f1 = skf_cubic_at(b, x[i + 1]);
    if ((f0 > 0) != (f1 > 0)) roots[count++] = f0 == 0 ? x[i] : f1 == 0 ? x[i + 1] : bracketed(b, x[i], x[i + 1]);
  }
  return count;
}
