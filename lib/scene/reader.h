/* SPDX-License-Identifier: MIT */
/* Tables of keys, and the one function that reads a YAML mapping by such a table. */
#ifndef SKF_SCENE_READER_H
#define SKF_SCENE_READER_H

#include "scene/yaml.h"
#include "skelfield/scene.h"

typedef struct skf_material skf_material;

typedef struct skf_reader {
  skf_yaml yaml;
  skf_error *error;
  skf_scene *scene;
  const char *folder;           /* file names are relative to it */
  const skf_scene_hooks *hooks; /* never NULL */
  size_t material_count;
  skf_material *materials;
  size_t particle_capacity;
} skf_reader;

typedef enum skf_key_type {
  SKF_KEY_NUMBER,  /* double */
  SKF_KEY_ANGLE,   /* double, degrees in the file, radians here */
  SKF_KEY_VECTOR,  /* skf_vec3 */
  SKF_KEY_VECTORS, /* `count` consecutive skf_vec3 */
  SKF_KEY_COLOR,   /* double[3], each in [0, 1] */
  SKF_KEY_SHARE,   /* the same, or one number for all three */
  SKF_KEY_NAME,    /* char *, allocated */
  SKF_KEY_OTHER    /* whatever its `read` reads */
} skf_key_type;

/* Which numbers are accepted, in the unit of the file; NULL stands for every finite number. */
typedef struct skf_range {
  double lowest, highest;
  bool open; /* lowest itself is refused */
} skf_range;

extern const skf_range skf_positive, skf_not_negative, skf_fraction, skf_negative;

typedef struct skf_key {
  const char *name, *unit, *doc;
  skf_key_type type;
  bool required;
  size_t offset; /* of the value in the struct that the mapping describes */
  const skf_range *range;
  int count;
  /* SKF_KEY_OTHER: reads the value into the struct; `form` is what the help and the messages expect, of a number
     instead of its range */
  skf_status (*read)(skf_reader *r, const skf_node *value, void *into);
  const char *form;
} skf_key;

/* The keys of one kind of mapping. */
typedef struct skf_section {
  const char *name, *doc; /* "body" */
  const skf_key *keys;
  int count;
} skf_section;

/* Every section with a fixed table, for the help and the tests; NULL after the last. */
extern const skf_section *const skf_sections[];
extern const skf_section skf_section_scene, skf_section_gravity, skf_section_body, skf_section_spin, skf_section_motion,
    skf_section_ellipsoid, skf_section_particle, skf_section_launch, skf_section_grid, skf_section_disc,
    skf_section_shell, skf_section_maxwellian, skf_section_force, skf_section_simulation, skf_section_camera,
    skf_section_light, skf_section_area, skf_section_animate, skf_section_fog, skf_section_background;

/* Reads a mapping into a struct. *given, unless NULL, gets bit i for the i-th key. */
skf_status skf_read_map(skf_reader *r, const skf_node *map, const skf_section *section, void *into, unsigned *given);

/* What a key expects, as words: "[x, y, z]", "a finite number > 0". */
const char *skf_key_form(const skf_key *key, char *text, size_t size);

/* SKF_ERR_PARSE after the message unless the node is of the type. */
skf_status skf_expect(skf_reader *r, const skf_node *node, skf_node_type type, const char *name, const char *form);
skf_status skf_read_number(skf_reader *r, const skf_node *node, const skf_key *key, double *out);
skf_status skf_read_vector(skf_reader *r, const skf_node *node, const skf_key *key, skf_vec3 *out);
skf_status skf_read_color(skf_reader *r, const skf_node *node, const char *name, double out[3]);
skf_status skf_read_name(skf_reader *r, const skf_node *node, const skf_key *key, char **out);

/* Where a file is that the scene names: relative names are in the scene's folder. The scene keeps and frees it. */
skf_status skf_file_path(skf_reader *r, const skf_node *file, const char **path);

/* The value of a key in a map, or NULL. */
const skf_node *skf_map_find(const skf_reader *r, const skf_node *map, const char *key);
/* The line of a key's value, or of the map when the key is absent. */
long skf_map_line(const skf_reader *r, const skf_node *map, const char *key);

/* Index of the text in n rows of names, or n after the message that lists them. */
skf_status skf_read_choice(skf_reader *r, const skf_node *node, const char *name, const char *const *choices, int n,
                           int *out);

skf_status skf_read_bodies(skf_reader *r, const skf_node *list, void *scene);
/* Once every body is known: a start may need them. */
skf_status skf_read_particles(skf_reader *r, const skf_node *list);
/* "inertial" or "body" */
skf_status skf_read_frame(skf_reader *r, const skf_node *node, bool *turning);
/* Refuses a turning frame where there are several. */
skf_status skf_check_frame(skf_reader *r, long line);
skf_status skf_read_simulation(skf_reader *r, const skf_node *map, void *scene);
/* Once bodies and simulation are known. */
skf_status skf_read_forces(skf_reader *r, const skf_node *list);
skf_status skf_read_camera(skf_reader *r, const skf_node *map, void *scene);
skf_status skf_read_lights(skf_reader *r, const skf_node *list, void *scene);
/* Puts the numbers of `animate` at the time of the hooks into the tree. */
skf_status skf_animate(skf_reader *r, const skf_node *list);
skf_status skf_read_fog(skf_reader *r, const skf_node *map, void *scene);
skf_status skf_read_background(skf_reader *r, const skf_node *value, void *scene);
/* An entry's name and line. */
typedef struct skf_named {
  const char *name;
  long line;
} skf_named;
/* Refuses two of the n entries with the same name. */
skf_status skf_refuse_duplicates(skf_reader *r, const char *what, size_t n, skf_named (*at)(const skf_scene *, size_t));

#endif
