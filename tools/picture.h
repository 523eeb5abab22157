/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the commands that write pictures share. */
#ifndef SKF_TOOLS_PICTURE_H
#define SKF_TOOLS_PICTURE_H

#include "adapt/plot.h"
#include "cli.h"

/* "1600x1200": each from 16 to 16384. Leaves the values when the option is absent. */
int picture_size(const cli *c, int *width, int *height);
/* `count` numbers separated by commas; leaves them when the option is absent. */
int picture_numbers(const cli *c, const char *option, int count, double *out);
/* The format of -o, png for stdout; *out is NULL after the message. */
int picture_format(const cli *c, const skf_picture_format **out);
int picture_format_of(const char *path, const skf_picture_format **out);
/* Loads the drawing module; CLI_FAILED after the message. */
int picture_module(const skf_plot **out);
/* Writes the bytes of an encoded picture to -o. */
int picture_write(const cli *c, const unsigned char *bytes, size_t n);
/* Colours that tell particles apart on any colour map, sRGB. */
void picture_color(size_t i, double rgba[4]);

#endif
