/* SPDX-License-Identifier: MIT */
/* Particles from a CSV file. */
#include "scene/sources.h"
#include "core/alloc.h"
#include "core/number.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { NUMBERS = 6, COLUMNS = 7, NAME = 6 };
static const char *const titles[COLUMNS] = {"x", "y", "z", "vx", "vy", "vz", "name"};

/* A row, whose name is at an offset of the pool that may still move. */
typedef struct start {
  double x[NUMBERS];
  size_t name;
} start;

typedef struct table {
  skf_reader *r;
  const char *path;
  char *line;
  size_t line_room;
  long number;
  int order[COLUMNS], columns; /* column k of the file is titles[order[k]] */
  bool named;
  start *rows;
  size_t count, capacity;
  char *pool;
  size_t pool_size, pool_capacity;
} table;

static skf_status refuse(const table *t, skf_status status, const char *what, const char *shown, const char *wanted) {
  skf_error *e = t->r->error;
  skf_error_set(e, status, t->number, "%s%s, expected %s", what, shown, wanted);
  if (e) snprintf(e->file, sizeof e->file, "%.511s", t->path);
  return status;
}

static skf_status no_memory(const table *t) { return skf_error_set(t->r->error, SKF_ERR_NOMEM, 0, "out of memory"); }

/* The next line that is not empty; NULL at the end. */
static char *next_line(table *t, FILE *f) {
  ssize_t n;
  while ((n = getline(&t->line, &t->line_room, f)) >= 0) {
    t->number++;
    while (n > 0 && strchr("\r\n \t", t->line[n - 1])) t->line[--n] = 0;
    if (n > 0) return t->line;
  }
  return NULL;
}

/* Cuts a field off the text: its blanks and the comma behind it go. */
static char *field(char **text) {
  char *from = *text + strspn(*text, " \t"), *end = from + strcspn(from, ",");
  *text = *end ? end + 1 : NULL;
  *end = 0;
  while (end > from && (end[-1] == ' ' || end[-1] == '\t')) *--end = 0;
  return from;
}

static skf_status read_header(table *t, FILE *f) {
  static const char wanted[] = "the columns x,y,z,vx,vy,vz and, if you like, name";
  char *text = next_line(t, f);
  if (!text) return t->number += t->number == 0, refuse(t, SKF_ERR_PARSE, "nothing in the file", "", wanted);
  if (memcmp(text, "\xef\xbb\xbf", 3) == 0) text += 3;
  unsigned seen = 0;
  while (text) {
    const char *title = field(&text);
    int k = 0;
    while (k < COLUMNS && strcmp(titles[k], title) != 0) k++;
    if (k == COLUMNS || seen >> k & 1) return refuse(t, SKF_ERR_PARSE, "the column is ", skf_quote(title).text, wanted);
    seen |= 1u << k;
    t->order[t->columns++] = k;
  }
  t->named = seen >> NAME & 1;
  for (int k = 0; k < NUMBERS; k++)
    if (!(seen >> k & 1)) return refuse(t, SKF_ERR_PARSE, "no column ", titles[k], wanted);
  return SKF_OK;
}

static skf_status read_name(table *t, const char *text, size_t *out) {
  size_t n = strlen(text) + 1;
  bool good = n > 1 && n <= 200;
  for (const char *p = text; *p; p++)
    if ((unsigned char)*p < 32 || *p == 127 || *p == '"') good = false;
  if (!good)
    return refuse(t, SKF_ERR_PARSE, "name is ", skf_quote(text).text,
                  "a name without control characters, commas or double quotes");
  if (t->pool_size + n > t->pool_capacity) {
    size_t capacity = 2 * t->pool_capacity + 4096;
    char *more = skf_realloc(t->pool, capacity, 1);
    if (!more) return no_memory(t);
    t->pool = more, t->pool_capacity = capacity;
  }
  memcpy(t->pool + t->pool_size, text, n);
  *out = t->pool_size, t->pool_size += n;
  return SKF_OK;
}

static skf_status read_row(table *t, char *text, start *out) {
  for (int k = 0; k < t->columns; k++) {
    if (!text) return refuse(t, SKF_ERR_PARSE, "too few columns", "", "as many as in the first line");
    const char *value = field(&text);
    int column = t->order[k];
    skf_status s = SKF_OK;
    if (column == NAME) {
      s = read_name(t, value, &out->name);
      if (s) return s;
      continue;
    }
    size_t used;
    s = skf_number_read(value, &used, out->x + column);
    if (s == SKF_OK && value[used]) s = SKF_ERR_PARSE;
    if (s) {
      char what[16];
      snprintf(what, sizeof what, "%s is ", titles[column]);
      return refuse(t, s, what, skf_quote(value).text, "a finite number");
    }
  }
  return text ? refuse(t, SKF_ERR_PARSE, "too many columns", "", "as many as in the first line") : SKF_OK;
}

static skf_status read_rows(table *t, FILE *f) {
  skf_status s = read_header(t, f);
  for (char *text; !s && (text = next_line(t, f));) {
    if (t->count == t->capacity) {
      size_t capacity = t->capacity + t->capacity / 2 + 64;
      start *more = skf_realloc(t->rows, capacity, sizeof *more);
      if (!more) return no_memory(t);
      t->rows = more, t->capacity = capacity;
    }
    s = read_row(t, text, t->rows + t->count);
    t->count += !s;
  }
  if (!s && ferror(f)) s = refuse(t, SKF_ERR_IO, strerror(errno), "", "a file that can be read");
  if (!s && t->count == 0) s = refuse(t, SKF_ERR_PARSE, "no particles", "", "at least one row below the header");
  return s;
}

/* Rows become particles, with their own names or numbers. */
static skf_status add_rows(table *t, const char *name, long line) {
  size_t n = t->count, size = t->named ? 0 : skf_source_name_size(name, n);
  skf_particle *p;
  skf_status s = skf_more_particles(t->r, (double)n, line, &p);
  if (s) return s;
  char *names = t->named ? t->pool : skf_alloc(n, size);
  if (t->named) t->pool = NULL;
  s = skf_keep_names(t->r, names);
  if (s) return s;
  for (size_t i = 0; i < n; i++) {
    const double *x = t->rows[i].x;
    p[i] = (skf_particle){.name = names + (t->named ? t->rows[i].name : i * size),
                          .sourced = true,
                          .position = {x[0], x[1], x[2]},
                          .velocity = {x[3], x[4], x[5]},
                          .line = line};
    if (!t->named) skf_source_name(p[i].name, name, i, n);
  }
  t->r->scene->particle_count += n;
  return SKF_OK;
}

skf_status skf_add_starts(skf_reader *r, const skf_node *file, const char *name, long line) {
  const char *text = skf_node_text(&r->yaml, file);
  table t = {.r = r};
  skf_status s = skf_file_path(r, file, &t.path);
  if (s) return s;
  struct stat about;
  errno = 0;
  bool regular = stat(t.path, &about) == 0 && S_ISREG(about.st_mode); /* a pipe would be read for ever */
  FILE *f = regular ? fopen(t.path, "rb") : NULL;
  s = f ? read_rows(&t, f)
        : skf_error_set(r->error, SKF_ERR_IO, file->line, "file %s: %s, expected a CSV file", skf_show(text).text,
                        errno ? strerror(errno) : "not a regular file");
  if (f) fclose(f);
  if (!s) s = add_rows(&t, name, line);
  skf_free(t.rows), skf_free(t.pool);
  free(t.line);
  return s;
}
