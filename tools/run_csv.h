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

/* A body that moves: its center of mass, its attitude (a unit quaternion), and their rates. */
typedef struct run_pose {
  double t;
  skf_vec3 x;
  double q[4];
  skf_vec3 v, w;
} run_pose;

typedef struct run_body {
  size_t body; /* index in the scene */
  run_pose *poses;
  size_t count;
} run_body;

typedef struct run_bodies_data {
  run_body *bodies;
  size_t count;
} run_bodies_data;

/* Reads what simulate --bodies wrote, of the scene's bodies; NULL: nothing. */
int run_bodies_read(const char *path, const skf_scene *scene, run_bodies_data *out);
void run_bodies_free(run_bodies_data *run);

/* Where a body is at time t, its first row being where the scene has it: turned about the axis through `about`, then
   shifted. Between two rows: a cubic, or a straight line where the velocities do not fit, and a turn by the mean
   angular velocity and what it misses; before the first and after the last as they are. */
typedef struct run_place {
  skf_vec3 axis, about, shift;
  double angle;
} run_place;
run_place run_body_at(const run_body *b, double t);

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
