/* SPDX-License-Identifier: MIT */
/* The loops of far_tensor.h. Included by the translation unit of each instruction set. */
#ifndef SKF_FIELD_FAR_LOOP_H
#define SKF_FIELD_FAR_LOOP_H

#include "field/far_tensor.h"
#include "simd/vec.h"

_Static_assert((int)FAR_PAD == (int)SKF_LANES, "rows are padded to whole vectors");

/* a b + c; without the instruction fma() would be a function */
#if defined(__AVX2__) && defined(__FMA__)
SKF_INLINE skf_vd far_mad(skf_vd a, skf_vd b, skf_vd c) { return vd_fma(a, b, c); }
#else
SKF_INLINE skf_vd far_mad(skf_vd a, skf_vd b, skf_vd c) { return a * b + c; }
#endif

#include "field/far_harmonic_loop.h"

/* One column of a tensor, or two side by side: entries i < n at at[i], of the second one i < n - FAR_PAD. `mirror`: of
   the cell at the opposite shift. */
typedef struct far_column {
  const far_matrix *m;
  const double *in, *mirror;
  double *out;
  int n;
  size_t at[FAR_ORDER];
} far_column;

/* Entry i goes to `outs` outputs j, j + 2, ...: the mirror's matrix has the other sign where i + j is odd. */
SKF_INLINE void far_entry(far_mode mode, int outs, int wide, bool odd, const far_column *f, int i, int j,
                          skf_vd s[4][2]) {
  skf_vd v[2];
#pragma GCC unroll 2
  for (int w = 0; w < wide; w++) {
    v[w] = vd_load(f->in + f->at[i] + w * FAR_PAD);
    if (mode == FAR_TWO && odd) v[w] -= vd_load(f->mirror + f->at[i] + w * FAR_PAD);
    if (mode == FAR_TWO && !odd) v[w] += vd_load(f->mirror + f->at[i] + w * FAR_PAD);
  }
#pragma GCC unroll 4
  for (int k = 0; k < outs; k++) {
    skf_vd m = vd_set(f->m->m[i][j + 2 * k]);
#pragma GCC unroll 2
    for (int w = 0; w < wide; w++) s[k][w] = far_mad(m, v[w], s[k][w]);
  }
}

SKF_INLINE void far_outputs(far_mode mode, int outs, int wide, int parity, const far_column *f, int j) {
  skf_vd s[4][2];
#pragma GCC unroll 4
  for (int k = 0; k < outs; k++)
#pragma GCC unroll 2
    for (int w = 0; w < wide; w++) s[k][w] = vd_load(f->out + f->at[j + 2 * k] + w * FAR_PAD);
#pragma GCC unroll 2
  for (int first = 0; first < 2; first++) {
    int i = first, all = wide == 2 ? f->n - FAR_PAD : f->n;
    if (mode == FAR_SAME && first != parity) continue;
    for (; i < all; i += 2) far_entry(mode, outs, wide, first != parity, f, i, j, s);
    for (; i < f->n; i += 2) far_entry(mode, outs, 1, first != parity, f, i, j, s);
  }
#pragma GCC unroll 4
  for (int k = 0; k < outs; k++)
#pragma GCC unroll 2
    for (int w = 0; w < wide; w++) vd_store(f->out + f->at[j + 2 * k] + w * FAR_PAD, s[k][w]);
}

/* Outputs from j on, below `end`, of one parity; where it goes on. */
SKF_INLINE int far_some(far_mode mode, int wide, int parity, const far_column *f, int j, int end) {
  for (; j + 6 < end; j += 8) far_outputs(mode, 4, wide, parity, f, j);
  for (; j + 2 < end; j += 4) far_outputs(mode, 2, wide, parity, f, j);
  for (; j < end; j += 2) far_outputs(mode, 1, wide, parity, f, j);
  return j;
}

SKF_INLINE void far_columns(far_mode mode, int wide, const far_column *f) {
#pragma GCC unroll 2
  for (int parity = 0; parity < 2; parity++) {
    int j = parity;
    if (wide == 2) j = far_some(mode, 2, parity, f, j, f->n - FAR_PAD);
    far_some(mode, 1, parity, f, j, f->n);
  }
}

/* All columns of a tensor along the axis 0 or 1, the last one before the end by itself where they are odd in number. */
SKF_INLINE void far_through(far_mode mode, int axis, const far_layout *l, int order, far_column *f) {
  for (int b = 0; b < order; b++)
    for (int c = 0, wide; b + c < order; c += wide * FAR_PAD) {
      f->n = order - b - c;
      wide = f->n > FAR_PAD ? 2 : 1;
      for (int i = 0; i < f->n; i++) f->at[i] = (axis ? l->row[b][i] : l->row[i][b]) + (size_t)c;
      if (wide == 2)
        far_columns(mode, 2, f);
      else
        far_columns(mode, 1, f);
    }
}

#define FAR_ALONG(axis, mode)                                                                                          \
  static void far_along##axis##mode(const far_layout *l, int order, const far_matrix *m, const double *in,             \
                                    const double *mirror, double *out) {                                               \
    far_column f = {.m = m, .in = in, .mirror = mirror, .out = out};                                                   \
    far_through(mode, axis, l, order, &f);                                                                             \
  }

FAR_ALONG(0, FAR_ONE)
FAR_ALONG(0, FAR_TWO)
FAR_ALONG(0, FAR_SAME)
FAR_ALONG(1, FAR_ONE)
FAR_ALONG(1, FAR_TWO)
FAR_ALONG(1, FAR_SAME)

/* Along the axis 2, of `rows` rows with n entries, `wide` vectors of them from c on. */
SKF_INLINE void far_rows(int rows, int wide, int n, int c, const far_matrix *m, const double *const from[4],
                         double *const to[4]) {
  skf_vd s[4][2];
#pragma GCC unroll 4
  for (int k = 0; k < rows; k++)
#pragma GCC unroll 2
    for (int w = 0; w < wide; w++) s[k][w] = vd_load(to[k] + c + w * FAR_PAD);
  for (int i = 0; i < n; i++) {
    skf_vd v[2];
#pragma GCC unroll 2
    for (int w = 0; w < wide; w++) v[w] = vd_load(m->m[i] + c + w * FAR_PAD);
#pragma GCC unroll 4
    for (int k = 0; k < rows; k++) {
      skf_vd x = vd_set(from[k][i]);
#pragma GCC unroll 2
      for (int w = 0; w < wide; w++) s[k][w] = far_mad(x, v[w], s[k][w]);
    }
  }
#pragma GCC unroll 4
  for (int k = 0; k < rows; k++)
#pragma GCC unroll 2
    for (int w = 0; w < wide; w++) vd_store(to[k] + c + w * FAR_PAD, s[k][w]);
}

/* Rows [a][b] of one sum a + b have the same length. */
static void far_along2(const far_layout *l, int order, const far_matrix *m, const double *in, const double *mirror,
                       double *out) {
  (void)mirror;
  for (int sum = 0; sum < order; sum++)
    for (int a = 0, rows; a <= sum; a += rows) {
      const double *from[4] = {in, in, in, in};
      double *to[4] = {out, out, out, out};
      int n = order - sum;
      rows = a + 3 <= sum ? 4 : 1;
      for (int k = 0; k < rows; k++)
        from[k] = in + l->row[a + k][sum - a - k], to[k] = out + l->row[a + k][sum - a - k];
      for (int c = 0; c < n; c += 2 * FAR_PAD) {
        bool two = c + FAR_PAD < n;
        if (rows == 4 && two) far_rows(4, 2, n, c, m, from, to);
        if (rows == 4 && !two) far_rows(4, 1, n, c, m, from, to);
        if (rows == 1 && two) far_rows(1, 2, n, c, m, from, to);
        if (rows == 1 && !two) far_rows(1, 1, n, c, m, from, to);
      }
    }
}

/* FAR_GATHER points: what x holds of them is T_i(x_k) at [k][i], weights in the first. */
static void far_points(const far_layout *l, double x[3][FAR_GATHER][FAR_ORDER + FAR_PAD], double *tensor) {
  for (int a = 0; a < l->order; a++)
    for (int b = 0; a + b < l->order; b++) {
      double *row = tensor + l->row[a][b];
      skf_vd w[FAR_GATHER];
#pragma GCC unroll 8
      for (int k = 0; k < FAR_GATHER; k++) w[k] = vd_set(x[0][k][a] * x[1][k][b]);
      for (int c = 0; a + b + c < l->order; c += FAR_PAD) {
        skf_vd s = vd_load(row + c);
#pragma GCC unroll 8
        for (int k = 0; k < FAR_GATHER; k++) s = far_mad(w[k], vd_load(x[2][k] + c), s);
        vd_store(row + c, s);
      }
    }
}

/* T and dT/dx */
SKF_INLINE void far_polynomials(int order, skf_vd x, skf_vd *T, skf_vd *D) {
  skf_vd two = vd_set(2), twice = two * x;
  T[0] = vd_set(1), D[0] = vd_set(0), T[1] = x, D[1] = vd_set(1);
  for (int i = 2; i < order; i++) {
    T[i] = twice * T[i - 1] - T[i - 2];
    D[i] = two * T[i - 1] + twice * D[i - 1] - D[i - 2];
  }
}

static void far_local(const far_layout *l, const double *tensor, size_t n, double per, const double x[3][SKF_BATCH],
                      double out[4][SKF_BATCH]) {
  skf_vd T[3][FAR_ORDER], D[3][FAR_ORDER], scale = vd_set(per);
  for (size_t i = 0; i < n; i += FAR_PAD) {
    for (int k = 0; k < 3; k++) far_polynomials(l->order, vd_load(x[k] + i), T[k], D[k]);
    skf_vd F = vd_set(0), X = F, Y = F, Z = F;
    for (int a = 0; a < l->order; a++) {
      skf_vd Fa = vd_set(0), Ya = Fa, Za = Fa;
      for (int b = 0; a + b < l->order; b++) {
        const double *row = tensor + l->row[a][b];
        skf_vd s = vd_set(0), d = s, s1 = s, d1 = s;
        int c = 0, m = l->order - a - b;
        for (; c + 2 <= m; c += 2) {
          skf_vd v = vd_set(row[c]), w = vd_set(row[c + 1]);
          s = far_mad(v, T[2][c], s), d = far_mad(v, D[2][c], d);
          s1 = far_mad(w, T[2][c + 1], s1), d1 = far_mad(w, D[2][c + 1], d1);
        }
        if (c < m) s = far_mad(vd_set(row[c]), T[2][c], s), d = far_mad(vd_set(row[c]), D[2][c], d);
        s += s1, d += d1;
        Fa = far_mad(s, T[1][b], Fa), Ya = far_mad(s, D[1][b], Ya), Za = far_mad(d, T[1][b], Za);
      }
      F = far_mad(Fa, T[0][a], F), X = far_mad(Fa, D[0][a], X);
      Y = far_mad(Ya, T[0][a], Y), Z = far_mad(Za, T[0][a], Z);
    }
    vd_store(out[0] + i, F);
    vd_store(out[1] + i, scale * X), vd_store(out[2] + i, scale * Y), vd_store(out[3] + i, scale * Z);
  }
}

#define FAR_OPS                                                                                                        \
  {                                                                                                                    \
    {{far_along0FAR_ONE, far_along0FAR_TWO, far_along0FAR_SAME},                                                       \
     {far_along1FAR_ONE, far_along1FAR_TWO, far_along1FAR_SAME},                                                       \
     {far_along2, NULL, NULL}},                                                                                        \
        far_points, far_local, far_transfer, far_transfer_both, far_gather, far_evaluate                               \
  }

#endif
