/* SPDX-License-Identifier: MIT */
/* Where there are no vector forms: the closed forms, the same sums. */
#include "field/batch_add.h"

const skf_batch_ops skf_batch_scalar = {.add = batch_add};

const skf_batch_ops *skf_batch_get(skf_isa isa) {
#ifdef SKF_HAVE_AVX2
  if (isa == SKF_ISA_AVX2) return &skf_batch_avx2;
#endif
  (void)isa;
  return &skf_batch_scalar;
}
