/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run_outputs.h"
#include "launch.h"
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static bool to_stdout(const char *path) { return !path || strcmp(path, "-") == 0; }

int run_outputs_check(const cli *c) {
  const char *contacts = cli_value(c, "contacts"), *out = cli_value(c, "output");
  if (cli_given(c, "json") && to_stdout(out)) return cli_fail(CLI_BAD, "--json needs -o FILE: both want stdout");
  if (contacts && to_stdout(contacts) && (to_stdout(out) || cli_given(c, "json")))
    return cli_fail(CLI_BAD, "--contacts - needs stdout for itself, expected a file name");
  return CLI_DONE;
}

/* The frame of rows and contacts: that of the option, or the scene's. */
static int choose_frame(run_outputs *o) {
  const skf_scene *scene = o->table.scene;
  const char *frame = cli_value(o->c, "frame");
  o->table.turning = frame ? strcmp(frame, "body") == 0 : scene->simulation.turning;
  if (frame && !o->table.turning && strcmp(frame, "inertial") != 0)
    return cli_fail(CLI_BAD, "--frame %s, expected inertial or body", frame);
  if (!o->table.turning) return CLI_DONE;
  if (!skf_scene_turning_body(scene, &o->frame))
    return cli_fail(CLI_BAD, "--frame body, but the bodies of %s spin differently, expected inertial",
                    o->table.scene_path);
  if (o->frame == SIZE_MAX) return CLI_DONE; /* nothing turns: its frame is the inertial one */
  o->seen = calloc(scene->particle_count, sizeof *o->seen);
  return o->seen ? CLI_DONE : cli_fail(CLI_FAILED, "out of memory");
}

static int choose_track(run_outputs *o) {
  const skf_scene *scene = o->table.scene;
  const char *name = cli_value(o->c, "ground-track");
  if (!name) return CLI_DONE;
  int b = cli_body(scene, name);
  if (b < 0) return CLI_BAD;
  o->track_body = (size_t)b;
  int status = launch_geo(scene->bodies + b, &o->geo);
  if (status) return status;
  o->table.track = true;
  o->places = calloc(scene->particle_count, sizeof *o->places);
  return o->places ? CLI_DONE : cli_fail(CLI_FAILED, "out of memory");
}

static int choose_invariants(run_outputs *o) {
  o->table.invariants = cli_given(o->c, "invariants");
  if (!o->table.invariants) return CLI_DONE;
  o->quantities = calloc(o->table.scene->particle_count, sizeof *o->quantities);
  return o->quantities ? CLI_DONE : cli_fail(CLI_FAILED, "out of memory");
}

int run_outputs_new(run_outputs *o, const cli *c, const skf_scene *scene, const skf_world *world) {
  *o = (run_outputs){.c = c, .table = {.scene = scene, .scene_path = cli_operand(c, 0)}, .world = world};
  int status = choose_frame(o);
  if (!status) status = choose_track(o);
  if (!status) status = choose_invariants(o);
  if (!status) status = contact_map_new(&o->map, c, scene, world);
  return status ? status : run_approaches_new(&o->near, c, scene, world);
}

static int open_others(run_outputs *o) {
  const char *path = cli_value(o->c, "output"), *contacts = cli_value(o->c, "contacts");
  int status = trajectory_writer_for(path, &o->writer);
  if (status) return status;
  if (contacts) status = cli_out_open(&o->contacts, contacts); /* first: opening the other may print its header */
  if (status) return status;
  o->log = contacts != NULL;
  if (o->log) contact_header(o->contacts.file);
  status = contact_map_open(&o->map);
  return status ? status : run_approaches_open(&o->near);
}

/* By all processes: table.crew stays NULL where they cannot write together. */
static int open_together(run_outputs *o, const char *path, const team *crew) {
  const trajectory_writer *writer = trajectory_writer_together(path);
  if (team_agree(crew, writer ? CLI_DONE : CLI_FAILED) != CLI_DONE) return CLI_DONE;
  o->table.crew = crew;
  int status = writer->open(&o->trajectory, path, &o->table);
  if (o->trajectory)
    o->writer = writer;
  else
    o->table.crew = NULL;
  return status;
}

int run_outputs_open(run_outputs *o, const team *crew) {
  const char *path = cli_value(o->c, "output");
  bool leads = !crew || team_leads(crew);
  int status = leads ? open_others(o) : CLI_DONE;
  if (crew) status = team_agree(crew, status);
  if (crew && status == CLI_DONE) status = open_together(o, path, crew);
  if (status == CLI_DONE && !o->trajectory && leads) status = o->writer->open(&o->trajectory, path, &o->table);
  return crew ? team_agree(crew, status) : status;
}

static double degrees(double radians) { return radians * (180 / 3.14159265358979323846); }

/* Particles in a row. */
static size_t row_width(const run_outputs *o) {
  const team *crew = o->table.crew;
  size_t n = o->table.scene->particle_count;
  return crew ? (n + (size_t)(crew->size - 1 - crew->rank)) / (size_t)crew->size : n;
}

skf_status run_outputs_row(void *user, double t, const skf_state *states) {
  run_outputs *o = user;
  size_t n = row_width(o);
  for (size_t i = 0; o->geo && i < n; i++) {
    skf_place p;
    if (skf_geo_place(o->geo, skf_world_to_body(o->world, o->track_body, t, states[i].position), &p))
      p = (skf_place){NAN, NAN, NAN};
    o->places[i] = (run_place){degrees(p.latitude), degrees(p.longitude), p.height};
  }
  for (size_t i = 0; o->quantities && i < n; i++) o->quantities[i] = skf_world_quantities(o->world, states + i);
  for (size_t i = 0; o->seen && i < n; i++) o->seen[i] = skf_world_state_to_body(o->world, o->frame, states + i);
  o->sum.rows++;
  o->sum.t = t;
  o->status = o->writer->row(o->trajectory, t, o->seen ? o->seen : states, &(run_more){o->places, o->quantities});
  return o->status ? SKF_ERR_IO : SKF_OK;
}

static skf_contact seen_contact(const run_outputs *o, const skf_contact *c) {
  skf_contact in = *c;
  skf_state before = {c->t, c->position, c->before}, after = {c->t, c->position, c->after};
  before = skf_world_state_to_body(o->world, o->frame, &before);
  in.position = before.position, in.before = before.velocity;
  in.after = skf_world_state_to_body(o->world, o->frame, &after).velocity;
  in.normal = skf_world_direction_to_body(o->world, o->frame, c->t, c->normal);
  return in;
}

skf_status run_outputs_contact(void *user, const skf_contact *c) {
  run_outputs *o = user;
  skf_contact in;
  if (contact_map_wanted(&o->map)) contact_map_add(&o->map, c);
  if (o->seen) in = seen_contact(o, c), c = &in;
  o->sum.contacts++;
  if (o->log) contact_row(o->contacts.file, o->table.scene, c);
  if (o->writer->contact) o->status = o->writer->contact(o->trajectory, c);
  return o->status ? SKF_ERR_IO : SKF_OK;
}

int run_outputs_close(run_outputs *o, bool keep) {
  int status = CLI_DONE, log = CLI_DONE;
  if (o->trajectory && keep) status = o->writer->commit(o->trajectory);
  if (o->trajectory && !keep) o->writer->abort(o->trajectory);
  keep = keep && status == CLI_DONE;
  if (o->log && keep) log = cli_out_commit(&o->contacts);
  if (o->log && !keep) cli_out_abort(&o->contacts);
  o->trajectory = NULL, o->log = false;
  int map = contact_map_close(&o->map, keep && log == CLI_DONE);
  int near = run_approaches_close(&o->near, o->seen ? o->frame : SIZE_MAX, keep && log == CLI_DONE && map == CLI_DONE);
  return status ? status : log ? log : map ? map : near;
}

void run_outputs_free(run_outputs *o) {
  run_outputs_close(o, false);
  contact_map_free(&o->map);
  run_approaches_free(&o->near);
  skf_geo_free(o->geo);
  free(o->places);
  free(o->quantities);
  free(o->seen);
}
