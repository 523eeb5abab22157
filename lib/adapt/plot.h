/* SPDX-License-Identifier: MIT */
/* Drawing and picture files, by a module that is loaded only when a picture is written (OpenCV's codecs load 140
   libraries). Coordinates are pixels from the upper left corner of the picture, y down, pixel centres at one half;
   colours are sRGB with opacity, each in [0, 1]. */
#ifndef SKF_ADAPT_PLOT_H
#define SKF_ADAPT_PLOT_H

#include "skelfield/core.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A file format, found by the ending of the file's name. */
typedef struct skf_picture_format {
  const char *ending, *doc;
  bool linear; /* holds linear floating-point light, not 8-bit sRGB */
  bool deep;   /* can hold 16-bit sRGB, too */
} skf_picture_format;

/* The registry's rows; NULL behind the last. */
const skf_picture_format *skf_picture_format_get(int i);
/* By the ending of a path, in any case of letters; NULL when there is none. */
const skf_picture_format *skf_picture_format_find(const char *path);

typedef struct skf_canvas skf_canvas;

/* A string's box at size 1 is `width` wide; digits reach `height` above the baseline. */
typedef struct skf_text_extent {
  double width, height;
} skf_text_extent;

/* Where a text goes: the anchor (x, y) is at the share `ax` of its width and `ay` of its digits' height above the
   baseline; `angle` turns it counter-clockwise about the anchor [rad]; `size` is that of an em [pixels]. */
typedef struct skf_text_place {
  double x, y, ax, ay, angle, size;
} skf_text_place;

enum { SKF_PLOT_ABI = 2 };

/* What a module exports under the name SKF_PLOT_SYMBOL. Drawing calls never fail at once: the first failure is kept
   and comes out of encode(). */
typedef struct skf_plot {
  unsigned abi;
  const char *name;
  /* A white canvas. `font` is a font file or NULL: then a list of usual places is searched, and plain strokes are used
     when there is none. NULL and a line in `error` on failure. */
  skf_canvas *(*create)(int width, int height, const char *font, char error[256]);
  void (*destroy)(skf_canvas *canvas);
  /* File of the font in use, "Hershey" for the strokes. */
  const char *(*font)(const skf_canvas *canvas);
  /* 256 colours of a map by name, dark to bright; false when it is unknown. colormaps: the names, NULL at the end. */
  bool (*colormap)(const char *name, unsigned char rgb[256][3]);
  const char *const *colormaps;
  /* What follows is drawn in this rectangle only. */
  void (*clip)(skf_canvas *canvas, double x0, double y0, double x1, double y1);
  /* width * height * 3 bytes, rows from the top. */
  void (*image)(skf_canvas *canvas, int x, int y, int width, int height, const unsigned char *rgb);
  void (*stroke)(skf_canvas *canvas, const double (*xy)[2], size_t n, bool closed, double width, const double rgba[4]);
  void (*fill)(skf_canvas *canvas, const double (*xy)[2], size_t n, const double rgba[4]);
  /* UTF-8. */
  void (*text)(skf_canvas *canvas, skf_text_place place, const char *text, const double rgba[4]);
  skf_text_extent (*extent)(skf_canvas *canvas, const char *text);
  /* The picture as the bytes of a file; give them back with release(). */
  skf_status (*encode)(skf_canvas *canvas, const char *ending, unsigned char **bytes, size_t *n, char error[256]);
  /* Linear light, width * height * 3 floats, rows from the top, in a linear format. */
  skf_status (*encode_linear)(int width, int height, const float *rgb, const char *ending, unsigned char **bytes,
                              size_t *n, char error[256]);
  void (*release)(unsigned char *bytes);
  /* sRGB in 16 bits, width * height * 3, in a format that is `deep`. */
  skf_status (*encode_deep)(int width, int height, const unsigned short *rgb, const char *ending, unsigned char **bytes,
                            size_t *n, char error[256]);
  /* Reads a picture file of any format: width * height * 3 bytes, sRGB, rows from the top; give them back with
     release(). */
  skf_status (*decode)(const char *path, int *width, int *height, unsigned char **rgb, char error[256]);
} skf_plot;

#define SKF_PLOT_MODULE "skelfield-opencv.so"
#define SKF_PLOT_SYMBOL "skf_plot_module"

/* The module: looked for in $SKELFIELD_MODULES (folders separated by colons), beside the program, in the folder of
   modules relative to it, and where it was installed. NULL and a line in `error` when there is none. The module stays
   loaded until the program ends. */
const skf_plot *skf_plot_load(char error[256]);

#ifdef __cplusplus
}
#endif
#endif
