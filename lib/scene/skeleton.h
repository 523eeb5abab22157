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

/* Fills body->elements and body->element_lines from a list that is not empty. */
skf_status skf_read_skeleton(skf_reader *r, const skf_node *list, const skf_default_kernel *kernel, skf_body *body);

#endif
