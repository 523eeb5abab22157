/* SPDX-License-Identifier: MIT */
/* Solids of scene files. */
#include "scene/skeleton.h"

/* A solid needs no kernel, and has no other. */
static skf_status settle_kernel(skf_reader *r, skf_entry *e) {
  if (!e->style.has_kernel) {
    e->style.has_kernel = true;
    e->style.kernel = (skf_kernel){.type = SKF_INVERSE, .param = 1};
  }
  if (e->style.kernel.type == SKF_INVERSE) return SKF_OK;
  return skf_error_set(r->error, SKF_ERR_UNSUPPORTED, e->kind->line,
                       "the kernel of this solid is %s, expected inverse, the only one that solids have, in it or in "
                       "its body",
                       skf_kernel_get(e->style.kernel.type)->name);
}

skf_status skf_read_solid(skf_reader *r, skf_entry *e) {
  skf_mesh m = {0};
  skf_error why = {0};
  skf_solid *solid;
  skf_status s = settle_kernel(r, e);
  if (!s) s = skf_read_mesh(r, e->file, &m);
  if (s) return s;
  s = skf_solid_new(m.vertices, m.vertex_count, (const unsigned(*)[3])m.triangles, m.triangle_count, &solid, &why);
  skf_mesh_free(&m);
  if (s == SKF_ERR_NOMEM) return skf_error_set(r->error, s, 0, "out of memory");
  if (s)
    return skf_error_set(r->error, s, e->file->line, "mesh %s: %.200s%s",
                         skf_show(skf_node_text(&r->yaml, e->file)).text, why.text,
                         ", expected a closed mesh that faces outward");
  e->element.primitive.solid = solid;
  return SKF_OK;
}
