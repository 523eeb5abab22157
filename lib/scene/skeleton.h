/* SPDX-License-Identifier: MIT */
/* Skeletons and kernels of scene files, read by the registries' tables. */
#ifndef SKF_SCENE_SKELETON_H
#define SKF_SCENE_SKELETON_H

#include "scene/style.h"

/* An entry of a skeleton while it is read. */
typedef struct skf_entry {
  skf_element element; /* the primitive, or what all its pieces share */
  skf_style style;
  const char *name;            /* of its kind */
  const skf_node *kind, *map;  /* where the kind stands, and its parameters */
  const skf_node *list, *file; /* of a compound: its points, its mesh */
  const skf_node *holes;       /* of a polygon, or NULL */
  const skf_node *profile;     /* NULL: none */
  bool closed;
  skf_vec3 control[4]; /* of a bezier, and its tolerance; 0: the default */
  double tolerance;
  skf_helix helix;             /* or a spiral; end_radius < 0: not given */
  skf_vec3 center, size, axis; /* of a box, and how it is turned */
  double angle;
  double color[3]; /* the first NAN: not given */
} skf_entry;

/* The keys that every entry may have besides its own. */
enum { SKF_ENTRY_KEYS = 8 };
#define SKF_OTHER_RADIUS "thickness" /* what the handle `radius` is called where the primitive has a radius */
extern const skf_key skf_entry_keys[SKF_ENTRY_KEYS];

/* What makes a look of an entry. */
typedef struct skf_look_key {
  const skf_material *material;
  double color[3];
} skf_look_key;

/* The elements of a body, as they grow. */
typedef struct skf_pieces {
  skf_body *body;
  skf_look_key *look_keys; /* of looks[1] and so on */
  size_t look_capacity, capacity, handled_capacity, profile_capacity;
} skf_pieces;

/* Checks the primitive and appends it with the entry's kernel, strength and line. */
skf_status skf_add_piece(skf_reader *r, const skf_entry *e, const skf_primitive *p, skf_pieces *into);

/* Keeps where a mesh file's name stands, and reads that file. */
skf_status skf_keep_file(skf_reader *r, const skf_node *value, void *entry);
skf_status skf_read_mesh(skf_reader *r, const skf_node *file, skf_mesh *mesh);
/* Makes the solid of e->file; its kernel is inverse, which need not be given. */
skf_status skf_read_solid(skf_reader *r, skf_entry *e);

/* A kind of entry that stands for several primitives. */
typedef struct skf_compound {
  skf_section section; /* offsets are into skf_entry */
  skf_status (*expand)(skf_reader *r, const skf_entry *e, skf_pieces *into);
} skf_compound;

/* Into the entry's list; a list of points into as many places. */
skf_status skf_keep_points(skf_reader *r, const skf_node *value, void *entry);
skf_status skf_read_points(skf_reader *r, const skf_node *list, skf_vec3 *out);

enum { SKF_POLYGON_KEYS = 2 };
extern const skf_key skf_polygon_keys[SKF_POLYGON_KEYS];
skf_status skf_expand_polygon(skf_reader *r, const skf_entry *e, skf_pieces *into);

enum { SKF_BEZIER_KEYS = 2, SKF_HELIX_KEYS = 8, SKF_SPIRAL_KEYS = 8 };
extern const skf_key skf_bezier_keys[SKF_BEZIER_KEYS], skf_helix_keys[SKF_HELIX_KEYS], skf_spiral_keys[SKF_SPIRAL_KEYS];
skf_status skf_expand_bezier(skf_reader *r, const skf_entry *e, skf_pieces *into);
skf_status skf_expand_helix(skf_reader *r, const skf_entry *e, skf_pieces *into); /* spirals, too */

enum { SKF_COMPOUND_COUNT = 8 };
extern const skf_compound skf_compounds[SKF_COMPOUND_COUNT];

/* Fills body->elements and what belongs to them from a list that is not empty. */
skf_status skf_read_skeleton(skf_reader *r, const skf_node *list, const skf_style *style, skf_body *body);

#endif
