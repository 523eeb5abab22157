/* SPDX-License-Identifier: MIT */
#include "field/far_mixture.h"
#include "core/vec3.h"
#include <stdlib.h>
#include <string.h>

static double power_of(skf_kernel_type type) {
  return type == SKF_INVERSE ? 0.5 : type == SKF_INVERSE_SQUARED ? 1 : type == SKF_CAUCHY ? 2 : 0;
}

bool skf_far_kernel(skf_kernel_type type) { return power_of(type) > 0; }

/* y^-alpha = sum w exp(-t y) for y in [1, R] */
typedef struct exponentials {
  int count;
  double t[FAR_TERMS], w[FAR_TERMS];
} exponentials;

/* The largest relative error of the sum and of its derivative. */
static double error_of(const exponentials *e, double alpha, double R) {
  enum { SAMPLES = 96 };
  double worst = 0;
  for (int i = 0; i < SAMPLES; i++) {
    double y = exp(log(R) * i / (SAMPLES - 1)), s = 0, d = 0;
    for (int k = 0; k < e->count; k++) {
      double v = e->w[k] * exp(-e->t[k] * y);
      s += v, d += v * e->t[k];
    }
    double p = pow(y, alpha);
    worst = fmax(worst, fmax(fabs(s * p - 1), fabs(d * p * y / alpha - 1)));
  }
  return worst;
}

/* t = exp(u - q exp(-3/2 u)), trapezoidal in u with step h, from u0 down. */
static bool rule(double alpha, double R, double accuracy, double h, double u0, exponentials *e) {
  double q = 4 * pow(R, -1.5), per = 1 / tgamma(alpha);
  e->count = 0;
  for (double u = u0;; u -= h) {
    double bend = q * exp(-1.5 * u), t = exp(u - bend), w = per * h * (1 + 1.5 * bend) * pow(t, alpha);
    if (bend > 700 || (t < 1 / R && w * pow(R, alpha) < 0.01 * accuracy)) return true;
    if (w * exp(-t) * fmax(1, t) < 0.01 * accuracy && t > 1) continue;
    if (e->count == FAR_TERMS) return false;
    e->t[e->count] = t, e->w[e->count++] = w;
  }
}

static bool find(double alpha, double R, double accuracy, exponentials *e) {
  double top = log(40 - 2 * log(accuracy));
  for (double h = 0.9; h > 0.1; h *= 0.95)
    for (int shift = 0; shift < 4; shift++)
      if (rule(alpha, R, accuracy, h, top + 0.25 * h * shift, e) && error_of(e, alpha, R) <= accuracy) return true;
  return false;
}

void skf_far_gaussian(double t, double shift, double c[FAR_NODES][FAR_NODES]) {
  double T[FAR_NODES][FAR_NODES], f[FAR_NODES][FAR_NODES], half[FAR_NODES][FAR_NODES], x[FAR_NODES];
  for (int k = 0; k < FAR_NODES; k++) {
    x[k] = cos(SKF_PI * (k + 0.5) / FAR_NODES);
    for (int i = 0; i < FAR_NODES; i++) /* the angle reduced exactly */
      T[k][i] = cos(SKF_PI * (i * (2 * k + 1) % (4 * FAR_NODES)) / (2 * FAR_NODES)) * (i ? 2.0 : 1.0) / FAR_NODES;
  }
  for (int k = 0; k < FAR_NODES; k++)
    for (int l = 0; l < FAR_NODES; l++) {
      double d = 0.5 * FAR_WIDE * (x[k] - x[l]) - shift;
      f[k][l] = exp(-t * d * d);
    }
  memset(half, 0, sizeof half);
  memset(c, 0, FAR_NODES * sizeof *c);
  for (int k = 0; k < FAR_NODES; k++)
    for (int l = 0; l < FAR_NODES; l++)
      for (int i = 0; i < FAR_NODES; i++) half[k][i] += f[k][l] * T[l][i];
  for (int k = 0; k < FAR_NODES; k++)
    for (int j = 0; j < FAR_NODES; j++)
      for (int i = 0; i < FAR_NODES; i++) c[j][i] += T[k][j] * half[k][i];
}

/* What is lost when the polynomials from n on are left out along one axis, of F and of its derivative per side. */
typedef struct tail {
  double lost[2][FAR_NODES + 1];
} tail;

static void tails(double c[FAR_NODES][FAR_NODES], tail *out) {
  memset(out, 0, sizeof *out);
  for (int n = FAR_NODES - 1; n >= 0; n--) {
    double s = 0, d = 0;
    for (int k = 0; k < FAR_NODES; k++) { /* less is rounding */
      if (fabs(c[k][n]) > 1e-15) s += fabs(c[k][n]), d += 2 * k * fabs(c[k][n]);
      if (fabs(c[n][k]) > 1e-15) s += fabs(c[n][k]), d += 2 * n * fabs(c[n][k]);
    }
    out->lost[0][n] = out->lost[0][n + 1] + s;
    out->lost[1][n] = out->lost[1][n + 1] + d;
  }
}

/* The largest value along one axis, for cells `shift` apart. */
static double peak(double t, int shift) {
  double gap = shift > 1 ? shift - 1 : 0;
  return exp(-t * gap * gap);
}

/* Over all pairs of cells in an interaction list, the worst of what a term loses at n polynomials along each axis over
   the kernel at the largest distance. */
static double loss(const far_term *g, const tail axis[FAR_REACH + 1], int n, double alpha, double c2) {
  double worst = 0;
  for (int a = 2; a <= FAR_REACH; a++)
    for (int b = 0; b <= a; b++)
      for (int c = 0; c <= b; c++) {
        const int shift[3] = {a, b, c};
        double far = 0, lost[2] = {0, 0};
        for (int k = 0; k < 3; k++) {
          double reach = shift[k] + 1;
          double others = peak(g->t, shift[(k + 1) % 3]) * peak(g->t, shift[(k + 2) % 3]);
          far += reach * reach;
          for (int e = 0; e < 2; e++) lost[e] += others * axis[shift[k]].lost[e][n];
        }
        double value = pow(far + c2, -alpha), slope = 2 * alpha * value * sqrt(far) / (far + c2);
        worst = fmax(worst, g->w * fmax(lost[0] / value, lost[1] / fmax(slope, value / sqrt(far))));
      }
  return worst;
}

/* Degrees along each axis to total degrees, as measured: the finer, the more does the gradient between facing corners
   take. tests/field/test_far.c measures the outcome. */
static int total_order(int n, double accuracy) {
  double digits = -log10(accuracy);
  return (5 * n + 3) / 4 + (digits > 9 ? (int)ceil((digits - 9) / 1.5 - 1e-9) : 0);
}

static bool expand(far_term *g, double alpha, double c2, double accuracy, int count) {
  double c[FAR_REACH + 1][FAR_NODES][FAR_NODES];
  tail axis[FAR_REACH + 1];
  for (int s = 0; s <= FAR_REACH; s++) {
    skf_far_gaussian(g->t, s, c[s]);
    tails(c[s], axis + s);
  }
  int n = 2;
  while (n < FAR_NODES && loss(g, axis, n, alpha, c2) > 5 * accuracy / count) n++;
  g->order = total_order(n, accuracy);
  if (g->order > FAR_ORDER) return false;
  for (int s = 0; s < FAR_SHIFTS; s++) {
    int away = abs(s - FAR_REACH);
    double far = away + 1;
    g->matters[s] =
        g->w * peak(g->t, away) * fmax(1, 2 * g->t) > 5e-3 * accuracy / count * pow(3 * far * far + c2, -alpha);
    for (int i = 0; i < g->order; i++)
      for (int j = 0; j < g->order; j++) {
        double v = c[away][j][i] * (s < FAR_REACH && (i + j) % 2 ? -1 : 1);
        g->along[s].m[i][j] = v;
        g->last[s].m[i][j] = g->w * v;
      }
  }
  return true;
}

bool skf_far_mixture_make(skf_kernel kernel, double side, double accuracy, far_mixture *out) {
  double alpha = power_of(kernel.type), c2 = 0, scale = pow(side, -2 * alpha); /* cells are at least a side apart */
  double far = FAR_REACH + 1;
  if (kernel.type == SKF_CAUCHY) {
    double s2 = kernel.param * side * (kernel.param * side);
    c2 = 1 / s2, scale = c2 * c2;
  }
  double y0 = 1 + c2, y1 = 3 * far * far + c2;
  exponentials e;
  if (!isfinite(scale) || !isfinite(c2) || !(scale > 0) || !find(alpha, y1 / y0, 0.4 * accuracy, &e)) return false;
  memset(out, 0, sizeof *out);
  for (int k = 0; k < e.count; k++) {
    far_term *g = out->term + out->count;
    g->t = e.t[k] / y0;
    g->w = pow(y0, -alpha) * e.w[k] * exp(-g->t * c2);
    if (g->w * exp(-g->t) < 1e-4 * accuracy * pow(y1, -alpha)) continue;
    if (!expand(g, alpha, c2, accuracy, e.count)) return false;
    out->order = g->order > out->order ? g->order : out->order;
    for (int s = 0; s < FAR_SHIFTS; s++)
      for (int i = 0; i < FAR_ORDER; i++)
        for (int j = 0; j < FAR_ORDER; j++) g->last[s].m[i][j] *= scale;
    out->count++;
  }
  return true;
}

void skf_far_shift_matrix(double slope, double offset, int n, far_matrix *out) {
  memset(out, 0, sizeof *out);
  for (int k = 0; k < n; k++) {
    double x = cos(SKF_PI * (k + 0.5) / n), T[FAR_ORDER], U[FAR_ORDER];
    far_chebyshev(x, n, T);
    far_chebyshev(slope * x + offset, n, U);
    for (int j = 0; j < n; j++)
      for (int i = 0; i <= j; i++) out->m[j][i] += U[j] * T[i] * (i ? 2.0 : 1.0) / n;
  }
}
