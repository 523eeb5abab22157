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

/* An element while it is read. */
typedef struct draft {
  skf_element element;
  skf_default_kernel kernel;
} draft;

static skf_status read_own_kernel(skf_reader *r, const skf_node *map, void *into) {
  draft *d = into;
  d->kernel.given = true;
  return skf_read_kernel(r, map, &d->kernel.kernel);
}

enum { SHAPE_KEYS = 12 };

typedef struct shape_table {
  skf_section section;
  skf_key keys[SHAPE_KEYS];
  skf_range ranges[SHAPE_KEYS];
} shape_table;

static const skf_key_type key_types[] = {
    [SKF_PARAM_NUMBER] = SKF_KEY_NUMBER,
    [SKF_PARAM_ANGLE] = SKF_KEY_ANGLE,
    [SKF_PARAM_VECTOR] = SKF_KEY_VECTOR,
    [SKF_PARAM_VECTORS] = SKF_KEY_VECTORS,
};

/* The registry's parameters, then strength and kernel. */
static void make_table(skf_shape shape, shape_table *t) {
  const skf_shape_info *info = skf_shape_get(shape);
  int n = 0;
  for (; n < info->param_count && n < SHAPE_KEYS - 2; n++) {
    const skf_param *p = info->params + n;
    double unit = p->type == SKF_PARAM_ANGLE ? 180 / SKF_PI : 1;
    t->ranges[n] = (skf_range){p->above * unit, p->upto * unit, true};
    t->keys[n] = (skf_key){.name = p->name,
                           .unit = p->unit,
                           .doc = p->doc,
                           .type = key_types[p->type],
                           .required = true,
                           .offset = offsetof(draft, element.primitive) + p->offset,
                           .range = t->ranges + n,
                           .count = p->count};
  }
  t->keys[n++] = (skf_key){.name = "strength", .type = SKF_KEY_NUMBER, .offset = offsetof(draft, element.strength)};
  t->keys[n++] = (skf_key){.name = "kernel", .type = SKF_KEY_OTHER, .read = read_own_kernel};
  t->section = (skf_section){info->name, info->doc, t->keys, n};
}

static skf_status one_kind(skf_reader *r, const skf_node *entry, long line) {
  char list[96] = "";
  for (int i = 0; i < SKF_SHAPE_COUNT; i++) {
    size_t n = strlen(list);
    snprintf(list + n, sizeof list - n, "%s%s", i ? ", " : "", skf_shape_get((skf_shape)i)->name);
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

static int find_shape(const char *name) {
  int i = 0;
  while (i < SKF_SHAPE_COUNT && strcmp(skf_shape_get((skf_shape)i)->name, name) != 0) i++;
  return i;
}

/* What the numbers mean together. */
static skf_status check(skf_reader *r, const draft *d, const shape_table *table, const skf_node *kind,
                        const skf_node *value) {
  const char *why;
  skf_status s = skf_primitive_check(&d->element.primitive, &why);
  if (s) return skf_error_set(r->error, s, kind->line, "%s, expected a proper %s", why, table->section.name);
  if (d->element.primitive.shape != SKF_PLANE && !isfinite(skf_primitive_measure(&d->element.primitive)))
    return skf_error_set(r->error, SKF_ERR_RANGE, kind->line, "measure of the %s overflows, expected smaller numbers",
                         table->section.name);
  if (d->element.strength == 0)
    return skf_error_set(r->error, SKF_ERR_RANGE, skf_map_line(r, value, "strength"),
                         "strength is 0, expected another number (a primitive of strength 0 is none)");
  if (d->kernel.given) return SKF_OK;
  return skf_error_set(r->error, SKF_ERR_PARSE, kind->line,
                       "no kernel for this %s, expected 'kernel' in it or in its body", table->section.name);
}

static skf_status read_entry(skf_reader *r, const skf_node *entry, const shape_table *tables,
                             const skf_default_kernel *kernel, skf_element *out) {
  const skf_node *kind = entry->type == SKF_NODE_MAP ? skf_node_first(&r->yaml, entry) : NULL;
  if (!kind) return one_kind(r, entry, entry->line);
  const skf_node *value = skf_node_next(&r->yaml, kind), *second = skf_node_next(&r->yaml, value);
  if (second) return one_kind(r, entry, second->line);
  int shape = kind->type == SKF_NODE_SCALAR ? find_shape(skf_node_text(&r->yaml, kind)) : SKF_SHAPE_COUNT;
  if (shape == SKF_SHAPE_COUNT) return one_kind(r, entry, kind->line);
  draft d = {.element = {.primitive = {.shape = (skf_shape)shape}, .strength = 1}, .kernel = *kernel};
  skf_status s = skf_read_map(r, value, &tables[shape].section, &d, NULL);
  if (!s) s = check(r, &d, tables + shape, kind, value);
  if (s) return s;
  *out = d.element;
  out->kernel = d.kernel.kernel;
  return SKF_OK;
}

skf_status skf_read_skeleton(skf_reader *r, const skf_node *list, const skf_default_kernel *kernel, skf_body *body) {
  shape_table tables[SKF_SHAPE_COUNT];
  for (int i = 0; i < SKF_SHAPE_COUNT; i++) make_table((skf_shape)i, tables + i);
  body->elements = skf_alloc((size_t)list->count, sizeof *body->elements);
  body->element_lines = skf_alloc((size_t)list->count, sizeof *body->element_lines);
  if (!body->elements || !body->element_lines) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  for (const skf_node *n = skf_node_first(&r->yaml, list); n; n = skf_node_next(&r->yaml, n)) {
    size_t i = body->element_count++;
    body->element_lines[i] = n->line;
    skf_status s = read_entry(r, n, tables, kernel, body->elements + i);
    if (s) return s;
  }
  return SKF_OK;
}
