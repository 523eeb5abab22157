/* SPDX-License-Identifier: MIT */
/* Matrices along the three axes of what has N^3 entries, compiled for each instruction set. */
#ifndef SKF_RAY_MODEL_TENSOR_H
#define SKF_RAY_MODEL_TENSOR_H

#include "ray/model.h"
#include "simd/vec.h"

/* out[k] = sum of a[k][q] in[q], of rows of n numbers that follow each other at `stride`. */
SKF_INLINE void combine(const double a[SKF_NODES][SKF_NODES], const double *in, int stride, int n, double *out) {
  for (int i = 0; i < n; i += SKF_LANES) {
    skf_vd row[SKF_NODES];
    for (int q = 0; q < SKF_NODES; q++) row[q] = vd_load(in + q * stride + i);
    for (int k = 0; k < SKF_NODES; k++) {
      skf_vd sum = vd_set(a[k][0]) * row[0];
      for (int q = 1; q < SKF_NODES; q++) sum = vd_fma(vd_set(a[k][q]), row[q], sum);
      vd_store(out + k * stride + i, sum);
    }
  }
}

SKF_INLINE void apply_all(const double a[3][SKF_NODES][SKF_NODES], double *c) {
  enum { N = SKF_NODES, PARTS = N / SKF_LANES };
  double b[SKF_ALL_NODES], turned[N][N];
  for (int k = 0; k < N; k++)
    for (int q = 0; q < N; q++) turned[q][k] = a[2][k][q];
  combine(a[0], c, N * N, N * N, b);
  for (int x = 0; x < N; x++) combine(a[1], b + x * N * N, N, N, c + x * N * N);
  for (int i = 0; i < N * N; i++) {
    double *row = c + i * N;
    skf_vd sum[PARTS];
    for (int m = 0; m < PARTS; m++) sum[m] = vd_load(turned[0] + m * SKF_LANES) * vd_set(row[0]);
    for (int q = 1; q < N; q++)
      for (int m = 0; m < PARTS; m++) sum[m] = vd_fma(vd_load(turned[q] + m * SKF_LANES), vd_set(row[q]), sum[m]);
    for (int m = 0; m < PARTS; m++) vd_store(row + m * SKF_LANES, sum[m]);
  }
}

#endif
