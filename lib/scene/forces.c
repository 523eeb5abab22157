/* SPDX-License-Identifier: MIT */
/* Forces besides the bodies' gravity. */
#include "scene/reader.h"
#include "core/alloc.h"
#include <string.h>

static skf_status read_type(skf_reader *r, const skf_node *node, void *into) {
  static const char *const types[] = {
      [SKF_FORCE_PUSH] = "push", [SKF_FORCE_DRAG] = "drag", [SKF_FORCE_DRAG_SQUARED] = "drag-squared"};
  int type = 0;
  skf_status s = skf_read_choice(r, node, "type", types, 3, &type);
  ((skf_force *)into)->type = (skf_force_type)type;
  return s;
}

static skf_status read_body(skf_reader *r, const skf_node *node, void *into) {
  skf_status s = skf_expect(r, node, SKF_NODE_SCALAR, "body", "a body's name");
  if (s) return s;
  const char *name = skf_node_text(&r->yaml, node);
  size_t i = 0;
  while (i < r->scene->body_count && strcmp(r->scene->bodies[i].name, name) != 0) i++;
  ((skf_force *)into)->body = i;
  if (i < r->scene->body_count) return SKF_OK;
  return skf_error_set(r->error, SKF_ERR_PARSE, node->line, "no body is called '%s', expected the name of a body",
                       skf_show(name).text);
}

enum { FORCE_TYPE, FORCE_ACCELERATION, FORCE_K, FORCE_BODY, FORCE_HEIGHT, FORCE_RADIUS, FORCE_CENTER, FORCE_KEYS };

static const skf_key force_keys[FORCE_KEYS] = {
    {"type", NULL, "a = acceleration; -k d (v - u); -k d |v - u| (v - u)", SKF_KEY_OTHER, true, .read = read_type,
     .form = "push, drag or drag-squared"},
    {"acceleration", "L/T^2", "of a push, inertial frame: uniform gravity, radiation pressure", SKF_KEY_VECTOR, false,
     .offset = offsetof(skf_force, push)},
    {"k", "1/T or 1/L", "of drag or drag-squared", SKF_KEY_NUMBER, false, .offset = offsetof(skf_force, k),
     .range = &skf_not_negative},
    {"body", NULL, "that the medium turns with, u (default: none, u = 0)", SKF_KEY_OTHER, .read = read_body,
     .form = "a body's name"},
    {"scale_height", "L",
     "d = exp(-(distance from center - radius) / scale_height) (default: "
     "1 everywhere)",
     SKF_KEY_NUMBER, false, .offset = offsetof(skf_force, scale_height), .range = &skf_positive},
    {"radius", "L", "where the density is 1 (default: 0)", SKF_KEY_NUMBER, false, .offset = offsetof(skf_force, radius),
     .range = &skf_not_negative},
    {"center", "L", "of the medium, in the body's frame (default: 0)", SKF_KEY_VECTOR, false,
     .offset = offsetof(skf_force, center)},
};
const skf_section skf_section_force = {
    "force", "what accelerates particles besides gravity; bodies that move, by push alone", force_keys, FORCE_KEYS};

static skf_status check(skf_reader *r, const skf_node *map, const skf_force *f, unsigned given) {
  bool push = f->type == SKF_FORCE_PUSH;
  for (int i = FORCE_ACCELERATION; i < FORCE_KEYS; i++)
    if ((given >> i & 1) && push != (i == FORCE_ACCELERATION))
      return skf_error_set(r->error, SKF_ERR_PARSE, skf_map_line(r, map, force_keys[i].name),
                           "unexpected '%s' in a %s, expected %s", force_keys[i].name, push ? "push" : "drag",
                           push ? "acceleration alone" : "k and what its medium is");
  const char *missing = push ? "acceleration" : "k";
  if (!(given >> (push ? FORCE_ACCELERATION : FORCE_K) & 1))
    return skf_error_set(r->error, SKF_ERR_PARSE, map->line, "missing '%s' in force, expected %s", missing,
                         push ? "[x, y, z]" : "a finite number >= 0");
  const char *name = r->scene->simulation.integrator;
  if (!r->scene->simulation.given || skf_integrator_takes(name, f)) return SKF_OK;
  return skf_error_set(r->error, SKF_ERR_PARSE, map->line, "integrator %s takes no %s, expected gauss-radau or dop853",
                       skf_integrator_find(name)->name, push ? "push" : "drag");
}

skf_status skf_read_forces(skf_reader *r, const skf_node *list) {
  skf_scene *scene = r->scene;
  skf_status s = skf_expect(r, list, SKF_NODE_LIST, "forces", "a list of forces");
  if (s) return s;
  scene->forces = skf_alloc((size_t)list->count, sizeof *scene->forces);
  if (!scene->forces) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  for (const skf_node *n = skf_node_first(&r->yaml, list); n && !s; n = skf_node_next(&r->yaml, n)) {
    skf_force *f = scene->forces + scene->force_count++;
    unsigned given;
    f->body = SKF_FORCE_AT_REST;
    s = skf_read_map(r, n, &skf_section_force, f, &given);
    if (!s) s = check(r, n, f, given);
  }
  return s;
}
