/* SPDX-License-Identifier: MIT */
/* The path of one step as a polynomial: what the dense output and the search for contacts read. */
#ifndef SKF_MOTION_PATH_H
#define SKF_MOTION_PATH_H

#include "motion/clock.h"

enum { SKF_PATH_DEGREE = 14 };

/* x(s) = x0 + sum_{k=1..degree} x[k-1] s^k for s in [0, 1], t = t0 + s h; v likewise. */
typedef struct skf_path {
  skf_clock t0;
  double h;
  int degree;
  skf_vec3 x0, v0;
  skf_vec3 x[SKF_PATH_DEGREE], v[SKF_PATH_DEGREE];
} skf_path;

skf_vec3 skf_path_position(const skf_path *p, double s);
skf_vec3 skf_path_velocity(const skf_path *p, double s);

/* dx/ds, of the polynomial x itself: v may be another one. */
skf_vec3 skf_path_rate(const skf_path *p, double s);

/* A bound of |x(s) - x0| for s in [0, 1]. */
double skf_path_reach(const skf_path *p);

/* The path about s = middle: position, derivatives with respect to s, and bounds over |s - middle| <= half. */
typedef struct skf_piece {
  skf_vec3 x, d1;     /* x(middle), dx/ds(middle) */
  double speed, bend; /* bounds of |dx/ds| and |d2x/ds2| */
} skf_piece;

skf_piece skf_path_piece(const skf_path *p, double middle, double half);

#endif
