/* SPDX-License-Identifier: MIT */
#include "scene/skeleton.h"
#include "core/alloc.h"
#include "core/vec3.h"
#include "scene/profile.h"
#include <stdio.h>
#include <string.h>

static skf_status read_own_kernel(skf_reader *r, const skf_node *map, void *into) {
  return skf_read_kernel(r, map, &((skf_entry *)into)->style);
}

static skf_status read_own_material(skf_reader *r, const skf_node *name, void *into) {
  return skf_read_material(r, name, &((skf_entry *)into)->style);
}

static skf_status keep_profile(skf_reader *r, const skf_node *value, void *into) {
  (void)r;
  ((skf_entry *)into)->profile = value;
  return SKF_OK;
}

const skf_key skf_entry_keys[SKF_ENTRY_KEYS] = {
    {"strength", "1", "factor of its field, not 0 (default: 1)", SKF_KEY_NUMBER,
     .offset = offsetof(skf_entry, style.strength)},
    {"kernel", NULL, "instead of the body's", SKF_KEY_OTHER, .read = read_own_kernel, .form = "{type: ...}"},
    SKF_RADIUS_KEY(skf_entry, style),
    SKF_BLOBBINESS_KEY(skf_entry, style),
    SKF_INFLUENCE_KEY(skf_entry, style),
    {"material", NULL, "whose properties it has where it is silent", SKF_KEY_OTHER, .read = read_own_material,
     .form = "a material's name"},
    {"profile", "1", "of curves: weight from end to end, see below", SKF_KEY_OTHER, .read = keep_profile,
     .form = "hat, sin2, {linear: ...}, ..."},
    {"color", "1", "linear light, mixed along the surface", SKF_KEY_COLOR, .offset = offsetof(skf_entry, color)},
};

enum { ENTRY_KEYS = SKF_HELIX_KEYS + SKF_ENTRY_KEYS, KINDS = SKF_SHAPE_COUNT + SKF_COMPOUND_COUNT };

/* The keys of one kind of entry: a primitive's, or a compound's. */
typedef struct entry_table {
  skf_section section;
  skf_key keys[ENTRY_KEYS];
  skf_range ranges[ENTRY_KEYS];
} entry_table;

static const skf_key_type key_types[] = {
    [SKF_PARAM_NUMBER] = SKF_KEY_NUMBER,   [SKF_PARAM_ANGLE] = SKF_KEY_ANGLE, [SKF_PARAM_VECTOR] = SKF_KEY_VECTOR,
    [SKF_PARAM_VECTORS] = SKF_KEY_VECTORS, [SKF_PARAM_SOLID] = SKF_KEY_OTHER,
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
  for (; n < info->param_count && n < ENTRY_KEYS - SKF_ENTRY_KEYS; n++) {
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
    if (p->type == SKF_PARAM_SOLID) t->keys[n].read = skf_keep_file, t->keys[n].form = "a file name";
  }
  return n;
}

/* The kind's own keys, then those of all. */
static void make_table(int kind, entry_table *t) {
  int n = own_keys(kind, t);
  int own = n;
  for (int i = 0; i < SKF_ENTRY_KEYS; i++) {
    t->keys[n] = skf_entry_keys[i];
    for (int k = 0; k < own; k++) /* an arc's radius is its own */
      if (strcmp(t->keys[k].name, t->keys[n].name) == 0) t->keys[n].name = SKF_OTHER_RADIUS;
    n++;
  }
  t->section = (skf_section){kind_name(kind), NULL, t->keys, n};
}

static skf_status one_kind(skf_reader *r, const skf_node *entry, long line) {
  char list[160] = "";
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

/* The second key of an entry: another kind, or one that belongs into the kind's own mapping. */
static skf_status one_key(skf_reader *r, const skf_node *entry, const skf_node *kind, const skf_node *second) {
  const char *word = second->type == SKF_NODE_SCALAR ? skf_node_text(&r->yaml, second) : "";
  if (!*word || kind->type != SKF_NODE_SCALAR || find_kind(word) < KINDS) return one_kind(r, entry, second->line);
  return skf_error_set(r->error, SKF_ERR_PARSE, second->line,
                       "'%s' beside '%s' in a skeleton entry, expected it within", skf_show(word).text,
                       skf_show(skf_node_text(&r->yaml, kind)).text);
}

static skf_status grow(skf_reader *r, skf_pieces *into) {
  skf_body *b = into->body;
  size_t n = 2 * into->capacity + 8;
  skf_element *elements = skf_realloc(b->elements, n, sizeof *elements);
  if (elements) b->elements = elements;
  long *lines = elements ? skf_realloc(b->element_lines, n, sizeof *lines) : NULL;
  if (!lines) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  b->element_lines = lines;
  unsigned char *looks = skf_realloc(b->look_of, n, 1);
  if (!looks) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  b->look_of = looks;
  into->capacity = n;
  return SKF_OK;
}

/* Squares of what is larger, and of its differences, overflow. */
static const double farthest = 1e153;

static bool is_beyond(const skf_primitive *p) {
  const skf_shape_info *info = skf_shape_get(p->shape);
  for (int i = 0; i < info->param_count; i++) {
    const skf_param *a = info->params + i;
    if (a->type == SKF_PARAM_SOLID || strcmp(a->unit, "L") != 0) continue;
    const double *x = (const double *)((const char *)p + a->offset);
    for (int k = 0; k < (a->type == SKF_PARAM_NUMBER ? 1 : 3 * a->count); k++)
      if (fabs(x[k]) > farthest) return true;
  }
  return false;
}

skf_status skf_add_piece(skf_reader *r, const skf_entry *e, const skf_primitive *p, skf_pieces *into) {
  const char *why;
  skf_body *b = into->body;
  skf_status s = skf_primitive_check(p, &why);
  if (s) return skf_error_set(r->error, s, e->kind->line, "%s, expected a proper %s", why, e->name);
  if (p->shape != SKF_PLANE && !isfinite(skf_primitive_measure(p)))
    return skf_error_set(r->error, SKF_ERR_RANGE, e->kind->line,
                         "measure of the %s overflows, expected smaller numbers", e->name);
  if (is_beyond(p))
    return skf_error_set(r->error, SKF_ERR_RANGE, e->kind->line,
                         "a length in the %s is beyond %g, expected smaller ones", e->name, farthest);
  if (b->element_count == into->capacity && (s = grow(r, into))) return s;
  b->element_lines[b->element_count] = e->kind->line, b->look_of[b->element_count] = 0;
  b->elements[b->element_count++] = (skf_element){
      .primitive = *p, .kernel = e->style.kernel, .strength = isnan(e->style.strength) ? 1 : e->style.strength};
  return SKF_OK;
}

/* What all kinds of entries share. */
static skf_status check_entry(skf_reader *r, const skf_entry *e, const skf_node *value) {
  if (e->style.strength == 0)
    return skf_error_set(r->error, SKF_ERR_RANGE, skf_map_line(r, value, "strength"),
                         "strength is 0, expected another number (a primitive of strength 0 is none)");
  if (e->style.has_kernel) return SKF_OK;
  return skf_error_set(r->error, SKF_ERR_PARSE, e->kind->line,
                       "no kernel for this %s, expected 'kernel' in it or in its body", e->name);
}

/* The profile of the pieces from `first` on; the body keeps it. */
static skf_status weigh(skf_reader *r, const skf_entry *e, size_t first, skf_pieces *into) {
  skf_body *b = into->body;
  if (b->profile_count == into->profile_capacity) {
    size_t n = 2 * into->profile_capacity + 8;
    skf_profile **more = skf_realloc(b->profiles, n, sizeof *more);
    if (!more) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
    b->profiles = more, into->profile_capacity = n;
  }
  skf_profile *block;
  skf_status s = skf_profile_apply(r, e->profile, e->name, b->elements + first, b->element_count - first, &block);
  if (block) b->profiles[b->profile_count++] = block;
  return s;
}

/* Handles give the pieces from `first` on their parameter and strength; the body remembers which. */
static skf_status handle(skf_reader *r, const skf_entry *e, size_t first, skf_pieces *into) {
  skf_body *b = into->body;
  const skf_handles *h = &e->style.handles;
  size_t n = b->element_count - first;
  skf_status s = skf_style_apply(r, &e->style, b->iso, e->name, e->kind->line, b->elements + first, n);
  if (s || (h->radius == 0 && h->blobbiness == 0 && h->influence == 0)) return s;
  if (b->handled_count == into->handled_capacity) {
    into->handled_capacity = 2 * into->handled_capacity + 8;
    skf_handled *more = skf_realloc(b->handled, into->handled_capacity, sizeof *more);
    if (!more) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
    b->handled = more;
  }
  b->handled[b->handled_count++] = (skf_handled){first, n, e->name};
  return SKF_OK;
}

static bool same_color(const double a[3], const double b[3]) {
  return isnan(a[0]) ? isnan(b[0]) : a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static skf_status add_look(skf_reader *r, const skf_entry *e, skf_pieces *into) {
  skf_body *b = into->body;
  if (b->look_count == SKF_LOOKS)
    return skf_error_set(r->error, SKF_ERR_RANGE, e->kind->line, "more than %d looks in a body, expected fewer colours",
                         SKF_LOOKS);
  if (b->look_count >= into->look_capacity) {
    size_t n = 2 * into->look_capacity + 4;
    skf_look *looks = skf_realloc(b->looks, n, sizeof *looks);
    if (looks) b->looks = looks;
    skf_look_key *keys = looks ? skf_realloc(into->look_keys, n, sizeof *keys) : NULL;
    if (!keys) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
    into->look_keys = keys, into->look_capacity = n;
  }
  skf_look *look = b->looks + b->look_count;
  *look = b->looks[0];
  skf_material_paint(e->style.material, look);
  if (!isnan(e->color[0])) memcpy(look->color, e->color, sizeof look->color);
  into->look_keys[b->look_count] = (skf_look_key){e->style.material, {e->color[0], e->color[1], e->color[2]}};
  b->look_count++;
  return SKF_OK;
}

/* The pieces from `first` on look like the entry: like the body where it says nothing. */
static skf_status paint(skf_reader *r, const skf_entry *e, size_t first, skf_pieces *into) {
  skf_body *b = into->body;
  size_t i = 1;
  if (!e->style.material && isnan(e->color[0])) return SKF_OK;
  while (i < b->look_count &&
         (into->look_keys[i].material != e->style.material || !same_color(into->look_keys[i].color, e->color)))
    i++;
  skf_status s = i == b->look_count ? add_look(r, e, into) : SKF_OK;
  for (size_t k = first; k < b->element_count && !s; k++) b->look_of[k] = (unsigned char)i;
  return s;
}

/* What an entry that was not added holds. */
static void release(const skf_entry *e) {
  if (e->element.primitive.shape == SKF_SOLID) skf_solid_free(e->element.primitive.solid);
}

static skf_status read_entry(skf_reader *r, const skf_node *entry, const entry_table *tables, const skf_style *style,
                             skf_pieces *into) {
  const skf_node *word = entry->type == SKF_NODE_MAP ? skf_node_first(&r->yaml, entry) : NULL;
  if (!word) return one_kind(r, entry, entry->line);
  const skf_node *value = skf_node_next(&r->yaml, word), *second = skf_node_next(&r->yaml, value);
  if (second) return one_key(r, entry, word, second);
  int kind = word->type == SKF_NODE_SCALAR ? find_kind(skf_node_text(&r->yaml, word)) : KINDS;
  if (kind == KINDS) return one_kind(r, entry, word->line);
  bool simple = kind < SKF_SHAPE_COUNT;
  skf_entry e = {.element = {.primitive.shape = simple ? (skf_shape)kind : SKF_POINT},
                 .style = skf_no_style,
                 .helix.end_radius = -1,
                 .axis = {0, 0, 1},
                 .color = {NAN},
                 .name = kind_name(kind),
                 .kind = word,
                 .map = value};
  skf_status s = skf_read_map(r, value, &tables[kind].section, &e, NULL);
  skf_style_inherit(&e.style, style);
  if (!s && kind == SKF_SOLID) s = skf_read_solid(r, &e);
  if (!s) s = check_entry(r, &e, value);
  if (s) return release(&e), s;
  size_t first = into->body->element_count;
  s = simple ? skf_add_piece(r, &e, &e.element.primitive, into)
             : skf_compounds[kind - SKF_SHAPE_COUNT].expand(r, &e, into);
  if (!s && e.profile) s = weigh(r, &e, first, into);
  if (s && into->body->element_count == first) release(&e);
  if (!s) s = paint(r, &e, first, into);
  return s ? s : handle(r, &e, first, into);
}

skf_status skf_read_skeleton(skf_reader *r, const skf_node *list, const skf_style *style, skf_body *body) {
  entry_table tables[KINDS];
  skf_pieces pieces = {.body = body};
  skf_status s = SKF_OK;
  for (int i = 0; i < KINDS; i++) make_table(i, tables + i);
  for (const skf_node *n = skf_node_first(&r->yaml, list); n && !s; n = skf_node_next(&r->yaml, n))
    s = read_entry(r, n, tables, style, &pieces);
  skf_free(pieces.look_keys);
  return s;
}
