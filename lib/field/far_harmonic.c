/* SPDX-License-Identifier: MIT */
/* The tables of far_harmonic.h. */
#include "field/far_harmonic.h"
#include "core/alloc.h"
#include <stdlib.h>
#include <string.h>

/* sqrt(n!) */
static void roots_of_factorials(double f[2 * FAR_DEGREES]) {
  double whole = 1;
  for (int n = 0; n < 2 * FAR_DEGREES; n++) f[n] = sqrt(whole *= n ? n : 1);
}

/* Matrices of turned harmonics from degree to degree [Ivanic & Ruedenberg 1996, 1998]: for each degree (2 l + 1)^2
   entries [m][n], -l <= m, n <= l, sines at negative m. */
typedef struct turning {
  int l;
  double Q[3][3]; /* of degree 1: y, z, x */
  double *last, *now;
} turning;

static double entry(const double *d, int l, int m, int n) { return d[(m + l) * (2 * l + 1) + n + l]; }

static double part(const turning *t, int i, int m, int n) {
  const int l = t->l, k = l - 1;
  const double *q = t->Q[i + 1];
  if (n == l) return q[2] * entry(t->last, k, m, k) - q[0] * entry(t->last, k, m, -k);
  if (n == -l) return q[2] * entry(t->last, k, m, -k) + q[0] * entry(t->last, k, m, k);
  return q[1] * entry(t->last, k, m, n);
}

static double turned(const turning *t, int m, int n) {
  const int l = t->l, a = m < 0 ? -m : m;
  double under = abs(n) < l ? (double)(l + n) * (l - n) : 2.0 * l * (2 * l - 1), root2 = sqrt(2), s = 0;
  double u = sqrt((double)(l + m) * (l - m) / under), w = sqrt((double)(l - a - 1) * (l - a) / under) / 2;
  double v = sqrt((double)(l + a - 1) * (l + a) / under) / 2;
  if (a < l) s += u * part(t, 0, m, n);
  if (m == 0) return s - v * root2 * (part(t, 1, 1, n) + part(t, -1, -1, n));
  if (m > 0)
    s += v * (a == 1 ? root2 * part(t, 1, 0, n) : part(t, 1, m - 1, n) - part(t, -1, 1 - m, n));
  else
    s += v * (a == 1 ? root2 * part(t, -1, 0, n) : part(t, 1, m + 1, n) + part(t, -1, -m - 1, n));
  if (a > l - 2) return s;
  return s - w * (m > 0 ? part(t, 1, m + 1, n) + part(t, -1, -m - 1, n) : part(t, 1, m - 1, n) - part(t, -1, 1 - m, n));
}

/* For axes turned about y so that (sine, 0, cosine) becomes z. */
static double *turn_new(int order, double cosine, double sine) {
  size_t full = (size_t)(4 * order * order), size = 0;
  for (int l = 0; l < order; l++) size += (size_t)((l + 1) * (l + 1) + l * l);
  double *room = skf_alloc(2 * full, sizeof *room), *out = skf_alloc(size, sizeof *out), *next = out;
  turning t = {.Q = {{1, 0, 0}, {0, cosine, sine}, {0, -sine, cosine}}, .last = room, .now = room + full};
  for (; room && out && t.l < order; t.l++) {
    const int l = t.l;
    for (int m = -l; m <= l; m++)
      for (int n = -l; n <= l; n++)
        t.now[(m + l) * (2 * l + 1) + n + l] = l == 0 ? 1 : l == 1 ? t.Q[m + 1][n + 1] : turned(&t, m, n);
    for (int m = 0; m <= l; m++)
      for (int n = 0; n <= l; n++) *next++ = entry(t.now, l, m, n);
    for (int m = 1; m <= l; m++)
      for (int n = 1; n <= l; n++) *next++ = entry(t.now, l, -m, -n);
    double *swap = t.last;
    t.last = t.now, t.now = swap;
  }
  if (!room) skf_free(out), out = NULL;
  return skf_free(room), out;
}

/* 1 + 4 + ... + n^2 */
static size_t of_squares(int n) { return (size_t)(n * (n + 1) * (2 * n + 1) / 6); }

/* Moments at a distance d along z, to polynomials. */
static double *over_new(int order, double d) {
  double f[2 * FAR_DEGREES], *out = skf_alloc(of_squares(order), sizeof *out), *next = out;
  roots_of_factorials(f);
  for (int m = 0; out && m < order; m++)
    for (int k = m; k < order; k++)
      for (int l = m; l < order; l++)
        *next++ = ((k + m) % 2 ? -1 : 1) * (f[l + k] / f[l - m] / f[k + m]) * (f[l + k] / f[l + m] / f[k - m]) *
                  pow(d, -(l + k + 1));
  return out;
}

/* Moments of a cell half as large at t along z; transposed, polynomials to there. */
static double *up_new(int order, double t) {
  double f[2 * FAR_DEGREES], *out = skf_alloc(of_squares(order), sizeof *out), *next = out;
  roots_of_factorials(f);
  for (int m = 0; out && m < order; m++)
    for (int l = m; l < order; l++)
      for (int k = m; k < order; k++, next++)
        if (k <= l)
          *next = f[l + m] / f[k + m] / f[l - k] * (f[l - m] / f[k - m] / f[l - k]) * pow(t, l - k) * ldexp(1, -k);
  return out;
}

/* How many degrees an interaction takes of cells whose middles are sqrt(d2) apart, so that the gradient of each pair of
   points comes out to two and to twelve digits of 1/r^2, and F to more; between is a straight line. Measured between
   faces, edges and corners, where errors, harmonic in both points, are largest. tests/field/test_far.c measures the
   outcome. */
static int order_of(int d2, double accuracy) {
  static const struct {
    int d2, two, twelve;
  } table[] = {{5, 12, 55}, {6, 12, 48}, {8, 9, 35},  {9, 9, 34},  {10, 7, 29}, {11, 7, 29}, {12, 8, 30},
               {14, 6, 26}, {16, 6, 23}, {17, 6, 24}, {19, 6, 23}, {22, 6, 22}, {27, 6, 21}};
  size_t i = 0;
  while (table[i].d2 < d2) i++;
  double share = (-log10(accuracy) - 2) / 10, n = table[i].two + share * (table[i].twelve - table[i].two);
  return (int)ceil(n - 1e-9);
}

/* Whether children of cells that are near, neighbours or two apart, are at a shift and are not near themselves. */
static bool occurs(const int at[3]) {
  int most = 0, far = 0;
  for (int k = 0; k < 3; k++) most = abs(at[k]) > most ? abs(at[k]) : most, far += abs(at[k]) > 1;
  return !far_is_near(at) && (most <= FAR_REACH || far == 1);
}

static bool make_over(far_harmonic *h, const int at[3], double accuracy) {
  int x = at[0], y = at[1], z = at[2], across = x * x + y * y, all = across + z * z, order = order_of(all, accuracy);
  double **turn = &h->turns[z + FAR_LONG][across], **along = &h->alongs[all], r = sqrt(across);
  if (!*turn && !(*turn = turn_new(order, z / sqrt(all), r / sqrt(all)))) return false;
  if (!*along && !(*along = over_new(order, sqrt(all)))) return false;
  h->over[x + FAR_LONG][y + FAR_LONG][z + FAR_LONG] =
      (far_move){order, *turn, *along, across ? x / r : 1, across ? y / r : 0};
  return true;
}

static bool make(far_harmonic *h, double accuracy) {
  const int n = h->order;
  for (int m = 0; m < n; m++)
    for (int l = m; l < n; l++) {
      double f = 1, under = l > m ? 1.0 / ((double)(l - m) * (l + m)) : 0;
      for (int k = l - m + 1; k <= l + m; k++) f *= k; /* (l + m)! / (l - m)! */
      double low = 1;
      for (int k = 2; k <= l - m; k++) low *= k;
      h->step[0][far_by_m(n, m, l)] = (2 * l - 1) * under, h->step[1][far_by_m(n, m, l)] = under;
      h->norm[far_cosine(l, m)] = low * sqrt(f) * (m ? sqrt(2) : 1);
      if (m) h->norm[far_sine(l, m)] = h->norm[far_cosine(l, m)];
    }
  for (int i = 0; i < FAR_WAYS * FAR_WAYS * FAR_WAYS; i++) {
    const int at[3] = {i % FAR_WAYS - FAR_LONG, i / FAR_WAYS % FAR_WAYS - FAR_LONG, i / FAR_WAYS / FAR_WAYS - FAR_LONG};
    if (occurs(at) && !make_over(h, at, accuracy)) return false;
  }
  h->child_along = up_new(n, sqrt(3) / 4);
  for (int i = 0; i < 2; i++) h->child_turn[i] = turn_new(n, (i ? 1 : -1) / sqrt(3), sqrt(2. / 3));
  if (!h->child_along || !h->child_turn[0] || !h->child_turn[1]) return false;
  for (int i = 0; i < 8; i++)
    h->child[i] = (far_move){n, h->child_turn[i >> 2], h->child_along, (i & 1 ? 1 : -1) * sqrt(0.5),
                             (i & 2 ? 1 : -1) * sqrt(0.5)};
  return true;
}

far_harmonic *skf_far_harmonic_new(double accuracy) {
  far_harmonic *h = skf_alloc(1, sizeof *h);
  if (!h) return NULL;
  h->order = order_of(5, accuracy);
  h->size = (size_t)(h->order * h->order + 3) / 4 * 4;
  for (int i = 0; i < 2; i++) h->step[i] = skf_alloc(h->size, sizeof(double));
  h->norm = skf_alloc(h->size, sizeof(double));
  if (h->step[0] && h->step[1] && h->norm && make(h, accuracy)) return h;
  return skf_far_harmonic_free(h), NULL;
}

static void drop(double **table) { skf_free(*table), *table = NULL; }

void skf_far_harmonic_free_ways(far_harmonic *h) {
  for (int i = 0; i < FAR_WAYS; i++)
    for (int k = 0; k < FAR_SQUARES; k++) drop(&h->turns[i][k]);
  for (int k = 0; k < FAR_SQUARES; k++) drop(&h->alongs[k]);
  drop(&h->child_turn[0]), drop(&h->child_turn[1]), drop(&h->child_along);
}

void skf_far_harmonic_free(far_harmonic *h) {
  if (!h) return;
  skf_far_harmonic_free_ways(h);
  skf_free(h->step[0]), skf_free(h->step[1]), skf_free(h->norm), skf_free(h);
}

void skf_far_regular(int order, const double x[3], double *R) {
  double r2 = x[0] * x[0] + x[1] * x[1] + x[2] * x[2], A = 1, B = 0;
  for (int m = 0; m < order; m++) {
    double last = 0, now = 1;
    for (int l = m; l < order; l++) {
      R[far_cosine(l, m)] = now * A;
      if (m) R[far_sine(l, m)] = now * B;
      double next = ((2 * l + 1) * x[2] * now - r2 * last) / ((double)(l + 1 - m) * (l + 1 + m));
      last = now, now = next;
    }
    double turned = (x[0] * A - x[1] * B) / (2 * m + 2);
    B = (x[0] * B + x[1] * A) / (2 * m + 2), A = turned;
  }
}

static double take(const double *in, int order, int l, int m, bool sine) {
  if (l < 0 || l >= order || m < 0 || m > l || (sine && m == 0)) return 0;
  return in[sine ? far_sine(l, m) : far_cosine(l, m)];
}

void skf_far_derive(int order, bool outside, int axis, const double *in, double *out) {
  int n = outside ? order + 1 : order - 1;
  for (int l = 0; l < n; l++)
    for (int m = 0; m <= l; m++)
      for (int sine = 0; sine <= (m > 0); sine++) {
        int from = outside ? l - 1 : l + 1;
        bool other = axis == 1 ? !sine : sine;
        double up = take(in, order, from, m + 1, other), down = (m == 1 ? 2 : 1) * take(in, order, from, m - 1, other);
        double v = axis == 0 ? up - down : sine ? -up - down : up + down;
        if (axis == 2) v = (outside ? -2 : 2) * take(in, order, from, m, sine);
        out[sine ? far_sine(l, m) : far_cosine(l, m)] = 0.5 * v;
      }
}
