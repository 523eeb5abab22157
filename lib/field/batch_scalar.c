/* SPDX-License-Identifier: MIT */
/* Where there are no vector forms: the closed forms, the same sums. */
#include "field/batch_add.h"

/* Column k of the sum: infinities stay, and where F is infinite the gradient is 0. */
static void batch_total(size_t n, const skf_batch_sum *sum, int k, double *out) {
  const double *F = sum->s[0], *s = sum->s[k], *low = sum->low[k];
  for (size_t i = 0; i < n; i++) {
    double all = s[i] + low[i], kept = s[i] - s[i] == 0 ? all : s[i];
    out[i] = k == 0 || F[i] - F[i] == 0 ? kept : 0;
  }
}

const skf_batch_ops skf_batch_scalar = {.set = batch_set, .add = batch_add, .total = batch_total};

const skf_batch_ops *skf_batch_get(skf_isa isa) {
#ifdef SKF_HAVE_AVX2
  if (isa == SKF_ISA_AVX2) return &skf_batch_avx2;
#endif
  (void)isa;
  return &skf_batch_scalar;
}
