/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From the samples of a map to its picture. */
#ifndef SKF_TOOLS_MAP_DRAW_H
#define SKF_TOOLS_MAP_DRAW_H

#include "map_grid.h"
#include "picture.h"
#include "run_csv.h"

/* What the command line asks for. */
typedef struct map_job {
  const cli *c;
  skf_scene *scene;
  const skf_plot *plot;
  const skf_picture_format *format; /* NULL: no picture, only numbers */
  map_kind kind;
  map_plane plane;
  int width, height, levels, every;
  double extent[4], range[2];
  bool log;
  run_data run;
  contours *outlines;
  map_grid grid;
  color_scale scale;
  chart chart;
} map_job;

/* Draws everything on the canvas and writes the picture to -o. */
int map_draw(map_job *j);

#endif
