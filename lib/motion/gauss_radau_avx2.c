/* SPDX-License-Identifier: MIT */
#define SKF_RADAU_OPS skf_radau_avx2
#include "motion/gauss_radau_loop.h"
