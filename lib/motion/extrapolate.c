/* SPDX-License-Identifier: MIT */
/* Extrapolation of the modified midpoint rule in h^2, order 16 [Hairer, Norsett & Wanner 1993, II.9]. */
#include "motion/swarm.h"
#include <float.h>
#include <string.h>

enum { COLUMNS = 8 };

size_t skf_swarm_work(size_t n) { return n * SKF_MOVER_STATE * (COLUMNS + 5); }

/* 2 (k + 1) steps of the midpoint rule over h, smoothed at the end. */
static bool midpoint(const skf_swarm *s, double h, int steps, const double *slope, double *a, double *b, double *dy,
                     double *out) {
  size_t n = s->n * SKF_MOVER_STATE;
  double d = h / steps;
  memcpy(a, s->y, n * sizeof *a);
  for (size_t i = 0; i < n; i++) b[i] = a[i] + d * slope[i];
  for (int k = 1; k < steps; k++) {
    if (!skf_swarm_slope(s, b, dy)) return false;
    for (size_t i = 0; i < n; i++) {
      double next = a[i] + 2 * d * dy[i];
      a[i] = b[i], b[i] = next;
    }
  }
  if (!skf_swarm_slope(s, b, dy)) return false;
  for (size_t i = 0; i < n; i++) out[i] = 0.5 * (a[i] + b[i] + d * dy[i]);
  return true;
}

/* What differs by more than rounding, which the extrapolation makes some ten times as large. */
static double beyond(double a, double b) { return fmax(0, fabs(a - b) - 64 * DBL_EPSILON * (fabs(a) + fabs(b))); }

/* The largest difference of two states, in units of what a body does in the step and of its size. */
static double apart(const skf_swarm *s, double h, const double *a, const double *b) {
  double worst = 0;
  for (size_t i = 0; i < s->n; i++) {
    const double *p = a + i * SKF_MOVER_STATE, *q = b + i * SKF_MOVER_STATE, *y = s->y + i * SKF_MOVER_STATE;
    const skf_mover *m = s->bodies + i;
    if (!m->free) continue;
    double speed = sqrt(p[3] * p[3] + p[4] * p[4] + p[5] * p[5]) + sqrt(y[3] * y[3] + y[4] * y[4] + y[5] * y[5]);
    double size = m->hull->radius, L = 0, x = 0, v = 0, r = 0, l = 0;
    for (int k = 0; k < 3; k++) {
      L += fabs(p[10 + k]) + fabs(y[10 + k]);
      x = fmax(x, beyond(p[k], q[k])), v = fmax(v, beyond(p[3 + k], q[3 + k]));
      l = fmax(l, beyond(p[10 + k], q[10 + k]));
    }
    for (int k = 6; k < 10; k++) r = fmax(r, beyond(p[k], q[k]));
    L += m->is.mass * size * speed;
    worst = fmax(worst, x / (size + h * speed));
    worst = fmax(worst, r);
    if (speed > 0) worst = fmax(worst, v * h / (size + h * speed));
    if (L > 0) worst = fmax(worst, l / (L + m->is.mass * size * size / h));
  }
  return worst;
}

static bool attempt(skf_swarm *s, double h, double *to, double *error) {
  size_t n = s->n * SKF_MOVER_STATE;
  double *slope = s->work, *a = slope + n, *b = a + n, *dy = b + n, *last = dy + n, *T = last + n;
  if (!skf_swarm_slope(s, s->y, slope)) return false;
  for (int k = 0; k < COLUMNS; k++) {
    double *row = T + (size_t)k * n;
    if (!midpoint(s, h, 2 * (k + 1), slope, a, b, dy, row)) return false;
    memcpy(last, T, n * sizeof *last);
    for (int j = k; j-- > 0;) { /* T[j] is the table's last diagonal from below */
      double ratio = (k + 1.0) / (j + 1.0), c = 1 / (ratio * ratio - 1);
      for (size_t i = 0; i < n; i++)
        T[(size_t)j * n + i] = T[(size_t)(j + 1) * n + i] + (T[(size_t)(j + 1) * n + i] - T[(size_t)j * n + i]) * c;
    }
  }
  memcpy(to, T, n * sizeof *to);
  for (size_t i = 0; i < n; i++)
    if (!isfinite(to[i])) return false;
  *error = apart(s, h, to, last);
  return isfinite(*error);
}

skf_status skf_swarm_extrapolate(skf_swarm *s, double most, double *to, double *taken) {
  for (double h = fmin(s->h, most);;) {
    double error = INFINITY;
    if (!(h > 16 * DBL_EPSILON * fabs(s->t)) || !(h > 0)) return SKF_ERR_CONVERGENCE;
    if (!attempt(s, h, to, &error)) {
      h *= 0.25;
      continue;
    }
    double q = 0.9 * pow(s->options.tolerance / error, 1.0 / (2 * COLUMNS - 1));
    if (error <= s->options.tolerance) {
      *taken = h;
      if (h >= s->h || q * h > s->h) s->h = h * fmin(3, q);
      break;
    }
    s->h = h = h * fmax(0.1, fmin(0.9, q));
  }
  for (size_t i = 0; i < s->n; i++) quat_normalize(to + i * SKF_MOVER_STATE + 6);
  return SKF_OK;
}
