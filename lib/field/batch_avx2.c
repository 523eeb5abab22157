/* SPDX-License-Identifier: MIT */
/* The vector forms, compiled for AVX2 and FMA. */
#include "field/batch_table.h"

const skf_batch_ops skf_batch_avx2 = {SKF_BATCH_TABLE};
