/* SPDX-License-Identifier: MIT */
/* STL: loose triangles in single precision; binary is written, both kinds are read. */
#include "surface/files.h"
#include <float.h>
#include <string.h>

static skf_status write_stl(const skf_mesh *m, FILE *f) {
  unsigned char head[84] = {0};
  if (m->triangle_count > 0xffffffffu) return SKF_ERR_CAPACITY;
  snprintf((char *)head, 80, "skelfield %s, binary STL", skf_version());
  skf_put_u32(head + 80, (uint32_t)m->triangle_count);
  fwrite(head, 1, sizeof head, f);
  for (size_t i = 0; i < m->triangle_count; i++) {
    unsigned char row[50] = {0};
    const unsigned *t = m->triangles[i];
    skf_vec3 a = m->vertices[t[0]], b = m->vertices[t[1]], c = m->vertices[t[2]];
    skf_vec3 v[4] = {v3_unit(v3_cross(v3_sub(b, a), v3_sub(c, a))), a, b, c};
    for (int k = 0; k < 12; k++) {
      double x = v3_get(v[k / 3], k % 3);
      if (fabs(x) > FLT_MAX) return SKF_ERR_RANGE;
      skf_put_f32(row + 4 * k, (float)x);
    }
    if (m->bodies) row[48] = (unsigned char)m->bodies[i], row[49] = (unsigned char)(m->bodies[i] >> 8);
    fwrite(row, 1, sizeof row, f);
  }
  return SKF_OK;
}

static bool is_binary(const char *data, size_t size) {
  return size >= 84 && size == 84 + 50 * (size_t)skf_get_u32((const unsigned char *)data + 80);
}

static bool recognise(const char *data, size_t size) {
  return is_binary(data, size) || (size > 6 && !memcmp(data, "solid", 5) && strstr(data, "facet"));
}

/* Joins vertices that are equal to the last bit. */
typedef struct joiner {
  skf_builder b;
  unsigned *table; /* index + 1 */
  size_t mask;
} joiner;

static size_t slot_of(const joiner *j, skf_vec3 p) {
  uint64_t h = 0;
  for (int i = 0; i < 3; i++) {
    double x = v3_get(p, i);
    uint64_t u;
    memcpy(&u, &x, 8);
    h = (h ^ u) * 0x9e3779b97f4a7c15u;
    h ^= h >> 29;
  }
  for (size_t s = (size_t)h & j->mask;; s = (s + 1) & j->mask) {
    if (!j->table[s]) return s;
    const skf_vec3 *q = j->b.mesh->vertices + j->table[s] - 1;
    if (q->x == p.x && q->y == p.y && q->z == p.z) return s;
  }
}

static bool grow(joiner *j) {
  size_t slots = j->mask ? 2 * (j->mask + 1) : 1024;
  unsigned *table = skf_alloc(slots, sizeof *table);
  if (!table) return false;
  skf_free(j->table);
  j->table = table, j->mask = slots - 1;
  for (size_t i = 0; i < j->b.mesh->vertex_count; i++) table[slot_of(j, j->b.mesh->vertices[i])] = (unsigned)i + 1;
  return true;
}

static bool join(joiner *j, skf_vec3 p, unsigned *out) {
  p = v3(p.x + 0.0, p.y + 0.0, p.z + 0.0); /* -0 is 0 */
  if (2 * j->b.mesh->vertex_count >= j->mask && !grow(j)) return false;
  size_t s = slot_of(j, p);
  if (!j->table[s]) {
    if (!skf_build_vertex(&j->b, p)) return false;
    j->table[s] = (unsigned)j->b.mesh->vertex_count;
  }
  *out = j->table[s] - 1;
  return true;
}

static skf_status read_binary(const char *data, size_t size, joiner *j, skf_error *e) {
  for (size_t at = 84; at < size; at += 50) {
    unsigned v[3];
    for (int k = 0; k < 3; k++) {
      const unsigned char *p = (const unsigned char *)data + at + 12 + 12 * k;
      skf_vec3 x = v3(skf_get_f32(p), skf_get_f32(p + 4), skf_get_f32(p + 8));
      if (!v3_finite(x))
        return skf_file_error(e, SKF_ERR_PARSE, 0, "byte %zu: expected finite coordinates", at + 12 + 12 * (size_t)k);
      if (!join(j, x, v + k)) return SKF_ERR_NOMEM;
    }
    if (!skf_build_triangle(&j->b, v[0], v[1], v[2])) return SKF_ERR_NOMEM;
  }
  return SKF_OK;
}

static bool expect(skf_scan *s, const char *what) {
  char word[16];
  return skf_scan_any(s) && skf_scan_word(s, word, sizeof word) && !strcmp(word, what);
}

static skf_status read_facet(skf_scan *s, joiner *j, skf_error *e) {
  unsigned v[3];
  skf_scan_end_line(s); /* the normal */
  if (!expect(s, "outer") || !expect(s, "loop"))
    return skf_file_error(e, SKF_ERR_PARSE, s->line, "expected \"outer loop\"");
  for (int k = 0; k < 3; k++) {
    double x[3];
    if (!expect(s, "vertex")) return skf_file_error(e, SKF_ERR_PARSE, s->line, "expected \"vertex x y z\"");
    for (int i = 0; i < 3; i++)
      if (!skf_scan_number(s, x + i))
        return skf_file_error(e, SKF_ERR_PARSE, s->line, "a vertex needs three finite numbers");
    if (!join(j, v3(x[0], x[1], x[2]), v + k)) return SKF_ERR_NOMEM;
  }
  if (!expect(s, "endloop") || !expect(s, "endfacet"))
    return skf_file_error(e, SKF_ERR_PARSE, s->line, "expected \"endloop\" and \"endfacet\" after three vertices");
  return skf_build_triangle(&j->b, v[0], v[1], v[2]) ? SKF_OK : SKF_ERR_NOMEM;
}

static skf_status read_text(const char *data, size_t size, joiner *j, skf_error *e) {
  skf_scan s = {data, data + size, 1, 0};
  char word[16];
  bool open = false;
  while (skf_scan_any(&s)) {
    if (!skf_scan_word(&s, word, sizeof word)) return skf_file_error(e, SKF_ERR_PARSE, s.line, "not text");
    skf_status r = SKF_OK;
    if (!strcmp(word, "solid"))
      open = true, skf_scan_end_line(&s);
    else if (!strcmp(word, "endsolid"))
      open = false, skf_scan_end_line(&s);
    else if (!strcmp(word, "facet") && open)
      r = read_facet(&s, j, e);
    else
      r = skf_file_error(e, SKF_ERR_PARSE, s.line, "unknown word \"%s\", expected facet or endsolid", word);
    if (r) return r;
  }
  return open ? skf_file_error(e, SKF_ERR_PARSE, s.line, "the file ends before \"endsolid\"") : SKF_OK;
}

static skf_status read_stl(const char *data, size_t size, skf_mesh *out, skf_error *e) {
  joiner j = {{out, 0, 0}, NULL, 0};
  skf_status s = SKF_ERR_PARSE;
  if (is_binary(data, size))
    s = read_binary(data, size, &j, e);
  else if (size >= 5 && !memcmp(data, "solid", 5))
    s = read_text(data, size, &j, e);
  else if (size < 84)
    skf_file_error(e, s, 0, "binary STL of %zu bytes, expected at least 84", size);
  else
    skf_file_error(e, s, 0, "binary STL of %zu bytes, expected 84 + 50 * %u as byte 80 says", size,
                   skf_get_u32((const unsigned char *)data + 80));
  skf_free(j.table);
  return s;
}

const skf_mesh_format skf_format_stl = {".stl", "STL, binary, single precision", write_stl, read_stl, recognise};
