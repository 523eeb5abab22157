/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writers of trajectories: one file each, one row in the list of formats, chosen by the ending of the file's name. */
#ifndef SKF_TOOLS_TRAJECTORY_H
#define SKF_TOOLS_TRAJECTORY_H

#include "team.h"

/* What a trajectory is about. */
typedef struct trajectory_table {
  const skf_scene *scene;
  const char *scene_path;
  bool track;      /* rows carry latitude, longitude [deg] and height [L] over a body */
  bool invariants; /* rows carry skf_quantities */
  bool turning;    /* everything is in the frame of the body that spins */
  /* Rows are of the particles of this process, rank, rank + size, ..., and all processes write the file together; NULL:
     of all particles. */
  const team *crew;
} trajectory_table;

typedef struct run_place {
  double latitude, longitude, height; /* degrees */
} run_place;

/* What a row carries besides states, one a particle; NULL: not asked for. */
typedef struct run_more {
  const run_place *places;
  const skf_quantities *quantities;
} run_more;

/* The columns of skf_quantities, and their numbers. */
enum { RUN_QUANTITIES = 6 };
#define RUN_QUANTITY_NAMES "energy,jacobi,lx,ly,lz,l_axis"
static inline void run_quantities(const skf_quantities *q, double out[RUN_QUANTITIES]) {
  skf_vec3 L = q->angular_momentum;
  const double all[RUN_QUANTITIES] = {q->energy, q->jacobi, L.x, L.y, L.z, q->axial_momentum};
  for (int k = 0; k < RUN_QUANTITIES; k++) out[k] = all[k];
}

typedef struct trajectory_writer {
  /* Each returns CLI_DONE, or another status after the message: the same for all processes that write together. path
     NULL or "-" is stdout. *self NULL: the processes do not see the same files. */
  int (*open)(void **self, const char *path, const trajectory_table *table);
  int (*row)(void *self, double t, const skf_state *states, const run_more *more); /* of all particles */
  int (*contact)(void *self, const skf_contact *contact); /* NULL: keeps none; of the first process alone */
  int (*commit)(void *self);                              /* frees self */
  void (*abort)(void *self);                              /* frees self */
} trajectory_writer;

extern const trajectory_writer trajectory_writer_csv;

/* By the file's ending; CSV for stdout. CLI_BAD after the message for an ending that none has, CLI_FAILED where the
   format's module is missing. */
int trajectory_writer_for(const char *path, const trajectory_writer **out);
/* The one with which all processes write such a file together; NULL where there is none. */
const trajectory_writer *trajectory_writer_together(const char *path);

/* The contract's contact log, one CSV row for each contact. */
void contact_header(FILE *f);
void contact_row(FILE *f, const skf_scene *scene, const skf_contact *c);

#endif
