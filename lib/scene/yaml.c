/* SPDX-License-Identifier: MIT */
/* libyaml's events, gathered into a tree. Its own document loader would resolve aliases and forget where they were. */
#include "scene/yaml.h"
#include "core/alloc.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <yaml.h>

enum {
  ANCHORS = 1024,    /* at most */
  COPIED = 1 << 18,  /* values that all aliases together stand for, at most: aliases of aliases grow without end */
  MERGED_KEYS = 256, /* of a mapping with a merge key, at most */
};

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
  struct anchor {
    uint32_t name, node; /* in the pool, in the tree */
  } anchors[ANCHORS];
  int anchor_count;
  size_t copied;
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

static skf_status add_text(builder *b, const void *text, size_t n, uint32_t *at) {
  skf_yaml *y = b->y;
  char *pool = grow(y->pool, y->pool_size + n + 1, &y->pool_capacity, 1);
  if (!pool) return skf_error_set(b->error, SKF_ERR_NOMEM, 0, "out of memory");
  y->pool = pool;
  memcpy(pool + y->pool_size, text, n);
  pool[y->pool_size + n] = 0;
  *at = (uint32_t)y->pool_size;
  y->pool_size += n + 1;
  return SKF_OK;
}

static skf_status add_scalar(builder *b) {
  const yaml_event_t *e = &b->event;
  size_t n = e->data.scalar.length;
  if (memchr(e->data.scalar.value, 0, n))
    return skf_error_set(b->error, SKF_ERR_PARSE, line_of(b), "text with a NUL character, expected plain text");
  skf_node node = {
      .type = SKF_NODE_SCALAR, .plain = e->data.scalar.style == YAML_PLAIN_SCALAR_STYLE, .line = (int)line_of(b)};
  skf_status s = add_text(b, e->data.scalar.value, n, &node.text);
  return s ? s : add(b, node);
}

static skf_status open_container(builder *b, skf_node node) {
  if (b->depth == DEPTH)
    return skf_error_set(b->error, SKF_ERR_PARSE, line_of(b), "nested too deep, expected at most %d levels", DEPTH);
  uint32_t id = (uint32_t)b->y->node_count;
  skf_status s = add(b, node);
  if (s) return s;
  b->open[b->depth] = id;
  b->last[b->depth++] = 0;
  return SKF_OK;
}

static bool is_merge(const builder *b, const skf_node *key) {
  return key->type == SKF_NODE_SCALAR && key->plain && strcmp(skf_node_text(b->y, key), "<<") == 0;
}

/* The map's first key that reads like this one, or NULL */
static const skf_node *find_key(const builder *b, const skf_node *map, const skf_node *key) {
  for (const skf_node *k = skf_node_first(b->y, map); k; k = skf_node_next(b->y, skf_node_next(b->y, k)))
    if (k->type == SKF_NODE_SCALAR && key->type == SKF_NODE_SCALAR &&
        strcmp(skf_node_text(b->y, k), skf_node_text(b->y, key)) == 0)
      return k;
  return NULL;
}

static skf_status refuse_merge(const builder *b, const skf_node *at, const char *what) {
  return skf_error_set(b->error, SKF_ERR_PARSE, at->line, "a merge key (<<) %s", what);
}

/* Moves the pairs of `from` whose keys the map lacks behind its last value. */
static skf_status merge(builder *b, skf_node *map, const skf_node *from, uint32_t *last) {
  skf_node *nodes = b->y->nodes;
  if (from->type != SKF_NODE_MAP)
    return refuse_merge(b, from, "of something else, expected a mapping or a list of them");
  for (uint32_t k = from->first; k; k = nodes[nodes[k].next].next)
    if (nodes[k].type == SKF_NODE_SCALAR && find_key(b, from, nodes + k) != nodes + k)
      return skf_error_set(b->error, SKF_ERR_PARSE, nodes[k].line, "duplicate key '%s', expected it once",
                           skf_show(skf_node_text(b->y, nodes + k)).text);
  if (map->count + from->count > MERGED_KEYS) return refuse_merge(b, from, "of a large mapping, expected fewer keys");
  for (uint32_t k = from->first, next; k; k = next) {
    uint32_t value = nodes[k].next;
    next = nodes[value].next;
    if (find_key(b, map, nodes + k)) continue;
    nodes[value].next = 0;
    *(*last ? &nodes[*last].next : &map->first) = k;
    *last = value, map->count++;
  }
  return SKF_OK;
}

/* Replaces the merge key of a map by what it lacks of that: its own keys count before, the first of several. What is
   merged is taken apart, so nothing else may name it; an alias is a copy. */
static skf_status merge_all(builder *b, skf_node *map) {
  skf_node *nodes = b->y->nodes;
  uint32_t merged = 0, end = 0, last = 0;
  for (uint32_t k = map->first, before = 0, next; k; k = next) {
    uint32_t value = nodes[k].next;
    next = nodes[value].next;
    if (!is_merge(b, nodes + k)) {
      before = last = value;
      continue;
    }
    if (merged) return refuse_merge(b, nodes + k, "for the second time, expected one of a list");
    merged = value, end = next ? next : (uint32_t)b->y->node_count, map->count--;
    *(before ? &nodes[before].next : &map->first) = next;
  }
  if (!merged) return SKF_OK;
  for (int i = 0; i < b->anchor_count; i++)
    if (b->anchors[i].node >= merged && b->anchors[i].node < end)
      return refuse_merge(b, nodes + b->anchors[i].node, "of what has an anchor (&), expected its alias");
  const skf_node *from = nodes + merged;
  if (from->type != SKF_NODE_LIST) return merge(b, map, from, &last);
  skf_status s = SKF_OK;
  for (uint32_t k = from->first, next; k && !s; k = next) next = nodes[k].next, s = merge(b, map, nodes + k, &last);
  return s;
}

static skf_status close_container(builder *b) {
  skf_node *n = b->y->nodes + b->open[--b->depth];
  if (n->type != SKF_NODE_MAP) return SKF_OK;
  n->count /= 2;
  return merge_all(b, n);
}

/* A value that an alias stands for, again: its nodes keep the lines where it is written. */
static skf_status copy(builder *b, uint32_t id) {
  skf_node node = b->y->nodes[id];
  uint32_t child = node.first;
  if (++b->copied > COPIED)
    return skf_error_set(b->error, SKF_ERR_PARSE, line_of(b), "aliases stand for too much, expected at most %d values",
                         COPIED);
  node.first = node.next = 0, node.count = 0;
  if (node.type == SKF_NODE_SCALAR) return add(b, node);
  skf_status s = open_container(b, node);
  for (; child && !s; child = b->y->nodes[child].next) s = copy(b, child);
  return s ? s : close_container(b);
}

static skf_status put_alias(builder *b) {
  const char *name = (const char *)b->event.data.alias.anchor;
  for (int i = b->anchor_count; i-- > 0;) {
    if (strcmp(b->y->pool + b->anchors[i].name, name) != 0) continue;
    for (int k = 0; k < b->depth; k++)
      if (b->open[k] == b->anchors[i].node)
        return skf_error_set(b->error, SKF_ERR_PARSE, line_of(b), "*%s is inside of &%s, expected it after that",
                             skf_show(name).text, skf_show(name).text);
    return copy(b, b->anchors[i].node);
  }
  return skf_error_set(b->error, SKF_ERR_PARSE, line_of(b), "*%s, expected an anchor &%s before it",
                       skf_show(name).text, skf_show(name).text);
}

/* Notes the anchor, if there is one, of the node that comes next. */
static skf_status put_anchor(builder *b, const yaml_char_t *name) {
  if (!name) return SKF_OK;
  if (b->anchor_count == ANCHORS)
    return skf_error_set(b->error, SKF_ERR_PARSE, line_of(b), "another anchor, expected at most %d", ANCHORS);
  struct anchor *a = b->anchors + b->anchor_count++;
  a->node = (uint32_t)b->y->node_count;
  return add_text(b, name, strlen((const char *)name), &a->name);
}

static skf_status refuse(const builder *b, const char *what) {
  return skf_error_set(b->error, SKF_ERR_PARSE, line_of(b), "%s, expected plain YAML without it", what);
}

static skf_status take(builder *b, int *documents) {
  const yaml_event_t *e = &b->event;
  const skf_node list = {.type = SKF_NODE_LIST, .line = (int)line_of(b)},
                 map = {.type = SKF_NODE_MAP, .line = (int)line_of(b)};
  skf_status s;
  switch (e->type) {
  case YAML_DOCUMENT_START_EVENT: return ++*documents > 1 ? refuse(b, "a second document") : SKF_OK;
  case YAML_ALIAS_EVENT: return put_alias(b);
  case YAML_SCALAR_EVENT:
    if (e->data.scalar.tag) return refuse(b, "a tag (!)");
    return (s = put_anchor(b, e->data.scalar.anchor)) ? s : add_scalar(b);
  case YAML_SEQUENCE_START_EVENT:
    if (e->data.sequence_start.tag) return refuse(b, "a tag (!)");
    return (s = put_anchor(b, e->data.sequence_start.anchor)) ? s : open_container(b, list);
  case YAML_MAPPING_START_EVENT:
    if (e->data.mapping_start.tag) return refuse(b, "a tag (!)");
    return (s = put_anchor(b, e->data.mapping_start.anchor)) ? s : open_container(b, map);
  case YAML_SEQUENCE_END_EVENT:
  case YAML_MAPPING_END_EVENT: return close_container(b);
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
