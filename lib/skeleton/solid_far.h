/* SPDX-License-Identifier: MIT */
/* Sums of regular solid harmonics over nodes, compiled for each instruction set to the same bits. */
#ifndef SKF_SKELETON_SOLID_FAR_H
#define SKF_SKELETON_SOLID_FAR_H

#include "simd/vec.h"

enum { SKF_HARMONIC_LANES = 8 };

/* Nodes with their weights, some at once. */
typedef struct skf_nodes_at {
  int count;
  double x[SKF_HARMONIC_LANES], y[SKF_HARMONIC_LANES], z[SKF_HARMONIC_LANES], w[SKF_HARMONIC_LANES];
} skf_nodes_at;

typedef struct skf_harmonics {
  int degree;
  double (*at)[2][SKF_HARMONIC_LANES]; /* row by row: real and imaginary parts */
  double (*step)[2];                   /* (2 n + 1) and 1, over (n + 1 - m)(n + 1 + m) */
  skf_nodes_at waiting;
} skf_harmonics;

/* Adds the nodes that wait: R_nm = Q_n R_mm with Q_m = 1, Q_n+1 = step0 z Q_n - step1 r^2 Q_n-1. */
void skf_harmonics_take(skf_harmonics *s);
void skf_harmonics_take_avx2(skf_harmonics *s);

SKF_INLINE void harmonics_half(skf_harmonics *s, size_t from) {
  const skf_nodes_at *q = &s->waiting;
  skf_vd x = vd_load(q->x + from), y = vd_load(q->y + from), z = vd_load(q->z + from), re = vd_load(q->w + from);
  skf_vd r2 = x * x + y * y + z * z, im = vd_set(0);
  size_t row = 0;
  for (int m = 0; m <= s->degree; m++) {
    skf_vd last = vd_set(0), now = vd_set(1), half = vd_set(0.5 / (m + 1));
    for (int n = m; n <= s->degree; n++, row++) {
      double *A = s->at[row][0] + from, *B = s->at[row][1] + from;
      skf_vd next = vd_set(s->step[row][0]) * z * now - vd_set(s->step[row][1]) * r2 * last;
      vd_store(A, vd_load(A) + re * now), vd_store(B, vd_load(B) + im * now);
      last = now, now = next;
    }
    skf_vd u = (x * re - y * im) * half;
    im = (x * im + y * re) * half, re = u;
  }
}

static inline void harmonics_take(skf_harmonics *s) {
  skf_nodes_at *q = &s->waiting;
  for (int i = q->count; i < SKF_HARMONIC_LANES; i++) q->x[i] = q->y[i] = q->z[i] = q->w[i] = 0;
  for (size_t from = 0; from < SKF_HARMONIC_LANES; from += SKF_LANES) harmonics_half(s, from);
  q->count = 0;
}

#endif
