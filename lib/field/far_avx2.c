/* SPDX-License-Identifier: MIT */
#include "field/far_loop.h"

const far_ops skf_far_avx2 = FAR_OPS;
