/* SPDX-License-Identifier: MIT */
/* Sums of solid harmonics, compiled for AVX2. */
#include "skeleton/solid_far.h"

void skf_harmonics_take_avx2(skf_harmonics *s) { harmonics_take(s); }
