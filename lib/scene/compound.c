/* SPDX-License-Identifier: MIT */
/* Entries of a skeleton that stand for several primitives; curves and polygons have files of their own. */
#include "scene/skeleton.h"
#include "core/alloc.h"
#include "core/vec3.h"
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static const char points_form[] = "a list of points [x, y, z]";

skf_status skf_keep_points(skf_reader *r, const skf_node *value, void *into) {
  ((skf_entry *)into)->list = value;
  return skf_expect(r, value, SKF_NODE_LIST, "the points", points_form);
}

skf_status skf_keep_file(skf_reader *r, const skf_node *value, void *into) {
  static const char form[] = "the name of a mesh file";
  ((skf_entry *)into)->file = value;
  skf_status s = skf_expect(r, value, SKF_NODE_SCALAR, "file", form);
  if (s || *skf_node_text(&r->yaml, value)) return s;
  return skf_error_set(r->error, SKF_ERR_PARSE, value->line, "file is empty, expected %s", form);
}

static skf_status read_closed(skf_reader *r, const skf_node *value, void *into) {
  static const char *const words[] = {"false", "true"};
  int chosen = 0;
  skf_status s = skf_read_choice(r, value, "closed", words, 2, &chosen);
  ((skf_entry *)into)->closed = chosen;
  return s;
}

skf_status skf_read_points(skf_reader *r, const skf_node *list, skf_vec3 *out) {
  const skf_key one = {.name = "a point", .type = SKF_KEY_VECTOR};
  skf_status s = SKF_OK;
  for (const skf_node *n = skf_node_first(&r->yaml, list); n && !s; n = skf_node_next(&r->yaml, n))
    s = skf_read_vector(r, n, &one, out++);
  return s;
}

/* The points of a list; the caller frees them. */
static skf_status read_points(skf_reader *r, const skf_entry *e, int least, const char *what, skf_vec3 **out) {
  if (e->list->count < least)
    return skf_error_set(r->error, SKF_ERR_PARSE, e->list->line, "%d %s, expected at least %d", e->list->count, what,
                         least);
  *out = skf_alloc((size_t)e->list->count, sizeof **out);
  if (!*out) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  skf_status s = skf_read_points(r, e->list, *out);
  if (s) skf_free(*out);
  return s;
}

static long line_of_entry(const skf_reader *r, const skf_node *list, size_t i) {
  const skf_node *n = skf_node_first(&r->yaml, list);
  while (i--) n = skf_node_next(&r->yaml, n);
  return n->line;
}

static skf_status expand_circle(skf_reader *r, const skf_entry *e, skf_pieces *into) {
  const skf_arc *a = &e->element.primitive.arc;
  return skf_add_piece(r, e, &(skf_primitive){.shape = SKF_ARC, .arc = skf_arc_circle(a->center, a->normal, a->radius)},
                       into);
}

static skf_status expand_polyline(skf_reader *r, const skf_entry *e, skf_pieces *into) {
  skf_vec3 *v;
  skf_status s = read_points(r, e, e->closed ? 3 : 2, e->closed ? "points of a closed polyline" : "points", &v);
  if (s) return s;
  size_t n = (size_t)e->list->count;
  for (size_t i = 0; i < (e->closed ? n : n - 1) && !s; i++) {
    size_t j = (i + 1) % n;
    if (v3_dist(v[i], v[j]) > 0)
      s = skf_add_piece(r, e, &(skf_primitive){.shape = SKF_SEGMENT, .segment = {v[i], v[j]}}, into);
    else
      s = skf_error_set(r->error, SKF_ERR_DEGENERATE, line_of_entry(r, e->list, j ? j : i),
                        j ? "a point equals the one before, expected another one"
                          : "the last point equals the first, expected another one (closed joins them)");
  }
  skf_free(v);
  return s;
}

/* Each face as two triangles, counter-clockwise from outside; corner i is at (i & 1, i >> 1 & 1, i >> 2). */
static skf_status expand_box(skf_reader *r, const skf_entry *e, skf_pieces *into) {
  static const unsigned char faces[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                             {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  skf_vec3 n = v3_unit(e->axis), corner[8];
  if (!(v3_norm(n) > 0))
    return skf_error_set(r->error, SKF_ERR_DEGENERATE, skf_map_line(r, e->map, "axis"),
                         "axis is the zero vector, expected a direction");
  for (int i = 0; i < 3; i++)
    if (!(v3_get(e->size, i) > 0))
      return skf_error_set(r->error, SKF_ERR_RANGE, skf_map_line(r, e->map, "size"),
                           "size of a box is %g along %c, expected three lengths > 0", v3_get(e->size, i), "xyz"[i]);
  double c = cos(e->angle), s = sin(e->angle);
  for (int i = 0; i < 8; i++) {
    skf_vec3 v =
        v3((i & 1 ? 0.5 : -0.5) * e->size.x, (i & 2 ? 0.5 : -0.5) * e->size.y, (i & 4 ? 0.5 : -0.5) * e->size.z);
    if (e->angle != 0) v = v3_mad(v3_mad(v3_scale(c, v), s, v3_cross(n, v)), (1 - c) * v3_dot(n, v), n);
    corner[i] = v3_add(e->center, v);
  }
  skf_status status = SKF_OK;
  for (int i = 0; i < 12 && !status; i++) {
    const unsigned char *f = faces[i];
    status = skf_add_piece(
        r, e, &(skf_primitive){.shape = SKF_TRIANGLE, .triangle.vertices = {corner[f[0]], corner[f[1]], corner[f[2]]}},
        into);
  }
  return status;
}

/* Its messages get the file's name in front, and what was expected where they do not tell. */
skf_status skf_read_mesh(skf_reader *r, const skf_node *file, skf_mesh *mesh) {
  const char *path, *name = skf_node_text(&r->yaml, file);
  skf_status s = skf_file_path(r, file, &path);
  if (s) return s;
  struct stat about;
  int gone = stat(path, &about) ? errno : 0;
  skf_error why = {0};
  s = SKF_ERR_IO;
  if (gone || !S_ISREG(about.st_mode)) /* a pipe or a device would be read for ever */
    snprintf(why.text, sizeof why.text, "%s", gone ? strerror(gone) : "not a regular file");
  else
    s = skf_mesh_read(path, mesh, &why);
  if (s == SKF_ERR_NOMEM) return skf_error_set(r->error, s, 0, "out of memory");
  if (!s) return s;
  char line[32] = "";
  if (why.line > 0) snprintf(line, sizeof line, "%ld:", why.line);
  return skf_error_set(r->error, s, file->line, "mesh %s:%s %.120s%s", skf_show(name).text, line, why.text,
                       strstr(why.text, "expected") ? "" : ", expected a PLY, OBJ, OFF or STL mesh");
}

static skf_status expand_mesh(skf_reader *r, const skf_entry *e, skf_pieces *into) {
  skf_mesh m = {0};
  skf_status s = skf_read_mesh(r, e->file, &m);
  for (size_t i = 0; i < m.triangle_count && !s; i++) {
    const unsigned *t = m.triangles[i];
    skf_primitive p = {.shape = SKF_TRIANGLE,
                       .triangle.vertices = {m.vertices[t[0]], m.vertices[t[1]], m.vertices[t[2]]}};
    if (skf_primitive_check(&p, NULL) == SKF_ERR_DEGENERATE)
      s = skf_error_set(r->error, SKF_ERR_DEGENERATE, e->file->line,
                        "triangle %zu of the %zu of mesh %s has no area (vertices %u, %u, %u from 0), expected only "
                        "triangles with one",
                        i + 1, m.triangle_count, skf_show(skf_node_text(&r->yaml, e->file)).text, t[0], t[1], t[2]);
    else
      s = skf_add_piece(r, e, &p, into);
  }
  skf_mesh_free(&m);
  return s;
}

static const skf_key circle_keys[] = {
    {"center", "L", "its centre", SKF_KEY_VECTOR, true, .offset = offsetof(skf_entry, element.primitive.arc.center)},
    {"normal", "1", "its axis; it is normalised", SKF_KEY_VECTOR, true,
     .offset = offsetof(skf_entry, element.primitive.arc.normal)},
    {"radius", "L", "its radius", SKF_KEY_NUMBER, true, .offset = offsetof(skf_entry, element.primitive.arc.radius),
     .range = &skf_positive},
};

static const skf_key polyline_keys[] = {
    {"points", "L", "two or more; three or more when closed", SKF_KEY_OTHER, true, .read = skf_keep_points,
     .form = points_form},
    {"closed", NULL, "joins the last point to the first (default: false)", SKF_KEY_OTHER, .read = read_closed,
     .form = "true or false"},
};

static const skf_key box_keys[] = {
    {"center", "L", "its centre", SKF_KEY_VECTOR, true, .offset = offsetof(skf_entry, center)},
    {"size", "L", "its lengths along its x, y and z, each > 0", SKF_KEY_VECTOR, true,
     .offset = offsetof(skf_entry, size)},
    {"axis", "1", "it is turned about this axis through its centre (default: z)", SKF_KEY_VECTOR, false,
     .offset = offsetof(skf_entry, axis)},
    {"angle", "deg", "by so much, right-handed (default: 0)", SKF_KEY_ANGLE, false,
     .offset = offsetof(skf_entry, angle)},
};

static const skf_key mesh_keys[] = {
    {"file", NULL, "PLY, OBJ, OFF or STL, relative to the scene's folder", SKF_KEY_OTHER, true, .read = skf_keep_file,
     .form = "a file name"},
};

const skf_compound skf_compounds[SKF_COMPOUND_COUNT] = {
    {{"circle", "a full circle, as one arc", circle_keys, 3}, expand_circle},
    {{"polyline", "segments from point to point", polyline_keys, 2}, expand_polyline},
    {{"polygon", "a flat simple polygon, convex or not, with or without holes, cut into triangles", skf_polygon_keys,
      SKF_POLYGON_KEYS},
     skf_expand_polygon},
    {{"bezier", "a cubic Bezier curve, as a chain of arcs within its tolerance", skf_bezier_keys, SKF_BEZIER_KEYS},
     skf_expand_bezier},
    {{"helix", "a helix, or a conical one, as a chain of arcs within its tolerance", skf_helix_keys, SKF_HELIX_KEYS},
     skf_expand_helix},
    {{"spiral", "a plane spiral of Archimedes, or a logarithmic one, as a chain of arcs within its tolerance",
      skf_spiral_keys, SKF_SPIRAL_KEYS},
     skf_expand_helix},
    {{"box", "the surface of a box, as twelve triangles", box_keys, 4}, expand_box},
    {{"mesh", "the triangles of a mesh file, open or closed; faces with more corners are cut into fans", mesh_keys, 1},
     expand_mesh},
};
