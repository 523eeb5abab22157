/* SPDX-License-Identifier: MIT */
/* Solids, compiled for AVX2 and FMA. */
#include "field/solid_vector.h"

const skf_solid_ops skf_solid_avx2 = {solid_points, solid_point};
