/* SPDX-License-Identifier: MIT */
#include "simd/isa.h"
#include <stdlib.h>
#include <string.h>

static skf_isa best(void) {
#ifdef SKF_HAVE_AVX512
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
    return SKF_ISA_AVX512;
#endif
#ifdef SKF_HAVE_AVX2
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return SKF_ISA_AVX2;
#endif
  return SKF_ISA_SCALAR;
}

skf_isa skf_isa_pick(void) {
  static const char *const names[] = {"scalar", "avx2", "avx512"};
  const char *asked = getenv("SKELFIELD_ISA");
  skf_isa isa = best();
  for (int i = 0; asked && i < (int)isa; i++)
    if (!strcmp(asked, names[i])) return (skf_isa)i;
  return isa;
}
