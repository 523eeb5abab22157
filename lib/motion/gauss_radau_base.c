/* SPDX-License-Identifier: MIT */
#define SKF_RADAU_OPS skf_radau_base
#include "motion/gauss_radau_loop.h"

const skf_radau_ops *skf_radau_get(skf_isa isa) {
#ifdef SKF_HAVE_AVX2
  if (isa >= SKF_ISA_AVX2) return &skf_radau_avx2;
#endif
  return (void)isa, &skf_radau_base;
}
