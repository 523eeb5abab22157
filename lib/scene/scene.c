/* SPDX-License-Identifier: MIT */
/* Scene files: from bytes to a scene. */
#include "scene/reader.h"
#include "scene/style.h"
#include "core/alloc.h"
#include "core/vec3.h"
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LARGEST = 64 << 20 }; /* bytes: 300 000 triangles as text; more of them belong into a mesh file */

static const skf_key gravity_keys[] = {
    {"G", "L^3/(M T^2)", "gravitational constant; negative repels (default: 6.67430e-11)", SKF_KEY_NUMBER, false,
     .offset = offsetof(skf_scene, G)},
};
const skf_section skf_section_gravity = {"gravity", "acceleration = G density grad F", gravity_keys, 1};

static skf_status read_gravity(skf_reader *r, const skf_node *map, void *scene) {
  return skf_read_map(r, map, &skf_section_gravity, scene, NULL);
}

static skf_status read_version(skf_reader *r, const skf_node *node, void *scene) {
  (void)scene;
  const skf_key key = {.name = "skelfield", .type = SKF_KEY_NUMBER};
  double version;
  skf_status s = skf_read_number(r, node, &key, &version);
  if (s || version == 1) return s;
  return skf_error_set(r->error, SKF_ERR_PARSE, node->line, "format version is %s, expected 1",
                       skf_show(skf_node_text(&r->yaml, node)).text);
}

static skf_status accept(skf_reader *r, const skf_node *value, void *into) {
  return (void)r, (void)value, (void)into, SKF_OK; /* what is read before or after the others */
}

enum {
  KEY_VERSION,
  KEY_GRAVITY,
  KEY_BODIES,
  KEY_PARTICLES,
  KEY_SIMULATION,
  KEY_FORCES,
  KEY_CAMERA,
  KEY_LIGHTS,
  KEY_BACKGROUND,
  KEY_FOG,
  KEY_ANIMATE,
  KEY_MATERIALS,
  KEYS
};

static const skf_key scene_keys[KEYS] = {
    [KEY_VERSION] = {"skelfield", NULL, "format version", SKF_KEY_OTHER, true, .read = read_version, .form = "1"},
    [KEY_GRAVITY] = {"gravity", NULL, "constant of gravity", SKF_KEY_OTHER, .read = read_gravity, .form = "{G: ...}"},
    [KEY_BODIES] = {"bodies", NULL, "at least one body", SKF_KEY_OTHER, true, .read = skf_read_bodies,
                    .form = "a list of bodies"},
    [KEY_PARTICLES] = {"particles", NULL, "what flies", SKF_KEY_OTHER, .read = accept, .form = "a list of particles"},
    [KEY_SIMULATION] = {"simulation", NULL, "how it flies", SKF_KEY_OTHER, .read = skf_read_simulation,
                        .form = "{t_end, output_every, ...}"},
    [KEY_FORCES] = {"forces", NULL, "what accelerates it besides gravity", SKF_KEY_OTHER, .read = accept,
                    .form = "a list of forces"},
    [KEY_CAMERA] = {"camera", NULL, "for render", SKF_KEY_OTHER, .read = skf_read_camera,
                    .form = "{from, to, up, fov}"},
    [KEY_LIGHTS] = {"lights", NULL, "for render", SKF_KEY_OTHER, .read = skf_read_lights, .form = "a list of lights"},
    [KEY_BACKGROUND] = {"background", "1", "linear light, for render", SKF_KEY_OTHER, .read = skf_read_background,
                        .form = "a color or {bottom, top}"},
    [KEY_ANIMATE] = {"animate", NULL, "numbers that change with time", SKF_KEY_OTHER, .read = accept,
                     .form = "a list of {path, keys}"},
    [KEY_FOG] = {"fog", NULL, "for render", SKF_KEY_OTHER, .read = skf_read_fog, .form = "{distance, color}"},
    [KEY_MATERIALS] = {"materials", NULL, "named properties of bodies and primitives", SKF_KEY_OTHER,
                       .read = skf_read_materials, .form = "a list of materials"},
};
const skf_section skf_section_scene = {"scene", "the whole file", scene_keys, KEYS};

const skf_section *const skf_sections[] = {&skf_section_scene,
                                           &skf_section_gravity,
                                           &skf_section_material,
                                           &skf_section_body,
                                           &skf_section_spin,
                                           &skf_section_motion,
                                           &skf_section_ellipsoid,
                                           &skf_section_particle,
                                           &skf_section_launch,
                                           &skf_section_grid,
                                           &skf_section_disc,
                                           &skf_section_shell,
                                           &skf_section_maxwellian,
                                           &skf_section_force,
                                           &skf_section_simulation,
                                           &skf_section_camera,
                                           &skf_section_light,
                                           &skf_section_area,
                                           &skf_section_background,
                                           &skf_section_fog,
                                           &skf_section_texture,
                                           &skf_section_animate,
                                           NULL};

static size_t hash(const char *text) {
  uint64_t h = 14695981039346656037u; /* FNV-1a */
  for (; *text; text++) h = (h ^ (unsigned char)*text) * 1099511628211u;
  return (size_t)(h ^ h >> 32);
}

skf_status skf_refuse_duplicates(skf_reader *r, const char *what, size_t n,
                                 skf_named (*at)(const skf_scene *, size_t)) {
  size_t size = 16;
  while (size < 2 * n) size *= 2;
  const char **table = skf_alloc(size, sizeof *table);
  if (!table) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  skf_named repeated = {NULL, 0};
  for (size_t i = 0; i < n && !repeated.name; i++) {
    skf_named next = at(r->scene, i);
    size_t k = hash(next.name) & (size - 1);
    while (table[k] && strcmp(table[k], next.name) != 0) k = (k + 1) & (size - 1);
    if (table[k]) repeated = next;
    table[k] = next.name;
  }
  skf_free(table);
  if (!repeated.name) return SKF_OK;
  return skf_error_set(r->error, SKF_ERR_PARSE, repeated.line, "a second %s is called '%s', expected different names",
                       what, skf_show(repeated.name).text);
}

/* It would do nothing. */
static skf_status check_softening(skf_reader *r, const skf_node *simulation) {
  const skf_scene *scene = r->scene;
  if (scene->simulation.softening == 0) return SKF_OK;
  for (size_t i = 0; i < scene->particle_count; i++)
    if (scene->particles[i].mass > 0) return SKF_OK;
  return skf_error_set(r->error, SKF_ERR_PARSE, skf_map_line(r, simulation, "softening"),
                       "softening, but no particle has a mass, expected one that has: bodies are not softened");
}

static skf_status read_scene(skf_reader *r) {
  const skf_node *root = r->yaml.nodes;
  skf_status s = skf_expect(r, root, SKF_NODE_MAP, "the scene", "a mapping (skelfield: 1, bodies: ...)");
  if (s) return s;
  const skf_node *version = skf_map_find(r, root, "skelfield");
  if (version && (s = read_version(r, version, r->scene))) return s; /* first: it decides what the rest means */
  const skf_node *animate = skf_map_find(r, root, "animate");
  if (animate && (s = skf_animate(r, animate))) return s; /* it changes what the rest says */
  const skf_node *materials = skf_map_find(r, root, "materials");
  if (materials && (s = skf_read_materials(r, materials, r->scene))) return s; /* the bodies refer to them */
  unsigned given;
  if ((s = skf_read_map(r, root, &skf_section_scene, r->scene, &given))) return s;
  r->scene->has_background = given >> KEY_BACKGROUND & 1;
  const skf_node *simulation = skf_map_find(r, root, "simulation");
  if (r->scene->simulation.turning && (s = skf_check_frame(r, skf_map_line(r, simulation, "frame")))) return s;
  const skf_node *forces = skf_map_find(r, root, "forces");
  if (forces && (s = skf_read_forces(r, forces))) return s;
  if (given >> KEY_PARTICLES & 1) s = skf_read_particles(r, skf_map_find(r, root, "particles"));
  return s ? s : check_softening(r, simulation);
}

skf_status skf_scene_parse(const char *text, size_t length, const char *folder, skf_scene **out, skf_error *error) {
  return skf_scene_parse_with(text, length, folder, NULL, out, error);
}

skf_status skf_scene_parse_with(const char *text, size_t length, const char *folder, const skf_scene_hooks *hooks,
                                skf_scene **out, skf_error *error) {
  static const skf_scene_hooks none = {NULL};
  *out = NULL;
  if (error) *error = (skf_error){0};
  if (length > LARGEST)
    return skf_error_set(error, SKF_ERR_RANGE, 0, "larger than %d MB, expected a scene", LARGEST >> 20);
  skf_reader r = {.error = error,
                  .scene = skf_alloc(1, sizeof *r.scene),
                  .folder = folder ? folder : ".",
                  .hooks = hooks ? hooks : &none};
  if (!r.scene) return skf_error_set(error, SKF_ERR_NOMEM, 0, "out of memory");
  *r.scene = (skf_scene){
      .G = 6.67430e-11, /* CODATA 2018 [m^3 kg^-1 s^-2] */
      .simulation = {.tolerance = 1e-12, .contact = SKF_CONTACT_STOP, .restitution = 1},
      .camera = {.up = {0, 0, 1}, .fov = 40 * (SKF_PI / 180)},
      .animated_until = -INFINITY,
  };
  skf_status s = skf_yaml_read(text, length, &r.yaml, error);
  if (!s) s = read_scene(&r);
  skf_yaml_free(&r.yaml);
  skf_materials_free(&r);
  if (s) return skf_scene_free(r.scene), s;
  *out = r.scene;
  return SKF_OK;
}

/* The file's bytes; at most one more than is accepted. */
static skf_status slurp(const char *path, char **text, size_t *length, skf_error *error) {
  FILE *f = fopen(path, "rb");
  if (!f) return skf_error_set(error, SKF_ERR_IO, 0, "%s, expected a scene file", strerror(errno));
  size_t capacity = 0, n = 0, got = 0;
  skf_status s = SKF_OK;
  *text = NULL;
  do {
    n += got;
    if (n == capacity) {
      capacity = capacity ? 2 * capacity : 1 << 14;
      char *more = skf_realloc(*text, capacity, 1);
      if (!more) s = skf_error_set(error, SKF_ERR_NOMEM, 0, "out of memory");
      if (more) *text = more;
    }
  } while (!s && n <= LARGEST && (got = fread(*text + n, 1, capacity - n, f)) > 0);
  if (!s && ferror(f)) s = skf_error_set(error, SKF_ERR_IO, 0, "%s, expected a scene file", strerror(errno));
  fclose(f);
  *length = n;
  return s;
}

skf_status skf_scene_read(const char *path, skf_scene **out, skf_error *error) {
  return skf_scene_read_with(path, NULL, out, error);
}

skf_status skf_scene_read_with(const char *path, const skf_scene_hooks *hooks, skf_scene **out, skf_error *error) {
  *out = NULL;
  if (error) *error = (skf_error){0};
  char *text = NULL, *folder = skf_strdup(path);
  size_t length = 0;
  if (!folder) return skf_error_set(error, SKF_ERR_NOMEM, 0, "out of memory");
  char *slash = strrchr(folder, '/');
  if (slash) slash[slash == folder] = 0;
  skf_status s = slurp(path, &text, &length, error);
  if (!s) s = skf_scene_parse_with(text, length, slash ? folder : ".", hooks, out, error);
  skf_free(text);
  skf_free(folder);
  return s;
}

void skf_scene_free(skf_scene *scene) {
  if (!scene) return;
  for (size_t i = 0; i < scene->body_count; i++) {
    skf_body *b = scene->bodies + i;
    skf_free(b->name);
    for (size_t k = 0; k < b->element_count; k++)
      if (b->elements[k].primitive.shape == SKF_SOLID) skf_solid_free(b->elements[k].primitive.solid);
    skf_free(b->elements);
    skf_free(b->looks);
    skf_free(b->look_of);
    skf_free(b->element_lines);
    skf_free(b->handled);
    for (size_t k = 0; k < b->profile_count; k++) skf_free(b->profiles[k]);
    skf_free(b->profiles);
    skf_field_free(b->field);
  }
  for (size_t i = 0; i < scene->particle_count; i++)
    if (!scene->particles[i].sourced) skf_free(scene->particles[i].name);
  for (size_t i = 0; i < scene->name_pool_count; i++) skf_free(scene->name_pools[i]);
  skf_free(scene->name_pools);
  skf_free(scene->drawn);
  skf_free(scene->bodies);
  skf_free(scene->particles);
  skf_free(scene->lights);
  skf_free(scene->forces);
  for (size_t i = 0; i < scene->image_count; i++) skf_free(scene->images[i]);
  skf_free(scene->images);
  for (size_t i = 0; i < scene->file_count; i++) skf_free(scene->files[i]);
  skf_free(scene->files);
  skf_free(scene);
}
