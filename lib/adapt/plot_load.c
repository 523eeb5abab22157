/* SPDX-License-Identifier: MIT */
/* Opens the drawing module, and lists the formats of picture files. */
#include "adapt/plot.h"
#include "adapt/module.h"
#include <stdio.h>
#include <string.h>
#include <strings.h>

static const skf_picture_format formats[] = {
    {"png", "lossless, 8 or 16 bits", false, true},
    {"jpg", "lossy, quality 95", false},
    {"jpeg", "the same as jpg", false},
    {"tif", "lossless, 8 or 16 bits", false, true},
    {"tiff", "the same as tif", false, true},
    {"webp", "lossless, 8 bits", false},
    {"bmp", "uncompressed, 8 bits", false},
    {"ppm", "uncompressed, 8 bits", false},
    {"exr", "linear light, 32-bit floats", true},
    {"pfm", "linear light, 32-bit floats, uncompressed", true},
    {"hdr", "linear light, shared exponent", true},
};

enum { FORMAT_COUNT = sizeof formats / sizeof *formats };

const skf_picture_format *skf_picture_format_get(int i) { return i >= 0 && i < FORMAT_COUNT ? formats + i : NULL; }

const skf_picture_format *skf_picture_format_find(const char *path) {
  const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
  for (int i = 0; dot && i < FORMAT_COUNT; i++)
    if (!strcasecmp(dot + 1, formats[i].ending)) return formats + i;
  return NULL;
}

#ifdef SKF_HAVE_OPENCV

const skf_plot *skf_plot_load(char error[256]) {
  const skf_plot *plot = skf_module_symbol(SKF_PLOT_MODULE, SKF_PLOT_SYMBOL, error);
  if (!plot || plot->abi == SKF_PLOT_ABI) return plot;
  return snprintf(error, 256, "%s belongs to another version of this program", SKF_PLOT_MODULE), NULL;
}

#else

const skf_plot *skf_plot_load(char error[256]) {
  return snprintf(error, 256, "this build has no OpenCV and writes no pictures"), NULL;
}

#endif
