/* SPDX-License-Identifier: MIT */
#include "scene/skeleton.h"
#include "core/alloc.h"
#include "core/vec3.h"
#include <stdio.h>
#include <string.h>

static skf_status accept(skf_reader *r, const skf_node *value, void *into) {
  return (void)r, (void)value, (void)into, SKF_OK;
}

skf_status skf_read_kernel(skf_reader *r, const skf_node *map, skf_kernel *out) {
  skf_status s = skf_expect(r, map, SKF_NODE_MAP, "kernel", "{type: ..., and its parameter}");
  if (s) return s;
  const skf_node *type = skf_map_find(r, map, "type");
  if (!type)
    return skf_error_set(r->error, SKF_ERR_PARSE, map->line, "missing 'type' in kernel, expected the kernel's name");
  const char *names[SKF_KERNEL_COUNT];
  for (int i = 0; i < SKF_KERNEL_COUNT; i++) names[i] = skf_kernel_get((skf_kernel_type)i)->name;
  int chosen;
  if ((s = skf_read_choice(r, type, "type", names, SKF_KERNEL_COUNT, &chosen))) return s;
  const skf_kernel_info *info = skf_kernel_get((skf_kernel_type)chosen);
  out->type = (skf_kernel_type)chosen;
  out->param = 1;
  const skf_key keys[] = {
      {"type", .type = SKF_KEY_OTHER, .required = true, .read = accept},
      {info->param, .type = SKF_KEY_NUMBER, .required = true, .offset = offsetof(skf_kernel, param),
       .range = &skf_positive},
  };
  char name[64];
  snprintf(name, sizeof name, "kernel %s", info->name);
  return skf_read_map(r, map, &(skf_section){name, NULL, keys, info->param ? 2 : 1}, out, NULL);
}

static skf_status read_own_kernel(skf_reader *r, const skf_node *map, void *into) {
  skf_entry *e = into;
  e->kernel.given = true;
  return skf_read_kernel(r, map, &e->kernel.kernel);
}

enum { ENTRY_KEYS = 12, KINDS = SKF_SHAPE_COUNT + SKF_COMPOUND_COUNT };

/* The keys of one kind of entry: a primitive's, or a compound's. */
typedef struct entry_table {
  skf_section section;
  skf_key keys[ENTRY_KEYS];
  skf_range ranges[ENTRY_KEYS];
} entry_table;

static const skf_key_type key_types[] = {
    [SKF_PARAM_NUMBER] = SKF_KEY_NUMBER,
    [SKF_PARAM_ANGLE] = SKF_KEY_ANGLE,
    [SKF_PARAM_VECTOR] = SKF_KEY_VECTOR,
    [SKF_PARAM_VECTORS] = SKF_KEY_VECTORS,
};

static const char *kind_name(int kind) {
  return kind < SKF_SHAPE_COUNT ? skf_shape_get((skf_shape)kind)->name
                                : skf_compounds[kind - SKF_SHAPE_COUNT].section.name;
}

static int own_keys(int kind, entry_table *t) {
  int n = 0;
  if (kind >= SKF_SHAPE_COUNT) {
    const skf_section *own = &skf_compounds[kind - SKF_SHAPE_COUNT].section;
    for (; n < own->count; n++) t->keys[n] = own->keys[n];
    return n;
  }
  const skf_shape_info *info = skf_shape_get((skf_shape)kind);
  for (; n < info->param_count && n < ENTRY_KEYS - 2; n++) {
    const skf_param *p = info->params + n;
    double unit = p->type == SKF_PARAM_ANGLE ? 180 / SKF_PI : 1;
    t->ranges[n] = (skf_range){p->above * unit, p->upto * unit, true};
    t->keys[n] = (skf_key){.name = p->name,
                           .unit = p->unit,
                           .doc = p->doc,
                           .type = key_types[p->type],
                           .required = true,
                           .offset = offsetof(skf_entry, element.primitive) + p->offset,
                           .range = t->ranges + n,
                           .count = p->count};
  }
  return n;
}

/* The kind's own keys, then strength and kernel. */
static void make_table(int kind, entry_table *t) {
  int n = own_keys(kind, t);
  t->keys[n++] = (skf_key){.name = "strength", .type = SKF_KEY_NUMBER, .offset = offsetof(skf_entry, element.strength)};
  t->keys[n++] = (skf_key){.name = "kernel", .type = SKF_KEY_OTHER, .read = read_own_kernel};
  t->section = (skf_section){kind_name(kind), NULL, t->keys, n};
}

static skf_status one_kind(skf_reader *r, const skf_node *entry, long line) {
  char list[128] = "";
  for (int i = 0; i < KINDS; i++) {
    size_t n = strlen(list);
    snprintf(list + n, sizeof list - n, "%s%s", i ? ", " : "", kind_name(i));
  }
  const skf_node *first = entry->type == SKF_NODE_MAP ? skf_node_first(&r->yaml, entry) : NULL;
  if (entry->type == SKF_NODE_MAP && entry->count > 1)
    return skf_error_set(r->error, SKF_ERR_PARSE, line, "more than one kind in a skeleton entry, expected one of %s",
                         list);
  if (first && first->type == SKF_NODE_SCALAR)
    return skf_error_set(r->error, SKF_ERR_PARSE, line, "unknown primitive '%s', expected one of %s",
                         skf_show(skf_node_text(&r->yaml, first)).text, list);
  return skf_error_set(r->error, SKF_ERR_PARSE, line, "a skeleton entry without a kind, expected one of %s", list);
}

static int find_kind(const char *name) {
  int i = 0;
  while (i < KINDS && strcmp(kind_name(i), name) != 0) i++;
  return i;
}

static skf_status grow(skf_reader *r, skf_pieces *into) {
  skf_body *b = into->body;
  size_t n = 2 * into->capacity + 8;
  skf_element *elements = skf_realloc(b->elements, n, sizeof *elements);
  if (elements) b->elements = elements;
  long *lines = elements ? skf_realloc(b->element_lines, n, sizeof *lines) : NULL;
  if (!lines) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  b->element_lines = lines;
  into->capacity = n;
  return SKF_OK;
}

skf_status skf_add_piece(skf_reader *r, const skf_entry *e, const skf_primitive *p, skf_pieces *into) {
  const char *why;
  skf_body *b = into->body;
  skf_status s = skf_primitive_check(p, &why);
  if (s) return skf_error_set(r->error, s, e->kind->line, "%s, expected a proper %s", why, e->name);
  if (p->shape != SKF_PLANE && !isfinite(skf_primitive_measure(p)))
    return skf_error_set(r->error, SKF_ERR_RANGE, e->kind->line,
                         "measure of the %s overflows, expected smaller numbers", e->name);
  if (b->element_count == into->capacity && (s = grow(r, into))) return s;
  b->element_lines[b->element_count] = e->kind->line;
  b->elements[b->element_count++] = (skf_element){*p, e->kernel.kernel, e->element.strength};
  return SKF_OK;
}

/* What all kinds of entries share. */
static skf_status check_entry(skf_reader *r, const skf_entry *e, const skf_node *value) {
  if (e->element.strength == 0)
    return skf_error_set(r->error, SKF_ERR_RANGE, skf_map_line(r, value, "strength"),
                         "strength is 0, expected another number (a primitive of strength 0 is none)");
  if (e->kernel.given) return SKF_OK;
  return skf_error_set(r->error, SKF_ERR_PARSE, e->kind->line,
                       "no kernel for this %s, expected 'kernel' in it or in its body", e->name);
}

static skf_status read_entry(skf_reader *r, const skf_node *entry, const entry_table *tables,
                             const skf_default_kernel *kernel, skf_pieces *into) {
  const skf_node *word = entry->type == SKF_NODE_MAP ? skf_node_first(&r->yaml, entry) : NULL;
  if (!word) return one_kind(r, entry, entry->line);
  const skf_node *value = skf_node_next(&r->yaml, word), *second = skf_node_next(&r->yaml, value);
  if (second) return one_kind(r, entry, second->line);
  int kind = word->type == SKF_NODE_SCALAR ? find_kind(skf_node_text(&r->yaml, word)) : KINDS;
  if (kind == KINDS) return one_kind(r, entry, word->line);
  bool simple = kind < SKF_SHAPE_COUNT;
  skf_entry e = {.element = {.primitive.shape = simple ? (skf_shape)kind : SKF_POINT, .strength = 1},
                 .kernel = *kernel,
                 .name = kind_name(kind),
                 .kind = word,
                 .map = value};
  skf_status s = skf_read_map(r, value, &tables[kind].section, &e, NULL);
  if (!s) s = check_entry(r, &e, value);
  if (s) return s;
  return simple ? skf_add_piece(r, &e, &e.element.primitive, into)
                : skf_compounds[kind - SKF_SHAPE_COUNT].expand(r, &e, into);
}

skf_status skf_read_skeleton(skf_reader *r, const skf_node *list, const skf_default_kernel *kernel, skf_body *body) {
  entry_table tables[KINDS];
  skf_pieces pieces = {body, 0};
  skf_status s = SKF_OK;
  for (int i = 0; i < KINDS; i++) make_table(i, tables + i);
  for (const skf_node *n = skf_node_first(&r->yaml, list); n && !s; n = skf_node_next(&r->yaml, n))
    s = read_entry(r, n, tables, kernel, &pieces);
  return s;
}
