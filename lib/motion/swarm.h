/* SPDX-License-Identifier: MIT */
/* Rigid bodies as the swarm's files see them. */
#ifndef SKF_MOTION_SWARM_H
#define SKF_MOTION_SWARM_H

#include "motion/collider.h"

/* A place of a skeleton (body frame, from the center of mass) and its mass. */
typedef struct skf_node {
  skf_vec3 at;
  double mass;
} skf_node;

typedef struct skf_mover {
  skf_rigid_body is;
  bool free; /* it moves */
  skf_collider *hull;
  skf_vec3 center;               /* of mass, body frame */
  double inertia[6], inverse[6]; /* body frame; xx, xy, xz, yy, yz, zz, with the signs of the tensor */
  size_t nodes;
  skf_node *node;
} skf_mover;

/* What changes: 13 numbers a body: x, v, q, L (angular momentum about the center of mass, inertial). */
enum { SKF_MOVER_STATE = 13 };

struct skf_swarm {
  size_t n;
  skf_mover *bodies;
  skf_rigid_options options;
  double t, h; /* h: the next step */
  double *y;   /* n times SKF_MOVER_STATE */
  double *work;
};

typedef struct skf_attitude {
  skf_vec3 x, v, L, w;
  double q[4];
} skf_attitude;

/* Body i in a state. */
skf_attitude skf_mover_at(const skf_swarm *s, const double *y, size_t i);
skf_vec3 skf_mover_spin(const skf_mover *m, const double q[4], skf_vec3 L);

/* The nodes of a body's skeleton; SKF_ERR_UNSUPPORTED for what has none. */
skf_status skf_mover_place_nodes(skf_mover *m);

/* dy/dt; false when not finite. */
bool skf_swarm_slope(const skf_swarm *s, const double *y, double *dy);
double skf_swarm_potential(const skf_swarm *s, const double *y);

/* One step of at most h from s->y to `to`; *taken is what was taken, s->h what the next should be. */
skf_status skf_swarm_extrapolate(skf_swarm *s, double h, double *to, double *taken);
/* Numbers of double that it needs in s->work. */
size_t skf_swarm_work(size_t n);

/* The impulse of a hit on the bodies of s->y; fills hit->impulse and hit->closing. False when they do not approach. */
bool skf_swarm_strike(skf_swarm *s, skf_rigid_hit *hit);

#endif
