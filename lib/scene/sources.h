/* SPDX-License-Identifier: MIT */
/* Sources: one entry of `particles` that stands for many. */
#ifndef SKF_SCENE_SOURCES_H
#define SKF_SCENE_SOURCES_H

#include "scene/reader.h"

typedef enum skf_source_kind {
  SKF_SOURCE_NONE,
  SKF_SOURCE_FILE,
  SKF_SOURCE_GRID,
  SKF_SOURCE_DISC,
  SKF_SOURCE_SHELL,
  SKF_SOURCE_MAXWELLIAN
} skf_source_kind;

/* What a source says; each kind uses some of it. */
typedef struct skf_source {
  skf_source_kind kind;
  const skf_node *node; /* its mapping, or its file's name */
  skf_vec3 from, to, center, normal, velocity;
  double counts[3], count, seed;
  double inner, outer, circular, radial, tangential, spread, temperature;
} skf_source;

/* Particles in one scene: a thousand revolutions of so many are weeks of a large machine. */
#define SKF_PARTICLES_MOST 100000000

/* Reads the mapping of a kind into *source. */
skf_status skf_read_source(skf_reader *r, const skf_node *map, skf_source_kind kind, skf_source *source);
/* Adds the source's particles to the scene, named NAME-000000, NAME-000001, ... Bodies are known. */
skf_status skf_add_source(skf_reader *r, const skf_source *source, const char *name, long line);
/* The same from a file: CSV with the columns x, y, z, vx, vy, vz and, if it likes, name. */
skf_status skf_add_starts(skf_reader *r, const skf_node *file, const char *name, long line);

/* Room for `more` particles at the end of the scene's. They are not counted yet. */
skf_status skf_more_particles(skf_reader *r, double more, long line, skf_particle **out);
/* Keeps a block of names until the scene ends; takes it, also on failure. */
skf_status skf_keep_names(skf_reader *r, char *names);
/* Bytes of a generated name; writes the i-th of n. */
size_t skf_source_name_size(const char *name, size_t n);
void skf_source_name(char *out, const char *name, size_t i, size_t n);

#endif
