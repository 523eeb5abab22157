/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Paths of particles in a rendered picture, hidden where a surface is in front. */
#ifndef SKF_TOOLS_RENDER_PATHS_H
#define SKF_TOOLS_RENDER_PATHS_H

#include "picture.h"
#include "run_csv.h"

typedef struct path_view {
  const skf_plot *plot;
  skf_canvas *canvas;
  skf_camera camera;
  int width, height;
  const float *depth; /* of the surfaces, as skf_render gives it */
  double line;        /* width of a line at the distance `middle` [pixels] */
  double middle;      /* [L] */
  bool heads;         /* dots at the paths' ends, not at their starts */
} path_view;

/* Draws all paths and contacts. False when memory is out. */
bool render_paths(const path_view *view, const run_data *run);

#endif
