/* SPDX-License-Identifier: MIT */
#define SKF_PAIRS_PULL skf_pairs_pull_base
#include "motion/pairs_loop.h"

skf_pairs_pull *skf_pairs_pick(skf_isa isa) {
#ifdef SKF_HAVE_AVX2
  if (isa >= SKF_ISA_AVX2) return skf_pairs_pull_avx2;
#endif
  return (void)isa, skf_pairs_pull_base;
}
