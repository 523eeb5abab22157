/* SPDX-License-Identifier: MIT */
/* OFF: text; "OFF", which may be left out or tell that vertices carry more than their place; counts, vertices, then
   polygons. */
#include "surface/files.h"
#include <string.h>

static skf_status write_off(const skf_mesh *m, FILE *f) {
  fprintf(f, "OFF\n%zu %zu 0\n", m->vertex_count, m->triangle_count);
  for (size_t i = 0; i < m->vertex_count; i++) skf_write_row(f, "", 3, &m->vertices[i].x);
  for (size_t i = 0; i < m->triangle_count; i++) {
    const unsigned *t = m->triangles[i];
    fprintf(f, "3 %u %u %u\n", t[0], t[1], t[2]);
  }
  return SKF_OK;
}

/* Texture, colours, normals stand behind the place, on its line. */
static const char *const headers[] = {"OFF", "COFF", "NOFF", "CNOFF", "STOFF", "STCOFF", "STNOFF", "STCNOFF"};

static bool is_header(const char *word) {
  for (size_t i = 0; i < sizeof headers / sizeof *headers; i++)
    if (!strcmp(word, headers[i])) return true;
  return false;
}

static bool recognise(const char *data, size_t size) {
  skf_scan s = {data, data + size, 1, '#'};
  char word[16];
  return size >= 4 && !memcmp(data, "OFF", 3) ? true : skf_scan_word(&s, word, sizeof word) && is_header(word);
}

static skf_status read_vertices(skf_scan *s, skf_builder *b, long n, skf_error *e) {
  for (long i = 0; i < n; i++) {
    double x[3];
    if (!skf_scan_any(s))
      return skf_file_error(e, SKF_ERR_PARSE, s->line, "the file ends after %ld of %ld vertices", i, n);
    for (int k = 0; k < 3; k++)
      if (!skf_scan_number(s, x + k))
        return skf_file_error(e, SKF_ERR_PARSE, s->line, "vertex %ld: expected three finite numbers", i);
    if (!skf_build_vertex(b, v3(x[0], x[1], x[2]))) return SKF_ERR_NOMEM;
    skf_scan_end_line(s); /* colours */
  }
  return SKF_OK;
}

static skf_status read_faces(skf_scan *s, skf_builder *b, long n, long vertices, skf_error *e) {
  for (long i = 0; i < n; i++) {
    long corners, v[3] = {0, 0, 0};
    if (!skf_scan_any(s))
      return skf_file_error(e, SKF_ERR_PARSE, s->line, "the file ends after %ld of %ld faces", i, n);
    if (!skf_scan_integer(s, &corners) || corners < 3)
      return skf_file_error(e, SKF_ERR_PARSE, s->line, "face %ld: expected a count of at least 3 corners", i);
    for (long k = 0; k < corners; k++) {
      long *at = v + (k < 2 ? k : 2);
      if (k > 2) v[1] = v[2];
      if (!skf_scan_integer(s, at))
        return skf_file_error(e, SKF_ERR_PARSE, s->line, "face %ld: expected %ld vertex numbers", i, corners);
      if (*at < 0 || *at >= vertices)
        return skf_file_error(e, SKF_ERR_RANGE, s->line, "face %ld: vertex %ld is not one of 0 to %ld", i, *at,
                              vertices - 1);
      if (k >= 2 && !skf_build_triangle(b, (unsigned)v[0], (unsigned)v[1], (unsigned)v[2])) return SKF_ERR_NOMEM;
    }
    skf_scan_end_line(s); /* colours */
  }
  return SKF_OK;
}

static skf_status read_off(const char *data, size_t size, skf_mesh *out, skf_error *e) {
  skf_scan s = {data, data + size, 1, '#'};
  skf_builder b = {out, 0, 0};
  char word[16];
  long n[3];
  if (skf_scan_any(&s) && *s.p >= '0' && *s.p <= '9')
    ; /* the counts at once */
  else if (!skf_scan_word(&s, word, sizeof word) || !is_header(word))
    return skf_file_error(e, SKF_ERR_PARSE, s.line, "expected \"OFF\" at the start");
  if (skf_scan_more(&s) && !strncmp(s.p, "BINARY", 6))
    return skf_file_error(e, SKF_ERR_UNSUPPORTED, s.line, "binary OFF is not read, expected text");
  for (int k = 0; k < 3; k++)
    if (!skf_scan_any(&s) || !skf_scan_integer(&s, n + k) || n[k] < 0)
      return skf_file_error(e, SKF_ERR_PARSE, s.line, "expected the counts of vertices, faces and edges");
  /* A vertex or a face takes at least six bytes. */
  if ((double)n[0] + (double)n[1] > (double)size / 6 + 2)
    return skf_file_error(e, SKF_ERR_PARSE, s.line, "the file is too short for %ld vertices and %ld faces", n[0], n[1]);
  skf_status r = read_vertices(&s, &b, n[0], e);
  if (!r) r = read_faces(&s, &b, n[1], n[0], e);
  if (!r && skf_scan_any(&s))
    r = skf_file_error(e, SKF_ERR_PARSE, s.line, "more than the %ld faces that the header promised", n[1]);
  return r;
}

const skf_mesh_format skf_format_off = {".off", "Object File Format, text, exact", write_off, read_off, recognise};
