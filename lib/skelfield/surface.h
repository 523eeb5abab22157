/* SPDX-License-Identifier: MIT */
/* Triangle meshes of isosurfaces, their measures and their files. */
#ifndef SKELFIELD_SURFACE_H
#define SKELFIELD_SURFACE_H

#include "skelfield/field.h"
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Indexed triangles, counter-clockwise seen from outside. normals and bodies may be NULL. */
typedef struct skf_mesh {
  size_t vertex_count, triangle_count;
  skf_vec3 *vertices, *normals; /* [L], unit vectors */
  unsigned (*triangles)[3];
  unsigned *bodies; /* of each triangle, when several bodies share the mesh */
} skf_mesh;

/* Frees the arrays and leaves an empty mesh. */
SKF_API void skf_mesh_free(skf_mesh *mesh);

/* Appends `part`, as body number `body`; on failure `mesh` is as before. */
SKF_API skf_status skf_mesh_append(skf_mesh *mesh, const skf_mesh *part, unsigned body);

/* A box that holds the whole surface F = iso. For iso < 0 it is the body that reaches to infinity, where F is 0, and
   the surface is around what is outside of it: *around (which may be NULL) tells so. SKF_ERR_UNBOUNDED: there is no box
   (a plane; iso = 0); SKF_ERR_EMPTY: there is no surface; SKF_ERR_UNSUPPORTED: an element has no bounds. */
SKF_API skf_status skf_surface_region(const skf_field *field, double iso, skf_box *out, bool *around);

/* Disjoint boxes that together hold the whole surface: one, or one for each of up to a thousand parts that are farther
   apart than the smaller of two is large. On failure, as of skf_surface_region, there are none. */
SKF_API skf_status skf_surface_parts(const skf_field *field, double iso, skf_box **boxes, size_t *count);
SKF_API void skf_surface_parts_free(skf_box *boxes);

/* How to mesh; all zero is the default. */
typedef struct skf_mesh_options {
  double edge;          /* target edge length [L]; 0: chosen from the size and the curvature of each part */
  size_t max_triangles; /* more are refused with SKF_ERR_CAPACITY; 0: 20 million */
  int rounds;           /* of flips and smoothing; 0: three; negative: none */
  skf_progress progress;
} skf_mesh_options;

/* What the mesher did. Lengths in [L]. */
typedef struct skf_mesh_report {
  double edge;     /* target length in force; the shortest where parts have their own */
  double residual; /* worst |F - iso| / |grad F| of a vertex */
  size_t cells;    /* lattice cells that may hold the surface */
  size_t samples;  /* lattice nodes at which the field was evaluated */
  size_t missed;   /* sampled places of the skeleton that are inside the surface, but that no lattice node near by
                      knows of: thinner parts than the lattice resolves */
  size_t parts;    /* meshed by themselves, see skf_surface_parts */
  bool around;     /* see skf_surface_region */
  size_t clamped;  /* vertices that could not be put onto the surface, since it touches a lattice node there */
} skf_mesh_report;

/* Closed oriented 2-manifold triangle mesh of F = iso without self-intersections, every vertex on the surface to
   rounding, normals -grad F / |grad F|. The body-centred cubic lattice under it finds every component that is larger
   than the edge length; parts that are far apart have one each where the edge is chosen, or where one does not reach.
   For iso < 0, where the body is around the surface, triangles and normals point into what they enclose, which is
   outside: the mesh's volume is negative. The result does not depend on the number of threads. On failure *out is
   empty; the report may be NULL. SKF_ERR_UNBOUNDED: the surface extends to infinity, or may; SKF_ERR_EMPTY: F < iso
   (for iso < 0: F > iso) wherever it was sampled; SKF_ERR_CAPACITY: more triangles than allowed; SKF_ERR_RANGE: the
   edge is not positive and finite. */
SKF_API skf_status skf_mesh_field(const skf_field *field, double iso, const skf_mesh_options *options, skf_mesh *out,
                                  skf_mesh_report *report);

/* Measures and defects of a mesh. Edges are counted without direction. */
typedef struct skf_mesh_measure {
  size_t edges, components, unused_vertices;
  size_t boundary_edges;                    /* with one triangle */
  size_t nonmanifold_edges;                 /* with more than two triangles */
  size_t misoriented_edges;                 /* with two triangles that run in the same direction */
  size_t nonmanifold_vertices;              /* whose triangles do not form one fan or disc */
  size_t degenerate;                        /* triangles with a repeated vertex or no area */
  size_t duplicates;                        /* triangles with the same three vertices as an earlier one */
  long euler;                               /* used vertices - edges + triangles */
  long genus;                               /* sum over components; meaningful for closed manifolds */
  bool closed, manifold, oriented, outward; /* outward: every component encloses a positive volume, or is a cavity */
  double area, volume;                      /* [L^2], [L^3]; volume of what the triangles enclose */
  skf_box box;
  double edge_min, edge_mean, edge_max; /* [L] */
  double angle_min, angle_mean;         /* smallest angle of all, mean of each triangle's smallest [rad] */
} skf_mesh_measure;

SKF_API skf_status skf_mesh_measure_of(const skf_mesh *mesh, skf_mesh_measure *out);

/* Finds triangles that cross or touch another one beyond what they share, or come so close to it that rounding cannot
   tell: bad[t], one for each triangle, is set to 1 for those and to 0 for all others; *count is their number. So 0 is
   certain. */
SKF_API skf_status skf_mesh_crossings(const skf_mesh *mesh, signed char *bad, size_t *count);

/* A registered mesh file format. */
typedef struct skf_mesh_format {
  const char *extension, *doc; /* ".ply" */
  /* SKF_OK or SKF_ERR_IO */
  skf_status (*write)(const skf_mesh *mesh, FILE *file);
  /* Reads a whole file from memory. */
  skf_status (*read)(const char *data, size_t size, skf_mesh *out, skf_error *error);
  bool (*recognise)(const char *data, size_t size);
} skf_mesh_format;

/* Row i of the registry, NULL behind the last. */
SKF_API const skf_mesh_format *skf_mesh_format_get(int i);
/* The format that a file name's ending asks for (any case); NULL when there is none. */
SKF_API const skf_mesh_format *skf_mesh_format_find(const char *path);

/* Writes to an open file; SKF_ERR_IO when the file refuses. */
SKF_API skf_status skf_mesh_write(const skf_mesh *mesh, const skf_mesh_format *format, FILE *file);

/* Reads a mesh of any registered format, which is recognised by its content, then by its name. Polygons are cut into
   fans, vertices of STL files are joined where they are equal to the last bit, normals are dropped. On failure *out is
   empty and *error, if given, tells what is wrong, where (line of a text file, byte of a binary one), and what was
   expected. */
SKF_API skf_status skf_mesh_read(const char *path, skf_mesh *out, skf_error *error);

#ifdef __cplusplus
}
#endif
#endif
