/* SPDX-License-Identifier: MIT */
/* First crossings that models have found wait here for the field at their places, so that it is asked for many at
   once. What becomes of one does not depend on the others. */
#ifndef SKF_RAY_ROOM_H
#define SKF_RAY_ROOM_H

#include "ray/walk.h"

/* What is settled at a time: as many points as the field's vectors like to have; a packet more may come in before. */
enum { SKF_ROOM = 256, SKF_ROOM_ALL = SKF_ROOM + 8 };

typedef struct skf_room {
  size_t count;
  skf_hit *hit[SKF_ROOM_ALL];
  const skf_leaf *leaf[SKF_ROOM_ALL];
  int looks[SKF_ROOM_ALL];
  double o[3][SKF_ROOM_ALL], d[3][SKF_ROOM_ALL], t[SKF_ROOM_ALL]; /* the ray; the place to look at next */
  /* along it, as in skf_bow; `bend`: what bounds the field's second derivatives in the leaf; per: 1 / length */
  double c2[SKF_ROOM_ALL], c3[SKF_ROOM_ALL], off[SKF_ROOM_ALL], bend[SKF_ROOM_ALL], per[SKF_ROOM_ALL];
  double turn[3][SKF_ROOM_ALL], loose[SKF_ROOM_ALL]; /* of the model's gradient along the ray; how far off it may be */
  double from[SKF_ROOM_ALL], from_f[SKF_ROOM_ALL], to[SKF_ROOM_ALL], to_f[SKF_ROOM_ALL]; /* around the crossing */
} skf_room;

/* The field at the first places. */
typedef struct skf_sights {
  double F[SKF_ROOM_ALL], g[3][SKF_ROOM_ALL], size[SKF_ROOM_ALL]; /* F with iso in it: see skf_knot */
} skf_sights;

/* Sets the hits of the first m, and done[i], where a crossing is good enough; else its next place. Reads up to a whole
   vector. */
typedef void skf_settle_fn(const skf_tracer *tracer, skf_room *r, size_t m, const skf_sights *at, bool *done);
skf_settle_fn skf_room_settle_scalar, skf_room_settle_avx2;

/* A crossing of a walk with a bow. */
void skf_room_add(skf_room *r, skf_hit *hit, const skf_walk *w, const skf_knot *a, const skf_knot *b, double guess);

/* Looks at the first SKF_ROOM of those who wait: they leave, or wait again. */
void skf_room_serve(skf_room *r, const skf_tracer *tracer, skf_ray_report *report);

#endif
