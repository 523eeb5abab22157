/* SPDX-License-Identifier: MIT */
/* Where a curved path first enters a body, and what happens there. */
#ifndef SKF_MOTION_CONTACT_H
#define SKF_MOTION_CONTACT_H

#include "motion/path.h"
#include "motion/slide.h"
#include "motion/world.h"

typedef struct skf_touch {
  bool found;
  size_t body;
  double s; /* on the path */
} skf_touch;

typedef struct skf_search_report {
  size_t bounds, grazing;
} skf_search_report;

/* Where to look on a path. */
typedef struct skf_hunt {
  const skf_path *path;
  double from, to; /* of s */
  size_t born;     /* a body on whose surface the path is at `from`, or SIZE_MAX */
  int side;        /* from where it came there: -1 outside (a contact right there is then one that goes inwards), 1 */
  bool fast;       /* by samples, see skf_search */
  const unsigned char *entered; /* of each body: the path has entered it, if it is not outside beyond doubt; or NULL */
  const skf_rail *along;        /* the path runs along these surfaces, which it does not enter; or NULL */
} skf_hunt;

/* The first s where the path goes from F < iso to F >= iso of any body. Pieces of the path that are within rounding of
   a surface and then leave it are no contacts; the report counts them as grazing. */
skf_touch skf_contact_find(const skf_world *world, const skf_hunt *how, skf_search_report *report);

/* Index of a body on whose surface p lies up to rounding, SIZE_MAX when there is none. */
size_t skf_contact_born(const skf_world *world, skf_clock t, skf_vec3 p);

/* Outward unit normal in the inertial frame; zero where the field has no gradient. */
skf_vec3 skf_contact_normal(const skf_world_body *b, skf_clock t, skf_vec3 p);

/* Velocity after a rebound, and which kind it is: SKF_OUTCOME_BOUNCE, _SLIDE or _REST. A slide is made of hops: *hops
   tells that it goes on. */
skf_outcome skf_contact_rebound(const skf_world *world, const skf_world_body *b, const skf_flight_options *options,
                                skf_clock t, skf_vec3 p, skf_vec3 normal, skf_vec3 before, bool *hops, skf_vec3 *after);

#endif
