/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trajectories and contact logs as CSV, and the list of writers. */
#include "trajectory.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct run_csv {
  cli_out out;
  const trajectory_table *table;
} run_csv;

static void put_vector(FILE *f, skf_vec3 v) {
  const double x[3] = {v.x, v.y, v.z};
  for (int k = 0; k < 3; k++) {
    putc(',', f);
    cli_put(f, x[k]);
  }
}

static int open_csv(void **self, const char *path, const trajectory_table *table) {
  run_csv *w = calloc(1, sizeof *w);
  if (!w) return cli_fail(CLI_FAILED, "out of memory");
  int status = cli_out_open(&w->out, path);
  if (status != CLI_DONE) return free(w), status;
  w->table = table;
  fprintf(w->out.file, "t,particle,x,y,z,vx,vy,vz%s%s\n", table->track ? ",lat,lon,height" : "",
          table->invariants ? "," RUN_QUANTITY_NAMES : "");
  return *self = w, CLI_DONE;
}

static void put_quantities(FILE *f, const skf_quantities *q) {
  double x[RUN_QUANTITIES];
  run_quantities(q, x);
  for (int k = 0; k < RUN_QUANTITIES; k++) {
    putc(',', f);
    cli_put(f, x[k]);
  }
}

static int row_csv(void *self, double t, const skf_state *states, const run_more *more) {
  const run_place *places = more->places;
  run_csv *w = self;
  FILE *f = w->out.file;
  const skf_scene *scene = w->table->scene;
  for (size_t i = 0; i < scene->particle_count; i++) {
    if (isnan(states[i].position.x)) continue; /* absorbed */
    cli_put(f, t);
    putc(',', f);
    fputs(scene->particles[i].name, f); /* names hold no commas and no quotes */
    put_vector(f, states[i].position);
    put_vector(f, states[i].velocity);
    if (places) put_vector(f, (skf_vec3){places[i].latitude, places[i].longitude, places[i].height});
    if (more->quantities) put_quantities(f, more->quantities + i);
    putc('\n', f);
  }
  return ferror(f) ? CLI_FAILED : CLI_DONE; /* the commit tells why */
}

static int commit_csv(void *self) {
  run_csv *w = self;
  int status = cli_out_commit(&w->out);
  free(w);
  return status;
}

static void abort_csv(void *self) {
  run_csv *w = self;
  cli_out_abort(&w->out);
  free(w);
}

const trajectory_writer trajectory_writer_csv = {open_csv, row_csv, NULL, commit_csv, abort_csv};

void contact_header(FILE *f) { fputs("t,particle,body,x,y,z,nx,ny,nz,vx,vy,vz,outcome\n", f); }

void contact_row(FILE *f, const skf_scene *scene, const skf_contact *c) {
  cli_put(f, c->t);
  putc(',', f);
  fprintf(f, "%s,%s", scene->particles[c->particle].name, scene->bodies[c->body].name);
  put_vector(f, c->position);
  put_vector(f, c->normal);
  put_vector(f, c->before);
  fprintf(f, ",%s\n", skf_outcome_name(c->outcome));
}
