/* SPDX-License-Identifier: MIT */
/* Polygons of a skeleton, with holes where the caller brings a way to cut them. */
#include "core/alloc.h"
#include "scene/skeleton.h"
#include <stdio.h>

static const char rings_form[] = "a list of holes, each a list of points [x, y, z]";

static skf_status keep_holes(skf_reader *r, const skf_node *value, void *into) {
  ((skf_entry *)into)->holes = value;
  return skf_expect(r, value, SKF_NODE_LIST, "holes", rings_form);
}

/* The vertices of all rings, one after the other; the first is the outline. */
typedef struct rings {
  size_t count, total;
  size_t *sizes;
  const skf_node **list;
  skf_vec3 *vertex;
} rings;

static void release(rings *g) { skf_free(g->sizes), skf_free(g->list), skf_free(g->vertex); }

static skf_status gather(skf_reader *r, const skf_entry *e, rings *g) {
  size_t most = 1 + (e->holes ? (size_t)e->holes->count : 0);
  g->sizes = skf_alloc(most, sizeof *g->sizes), g->list = skf_alloc(most, sizeof *g->list);
  if (!g->sizes || !g->list) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  const skf_node *hole = e->holes ? skf_node_first(&r->yaml, e->holes) : NULL;
  skf_status s = SKF_OK;
  for (const skf_node *list = e->list; list && !s; g->count++) {
    bool outline = g->count == 0;
    s = skf_expect(r, list, SKF_NODE_LIST, "a hole", "a list of points [x, y, z]");
    if (!s && list->count < 3)
      s = skf_error_set(r->error, SKF_ERR_PARSE, list->line, "%d vertices of a %s, expected at least 3", list->count,
                        outline ? "polygon" : "hole");
    g->list[g->count] = list, g->sizes[g->count] = (size_t)list->count, g->total += (size_t)list->count;
    list = outline ? hole : skf_node_next(&r->yaml, list);
  }
  if (s) return s;
  g->vertex = skf_alloc(g->total, sizeof *g->vertex);
  if (!g->vertex) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  skf_vec3 *to = g->vertex;
  for (size_t k = 0; k < g->count && !s; to += g->sizes[k++]) s = skf_read_points(r, g->list[k], to);
  return s;
}

/* The line and the name of a vertex. */
static skf_status refuse(skf_reader *r, skf_status s, const rings *g, size_t where, const char *why) {
  size_t k = 0;
  while (k + 1 < g->count && where >= g->sizes[k]) where -= g->sizes[k++];
  const skf_node *n = skf_node_first(&r->yaml, g->list[k]);
  for (size_t i = 0; i < where; i++) n = skf_node_next(&r->yaml, n);
  char of[32] = "";
  if (k) snprintf(of, sizeof of, " of hole %zu", k);
  return skf_error_set(r->error, s, n->line, "%s (vertex %zu%s), expected a simple and planar polygon%s", why,
                       where + 1, of, g->count > 1 ? " with its holes apart inside" : "");
}

static skf_status cut(skf_reader *r, const rings *g, unsigned (*t)[3], size_t *n) {
  const char *why = NULL;
  size_t where = 0;
  skf_ring_cutter *cutter = r->hooks->cut_rings;
  skf_status s;
  if (cutter)
    s = skf_polygon_cut(g->vertex, g->count, g->sizes, cutter, t, n, &why, &where);
  else
    s = skf_polygon_triangulate(g->vertex, g->total, t, &why, &where), *n = g->total - 2;
  if (!s) return s;
  return why ? refuse(r, s, g, where, why) : skf_error_set(r->error, s, 0, "out of memory");
}

skf_status skf_expand_polygon(skf_reader *r, const skf_entry *e, skf_pieces *into) {
  rings g = {.count = 0};
  if (e->holes && e->holes->count && !r->hooks->cut_rings)
    return skf_error_set(r->error, SKF_ERR_UNSUPPORTED, e->holes->line,
                         "holes need CGAL, which this build has not, expected a polygon without holes");
  skf_status s = gather(r, e, &g);
  unsigned(*t)[3] = s ? NULL : skf_alloc(g.total + 2 * g.count, sizeof *t);
  if (!s && !t) s = skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  size_t n = 0;
  if (!s) s = cut(r, &g, t, &n);
  for (size_t i = 0; i < n && !s; i++) {
    const skf_vec3 *v = g.vertex;
    s = skf_add_piece(
        r, e, &(skf_primitive){.shape = SKF_TRIANGLE, .triangle.vertices = {v[t[i][0]], v[t[i][1]], v[t[i][2]]}}, into);
  }
  skf_free(t), release(&g);
  return s;
}

const skf_key skf_polygon_keys[SKF_POLYGON_KEYS] = {
    {"vertices", "L", "three or more, in order; within 1e-6 of its size in a plane", SKF_KEY_OTHER, true,
     .read = skf_keep_points, .form = "a list of points [x, y, z]"},
    {"holes", "L", "each as vertices; apart from each other, inside; needs CGAL", SKF_KEY_OTHER, .read = keep_holes,
     .form = "a list of lists of points"},
};
