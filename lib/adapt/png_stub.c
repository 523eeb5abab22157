/* SPDX-License-Identifier: MIT */
/* Stands in where the build has no libpng or no libdeflate. */
#include "adapt/png_file.h"

bool skf_png_there(void) { return false; }

skf_status skf_png_encode(int width, int height, int bits, const void *rgb, unsigned char **bytes, size_t *n) {
  (void)width, (void)height, (void)bits, (void)rgb;
  *bytes = NULL, *n = 0;
  return SKF_ERR_UNSUPPORTED;
}
