/* SPDX-License-Identifier: MIT */
/* Solids bounded by isosurfaces, as rigid bodies: their masses, and where two of them meet. */
#ifndef SKELFIELD_RIGID_H
#define SKELFIELD_RIGID_H

#include "skelfield/ray.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Mass properties ---- */

/* Of the solid F >= iso with density 1. */
typedef struct skf_mass {
  double volume;     /* [L^3] */
  skf_vec3 center;   /* of mass [L] */
  double inertia[6]; /* about the center: xx, xy, xz, yy, yz, zz [L^5]; xy is -int x y dV */
  double error; /* estimate, no bound, of the volume's relative error, and of the others' against volume times size */
} skf_mass;

/* Integrates over the inside of an isosurface by Gauss's rule in cells: those certified inside as they are, those that
   the surface passes along lines that it cuts once, halved until the difference of two rules is below `tolerance` of
   them, from 1e-13 to 0.1; 0 stands for 1e-9. tests/motion/test_mass.c finds spheres and the donut within it, and
   within what `error` says. Cells where the gradient vanishes on the surface are halved to a floor whose share is
   counted into the error. What a cell's middle and corners and the points of two rules do not show, such as a thin
   feature between them, is in neither the result nor the error. The donut takes 0.9 s for 1e-6, 2.1 s for 1e-9, a
   point's sphere 0.05 s. iso > 0 with a bounded surface. SKF_ERR_ARG (iso is not finite), SKF_ERR_RANGE (tolerance),
   SKF_ERR_EMPTY, SKF_ERR_UNBOUNDED (a plane, iso <= 0, a profile with both signs), SKF_ERR_UNSUPPORTED (no bounds) or
   SKF_ERR_NOMEM. */
SKF_API skf_status skf_mass_of(const skf_field *field, double iso, double tolerance, skf_mass *out);

/* ---- Poses and motions ---- */

/* x (inertial) = position + R x (body), R being the rotation of the unit quaternion w, x, y, z. */
typedef struct skf_pose {
  skf_vec3 position;
  double q[4];
} skf_pose;

SKF_API skf_vec3 skf_pose_point(const skf_pose *pose, skf_vec3 x);
SKF_API skf_vec3 skf_pose_inverse(const skf_pose *pose, skf_vec3 x);
SKF_API skf_vec3 skf_pose_turn(const skf_pose *pose, skf_vec3 v); /* directions */

/* The pose at time t, and how it goes on: the origin of the body's frame on a parabola, the body turning about it with
   a constant angular velocity (inertial frame). */
typedef struct skf_rigid_motion {
  double t;
  skf_pose pose;
  skf_vec3 velocity, acceleration, angular_velocity;
} skf_rigid_motion;

SKF_API skf_pose skf_rigid_at(const skf_rigid_motion *motion, double t);

/* ---- Collisions ---- */

/* A solid ready for collisions: immutable, safe to share between threads. Borrows the field. */
typedef struct skf_collider skf_collider;

/* SKF_ERR_ARG (iso is not finite), SKF_ERR_EMPTY (no surface), SKF_ERR_UNSUPPORTED (no bounds) or SKF_ERR_NOMEM. An
   unbounded surface, such as a plane's, can meet bounded ones. */
SKF_API skf_status skf_collider_new(const skf_field *field, double iso, skf_collider **out);
SKF_API void skf_collider_free(skf_collider *collider);

typedef enum skf_meeting {
  SKF_MEETING_APART,    /* certified: no place is inside both, up to rounding of F and of the places */
  SKF_MEETING_OVERLAP,  /* `at` is inside both */
  SKF_MEETING_UNDECIDED /* they touch more closely than rounding, or the search was given up */
} skf_meeting;

/* Where two solids are deepest in each other, or closest to touching, as far as it is known. */
typedef struct skf_meet {
  skf_meeting meeting;
  double t;        /* of skf_collide_first */
  skf_vec3 at;     /* inertial */
  skf_vec3 normal; /* unit, from a to b */
  double depth;    /* by which they overlap along the normal, to first order [L]; 0 at a first contact */
  size_t cells;    /* looked at: what it cost */
  size_t grazing;  /* of them, left undecided at the floor of subdivision */
} skf_meet;

/* Whether two solids at rest overlap. The common space is cut into cells; one is dismissed when bounds on both fields,
   or on a sum of them, keep both solids from being in it together, and everything else is halved. So an overlap is
   never missed, however thin. SKF_ERR_UNSUPPORTED when neither is bounded, SKF_ERR_RANGE or SKF_ERR_NOMEM. */
SKF_API skf_status skf_collide(const skf_collider *a, const skf_pose *pose_a, const skf_collider *b,
                               const skf_pose *pose_b, skf_meet *out);

/* The first time in [t0, t1] when two moving solids meet, by cells of space and time: before out->t they are certified
   apart, up to rounding. SKF_MEETING_OVERLAP: they touch at out->t, or overlap at the start, when out->t = t0;
   SKF_MEETING_APART: certified for all of the time. SKF_MEETING_UNDECIDED: they come within rounding of each other at
   out->t, where the pieces undecided begin. The time is good to rounding of the times and of the places over the speed
   of approach. */
SKF_API skf_status skf_collide_first(const skf_collider *a, const skf_rigid_motion *motion_a, const skf_collider *b,
                                     const skf_rigid_motion *motion_b, double t0, double t1, skf_meet *out);

/* ---- Bodies that move ---- */

/* Position and velocity of the center of mass, attitude of the body's frame, angular velocity; all inertial. */
typedef struct skf_rigid_state {
  skf_vec3 position, velocity, angular_velocity;
  double q[4]; /* unit quaternion w, x, y, z: direction (inertial) = R (body) */
} skf_rigid_state;

/* A body bounded by F >= iso. Its skeleton attracts and is attracted: density times strength times measure is its
   elements' mass; as a rigid body it is the homogeneous solid inside. The field is borrowed. */
typedef struct skf_rigid_body {
  const skf_field *field;
  double iso;
  double density; /* of the skeleton, as of skf_attractor: [M/L], ... per element's measure */
  double mass;    /* inertial [M]; 0: it is fixed, whatever its state */
  skf_mass solid; /* of one that moves: skf_mass_of(field, iso) */
  skf_rigid_state start;
} skf_rigid_body;

typedef struct skf_rigid_options {
  double G;           /* 0: no gravity of theirs */
  skf_vec3 gravity;   /* uniform acceleration [L/T^2] */
  double tolerance;   /* relative error per step, 0: 1e-12 */
  double restitution; /* in [0, 1] */
  double friction;    /* Coulomb's, >= 0 */
  double rolling;     /* friction against rolling and turning: torque at most this times the normal force, >= 0 [L] */
} skf_rigid_options;

typedef struct skf_rigid_hit {
  double t;
  size_t a, b;
  skf_vec3 at, normal; /* unit, from a to b */
  skf_vec3 impulse;    /* on b; -impulse on a [M L/T] */
  double closing;      /* speed of approach before [L/T] */
} skf_rigid_hit;

/* Sums over the bodies that move. Momentum is conserved where none is fixed and there is no uniform gravity, and so is
   the angular momentum about the origin; energy where no hit has taken any. */
typedef struct skf_rigid_sums {
  skf_vec3 momentum, angular_momentum;
  double kinetic, potential;
} skf_rigid_sums;

/* Bodies under each other's gravity and impacts.

   Forces: Gauss's rule over each skeleton in the other's field, and the same the other way round, half each; each
   node's force acts back on the other body at the same place. So momentum and angular momentum are kept to rounding
   whatever the rule, and the energy belongs to the same sum. (For kernels other than 1/r the two halves are different
   laws; the mean of both is taken, for the sake of action = reaction.) A fixed body without nodes, a plane, pulls with
   its whole field. Motion: extrapolation of order 16 [Gragg 1965; Bulirsch and Stoer 1966], attitudes as quaternions.
   Impacts: each step's motion, as parabolas and constant turns, goes through skf_collide_first; towards a hit the step
   is shortened until the two are closer than 1e-9 of their size. What the search certifies is that stand-in, not the
   path: where bodies are near each other, steps are so short that both differ by less than 1e-7 of the size, by an
   estimate from the change of acceleration and angular velocity; overlaps of less than that may be missed. Where it
   stays undecided (SKF_MEETING_UNDECIDED) a hit is assumed. At a hit an impulse acts: Newton's restitution in the
   normal velocity, and friction that ends the slip or is Coulomb's against it, or as much less as it takes not to
   create energy where the slip changes its direction during the impact [Kane 1984].

   Contact that lasts: from a hit on until all bodies are apart by 0.05 of their size again, all places where two come
   close are found by cells, with a margin that covers what the bodies move before they are looked for again, and
   followed by Newton's method. Steps are at most 0.02 of the time in which a body moves or falls by its size, or turns
   by 1, and end where another place touches. Rebounds that would rise by less than 1e-6 of the size (1e-14 where
   restitution is 1) are none: from then on forces keep the two apart, by Signorini's law, with Coulomb's friction and
   `rolling`, solved for all places at once to 1e-14 of the speeds [Moreau 1988; Stewart and Trinkle 1996]; of second
   order in the step. Bodies that lean on each other hover: gaps go to 4e-9 of the size and are kept above 1e-9, both
   plus rounding of the places. tests/motion/test_rest.c finds no overlap by skf_collide. The energy never grows but for
   what keeping the gaps open takes, 1e-8 of weight times size; a group of bodies that touch, none of them fixed, keeps
   its momentum and angular momentum to rounding, within 1e-12 there. When no body has moved for ten steps (1e-9 of the
   speed of a fall by its size), all is at rest for good. Two solids that touch along a line or a face are held at up to
   24 places. Overlaps from the start are undone by 1e-4 of the size a step. */
typedef struct skf_swarm skf_swarm;

/* SKF_ERR_ARG (no field, a mass or solid that is not positive, options out of range), SKF_ERR_RANGE (not finite),
   SKF_ERR_UNSUPPORTED (a solid, plane or user's kernel in a body that moves, or no bounds), SKF_ERR_EMPTY (no surface)
   or SKF_ERR_NOMEM. Starts at t = 0. */
SKF_API skf_status skf_swarm_new(const skf_rigid_body *bodies, size_t n, const skf_rigid_options *options,
                                 skf_swarm **out);
SKF_API void skf_swarm_free(skf_swarm *swarm);

/* Goes on to time t; `hit`, if given, is told each impact and may end the run with another status than SKF_OK.
   SKF_ERR_CONVERGENCE: a force is not finite, or contact is too intricate to follow; the swarm stays where it came to.
   Bodies that overlap at the start are hit when they approach, and pass else. */
SKF_API skf_status skf_swarm_run(skf_swarm *swarm, double t, skf_status (*hit)(void *user, const skf_rigid_hit *hit),
                                 void *user);
/* Whether all bodies have come to rest on each other, for good. */
SKF_API bool skf_swarm_is_still(const skf_swarm *swarm);
SKF_API double skf_swarm_time(const skf_swarm *swarm);
SKF_API skf_rigid_state skf_swarm_state(const skf_swarm *swarm, size_t body);
SKF_API skf_rigid_sums skf_swarm_sums(const skf_swarm *swarm);

/* Everything that the rest of a run depends on, as bytes for the same build of the library; a status of `write` other
   than SKF_OK ends it. Between two calls of skf_swarm_run: what follows is the same, bit by bit. */
SKF_API skf_status skf_swarm_save(const skf_swarm *swarm, skf_status (*write)(void *user, const void *bytes, size_t n),
                                  void *user);
/* The same into a new swarm of the same bodies and options; SKF_ERR_PARSE when they are of another number of bodies or
   of other options, and then, as after a status of `read`, it is to be freed. */
SKF_API skf_status skf_swarm_load(skf_swarm *swarm, skf_status (*read)(void *user, void *bytes, size_t n), void *user);

#ifdef __cplusplus
}
#endif
#endif
