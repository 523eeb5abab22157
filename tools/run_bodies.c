/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run_bodies.h"
#include "same_shape.h"
#include "checkpoint.h"
#include "core/vec3.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MASS_TOLERANCE 1e-7 /* of the solids' volumes, centers and inertias */

typedef struct bodies {
  const cli *c;
  const skf_scene *scene;
  skf_swarm *swarm;
  cli_out rows, hits;
  bool log;
  skf_rigid_state *states;
  size_t hit_count;
  double still;    /* row from which nothing moves */
  double energy;   /* at the start */
  uint64_t next;   /* row */
  team alone;      /* this process */
  checkpoint keep; /* where rows and hits go first, if kept */
} bodies;

bool bodies_move(const skf_scene *scene) {
  size_t i = 0;
  while (i < scene->body_count && !scene->bodies[i].moves) i++;
  return i < scene->body_count;
}

static int check(const cli *c, const skf_scene *scene) {
  const char *path = cli_operand(c, 0), *hits = cli_value(c, "contacts");
  if (!scene->simulation.given)
    return cli_fail(CLI_BAD, "%s:1: no simulation, expected one with t_end and output_every", path);
  if (scene->particle_count)
    return cli_fail(CLI_BAD, "%s: particles among bodies that move, expected either of them", path);
  static const char *const maps[] = {"contact-map", "contact-bins", "map-body", "map-step", "map-quantity"};
  for (size_t i = 0; i < sizeof maps / sizeof *maps; i++)
    if (cli_given(c, maps[i])) return cli_fail(CLI_BAD, "%s: bodies move, expected no --%s", path, maps[i]);
  if (cli_given(c, "output") || cli_given(c, "ground-track") || cli_given(c, "json") || cli_given(c, "invariants") ||
      cli_given(c, "frame") || cli_given(c, "approach"))
    return cli_fail(CLI_BAD, "%s: bodies that move, expected --bodies and --contacts alone", path);
  for (size_t i = 0; i < scene->force_count; i++)
    if (scene->forces[i].type != SKF_FORCE_PUSH)
      return cli_fail(CLI_BAD, "%s: drag among bodies that move, expected no other force than push", path);
  for (size_t i = 0; i < scene->body_count; i++)
    if (scene->bodies[i].spin.rate != 0)
      return cli_fail(CLI_BAD, "%s:%ld: body '%s' has a spin among bodies that move, expected motion instead", path,
                      scene->bodies[i].line, scene->bodies[i].name);
  if (scene->simulation.turning) return cli_fail(CLI_BAD, "%s: bodies move, expected frame: inertial", path);
  if (hits && strcmp(hits, "-") == 0) return cli_fail(CLI_BAD, "--contacts needs a file name here");
  return CLI_DONE;
}

static double mass_of(const skf_body *b) {
  double sum = 0;
  for (size_t i = 0; i < b->element_count; i++) sum += b->elements[i].strength * skf_element_measure(b->elements + i);
  return b->rho * sum;
}

/* Those of a body of the same shape where there is one before it: it takes seconds. */
static skf_status solve_mass(const skf_scene *scene, size_t i, const skf_rigid_body *all, skf_mass *out) {
  const skf_body *b = scene->bodies + i;
  for (size_t k = 0; k < i; k++)
    if (scene->bodies[k].moves && same_shape(scene->bodies + k, b, &all[k].solid, out)) return SKF_OK;
  return skf_mass_of(b->field, b->iso, MASS_TOLERANCE, out);
}

static int set(const cli *c, const skf_scene *scene, size_t i, skf_rigid_body *all) {
  const skf_body *b = scene->bodies + i;
  skf_rigid_body *out = all + i;
  const char *path = cli_operand(c, 0);
  *out = (skf_rigid_body){.field = b->field, .iso = b->iso, .density = b->rho, .start = {.q = {1, 0, 0, 0}}};
  if (!b->moves) return CLI_DONE;
  skf_status s = solve_mass(scene, i, all, &out->solid);
  if (s == SKF_ERR_EMPTY || s == SKF_ERR_UNBOUNDED || s == SKF_ERR_UNSUPPORTED)
    return cli_fail(CLI_BAD, "%s:%ld: body '%s' moves, expected a bounded surface with something inside", path, b->line,
                    b->name);
  if (s) return cli_fail_status(s, "simulate");
  out->mass = mass_of(b);
  if (!(out->mass > 0) || !isfinite(out->mass))
    return cli_fail(CLI_BAD, "%s:%ld: body '%s' moves with mass %g, expected a mass above 0", path, b->line, b->name,
                    out->mass);
  out->start.position = out->solid.center;
  out->start.velocity = b->velocity, out->start.angular_velocity = b->angular_velocity;
  return CLI_DONE;
}

static int prepare(bodies *s) {
  const skf_scene *scene = s->scene;
  const skf_simulation *sim = &scene->simulation;
  skf_rigid_body *all = calloc(scene->body_count, sizeof *all);
  int status = all ? CLI_DONE : cli_fail(CLI_FAILED, "out of memory");
  for (size_t i = 0; i < scene->body_count && status == CLI_DONE; i++) status = set(s->c, scene, i, all);
  skf_rigid_options o = {.G = scene->G,
                         .tolerance = sim->tolerance,
                         .restitution = sim->restitution,
                         .friction = sim->friction,
                         .rolling = sim->rolling};
  for (size_t i = 0; i < scene->force_count; i++) o.gravity = v3_add(o.gravity, scene->forces[i].push);
  if (status == CLI_DONE) {
    skf_status bad = skf_swarm_new(all, scene->body_count, &o, &s->swarm);
    if (bad == SKF_ERR_UNSUPPORTED)
      status = cli_fail(CLI_BAD, "%s: a solid, a plane or a user's kernel in a body that moves, expected none",
                        cli_operand(s->c, 0));
    else if (bad)
      status = cli_fail_status(bad, "simulate");
  }
  free(all);
  return status;
}

static void put(FILE *f, const double *x, int n) {
  for (int k = 0; k < n; k++) fputc(',', f), cli_put(f, x[k]);
}

static void write_row(const bodies *s, double t, const skf_rigid_state *states) {
  FILE *f = s->rows.file;
  for (size_t i = 0; i < s->scene->body_count; i++) {
    const skf_rigid_state *b = states + i;
    if (!s->scene->bodies[i].moves) continue;
    cli_put(f, t);
    fprintf(f, ",%s", s->scene->bodies[i].name);
    put(f, &b->position.x, 3), put(f, b->q, 4), put(f, &b->velocity.x, 3), put(f, &b->angular_velocity.x, 3);
    fputc('\n', f);
  }
}

static void write_hit(const bodies *s, const skf_rigid_hit *h) {
  FILE *f = s->hits.file;
  if (!s->log) return;
  cli_put(f, h->t);
  fprintf(f, ",%s,%s", s->scene->bodies[h->a].name, s->scene->bodies[h->b].name);
  put(f, &h->at.x, 3), put(f, &h->normal.x, 3), put(f, &h->impulse.x, 3), put(f, &h->closing, 1);
  fputc('\n', f);
}

static skf_status row(bodies *s, double t) {
  size_t n = s->scene->body_count;
  for (size_t i = 0; i < n; i++) s->states[i] = skf_swarm_state(s->swarm, i);
  if (!s->keep.path) return write_row(s, t, s->states), SKF_OK;
  skf_status bad = journal_put(&s->keep, 'b', &t, sizeof t);
  for (size_t i = 0; i < n && !bad; i++) bad = journal_put(&s->keep, 's', s->states + i, sizeof *s->states);
  return bad;
}

static skf_status take_hit(void *user, const skf_rigid_hit *h) {
  bodies *s = user;
  s->hit_count++;
  if (s->keep.path) return journal_put(&s->keep, 'h', h, sizeof *h);
  if (cli_interrupted()) return SKF_ERR_CANCELLED;
  return write_hit(s, h), SKF_OK;
}

/* ---- Checkpoints ---- */

typedef struct record {
  uint64_t next, hits;
  double still, energy;
} record;

static skf_status save(const void *run, skf_status (*write)(void *, const void *, size_t), void *user) {
  const bodies *s = run;
  record r = {s->next, s->hit_count, s->still, s->energy};
  skf_status bad = write(user, &r, sizeof r);
  return bad ? bad : skf_swarm_save(s->swarm, write, user);
}

static skf_status load(void *run, skf_status (*read)(void *, void *, size_t), void *user) {
  bodies *s = run;
  record r;
  skf_status bad = read(user, &r, sizeof r);
  if (bad) return bad;
  s->next = r.next, s->hit_count = (size_t)r.hits, s->still = r.still, s->energy = r.energy;
  return skf_swarm_load(s->swarm, read, user);
}

static const checkpoint_kind kind = {save, load};

/* Begins, or goes on from a checkpoint; *over: there is nothing left to do. */
static int begin(bodies *s, bool *over) {
  skf_rigid_sums first = skf_swarm_sums(s->swarm);
  *over = false;
  s->energy = first.kinetic + first.potential;
  if (!s->keep.path) return CLI_DONE;
  s->keep.identity = checkpoint_identity(s->scene, cli_operand(s->c, 0), NULL, NULL);
  return checkpoint_start(&s->keep, s, over);
}

/* From the journal to the outputs. */
static skf_status write_kept(bodies *s) {
  FILE *f = s->keep.journal;
  if (fflush(f) || fseeko(f, 0, SEEK_SET)) return SKF_ERR_IO;
  for (int what; (what = getc(f)) != EOF;) {
    double t;
    skf_rigid_hit hit;
    bool good = what == 'h' ? fread(&hit, sizeof hit, 1, f) == 1 : what == 'b' && fread(&t, sizeof t, 1, f) == 1;
    for (size_t i = 0; i < s->scene->body_count && good && what == 'b'; i++)
      good = getc(f) == 's' && fread(s->states + i, sizeof *s->states, 1, f) == 1;
    if (!good) return SKF_ERR_IO;
    if (what == 'h') write_hit(s, &hit);
    if (what == 'b') write_row(s, t, s->states);
  }
  return SKF_OK;
}

/* ---- The run ---- */

static double time_of(const skf_simulation *sim, uint64_t row) {
  double t = (double)row * sim->output_every;
  return t > sim->t_end * (1 - 4e-16) ? sim->t_end : t; /* 4e-16: the rounding of the product */
}

static skf_status go_on(bodies *s) {
  const skf_simulation *sim = &s->scene->simulation;
  skf_progress progress = cli_progress("simulate");
  skf_status bad = SKF_OK;
  for (bool end = s->next > 0 && time_of(sim, s->next - 1) >= sim->t_end; !end && !bad;) {
    double t = time_of(sim, s->next);
    bad = skf_swarm_run(s->swarm, t, take_hit, s);
    if (!bad) bad = row(s, t);
    if (bad) break;
    s->next++, end = t >= sim->t_end;
    if (skf_swarm_is_still(s->swarm)) s->still = fmin(s->still, t);
    bool stop =
        cli_interrupted() || (progress.report && progress.report(progress.user, sim->t_end > 0 ? t / sim->t_end : 1));
    if (stop && !end) bad = SKF_ERR_CANCELLED;
    if (s->keep.path && !end && (bad || checkpoint_due(&s->keep)) && checkpoint_save(&s->keep, s) != CLI_DONE)
      bad = SKF_ERR_IO;
  }
  cli_progress_end();
  return bad;
}

static int tell(const bodies *s, skf_status bad) {
  skf_rigid_sums last = skf_swarm_sums(s->swarm);
  double e = last.kinetic + last.potential, t = s->next ? time_of(&s->scene->simulation, s->next - 1) : 0;
  cli_say("%zu hit%s to t = %.9g; energy %.9g at the start, %.9g at the end", s->hit_count,
          s->hit_count == 1 ? "" : "s", t, s->energy, e);
  if (s->still < INFINITY) cli_say("all bodies are at rest from t = %.9g on, or before", s->still);
  if (bad == SKF_ERR_CANCELLED && s->keep.path) cli_say("skelfield: to go on: --resume %s", s->keep.path);
  if (bad == SKF_ERR_CANCELLED) return cli_fail(CLI_FAILED, "interrupted after t = %.9g, rows before are written", t);
  if (bad == SKF_ERR_CONVERGENCE)
    return cli_fail(CLI_FAILED, "a force or contacts that no step can follow, at t = %.17g, rows before are written",
                    skf_swarm_time(s->swarm));
  return bad ? cli_fail_status(bad, "simulate") : CLI_DONE;
}

static int open_outputs(bodies *s) {
  const char *hits = cli_value(s->c, "contacts");
  int status = hits ? cli_out_open(&s->hits, hits) : CLI_DONE;
  if (status != CLI_DONE) return status;
  s->log = hits != NULL;
  status = cli_out_open(&s->rows, cli_value(s->c, "bodies"));
  if (status != CLI_DONE) {
    if (s->log) cli_out_abort(&s->hits);
    return status;
  }
  fputs("t,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz\n", s->rows.file);
  if (s->log) fputs("t,body,other,x,y,z,nx,ny,nz,jx,jy,jz,closing\n", s->hits.file);
  return CLI_DONE;
}

static int fly(bodies *s) {
  bool over;
  int status = begin(s, &over);
  if (status == CLI_DONE && over) cli_say("%s: the run is complete, its outputs are written", s->keep.path);
  if (status != CLI_DONE || over) return status;
  if (!s->keep.path && (status = open_outputs(s)) != CLI_DONE) return status;
  skf_status bad = go_on(s);
  if (s->keep.path) {
    if (bad == SKF_ERR_IO) return CLI_FAILED;
    if ((status = open_outputs(s)) != CLI_DONE) return status;
    if (write_kept(s)) bad = SKF_ERR_IO;
  }
  status = tell(s, bad);
  int rows = cli_out_commit(&s->rows), log = s->log ? cli_out_commit(&s->hits) : CLI_DONE;
  if (status == CLI_DONE) status = rows != CLI_DONE ? rows : log;
  return s->keep.path && status == CLI_DONE ? checkpoint_complete(&s->keep) : status;
}

int run_bodies(const cli *c, const skf_scene *scene) {
  bodies s = {.c = c, .scene = scene, .still = INFINITY, .alone = {.size = 1}};
  s.keep = (checkpoint){.kind = &kind, .crew = &s.alone};
  int status = check(c, scene);
  if (status == CLI_DONE) status = checkpoint_options(&s.keep, c);
  if (status == CLI_DONE) status = prepare(&s);
  s.states = calloc(scene->body_count, sizeof *s.states);
  if (status == CLI_DONE && !s.states) status = cli_fail(CLI_FAILED, "out of memory");
  if (status == CLI_DONE) status = fly(&s);
  checkpoint_close(&s.keep);
  free(s.states);
  skf_swarm_free(s.swarm);
  return status;
}
