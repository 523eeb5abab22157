/* SPDX-License-Identifier: MIT */
/* Which vector instructions to use, decided at run time. */
#ifndef SKF_SIMD_ISA_H
#define SKF_SIMD_ISA_H

typedef enum skf_isa { SKF_ISA_SCALAR, SKF_ISA_AVX2 } skf_isa;

/* The best one that this build and this processor have; the environment variable SKELFIELD_ISA ("scalar", "avx2") may
   ask for a lesser one. */
skf_isa skf_isa_pick(void);

#endif
