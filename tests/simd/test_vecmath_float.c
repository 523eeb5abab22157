/* SPDX-License-Identifier: MIT */
/* The same for floats. */
#define SKF_VEC_FLOAT
#include "test_vecmath.c"
