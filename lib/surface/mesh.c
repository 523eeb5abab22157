/* SPDX-License-Identifier: MIT */
#include "core/alloc.h"
#include "skelfield/surface.h"
#include <string.h>

void skf_mesh_free(skf_mesh *m) {
  if (!m) return;
  skf_free(m->vertices), skf_free(m->normals), skf_free(m->triangles), skf_free(m->bodies);
  *m = (skf_mesh){0};
}

skf_status skf_mesh_append(skf_mesh *m, const skf_mesh *part, unsigned body) {
  size_t nv = m->vertex_count + part->vertex_count, nt = m->triangle_count + part->triangle_count;
  if (nv >= 0xffffffffu) return SKF_ERR_CAPACITY;
  bool normals = part->normals && (m->normals || !m->vertex_count);
  skf_mesh sum = {nv,
                  nt,
                  skf_alloc(nv, sizeof *sum.vertices),
                  normals ? skf_alloc(nv, sizeof *sum.normals) : NULL,
                  skf_alloc(nt, sizeof *sum.triangles),
                  skf_alloc(nt, sizeof *sum.bodies)};
  if (!sum.vertices || !sum.triangles || !sum.bodies || (normals && !sum.normals))
    return skf_mesh_free(&sum), SKF_ERR_NOMEM;
  size_t v = m->vertex_count, t = m->triangle_count;
  if (v) memcpy(sum.vertices, m->vertices, v * sizeof *sum.vertices);
  if (part->vertex_count) memcpy(sum.vertices + v, part->vertices, part->vertex_count * sizeof *sum.vertices);
  if (normals && v) memcpy(sum.normals, m->normals, v * sizeof *sum.normals);
  if (normals && part->vertex_count) memcpy(sum.normals + v, part->normals, part->vertex_count * sizeof *sum.normals);
  if (t) memcpy(sum.triangles, m->triangles, t * sizeof *sum.triangles);
  if (t && m->bodies) memcpy(sum.bodies, m->bodies, t * sizeof *sum.bodies);
  for (size_t i = 0; i < part->triangle_count; i++) {
    for (int k = 0; k < 3; k++) sum.triangles[t + i][k] = part->triangles[i][k] + (unsigned)v;
    sum.bodies[t + i] = body;
  }
  skf_mesh_free(m);
  *m = sum;
  return SKF_OK;
}
