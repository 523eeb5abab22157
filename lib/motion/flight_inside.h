/* SPDX-License-Identifier: MIT */
/* A flight from the inside: flight.c flies it alone, cluster.c together with others. */
#ifndef SKF_MOTION_FLIGHT_INSIDE_H
#define SKF_MOTION_FLIGHT_INSIDE_H

#include "motion/contact.h"
#include "motion/flight.h"
#include "motion/integrator.h"
#include "motion/slide.h"
#include "motion/view.h"
#include <stdint.h>

typedef enum skf_fate { SKF_FATE_FLIES, SKF_FATE_STOPPED, SKF_FATE_RIDES, SKF_FATE_ABSORBED } skf_fate;

/* The closest approach so far. */
typedef struct skf_nearest {
  skf_sight best;
  skf_approach is;
} skf_nearest;

struct skf_flight {
  const skf_world *world;
  skf_flight_options options;
  const skf_integrator_ops *ops;
  bool blind;    /* to joins, which there are: steps of one length pass over them */
  bool together; /* with others, whose pull is none of the world's: no constants of its own */
  void *work;
  size_t work_size;
  skf_ode ode;
  skf_nearest *near;    /* of each body, or NULL; kept by skf_flight_save, too */
  unsigned char *entry; /* of each body: its entry has been told, and the path is not clear of its surface; or NULL */
  double horizon;       /* what comes after this time is no approach */
  /* From here on: what skf_flight_save keeps. */
  skf_orbit orbit; /* at the end of the last step, after its contact */
  skf_clock from;  /* start of the last step */
  skf_path path;   /* of the last step, where there was one */
  bool dense;      /* it is known */
  skf_fate fate;
  size_t body;         /* that it rides on, or on whose surface it starts; SIZE_MAX: none */
  skf_vec3 seat;       /* its place on that body */
  bool within;         /* it is on the surface of `body` on its way in */
  bool hops;           /* it slides by hops: together with others */
  skf_rail rail, last; /* what it slides on; what it has slid on in the last step */
  int wedged;
  skf_invariants reference; /* since the last contact */
  double momentum_scale;
  uint64_t zone; /* of a blind flight */
  skf_flight_report report;
};

/* The longest step from a place. */
double skf_flight_longest(const skf_flight *f, const skf_orbit *at);
/* The orbit has moved on by a step from `before`. */
void skf_flight_moved(skf_flight *f, const skf_orbit *before);
/* The path of the last step. */
skf_status skf_flight_know_path(skf_flight *f);
/* The first contact along it. */
skf_touch skf_flight_look(skf_flight *f);
/* Cuts the last step at a contact. *silent: a further hop of a slide, not told again. */
skf_status skf_flight_touch(skf_flight *f, const skf_touch *at, skf_contact *c, bool *silent);
/* The same for those who ask: either may be NULL; *touched unless it is silent. */
skf_status skf_flight_tell(skf_flight *f, const skf_touch *at, skf_contact *contact, bool *touched);
/* Begins anew from the orbit, on the rail if there is one. */
skf_status skf_flight_restart(skf_flight *f);
/* It stays at its place on a body. */
void skf_flight_ride(skf_flight *f, size_t body);
/* Where one that flies no more is. */
skf_state skf_flight_seated(const skf_flight *f, double t);
/* The worse of two drifts, the second one being that of a quantity relative to a scale. */
double skf_drift_worse(double drift, double now, double before, double scale);

#endif
