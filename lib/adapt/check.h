/* SPDX-License-Identifier: MIT */
/* Checks of meshes and skeletons by a second party: CGAL, with exact predicates. */
#ifndef SKF_ADAPT_CHECK_H
#define SKF_ADAPT_CHECK_H

#include "skelfield/ray.h"
#include "skelfield/surface.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Whether this build has CGAL; without it every check returns SKF_ERR_UNSUPPORTED. */
bool check_available(void);

/* What CGAL finds. The figures below `bounds` are 0 when the triangles do not form a mesh or it is not closed. */
typedef struct check_mesh_report {
  bool mesh;    /* the triangles form an oriented 2-manifold, with or without a border */
  bool closed;  /* no border */
  bool bounds;  /* free of self-intersections, and its components are nested and oriented so that they bound a volume */
  bool outward; /* oriented outwards */
  size_t self_intersections; /* pairs of triangles that share more than a common edge or vertex */
  size_t components, degenerate;
  long euler, genus;
  double area, volume; /* [L^2], [L^3] */
} check_mesh_report;

skf_status check_mesh(const skf_mesh *mesh, check_mesh_report *out);

/* A tree of boxes over the triangles, for rays. */
typedef struct check_tree check_tree;
skf_status check_tree_new(const skf_mesh *mesh, check_tree **out);
void check_tree_free(check_tree *tree);
/* All crossings with t >= 0 along the normalised direction, sorted: at most `capacity` go to t, *count is their number.
 */
skf_status check_tree_all(const check_tree *tree, skf_vec3 origin, skf_vec3 direction, size_t capacity, double *t,
                          size_t *count);

/* Two triangles of a skeleton that share more than they should. */
typedef struct check_pair {
  size_t first, second;
  bool overlap; /* they share an area; else their interiors cross along a line */
} check_pair;

/* n triangles of three corners each; at most `capacity` pairs are stored, *count is their number. Exact. */
skf_status check_triangles(size_t n, const skf_vec3 (*corners)[3], size_t capacity, check_pair *pairs, size_t *count);

#ifdef __cplusplus
}
#endif
#endif
