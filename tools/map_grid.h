/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A quantity of a scene, sampled on an axis-aligned plane. */
#ifndef SKF_TOOLS_MAP_GRID_H
#define SKF_TOOLS_MAP_GRID_H

#include "chart.h"
#include "cli.h"

/* The plane where coordinate `normal` (0..2) is `at`; across goes `u`, up goes `v`. */
typedef struct map_plane {
  int normal, u, v;
  double at;
} map_plane;

/* "z=0". False when malformed. */
bool map_plane_parse(const char *text, map_plane *out);

typedef enum map_kind { MAP_F, MAP_POTENTIAL, MAP_ACCELERATION, MAP_KIND_COUNT } map_kind;

/* A registered quantity. */
typedef struct map_quantity {
  const char *name, *title, *label, *absolute; /* absolute: the label of its absolute value */
} map_quantity;
extern const map_quantity map_quantities[MAP_KIND_COUNT];

typedef struct map_grid {
  map_plane plane;
  double x0, x1, y0, y1; /* edges; the samples are at the middles of nx * ny cells, rows from y1 down */
  int nx, ny;
  double *value;
  double *slope[2]; /* du and dv of the quantity's force, where wanted; else NULL */
} map_grid;

skf_vec3 map_point(const map_grid *g, double i, double j);

/* Fills value (and slope when `arrows`) and the outline F = iso of each body. outlines: body_count, to be freed by
   contour_free. */
skf_status map_sample(const skf_scene *scene, map_kind kind, bool arrows, map_grid *g, contours *outlines,
                      skf_progress progress);
void map_grid_free(map_grid *g);

/* Widens [x0, x1] and [y0, y1] (empty: x0 > x1) to the bodies' surfaces in the plane; where a surface is unbounded or
   absent, to the skeleton. */
void map_frame(const skf_scene *scene, map_plane plane, double x[2], double y[2]);

/* The skeleton's bounds with room around them; of a plane its point. */
skf_box map_skeleton_box(const skf_body *body);

/* The range to show: that of the finite values, less what stands out near singularities. NaN ends are chosen. */
void map_range(const double *value, size_t n, bool log, double lo, double hi, color_scale *out);

#endif
