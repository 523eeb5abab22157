/* SPDX-License-Identifier: MIT */
#include "ray/render_shade_lanes.h"

void skf_shade_avx2(const skf_stage *g, const skf_shaded s[SKF_SHADED], double (*rgb)[3]) { shade_lanes(g, s, rgb); }
