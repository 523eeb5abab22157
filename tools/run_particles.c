/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run_particles.h"
#include "checkpoint.h"
#include "launch.h"
#include "run_outputs.h"
#include "simd/isa.h"
#include <math.h>
#include <stdlib.h>

/* Everything that a run holds. */
typedef struct particles {
  const cli *c;
  const skf_scene *scene;
  const char *scene_path;
  team *crew; /* processes that fly shares of the particles; the first one has the outputs */
  skf_world *world;
  skf_state *starts;
  skf_flight_report *reports;
  double *gm; /* G times the mass of each particle, where some have one */
  run_outputs out;
  checkpoint keep;
  skf_progress bar;
} particles;

/* A start inside a body is legal: the particle flies until it leaves. Some are named, the others counted. */
static void warn_inside(const particles *s) {
  const skf_scene *scene = s->scene;
  enum { NAMED = 5 };
  for (size_t b = 0; b < scene->body_count && scene->simulation.contact != SKF_CONTACT_NONE; b++) {
    size_t inside = 0;
    for (size_t i = 0; i < scene->particle_count; i++) {
      if (!(skf_world_level(s->world, b, 0, s->starts[i].position) > 1e-9 * fabs(scene->bodies[b].iso))) continue;
      if (++inside <= NAMED)
        cli_say("skelfield: warning: particle '%s' starts inside of body '%s': it flies freely until it leaves",
                scene->particles[i].name, scene->bodies[b].name);
    }
    if (inside > NAMED)
      cli_say("skelfield: warning: %zu more particles start inside of body '%s'", inside - NAMED,
              scene->bodies[b].name);
  }
}

static int check(const particles *s) {
  if (cli_given(s->c, "bodies"))
    return cli_fail(CLI_BAD, "%s: no body moves, expected motion for --bodies", s->scene_path);
  if (!s->scene->simulation.given)
    return cli_fail(CLI_BAD, "%s:1: no simulation, expected one with t_end and output_every", s->scene_path);
  if (s->scene->particle_count == 0)
    return cli_fail(CLI_BAD, "%s:1: no particles, expected at least one", s->scene_path);
  return run_outputs_check(s->c);
}

static int prepare(particles *s) {
  int status = launch_world(s->scene, &s->world);
  if (status == CLI_DONE) status = launch_starts(s->scene, s->scene_path, s->world, &s->starts);
  if (status == CLI_DONE) status = run_outputs_new(&s->out, s->c, s->scene, s->world);
  s->reports = calloc(s->scene->particle_count, sizeof *s->reports);
  return s->reports ? status : cli_fail(CLI_FAILED, "out of memory");
}

/* Particles with a mass attract the others. */
static int weigh(particles *s) {
  const skf_scene *scene = s->scene;
  size_t massless = 0;
  while (massless < scene->particle_count && scene->particles[massless].mass == 0) massless++;
  if (massless == scene->particle_count) return CLI_DONE;
  if (s->crew->size > 1)
    return cli_fail(CLI_BAD, "%s:%ld: particle '%s' has a mass, but %d processes share the run, expected one",
                    s->scene_path, scene->particles[massless].line, scene->particles[massless].name, s->crew->size);
  s->gm = calloc(scene->particle_count, sizeof *s->gm);
  if (!s->gm) return cli_fail(CLI_FAILED, "out of memory");
  for (size_t i = 0; i < scene->particle_count; i++) {
    s->gm[i] = scene->G * scene->particles[i].mass;
    if (!isfinite(s->gm[i]))
      return cli_fail(CLI_BAD, "%s:%ld: G times the mass of particle '%s' overflows, expected a finite number",
                      s->scene_path, scene->particles[i].line, scene->particles[i].name);
  }
  return CLI_DONE;
}

/* What all processes must have alike, and a run that goes on with the one that was saved. */
static uint64_t identity(const particles *s) {
  uint64_t scene = checkpoint_identity(s->scene, s->scene_path, s->world, s->starts);
  return s->out.near.path ? ~scene : scene; /* approaches are part of what is kept */
}

static int keep_checkpoints(particles *s) {
  s->keep = (checkpoint){.kind = &checkpoint_of_runner, .crew = s->crew, .particles = s->scene->particle_count};
  int status = checkpoint_options(&s->keep, s->c);
  if (s->keep.path) s->keep.identity = identity(s);
  return status;
}

static int ready(particles *s) {
  int status = check(s);
  if (status == CLI_DONE) status = prepare(s);
  if (status == CLI_DONE) warn_inside(s);
  if (status == CLI_DONE) status = weigh(s);
  return status == CLI_DONE ? keep_checkpoints(s) : status;
}

/* Says how a run ended early. */
static int complain(const particles *s, skf_status ended, const skf_run_failure *where) {
  const skf_scene *scene = s->scene;
  const char *kept = s->out.sum.rows ? "rows before are written" : "nothing written";
  if (ended == SKF_ERR_IO) return CLI_FAILED;
  if (team_lost(s->crew))
    return cli_fail(CLI_FAILED, "a process does not answer after t = %.9g, %s%s", s->out.sum.t, kept,
                    s->out.table.crew && s->out.sum.rows ? " but for the last ones" : "");
  if (ended == SKF_ERR_CANCELLED) return cli_fail(CLI_FAILED, "interrupted after t = %.9g, %s", s->out.sum.t, kept);
  if (ended == SKF_ERR_CONVERGENCE)
    return cli_fail(CLI_FAILED, "particle '%s' meets a force that no step can follow at t = %.17g, %s",
                    scene->particles[where->particle].name, where->t, kept);
  return cli_fail_status(ended, "simulate");
}

/* Whether this process wants to stop: for an interrupt, or for the next checkpoint. */
static bool wants_stop(void *user) {
  const particles *s = user;
  return cli_interrupted() || (team_leads(s->crew) && checkpoint_due(&s->keep));
}

static int watch(void *user, double done) {
  const particles *s = user;
  s->bar.report(s->bar.user, done);
  return team_poll(s->crew, wants_stop(user));
}

static skf_status keep_row(void *user, double t, const skf_state *states) {
  return journal_row(&((particles *)user)->keep, t, states);
}
static skf_status keep_contact(void *user, const skf_contact *c) {
  return journal_contact(&((particles *)user)->keep, c);
}

/* Goes on from checkpoint to checkpoint; *ended as skf_runner_fly says. */
static int fly_on(particles *s, skf_runner *runner, const skf_run_sink *sink, skf_status *ended,
                  skf_run_failure *where) {
  const skf_progress progress = {watch, s};
  for (;;) {
    team_begin(s->crew, wants_stop, s);
    *ended = skf_runner_fly(runner, sink, &progress, where);
    team_end(s->crew);
    if (!s->keep.path || *ended == SKF_ERR_IO || team_lost(s->crew)) return CLI_DONE;
    bool asked = team_agree(s->crew, cli_interrupted()) != 0;
    int status = checkpoint_save(&s->keep, runner);
    if (status != CLI_DONE || *ended != SKF_ERR_CANCELLED || asked) return status;
  }
}

/* The run itself: made, or found in a checkpoint. *over: there is nothing left to do. */
static int start(particles *s, const skf_run *run, skf_runner **runner, bool *over, skf_status *ended,
                 skf_run_failure *where) {
  *over = false;
  *ended = skf_runner_new(s->world, run, runner, where);
  return *ended || !s->keep.path ? CLI_DONE : checkpoint_start(&s->keep, *runner, over);
}

/* From the journal to the outputs. */
static skf_status write_kept(particles *s) {
  return journal_replay(&s->keep, &(skf_run_sink){run_outputs_row, run_outputs_contact, &s->out});
}

/* The part of another process than the first one. */
static int leave_outputs(particles *s, skf_status ended, int status) {
  if (s->out.status != CLI_DONE) ended = SKF_ERR_IO;
  int closed = run_outputs_close(&s->out, s->out.sum.rows > 0 && ended != SKF_ERR_IO);
  return status != CLI_DONE ? status : closed;
}

/* The first process's. */
static int finish(particles *s, skf_status ended, const skf_run_failure *where) {
  const skf_scene *scene = s->scene;
  if (s->out.status != CLI_DONE) ended = SKF_ERR_IO; /* whatever followed */
  int status = ended ? complain(s, ended, where) : CLI_DONE;
  bool keep = s->out.sum.rows > 0 && ended != SKF_ERR_IO;
  int closed = run_outputs_close(&s->out, keep);
  if (s->out.status != CLI_DONE) status = s->out.status;
  if (s->keep.path && status == CLI_DONE && closed == CLI_DONE) status = checkpoint_complete(&s->keep);
  if (s->keep.path && ended == SKF_ERR_CANCELLED) cli_say("skelfield: to go on: --resume %s", s->keep.path);
  if (keep && closed == CLI_DONE && !team_lost(s->crew))
    run_summary_tell(&s->out.sum, scene, s->reports, cli_given(s->c, "json"));
  return status != CLI_DONE ? status : closed;
}

static int fly(particles *s) {
  const skf_scene *scene = s->scene;
  const skf_simulation *sim = &scene->simulation;
  skf_run run = {scene->particle_count,
                 s->starts,
                 sim->t_end,
                 sim->output_every,
                 {sim->integrator, sim->tolerance, 0, sim->contact, sim->restitution, sim->friction, sim->search,
                  s->out.near.path != NULL, sim->step},
                 &s->crew->link,
                 s->gm,
                 sim->softening};
  skf_run_sink direct = {run_outputs_row, run_outputs_contact, &s->out}, journal = {keep_row, keep_contact, s};
  skf_run_failure where = {0, 0};
  skf_runner *runner = NULL;
  skf_status ended;
  bool over;
  s->bar = cli_progress("simulate");
  int status = start(s, &run, &runner, &over, &ended, &where);
  if (status == CLI_DONE && over) cli_say("%s: the run is complete, its outputs are written", s->keep.path);
  if (status == CLI_DONE && !over && !ended) {
    if (!s->keep.path) status = run_outputs_open(&s->out, s->crew->size > 1 ? s->crew : NULL);
    direct.own = s->out.table.crew != NULL;
    if (status == CLI_DONE) status = fly_on(s, runner, s->keep.path ? &journal : &direct, &ended, &where);
    if (status == CLI_DONE) skf_runner_reports(runner, s->reports); /* or a process is lost */
    if (status == CLI_DONE && s->out.near.path) skf_runner_approaches(runner, s->out.near.of);
  }
  skf_runner_free(runner);
  cli_progress_end();
  if (!team_leads(s->crew)) return leave_outputs(s, ended, status);
  if (status == CLI_DONE && !over && s->keep.journal && ended != SKF_ERR_IO) {
    status = run_outputs_open(&s->out, NULL);
    skf_status written = status == CLI_DONE ? write_kept(s) : SKF_OK;
    if (written) ended = SKF_ERR_IO;
  }
  return status != CLI_DONE || over ? status : finish(s, ended, &where);
}

int run_particles(const cli *c, const skf_scene *scene, team *crew) {
  particles s = {.c = c, .scene = scene, .scene_path = cli_operand(c, 0), .crew = crew};
  int status = ready(&s);
  status = team_meet(crew, status, status == CLI_DONE && crew->size > 1 ? identity(&s) + skf_isa_pick() : 0);
  if (status == CLI_DONE) status = fly(&s);
  run_outputs_free(&s.out);
  checkpoint_close(&s.keep);
  skf_world_free(s.world);
  free(s.starts);
  free(s.reports);
  free(s.gm);
  return status;
}
