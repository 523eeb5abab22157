/* SPDX-License-Identifier: MIT */
/* A run of many particles from the inside: run.c flies it, run_team.c shares it, run_keep.c saves it. */
#ifndef SKF_MOTION_RUNNER_H
#define SKF_MOTION_RUNNER_H

#include "motion/cluster.h"
#include "motion/flight.h"
#include <stdint.h>
#include <omp.h>

typedef struct skf_log_entry {
  skf_contact contact;
  size_t sequence; /* of the particle's contacts */
} skf_log_entry;

/* Contacts of the window, as one thread has seen them. */
typedef struct skf_contact_log {
  skf_log_entry *entries;
  size_t count, capacity;
} skf_contact_log;

skf_status skf_contact_log_add(skf_contact_log *log, const skf_contact *c, size_t sequence);

/* What a particle waits with: a contact later than the window; and how far it is. */
typedef struct skf_pending {
  skf_contact contact;
  bool held;
  size_t sequence;
  size_t row; /* of the window, the next one */
} skf_pending;

struct skf_runner {
  const skf_world *world;
  skf_run run;
  skf_team team;
  const skf_run_sink *sink;
  const skf_progress *progress;
  double start;
  size_t row_count, window, first; /* rows; in a window; before this window */
  size_t mine;                     /* particles of this member: the arrays' length unless they say otherwise */
  skf_flight **flights;
  skf_cluster *cluster; /* of particles that attract each other, or NULL */
  skf_pending *waiting;
  skf_state *rows, *arrived; /* rows of the window, `width` states each; what another member has sent of one */
  size_t width, stride;      /* the first member has all particles' states, unless own; the others have their own */
  bool own;                  /* each member's sink has its own particles' rows */
  skf_contact_log *logs;     /* of each thread */
  int threads;
  skf_status *status; /* in this window */
  double *failed_at;
  omp_lock_t watching;
  size_t flown; /* rows of all its particles in this window */
  int stop;
};

static inline size_t skf_runner_rows(const skf_runner *r) {
  size_t left = r->row_count - r->first;
  return r->window < left ? r->window : left;
}

/* Member m has particles m, m + size, ...: neighbours cost alike. Its i-th one, and how many it has of n. */
static inline size_t skf_team_particle(const skf_team *t, size_t i) { return t->rank + i * t->size; }
static inline size_t skf_team_share(const skf_team *t, size_t member, size_t n) {
  return (n + t->size - 1 - member) / t->size;
}

/* The state of this member's particle i in row k of the window. */
static inline skf_state *skf_runner_cell(const skf_runner *r, size_t i, size_t k) {
  return r->rows + k * r->width + i * r->stride;
}

/* Adds to the worst so far: of failures of particles the first one, and anything else before those. */
void skf_team_worse(skf_status *worst, skf_run_failure *where, skf_status status, skf_run_failure failure);
/* The worst of all members' statuses, the same for all of them; where, of the first particle that failed, may be NULL.
 */
skf_status skf_team_agree(const skf_team *t, skf_status status, skf_run_failure *where);
/* Brings the window's rows (unless own) and contacts to the first member. */
skf_status skf_runner_collect(skf_runner *r);

#endif
