/* SPDX-License-Identifier: MIT */
/* Inside of the mesher: a body-centred cubic lattice, sampled only where the surface may be.

   Cubes have side 2 half; lattice nodes are their corners and centres, at origin + half (x, y, z) with integers that
   are all even (corners) or all odd (centres). A tetrahedron joins the centres of two cubes that share a face with an
   edge of that face. Signs of F - iso at the nodes decide the topology: marching tetrahedra give a closed manifold that
   lies inside the tetrahedra, so it cannot cross itself. Nodes that the surface nearly touches are moved onto it
   ("warped") when the surface stays a manifold there and no tetrahedron turns over
   [Labelle & Shewchuk 2007, Isosurface stuffing]. */
#ifndef SKF_SURFACE_MESHER_H
#define SKF_SURFACE_MESHER_H

#include "core/alloc.h"
#include "core/vec3.h"
#include "skelfield/surface.h"
#include <stdint.h>

#define SKF_NONE 0xffffffffu

typedef struct skf_lattice {
  skf_vec3 origin;
  double half;
  int depth; /* 2^depth cubes along an axis */
} skf_lattice;

/* Integer coordinates in 0 .. 2^21 - 1, packed. */
typedef uint64_t skf_key;

static inline skf_key skf_key_of(const int x[3]) { return (skf_key)x[0] | (skf_key)x[1] << 21 | (skf_key)x[2] << 42; }
static inline void skf_key_get(skf_key k, int x[3]) {
  for (int i = 0; i < 3; i++) x[i] = (int)(k >> 21 * i & 0x1fffff);
}

/* Sampled nodes, found by key. */
typedef struct skf_nodes {
  size_t count, capacity, mask;
  unsigned *table; /* index + 1, 0: free */
  skf_key *key;
  double *F;
  skf_vec3 *at;
  signed char *sign; /* 1: F > iso, else -1 */
  signed char *zero; /* 1: warped onto the surface */
} skf_nodes;

/* An edge of the lattice that the surface cuts: from inside (sign 1) to outside. */
typedef struct skf_cut {
  unsigned in, out;
} skf_cut;

typedef struct skf_mesher {
  const skf_field *field;
  double iso;
  const skf_progress *progress;
  size_t limit; /* of triangles */
  skf_lattice lattice;
  skf_box region;
  bool around; /* the body is around the surface: F > iso far away */
  size_t cube_count;
  skf_key *cubes; /* cubes that may hold the surface, by the integer coordinates of their centres */
  skf_nodes nodes;
  size_t tet_count;
  unsigned (*tets)[4]; /* tetrahedra with both signs, positively oriented */
  size_t cut_count;
  skf_cut *cuts;
  skf_vec3 *cut_at;
  unsigned *cut_of; /* 7 per node, see skf_edge_slot; SKF_NONE: no cut */
  size_t clamped;
} skf_mesher;

/* lattice.c */
skf_status skf_lattice_set(skf_lattice *l, skf_box region, double edge);
skf_vec3 skf_lattice_at(const skf_lattice *l, skf_key key);
unsigned skf_nodes_find(const skf_nodes *n, skf_key key);
/* Index of the node, added when new; SKF_NONE when memory is out. */
unsigned skf_nodes_add(skf_nodes *n, const skf_lattice *l, skf_key key);
void skf_nodes_free(skf_nodes *n);
/* Offsets of the 14 neighbours, and the 24 triangles of their sphere, counter-clockwise from outside. */
extern const signed char skf_star[14][3];
extern const unsigned char skf_star_faces[24][3];
/* The slot in cut_of of the edge between neighbours a and b. */
size_t skf_edge_slot(const skf_nodes *n, unsigned a, unsigned b);

/* parts.c: boxes that hold all of the surface in m->region, far enough apart to be meshed by themselves at edges of up
   to a hundredth of their diagonals, or of `edge` if that is more; one where there is but one, or more than a thousand.
   The caller frees them. */
skf_status skf_mesher_parts(const skf_mesher *m, double edge, skf_box **boxes, size_t *count);

/* cells.c: finds the cubes that may hold the surface. */
skf_status skf_mesher_cells(skf_mesher *m);

/* cuts.c: samples the nodes of those cubes, lists the tetrahedra with both signs and puts a vertex onto each cut. */
skf_status skf_mesher_cuts(skf_mesher *m);

/* warp.c */
skf_status skf_mesher_warp(skf_mesher *m);

/* extract.c */
skf_status skf_mesher_extract(skf_mesher *m, skf_mesh *out);

void skf_mesher_free(skf_mesher *m);

/* polish.c */
/* Points between in[i] (F > iso) and out[i] (F <= iso) with F = iso to rounding. */
skf_status skf_polish_segments(const skf_field *field, double iso, size_t n, const skf_vec3 *in, const skf_vec3 *out,
                               skf_vec3 *at);
/* Moves points near the surface onto it along the gradient; moved[i] is set where that succeeded within `reach`, other
   points are left alone. */
skf_status skf_polish_points(const skf_field *field, double iso, double reach, size_t n, skf_vec3 *at,
                             signed char *moved);
/* Field and gradient at n points; F or g may be NULL. */
skf_status skf_sample(const skf_field *field, size_t n, const skf_vec3 *at, double *F, skf_vec3 *g);

/* improve.c: flips and smooths; the vertices named in `locked` stay, and so do the edges between them. */
skf_status skf_mesh_improve(skf_mesh *mesh, const skf_field *field, double iso, double edge, int rounds,
                            const signed char *locked);

static inline bool skf_cancelled(const skf_progress *p, double done) {
  return p && p->report && p->report(p->user, done) != 0;
}

#endif
