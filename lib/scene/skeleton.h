/* SPDX-License-Identifier: MIT */
/* Skeletons and kernels of scene files, read by the registries' tables. */
#ifndef SKF_SCENE_SKELETON_H
#define SKF_SCENE_SKELETON_H

#include "scene/reader.h"

typedef struct skf_default_kernel {
  bool given;
  skf_kernel kernel;
} skf_default_kernel;

skf_status skf_read_kernel(skf_reader *r, const skf_node *map, skf_kernel *out);

/* An entry of a skeleton while it is read. */
typedef struct skf_entry {
  skf_element element; /* the primitive, or what all its pieces share */
  skf_default_kernel kernel;
  const char *name;            /* of its kind */
  const skf_node *kind, *map;  /* where the kind stands, and its parameters */
  const skf_node *list, *file; /* of a compound: its points, its mesh */
  bool closed;
  skf_vec3 control[4]; /* of a bezier, and its tolerance; 0: the default */
  double tolerance;
} skf_entry;

/* The elements of a body, as they grow. */
typedef struct skf_pieces {
  skf_body *body;
  size_t capacity;
} skf_pieces;

/* Checks the primitive and appends it with the entry's kernel, strength and line. */
skf_status skf_add_piece(skf_reader *r, const skf_entry *e, const skf_primitive *p, skf_pieces *into);

/* A kind of entry that stands for several primitives. */
typedef struct skf_compound {
  skf_section section; /* offsets are into skf_entry */
  skf_status (*expand)(skf_reader *r, const skf_entry *e, skf_pieces *into);
} skf_compound;

enum { SKF_COMPOUND_COUNT = 5 };
extern const skf_compound skf_compounds[SKF_COMPOUND_COUNT];

/* Fills body->elements and body->element_lines from a list that is not empty. */
skf_status skf_read_skeleton(skf_reader *r, const skf_node *list, const skf_default_kernel *kernel, skf_body *body);

#endif
