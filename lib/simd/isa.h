/* SPDX-License-Identifier: MIT */
/* Which vector instructions to use, decided at run time. */
#ifndef SKF_SIMD_ISA_H
#define SKF_SIMD_ISA_H

/* From the plainest to the widest. SKF_ISA_AVX2 needs FMA too, SKF_ISA_AVX512 F, DQ and VL. */
typedef enum skf_isa { SKF_ISA_SCALAR, SKF_ISA_AVX2, SKF_ISA_AVX512 } skf_isa;

/* The best one that this build and this processor have; the environment variable SKELFIELD_ISA ("scalar", "avx2",
   "avx512") may ask for a lesser one. */
skf_isa skf_isa_pick(void);

#endif
