/* SPDX-License-Identifier: MIT */
/* The registry of mesh file formats, and what they share. */
#include "surface/files.h"
#include <stdarg.h>
#include <string.h>
#include <strings.h>

static const skf_mesh_format *const registry[] = {&skf_format_ply, &skf_format_obj, &skf_format_off, &skf_format_stl};

const skf_mesh_format *skf_mesh_format_get(int i) {
  return i >= 0 && i < (int)(sizeof registry / sizeof *registry) ? registry[i] : NULL;
}

const skf_mesh_format *skf_mesh_format_find(const char *path) {
  const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
  for (int i = 0; dot && skf_mesh_format_get(i); i++)
    if (!strcasecmp(dot, registry[i]->extension)) return registry[i];
  return NULL;
}

skf_status skf_file_error(skf_error *e, skf_status status, long line, const char *format, ...) {
  if (!e) return status;
  va_list args;
  va_start(args, format);
  e->status = status, e->line = line;
  vsnprintf(e->text, sizeof e->text, format, args);
  va_end(args);
  return status;
}

skf_status skf_mesh_write(const skf_mesh *mesh, const skf_mesh_format *format, FILE *file) {
  skf_status s = format->write(mesh, file);
  return s ? s : ferror(file) ? SKF_ERR_IO : SKF_OK;
}

/* The whole file with a NUL behind it. */
static skf_status slurp(const char *path, char **out, size_t *size, skf_error *error) {
  FILE *f = fopen(path, "rb");
  if (!f) return skf_file_error(error, SKF_ERR_IO, 0, "cannot open the file");
  size_t n = 0, capacity = 1 << 16;
  char *data = skf_alloc(capacity, 1);
  while (data) {
    n += fread(data + n, 1, capacity - 1 - n, f);
    if (n < capacity - 1) break;
    char *more = skf_realloc(data, 2 * capacity, 1);
    if (!more) skf_free(data);
    data = more, capacity *= 2;
  }
  bool bad = ferror(f);
  fclose(f);
  if (!data) return skf_file_error(error, SKF_ERR_NOMEM, 0, "out of memory");
  if (bad) return skf_free(data), skf_file_error(error, SKF_ERR_IO, 0, "cannot read the file");
  data[n] = 0;
  *out = data, *size = n;
  return SKF_OK;
}

skf_status skf_mesh_read(const char *path, skf_mesh *out, skf_error *error) {
  char *data = NULL;
  size_t size = 0;
  *out = (skf_mesh){0};
  skf_status s = slurp(path, &data, &size, error);
  if (s) return s;
  const skf_mesh_format *format = NULL;
  for (int i = 0; !format && skf_mesh_format_get(i); i++)
    if (registry[i]->recognise(data, size)) format = registry[i];
  if (!format) format = skf_mesh_format_find(path);
  if (!size)
    s = skf_file_error(error, SKF_ERR_PARSE, 0, "the file is empty, expected a PLY, OBJ, OFF or STL mesh");
  else if (!format)
    s = skf_file_error(error, SKF_ERR_PARSE, 1, "not a mesh: expected a PLY, OBJ, OFF or STL file");
  else
    s = format->read(data, size, out, error);
  if (!s && !out->triangle_count) s = skf_file_error(error, SKF_ERR_PARSE, 0, "the mesh has no faces");
  if (s == SKF_ERR_NOMEM) skf_file_error(error, s, 0, "out of memory");
  if (s) skf_mesh_free(out);
  skf_free(data);
  return s;
}

static bool room(void *array, size_t count, size_t *capacity, size_t size) {
  void *p;
  if (count < *capacity) return true;
  size_t more = *capacity ? 2 * *capacity : 1024;
  memcpy(&p, array, sizeof p);
  p = count < 0xfffffffeu ? skf_realloc(p, more, size) : NULL;
  if (p) memcpy(array, &p, sizeof p), *capacity = more;
  return p;
}

bool skf_build_vertex(skf_builder *b, skf_vec3 p) {
  skf_mesh *m = b->mesh;
  if (!room(&m->vertices, m->vertex_count, &b->vertex_capacity, sizeof p)) return false;
  m->vertices[m->vertex_count++] = p;
  return true;
}

bool skf_build_triangle(skf_builder *b, unsigned i, unsigned j, unsigned k) {
  skf_mesh *m = b->mesh;
  if (!room(&m->triangles, m->triangle_count, &b->triangle_capacity, sizeof *m->triangles)) return false;
  unsigned *t = m->triangles[m->triangle_count++];
  t[0] = i, t[1] = j, t[2] = k;
  return true;
}

/* Length of a line's end that the next line continues, 0: there is none at p. */
static int joint(const skf_scan *s, const char *p) {
  if (!s->joins || *p != '\\') return 0;
  int n = p[1] == '\r' ? 2 : 1;
  return p + n < s->end && p[n] == '\n' ? n + 1 : 0;
}

bool skf_scan_more(skf_scan *s) {
  int n = 0;
  while (s->p < s->end && ((n = joint(s, s->p)) || *s->p == ' ' || *s->p == '\t' || *s->p == '\r'))
    s->p += n ? n : 1, s->line += n > 0;
  return s->p < s->end && *s->p != '\n' && !(s->comment && *s->p == s->comment);
}

void skf_scan_end_line(skf_scan *s) {
  bool comment = false; /* which ends with its line */
  while (s->p < s->end && *s->p != '\n') {
    comment = comment || (s->comment && *s->p == s->comment);
    int n = comment ? 0 : joint(s, s->p);
    s->p += n ? n : 1, s->line += n > 0;
  }
  if (s->p < s->end) s->p++, s->line++;
}

bool skf_scan_any(skf_scan *s) {
  while (!skf_scan_more(s)) {
    if (s->p >= s->end) return false;
    skf_scan_end_line(s);
  }
  return true;
}

static bool blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == 0; }

bool skf_scan_word(skf_scan *s, char *word, size_t size) {
  size_t n = 0;
  if (!skf_scan_more(s)) return false;
  for (; s->p < s->end && !blank(*s->p) && !joint(s, s->p); s->p++)
    if (n + 1 < size) word[n++] = *s->p;
  word[n] = 0;
  if (!n && s->p < s->end) s->p++; /* a NUL in the text */
  return n > 0;
}

bool skf_scan_number(skf_scan *s, double *out) {
  size_t used;
  if (!skf_scan_more(s) || skf_number_read(s->p, &used, out) || !(blank(s->p[used]) || joint(s, s->p + used)))
    return false;
  s->p += used;
  return isfinite(*out);
}

bool skf_scan_integer(skf_scan *s, long *out) {
  double x;
  if (!skf_scan_number(s, &x) || x != floor(x) || fabs(x) > 1e15) return false;
  *out = (long)x;
  return true;
}

void skf_put_f32(unsigned char *b, float x) {
  uint32_t u;
  memcpy(&u, &x, 4);
  skf_put_u32(b, u);
}

void skf_put_f64(unsigned char *b, double x) {
  uint64_t u;
  memcpy(&u, &x, 8);
  skf_put_u32(b, (uint32_t)u), skf_put_u32(b + 4, (uint32_t)(u >> 32));
}

float skf_get_f32(const unsigned char *b) {
  uint32_t u = skf_get_u32(b);
  float x;
  memcpy(&x, &u, 4);
  return x;
}

void skf_write_row(FILE *f, const char *start, int n, const double *x) {
  char text[SKF_NUMBER_SIZE];
  fputs(start, f);
  for (int i = 0; i < n; i++) {
    if (i || *start) fputc(' ', f);
    fwrite(text, 1, skf_number_write(text, x[i]), f);
  }
  fputc('\n', f);
}
