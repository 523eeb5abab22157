/* SPDX-License-Identifier: MIT */
#include "ray/render_srgb.h"

void skf_srgb_avx2(const float *line, const float *rgb, size_t n, size_t x, size_t y, unsigned char *out,
                   unsigned char *unsure) {
  srgb_piece(line, rgb, n, x, y, out, unsure);
}
