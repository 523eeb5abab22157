/* SPDX-License-Identifier: MIT */
/* What moves among the bodies, and for how long. */
#include "scene/reader.h"
#include "core/alloc.h"
#include "core/vec3.h"
#include <stdlib.h>
#include <stdio.h>
#include <string.h>

static const skf_range latitude = {-90, 90, false}, turn = {-360, 360, false}, tolerance = {0, 0.1, true};

static skf_status accept(skf_reader *r, const skf_node *value, void *into) {
  return (void)r, (void)value, (void)into, SKF_OK;
}

static const skf_key launch_keys[] = {
    {"body", NULL, "name of a body with an ellipsoid", SKF_KEY_OTHER, true, .read = accept, .form = "a body's name"},
    {"latitude", "deg", "north of the equator", SKF_KEY_ANGLE, true, .offset = offsetof(skf_launch, latitude),
     .range = &latitude},
    {"longitude", "deg", "east of the meridian", SKF_KEY_ANGLE, true, .offset = offsetof(skf_launch, longitude),
     .range = &turn},
    {"height", "L", "above the ellipsoid (default: 0)", SKF_KEY_NUMBER, false, .offset = offsetof(skf_launch, height)},
    {"azimuth", "deg", "clockwise from north (default: 0)", SKF_KEY_ANGLE, false,
     .offset = offsetof(skf_launch, azimuth), .range = &turn},
    {"elevation", "deg", "above the horizon (default: 0)", SKF_KEY_ANGLE, false,
     .offset = offsetof(skf_launch, elevation), .range = &latitude},
    {"speed", "L/T", "relative to the body's ground", SKF_KEY_NUMBER, true, .offset = offsetof(skf_launch, speed),
     .range = &skf_not_negative},
};
const skf_section skf_section_launch = {"launch", "a start on a body's ellipsoid", launch_keys, 7};

static skf_status read_launch(skf_reader *r, const skf_node *map, void *into) {
  skf_launch *launch = &((skf_particle *)into)->launch;
  launch->given = true;
  return skf_read_map(r, map, &skf_section_launch, launch, NULL);
}

enum { PARTICLE_NAME, PARTICLE_POSITION, PARTICLE_VELOCITY, PARTICLE_LAUNCH, PARTICLE_KEYS };

static const skf_key particle_keys[PARTICLE_KEYS] = {
    {"name", NULL, "unique among the particles", SKF_KEY_NAME, true, .offset = offsetof(skf_particle, name)},
    {"position", "L", "at t = 0, inertial frame", SKF_KEY_VECTOR, false, .offset = offsetof(skf_particle, position)},
    {"velocity", "L/T", "at t = 0, inertial frame", SKF_KEY_VECTOR, false, .offset = offsetof(skf_particle, velocity)},
    {"launch", NULL, "instead of position and velocity", SKF_KEY_OTHER, .read = read_launch,
     .form = "{body, latitude, longitude, speed, ...}"},
};
const skf_section skf_section_particle = {"particle", "a point without mass of its own", particle_keys, PARTICLE_KEYS};

static skf_status read_particle(skf_reader *r, const skf_node *map, skf_particle *p) {
  unsigned given;
  p->line = map->line;
  skf_status s = skf_read_map(r, map, &skf_section_particle, p, &given);
  if (s) return s;
  bool position = given >> PARTICLE_POSITION & 1, velocity = given >> PARTICLE_VELOCITY & 1;
  if (p->launch.given && (position || velocity))
    return skf_error_set(r->error, SKF_ERR_PARSE, skf_map_line(r, map, position ? "position" : "velocity"),
                         "both launch and %s, expected launch alone or position and velocity",
                         position ? "position" : "velocity");
  if (p->launch.given || (position && velocity)) return SKF_OK;
  return skf_error_set(r->error, SKF_ERR_PARSE, map->line, "missing '%s' in particle, expected [x, y, z]",
                       position ? "velocity" : "position");
}

static const char *name_at(const skf_scene *scene, size_t i) { return scene->particles[i].name; }

skf_status skf_read_particles(skf_reader *r, const skf_node *list, void *into) {
  skf_scene *scene = into;
  skf_status s = skf_expect(r, list, SKF_NODE_LIST, "particles", "a list of particles");
  if (s) return s;
  scene->particles = skf_alloc((size_t)list->count, sizeof *scene->particles);
  if (!scene->particles) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  for (const skf_node *n = skf_node_first(&r->yaml, list); n && !s; n = skf_node_next(&r->yaml, n))
    s = read_particle(r, n, scene->particles + scene->particle_count++);
  return s ? s : skf_refuse_duplicates(r, list, "particle", scene->particle_count, name_at);
}

static skf_status resolve(skf_reader *r, const skf_node *launch, skf_launch *out) {
  const skf_node *node = skf_map_find(r, launch, "body");
  skf_status s = skf_expect(r, node, SKF_NODE_SCALAR, "body", "a body's name");
  if (s) return s;
  const char *name = skf_node_text(&r->yaml, node);
  size_t i = 0;
  while (i < r->scene->body_count && strcmp(r->scene->bodies[i].name, name) != 0) i++;
  if (i == r->scene->body_count)
    return skf_error_set(r->error, SKF_ERR_PARSE, node->line, "no body is called '%s', expected the name of a body",
                         skf_show(name).text);
  out->body = i;
  if (r->scene->bodies[i].ellipsoid.given) return SKF_OK;
  return skf_error_set(r->error, SKF_ERR_PARSE, node->line, "body '%s' has no ellipsoid, expected one for a launch",
                       skf_show(name).text);
}

skf_status skf_resolve_launches(skf_reader *r, const skf_node *particles) {
  const skf_node *n = skf_node_first(&r->yaml, particles);
  for (size_t i = 0; n; i++, n = skf_node_next(&r->yaml, n)) {
    skf_particle *p = r->scene->particles + i;
    if (!p->launch.given) continue;
    skf_status s = resolve(r, skf_map_find(r, n, "launch"), &p->launch);
    if (s) return s;
  }
  return SKF_OK;
}

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
    {"search", NULL, "for contacts: misses none, or samples each step (default: certified)", SKF_KEY_OTHER,
     .read = read_search, .form = "certified or fast"},
    {"step", "T", "of integrators with a fixed step, which know no tolerance", SKF_KEY_NUMBER, false,
     .offset = offsetof(skf_simulation, step), .range = &skf_positive},
    {"integrator", NULL, "by name (default: the best for the tolerance)", SKF_KEY_OTHER, .read = read_integrator,
     .form = "an integrator's name"},
};
const skf_section skf_section_simulation = {"simulation", "how the particles fly", simulation_keys, 9};

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
