/* SPDX-License-Identifier: MIT */
/* libyaml's events, gathered into a tree. Its own document loader would resolve aliases and forget where they were. */
#include "scene/yaml.h"
#include "core/alloc.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <yaml.h>

enum { DEPTH = 16 }; /* a scene nests 8 deep: scene, bodies, body, skeleton, entry, triangle, vertices, vertex */

typedef struct builder {
  skf_yaml *y;
  skf_error *error;
  yaml_parser_t parser;
  yaml_event_t event;
  const char *text;
  size_t length;
  long last_line;
  int depth;
  uint32_t open[DEPTH], last[DEPTH]; /* the containers that are open, and their latest children */
} builder;

skf_status skf_error_set(skf_error *error, skf_status status, long line, const char *format, ...) {
  if (!error) return status;
  error->status = status;
  error->line = line;
  va_list args;
  va_start(args, format);
  vsnprintf(error->text, sizeof error->text, format, args);
  va_end(args);
  return status;
}

skf_shown skf_show(const char *text) {
  skf_shown s;
  size_t n = strlen(text), room = sizeof s.text - 4; /* two quotes and NUL must fit, too */
  bool cut = n > room;
  if (cut) {
    n = room - 3;
    while (n && ((unsigned char)text[n] & 0xc0) == 0x80) n--; /* not inside a UTF-8 character */
  }
  for (size_t i = 0; i < n; i++) s.text[i] = (unsigned char)text[i] < 32 || text[i] == 127 ? '?' : text[i];
  strcpy(s.text + n, cut ? "..." : "");
  return s;
}

skf_shown skf_quote(const char *text) {
  skf_shown inner = skf_show(text), s;
  const char *mark = *text ? "'" : "";
  snprintf(s.text, sizeof s.text, "%s%.*s%s", mark, (int)sizeof s.text - 3, *text ? inner.text : "empty", mark);
  return s;
}

static void *grow(void *array, size_t need, size_t *capacity, size_t size) {
  if (need <= *capacity) return array;
  size_t n = *capacity + *capacity / 2 > need ? *capacity + *capacity / 2 : need + 64;
  void *more = skf_realloc(array, n, size);
  if (more) *capacity = n;
  return more;
}

static long line_at(const builder *b, size_t offset) {
  long line = 1;
  for (size_t i = 0; i < offset && i < b->length; i++) /* LF, CRLF or CR, as libyaml counts them */
    line += b->text[i] == '\n' || (b->text[i] == '\r' && !(i + 1 < b->length && b->text[i + 1] == '\n'));
  return line;
}

/* libyaml places what is missing at the end behind the last line. */
static long clamp_line(const builder *b, size_t line) {
  return (long)line + 1 < b->last_line ? (long)line + 1 : b->last_line;
}

static long line_of(const builder *b) { return clamp_line(b, b->event.start_mark.line); }

static skf_status syntax(const builder *b) {
  const yaml_parser_t *p = &b->parser;
  if (p->error == YAML_MEMORY_ERROR) return skf_error_set(b->error, SKF_ERR_NOMEM, 0, "out of memory");
  const char *problem = p->problem ? p->problem : "unreadable text";
  if (p->error == YAML_READER_ERROR)
    return skf_error_set(b->error, SKF_ERR_PARSE, line_at(b, p->problem_offset), "%s, expected UTF-8 text", problem);
  return skf_error_set(b->error, SKF_ERR_PARSE, clamp_line(b, p->problem_mark.line),
                       "%s%s%s, expected well-formed YAML", p->context ? p->context : "", p->context ? ": " : "",
                       problem);
}

/* Adds a node below the innermost open container. */
static skf_status add(builder *b, skf_node node) {
  skf_yaml *y = b->y;
  skf_node *nodes = grow(y->nodes, y->node_count + 1, &y->node_capacity, sizeof *nodes);
  if (!nodes) return skf_error_set(b->error, SKF_ERR_NOMEM, 0, "out of memory");
  y->nodes = nodes;
  uint32_t id = (uint32_t)y->node_count++;
  nodes[id] = node;
  if (b->depth) {
    uint32_t *last = b->last + b->depth - 1, parent = b->open[b->depth - 1];
    if (*last) nodes[*last].next = id;
    if (!*last) nodes[parent].first = id;
    nodes[parent].count++;
    *last = id;
  }
  return SKF_OK;
}

static skf_status add_scalar(builder *b) {
  const yaml_event_t *e = &b->event;
  skf_yaml *y = b->y;
  size_t n = e->data.scalar.length;
  if (memchr(e->data.scalar.value, 0, n))
    return skf_error_set(b->error, SKF_ERR_PARSE, line_of(b), "text with a NUL character, expected plain text");
  char *pool = grow(y->pool, y->pool_size + n + 1, &y->pool_capacity, 1);
  if (!pool) return skf_error_set(b->error, SKF_ERR_NOMEM, 0, "out of memory");
  y->pool = pool;
  memcpy(pool + y->pool_size, e->data.scalar.value, n);
  pool[y->pool_size + n] = 0;
  skf_node node = {.type = SKF_NODE_SCALAR,
                   .plain = e->data.scalar.style == YAML_PLAIN_SCALAR_STYLE,
                   .line = (int)line_of(b),
                   .text = (uint32_t)y->pool_size};
  y->pool_size += n + 1;
  return add(b, node);
}

static skf_status open_container(builder *b, unsigned char type) {
  if (b->depth == DEPTH)
    return skf_error_set(b->error, SKF_ERR_PARSE, line_of(b), "nested too deep, expected at most %d levels", DEPTH);
  uint32_t id = (uint32_t)b->y->node_count;
  skf_status s = add(b, (skf_node){.type = type, .line = (int)line_of(b)});
  if (s) return s;
  b->open[b->depth] = id;
  b->last[b->depth++] = 0;
  return SKF_OK;
}

static void close_container(builder *b) {
  skf_node *n = b->y->nodes + b->open[--b->depth];
  if (n->type == SKF_NODE_MAP) n->count /= 2;
}

static skf_status refuse(const builder *b, const char *what) {
  return skf_error_set(b->error, SKF_ERR_PARSE, line_of(b), "%s, expected plain YAML without it", what);
}

static skf_status take(builder *b, int *documents) {
  const yaml_event_t *e = &b->event;
  switch (e->type) {
  case YAML_DOCUMENT_START_EVENT: return ++*documents > 1 ? refuse(b, "a second document") : SKF_OK;
  case YAML_ALIAS_EVENT: return refuse(b, "an alias (*)");
  case YAML_SCALAR_EVENT:
    if (e->data.scalar.anchor) return refuse(b, "an anchor (&)");
    return e->data.scalar.tag ? refuse(b, "a tag (!)") : add_scalar(b);
  case YAML_SEQUENCE_START_EVENT:
    if (e->data.sequence_start.anchor) return refuse(b, "an anchor (&)");
    return e->data.sequence_start.tag ? refuse(b, "a tag (!)") : open_container(b, SKF_NODE_LIST);
  case YAML_MAPPING_START_EVENT:
    if (e->data.mapping_start.anchor) return refuse(b, "an anchor (&)");
    return e->data.mapping_start.tag ? refuse(b, "a tag (!)") : open_container(b, SKF_NODE_MAP);
  case YAML_SEQUENCE_END_EVENT:
  case YAML_MAPPING_END_EVENT: close_container(b); return SKF_OK;
  default: return SKF_OK;
  }
}

static skf_status build(builder *b) {
  int documents = 0;
  for (bool end = false; !end;) {
    if (!yaml_parser_parse(&b->parser, &b->event)) return syntax(b);
    end = b->event.type == YAML_STREAM_END_EVENT;
    skf_status s = take(b, &documents);
    yaml_event_delete(&b->event);
    if (s) return s;
  }
  if (b->y->node_count) return SKF_OK;
  return skf_error_set(b->error, SKF_ERR_PARSE, 1, "nothing in the file, expected a scene (skelfield: 1, bodies: ...)");
}

skf_status skf_yaml_read(const char *text, size_t length, skf_yaml *out, skf_error *error) {
  *out = (skf_yaml){0};
  if (length > UINT32_MAX / 2) return skf_error_set(error, SKF_ERR_PARSE, 1, "a larger file, expected at most 2 GiB");
  bool mark = length >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0; /* libyaml reads no %YAML behind it */
  if (mark) text += 3, length -= 3;
  builder b = {.y = out, .error = error, .text = text, .length = length};
  b.last_line = line_at(&b, length ? length - 1 : 0);
  if (!yaml_parser_initialize(&b.parser)) return skf_error_set(error, SKF_ERR_NOMEM, 0, "out of memory");
  yaml_parser_set_encoding(&b.parser, YAML_UTF8_ENCODING);
  yaml_parser_set_input_string(&b.parser, (const unsigned char *)text, length);
  skf_status s = build(&b);
  yaml_parser_delete(&b.parser);
  if (s) skf_yaml_free(out);
  return s;
}

void skf_yaml_free(skf_yaml *y) {
  skf_free(y->nodes);
  skf_free(y->pool);
  *y = (skf_yaml){0};
}
