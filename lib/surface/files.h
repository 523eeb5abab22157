/* SPDX-License-Identifier: MIT */
/* What the mesh file formats share: rows of the registry, building a mesh, scanning text, writing bytes. */
#ifndef SKF_SURFACE_FILES_H
#define SKF_SURFACE_FILES_H

#include "core/alloc.h"
#include "core/number.h"
#include "core/vec3.h"
#include "skelfield/surface.h"
#include <stdint.h>

extern const skf_mesh_format skf_format_ply, skf_format_obj, skf_format_off, skf_format_stl;

/* Fills in the error and returns its status. */
skf_status skf_file_error(skf_error *e, skf_status status, long line, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* A mesh that grows. */
typedef struct skf_builder {
  skf_mesh *mesh;
  size_t vertex_capacity, triangle_capacity;
} skf_builder;

bool skf_build_vertex(skf_builder *b, skf_vec3 p);
bool skf_build_triangle(skf_builder *b, unsigned i, unsigned j, unsigned k);

/* Text with a place in it. The text ends with NUL. */
typedef struct skf_scan {
  const char *p, *end;
  long line;
  char comment; /* starts a comment that runs to the end of the line; 0: there are none */
  bool joins;   /* a backslash at the end of a line continues it on the next */
} skf_scan;

/* Skips blanks on this line; true when something is left on it. */
bool skf_scan_more(skf_scan *s);
/* Skips blanks and empty lines; false at the end of the text. */
bool skf_scan_any(skf_scan *s);
void skf_scan_end_line(skf_scan *s);
/* Copies the next word on this line, cut to size - 1; false when there is none. */
bool skf_scan_word(skf_scan *s, char *word, size_t size);
/* The next number on this line, finite. */
bool skf_scan_number(skf_scan *s, double *out);
bool skf_scan_integer(skf_scan *s, long *out);

/* Bytes of little-endian numbers. */
static inline void skf_put_u32(unsigned char *b, uint32_t x) {
  for (int i = 0; i < 4; i++) b[i] = (unsigned char)(x >> 8 * i);
}
static inline uint32_t skf_get_u32(const unsigned char *b) {
  return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}
void skf_put_f32(unsigned char *b, float x);
void skf_put_f64(unsigned char *b, double x);
float skf_get_f32(const unsigned char *b);

/* Writes numbers separated by blanks and ends the line. */
void skf_write_row(FILE *f, const char *start, int n, const double *x);

#endif
