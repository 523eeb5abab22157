/* SPDX-License-Identifier: MIT */
/* Bodies that attract, as the integrators and the search for contacts see them. */
#ifndef SKF_MOTION_WORLD_H
#define SKF_MOTION_WORLD_H

#include "skelfield/motion.h"
#include "motion/clock.h"
#include <stdint.h>

typedef struct skf_world_body {
  skf_attractor is;
  skf_vec3 axis;        /* unit, or zero without rotation */
  double rate;          /* 0 without rotation */
  bool turns;           /* the field turns with it: it is not symmetric about that axis */
  skf_vec3 center;      /* of the bounded part of the skeleton, body frame */
  double radius;        /* of a ball about it that holds that part; 0 when there is none */
  double grain;         /* shortest support of its kernels, INFINITY when none has one */
  double reach;         /* no force beyond this distance from center; INFINITY when none is bounded */
  bool surface;         /* it has a surface that can be touched */
  bool bounds;          /* its field has bounds (skf_field_has_bound) */
  bool walled;          /* the surface lies in a known ball: */
  skf_vec3 wall_center; /* body frame */
  double wall_radius;
} skf_world_body;

typedef struct skf_scout skf_scout; /* motion/scout.h */

struct skf_world {
  size_t n;
  skf_world_body *bodies;
  bool still;  /* nothing changes with time */
  bool grainy; /* some body's grain is finite */
  skf_force *forces;
  size_t force_count;
  bool dragged;         /* some depend on the velocity */
  bool alike;           /* all bodies spin alike: there is a Jacobi constant */
  bool axial;           /* everything is symmetric about one axis, */
  skf_vec3 axis, about; /* this one */
  skf_scout *scout;
};

/* A rotation at one instant: angle about an axis through a point. */
typedef struct skf_turn {
  skf_vec3 axis, about;
  double c, s; /* cosine and sine */
  bool on;
} skf_turn;

skf_turn skf_turn_at(const skf_world_body *b, skf_clock t);
/* That of its field: none where it makes no difference. */
skf_turn skf_field_turn_at(const skf_world_body *b, skf_clock t);
/* Turns a vector by the angle (sign +1: body to inertial) or back (sign -1). */
skf_vec3 skf_turn_vector(const skf_turn *r, double sign, skf_vec3 v);
skf_vec3 skf_turn_point(const skf_turn *r, double sign, skf_vec3 p);

/* Whether every body's field has bounds, which contact needs. */
bool skf_world_has_bound(const skf_world *world);

/* Acceleration of a particle; *noise, if asked for, bounds its rounding error from above, roughly. False when not
   finite. With the bits of skf_field_eval. An skf_ode's `eval`. */
bool skf_world_force(const void *world, skf_clock t, const skf_vec3 *p, skf_vec3 *a, double *noise);
/* The same bits for n particles, each at a time of its own: an skf_ode's `many`. */
void skf_world_force_many(const void *world, size_t n, const double *t_hi, const double *t_lo, const double *const p[3],
                          double *const a[3], double *noise);
/* The body that makes all of the force, if there is one, it rests, and its gain is positive; else NULL. */
const skf_world_body *skf_world_lone(const skf_world *world);
/* Rounding error of a body's acceleration at a place of its frame, from above, roughly; from F and the gradient. */
double skf_body_noise(const skf_world_body *body, skf_vec3 p, double F, skf_vec3 g);
/* Acceleration and its time derivative along a motion with velocity v: an skf_ode's `jerk`. False when not finite. */
bool skf_world_jerk(const void *world, skf_clock t, skf_vec3 p, skf_vec3 v, skf_vec3 *a, skf_vec3 *jerk);
/* Whether it depends on the velocity. */
bool skf_force_drags(const skf_force *f);
/* Copies the forces; w->bodies and w->still are set. */
skf_status skf_world_take_forces(skf_world *w, const skf_force *forces, size_t count);
/* Adds the forces that do not depend on the velocity (skf_world_force has them), and those that do: an skf_ode's
   `drag`. False when the sum is not finite. */
bool skf_world_push(const skf_world *world, skf_clock t, skf_vec3 p, skf_vec3 *a);
bool skf_world_drag(const void *world, skf_clock t, skf_vec3 p, skf_vec3 v, skf_vec3 *a);
/* Potential energy per unit mass, and the sum of its terms' magnitudes. */
double skf_world_potential(const skf_world *world, skf_clock t, skf_vec3 p, double *magnitude);
/* Velocity of the material at an inertial point. */
skf_vec3 skf_body_velocity(const skf_world_body *b, skf_vec3 p);
/* Longest distance that a particle at p may travel in one step without leaping over a field of finite support. */
double skf_world_leap(const skf_world *world, skf_vec3 p);
/* Whether some field has joins, and a number that differs between places (inertial) that lie on different sides of one:
   within or beyond a kernel's end of the nearest and of the farthest point of a primitive. */
bool skf_world_has_joins(const skf_world *world);
uint64_t skf_world_zone(const skf_world *world, skf_clock t, skf_vec3 p);
/* The symmetry of the whole world, and which bodies' fields turn. */
void skf_world_find_symmetry(skf_world *world);
skf_invariants skf_world_invariants_at(const skf_world *world, skf_clock t, skf_vec3 p, skf_vec3 v);

#endif
