/* SPDX-License-Identifier: MIT */
/* The vector forms for floats, compiled for AVX-512. */
#define SKF_VEC_FLOAT
#include "field/batch_f32_table.h"

const skf_f32_ops skf_f32_avx512 = {SKF_F32_TABLE};
