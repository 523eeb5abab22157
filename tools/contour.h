/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Iso-lines of values on a grid: marching squares, with the pieces joined to lines. */
#ifndef SKF_TOOLS_CONTOUR_H
#define SKF_TOOLS_CONTOUR_H

#include <stdbool.h>
#include <stddef.h>

/* One line: points in units of the grid, (0, 0) at the first value, (nx - 1, 0) at the end of the first row. */
typedef struct contour {
  double (*xy)[2];
  size_t n;
  bool closed; /* the last point joins the first, which is not repeated */
} contour;

typedef struct contours {
  contour *lines;
  size_t count;
} contours;

/* The lines where the values cross the level, interpolated linearly. values: nx * ny, rows one after the other.
   Cells with a NaN are left out; an infinite corner counts as far above or below. False when memory is out. */
bool contour_find(const double *values, int nx, int ny, double level, contours *out);
void contour_free(contours *c);

#endif
