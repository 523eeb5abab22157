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

/* out[to[j]] += sum_i m[i][j] in[from[i]] for i, j < n, one vector each */
SKF_INLINE void far_column(int n, const far_matrix *m, const double *in, const size_t *from, double *out,
                           const size_t *to) {
  int j = 0;
  for (; j + 4 <= n; j += 4) {
    skf_vd s0 = vd_load(out + to[j]), s1 = vd_load(out + to[j + 1]), s2 = vd_load(out + to[j + 2]),
           s3 = vd_load(out + to[j + 3]);
    for (int i = 0; i < n; i++) {
      skf_vd v = vd_load(in + from[i]);
      s0 = far_mad(vd_set(m->m[i][j]), v, s0), s1 = far_mad(vd_set(m->m[i][j + 1]), v, s1);
      s2 = far_mad(vd_set(m->m[i][j + 2]), v, s2), s3 = far_mad(vd_set(m->m[i][j + 3]), v, s3);
    }
    vd_store(out + to[j], s0), vd_store(out + to[j + 1], s1), vd_store(out + to[j + 2], s2);
    vd_store(out + to[j + 3], s3);
  }
  for (; j < n; j++) {
    skf_vd s = vd_load(out + to[j]);
    for (int i = 0; i < n; i++) s = far_mad(vd_set(m->m[i][j]), vd_load(in + from[i]), s);
    vd_store(out + to[j], s);
  }
}

static void far_along0(const far_layout *l, int order, const far_matrix *m, const double *in, double *out) {
  for (int b = 0; b < order; b++)
    for (int c = 0; b + c < order; c += FAR_PAD) {
      size_t at[FAR_ORDER];
      int n = order - b - c;
      for (int i = 0; i < n; i++) at[i] = l->row[i][b] + (size_t)c;
      far_column(n, m, in, at, out, at);
    }
}

static void far_along1(const far_layout *l, int order, const far_matrix *m, const double *in, double *out) {
  for (int a = 0; a < order; a++)
    for (int c = 0; a + c < order; c += FAR_PAD) {
      size_t at[FAR_ORDER];
      int n = order - a - c;
      for (int i = 0; i < n; i++) at[i] = l->row[a][i] + (size_t)c;
      far_column(n, m, in, at, out, at);
    }
}

static void far_along2(const far_layout *l, int order, const far_matrix *m, const double *in, double *out) {
  for (int a = 0; a < order; a++)
    for (int b = 0; a + b < order; b++) {
      const double *from = in + l->row[a][b];
      double *to = out + l->row[a][b];
      int n = order - a - b;
      for (int c = 0; c < n; c += 2 * FAR_PAD) {
        bool both = c + FAR_PAD < n;
        skf_vd s = vd_load(to + c), t = both ? vd_load(to + c + FAR_PAD) : s;
        if (both)
          for (int i = 0; i < n; i++) {
            skf_vd v = vd_set(from[i]);
            s = far_mad(v, vd_load(m->m[i] + c), s), t = far_mad(v, vd_load(m->m[i] + c + FAR_PAD), t);
          }
        else
          for (int i = 0; i < n; i++) s = far_mad(vd_set(from[i]), vd_load(m->m[i] + c), s);
        vd_store(to + c, s);
        if (both) vd_store(to + c + FAR_PAD, t);
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
  { {far_along0, far_along1, far_along2}, far_local }

#endif
