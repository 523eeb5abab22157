/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a run of particles writes: rows, the contact log, a contact map, approaches; and what it counts meanwhile. */
#ifndef SKF_TOOLS_RUN_OUTPUTS_H
#define SKF_TOOLS_RUN_OUTPUTS_H

#include "contact_map.h"
#include "run_approaches.h"
#include "run_summary.h"
#include "trajectory.h"

typedef struct run_outputs {
  const cli *c;
  trajectory_table table;
  const skf_world *world;
  skf_geo *geo; /* of the ground track */
  size_t track_body;
  run_place *places;
  skf_quantities *quantities; /* where --invariants asks for them */
  size_t frame;               /* rows and contacts are in the frame of this body, or SIZE_MAX: inertial */
  skf_state *seen;            /* there */
  const trajectory_writer *writer;
  void *trajectory;
  cli_out contacts;
  bool log;
  contact_map map; /* where they lie on a body */
  run_approaches near;
  int status; /* of what has been written */
  run_summary sum;
} run_outputs;

/* Whether the options fit each other: who has stdout, no file twice. CLI_DONE, or another status after the message, as
   all of these. */
int run_outputs_check(const cli *c);
/* From the command line, before anything is opened. */
int run_outputs_new(run_outputs *o, const cli *c, const skf_scene *scene, const skf_world *world);
/* By the first process; or by all of `crew`, which then write the trajectory together if they can (table.crew tells):
   rows are then of each one's own particles, and all close. */
int run_outputs_open(run_outputs *o, const team *crew);
/* Rows and contacts in the inertial frame, for skf_run_sink; user is the run_outputs. */
skf_status run_outputs_row(void *user, double t, const skf_state *states);
skf_status run_outputs_contact(void *user, const skf_contact *contact);
/* Commits what is complete (all of it, or the rows before a failure or an interrupt), or leaves nothing of it. */
int run_outputs_close(run_outputs *o, bool keep);
void run_outputs_free(run_outputs *o);

#endif
