/* SPDX-License-Identifier: MIT */
/* Polygons with holes, cut into triangles by CGAL's constrained Delaunay triangulation. */
#ifndef SKF_ADAPT_POLYGON_H
#define SKF_ADAPT_POLYGON_H

#include "skelfield/polygon.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What skf_polygon_cut wants, with exact predicates: what touches or crosses by less than rounding is told from what
   does not. Of all triangulations it has the largest smallest angle. NULL where the build has no CGAL. */
skf_ring_cutter *polygon_cutter(void);

#ifdef __cplusplus
}
#endif
#endif
