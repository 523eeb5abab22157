/* SPDX-License-Identifier: MIT */
/* The orbits that notebooks fly, and what times them. */
#ifndef NOTEBOOKS_COURSE_H
#define NOTEBOOKS_COURSE_H

#include "core/vec3.h"
#include "nb.h"
#include "skelfield/skelfield.h"
#include <time.h>

/* One orbit of one world, in SI units. */
typedef struct course {
  const char *name, *file, *told;
  size_t particle; /* of the scene */
  double end, drawn;
  const skf_field *field;
  skf_world *world;
  double gain, rate; /* acceleration = gain grad F in the body's frame, which turns about z with this rate */
  skf_state start;
  skf_vec3 goal;    /* the place at the end, by the reference */
  double certainty; /* how far two references are apart there */
} course;
enum { COURSES = 3 };
course courses[COURSES] = {
    {"donut", "data/donut.yaml", "the bow: 5 turns over the top and through the hole", 1, 110783.14, 22156.6},
    {"cigar", "data/cigar.yaml", "over the ends of the cigar for four days", 1, 345600, 60000},
    {"cross", "data/cross.yaml", "against the turn of the cross for eight days", 1, 691200, 200000},
};

double seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void read_course(course *c) {
  skf_scene *scene;
  skf_error problem;
  if (skf_scene_read(c->file, &scene, &problem)) nb_fail("%s, line %ld: %s", c->file, problem.line, problem.text);
  const skf_body *b = scene->bodies;
  const skf_particle *p = scene->particles + c->particle;
  nb_require(scene->body_count == 1 && (b->spin.rate == 0 || b->spin.axis.z == 1) && !p->launch.given);
  c->field = b->field, c->gain = scene->G * b->rho, c->rate = b->spin.rate;
  c->start = (skf_state){0, p->position, p->velocity};
  skf_attractor body = {c->field, b->iso, c->gain, b->spin};
  nb_require(skf_world_new(&body, 1, &c->world) == SKF_OK);
  printf("%s: %s\n", c->name, c->told);
}

#endif
