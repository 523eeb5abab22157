/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A picture with axes, on the canvas of the drawing module. */
#ifndef SKF_TOOLS_CHART_H
#define SKF_TOOLS_CHART_H

#include "adapt/plot.h"
#include "contour.h"
#include "ticks.h"

/* How values become colours. lo < hi; with `log`, 0 < lo and the absolute value is shown. */
typedef struct color_scale {
  double lo, hi;
  bool log;
  bool below, above; /* values beyond the ends exist */
  unsigned char rgb[256][3];
} color_scale;

/* The colour of a value; grey for NaN. */
void scale_color(const color_scale *s, double value, unsigned char rgb[3]);
/* Share of the way from lo to hi, not clipped. */
double scale_share(const color_scale *s, double value);
/* Lightness in [0, 1] of the colour of a value. */
double scale_lightness(const color_scale *s, double value);

/* A cell of the box holds nothing, something that labels must not cover, or the iso-line with this number. */
enum { CHART_CELLS = 160, CHART_FREE = 0, CHART_BUSY = 255 };

typedef struct chart {
  const skf_plot *plot;
  skf_canvas *canvas;
  int width, height;
  double em;                                    /* size of the tick labels [pixels] */
  double left, top, right, bottom;              /* box of the axes [pixels]; whole numbers */
  double x0, x1, y0, y1;                        /* what the box shows */
  bool degrees;                                 /* it shows angles [deg] */
  unsigned char busy[CHART_CELLS][CHART_CELLS]; /* what parts of the box hold */
} chart;

extern const double chart_ink[4];

/* Lays the box out: leaves room for title, labels and colour bar. When `fill`, [x0, x1] and [y0, y1] are widened about
   their middle until they fill the room, else the box takes their shape; scales are equal on both axes. */
void chart_layout(chart *c, bool fill);
/* Pixels from scene units. */
void chart_at(const chart *c, double x, double y, double xy[2]);

/* The frame, ticks with labels, the names of the axes, the title and what stands below it. */
void chart_axes(chart *c, const char *x_name, const char *y_name, const char *title, const char *subtitle);
/* The colour bar at the right of the box, with marks at the levels. */
void chart_bar(chart *c, const color_scale *s, const char *name, const double *levels, int level_count);

/* Lines in grid units; the grid's corner values lie half a cell inside the box. `text`, if given, labels them where
   there is nothing but the lines kept as `number`. */
void chart_contours(chart *c, const contours *lines, int nx, int ny, double width, const double rgba[4],
                    const char *text, int number);
/* Notes where lines are, so that labels keep off: iso-lines by their number, or CHART_BUSY; a line in scene units. */
void chart_keep_contours(chart *c, const contours *lines, int nx, int ny, int number);
void chart_keep_curve(chart *c, const double (*xy)[2], size_t n);
/* A line with a halo, in scene units. */
void chart_curve(chart *c, const double (*xy)[2], size_t n, const double rgba[4], const double halo[4], double width);
/* Whether labels and arrows must keep off a place in scene units. */
bool chart_busy(const chart *c, double x, double y);
/* An arrow of `length` pixels about (x, y) in scene units, towards (dx, dy). */
void chart_arrow(chart *c, double x, double y, double dx, double dy, double length, const double rgba[4]);
/* A round mark (corners > 4), square, or cross (corners = 0) at a place in scene units. */
void chart_mark(chart *c, double x, double y, int corners, double radius, const double rgba[4], const double edge[4]);

typedef struct legend_row {
  char text[96];
  double rgba[4], edge[4];
  int corners; /* of a mark; -1: a line, 0: a cross */
} legend_row;
/* A legend in the corner that is least busy; keep its place before iso-lines are labelled, draw it after all else. */
typedef struct legend {
  legend_row rows[20];
  int count;
  double left, top, width, height; /* pixels */
} legend;
void chart_legend_place(chart *c, legend *l);
void chart_legend_draw(chart *c, const legend *l);

#endif
