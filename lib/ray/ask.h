/* SPDX-License-Identifier: MIT */
/* Questions about what rays meet, put to the octree or to the walk. */
#ifndef SKF_RAY_ASK_H
#define SKF_RAY_ASK_H

#include "ray/packet.h"

/* What to do with the crossings of rays, and how much it cost. */
typedef struct skf_question {
  const skf_tracer *tracer;
  skf_crossing_fn *found;
  bool first, exact; /* see skf_packet */
  skf_ray_report report;
} skf_question;

void skf_report_add(skf_ray_report *sum, const skf_ray_report *r);

/* One ray; *last: the sign of F - iso at its end, 0 on the surface. */
skf_status skf_ask(skf_question *q, const skf_ray *ray, void *user, int *last);

/* Any number of them, each with its bits of skf_ask; the last thing that was wrong with one of them. */
skf_status skf_ask_many(skf_question *q, size_t n, const skf_ray *rays, skf_answer *user);

#endif
