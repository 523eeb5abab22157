/* SPDX-License-Identifier: MIT */
/* Numbers of a scene that change with time: they are replaced in the tree before anything is read from it. */
#include "scene/reader.h"
#include "core/alloc.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One entry while it is read. */
typedef struct track {
  const skf_node *path, *keys;
} track;

static skf_status keep_path(skf_reader *r, const skf_node *node, void *into) {
  ((track *)into)->path = node;
  static const char form[] = "the names that lead to a number, like bodies.star.iso";
  skf_status s = skf_expect(r, node, SKF_NODE_SCALAR, "path", form);
  if (s || *skf_node_text(&r->yaml, node)) return s;
  return skf_error_set(r->error, SKF_ERR_PARSE, node->line, "path is '', expected %s", form);
}

static skf_status keep_keys(skf_reader *r, const skf_node *list, void *into) {
  static const char form[] = "a list of [time, value]";
  ((track *)into)->keys = list;
  skf_status s = skf_expect(r, list, SKF_NODE_LIST, "keys", form);
  if (s || list->count) return s;
  return skf_error_set(r->error, SKF_ERR_PARSE, list->line, "keys is empty, expected %s", form);
}

static const skf_key animate_keys[] = {
    {"path", NULL, "to a number: bodies.NAME.iso, camera.from.0, ...", SKF_KEY_OTHER, true, .read = keep_path,
     .form = "names and places, with dots"},
    {"keys", "T, any", "straight between them, fixed before and behind", SKF_KEY_OTHER, true, .read = keep_keys,
     .form = "[[time, value], ...]"},
};
const skf_section skf_section_animate = {
    "animate",
    "a number of the scene that changes with time. The path has keys of mappings, and of lists\n"
    "places from 0 or the names of what is in them (what has a dot in its name, by its place alone);\n"
    "without --time the time is 0",
    animate_keys, 2};

static bool is_called(const skf_reader *r, const skf_node *node, const char *name, size_t n) {
  if (!node || node->type != SKF_NODE_SCALAR) return false;
  const char *text = skf_node_text(&r->yaml, node);
  return strncmp(text, name, n) == 0 && !text[n];
}

/* What a part of the path names in a node, or NULL. */
static const skf_node *step(const skf_reader *r, const skf_node *in, const char *name, size_t n) {
  const skf_node *k = skf_node_first(&r->yaml, in);
  if (in->type == SKF_NODE_SCALAR) return NULL;
  if (in->type == SKF_NODE_MAP) {
    while (k && !is_called(r, k, name, n)) k = skf_node_next(&r->yaml, skf_node_next(&r->yaml, k));
    return k ? skf_node_next(&r->yaml, k) : NULL;
  }
  for (const skf_node *e = k; e; e = skf_node_next(&r->yaml, e))
    if (e->type == SKF_NODE_MAP && is_called(r, skf_map_find(r, e, "name"), name, n)) return e;
  char *end;
  long place = strtol(name, &end, 10);
  if (end != name + n || place < 0 || name[0] == '-' || name[0] == '+') return NULL;
  while (k && place-- > 0) k = skf_node_next(&r->yaml, k);
  return k;
}

static skf_status resolve(skf_reader *r, const skf_node *path, const skf_node **out) {
  const char *at = skf_node_text(&r->yaml, path);
  const skf_node *node = r->yaml.nodes;
  for (;;) {
    size_t n = strcspn(at, ".");
    char part[64];
    snprintf(part, sizeof part, "%.*s", (int)(n < 60 ? n : 60), at);
    if (!(node = step(r, node, at, n)))
      return skf_error_set(r->error, SKF_ERR_PARSE, path->line,
                           "nothing is called %s in the path %s, expected a number", skf_quote(part).text,
                           skf_show(skf_node_text(&r->yaml, path)).text);
    if (!at[n]) break;
    at += n + 1;
  }
  const skf_key number = {.name = "what the path leads to", .type = SKF_KEY_NUMBER};
  double unused;
  skf_status s = skf_read_number(r, node, &number, &unused);
  *out = node;
  if (s && r->error) r->error->line = path->line;
  return s;
}

static skf_status read_pair(skf_reader *r, const skf_node *pair, double x[2]) {
  static const char form[] = "[time, value]";
  const skf_key one = {.name = "a key", .type = SKF_KEY_NUMBER};
  skf_status s = skf_expect(r, pair, SKF_NODE_LIST, "a key", form);
  if (s) return s;
  if (pair->count != 2)
    return skf_error_set(r->error, SKF_ERR_PARSE, pair->line, "a key has %d entries, expected %s", pair->count, form);
  const skf_node *n = skf_node_first(&r->yaml, pair);
  s = skf_read_number(r, n, &one, x);
  return s ? s : skf_read_number(r, skf_node_next(&r->yaml, n), &one, x + 1);
}

/* On the straight line from a to b; no difference of finite numbers overflows. */
static double between(const double a[2], const double b[2], double t) {
  double half = isinf(b[0] - a[0]) ? 0.5 : 1, s = (half * t - half * a[0]) / (half * b[0] - half * a[0]);
  return isinf(b[1] - a[1]) ? (1 - s) * a[1] + s * b[1] : a[1] + (b[1] - a[1]) * s;
}

/* The value at the scene's time. */
static skf_status value_at(skf_reader *r, const skf_node *keys, double *out) {
  double before[2] = {-INFINITY, 0}, key[2], t = r->hooks->time;
  bool known = false;
  for (const skf_node *n = skf_node_first(&r->yaml, keys); n; n = skf_node_next(&r->yaml, n)) {
    skf_status s = read_pair(r, n, key);
    if (s) return s;
    if (!(key[0] > before[0]))
      return skf_error_set(r->error, SKF_ERR_RANGE, n->line, "the times of keys do not rise, expected later ones");
    if (!known && t <= key[0]) {
      *out = isinf(before[0]) ? key[1] : between(before, key, t);
      known = true;
    }
    before[0] = key[0], before[1] = key[1];
  }
  if (!known) *out = before[1];
  r->scene->animated_until = fmax(r->scene->animated_until, before[0]);
  return SKF_OK;
}

static skf_status put_number(skf_reader *r, const skf_node *node, double value) {
  skf_yaml *y = &r->yaml;
  char text[40];
  size_t n = (size_t)snprintf(text, sizeof text, "%.17g", value) + 1;
  char *pool = skf_realloc(y->pool, y->pool_size + n, 1);
  if (!pool) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  memcpy(pool + y->pool_size, text, n);
  y->pool = pool, y->pool_capacity = y->pool_size + n;
  y->nodes[node - y->nodes].text = (uint32_t)y->pool_size;
  y->pool_size += n;
  return SKF_OK;
}

skf_status skf_animate(skf_reader *r, const skf_node *list) {
  static const char form[] = "a list of {path, keys}";
  skf_status s = skf_expect(r, list, SKF_NODE_LIST, "animate", form);
  if (!s && !list->count) s = skf_error_set(r->error, SKF_ERR_PARSE, list->line, "animate is empty, expected %s", form);
  for (const skf_node *n = s ? NULL : skf_node_first(&r->yaml, list); n && !s; n = skf_node_next(&r->yaml, n)) {
    track t = {NULL, NULL};
    const skf_node *number = NULL;
    double value = 0;
    s = skf_read_map(r, n, &skf_section_animate, &t, NULL);
    if (!s) s = resolve(r, t.path, &number);
    if (!s) s = value_at(r, t.keys, &value);
    if (!s) s = put_number(r, number, value);
  }
  return s;
}
