/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Motion JPEG in AVI files, up to 2 GB. */
#ifndef SKF_TOOLS_AVI_H
#define SKF_TOOLS_AVI_H

#include "cli.h"
#include <stdint.h>

typedef struct avi {
  FILE *file;
  int width, height;
  double fps;
  uint32_t count, largest;
  uint32_t (*index)[2]; /* offset and size of each picture */
} avi;

/* CLI_DONE, or CLI_FAILED after the message. The file must be seekable and stays the caller's, as does the index. */
int avi_open(avi *a, FILE *file, int width, int height, double fps);
int avi_add(avi *a, const unsigned char *jpeg, size_t n);
int avi_close(avi *a);

#endif
