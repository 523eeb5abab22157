/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What `skelfield simulate` wrote, read back for pictures. */
#ifndef SKF_TOOLS_RUN_CSV_H
#define SKF_TOOLS_RUN_CSV_H

#include "cli.h"

typedef struct run_state {
  double t;
  skf_vec3 x, v;
} run_state;

typedef struct run_particle {
  char name[64];
  run_state *states; /* in the order of the file */
  size_t count;
} run_particle;

typedef struct run_contact {
  size_t particle; /* index; the run's particle_count when the run does not have it */
  run_state state; /* before the contact */
  char outcome[16];
} run_contact;

typedef struct run_data {
  run_particle *particles;
  size_t particle_count;
  run_contact *contacts;
  size_t contact_count;
} run_data;

/* Reads RUN.csv (columns t,particle,x,y,z,vx,vy,vz first, others after them are ignored) and, unless NULL, C.csv.
   CLI_DONE, or CLI_BAD or CLI_FAILED after the message. */
int run_read(const char *path, const char *contacts, run_data *out);
void run_free(run_data *run);

/* The path of a particle as a fine polyline: cubic between the states by their velocities, broken at contacts. Returns
   the points (to be freed), NULL when memory is out. */
skf_vec3 *run_path(const run_data *run, size_t particle, size_t *count);

/* What there is of a run at time t: the states before, one at t between two of them, the contacts before. False when
   memory is out; free it with run_free either way. */
bool run_until(const run_data *run, double t, run_data *out);

#endif
