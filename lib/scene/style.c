/* SPDX-License-Identifier: MIT */
#include "scene/style.h"
#include "core/alloc.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

const skf_style skf_no_style = {.strength = NAN};

static skf_status accept(skf_reader *r, const skf_node *value, void *into) {
  return (void)r, (void)value, (void)into, SKF_OK;
}

skf_status skf_read_kernel(skf_reader *r, const skf_node *map, skf_style *out) {
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
  out->has_kernel = true, out->kernel_line = map->line;
  out->kernel = (skf_kernel){(skf_kernel_type)chosen, 1};
  const skf_key keys[] = {
      {"type", .type = SKF_KEY_OTHER, .required = true, .read = accept},
      {info->param, .type = SKF_KEY_NUMBER, .offset = offsetof(skf_kernel, param), .range = &skf_positive},
  };
  char name[64];
  unsigned given = 0;
  snprintf(name, sizeof name, "kernel %s", info->name);
  s = skf_read_map(r, map, &(skf_section){name, NULL, keys, info->param ? 2 : 1}, &out->kernel, &given);
  out->has_param = given >> 1 & 1;
  return s;
}

static void take(skf_style *to, const skf_style *from) {
  if (!to->has_kernel) {
    to->has_kernel = from->has_kernel, to->has_param = from->has_param;
    to->kernel = from->kernel, to->kernel_line = from->kernel_line;
  }
  if (isnan(to->strength)) to->strength = from->strength;
  if (to->handles.radius == 0) to->handles.radius = from->handles.radius;
  if (to->handles.blobbiness == 0) to->handles.blobbiness = from->handles.blobbiness;
  if (to->handles.influence == 0) to->handles.influence = from->handles.influence;
}

void skf_style_inherit(skf_style *to, const skf_style *from) {
  if (to->material) take(to, &to->material->style);
  take(to, from);
  if (from->material) take(to, &from->material->style);
}

static skf_status read_kernel(skf_reader *r, const skf_node *map, void *into) {
  return skf_read_kernel(r, map, &((skf_material *)into)->style);
}

static skf_status read_texture(skf_reader *r, const skf_node *value, void *into) {
  return skf_read_textures(r, value, &((skf_material *)into)->look);
}

static const skf_range indices = {0.1, 10, false};

static const skf_key material_keys[] = {
    {"name", NULL, "unique among the materials", SKF_KEY_NAME, true, .offset = offsetof(skf_material, name)},
    {"kernel", NULL, "without its parameter where handles give it", SKF_KEY_OTHER, .read = read_kernel,
     .form = "{type: ...}"},
    {"strength", "1", "factor of the field, not 0", SKF_KEY_NUMBER, .offset = offsetof(skf_material, style.strength)},
    SKF_RADIUS_KEY(skf_material, style),
    SKF_BLOBBINESS_KEY(skf_material, style),
    SKF_INFLUENCE_KEY(skf_material, style),
    {"color", "1", "linear light that the matt body sends back", SKF_KEY_COLOR,
     .offset = offsetof(skf_material, look.color)},
    {"ambient", "1", "share of the sky's light (default: 1)", SKF_KEY_NUMBER,
     .offset = offsetof(skf_material, look.ambient), .range = &skf_not_negative},
    {"diffuse", "1", "share of the lights' light (default: 1)", SKF_KEY_NUMBER,
     .offset = offsetof(skf_material, look.diffuse), .range = &skf_not_negative},
    {"specular", "1", "of its gloss, seen from the front (default: 0.04)", SKF_KEY_SHARE,
     .offset = offsetof(skf_material, look.specular)},
    {"shine", "1", "Phong's exponent of the gloss (default: 10.5)", SKF_KEY_NUMBER,
     .offset = offsetof(skf_material, look.shine), .range = &skf_positive},
    {"reflection", "1", "share that it mirrors (default: 0)", SKF_KEY_SHARE,
     .offset = offsetof(skf_material, look.reflection)},
    {"transparency", "1", "share that each surface lets through (default: 0)", SKF_KEY_SHARE,
     .offset = offsetof(skf_material, look.transparency)},
    {"ior", "1", "index of refraction (default: 1)", SKF_KEY_NUMBER, .offset = offsetof(skf_material, look.ior),
     .range = &indices},
    {"texture", NULL, "see below; up to 4, whose colours multiply", SKF_KEY_OTHER, .read = read_texture,
     .form = "{type: ...}, or a list of them"},
};
enum { COLOR = 6, AMBIENT, DIFFUSE, SPECULAR, SHINE, REFLECTION, TRANSPARENCY, IOR, TEXTURE, MATERIAL_KEYS };
const skf_section skf_section_material = {"material", "what bodies and primitives may share, by its name",
                                          material_keys, MATERIAL_KEYS};

static skf_status refuse_repeated(skf_reader *r, const skf_node *map, size_t i) {
  for (size_t k = 0; k < i; k++)
    if (strcmp(r->materials[k].name, r->materials[i].name) == 0)
      return skf_error_set(r->error, SKF_ERR_PARSE, skf_map_line(r, map, "name"),
                           "a second material is called '%s', expected different names",
                           skf_show(r->materials[i].name).text);
  return SKF_OK;
}

skf_status skf_read_materials(skf_reader *r, const skf_node *list, void *scene) {
  (void)scene;
  if (r->materials) return SKF_OK; /* they are read before everything else */
  skf_status s = skf_expect(r, list, SKF_NODE_LIST, "materials", "a list of materials");
  if (s) return s;
  r->materials = skf_alloc((size_t)list->count, sizeof *r->materials);
  if (!r->materials) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  for (const skf_node *n = skf_node_first(&r->yaml, list); n && !s; n = skf_node_next(&r->yaml, n)) {
    skf_material *m = r->materials + r->material_count++;
    m->style = skf_no_style;
    s = skf_read_map(r, n, &skf_section_material, m, &m->given);
    if (!s) s = refuse_repeated(r, n, r->material_count - 1);
    if (!s && m->style.strength == 0)
      s = skf_error_set(r->error, SKF_ERR_RANGE, skf_map_line(r, n, "strength"),
                        "strength is 0, expected another number");
  }
  return s;
}

void skf_material_paint(const skf_material *m, skf_look *to) {
  if (!m) return;
  const skf_look *l = &m->look;
  const struct {
    int key;
    size_t size;
    void *to;
    const void *from;
  } parts[] = {
      {COLOR, sizeof l->color, to->color, l->color},
      {AMBIENT, sizeof l->ambient, &to->ambient, &l->ambient},
      {DIFFUSE, sizeof l->diffuse, &to->diffuse, &l->diffuse},
      {SPECULAR, sizeof l->specular, to->specular, l->specular},
      {SHINE, sizeof l->shine, &to->shine, &l->shine},
      {REFLECTION, sizeof l->reflection, to->reflection, l->reflection},
      {TRANSPARENCY, sizeof l->transparency, to->transparency, l->transparency},
      {IOR, sizeof l->ior, &to->ior, &l->ior},
      {TEXTURE, sizeof l->texture_count, &to->texture_count, &l->texture_count},
      {TEXTURE, sizeof l->textures, to->textures, l->textures},
  };
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
    if (m->given >> parts[i].key & 1) memcpy(parts[i].to, parts[i].from, parts[i].size);
}

void skf_materials_free(skf_reader *r) {
  for (size_t i = 0; i < r->material_count; i++) skf_free(r->materials[i].name);
  skf_free(r->materials);
}

skf_status skf_read_material(skf_reader *r, const skf_node *node, skf_style *out) {
  char list[200] = "";
  skf_status s = skf_expect(r, node, SKF_NODE_SCALAR, "material", "a material's name");
  if (s) return s;
  const char *name = skf_node_text(&r->yaml, node);
  for (size_t i = 0; i < r->material_count; i++) {
    if (strcmp(r->materials[i].name, name) == 0) return out->material = r->materials + i, SKF_OK;
    size_t n = strlen(list);
    snprintf(list + n, sizeof list - n, "%s%s", i ? ", " : "", r->materials[i].name);
  }
  if (!r->material_count)
    return skf_error_set(r->error, SKF_ERR_PARSE, node->line,
                         "no material is called '%s', expected 'materials' in the scene", skf_show(name).text);
  return skf_error_set(r->error, SKF_ERR_PARSE, node->line, "no material is called '%s', expected one of %s",
                       skf_show(name).text, list);
}

skf_status skf_style_apply(skf_reader *r, const skf_style *style, double iso, const char *name, long line,
                           skf_element *elements, size_t n) {
  const skf_handles *h = &style->handles;
  const skf_kernel_info *info = skf_kernel_get(style->kernel.type);
  unsigned fixed = (style->has_param ? SKF_FIXED_PARAM : 0) | (isnan(style->strength) ? 0 : SKF_FIXED_STRENGTH);
  if (h->radius == 0 && h->blobbiness == 0 && h->influence == 0) {
    if (style->has_param || !info->param) return SKF_OK;
    return skf_error_set(r->error, SKF_ERR_PARSE, style->kernel_line,
                         "missing '%s' in kernel %s, expected a finite number > 0", info->param, info->name);
  }
  const char *why = NULL;
  skf_status s = skf_handles_solve(h, iso, fixed, elements, n, NULL, &why);
  return s ? skf_error_set(r->error, s, line, "%s: %s", name, why ? why : skf_status_text(s)) : SKF_OK;
}
