/* SPDX-License-Identifier: MIT */
/* Wavefront OBJ: text; vertices, normals and polygons line by line. */
#include "surface/files.h"
#include <string.h>

static skf_status write_obj(const skf_mesh *m, FILE *f) {
  fprintf(f, "# skelfield %s\n", skf_version());
  for (size_t i = 0; i < m->vertex_count; i++) skf_write_row(f, "v", 3, &m->vertices[i].x);
  for (size_t i = 0; i < m->vertex_count && m->normals; i++) skf_write_row(f, "vn", 3, &m->normals[i].x);
  for (size_t i = 0; i < m->triangle_count; i++) {
    const unsigned *t = m->triangles[i];
    unsigned a = t[0] + 1, b = t[1] + 1, c = t[2] + 1;
    if (m->bodies && (i == 0 || m->bodies[i] != m->bodies[i - 1])) fprintf(f, "g body_%u\n", m->bodies[i]);
    if (m->normals)
      fprintf(f, "f %u//%u %u//%u %u//%u\n", a, a, b, b, c, c);
    else
      fprintf(f, "f %u %u %u\n", a, b, c);
  }
  return SKF_OK;
}

/* Keywords that carry no triangles of the surface. */
static const char *const ignored[] = {"vn", "vt", "vp", "g", "o", "s", "usemtl", "mtllib", "l", "p"};

static bool is_ignored(const char *word) {
  for (size_t i = 0; i < sizeof ignored / sizeof *ignored; i++)
    if (!strcmp(word, ignored[i])) return true;
  return false;
}

/* Text whose first words are OBJ's. */
static bool recognise(const char *data, size_t size) {
  skf_scan s = {data, data + size, 1, '#', true};
  char word[8];
  while (skf_scan_any(&s) && skf_scan_word(&s, word, sizeof word)) {
    double x;
    if (!strcmp(word, "v")) return skf_scan_number(&s, &x);
    if (!is_ignored(word)) return false;
    skf_scan_end_line(&s);
  }
  return false;
}

/* A corner "7", "7/2", "7//3", "7/2/3" or with negative numbers that count back. */
static bool corner(const char *word, size_t count, unsigned *out) {
  double x;
  size_t used;
  if (skf_number_read(word, &used, &x) || x != floor(x) || fabs(x) > 4e9) return false;
  for (const char *p = word + used; *p; p++)
    if (!strchr("/-0123456789", *p)) return false;
  if (word[used] && word[used] != '/') return false;
  double i = x < 0 ? (double)count + x : x - 1;
  if (!(i >= 0 && i < (double)count) || x == 0) return false;
  *out = (unsigned)i;
  return true;
}

static skf_status read_face(skf_scan *s, skf_builder *b, skf_error *e) {
  char word[64];
  unsigned v[3] = {0, 0, 0};
  int n = 0;
  for (; skf_scan_word(s, word, sizeof word); n++) {
    if (n > 2) v[1] = v[2];
    if (!corner(word, b->mesh->vertex_count, v + (n < 2 ? n : 2)))
      return skf_file_error(e, SKF_ERR_RANGE, s->line,
                            "face corner \"%.32s\" does not name one of the %zu vertices above", word,
                            b->mesh->vertex_count);
    if (n >= 2 && !skf_build_triangle(b, v[0], v[1], v[2])) return SKF_ERR_NOMEM;
  }
  if (n < 3) return skf_file_error(e, SKF_ERR_PARSE, s->line, "a face has %d corners, expected at least 3", n);
  return SKF_OK;
}

static skf_status read_obj(const char *data, size_t size, skf_mesh *out, skf_error *e) {
  skf_builder b = {out, 0, 0};
  char word[32];
  for (skf_scan s = {data, data + size, 1, '#', true}; skf_scan_any(&s); skf_scan_end_line(&s)) {
    if (!skf_scan_word(&s, word, sizeof word))
      return skf_file_error(e, SKF_ERR_PARSE, s.line, "not text, expected Wavefront OBJ");
    if (!strcmp(word, "v")) {
      double x[3];
      for (int k = 0; k < 3; k++)
        if (!skf_scan_number(&s, x + k))
          return skf_file_error(e, SKF_ERR_PARSE, s.line, "a vertex needs three finite numbers");
      if (!skf_build_vertex(&b, v3(x[0], x[1], x[2]))) return SKF_ERR_NOMEM;
    } else if (!strcmp(word, "f")) {
      skf_status r = read_face(&s, &b, e);
      if (r) return r;
    } else if (!is_ignored(word))
      return skf_file_error(e, SKF_ERR_PARSE, s.line, "unknown keyword \"%s\", expected v, vn, vt, f, g, o, s, ...",
                            word);
  }
  return SKF_OK;
}

const skf_mesh_format skf_format_obj = {".obj", "Wavefront OBJ with normals, text, exact", write_obj, read_obj,
                                        recognise};
