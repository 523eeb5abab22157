/* SPDX-License-Identifier: MIT */
/* PNG files by libpng and libdeflate, which are loaded sooner than OpenCV. */
#ifndef SKF_ADAPT_PNG_FILE_H
#define SKF_ADAPT_PNG_FILE_H

#include "skelfield/core.h"
#include <stdbool.h>
#include <stddef.h>

/* Whether this build has it. */
bool skf_png_there(void);

/* rgb: width * height * 3 values of 8 bits (unsigned char) or 16 bits (unsigned short), rows from the top. The file's
   bytes are the caller's to free(). SKF_ERR_NOMEM; SKF_ERR_UNSUPPORTED: not in this build. */
skf_status skf_png_encode(int width, int height, int bits, const void *rgb, unsigned char **bytes, size_t *n);

#endif
