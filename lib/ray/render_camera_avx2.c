/* SPDX-License-Identifier: MIT */
#include "ray/render_camera_lanes.h"

void skf_view_row_avx2(const skf_view *v, skf_vec3 row, int width, double px, int n, skf_beam *out) {
  view_row(v, row, width, px, n, out);
}
