/* SPDX-License-Identifier: MIT */
/* The loops of far_harmonic.h. Included by far_loop.h. */
#ifndef SKF_FIELD_FAR_HARMONIC_LOOP_H
#define SKF_FIELD_FAR_HARMONIC_LOOP_H

#include "field/far_tensor.h"
#include "simd/vec.h"

/* Vectors of a group, whose lanes are pairs of cells */
_Static_assert((int)SKF_LANES == 4, "four cells are turned round at once");
enum { FAR_WIDTH = FAR_GROUP / SKF_LANES };

typedef struct far_lanes {
  skf_vd v[FAR_WIDTH];
} far_lanes;

/* Rows of a small matrix: d[i * row + j * column] from the n entries from[j] to the entries to[i] */
typedef struct far_small {
  const double *d;
  int rows, n, row, column;
  const unsigned short *from, *to;
} far_small;

SKF_INLINE void far_some_rows(int rows, const far_small *s, int i, const far_lanes *in, far_lanes *out) {
  skf_vd sum[4][FAR_WIDTH];
  const double *d = s->d + i * s->row;
  const int n = s->n, row = s->row, column = s->column;
#pragma GCC unroll 4
  for (int k = 0; k < rows; k++)
#pragma GCC unroll 4
    for (int w = 0; w < FAR_WIDTH; w++) sum[k][w] = vd_set(0);
  for (int j = 0; j < n; j++, d += column) {
    const far_lanes *x = in + s->from[j];
#pragma GCC unroll 4
    for (int k = 0; k < rows; k++) {
      skf_vd m = vd_set(d[k * row]);
#pragma GCC unroll 4
      for (int w = 0; w < FAR_WIDTH; w++) sum[k][w] = far_mad(m, x->v[w], sum[k][w]);
    }
  }
#pragma GCC unroll 4
  for (int k = 0; k < rows; k++)
#pragma GCC unroll 4
    for (int w = 0; w < FAR_WIDTH; w++) out[s->to[i + k]].v[w] = sum[k][w];
}

SKF_INLINE void far_multiply(const far_small *s, const far_lanes *in, far_lanes *out) {
  int i = 0;
  for (; i + 4 <= s->rows; i += 4) far_some_rows(4, s, i, in, out);
  if (s->rows - i == 3) far_some_rows(3, s, i, in, out);
  if (s->rows - i == 2) far_some_rows(2, s, i, in, out);
  if (s->rows - i == 1) far_some_rows(1, s, i, in, out);
}

/* About y, degree by degree */
static void far_turn(const far_move *m, bool back, const far_lanes *in, far_lanes *out) {
  static const unsigned short ascending[FAR_DEGREES] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
                                                        16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31,
                                                        32, 33, 34, 35, 36, 37, 38, 39, 40, 41, 42, 43, 44, 45, 46, 47,
                                                        48, 49, 50, 51, 52, 53, 54, 55, 56, 57, 58, 59, 60, 61, 62, 63};
  const double *d = m->turn;
  for (int l = 0; l < m->order; l++) {
    const far_lanes *from = in + l * l;
    far_lanes *to = out + l * l;
    far_small c = {d, l + 1, l + 1, back ? 1 : l + 1, back ? l + 1 : 1, ascending, ascending};
    far_small s = {d + (l + 1) * (l + 1), l, l, back ? 1 : l, back ? l : 1, ascending, ascending};
    far_multiply(&c, from, to);
    far_multiply(&s, from + l + 1, to + l + 1);
    d = s.d + l * l;
  }
}

/* About z, in place */
static void far_azimuth(const far_move *f, bool back, far_lanes *a) {
  double co = 1, si = 0;
  for (int m = 1; m < f->order; m++) {
    double next = co * f->cosine - si * f->sine;
    si = si * f->cosine + co * f->sine, co = next;
    skf_vd c = vd_set(co), s = vd_set(back ? -si : si);
    for (int l = m; l < f->order; l++) {
      far_lanes *x = a + far_cosine(l, m), *y = a + far_sine(l, m);
      for (int w = 0; w < FAR_WIDTH; w++) {
        skf_vd u = x->v[w], v = y->v[w];
        x->v[w] = far_mad(c, u, s * v), y->v[w] = far_mad(c, v, -(s * u));
      }
    }
  }
}

static void far_along_z(const far_move *f, bool down, const far_lanes *in, far_lanes *out) {
  const double *d = f->along;
  unsigned short at[FAR_DEGREES];
  for (int m = 0; m < f->order; m++) {
    const int n = f->order - m;
    for (int sine = 0; sine <= (m > 0); sine++) {
      for (int l = 0; l < n; l++) at[l] = (unsigned short)(sine ? far_sine(l + m, m) : far_cosine(l + m, m));
      far_multiply(&(far_small){d, n, n, down ? 1 : n, down ? n : 1, at, at}, in, out);
    }
    d += n * n;
  }
}

/* Even degrees from `even`, odd ones from `odd` */
static void far_along_both(const far_move *f, const far_lanes *even, const far_lanes *odd, far_lanes *out) {
  const double *d = f->along;
  unsigned short at[FAR_DEGREES], to[2][FAR_DEGREES];
  for (int m = 0; m < f->order; m++) {
    const int n = f->order - m;
    for (int sine = 0; sine <= (m > 0); sine++) {
      for (int l = 0; l < n; l++) {
        at[l] = (unsigned short)(sine ? far_sine(l + m, m) : far_cosine(l + m, m));
        to[l % 2][l / 2] = at[l];
      }
      far_multiply(&(far_small){d, (n + 1) / 2, n, 2 * n, 1, at, to[0]}, m % 2 ? odd : even, out);
      far_multiply(&(far_small){d + n, n / 2, n, 2 * n, 1, at, to[1]}, m % 2 ? even : odd, out);
    }
    d += n * n;
  }
}

/* Four numbers of four cells the other way round */
SKF_INLINE void far_transpose(skf_vd r[4]) {
  const skf_vi even = {0, 4, 2, 6}, odd = {1, 5, 3, 7}, low = {0, 1, 4, 5}, high = {2, 3, 6, 7};
  skf_vd a = __builtin_shuffle(r[0], r[1], even), b = __builtin_shuffle(r[0], r[1], odd);
  skf_vd c = __builtin_shuffle(r[2], r[3], even), d = __builtin_shuffle(r[2], r[3], odd);
  r[0] = __builtin_shuffle(a, c, low), r[1] = __builtin_shuffle(b, d, low);
  r[2] = __builtin_shuffle(a, c, high), r[3] = __builtin_shuffle(b, d, high);
}

static void far_fetch(size_t size, double by, int n, const double *const from[FAR_GROUP], far_lanes *a) {
  for (int w = 0; w < FAR_WIDTH; w++) {
    const double *lane[4];
    size_t k = 0;
    for (int i = 0; i < 4; i++) lane[i] = from[4 * w + i < n ? 4 * w + i : 0];
    for (; k + 4 <= size; k += 4) {
      skf_vd r[4];
      for (int i = 0; i < 4; i++) r[i] = vd_set(by) * vd_load(lane[i] + k);
      far_transpose(r);
      for (int i = 0; i < 4; i++) a[k + (size_t)i].v[w] = r[i];
    }
    for (; k < size; k++)
      for (int i = 0; i < 4; i++) a[k].v[w][i] = by * lane[i][k];
  }
}

static void far_hand_out(size_t size, int n, const far_lanes *a, double *const to[FAR_GROUP]) {
  for (int first = 0; first < n; first += 4) {
    size_t k = 0;
    int lanes = n - first < 4 ? n - first : 4, w = first / 4;
    for (; k + 4 <= size; k += 4) {
      skf_vd r[4];
      for (int i = 0; i < 4; i++) r[i] = a[k + (size_t)i].v[w];
      far_transpose(r);
      for (int i = 0; i < lanes; i++) vd_store(to[first + i] + k, vd_load(to[first + i] + k) + r[i]);
    }
    for (; k < size; k++)
      for (int i = 0; i < lanes; i++) to[first + i][k] += a[k].v[w][i];
  }
}

/* a and b become a + b and a - b, where b's odd degrees change their signs. */
static void far_mirror(int order, far_lanes *a, far_lanes *b) {
  size_t k = 0;
  for (int l = 0; l < order; l++)
    for (; k < (size_t)((l + 1) * (l + 1)); k++)
      for (int w = 0; w < FAR_WIDTH; w++) {
        skf_vd u = a[k].v[w], v = l % 2 ? -b[k].v[w] : b[k].v[w];
        a[k].v[w] = u + v, b[k].v[w] = u - v;
      }
}

/* FAR_OVER from cells on both sides of targets, as far away. Seen from there z is reversed, so odd degrees are, in and
   out: what comes out in even degrees is due to the sum of the one's moments and the other's reversed, in odd degrees
   to the difference. So both take one matrix along z and one turn back. */
static void far_transfer_both(const far_move *m, double by, int n, const double *const from[2][FAR_GROUP],
                              double *const to[FAR_GROUP], double *room) {
  size_t size = (size_t)(m->order * m->order);
  far_lanes *a = (far_lanes *)(void *)room, *b = a + size, *c = b + size;
  far_fetch(size, by, n, from[0], a);
  far_fetch(size, by, n, from[1], b);
  far_mirror(m->order, a, b);
  far_azimuth(m, false, a);
  far_azimuth(m, false, b);
  far_turn(m, false, a, c);
  far_turn(m, false, b, a);
  far_along_both(m, c, a, b);
  far_turn(m, true, b, a);
  far_azimuth(m, true, a);
  far_hand_out(size, n, a, to);
}

static void far_transfer(const far_move *m, far_kind kind, double by, int n, const double *const from[FAR_GROUP],
                         double *const to[FAR_GROUP], double *room) {
  size_t size = (size_t)(m->order * m->order);
  far_lanes *a = (far_lanes *)(void *)room, *b = a + size;
  far_fetch(size, by, n, from, a);
  far_azimuth(m, false, a);
  far_turn(m, false, a, b);
  far_along_z(m, kind == FAR_DOWN, b, a);
  far_turn(m, true, a, b);
  far_azimuth(m, true, b);
  far_hand_out(size, n, b, to);
}

/* x: three coordinates, weights */
static void far_gather(const far_harmonic *h, const double x[4][FAR_GATHER], double *out) {
  enum { WIDE = FAR_GATHER / SKF_LANES };
  skf_vd A[WIDE], B[WIDE], X[WIDE], Y[WIDE], Z[WIDE], R[WIDE];
  for (int w = 0; w < WIDE; w++) {
    X[w] = vd_load(x[0] + w * SKF_LANES), Y[w] = vd_load(x[1] + w * SKF_LANES), Z[w] = vd_load(x[2] + w * SKF_LANES);
    R[w] = X[w] * X[w] + Y[w] * Y[w] + Z[w] * Z[w], A[w] = vd_load(x[3] + w * SKF_LANES), B[w] = vd_set(0);
  }
  for (int m = 0; m < h->order; m++) {
    skf_vd now[WIDE], last[WIDE];
    for (int w = 0; w < WIDE; w++) now[w] = vd_set(1), last[w] = vd_set(0);
    for (int l = m; l < h->order; l++) {
      skf_vd c = vd_set(0), s = c;
      for (int w = 0; w < WIDE && l > m; w++) {
        size_t k = far_by_m(h->order, m, l);
        skf_vd next = vd_set(h->step[0][k]) * Z[w] * now[w] - vd_set(h->step[1][k]) * R[w] * last[w];
        last[w] = now[w], now[w] = next;
      }
      for (int w = 0; w < WIDE; w++) c = far_mad(A[w], now[w], c), s = far_mad(B[w], now[w], s);
      for (int i = 0; i < SKF_LANES; i++) out[far_cosine(l, m)] += c[i];
      for (int i = 0; i < SKF_LANES && m; i++) out[far_sine(l, m)] += s[i];
    }
    for (int w = 0; w < WIDE; w++) {
      skf_vd per = vd_set(1.0 / (2 * m + 2)), t = per * (X[w] * A[w] - Y[w] * B[w]);
      B[w] = per * (X[w] * B[w] + Y[w] * A[w]), A[w] = t;
    }
  }
}

/* Four sums and what is multiplied by sines, side by side */
typedef struct far_terms {
  double cosine[4], sine[4];
} far_terms;

/* The sum's and its derivatives' (skf_far_derive), by m, then l. There is one way through for all m, for which sines of
   m = 0 and what is beside them are picked as 0. */
static void far_terms_of(int order, const double *tensor, far_terms *all) {
  static const double none[2 * FAR_DEGREES + 2] = {0};
  for (int l = 0; l < order; l++) {
    const double *c = tensor + l * l, *s = c + l; /* of degree l, and of the one above */
    const double *C = l + 1 < order ? c + 2 * l + 1 : none, *S = C + l + 1;
    all[far_by_m(order, 0, l)] = (far_terms){{c[0], 0.5 * C[1], 0.5 * S[1], C[0]}, {0, 0, 0, 0}};
    for (int m = 1; m <= l; m++) {
      const double by = m == 1 ? 2 : 1, down = m == 1 ? 0 : S[m - 1];
      far_terms *t = all + far_by_m(order, m, l);
      t->cosine[0] = c[m], t->sine[0] = s[m];
      t->cosine[1] = 0.5 * (C[m + 1] - by * C[m - 1]), t->sine[1] = 0.5 * (S[m + 1] - down);
      t->cosine[2] = 0.5 * (S[m + 1] + down), t->sine[2] = 0.5 * (-C[m + 1] - by * C[m - 1]);
      t->cosine[3] = C[m], t->sine[3] = S[m];
    }
  }
}

static void far_evaluate(const far_harmonic *h, const double *tensor, size_t n, double per,
                         const double x[3][SKF_BATCH], double out[4][SKF_BATCH]) {
  const int order = h->order;
  far_terms all[FAR_DEGREES * (FAR_DEGREES + 1) / 2];
  far_terms_of(order, tensor, all);
  for (size_t i = 0; i < n; i += FAR_PAD) {
    skf_vd X = vd_load(x[0] + i), Y = vd_load(x[1] + i), Z = vd_load(x[2] + i), R = X * X + Y * Y + Z * Z;
    skf_vd A = vd_set(1), B = vd_set(0), sum[4] = {B, B, B, B};
    for (int m = 0; m < order; m++) {
      skf_vd now = vd_set(1), last = vd_set(0), c[4], s[4];
      const far_terms *t = all + far_by_m(order, m, m);
      const double *step[2] = {h->step[0] + far_by_m(order, m, m), h->step[1] + far_by_m(order, m, m)};
#pragma GCC unroll 4
      for (int k = 0; k < 4; k++) c[k] = vd_set(t->cosine[k]), s[k] = vd_set(t->sine[k]);
      for (int l = 1; l < order - m; l++) {
        skf_vd next = far_mad(vd_set(step[0][l]) * Z, now, -(vd_set(step[1][l]) * R * last));
        last = now, now = next;
#pragma GCC unroll 4
        for (int k = 0; k < 4; k++)
          c[k] = far_mad(vd_set(t[l].cosine[k]), now, c[k]), s[k] = far_mad(vd_set(t[l].sine[k]), now, s[k]);
      }
#pragma GCC unroll 4
      for (int k = 0; k < 4; k++) sum[k] = far_mad(A, c[k], far_mad(B, s[k], sum[k]));
      skf_vd by = vd_set(1.0 / (2 * m + 2)), turned = by * (X * A - Y * B);
      B = by * (X * B + Y * A), A = turned;
    }
    for (int k = 0; k < 4; k++) vd_store(out[k] + i, k ? vd_set(per) * sum[k] : sum[k]);
  }
}

#endif
