/* SPDX-License-Identifier: MIT */
#ifndef SKF_RAY_PATCH_H
#define SKF_RAY_PATCH_H

#include "ray/octree.h"

/* By how much the gradient of a leaf's model changes between two places. */
skf_vec3 skf_patch_turn(const skf_leaf *leaf, skf_vec3 from, skf_vec3 to);

#endif
