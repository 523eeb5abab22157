/* SPDX-License-Identifier: MIT */
/* Points and planes, where every kernel has a formula of one line. */
#ifndef SKF_FIELD_SIMPLE_H
#define SKF_FIELD_SIMPLE_H

#include "field/kernel.h"
#include "num/exact.h"

/* x - at, exact, and its squared length. */
static inline skf_dd3 skf_point_delta(const skf_prepared *e, skf_vec3 x, double *w) {
  skf_dd3 d = dd3_diff(x, e->primitive.point.at);
  *w = v3_norm2(dd3_round(d));
  return d;
}

/* From h and its derivatives with respect to w = |d|^2. */
void skf_point_result(const double h[4], skf_dd3 d, int order, skf_value *v);

/* x where the plane's normal is along no axis; else its coordinate along that, and of `rest` the others, which do not
   matter, be they huge, infinite or NaN. */
skf_vec3 skf_plane_seen(const skf_prepared *e, skf_vec3 x, skf_vec3 rest);
/* Signed height of x over the plane, to an ulp or two. */
double skf_plane_height(const skf_prepared *e, skf_vec3 x);
/* From F and its first two derivatives with respect to the height. For every kernel these are -2 pi z h(|z|) and
   -2 pi (h + 2 z^2 dh/dw). */
void skf_plane_result(const skf_prepared *e, double F, double slope, double curvature, int order, skf_value *v);

#endif
