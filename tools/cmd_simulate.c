/* SPDX-License-Identifier: GPL-3.0-or-later */
/* skelfield simulate: particles in the gravity of a scene's bodies. */
#include "checkpoint.h"
#include "contact_map.h"
#include "launch.h"
#include "run_bodies.h"
#include "run_summary.h"
#include "simd/isa.h"
#include "team.h"
#include "trajectory.h"
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Everything that a run holds. */
typedef struct simulate {
  const cli *c;
  team crew; /* processes that fly shares of the particles; the first one has the outputs */
  trajectory_table table;
  skf_world *world;
  skf_state *starts;
  skf_flight_report *reports;
  skf_geo *geo; /* of the ground track */
  size_t track_body;
  double *gm; /* G times the mass of each particle, where some have one */
  run_place *places;
  skf_quantities *quantities; /* where --invariants asks for them */
  size_t frame;               /* rows and contacts are in the frame of this body, or SIZE_MAX: inertial */
  skf_state *seen;            /* there */
  const trajectory_writer *writer;
  void *trajectory;
  cli_out contacts;
  bool log;
  contact_map map; /* where they lie on a body */
  int output_status;
  run_summary sum;
  checkpoint keep;
  skf_progress bar;
} simulate;

static double degrees(double radians) { return radians * (180 / 3.14159265358979323846); }

static skf_status take_row(void *user, double t, const skf_state *states) {
  simulate *s = user;
  for (size_t i = 0; s->geo && i < s->table.scene->particle_count; i++) {
    skf_place p;
    if (skf_geo_place(s->geo, skf_world_to_body(s->world, s->track_body, t, states[i].position), &p))
      p = (skf_place){NAN, NAN, NAN};
    s->places[i] = (run_place){degrees(p.latitude), degrees(p.longitude), p.height};
  }
  for (size_t i = 0; s->quantities && i < s->table.scene->particle_count; i++)
    s->quantities[i] = skf_world_quantities(s->world, states + i);
  for (size_t i = 0; s->seen && i < s->table.scene->particle_count; i++)
    s->seen[i] = skf_world_state_to_body(s->world, s->frame, states + i);
  s->sum.rows++;
  s->sum.t = t;
  s->output_status =
      s->writer->row(s->trajectory, t, s->seen ? s->seen : states, &(run_more){s->places, s->quantities});
  return s->output_status == CLI_DONE ? SKF_OK : SKF_ERR_IO;
}

static skf_contact seen_contact(const simulate *s, const skf_contact *c) {
  skf_contact in = *c;
  skf_state before = {c->t, c->position, c->before}, after = {c->t, c->position, c->after};
  before = skf_world_state_to_body(s->world, s->frame, &before);
  in.position = before.position, in.before = before.velocity;
  in.after = skf_world_state_to_body(s->world, s->frame, &after).velocity;
  in.normal = skf_world_direction_to_body(s->world, s->frame, c->t, c->normal);
  return in;
}

static skf_status take_contact(void *user, const skf_contact *c) {
  simulate *s = user;
  skf_contact in;
  if (contact_map_wanted(&s->map)) contact_map_add(&s->map, c);
  if (s->seen) in = seen_contact(s, c), c = &in;
  s->sum.contacts++;
  if (s->log) contact_row(s->contacts.file, s->table.scene, c);
  if (s->writer->contact) s->output_status = s->writer->contact(s->trajectory, c);
  return s->output_status == CLI_DONE ? SKF_OK : SKF_ERR_IO;
}

/* A start inside a body is legal: the particle flies until it leaves. Some are named, the others counted. */
static void warn_inside(const simulate *s) {
  const skf_scene *scene = s->table.scene;
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

static bool to_stdout(const char *path) { return !path || strcmp(path, "-") == 0; }

static int check(const cli *c, const skf_scene *scene) {
  const char *path = cli_operand(c, 0), *contacts = cli_value(c, "contacts"), *out = cli_value(c, "output");
  if (cli_given(c, "bodies")) return cli_fail(CLI_BAD, "%s: no body moves, expected motion for --bodies", path);
  if (!scene->simulation.given)
    return cli_fail(CLI_BAD, "%s: no simulation, expected one with t_end and output_every", path);
  if (scene->particle_count == 0) return cli_fail(CLI_BAD, "%s: no particles, expected at least one", path);
  if (cli_given(c, "json") && to_stdout(out)) return cli_fail(CLI_BAD, "--json needs -o FILE: both want stdout");
  if (contacts && to_stdout(contacts) && (to_stdout(out) || cli_given(c, "json")))
    return cli_fail(CLI_BAD, "--contacts - needs stdout for itself, expected a file name");
  if (contacts && out && !to_stdout(out) && cli_same_file(out, contacts))
    return cli_fail(CLI_BAD, "-o and --contacts name the same file");
  return CLI_DONE;
}

/* The frame of rows and contacts: that of the option, or the scene's. */
static int choose_frame(simulate *s) {
  const skf_scene *scene = s->table.scene;
  const char *frame = cli_value(s->c, "frame");
  s->table.turning = frame ? strcmp(frame, "body") == 0 : scene->simulation.turning;
  if (frame && !s->table.turning && strcmp(frame, "inertial") != 0)
    return cli_fail(CLI_BAD, "--frame %s, expected inertial or body", frame);
  if (!s->table.turning) return CLI_DONE;
  if (!skf_scene_turning_body(scene, &s->frame))
    return cli_fail(CLI_BAD, "--frame body, but the bodies of %s spin differently, expected inertial",
                    s->table.scene_path);
  if (s->frame == SIZE_MAX) return CLI_DONE; /* nothing turns: its frame is the inertial one */
  s->seen = calloc(scene->particle_count, sizeof *s->seen);
  return s->seen ? CLI_DONE : cli_fail(CLI_FAILED, "out of memory");
}

static int prepare(simulate *s) {
  const skf_scene *scene = s->table.scene;
  const char *body = cli_value(s->c, "ground-track");
  int status = choose_frame(s);
  if (status == CLI_DONE) status = launch_world(scene, &s->world);
  if (status == CLI_DONE) status = launch_starts(scene, s->table.scene_path, s->world, &s->starts);
  if (status == CLI_DONE && body) {
    int b = cli_body(scene, body);
    if (b < 0) return CLI_BAD;
    s->track_body = (size_t)b;
    status = launch_geo(scene->bodies + b, &s->geo);
    s->places = calloc(scene->particle_count, sizeof *s->places);
    if (!s->places) return cli_fail(CLI_FAILED, "out of memory");
  }
  if (status == CLI_DONE) status = contact_map_new(&s->map, s->c, scene, s->world);
  s->table.invariants = cli_given(s->c, "invariants");
  if (s->table.invariants) s->quantities = calloc(scene->particle_count, sizeof *s->quantities);
  s->reports = calloc(scene->particle_count, sizeof *s->reports);
  return s->reports && (s->quantities || !s->table.invariants) ? status : cli_fail(CLI_FAILED, "out of memory");
}

static int open_own_outputs(simulate *s) {
  const char *path = cli_value(s->c, "output"), *contacts = cli_value(s->c, "contacts");
  int status = trajectory_writer_for(path, &s->writer);
  if (status != CLI_DONE) return status;
  s->table.track = s->geo != NULL;
  if (contacts) status = cli_out_open(&s->contacts, contacts); /* first: opening the other may print its header */
  if (status != CLI_DONE) return status;
  s->log = contacts != NULL;
  if (s->log) contact_header(s->contacts.file);
  status = contact_map_open(&s->map);
  if (status != CLI_DONE) return status;
  return s->writer->open(&s->trajectory, path, &s->table);
}

static int open_outputs(simulate *s) {
  return team_agree(&s->crew, team_leads(&s->crew) ? open_own_outputs(s) : CLI_DONE);
}

/* Commits what is complete: all of it, or the rows before a failure or an interrupt. */
static int close_outputs(simulate *s, bool keep) {
  int status = CLI_DONE, log = CLI_DONE;
  if (s->trajectory && keep) status = s->writer->commit(s->trajectory);
  if (s->trajectory && !keep) s->writer->abort(s->trajectory);
  keep = keep && status == CLI_DONE;
  if (s->log && keep) log = cli_out_commit(&s->contacts);
  if (s->log && !keep) cli_out_abort(&s->contacts);
  int map = contact_map_close(&s->map, keep && log == CLI_DONE);
  return status != CLI_DONE ? status : log != CLI_DONE ? log : map;
}

/* Says how a run ended early. */
static int complain(const simulate *s, skf_status ended, const skf_run_failure *where) {
  const skf_scene *scene = s->table.scene;
  const char *kept = s->sum.rows ? "rows before are written" : "nothing written";
  if (team_lost(&s->crew)) return cli_fail(CLI_FAILED, "a process does not answer after t = %.9g, %s", s->sum.t, kept);
  if (ended == SKF_ERR_CANCELLED) return cli_fail(CLI_FAILED, "interrupted after t = %.9g, %s", s->sum.t, kept);
  if (ended == SKF_ERR_CONVERGENCE)
    return cli_fail(CLI_FAILED, "particle '%s' meets a force that no step can follow at t = %.17g, %s",
                    scene->particles[where->particle].name, where->t, kept);
  if (ended == SKF_ERR_IO) return CLI_FAILED;
  return cli_fail_status(ended, "simulate");
}

/* Whether this process wants to stop: for an interrupt, or for the next checkpoint. */
static bool wants_stop(void *user) {
  const simulate *s = user;
  return cli_interrupted() || (team_leads(&s->crew) && checkpoint_due(&s->keep));
}

static int watch(void *user, double done) {
  const simulate *s = user;
  s->bar.report(s->bar.user, done);
  return team_poll(&s->crew, wants_stop(user));
}

static skf_status keep_row(void *user, double t, const skf_state *states) {
  return journal_row(&((simulate *)user)->keep, t, states);
}
static skf_status keep_contact(void *user, const skf_contact *c) {
  return journal_contact(&((simulate *)user)->keep, c);
}

/* Goes on from checkpoint to checkpoint; *ended as skf_runner_fly says. */
static int fly_on(simulate *s, skf_runner *runner, const skf_run_sink *sink, skf_status *ended,
                  skf_run_failure *where) {
  const skf_progress progress = {watch, s};
  for (;;) {
    team_begin(&s->crew, wants_stop, s);
    *ended = skf_runner_fly(runner, sink, &progress, where);
    team_end(&s->crew);
    if (!s->keep.path || *ended == SKF_ERR_IO || team_lost(&s->crew)) return CLI_DONE;
    bool asked = team_agree(&s->crew, cli_interrupted()) != 0;
    int status = checkpoint_save(&s->keep, runner);
    if (status != CLI_DONE || *ended != SKF_ERR_CANCELLED || asked) return status;
  }
}

/* The run itself: made, or found in a checkpoint. *over: there is nothing left to do. */
static int start(simulate *s, const skf_run *run, skf_runner **runner, bool *over, skf_status *ended,
                 skf_run_failure *where) {
  *over = false;
  *ended = skf_runner_new(s->world, run, runner, where);
  return *ended || !s->keep.path ? CLI_DONE : checkpoint_start(&s->keep, *runner, over);
}

/* From the journal to the outputs. */
static skf_status write_kept(simulate *s) {
  return journal_replay(&s->keep, &(skf_run_sink){take_row, take_contact, s});
}

/* The first process's. */
static int finish(simulate *s, skf_status ended, const skf_run_failure *where) {
  const skf_scene *scene = s->table.scene;
  int status = ended ? complain(s, ended, where) : CLI_DONE;
  bool keep = s->sum.rows > 0 && ended != SKF_ERR_IO;
  int closed = close_outputs(s, keep);
  s->trajectory = NULL, s->log = false;
  if (s->output_status != CLI_DONE) status = s->output_status;
  if (s->keep.path && status == CLI_DONE && closed == CLI_DONE) status = checkpoint_complete(&s->keep);
  if (s->keep.path && ended == SKF_ERR_CANCELLED) cli_say("skelfield: to go on: --resume %s", s->keep.path);
  if (keep && closed == CLI_DONE && !team_lost(&s->crew))
    run_summary_tell(&s->sum, scene, s->reports, cli_given(s->c, "json"));
  return status != CLI_DONE ? status : closed;
}

/* Particles with a mass attract the others. */
static int weigh(simulate *s) {
  const skf_scene *scene = s->table.scene;
  size_t massless = 0;
  while (massless < scene->particle_count && scene->particles[massless].mass == 0) massless++;
  if (massless == scene->particle_count) return CLI_DONE;
  if (s->crew.size > 1)
    return cli_fail(CLI_BAD, "%s:%ld: particle '%s' has a mass, but %d processes share the run, expected one",
                    s->table.scene_path, scene->particles[massless].line, scene->particles[massless].name,
                    s->crew.size);
  s->gm = calloc(scene->particle_count, sizeof *s->gm);
  if (!s->gm) return cli_fail(CLI_FAILED, "out of memory");
  for (size_t i = 0; i < scene->particle_count; i++) {
    s->gm[i] = scene->G * scene->particles[i].mass;
    if (!isfinite(s->gm[i]))
      return cli_fail(CLI_BAD, "%s:%ld: G times the mass of particle '%s' overflows, expected a finite number",
                      s->table.scene_path, scene->particles[i].line, scene->particles[i].name);
  }
  return CLI_DONE;
}

static int fly(simulate *s) {
  const skf_scene *scene = s->table.scene;
  const skf_simulation *sim = &scene->simulation;
  skf_run run = {scene->particle_count,
                 s->starts,
                 sim->t_end,
                 sim->output_every,
                 {sim->integrator, sim->tolerance, 0, sim->contact, sim->restitution, sim->friction, sim->search, false,
                  sim->step},
                 &s->crew.link,
                 s->gm,
                 sim->softening};
  skf_run_sink direct = {take_row, take_contact, s}, journal = {keep_row, keep_contact, s};
  skf_run_failure where = {0, 0};
  skf_runner *runner = NULL;
  skf_status ended;
  bool over;
  s->bar = cli_progress("simulate");
  int status = start(s, &run, &runner, &over, &ended, &where);
  if (status == CLI_DONE && over) cli_say("%s: the run is complete, its outputs are written", s->keep.path);
  if (status == CLI_DONE && !over && !ended) {
    if (!s->keep.path) status = open_outputs(s);
    if (status == CLI_DONE) status = fly_on(s, runner, s->keep.path ? &journal : &direct, &ended, &where);
    if (status == CLI_DONE) skf_runner_reports(runner, s->reports); /* or a process is lost */
  }
  skf_runner_free(runner);
  cli_progress_end();
  if (!team_leads(&s->crew)) return status;
  if (status == CLI_DONE && !over && s->keep.journal && ended != SKF_ERR_IO) {
    status = open_own_outputs(s);
    skf_status written = status == CLI_DONE ? write_kept(s) : SKF_OK;
    if (written) ended = SKF_ERR_IO;
  }
  return status != CLI_DONE || over ? status : finish(s, ended, &where);
}

/* What all processes must have alike, and a run that goes on with the one that was saved. */
static uint64_t identity(const simulate *s) {
  return checkpoint_identity(s->table.scene, s->table.scene_path, s->world, s->starts);
}

static int keep_checkpoints(simulate *s) {
  static const char *const outputs[] = {"output", "contacts", "contact-map", "contact-bins"};
  s->keep = (checkpoint){.kind = &checkpoint_of_runner, .crew = &s->crew, .particles = s->table.scene->particle_count};
  int status = checkpoint_options(&s->keep, s->c, outputs, 4);
  if (s->keep.path) s->keep.identity = identity(s);
  return status;
}

static int ready(simulate *s, const skf_scene *scene) {
  if (bodies_move(scene)) {
    if (s->crew.size == 1) return CLI_DONE;
    return cli_fail(CLI_BAD, "%s: bodies move, which %d processes cannot share, expected one", s->table.scene_path,
                    s->crew.size);
  }
  s->table.scene = scene;
  int status = check(s->c, scene);
  if (status == CLI_DONE) status = prepare(s);
  if (status == CLI_DONE) warn_inside(s);
  if (status == CLI_DONE) status = weigh(s);
  return status == CLI_DONE ? keep_checkpoints(s) : status;
}

static int run(cli *c) {
  skf_scene *scene = NULL;
  simulate s = {.c = c, .table = {.scene_path = cli_operand(c, 0)}};
  int status = team_join(&s.crew);
  if (status != CLI_DONE) return status;
  status = cli_scene(s.table.scene_path, &scene);
  if (status == CLI_DONE) status = ready(&s, scene);
  status = team_meet(&s.crew, status, status == CLI_DONE && s.crew.size > 1 ? identity(&s) + skf_isa_pick() : 0);
  if (status == CLI_DONE) status = s.table.scene ? fly(&s) : run_bodies(c, scene);
  close_outputs(&s, false);
  checkpoint_close(&s.keep);
  contact_map_free(&s.map);
  team_leave(&s.crew);
  skf_world_free(s.world);
  skf_geo_free(s.geo);
  free(s.starts);
  free(s.reports);
  free(s.gm);
  free(s.places);
  free(s.quantities);
  free(s.seen);
  skf_scene_free(scene);
  return status;
}

static const cli_option options[] = {
    {'o', "output", "FILE", "the trajectory, .csv or .h5 (default: CSV on stdout)"},
    {'c', "contacts", "FILE", "the contact log, CSV"},
    {'g', "ground-track", "BODY", "add lat, lon [deg] and height over this body's ellipsoid, in its turning frame"},
    {'i', "invariants", NULL, "add energy, Jacobi constant and angular momentum of each particle to each row"},
    {'f', "frame", "FRAME", "of rows and contacts: inertial, or body, which turns (default: the scene's, inertial)"},
    CONTACT_MAP_OPTIONS{'b', "bodies", "FILE", "rows of the bodies that move, CSV (default: stdout)"},
    {'k', "checkpoint", "FILE", "keep the run's state there (and rows in FILE.journal), now and then and on Ctrl-C"},
    {'s', "every-seconds", "S", "between two checkpoints (default: 60)"},
    {'r', "resume", "FILE", "go on from that checkpoint; with --checkpoint of the same name begin if there is none"},
    {'j', "json", NULL, "print the summary as JSON on stdout"},
};

const cli_command cmd_simulate = {
    "simulate",
    "SCENE",
    "fly the scene's particles, find their contacts",
    1,
    options,
    sizeof options / sizeof *options,
    "in:  a scene with particles, or bodies that have `motion`, and a simulation\n"
    "out: t,particle,x,y,z,vx,vy,vz at t = 0, output_every, ..., t_end, by time, then particle; inertial frame.\n"
    "     HDF5: t (T), position and velocity (T, N, 3), place (T, N, 3), particles, bodies, contacts, scene; "
    "attributes\n"
    "     program, version, frame, seed of each source that draws, seeded: its first particle and how many\n"
    "invariants: energy,jacobi,lx,ly,lz,l_axis (HDF5: invariants, (T, N, 6)), per unit mass, constant or not: kinetic "
    "+\n"
    "     potential energy (of bodies and pushes); that less spin . angular momentum, where all bodies spin alike; "
    "the\n"
    "     angular momentum about a point of the axis of symmetry, else of spin, else the origin; its part along the "
    "axis\n"
    "     of symmetry. nan where there is none. The summary tells those that are constant with their drift, and warns "
    "of\n"
    "     one beyond steps * tolerance + 64 eps sqrt(steps + 1) relative to kinetic + |potential| energy (momentum: "
    "to\n"
    "     |r| |v|). Of particles that attract each other it tells those of all with a mass together; the columns are "
    "those\n"
    "     of each one in the bodies' field alone\n"
    "mass: particles with one attract all others (not the bodies): a direct sum, one step for all of them, by "
    "gauss-radau,\n"
    "     softened on request (simulation: {softening}); the bodies' own fields are never softened\n"
    "frame: in that of the body that spins, velocities are relative to it; times and invariants are the same\n"
    "contacts: t,particle,body,x,y,z,nx,ny,nz,vx,vy,vz,outcome: the first point where a path enters a body, the\n"
    "     outward normal, the velocity just before, and what follows:\n"
    "     stop    stays at that point of the inertial frame with velocity 0; rows go on\n"
    "     stick   stays at that point of the body and turns with it\n"
    "     bounce  rebounds: the normal velocity relative to the turning ground times -restitution, the tangential one\n"
    "             less friction times the normal impulse\n"
    "     slide   a rebound too low to tell: slides on, until it takes off again\n"
    "     rest    the same without speed along the ground, held by friction: stays on the body\n"
    "     absorb  is gone: no rows at or after that time (HDF5: NaN)\n"
    "     pass    flies through, told at each entry\n"
    "     A particle that starts inside of a body flies freely until it leaves it.\n"
    "contact map: contacts with one body, bounces and passes too, by latitude and longitude in its own frame, spin "
    "taken\n"
    "     out: geodetic on its ellipsoid, or else those of the direction from a centre: poles on the axis of spin (or\n"
    "     along z), centre at the middle of the skeleton (there on the axis). A donut or a star has several places in\n"
    "     one direction: they share a bin. Bins are about equally large, fewer towards the poles; speed is that\n"
    "     relative to the ground, mean of the bin, nan without contacts.\n"
    "     table: lat_min,lat_max,lon_min,lon_max,count,speed, from the south, then the west [deg]\n"
    "search: certified misses no contact and invents none, up to rounding; fast takes eight samples in a step and\n"
    "     promises nothing for what is thinner\n"
    "bodies: t,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz: center of mass, attitude (a quaternion; a point p of the\n"
    "     scene is at x + R (p - x at t = 0)), velocity, angular velocity, all inertial. Bodies attract each other\n"
    "     (gravity: {G}), are pushed (forces: push), collide with restitution and friction, slide, roll and come to\n"
    "     rest on each other, gaps being 1e-9 to 1e-6 of their size, and their hits are rows of\n"
    "     t,body,other,x,y,z,nx,ny,nz,jx,jy,jz,closing: place, normal and impulse towards the other, speed of "
    "approach\n"
    "checkpoints: a resumed run ends with the same bytes as one that was not interrupted; the outputs are written "
    "when\n"
    "     it ends, from the journal. What ended, even by kill -9, loses at most what was done since the last "
    "checkpoint.\n"
    "     The scene and the program must be the same; threads and outputs may differ.\n"
    "processes: mpirun -n N skelfield simulate SCENE ... flies a share of the particles in each; the first process\n"
    "     has the outputs, whose bytes are those of one process. Started with a checkpoint, a run may go on with "
    "another\n"
    "     number. mpirun kills a run one second after Ctrl-C: --mca odls_base_sigkill_timeout 60 gives it time to end\n"
    "     in order. SKELFIELD_MPI=off in the environment: each process works by itself, on its own files.\n"
    "launch: a start on a body's ellipsoid; its speed is relative to the turning ground.\n"
    "example: skelfield simulate data/donut.yaml -o orbits.csv --contacts contacts.csv",
    run,
    true};
