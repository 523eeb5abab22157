/* SPDX-License-Identifier: MIT */
/* A path seen from a body: F - iso along it, and how far it can change. */
#ifndef SKF_MOTION_VIEW_H
#define SKF_MOTION_VIEW_H

#include "motion/path.h"
#include "motion/world.h"
#include "ray/ball.h"
#include "ray/walk.h"

typedef struct skf_view {
  const skf_world_body *b;
  const skf_tracer *tracer; /* whose octree knows the body; or NULL */
  const skf_path *path;
  double omega; /* turn per unit of s */
} skf_view;

skf_view skf_view_of(const skf_world *world, size_t body, const skf_path *path);

/* F - iso at s. */
double skf_view_level(const skf_view *v, double s);

/* The same with its derivative by s, its rounding error, and |grad F|. */
typedef struct skf_sight {
  double s, f, slope, rough, steep;
} skf_sight;
skf_sight skf_view_at(const skf_view *v, double s);

/* A crossing in [a, b] with f(a) < 0 <= f(b), by Chandrupatla's method, until F - iso is zero or the bracket is as
   narrow as s allows. */
double skf_view_polish(const skf_view *v, double a, double b);

/* The first entry in [a, b] that samples at the ends of so many pieces show. *side is where the path was last beyond
   doubt, outside (-1), inside (1) or not known (0), and is kept up to date. */
bool skf_view_sample(const skf_view *v, double a, double b, int pieces, int *side, double *s);

/* The place of largest F - iso in [a, b], certified: nowhere it is larger by more than rounding; nothing happens unless
   it is larger than best->f. */
void skf_view_summit(const skf_view *v, double a, double b, skf_sight *best);

/* Rounding error of F - iso at q, seen from the inertial place x; what is infinite is surely not iso. */
double skf_view_noise(const skf_world_body *b, double F, skf_vec3 g, skf_vec3 q, skf_vec3 x);

/* What is known of F - iso over |s - middle| <= half. */
typedef struct skf_glance {
  skf_vec3 x, q;      /* the place at the middle, inertial and in the body's frame */
  skf_vec3 d;         /* dq/ds there, turned into the inertial frame */
  double speed, bend; /* bounds of |dq/ds| and |d2q/ds2| */
  double radius;      /* a ball about q holds the piece */
  skf_ball ball;      /* what the octree knows of it, once asked */
  double f, slope;    /* at the middle */
  double second;      /* bound of |d2f/ds2| */
  double rough;       /* rounding error of f */
  double lo, hi;      /* of f */
} skf_glance;

/* The geometry alone. */
skf_glance skf_view_place(const skf_view *v, double middle, double half);
bool skf_view_beyond_wall(const skf_view *v, const skf_glance *g);
/* -1 or 1 where the piece is surely outside or inside: by the wall and the octree, without any evaluation. *enough
   tells that smaller pieces are better than a closer look at this one. */
int skf_view_side(const skf_view *v, skf_glance *g, bool *enough);
/* Fills in f and what follows, unless bounds alone tell that f > 0 or f < below all along: then it returns false and
   sets nothing but lo and hi. */
bool skf_view_measure(const skf_view *v, skf_glance *g, double half, double below);

#endif
