/* SPDX-License-Identifier: MIT */
#include "scene/reader.h"
#include "core/alloc.h"
#include "core/number.h"
#include "core/vec3.h"
#include <float.h>
#include <stdio.h>
#include <string.h>

const skf_range skf_positive = {0, INFINITY, true}, skf_not_negative = {0, INFINITY, false},
                skf_fraction = {0, 1, false}, skf_negative = {-INFINITY, -DBL_TRUE_MIN, false};

const skf_node *skf_map_find(const skf_reader *r, const skf_node *map, const char *key) {
  const skf_node *k = skf_node_first(&r->yaml, map);
  while (k) {
    const skf_node *value = skf_node_next(&r->yaml, k);
    if (k->type == SKF_NODE_SCALAR && strcmp(skf_node_text(&r->yaml, k), key) == 0) return value;
    k = skf_node_next(&r->yaml, value);
  }
  return NULL;
}

long skf_map_line(const skf_reader *r, const skf_node *map, const char *key) {
  const skf_node *value = skf_map_find(r, map, key);
  return value ? value->line : map->line;
}

static const char *number_form(const skf_range *a, char *text, size_t size) {
  if (!a || (a->lowest == -INFINITY && a->highest == INFINITY))
    snprintf(text, size, "a finite number");
  else if (a == &skf_negative)
    snprintf(text, size, "a finite number < 0");
  else if (a->highest == INFINITY)
    snprintf(text, size, "a finite number %s %g", a->open ? ">" : ">=", a->lowest);
  else if (a->open)
    snprintf(text, size, "a number > %g and <= %g", a->lowest, a->highest);
  else
    snprintf(text, size, "a number from %g to %g", a->lowest, a->highest);
  return text;
}

const char *skf_key_form(const skf_key *key, char *text, size_t size) {
  switch (key->type) {
  case SKF_KEY_NUMBER:
  case SKF_KEY_ANGLE: return number_form(key->range, text, size);
  case SKF_KEY_VECTOR: return "[x, y, z]";
  case SKF_KEY_VECTORS: snprintf(text, size, "a list of %d points [x, y, z]", key->count); return text;
  case SKF_KEY_COLOR: return "[red, green, blue] from 0 to 1";
  case SKF_KEY_SHARE: return "a number or a color from 0 to 1";
  case SKF_KEY_NAME: return "a name";
  default: return key->form;
  }
}

static const char *kind_of(const skf_node *n) {
  return n->type == SKF_NODE_LIST ? "a list" : n->type == SKF_NODE_MAP ? "a mapping" : "text";
}

skf_status skf_expect(skf_reader *r, const skf_node *node, skf_node_type type, const char *name, const char *form) {
  if (node->type == type) return SKF_OK;
  if (node->type == SKF_NODE_SCALAR)
    return skf_error_set(r->error, SKF_ERR_PARSE, node->line, "%s is %s, expected %s", name,
                         skf_quote(skf_node_text(&r->yaml, node)).text, form);
  return skf_error_set(r->error, SKF_ERR_PARSE, node->line, "%s is %s, expected %s", name, kind_of(node), form);
}

static bool in_range(const skf_range *a, double x) {
  return !a || ((a->open ? x > a->lowest : x >= a->lowest) && x <= a->highest);
}

/* A number without anything to say about it, which nearly all of them are. */
static bool is_good(const skf_reader *r, const skf_node *node, const skf_key *key, double *x) {
  if (node->type != SKF_NODE_SCALAR || !node->plain) return false;
  const char *text = skf_node_text(&r->yaml, node);
  size_t used;
  return skf_number_read(text, &used, x) == SKF_OK && !text[used] && in_range(key->range, *x);
}

static double number_of(const skf_key *key, double x) {
  if (key->type != SKF_KEY_ANGLE) return x;
  return x == 360 ? 2 * SKF_PI : x * (SKF_PI / 180);
}

skf_status skf_read_number(skf_reader *r, const skf_node *node, const skf_key *key, double *out) {
  char text_of_form[64];
  double x;
  if (is_good(r, node, key, &x)) return *out = number_of(key, x), SKF_OK;
  const char *form = key->form ? key->form : number_form(key->range, text_of_form, sizeof text_of_form);
  skf_status s = skf_expect(r, node, SKF_NODE_SCALAR, key->name, form);
  if (s) return s;
  const char *text = skf_node_text(&r->yaml, node);
  size_t used;
  s = skf_number_read(text, &used, &x);
  if (s == SKF_OK && (text[used] || !node->plain)) s = SKF_ERR_PARSE;
  if (s == SKF_ERR_PARSE) {
    bool quoted = !node->plain;
    return skf_error_set(r->error, s, node->line, "%s is %s%s, expected %s%s", key->name, quoted ? "the text " : "",
                         skf_quote(text).text, form, quoted ? " without quotes" : "");
  }
  return skf_error_set(r->error, SKF_ERR_RANGE, node->line, "%s is %s, expected %s", key->name, skf_show(text).text,
                       form);
}

static skf_status read_three(skf_reader *r, const skf_node *node, const skf_key *key, double x[3]) {
  char buffer[64];
  bool color = key->type == SKF_KEY_COLOR || key->type == SKF_KEY_SHARE;
  const char *form = color ? skf_key_form(key, buffer, sizeof buffer) : "[x, y, z]";
  skf_status s = skf_expect(r, node, SKF_NODE_LIST, key->name, form);
  if (s) return s;
  if (node->count != 3)
    return skf_error_set(r->error, SKF_ERR_PARSE, node->line, "%s has %d entries, expected %s", key->name, node->count,
                         form);
  const skf_key one = {.name = key->name, .range = color ? &skf_fraction : NULL};
  const skf_node *n = skf_node_first(&r->yaml, node);
  for (int i = 0; i < 3 && !s; i++, n = skf_node_next(&r->yaml, n)) s = skf_read_number(r, n, &one, x + i);
  return s;
}

static skf_status read_share(skf_reader *r, const skf_node *node, const skf_key *key, double x[3]) {
  if (node->type == SKF_NODE_LIST) return read_three(r, node, key, x);
  const skf_key one = {.name = key->name, .range = &skf_fraction};
  skf_status s = skf_read_number(r, node, &one, x);
  if (!s) x[1] = x[2] = x[0];
  return s;
}

skf_status skf_read_color(skf_reader *r, const skf_node *node, const char *name, double out[3]) {
  const skf_key key = {.name = name, .type = SKF_KEY_COLOR};
  return read_three(r, node, &key, out);
}

skf_status skf_read_vector(skf_reader *r, const skf_node *node, const skf_key *key, skf_vec3 *out) {
  double x[3];
  skf_status s = read_three(r, node, key, x);
  if (!s) *out = v3(x[0], x[1], x[2]);
  return s;
}

static skf_status read_vectors(skf_reader *r, const skf_node *node, const skf_key *key, skf_vec3 *out) {
  char form[64];
  skf_key_form(key, form, sizeof form);
  skf_status s = skf_expect(r, node, SKF_NODE_LIST, key->name, form);
  if (s) return s;
  if (node->count != key->count)
    return skf_error_set(r->error, SKF_ERR_PARSE, node->line, "%s has %d entries, expected %s", key->name, node->count,
                         form);
  const skf_node *n = skf_node_first(&r->yaml, node);
  for (int i = 0; i < key->count && !s; i++, n = skf_node_next(&r->yaml, n)) s = skf_read_vector(r, n, key, out + i);
  return s;
}

skf_status skf_read_name(skf_reader *r, const skf_node *node, const skf_key *key, char **out) {
  static const char form[] = "a name without control characters, commas or double quotes";
  skf_status s = skf_expect(r, node, SKF_NODE_SCALAR, key->name, form);
  if (s) return s;
  const char *text = skf_node_text(&r->yaml, node);
  bool good = *text && strlen(text) < 200 && !(node->plain && strcmp(text, "~") == 0);
  for (const char *p = text; *p; p++) /* names go into CSV files and one-line messages */
    if ((unsigned char)*p < 32 || *p == 127 || *p == ',' || *p == '"') good = false;
  if (!good)
    return skf_error_set(r->error, SKF_ERR_PARSE, node->line, "%s is %s, expected %s", key->name, skf_quote(text).text,
                         form);
  *out = skf_strdup(text);
  return *out ? SKF_OK : skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
}

skf_status skf_read_choice(skf_reader *r, const skf_node *node, const char *name, const char *const *choices, int n,
                           int *out) {
  const char *text = node->type == SKF_NODE_SCALAR ? skf_node_text(&r->yaml, node) : NULL;
  for (int i = 0; text && i < n; i++)
    if (strcmp(text, choices[i]) == 0) return *out = i, SKF_OK;
  char form[160] = "one of";
  for (int i = 0; i < n; i++) {
    size_t used = strlen(form);
    snprintf(form + used, sizeof form - used, "%s %s", i ? "," : "", choices[i]);
  }
  skf_status s = skf_expect(r, node, SKF_NODE_SCALAR, name, form);
  if (s) return s;
  return skf_error_set(r->error, SKF_ERR_PARSE, node->line, "%s is %s, expected %s", name, skf_quote(text).text, form);
}

static skf_status read_value(skf_reader *r, const skf_node *value, const skf_key *key, void *into) {
  void *at = (char *)into + key->offset;
  switch (key->type) {
  case SKF_KEY_NUMBER:
  case SKF_KEY_ANGLE: return skf_read_number(r, value, key, at);
  case SKF_KEY_VECTOR: return skf_read_vector(r, value, key, at);
  case SKF_KEY_VECTORS: return read_vectors(r, value, key, at);
  case SKF_KEY_COLOR: return read_three(r, value, key, at);
  case SKF_KEY_SHARE: return read_share(r, value, key, at);
  case SKF_KEY_NAME: return skf_read_name(r, value, key, at);
  default: return key->read(r, value, into);
  }
}

static skf_status unknown_key(skf_reader *r, const skf_node *key, const skf_section *section) {
  char list[200] = "";
  for (int i = 0; i < section->count; i++) {
    size_t n = strlen(list);
    snprintf(list + n, sizeof list - n, "%s%s", i ? ", " : "", section->keys[i].name);
  }
  const char *text = key->type == SKF_NODE_SCALAR ? skf_node_text(&r->yaml, key) : kind_of(key);
  return skf_error_set(r->error, SKF_ERR_PARSE, key->line, "unknown key '%s' in %s, expected %s", skf_show(text).text,
                       section->name, list);
}

static int key_index(const skf_reader *r, const skf_node *key, const skf_section *section) {
  if (key->type != SKF_NODE_SCALAR) return -1;
  for (int i = 0; i < section->count; i++)
    if (strcmp(skf_node_text(&r->yaml, key), section->keys[i].name) == 0) return i;
  return -1;
}

static skf_status missing_key(skf_reader *r, const skf_node *map, const skf_section *section, unsigned given) {
  char form[64];
  for (int i = 0; i < section->count; i++)
    if (section->keys[i].required && !(given >> i & 1))
      return skf_error_set(r->error, SKF_ERR_PARSE, map->line, "missing '%s' in %s, expected %s", section->keys[i].name,
                           section->name, skf_key_form(section->keys + i, form, sizeof form));
  return SKF_OK;
}

skf_status skf_read_map(skf_reader *r, const skf_node *map, const skf_section *section, void *into, unsigned *given) {
  unsigned seen = 0;
  skf_status s;
  if (map->type != SKF_NODE_MAP) {
    char form[96];
    snprintf(form, sizeof form, "a mapping with '%s'", section->keys[0].name);
    return skf_expect(r, map, SKF_NODE_MAP, section->name, form);
  }
  const skf_node *key = skf_node_first(&r->yaml, map);
  while (key) {
    const skf_node *value = skf_node_next(&r->yaml, key);
    int i = key_index(r, key, section);
    if (i < 0) return unknown_key(r, key, section);
    if (seen >> i & 1)
      return skf_error_set(r->error, SKF_ERR_PARSE, key->line, "duplicate key '%s' in %s, expected it once",
                           section->keys[i].name, section->name);
    seen |= 1u << i;
    if ((s = read_value(r, value, section->keys + i, into))) return s;
    key = skf_node_next(&r->yaml, value);
  }
  if (given) *given = seen;
  return missing_key(r, map, section, seen);
}

skf_status skf_file_path(skf_reader *r, const skf_node *file, const char **path) {
  skf_scene *scene = r->scene;
  const char *name = skf_node_text(&r->yaml, file);
  size_t size = strlen(r->folder) + strlen(name) + 2;
  char **more = skf_realloc(scene->files, scene->file_count + 1, sizeof *more);
  if (more) scene->files = more;
  char *text = more ? skf_alloc(size, 1) : NULL;
  if (!text) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  snprintf(text, size, "%s%s%s", *name == '/' ? "" : r->folder, *name == '/' ? "" : "/", name);
  *path = scene->files[scene->file_count++] = text;
  return SKF_OK;
}
