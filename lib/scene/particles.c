/* SPDX-License-Identifier: MIT */
/* What moves among the bodies. */
#include "scene/sources.h"
#include "core/alloc.h"
#include "core/vec3.h"
#include <stdint.h>
#include <stdio.h>
#include <string.h>

static const skf_range latitude = {-90, 90, false}, turn = {-360, 360, false};

static skf_status accept(skf_reader *r, const skf_node *value, void *into) {
  return (void)r, (void)value, (void)into, SKF_OK;
}

static skf_status find_body(skf_reader *r, const skf_node *node, skf_launch *out) {
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

/* An entry of the list: a particle, or a source of many. */
typedef struct entry {
  skf_particle particle; /* first: the tables' offsets are its */
  skf_source source;
  bool turning; /* velocities are relative to the turning frame */
} entry;

static skf_status read_file(skf_reader *r, const skf_node *node, void *into) {
  skf_source *source = &((entry *)into)->source;
  source->kind = SKF_SOURCE_FILE, source->node = node;
  static const char form[] = "the name of a CSV file";
  skf_status s = skf_expect(r, node, SKF_NODE_SCALAR, "file", form);
  if (s || *skf_node_text(&r->yaml, node)) return s;
  return skf_error_set(r->error, SKF_ERR_PARSE, node->line, "file is empty, expected %s", form);
}
static skf_status read_grid(skf_reader *r, const skf_node *map, void *into) {
  return skf_read_source(r, map, SKF_SOURCE_GRID, &((entry *)into)->source);
}
static skf_status read_disc(skf_reader *r, const skf_node *map, void *into) {
  return skf_read_source(r, map, SKF_SOURCE_DISC, &((entry *)into)->source);
}
static skf_status read_shell(skf_reader *r, const skf_node *map, void *into) {
  return skf_read_source(r, map, SKF_SOURCE_SHELL, &((entry *)into)->source);
}
static skf_status read_maxwellian(skf_reader *r, const skf_node *map, void *into) {
  return skf_read_source(r, map, SKF_SOURCE_MAXWELLIAN, &((entry *)into)->source);
}
static skf_status read_frame(skf_reader *r, const skf_node *node, void *into) {
  return skf_read_frame(r, node, &((entry *)into)->turning);
}

enum {
  KEY_NAME,
  KEY_POSITION,
  KEY_VELOCITY,
  KEY_FRAME,
  KEY_MASS,
  KEY_LAUNCH,
  KEY_FILE,
  KEY_GRID,
  KEY_DISC,
  KEY_SHELL,
  KEY_MAXWELLIAN,
  KEYS
};

static const skf_key particle_keys[KEYS] = {
    {"name", NULL, "unique among the particles; of many: NAME-000000, NAME-000001, ...", SKF_KEY_NAME, true,
     .offset = offsetof(skf_particle, name)},
    {"position", "L", "at t = 0, inertial frame", SKF_KEY_VECTOR, false, .offset = offsetof(skf_particle, position)},
    {"velocity", "L/T", "at t = 0, inertial frame", SKF_KEY_VECTOR, false, .offset = offsetof(skf_particle, velocity)},
    {"frame", NULL, "of velocities: inertial, or that of the body that spins (default: inertial)", SKF_KEY_OTHER,
     .read = read_frame, .form = "inertial or body"},
    {"mass", "M", "attracts all other particles, not the bodies; of each of many (default: 0)", SKF_KEY_NUMBER, false,
     .offset = offsetof(skf_particle, mass), .range = &skf_not_negative},
    {"launch", NULL, "instead of position and velocity", SKF_KEY_OTHER, .read = read_launch,
     .form = "{body, latitude, longitude, speed, ...}"},
    {"file", NULL, "many: CSV x,y,z,vx,vy,vz and, if it likes, name", SKF_KEY_OTHER, .read = read_file,
     .form = "the name of a CSV file"},
    {"grid", NULL, "many: on the points of a grid", SKF_KEY_OTHER, .read = read_grid,
     .form = "{from, to, counts, ...}"},
    {"disc", NULL, "many: all over a disc or ring", SKF_KEY_OTHER, .read = read_disc, .form = "{outer, count, ...}"},
    {"shell", NULL, "many: all over a sphere or shell", SKF_KEY_OTHER, .read = read_shell,
     .form = "{outer, count, ...}"},
    {"maxwellian", NULL, "many: a cloud with a temperature", SKF_KEY_OTHER, .read = read_maxwellian,
     .form = "{count, spread, ...}"},
};
const skf_section skf_section_particle = {"particle", "a point that feels gravity, or a source of many", particle_keys,
                                          KEYS};

/* Exactly one way to say where it starts. */
static skf_status check_ways(skf_reader *r, const skf_node *map, unsigned given) {
  bool position = given >> KEY_POSITION & 1, velocity = given >> KEY_VELOCITY & 1;
  int way = -1;
  for (int k = KEY_LAUNCH; k < KEYS; k++) {
    if (!(given >> k & 1)) continue;
    const char *other = position ? "position" : velocity ? "velocity" : way >= 0 ? particle_keys[way].name : NULL;
    if (other)
      return skf_error_set(r->error, SKF_ERR_PARSE, skf_map_line(r, map, other),
                           "both %s and %s, expected %s alone or position and velocity", particle_keys[k].name, other,
                           particle_keys[k].name);
    way = k;
  }
  if (way >= 0 || (position && velocity)) return SKF_OK;
  return skf_error_set(r->error, SKF_ERR_PARSE, map->line, "missing '%s' in particle, expected [x, y, z]",
                       position ? "velocity" : "position");
}

skf_status skf_more_particles(skf_reader *r, double more, long line, skf_particle **out) {
  skf_scene *scene = r->scene;
  double need = (double)scene->particle_count + more;
  if (need > SKF_PARTICLES_MOST)
    return skf_error_set(r->error, SKF_ERR_RANGE, line, "%.0f particles, expected at most %d in a scene", need,
                         SKF_PARTICLES_MOST);
  if ((size_t)need > r->particle_capacity) {
    size_t capacity = r->particle_capacity + r->particle_capacity / 2;
    if (capacity < (size_t)need) capacity = (size_t)need;
    skf_particle *all = skf_realloc(scene->particles, capacity, sizeof *all);
    if (!all) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
    scene->particles = all, r->particle_capacity = capacity;
  }
  *out = scene->particles + scene->particle_count;
  memset(*out, 0, (size_t)more * sizeof **out);
  return SKF_OK;
}

static skf_status add_one(skf_reader *r, const skf_particle *p) {
  skf_particle *room;
  skf_status s = skf_more_particles(r, 1, p->line, &room);
  if (s) return s;
  *room = *p;
  r->scene->particle_count++;
  return SKF_OK;
}

/* The velocities of the particles from `first` on become inertial. */
static skf_status make_inertial(skf_reader *r, size_t first, long line) {
  skf_scene *scene = r->scene;
  size_t body;
  skf_status s = skf_check_frame(r, line);
  if (s || !skf_scene_turning_body(scene, &body) || body == SIZE_MAX) return s;
  const skf_spin *spin = &scene->bodies[body].spin;
  skf_vec3 omega = v3_scale(spin->rate, v3_unit(spin->axis));
  for (size_t i = first; i < scene->particle_count && !s; i++) {
    skf_particle *p = scene->particles + i;
    p->velocity = v3_add(p->velocity, v3_cross(omega, v3_sub(p->position, spin->about)));
    if (!v3_finite(p->velocity))
      s = skf_error_set(r->error, SKF_ERR_RANGE, line, "velocity is too large, expected finite numbers");
  }
  return s;
}

/* The particles from `first` on attract the others. */
static skf_status give_mass(skf_reader *r, size_t first, double mass, long line) {
  skf_scene *scene = r->scene;
  for (size_t i = first; i < scene->particle_count; i++) scene->particles[i].mass = mass;
  const skf_integrator_info *used = skf_integrator_find(scene->simulation.integrator);
  if (used == skf_integrator_get(0)) return SKF_OK;
  return skf_error_set(r->error, SKF_ERR_PARSE, line,
                       "particles with a mass, but %s flies them one by one, expected integrator %s", used->name,
                       skf_integrator_get(0)->name);
}

static skf_status read_entry(skf_reader *r, const skf_node *map) {
  entry e = {.particle = {.line = map->line}};
  size_t first = r->scene->particle_count;
  unsigned given;
  skf_status s = skf_read_map(r, map, &skf_section_particle, &e, &given);
  if (!s) s = check_ways(r, map, given);
  if (!s && e.particle.launch.given && given >> KEY_FRAME & 1)
    s = skf_error_set(r->error, SKF_ERR_PARSE, skf_map_line(r, map, "frame"),
                      "both launch and frame, expected launch alone: its speed is relative to the ground");
  if (!s && e.particle.launch.given)
    s = find_body(r, skf_map_find(r, skf_map_find(r, map, "launch"), "body"), &e.particle.launch);
  if (!s && e.source.kind == SKF_SOURCE_NONE) {
    s = add_one(r, &e.particle);
    if (!s) e.particle.name = NULL; /* the scene has it */
  } else if (!s && e.source.kind == SKF_SOURCE_FILE) {
    s = skf_add_starts(r, e.source.node, e.particle.name, map->line);
  } else if (!s) {
    s = skf_add_source(r, &e.source, e.particle.name, map->line);
  }
  if (!s && e.particle.mass > 0) s = give_mass(r, first, e.particle.mass, skf_map_line(r, map, "mass"));
  if (!s && e.turning) s = make_inertial(r, first, skf_map_line(r, map, "frame"));
  skf_free(e.particle.name);
  return s;
}

static skf_named name_at(const skf_scene *scene, size_t i) {
  return (skf_named){scene->particles[i].name, scene->particles[i].line};
}

skf_status skf_read_particles(skf_reader *r, const skf_node *list) {
  skf_status s = skf_expect(r, list, SKF_NODE_LIST, "particles", "a list of particles");
  for (const skf_node *n = skf_node_first(&r->yaml, list); n && !s; n = skf_node_next(&r->yaml, n))
    s = read_entry(r, n);
  return s ? s : skf_refuse_duplicates(r, "particle", r->scene->particle_count, name_at);
}
