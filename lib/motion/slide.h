/* SPDX-License-Identifier: MIT */
/* Motion along surfaces: what holds a particle down keeps it on one body, in the groove of two, or in a corner. */
#ifndef SKF_MOTION_SLIDE_H
#define SKF_MOTION_SLIDE_H

#include "skelfield/motion.h"
#include "motion/world.h"

enum { SKF_GROUNDS = 3 };

/* Bodies on whose surfaces a particle slides. */
typedef struct skf_rail {
  size_t n, body[SKF_GROUNDS];
} skf_rail;

bool skf_rail_has(const skf_rail *rail, size_t body);

/* Takes a place and a velocity (inertial) to the nearest ones on all surfaces of the rail. */
void skf_rail_project(const skf_world *world, const skf_rail *rail, skf_clock t, skf_vec3 *x, skf_vec3 *v);

/* What follows an impact on a body, by option: the velocity after it, and what the particle slides on from then on;
   `before` is of one that slides on *rail, if on anything. */
skf_outcome skf_slide_strike(const skf_world *world, const skf_flight_options *options, size_t body, skf_clock t,
                             skf_vec3 p, skf_vec3 before, skf_rail *rail, skf_vec3 *after);

/* The flight's integrator on its rail, from its orbit. */
skf_status skf_slide_begin(skf_flight *flight, double h);
/* One step along it, up to where it takes off, meets another body or stops; as skf_flight_step. */
skf_status skf_slide_step(skf_flight *flight, skf_contact *contact, bool *touched);

#endif
