/* SPDX-License-Identifier: MIT */
/* Weights along the curves of a skeleton. */
#ifndef SKF_SCENE_PROFILE_H
#define SKF_SCENE_PROFILE_H

#include "scene/reader.h"

/* Gives n elements, which join into a curve, their parts by length of the profile that a node tells. *block is what
   they point to, NULL for a constant; the caller frees it. `kind` is the entry's. */
skf_status skf_profile_apply(skf_reader *r, const skf_node *node, const char *kind, skf_element *elements, size_t n,
                             skf_profile **block);

#endif
