/* SPDX-License-Identifier: MIT */
/* Rays from far away, and fields whose lengths are huge or tiny: both are answered in a frame of their own. */
#ifndef SKF_RAY_FRAME_H
#define SKF_RAY_FRAME_H

#include "core/vec3.h"
#include "ray/walk.h"

typedef struct skf_frame {
  const skf_tracer *tracer; /* which answers */
  skf_ray ray;              /* as it is put to that */
  double ahead;             /* by how much it starts later */
  bool lost;                /* its places there leave the range of doubles: nothing can be told of it */
} skf_frame;

static inline bool skf_frame_needed(const skf_tracer *t, const skf_ray *ray) {
  return t->copy || v3_norm2(v3_sub(ray->origin, t->middle)) > t->far2;
}

skf_frame skf_frame_of(const skf_tracer *tracer, const skf_ray *ray);

/* A hit on the frame's ray, as one on the ray itself. */
void skf_frame_leave(const skf_frame *f, const skf_tracer *tracer, skf_hit *hit);

#endif
