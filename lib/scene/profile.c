/* SPDX-License-Identifier: MIT */
#include "scene/profile.h"
#include "core/alloc.h"
#include <string.h>

static const char form[] = "constant, hat, sin2, {linear: [from, to]} or {cubic: [[t, value, slope], ...]}";

static skf_status read_numbers(skf_reader *r, const skf_node *list, const char *name, const char *expected, int n,
                               double *out) {
  skf_status s = skf_expect(r, list, SKF_NODE_LIST, name, expected);
  if (!s && list->count != n)
    s = skf_error_set(r->error, SKF_ERR_PARSE, list->line, "%s has %d entries, expected %s", name, list->count,
                      expected);
  const skf_key one = {.name = name, .type = SKF_KEY_NUMBER};
  const skf_node *at = s ? NULL : skf_node_first(&r->yaml, list);
  for (int i = 0; i < n && !s; i++, at = skf_node_next(&r->yaml, at)) s = skf_read_number(r, at, &one, out + i);
  return s;
}

static skf_status read_knots(skf_reader *r, const skf_node *list, skf_profile_knot *knots) {
  skf_status s = SKF_OK;
  for (const skf_node *n = skf_node_first(&r->yaml, list); n && !s; n = skf_node_next(&r->yaml, n), knots++) {
    double x[3];
    s = read_numbers(r, n, "a knot", "[t, value, slope]", 3, x);
    if (!s) *knots = (skf_profile_knot){x[0], x[1], x[2]};
  }
  return s;
}

static skf_status misfit(skf_reader *r, const skf_node *node) {
  return skf_error_set(r->error, SKF_ERR_PARSE, node->line, "unknown profile, expected %s", form);
}

/* The type of a profile in words, SKF_PROFILE_COUNT for a constant; *list gets its numbers. */
static skf_status read_type(skf_reader *r, const skf_node *node, skf_profile_type *type, const skf_node **list) {
  static const struct {
    const char *name;
    skf_profile_type type;
    bool list;
  } words[] = {{"constant", SKF_PROFILE_COUNT, false},
               {"hat", SKF_PROFILE_HAT, false},
               {"sin2", SKF_PROFILE_SINE, false},
               {"linear", SKF_PROFILE_LINEAR, true},
               {"cubic", SKF_PROFILE_CUBIC, true}};
  bool map = node->type == SKF_NODE_MAP;
  const skf_node *word = map ? skf_node_first(&r->yaml, node) : node;
  if (!word || word->type != SKF_NODE_SCALAR) return misfit(r, node);
  *list = map ? skf_node_next(&r->yaml, word) : NULL;
  if (map && skf_node_next(&r->yaml, *list)) return misfit(r, node);
  for (size_t i = 0; i < sizeof words / sizeof *words; i++)
    if (words[i].list == map && strcmp(skf_node_text(&r->yaml, word), words[i].name) == 0)
      return *type = words[i].type, SKF_OK;
  return misfit(r, node);
}

static skf_status fill(skf_reader *r, const skf_node *list, skf_profile *p, skf_profile_knot *knots) {
  skf_status s = SKF_OK;
  if (p->type == SKF_PROFILE_LINEAR) s = read_numbers(r, list, "linear", "[from, to]", 2, p->ends);
  if (p->type == SKF_PROFILE_CUBIC) {
    p->knots = knots, p->knot_count = (size_t)list->count;
    s = read_knots(r, list, knots);
  }
  const char *why;
  if (s || !(s = skf_profile_check(p, &why))) return s;
  return skf_error_set(r->error, s, list ? list->line : 0, "%s", why);
}

/* Each its part, by length. */
static void share(skf_element *elements, size_t n, skf_profile *p) {
  double total = 0, done = 0;
  for (size_t i = 0; i < n; i++) total += skf_primitive_measure(&elements[i].primitive);
  for (size_t i = 0; i < n; i++) {
    p[i] = p[0];
    elements[i].profile = p + i;
  }
  for (size_t i = 0; i < n && n > 1; i++) {
    p[i].from = done / total;
    done += skf_primitive_measure(&elements[i].primitive);
    p[i].to = i + 1 < n ? done / total : 1;
  }
}

skf_status skf_profile_apply(skf_reader *r, const skf_node *node, const char *kind, skf_element *elements, size_t n,
                             skf_profile **block) {
  skf_profile_type type = SKF_PROFILE_COUNT;
  const skf_node *list = NULL;
  *block = NULL;
  skf_status s = read_type(r, node, &type, &list);
  if (s || type == SKF_PROFILE_COUNT) return s;
  for (size_t i = 0; i < n; i++)
    if (elements[i].primitive.shape != SKF_SEGMENT && elements[i].primitive.shape != SKF_ARC)
      return skf_error_set(r->error, SKF_ERR_ARG, node->line, "a profile on a %s, expected it on curves alone", kind);
  size_t knots = type == SKF_PROFILE_CUBIC && list->type == SKF_NODE_LIST ? (size_t)list->count : 0;
  if (type == SKF_PROFILE_CUBIC && (s = skf_expect(r, list, SKF_NODE_LIST, "cubic", "[[t, value, slope], ...]")))
    return s;
  skf_profile *p = skf_alloc(1, n * sizeof *p + knots * sizeof(skf_profile_knot));
  if (!p) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  p->type = type;
  if ((s = fill(r, list, p, (skf_profile_knot *)(p + n)))) return skf_free(p), s;
  share(elements, n, p);
  return *block = p, SKF_OK;
}
