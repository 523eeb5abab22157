/* SPDX-License-Identifier: GPL-3.0-or-later */
/* PNG files of RGB pictures [ISO/IEC 15948:2004], lossless, without a library to load. */
#ifndef SKF_TOOLS_PNG_H
#define SKF_TOOLS_PNG_H

#include <stdbool.h>
#include <stddef.h>

/* rgb: width * height * 3 values of 8 bits (unsigned char) or 16 bits (unsigned short), rows from the top. The file's
   bytes are the caller's to free(); false: out of memory. */
bool png_encode(int width, int height, int bits, const void *rgb, unsigned char **bytes, size_t *n);

#endif
