/* SPDX-License-Identifier: MIT */
/* A solid as the search for collisions sees it, and what it knows of a ball. */
#ifndef SKF_MOTION_COLLIDER_H
#define SKF_MOTION_COLLIDER_H

#include "motion/pose.h"
#include "ray/walk.h"

struct skf_collider {
  const skf_field *field;
  double iso;
  skf_vec3 origin;    /* of the frame in which places are told: field coordinates = place + origin */
  skf_tracer *tracer; /* with an octree, or NULL */
  bool bounded;       /* by a box and the ball around it: */
  skf_box box;        /* field coordinates, as the center */
  skf_vec3 center;
  double radius;
};

/* f = F - iso in a ball about a place. */
typedef struct skf_guess {
  int side;     /* -1, 1: all of the ball is outside, inside; 0: not known */
  bool vague;   /* 0, and smaller balls are better than a closer look; nothing below is set */
  double f;     /* at the place */
  skf_vec3 g;   /* gradient there, body frame */
  double slope; /* bound of |g| in the ball */
  double bend;  /* bound of the Hessian's norm */
  double rough; /* rounding error of f */
} skf_guess;

/* `far`: the size of the coordinates that q was computed from, for the rounding. */
skf_guess skf_collider_guess(const skf_collider *c, skf_vec3 q, double radius, double far);

/* Two solids in relative motion: a is bounded. */
typedef struct skf_duel {
  const skf_collider *a, *b;
  skf_rigid_motion ma, mb;
} skf_duel;

/* A place where the two touch. */
typedef struct skf_kiss {
  double t;
  skf_vec3 p;          /* frame of a */
  skf_vec3 at, normal; /* inertial; from a to b */
  double approach;     /* speed along the normal, positive when they come closer */
  double depth;
  bool summit; /* nowhere nearby are they deeper in each other, to second order */
} skf_kiss;

/* Newton's method from a guess, with p and t free: where F_a = F_b = iso and the gradients are opposite. False when it
   does not converge to such a place within `reach` of p. */
bool skf_kiss_in_time(const skf_duel *d, double t, skf_vec3 p, double reach, double duration, skf_kiss *out);

/* The same at a fixed time: where both are equally deep and the gradients are opposite; the depth may be negative. */
bool skf_kiss_at(const skf_duel *d, double t, skf_vec3 p, double reach, skf_kiss *out);

/* A place where two solids are close to touching. */
typedef struct skf_spot {
  skf_vec3 p;          /* frame of a */
  skf_vec3 at, normal; /* inertial; from a to b */
  double gap;          /* between the surfaces, to first order; negative where they overlap */
  skf_vec3 push;       /* on b, as the solver left it: mean force over the last step, */
  skf_vec3 twist;      /* and torque of rolling friction */
  bool lost;           /* Newton's method did not follow it */
} skf_spot;

enum { SKF_SPOTS = 24 };

/* Balls, frame of a. */
typedef struct skf_leaf_cell {
  skf_vec3 center;
  double radius;
  double until; /* dismissed until the bodies have moved by that since the search */
} skf_leaf_cell;

typedef struct skf_leaves {
  size_t n, capacity;
  skf_leaf_cell *cell;
} skf_leaves;

/* The places where two solids, in their poses at time 0, come closest to each other, and cells around: certified, up to
   rounding, that while no place of b's material near a moves against a's by more than `margin`, the two meet nowhere
   but in those. Fills spots[SKF_SPOTS] with the nearest place from each cell; those within 0.02 of a's radius of each
   other are one. SKF_ERR_CONVERGENCE when it takes more than 400,000 cells, or SKF_ERR_NOMEM. */
skf_status skf_near_find(const skf_duel *d, double margin, skf_spot *spots, int *count, skf_leaves *leaves);

/* Looks through the cells again in other poses: those where the two cannot meet are dismissed for certain, from the
   others the nearest places are looked for. New ones are added. `moved`: by how much the bodies have since the search,
   of which they may do `step` once more in another way; `ahead`: for how much of that cells are tried to be dismissed
   at once. SKF_ERR_NOMEM, or SKF_OK. */
skf_status skf_near_check(const skf_duel *d, skf_leaves *leaves, double moved, double step, double ahead,
                          skf_spot *spots, int *count);

#endif
