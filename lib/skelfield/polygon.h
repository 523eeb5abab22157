/* SPDX-License-Identifier: MIT */
/* Polygons with holes, by a way to cut them that the caller brings. */
#ifndef SKELFIELD_POLYGON_H
#define SKELFIELD_POLYGON_H

#include "skelfield/skeleton.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Cuts rings in the plane into triangles of their vertices, counter-clockwise. Ring k has sizes[k] >= 3 vertices, which
   stand one ring after the other in xy; the first ring is the outline, the others are holes; any of them may run either
   way round. *count is n + 2 holes - 2 at most. SKF_ERR_DEGENERATE: *why tells what is wrong, *where at which vertex.
 */
typedef skf_status skf_ring_cutter(const double (*xy)[2], size_t rings, const size_t *sizes, unsigned (*triangles)[3],
                                   size_t *count, const char **why, size_t *where);

/* Cuts a polygon with holes by a cutter of the caller's (the program has CGAL's, this library has none), which gets the
   coordinates unchanged but for the one that is nearest to the normal, which is left out. All vertices must be within
   1e-6 of the outline's extent in its plane. The triangles have the outline's orientation. Errors as of
   skf_polygon_triangulate. */
SKF_API skf_status skf_polygon_cut(const skf_vec3 *vertices, size_t rings, const size_t *sizes, skf_ring_cutter *cutter,
                                   unsigned (*triangles)[3], size_t *count, const char **why, size_t *where);

#ifdef __cplusplus
}
#endif
#endif
