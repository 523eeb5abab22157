/* SPDX-License-Identifier: MIT */
/* The inside of a closed triangle mesh: what it is made of, and what its queries and its field keep ready. */
#ifndef SKF_SKELETON_SOLID_H
#define SKF_SKELETON_SOLID_H

#include "core/vec3.h"
#include "skelfield/skeleton.h"
#include <stdatomic.h>

/* Faces of a block; a block keeps its own list of vertices, so that they fit the cache. Its columns are padded to
   SKF_SOLID_PAD, faces and edges with some that give nothing. */
enum { SKF_SOLID_BLOCK = 128, SKF_SOLID_PAD = 16 };

/* Columns of a block. An edge between two faces with unit normals nA, nB has the dyad nA mA' + nB mB' (m: outward in
   the face, across the edge), symmetric, without trace, zero along the edge; edges in one plane have none and are left
   out. */
enum { SKF_EDGE_LENGTH, SKF_EDGE_XX, SKF_EDGE_XY, SKF_EDGE_XZ, SKF_EDGE_YY, SKF_EDGE_YZ, SKF_EDGE_COLUMNS };
enum { SKF_FACE_NX, SKF_FACE_NY, SKF_FACE_NZ, SKF_FACE_TWICE, SKF_FACE_COLUMNS }; /* unit normal, twice the area */

typedef struct skf_solid_block {
  size_t vertices, edges, faces;
  size_t vertex_room, edge_room, face_room; /* with the padding: length of the columns */
  double *vertex, *edge, *face;             /* columns x, y, z; as above */
  unsigned short *ends, *corners;           /* two and three columns of vertices' numbers within the block */
  skf_box box;
  double longest; /* edge */
} skf_solid_block;

/* Faces [first, first + count) of a node of the tree; an inner node's children are the next node and `right`. */
typedef struct skf_solid_node {
  skf_box box;
  unsigned first, count, right; /* right = 0: a leaf */
} skf_solid_node;

/* The expansion far away: a row for each (n, m), m by m with n rising up to the degree, holds the coefficients of F,
   the gradient and the Hessian (xx, xy, xz, yy, yz), of the real and the imaginary part of I_nm each. */
enum { SKF_SOLID_FAR_COLUMNS = 18, SKF_SOLID_FAR_MAX = 40, SKF_SOLID_BANDS = 5 };

struct skf_solid {
  atomic_uint shares;
  skf_solid_info info;
  size_t vertex_count, face_count;
  skf_vec3 *vertices;
  unsigned (*faces)[3]; /* in the order of the tree */
  unsigned char *sharp; /* of each face: bit i is set when the edge from corner i has a dyad that is not zero */
  skf_solid_node *nodes;
  size_t block_count;
  skf_solid_block *blocks;
  double *columns; /* of all blocks */
  unsigned short *numbers;
  double radius;                        /* of a ball about info.center that holds everything */
  double far;                           /* from this distance on the expansion about info.center */
  int degree, degrees[SKF_SOLID_BANDS]; /* from `far` times 1, 2, 4, 16, 256 on fewer are enough */
  double band[SKF_SOLID_BANDS];
  double *moments; /* rows of SKF_SOLID_FAR_COLUMNS; lengths in units of `radius` */
};

/* A mesh with equal vertices joined, without unused vertices and faces that have no area. */
typedef struct skf_solid_mesh {
  size_t nv, nf;
  skf_vec3 *v;
  unsigned (*f)[3];
  size_t joined, unused, dropped;
} skf_solid_mesh;

/* Two faces that meet at an edge: `along` runs from lo to hi, `against` the other way. */
typedef struct skf_solid_pair {
  unsigned lo, hi;
  unsigned along, against; /* 3 * face + corner where it starts */
} skf_solid_pair;

/* Fills in the error and returns its status. */
skf_status skf_solid_refuse(skf_error *e, skf_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

skf_status skf_solid_clean(const skf_vec3 *v, size_t nv, const unsigned (*f)[3], size_t nf, skf_solid_mesh *out,
                           skf_error *e);
void skf_solid_mesh_free(skf_solid_mesh *m);
/* Every edge with its two faces; refuses what is not closed or not consistently oriented. */
skf_status skf_solid_pairs(const skf_solid_mesh *m, skf_solid_pair **out, size_t *count, skf_error *e);
/* Refuses components that face inward without being a cavity, and those that lie inside of another one's material. */
skf_status skf_solid_components(const skf_solid_mesh *m, const skf_solid_pair *pairs, size_t count, size_t *components,
                                skf_error *e);

/* Sorts the mesh's faces along the tree and builds it. */
skf_status skf_solid_tree(skf_solid_mesh *m, skf_solid_node **nodes);

/* Area, volume, centre, inertia. */
void skf_solid_weigh(const skf_solid_mesh *m, skf_solid_info *out);
/* Blocks with their vertices, edges and faces. */
skf_status skf_solid_cut(skf_solid *s, const skf_solid_pair *pairs, size_t count);
/* The expansion. */
skf_status skf_solid_expand(skf_solid *s);

/* Distance from x to the surface. */
double skf_solid_to_surface(const skf_solid *s, skf_vec3 x);
/* Distance from x to the nearest edge whose dyad is not zero, or `upto` when that is nearer. */
double skf_solid_to_edges(const skf_solid *s, skf_vec3 x, double upto);
/* How many faces come closer to x than r; not counted beyond `most`. */
size_t skf_solid_faces_within(const skf_solid *s, skf_vec3 x, double r, size_t most);

/* Solid angle of a triangle seen from the origin, over 4 pi, positive from its inner side [van Oosterom, Strackee 1983,
   eq. 8]. */
double skf_solid_winding(skf_vec3 a, skf_vec3 b, skf_vec3 c);

#endif
