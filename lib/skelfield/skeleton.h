/* SPDX-License-Identifier: MIT */
/* Primitives of a skeleton: points, segments, arcs, triangles, planes, solids. */
#ifndef SKELFIELD_SKELETON_H
#define SKELFIELD_SKELETON_H

#include "skelfield/core.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum skf_shape {
  SKF_POINT,
  SKF_SEGMENT,
  SKF_ARC,
  SKF_TRIANGLE,
  SKF_PLANE,
  SKF_SOLID,
  SKF_SHAPE_COUNT
} skf_shape;

typedef struct skf_point {
  skf_vec3 at;
} skf_point;

typedef struct skf_segment {
  skf_vec3 from, to;
} skf_segment;

/* Starts at center + radius * start and turns about normal by the right-hand rule. `start` is projected onto the
   arc's plane and normalised, `normal` is normalised. sweep [rad] in (0, 2 pi]; 2 pi (the double) is the full circle.
 */
typedef struct skf_arc {
  skf_vec3 center, normal, start;
  double radius, sweep;
} skf_arc;

typedef struct skf_triangle {
  skf_vec3 vertices[3];
} skf_triangle;

typedef struct skf_plane {
  skf_vec3 through, normal;
} skf_plane;

/* The homogeneous inside of a closed triangle mesh: immutable, shared by a count of its holders, safe to share between
   threads. */
typedef struct skf_solid skf_solid;

/* One primitive, in the frame of its body. */
typedef struct skf_primitive {
  skf_shape shape;
  union {
    skf_point point;
    skf_segment segment;
    skf_arc arc;
    skf_triangle triangle;
    skf_plane plane;
    const skf_solid *solid;
  };
} skf_primitive;

typedef enum skf_param_type {
  SKF_PARAM_NUMBER,  /* double */
  SKF_PARAM_ANGLE,   /* double, radians here and degrees in files */
  SKF_PARAM_VECTOR,  /* skf_vec3 */
  SKF_PARAM_VECTORS, /* `count` consecutive skf_vec3 */
  SKF_PARAM_SOLID    /* const skf_solid *, the name of a mesh file in files */
} skf_param_type;

/* One parameter of a registered kind: the scene reader, the help and the documentation all read this. */
typedef struct skf_param {
  const char *name, *unit, *doc;
  skf_param_type type;
  int count;
  size_t offset;      /* of the value in the struct that the kind describes */
  double above, upto; /* numbers: above < value <= upto; angles in radians */
} skf_param;

/* A registered primitive. */
typedef struct skf_shape_info {
  const char *name, *doc, *measure_unit;
  const skf_param *params; /* offsets are into skf_primitive */
  int param_count;
} skf_shape_info;

/* The registry's row for a shape; NULL when out of range. */
SKF_API const skf_shape_info *skf_shape_get(skf_shape shape);

/* SKF_OK, SKF_ERR_RANGE (not finite, parameter out of range) or SKF_ERR_DEGENERATE (zero length, area or normal); on
   failure *why, if given, names what is wrong. */
SKF_API skf_status skf_primitive_check(const skf_primitive *p, const char **why);

/* Count, length, area, volume [1, L, L^2, L^3]; +infinity for a plane. */
SKF_API double skf_primitive_measure(const skf_primitive *p);

/* Smallest and largest distance from x to the primitive [L]; largest is +infinity for a plane. A solid's smallest is 0
   inside. */
SKF_API double skf_primitive_distance(const skf_primitive *p, skf_vec3 x);
SKF_API double skf_primitive_distance_max(const skf_primitive *p, skf_vec3 x);

/* Tight axis-aligned bounds; infinite for a plane. */
SKF_API skf_box skf_primitive_bounds(const skf_primitive *p);

/* A point of the primitive: s, t in [0, 1]. Points ignore both, segments and arcs t; planes give `through`, solids
   places on their surface. */
SKF_API skf_vec3 skf_primitive_point(const skf_primitive *p, double s, double t);

/* What a solid is made of and how it would move as a rigid body of density 1. */
typedef struct skf_solid_info {
  size_t vertices, faces, edges, components;
  size_t joined, unused, dropped; /* vertices that equalled others, that no face had; faces without any area */
  double area, volume;            /* [L^2], [L^3]; relative error 1e-15 unless the signed volumes of the tetrahedra over
                                     the faces, seen from the middle of the box, cancel */
  skf_vec3 center;                /* of mass [L] */
  double inertia[6];              /* about the center: xx, xy, xz, yy, yz, zz [L^5]; xy is -int x y dV */
  skf_box bounds;
} skf_solid_info;

/* Copies the mesh. Triangles are counter-clockwise seen from outside and close: each edge has as many in one direction
   as in the other. Several components are fine, cavities among them: they face inward and lie inside. Equal vertices
   are joined, unused ones and faces of zero area are left out. Whether faces cross each other is not looked at.
   SKF_ERR_RANGE (a number that is not finite, a wrong index), SKF_ERR_DEGENERATE (not closed, a face twice,
   inconsistent or inward, no volume), SKF_ERR_CAPACITY or SKF_ERR_NOMEM; *error, if given, tells what and where. */
SKF_API skf_status skf_solid_new(const skf_vec3 *vertices, size_t vertex_count, const unsigned (*faces)[3],
                                 size_t face_count, skf_solid **out, skf_error *error);
/* One more holder, and one less: the last one frees it. Fields hold the solids of their elements. NULL is fine. */
SKF_API const skf_solid *skf_solid_share(const skf_solid *solid);
SKF_API void skf_solid_free(const skf_solid *solid);

SKF_API const skf_solid_info *skf_solid_get(const skf_solid *solid);
/* info->vertices points; the numbers of three of them for each of info->faces triangles, in an order of their own. */
SKF_API const skf_vec3 *skf_solid_vertices(const skf_solid *solid);
SKF_API const unsigned *skf_solid_faces(const skf_solid *solid);
/* Whether x is inside; places on the surface, to rounding, may count either way. */
SKF_API bool skf_solid_contains(const skf_solid *solid, skf_vec3 x);
/* Distance from x to the farthest vertex [L]. */
SKF_API double skf_solid_distance_max(const skf_solid *solid, skf_vec3 x);

/* The full circle as an arc, which starts in a direction that depends on the normal alone. */
SKF_API skf_arc skf_arc_circle(skf_vec3 center, skf_vec3 normal, double radius);

/* Cuts a simple polygon, convex or not, into n - 2 triangles with the polygon's orientation; collinear vertices are
   used, too. Vertices may be off their plane by 1e-6 of the extent. Takes O(n^2 log n) typically. SKF_ERR_DEGENERATE
   (not planar, no area, edges that touch or cross) or SKF_ERR_RANGE: *why, if given, tells what is wrong, *where at
   which vertex. */
SKF_API skf_status skf_polygon_triangulate(const skf_vec3 *vertices, size_t n, unsigned (*triangles)[3],
                                           const char **why, size_t *where);

/* ---- Curves as chains of arcs ---- */

/* A curve for t in [0, 1]: its place, and the direction (of any length but 0) in which it goes on from there (side > 0)
   or came there (side < 0); the two differ at corners and cusps. */
typedef struct skf_curve {
  void (*at)(const void *user, double t, int side, skf_vec3 *place, skf_vec3 *direction);
  const void *user;
  int parts; /* is cut into this many equal parts of t to begin with: some four a turn, or its corners; 0: one */
} skf_curve;

/* Default tolerance, as a part of the curve's size. */
#define SKF_CURVE_TOLERANCE  1e-6
#define SKF_BEZIER_TOLERANCE SKF_CURVE_TOLERANCE

/* Replaces a curve by arcs (segments where it is straight), in order, each from where the last one ends, tangent to
   each other and to the curve at every second joint [Sharrock 1987]. Curve and pieces are nowhere farther than
   `tolerance` [L] from each other (measured at 15 points of each pair of arcs, with a factor 2 to spare); 0 stands for
   the default; it must be from 1e-10 to 0.1 of the largest side of the curve's box. *count is how many pieces there
   are, which grows like tolerance^(-1/3); pieces may be NULL, to count them. SKF_ERR_RANGE (not finite, tolerance),
   SKF_ERR_DEGENERATE (it stays where it is) or SKF_ERR_CAPACITY. */
SKF_API skf_status skf_curve_cut(const skf_curve *curve, double tolerance, skf_primitive *pieces, size_t capacity,
                                 size_t *count);

/* The same for the cubic Bezier curve of four control points; its size is its control polygon's length. Four equal
   points are SKF_ERR_DEGENERATE. */
SKF_API skf_status skf_bezier_cut(const skf_vec3 points[4], double tolerance, skf_primitive *pieces, size_t capacity,
                                  size_t *count);

#define SKF_HELIX_TURNS 1e5 /* at most */

/* Starts at center + radius * start, turns about the axis by the right-hand rule and rises by `pitch` along it in each
   turn [L], of any sign. The radius goes to end_radius linearly with the angle, or, if logarithmic, by the same factor
   in equal angles. So end_radius = radius is a helix, another one a conical helix; with pitch = 0 it is the spiral of
   Archimedes or the logarithmic one. `start` is projected and normalised as an arc's. */
typedef struct skf_helix {
  skf_vec3 center, axis, start;
  double radius, end_radius; /* >= 0, not both 0; both > 0 if logarithmic [L] */
  double pitch, turns;       /* 0 < turns <= SKF_HELIX_TURNS */
  bool logarithmic;
} skf_helix;

/* The same for a helix; its size is the larger radius. The pieces' total length is the curve's to (tolerance / size) or
   better. SKF_ERR_DEGENERATE: no axis or start, no radius, or a circle that is run through again (no pitch, one radius,
   more than one turn). */
SKF_API skf_status skf_helix_cut(const skf_helix *helix, double tolerance, skf_primitive *pieces, size_t capacity,
                                 size_t *count);

#ifdef __cplusplus
}
#endif
#endif
