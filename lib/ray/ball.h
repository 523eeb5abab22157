/* SPDX-License-Identifier: MIT */
/* Balls against the octree: on which side of the surface a whole ball lies, and how the field behaves in it. */
#ifndef SKF_RAY_BALL_H
#define SKF_RAY_BALL_H

#include "ray/octree.h"

/* What the octree tells of a ball. */
typedef struct skf_ball {
  int side;             /* -1, 1: all of it is certainly outside or inside; 0: not known */
  bool exhausted;       /* side 0: a smaller ball may tell more, but not the octree's cells by themselves */
  const skf_leaf *leaf; /* that holds all of it, or NULL */
  const uint32_t *list; /* the elements in reach of it */
  uint32_t count;
} skf_ball;

/* Takes some ten to some hundred nanoseconds where the cells have been examined, however many elements there are. */
skf_ball skf_octree_ball(skf_octree *tree, skf_vec3 center, double radius);

/* Bounds of F and its derivatives in the ball, from the elements on the list. */
skf_outlook skf_octree_enclose(const skf_octree *tree, const skf_ball *ball, skf_vec3 center, double radius);

#endif
