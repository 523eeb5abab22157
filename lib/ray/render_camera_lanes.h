/* SPDX-License-Identifier: MIT */
/* Rays of the camera side by side, each with the bits that it has alone. */
#ifndef SKF_RAY_RENDER_CAMERA_LANES_H
#define SKF_RAY_RENDER_CAMERA_LANES_H

#include "ray/render.h"
#include "simd/vec.h"

SKF_INLINE void view_row(const skf_view *v, skf_vec3 row, int width, double px, int n, skf_beam *out) {
  for (int i = 0; i < n; i += SKF_LANES) {
    double at[3][SKF_LANES], x[SKF_LANES];
    for (int k = 0; k < SKF_LANES; k++) x[k] = px + (i + k);
    skf_vd s = (vd_set(2) * vd_load(x) / vd_set(width) - vd_set(1)) * vd_set(v->tan_x), way[3], per = vd_set(1);
    for (int c = 0; c < 3; c++) way[c] = vd_set(v3_get(row, c)) + s * vd_set(v3_get(v->right, c));
    if (!v->parallel) per = vd_set(1) / vd_sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
    for (int c = 0; c < 3; c++) vd_store(at[c], per * way[c]);
    for (int k = 0; k < SKF_LANES && i + k < n; k++) {
      skf_vec3 p = v3(at[0][k], at[1][k], at[2][k]);
      out[i + k].from = v->parallel ? p : v->from, out[i + k].direction = v->parallel ? v->forward : p;
    }
  }
}

#endif
