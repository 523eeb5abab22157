/* SPDX-License-Identifier: MIT */
#define SKF_PAIRS_PULL skf_pairs_pull_avx2
#include "motion/pairs_loop.h"
