/* SPDX-License-Identifier: MIT */
/* How particles fly, and for how long. */
#include "scene/reader.h"
#include "core/alloc.h"
#include "core/vec3.h"
#include <stdint.h>
#include <stdlib.h>
#include <stdio.h>
#include <string.h>

static const skf_range tolerance = {0, 0.1, true};

static skf_status read_contact(skf_reader *r, const skf_node *node, void *into) {
  static const char *const modes[] = {
      [SKF_CONTACT_NONE] = "none",   [SKF_CONTACT_STOP] = "stop",     [SKF_CONTACT_BOUNCE] = "bounce",
      [SKF_CONTACT_STICK] = "stick", [SKF_CONTACT_ABSORB] = "absorb", [SKF_CONTACT_PASS] = "pass"};
  int mode = SKF_CONTACT_STOP;
  skf_status s = skf_read_choice(r, node, "contact", modes, SKF_CONTACT_COUNT, &mode);
  ((skf_simulation *)into)->contact = (skf_contact_mode)mode;
  return s;
}

static skf_status read_search(skf_reader *r, const skf_node *node, void *into) {
  static const char *const modes[] = {[SKF_SEARCH_CERTIFIED] = "certified", [SKF_SEARCH_FAST] = "fast"};
  int mode = SKF_SEARCH_CERTIFIED;
  skf_status s = skf_read_choice(r, node, "search", modes, 2, &mode);
  ((skf_simulation *)into)->search = (skf_search)mode;
  return s;
}

skf_status skf_read_frame(skf_reader *r, const skf_node *node, bool *turning) {
  static const char *const frames[] = {"inertial", "body"};
  int frame = 0;
  skf_status s = skf_read_choice(r, node, "frame", frames, 2, &frame);
  return *turning = frame == 1, s;
}

static skf_status read_frame(skf_reader *r, const skf_node *node, void *into) {
  return skf_read_frame(r, node, &((skf_simulation *)into)->turning);
}

/* Whether two bodies turn as one. */
static bool alike(const skf_spin *a, const skf_spin *b) {
  const double same = 1e-14; /* the rounding of numbers in files */
  skf_vec3 w = v3_scale(a->rate, v3_unit(a->axis)), d = v3_sub(b->about, a->about);
  bool axis = v3_norm(v3_cross(d, v3_unit(a->axis))) <= same * (v3_norm(a->about) + v3_norm(b->about));
  return axis && v3_dist(w, v3_scale(b->rate, v3_unit(b->axis))) <= same * v3_norm(w);
}

bool skf_scene_turning_body(const skf_scene *scene, size_t *body) {
  *body = SIZE_MAX;
  for (size_t i = 0; i < scene->body_count; i++) {
    const skf_spin *spin = &scene->bodies[i].spin;
    if (spin->rate == 0) continue;
    if (*body != SIZE_MAX && !alike(&scene->bodies[*body].spin, spin)) return false;
    if (*body == SIZE_MAX) *body = i;
  }
  return true;
}

skf_status skf_check_frame(skf_reader *r, long line) {
  size_t body;
  if (skf_scene_turning_body(r->scene, &body)) return SKF_OK;
  return skf_error_set(r->error, SKF_ERR_PARSE, line,
                       "frame is body, but bodies spin differently, expected frame: inertial");
}

static skf_status read_integrator(skf_reader *r, const skf_node *node, void *into) {
  char *out = ((skf_simulation *)into)->integrator;
  size_t size = sizeof((skf_simulation *)into)->integrator;
  skf_status s = skf_expect(r, node, SKF_NODE_SCALAR, "integrator", "an integrator's name");
  if (s) return s;
  const char *text = skf_node_text(&r->yaml, node);
  if (*text && strlen(text) < size && skf_integrator_find(text)) return strcpy(out, text), SKF_OK;
  char list[256] = "";
  for (size_t i = 0; i < skf_integrator_count() && strlen(list) + 40 < sizeof list; i++)
    snprintf(list + strlen(list), sizeof list - strlen(list), "%s%s", i ? ", " : "", skf_integrator_get(i)->name);
  return skf_error_set(r->error, SKF_ERR_PARSE, node->line, "integrator is %s, expected one of %s",
                       skf_quote(text).text, list);
}

static const skf_key simulation_keys[] = {
    {"t_end", "T", "end of the flight", SKF_KEY_NUMBER, true, .offset = offsetof(skf_simulation, t_end),
     .range = &skf_not_negative},
    {"output_every", "T", "between two rows of output", SKF_KEY_NUMBER, true,
     .offset = offsetof(skf_simulation, output_every), .range = &skf_positive},
    {"tolerance", "1", "relative error per step (default: 1e-12)", SKF_KEY_NUMBER, false,
     .offset = offsetof(skf_simulation, tolerance), .range = &tolerance},
    {"contact", NULL, "what happens at a surface (default: stop)", SKF_KEY_OTHER, .read = read_contact,
     .form = "none, stop, bounce, stick, absorb or pass"},
    {"restitution", "1", "of a bounce: normal speed after / before (default: 1)", SKF_KEY_NUMBER, false,
     .offset = offsetof(skf_simulation, restitution), .range = &skf_fraction},
    {"friction", "1", "of a bounce, Coulomb's coefficient (default: 0)", SKF_KEY_NUMBER, false,
     .offset = offsetof(skf_simulation, friction), .range = &skf_not_negative},
    {"rolling", "L", "of bodies that move: torque against rolling and turning, over the normal force (default: 0)",
     SKF_KEY_NUMBER, false, .offset = offsetof(skf_simulation, rolling), .range = &skf_not_negative},
    {"search", NULL, "for contacts: misses none, or stops at eighths of a step (default: certified)", SKF_KEY_OTHER,
     .read = read_search, .form = "certified or fast"},
    {"step", "T", "of integrators with a fixed step, which know no tolerance", SKF_KEY_NUMBER, false,
     .offset = offsetof(skf_simulation, step), .range = &skf_positive},
    {"integrator", NULL, "by name (default: the best for the tolerance)", SKF_KEY_OTHER, .read = read_integrator,
     .form = "an integrator's name"},
    {"softening", "L", "of the pull of particles with a mass, -G m / sqrt(r^2 + softening^2) (default: 0)",
     SKF_KEY_NUMBER, false, .offset = offsetof(skf_simulation, softening), .range = &skf_not_negative},
    {"frame", NULL, "of rows and contacts: inertial, or that of the body that spins (default: inertial)", SKF_KEY_OTHER,
     .read = read_frame, .form = "inertial or body"},
};
const skf_section skf_section_simulation = {"simulation", "how the particles fly", simulation_keys, 12};

skf_status skf_read_simulation(skf_reader *r, const skf_node *map, void *into) {
  skf_simulation *sim = &((skf_scene *)into)->simulation;
  sim->given = true;
  skf_status s = skf_read_map(r, map, &skf_section_simulation, sim, NULL);
  if (s) return s;
  const skf_integrator_info *integrator = skf_integrator_find(sim->integrator);
  if (integrator->adaptive && sim->step != 0)
    return skf_error_set(r->error, SKF_ERR_PARSE, skf_map_line(r, map, "step"),
                         "step given, but %s chooses its own, expected an integrator with a fixed step",
                         integrator->name);
  if (!integrator->adaptive && sim->step == 0)
    return skf_error_set(r->error, SKF_ERR_PARSE, skf_map_line(r, map, "integrator"),
                         "%s takes steps of one length, expected step", integrator->name);
  if (sim->t_end / sim->output_every <= 1e9) return s; /* rows for each particle */
  return skf_error_set(r->error, SKF_ERR_RANGE, skf_map_line(r, map, "output_every"),
                       "more than 1e9 output times, expected a larger output_every");
}
