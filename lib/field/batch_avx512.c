/* SPDX-License-Identifier: MIT */
/* The vector forms, compiled for AVX-512. */
#include "field/batch_table.h"

const skf_batch_ops skf_batch_avx512 = {SKF_BATCH_TABLE};
