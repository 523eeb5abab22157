/* SPDX-License-Identifier: MIT */
/* What the search for contacts learns of the bodies' surfaces: octrees, made when the first flight asks for them and
   filled as paths come by. Shared by all flights in a world, on all threads. */
#ifndef SKF_MOTION_SCOUT_H
#define SKF_MOTION_SCOUT_H

#include "motion/world.h"
#include "skelfield/ray.h"

/* Makes room for them; nothing is computed yet. */
skf_scout *skf_scout_new(size_t bodies);
void skf_scout_free(skf_scout *scout);

/* Makes the tracers of all bodies that have a surface, once. SKF_ERR_NOMEM, or SKF_OK. */
skf_status skf_scout_send(const skf_world *world);

/* The tracer of a body, whose octree exists; NULL before skf_scout_send, and where there is none: unbounded surfaces.
 */
const skf_tracer *skf_scout_tracer(const skf_world *world, size_t body);

#endif
