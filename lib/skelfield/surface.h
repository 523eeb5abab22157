/* SPDX-License-Identifier: MIT */
/* Triangle meshes of isosurfaces, and their files. */
#ifndef SKELFIELD_SURFACE_H
#define SKELFIELD_SURFACE_H

#include "skelfield/field.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Indexed triangles, counter-clockwise seen from outside. normals may be NULL. */
typedef struct skf_mesh {
  size_t vertex_count, triangle_count;
  skf_vec3 *vertices, *normals;
  unsigned (*triangles)[3];
} skf_mesh;

SKF_API void skf_mesh_free(skf_mesh *mesh);

#ifdef __cplusplus
}
#endif
#endif
