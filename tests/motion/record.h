/* SPDX-License-Identifier: MIT */
/* A world for runs of many particles, and what they make. */
#ifndef SKF_TESTS_MOTION_RECORD_H
#define SKF_TESTS_MOTION_RECORD_H

#include "motion/bytes.h"
#include "motion/worlds.h"
#include <string.h>

enum { COUNT = 40, ROWS = 200, LOG = 4000 };

typedef struct record {
  size_t rows, contacts;
  double t[ROWS];
  skf_state states[ROWS][COUNT];
  skf_contact log[LOG];
  size_t row_of[LOG]; /* rows delivered before this contact */
} record;

static skf_status row(void *user, double t, const skf_state *states) {
  record *r = user;
  assert_true(r->rows < ROWS);
  r->t[r->rows] = t;
  memcpy(r->states[r->rows++], states, sizeof r->states[0]);
  return SKF_OK;
}

static skf_status contact(void *user, const skf_contact *c) {
  record *r = user;
  assert_true(r->contacts < LOG);
  r->row_of[r->contacts] = r->rows;
  memcpy(r->log + r->contacts++, c, offsetof(skf_contact, outcome) + sizeof c->outcome); /* padding stays zero */
  return SKF_OK;
}

static skf_field *field;
static skf_world *world;
static skf_state start[COUNT];
static const skf_flight_options bounce = {.contact = SKF_CONTACT_BOUNCE, .restitution = 0.9};

/* A ring with a body of its own; particles fall on it from a sphere around it. */
static int set_up(void **state) {
  (void)state;
  skf_element e = ring_of(1, newton, 1);
  world = single(&e, 1, 9, 1 / TAU, (skf_spin){{1, 0, 0}, {0, 0, 0}, 0.3}, &field);
  for (int i = 0; i < COUNT; i++) {
    double z = -1 + (i + 0.5) * 2 / COUNT, phi = 2.399963 * i, r = sqrt(1 - z * z);
    start[i] = (skf_state){0, {2 * r * cos(phi), 2 * r * sin(phi), 2 * z}, {0, 0.1, 0}};
  }
  return 0;
}

static int tear_down(void **state) {
  (void)state;
  skf_world_free(world);
  skf_field_free(field);
  return 0;
}

#endif
