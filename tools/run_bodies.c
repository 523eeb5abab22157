/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run_bodies.h"
#include "same_shape.h"
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
  size_t hit_count;
  double still; /* row from which nothing moves */
} bodies;

bool bodies_move(const skf_scene *scene) {
  size_t i = 0;
  while (i < scene->body_count && !scene->bodies[i].moves) i++;
  return i < scene->body_count;
}

static int check(const cli *c, const skf_scene *scene) {
  const char *path = cli_operand(c, 0), *rows = cli_value(c, "bodies"), *hits = cli_value(c, "contacts");
  if (!scene->simulation.given)
    return cli_fail(CLI_BAD, "%s: no simulation, expected one with t_end and output_every", path);
  if (scene->particle_count)
    return cli_fail(CLI_BAD, "%s: particles among bodies that move, expected either of them", path);
  static const char *const maps[] = {"contact-map", "contact-bins", "map-body", "map-step", "map-quantity"};
  for (size_t i = 0; i < sizeof maps / sizeof *maps; i++)
    if (cli_given(c, maps[i])) return cli_fail(CLI_BAD, "%s: bodies move, expected no --%s", path, maps[i]);
  if (cli_given(c, "checkpoint") || cli_given(c, "resume") || cli_given(c, "every-seconds"))
    return cli_fail(CLI_BAD, "%s: bodies move, expected no --checkpoint and no --resume", path);
  if (cli_given(c, "output") || cli_given(c, "ground-track") || cli_given(c, "json") || cli_given(c, "invariants") ||
      cli_given(c, "frame"))
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
  if (hits && rows && cli_same_file(hits, rows)) return cli_fail(CLI_BAD, "--bodies and --contacts name the same file");
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

static void row(const bodies *s, double t) {
  FILE *f = s->rows.file;
  for (size_t i = 0; i < s->scene->body_count; i++) {
    if (!s->scene->bodies[i].moves) continue;
    skf_rigid_state b = skf_swarm_state(s->swarm, i);
    cli_put(f, t);
    fprintf(f, ",%s", s->scene->bodies[i].name);
    put(f, &b.position.x, 3), put(f, b.q, 4), put(f, &b.velocity.x, 3), put(f, &b.angular_velocity.x, 3);
    fputc('\n', f);
  }
}

static skf_status take_hit(void *user, const skf_rigid_hit *h) {
  bodies *s = user;
  s->hit_count++;
  if (cli_interrupted()) return SKF_ERR_CANCELLED;
  if (!s->log) return SKF_OK;
  FILE *f = s->hits.file;
  cli_put(f, h->t);
  fprintf(f, ",%s,%s", s->scene->bodies[h->a].name, s->scene->bodies[h->b].name);
  put(f, &h->at.x, 3), put(f, &h->normal.x, 3), put(f, &h->impulse.x, 3), put(f, &h->closing, 1);
  fputc('\n', f);
  return SKF_OK;
}

static int fly(bodies *s) {
  const skf_simulation *sim = &s->scene->simulation;
  skf_rigid_sums first = skf_swarm_sums(s->swarm);
  skf_progress progress = cli_progress("simulate");
  skf_status bad = SKF_OK;
  double t = 0;
  fputs("t,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz\n", s->rows.file);
  if (s->log) fputs("t,body,other,x,y,z,nx,ny,nz,jx,jy,jz,closing\n", s->hits.file);
  row(s, 0);
  for (size_t k = 1; t < sim->t_end && !bad; k++) {
    double next = (double)k * sim->output_every;
    if (next > sim->t_end * (1 - 4e-16)) next = sim->t_end; /* 4e-16: the rounding of the product */
    bad = skf_swarm_run(s->swarm, next, take_hit, s);
    if (!bad) row(s, t = next);
    if (!bad && skf_swarm_is_still(s->swarm)) s->still = fmin(s->still, t);
    if (!bad && progress.report && progress.report(progress.user, t / sim->t_end)) bad = SKF_ERR_CANCELLED;
  }
  cli_progress_end();
  skf_rigid_sums last = skf_swarm_sums(s->swarm);
  double E = first.kinetic + first.potential, e = last.kinetic + last.potential;
  cli_say("%zu hit%s to t = %.9g; energy %.9g at the start, %.9g at the end", s->hit_count,
          s->hit_count == 1 ? "" : "s", t, E, e);
  if (s->still < INFINITY) cli_say("all bodies are at rest from t = %.9g on, or before", s->still);
  if (bad == SKF_ERR_CANCELLED) return cli_fail(CLI_FAILED, "interrupted after t = %.9g, rows before are written", t);
  if (bad == SKF_ERR_CONVERGENCE)
    return cli_fail(CLI_FAILED, "a force or contacts that no step can follow, at t = %.17g, rows before are written",
                    skf_swarm_time(s->swarm));
  return bad ? cli_fail_status(bad, "simulate") : CLI_DONE;
}

int run_bodies(const cli *c, const skf_scene *scene) {
  bodies s = {.c = c, .scene = scene, .still = INFINITY};
  const char *hits = cli_value(c, "contacts");
  int status = check(c, scene);
  if (status == CLI_DONE) status = prepare(&s);
  if (status == CLI_DONE && hits) status = cli_out_open(&s.hits, hits), s.log = status == CLI_DONE;
  if (status == CLI_DONE) {
    status = cli_out_open(&s.rows, cli_value(c, "bodies"));
    if (status == CLI_DONE) {
      status = fly(&s);
      int rows = cli_out_commit(&s.rows), log = s.log ? cli_out_commit(&s.hits) : CLI_DONE;
      if (status == CLI_DONE) status = rows != CLI_DONE ? rows : log;
    } else if (s.log) {
      cli_out_abort(&s.hits);
    }
  }
  skf_swarm_free(s.swarm);
  return status;
}
