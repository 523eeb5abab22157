/* SPDX-License-Identifier: MIT */
#include "simd/isa.h"
#include <stdlib.h>
#include <string.h>

skf_isa skf_isa_pick(void) {
#ifdef SKF_HAVE_AVX2
  const char *asked = getenv("SKELFIELD_ISA");
  if (asked && !strcmp(asked, "scalar")) return SKF_ISA_SCALAR;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return SKF_ISA_AVX2;
#endif
  return SKF_ISA_SCALAR;
}
