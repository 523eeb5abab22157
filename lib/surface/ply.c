/* SPDX-License-Identifier: MIT */
/* PLY: binary little-endian is written, all three kinds are read. */
#include "surface/files.h"
#include <string.h>

static skf_status write_ply(const skf_mesh *m, FILE *f) {
  fprintf(f, "ply\nformat binary_little_endian 1.0\ncomment skelfield %s\nelement vertex %zu\n", skf_version(),
          m->vertex_count);
  fputs("property double x\nproperty double y\nproperty double z\n", f);
  if (m->normals) fputs("property float nx\nproperty float ny\nproperty float nz\n", f);
  fprintf(f, "element face %zu\nproperty list uchar int vertex_indices\n", m->triangle_count);
  if (m->bodies) fputs("property int body\n", f);
  fputs("end_header\n", f);
  for (size_t i = 0; i < m->vertex_count; i++) {
    unsigned char row[36];
    for (int k = 0; k < 3; k++) skf_put_f64(row + 8 * k, v3_get(m->vertices[i], k));
    for (int k = 0; k < 3 && m->normals; k++) skf_put_f32(row + 24 + 4 * k, (float)v3_get(m->normals[i], k));
    fwrite(row, 1, m->normals ? 36 : 24, f);
  }
  for (size_t i = 0; i < m->triangle_count; i++) {
    unsigned char row[17] = {3};
    for (int k = 0; k < 3; k++) skf_put_u32(row + 1 + 4 * k, m->triangles[i][k]);
    if (m->bodies) skf_put_u32(row + 13, m->bodies[i]);
    fwrite(row, 1, m->bodies ? 17 : 13, f);
  }
  return SKF_OK;
}

typedef enum kind { I8, U8, I16, U16, I32, U32, F32, F64, KINDS } kind;

static const struct {
  const char *name, *alias;
  size_t size;
} kinds[KINDS] = {{"char", "int8", 1}, {"uchar", "uint8", 1}, {"short", "int16", 2},   {"ushort", "uint16", 2},
                  {"int", "int32", 4}, {"uint", "uint32", 4}, {"float", "float32", 4}, {"double", "float64", 8}};

enum { MAX_ELEMENTS = 8, MAX_PROPERTIES = 32 };

typedef struct property {
  bool list;
  kind count, type;
  int role; /* 0 1 2: x y z; 3: the list of a face's vertices; -1: skipped */
} property;

typedef struct element {
  long count;
  int properties;
  bool vertex, face;
  property property[MAX_PROPERTIES];
} element;

typedef struct reader {
  skf_scan s;
  const char *start;
  bool text, big;
  int elements;
  element element[MAX_ELEMENTS];
  skf_builder b;
  skf_error *error;
} reader;

static skf_status fail(reader *r, const char *what) {
  bool body = !r->text && r->elements && r->s.line == 0;
  if (body) return skf_file_error(r->error, SKF_ERR_PARSE, 0, "byte %zu: %s", (size_t)(r->s.p - r->start), what);
  return skf_file_error(r->error, SKF_ERR_PARSE, r->s.line, "%s", what);
}

static kind kind_of(const char *word) {
  int k = 0;
  while (k < KINDS && strcmp(word, kinds[k].name) && strcmp(word, kinds[k].alias)) k++;
  return (kind)k;
}

static skf_status read_property(reader *r) {
  char word[32];
  if (!r->elements) return fail(r, "a property before the first element");
  element *e = r->element + r->elements - 1;
  if (e->properties == MAX_PROPERTIES) return fail(r, "more than 32 properties of an element");
  property *p = e->property + e->properties++;
  *p = (property){false, U8, F32, -1};
  if (!skf_scan_word(&r->s, word, sizeof word)) return fail(r, "expected the type of the property");
  if (!strcmp(word, "list")) {
    p->list = true;
    p->count = skf_scan_word(&r->s, word, sizeof word) ? kind_of(word) : KINDS;
    if (p->count >= F32) return fail(r, "expected an integer type for the count of a list");
    if (!skf_scan_word(&r->s, word, sizeof word)) return fail(r, "expected the type of the list");
  }
  p->type = kind_of(word);
  if (p->type == KINDS) return fail(r, "unknown type, expected char, uchar, short, ushort, int, uint, float or double");
  if (!skf_scan_word(&r->s, word, sizeof word)) return fail(r, "expected the name of the property");
  if (e->vertex && !p->list && word[0] >= 'x' && word[0] <= 'z' && !word[1]) p->role = word[0] - 'x';
  if (e->face && p->list && p->type < F32 && (!strcmp(word, "vertex_indices") || !strcmp(word, "vertex_index")))
    p->role = 3;
  return SKF_OK;
}

static skf_status read_element(reader *r) {
  char word[32];
  if (r->elements == MAX_ELEMENTS) return fail(r, "more than 8 kinds of elements");
  element *e = r->element + r->elements;
  *e = (element){0};
  if (!skf_scan_word(&r->s, word, sizeof word) || !skf_scan_integer(&r->s, &e->count) || e->count < 0)
    return fail(r, "expected \"element NAME COUNT\"");
  e->vertex = !strcmp(word, "vertex"), e->face = !strcmp(word, "face");
  r->elements++;
  return SKF_OK;
}

static skf_status read_format(reader *r) {
  char word[32];
  if (!skf_scan_word(&r->s, word, sizeof word)) return fail(r, "expected the format");
  r->text = !strcmp(word, "ascii"), r->big = !strcmp(word, "binary_big_endian");
  if (!r->text && !r->big && strcmp(word, "binary_little_endian"))
    return fail(r, "unknown format, expected ascii, binary_little_endian or binary_big_endian");
  return SKF_OK;
}

static skf_status read_header(reader *r) {
  char word[32];
  bool format = false;
  skf_scan_end_line(&r->s);
  for (; skf_scan_any(&r->s); skf_scan_end_line(&r->s)) {
    skf_status s = SKF_OK;
    if (!skf_scan_word(&r->s, word, sizeof word)) return fail(r, "not a PLY header");
    if (!strcmp(word, "end_header")) {
      skf_scan_end_line(&r->s);
      return format ? SKF_OK : fail(r, "the header has no format line");
    }
    if (!strcmp(word, "format"))
      s = read_format(r), format = true;
    else if (!strcmp(word, "element"))
      s = read_element(r);
    else if (!strcmp(word, "property"))
      s = read_property(r);
    else if (strcmp(word, "comment") && strcmp(word, "obj_info"))
      s = fail(r, "unknown header line, expected format, element, property, comment or end_header");
    if (s) return s;
  }
  return fail(r, "the file ends before end_header");
}

/* Which of vertices and faces are there, with what they need; and whether the file can hold the counts. */
static skf_status check_header(reader *r) {
  bool vertex = false, face = false;
  for (int i = 0; i < r->elements; i++) {
    const element *e = r->element + i;
    unsigned roles = 0;
    double least = 0;
    for (int k = 0; k < e->properties; k++) {
      const property *p = e->property + k;
      if (p->role >= 0) roles |= 1u << p->role;
      least += r->text ? 2 : (double)kinds[p->list ? p->count : p->type].size;
    }
    if (e->vertex && (vertex || roles != 7)) return fail(r, "expected one element vertex with properties x, y and z");
    if (e->face && (face || roles != 8)) return fail(r, "expected one element face with a list vertex_indices");
    if (e->face && !vertex) return fail(r, "expected the element vertex before the element face");
    if (!e->properties && e->count) return fail(r, "an element without properties");
    if ((double)e->count * least > (double)(r->s.end - r->s.p) + 1)
      return fail(r, "the file is too short for the counts in its header");
    vertex |= e->vertex, face |= e->face;
  }
  return vertex && face ? SKF_OK : fail(r, "expected elements vertex and face");
}

static bool get_binary(reader *r, kind k, double *out) {
  unsigned char b[8];
  size_t n = kinds[k].size;
  if ((size_t)(r->s.end - r->s.p) < n) return false;
  for (size_t i = 0; i < n; i++) b[r->big ? n - 1 - i : i] = (unsigned char)r->s.p[i];
  r->s.p += n;
  uint64_t u = 0;
  for (size_t i = 0; i < n; i++) u |= (uint64_t)b[i] << 8 * i;
  if (k == F32)
    *out = skf_get_f32(b);
  else if (k == F64)
    memcpy(out, &u, 8);
  else if (k == I8)
    *out = (int8_t)u;
  else if (k == I16)
    *out = (int16_t)u;
  else if (k == I32)
    *out = (int32_t)u;
  else
    *out = (double)u;
  return true;
}

static bool get(reader *r, kind k, double *out) {
  return r->text ? skf_scan_number(&r->s, out) : get_binary(r, k, out);
}

static skf_status read_list(reader *r, const property *p) {
  double n, x;
  unsigned v[3] = {0, 0, 0};
  if (!get(r, p->count, &n)) return fail(r, "the file ends inside a list, or its count is not a number");
  if (p->role == 3 && !(n >= 3 && n == floor(n))) return fail(r, "a face has fewer than 3 corners");
  for (double i = 0; i < n; i++) {
    if (!get(r, p->type, &x)) return fail(r, "the list is shorter than its count");
    if (p->role != 3) continue;
    if (!(x >= 0 && x < (double)r->b.mesh->vertex_count && x == floor(x)))
      return fail(r, "a face names a vertex that does not exist");
    if (i > 2) v[1] = v[2];
    v[i < 2 ? (int)i : 2] = (unsigned)x;
    if (i >= 2 && !skf_build_triangle(&r->b, v[0], v[1], v[2])) return SKF_ERR_NOMEM;
  }
  return SKF_OK;
}

static skf_status read_row(reader *r, const element *e) {
  double at[3] = {0, 0, 0}, x;
  if (r->text && !skf_scan_any(&r->s)) return fail(r, "the file ends before the counts in its header are reached");
  for (int k = 0; k < e->properties; k++) {
    const property *p = e->property + k;
    skf_status s = SKF_OK;
    if (p->list)
      s = read_list(r, p);
    else if (!get(r, p->type, &x))
      s = fail(r, "expected a number, or the file ends too early");
    else if (p->role >= 0)
      at[p->role] = x;
    if (s) return s;
  }
  if (!e->vertex) return SKF_OK;
  if (!isfinite(at[0]) || !isfinite(at[1]) || !isfinite(at[2])) return fail(r, "a vertex is not finite");
  return skf_build_vertex(&r->b, v3(at[0], at[1], at[2])) ? SKF_OK : SKF_ERR_NOMEM;
}

static bool recognise(const char *data, size_t size) { return size > 4 && !memcmp(data, "ply", 3) && data[3] <= ' '; }

static skf_status read_ply(const char *data, size_t size, skf_mesh *out, skf_error *error) {
  reader r = {.s = {data, data + size, 1, 0}, .start = data, .text = true, .b = {out, 0, 0}, .error = error};
  if (!recognise(data, size)) return fail(&r, "expected \"ply\" at the start");
  skf_status s = read_header(&r);
  if (!s) s = check_header(&r);
  if (!r.text && !s) r.s.line = 0;
  for (int i = 0; i < r.elements && !s; i++)
    for (long k = 0; k < r.element[i].count && !s; k++) {
      s = read_row(&r, r.element + i);
      if (r.text && !s && skf_scan_more(&r.s)) s = fail(&r, "more numbers on the line than properties");
    }
  if (!s && (r.text ? skf_scan_any(&r.s) : r.s.p < r.s.end)) s = fail(&r, "more data than the header promised");
  return s;
}

const skf_mesh_format skf_format_ply = {".ply", "PLY with normals, binary, exact", write_ply, read_ply, recognise};
