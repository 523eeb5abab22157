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
  double error;      /* estimate of the volume's relative error, and of the other's against volume times size */
} skf_mass;

/* Integrates over the inside of an isosurface by Gauss's rule in cells: those certified inside as they are, those that
   the surface passes along lines that it cuts once, halved until the difference of two rules is below `tolerance` of
   them, from 1e-13 to 0.1; 0 stands for 1e-9. tests/motion/test_mass.c finds spheres and the donut within it, and
   within what `error` says. Cells where the gradient vanishes on the surface are halved to a floor whose share is
   counted into the error. The donut takes 0.9 s for 1e-6, 2.1 s for 1e-9, a point's sphere 0.05 s. iso > 0 with a
   bounded surface. SKF_ERR_ARG (iso is not finite), SKF_ERR_RANGE (tolerance), SKF_ERR_EMPTY, SKF_ERR_UNBOUNDED (a
   plane, iso <= 0, a profile with both signs), SKF_ERR_UNSUPPORTED (no bounds) or SKF_ERR_NOMEM. */
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

#ifdef __cplusplus
}
#endif
#endif
