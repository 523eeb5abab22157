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

/* Steps without motion after which nothing moves any more. */
enum { SKF_STILL = 10 };

/* Two bodies that are near each other, and where: a and b as in skf_duel. */
typedef struct skf_bond {
  size_t a, b;
  double size;  /* of the smaller one that moves */
  double wide;  /* margin of the last search, */
  double clear; /* and what is left of it: when the bodies have moved so far, places have to be looked for again */
  bool stale;   /* they have to be, however little has moved */
  int n;
  skf_spot spot[SKF_SPOTS];
  skf_leaves leaves; /* of the last search; owned by those of skf_swarm's `here` */
} skf_bond;

/* Bonds in one state of the bodies. */
typedef struct skf_bonds {
  size_t n, capacity;
  skf_bond *bond;
} skf_bonds;

/* A place where two press on each other, or might. */
typedef struct skf_press {
  size_t a, b;
  skf_vec3 at, normal;
  double want;      /* least speed of parting, or way */
  double friction;  /* coefficient */
  double rolling;   /* the most of the torque over the normal force */
  skf_vec3 impulse; /* on b; in: a guess */
  skf_vec3 twist;   /* of angular momentum, the same */
} skf_press;

struct skf_swarm {
  size_t n;
  skf_mover *bodies;
  skf_rigid_options options;
  double t, h; /* h: the next step */
  double *y;   /* n times SKF_MOVER_STATE */
  double *work;
  bool leaning; /* bodies lean on each other: steps by skf_rest_step */
  int still;    /* steps since one has moved */
  /* What these steps use: bonds at the start and at the end; dy/dt at the start; the end of the free motion; velocities
     and angular momenta; the length that a step should have */
  skf_bonds here, there, spare;
  double *slope, *ideal, *speeds, lull;
  size_t *group; /* of each body, by its first one */
  skf_press *press;
  size_t presses;
};

typedef struct skf_attitude {
  skf_vec3 x, v, L, w;
  double q[4];
} skf_attitude;

/* Body i in a state. */
skf_attitude skf_mover_at(const skf_swarm *s, const double *y, size_t i);
/* Angular velocity of an angular momentum, and the other way round. */
skf_vec3 skf_mover_spin(const skf_mover *m, const double q[4], skf_vec3 L);
skf_vec3 skf_mover_spun(const skf_mover *m, const double q[4], skf_vec3 w);

/* The nodes of a body's skeleton; SKF_ERR_UNSUPPORTED for what has none. */
skf_status skf_mover_place_nodes(skf_mover *m);

/* dy/dt; false when not finite. */
bool skf_swarm_slope(const skf_swarm *s, const double *y, double *dy);
double skf_swarm_potential(const skf_swarm *s, const double *y);
double skf_swarm_energy(const skf_swarm *s, const double *y);

/* One step of at most h from s->y to `to`; *taken is what was taken, s->h what the next should be. */
skf_status skf_swarm_extrapolate(skf_swarm *s, double h, double *to, double *taken);
/* Numbers of double that it needs in s->work. */
size_t skf_swarm_work(size_t n);

/* The impulse of a hit on the bodies of s->y; fills hit->impulse and hit->closing. False when they do not approach. A
   rebound slower than `hop` is none. */
bool skf_swarm_strike(skf_swarm *s, skf_rigid_hit *hit, double hop);
/* Solves K x = r for a symmetric K given by its columns. */
skf_vec3 skf_symmetric_solve(const skf_vec3 K[3], skf_vec3 r);
/* How fast a rebound between two bodies must at least be to be followed, given the accelerations of all. */
double skf_swarm_hop(const skf_swarm *s, const double *slope, size_t i, size_t j);

/* The shortest time in which a body crosses its size, turns by 1, or falls by its size. */
double skf_swarm_pace(const skf_swarm *s, const double *slope);

/* Goes on by a step of at most `most` while some lean on each other; `told` as for skf_swarm_run. */
skf_status skf_rest_step(skf_swarm *s, double most, skf_status (*told)(void *, const skf_rigid_hit *), void *user);

/* Whether two touch at place i of bond k, at the start of the step or at its end. */
bool skf_rest_touch(const skf_swarm *s, size_t k, int i);
/* Finds s->group: bodies that touch. */
void skf_rest_group(skf_swarm *s);
/* Gives each group at `to` that has no fixed body the momentum and angular momentum that it has at the end of the free
   motion, and takes what energy there is beyond `most` from the motions within the groups. */
void skf_rest_keep(skf_swarm *s, const double *free_end, double most, double *to);

/* ---- Bonds ---- */

/* Whether two bodies may meet while they come closer by no more than `way`: by the balls about their centers of mass.
 */
bool skf_swarm_close(const skf_swarm *s, size_t i, size_t j, double way);
double skf_mover_reach(const skf_mover *m); /* of its material, from the center of mass */

/* Bonds of all that may meet within a step in which bodies move by their speeds over h and twice the fall; those that
   are still good are kept. */
skf_status skf_bonds_make(skf_swarm *s, const double *slope, double h);
/* The places of `from`, those of s->y, in another state y of the bodies after a time h, `to`, which has room for them;
   false when some body has moved by more than is clear. h < 0: after a small correction, which does not count. */
bool skf_bonds_follow(const skf_swarm *s, const skf_bonds *from, double h, const double *y, skf_bonds *to);
/* Looks for places that have come into being in the state y, that of `to`, and adds them; *least is the smallest of
   their gaps, over the size. */
skf_status skf_bonds_check(const skf_swarm *s, const double *y, skf_bonds *to, double *least);
/* Forgets the places that are lost; all bonds. */
void skf_bonds_tidy(skf_bonds *b);
void skf_bonds_clear(skf_bonds *b);
bool skf_bonds_room(skf_bonds *b, size_t n);

/* ---- Pressing ---- */

/* The impulses after which no two approach at their places by more than they want, by Coulomb's law, and what they make
   of v (6 a body: velocity and angular momentum); poses from y. SKF_ERR_NOMEM, or SKF_OK. */
skf_status skf_press_solve(const skf_swarm *s, const double *y, skf_press *p, size_t n, double *v);

#endif
