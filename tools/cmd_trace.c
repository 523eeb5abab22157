/* SPDX-License-Identifier: GPL-3.0-or-later */
/* skelfield trace: rays against the bodies' surfaces. */
#include "cli.h"
#include <stdlib.h>

enum { BATCH = 2048 }; /* rays between two looks at the progress */

typedef struct crossing {
  skf_hit hit;
  size_t body;
} crossing;

/* The crossings of one ray. */
typedef struct crossings {
  size_t n;
  crossing *list;
  skf_status status;
  skf_ray_report report;
} crossings;

typedef struct trace {
  const skf_scene *scene;
  skf_tracer **tracers; /* one a body */
  const double *rows;   /* ox, oy, oz, dx, dy, dz */
  size_t n;
  bool first;
  skf_ray_report report;
} trace;

static int by_t(const void *a, const void *b) {
  const crossing *x = a, *y = b;
  if (x->hit.t != y->hit.t) return x->hit.t < y->hit.t ? -1 : 1;
  return x->body < y->body ? -1 : x->body > y->body;
}

/* Adds all crossings with one body. */
static skf_status add_all(const trace *t, const skf_ray *ray, size_t body, crossings *c) {
  enum { FEW = 16 };
  skf_hit few[FEW], *hits = few;
  size_t count;
  skf_status s = skf_tracer_all(t->tracers[body], ray, FEW, few, &count, &c->report);
  if (s || count == 0) return s;
  crossing *more = realloc(c->list, (c->n + count) * sizeof *more);
  if (!more) return SKF_ERR_NOMEM;
  c->list = more;
  if (count > FEW) {
    hits = malloc(count * sizeof *hits);
    if (!hits) return SKF_ERR_NOMEM;
    s = skf_tracer_all(t->tracers[body], ray, count, hits, &count, NULL);
  }
  for (size_t i = 0; i < count && !s; i++) c->list[c->n++] = (crossing){hits[i], body};
  if (hits != few) free(hits);
  return s;
}

/* Keeps the nearest first crossing over the bodies; what is behind it need not be looked at. */
static skf_status add_first(const trace *t, skf_ray *ray, size_t body, crossings *c) {
  crossing x = {.body = body};
  bool found;
  skf_status s = skf_tracer_first(t->tracers[body], ray, &x.hit, &found, &c->report);
  if (s || !found) return s;
  if (!c->list && !(c->list = malloc(sizeof *c->list))) return SKF_ERR_NOMEM;
  if (c->n == 0 || by_t(&x, c->list) < 0) c->list[0] = x;
  c->n = 1;
  ray->t_max = c->list[0].hit.t;
  return SKF_OK;
}

static void trace_ray(const trace *t, const double *row, crossings *c) {
  skf_ray ray = {{row[0], row[1], row[2]}, {row[3], row[4], row[5]}, 0, __builtin_inf()};
  *c = (crossings){.status = SKF_OK};
  for (size_t b = 0; b < t->scene->body_count && c->status == SKF_OK; b++)
    c->status = t->first ? add_first(t, &ray, b, c) : add_all(t, &ray, b, c);
  if (c->n > 1) qsort(c->list, c->n, sizeof *c->list, by_t);
}

static void write_hits(FILE *f, const skf_scene *scene, size_t ray, const crossings *c) {
  for (size_t i = 0; i < c->n; i++) {
    const skf_hit *h = &c->list[i].hit;
    double v[7] = {h->t, h->at.x, h->at.y, h->at.z, h->normal.x, h->normal.y, h->normal.z};
    fprintf(f, "%zu", ray);
    for (int k = 0; k < 7; k++) {
      putc(',', f);
      cli_put(f, v[k]);
    }
    fprintf(f, ",%s\n", scene->bodies[c->list[i].body].name);
  }
}

/* One batch: traced in parallel, written in order. */
static int trace_batch(trace *t, size_t from, size_t n, crossings *batch, FILE *f) {
  skf_status status = SKF_OK;
#pragma omp parallel for schedule(dynamic, 16) if (n > 16)
  for (size_t i = 0; i < n; i++) trace_ray(t, t->rows + 6 * (from + i), batch + i);
  for (size_t i = 0; i < n; i++) {
    if (batch[i].status) status = batch[i].status;
    if (!status) write_hits(f, t->scene, from + i, batch + i);
    t->report.cells += batch[i].report.cells, t->report.subdivisions += batch[i].report.subdivisions;
    t->report.evaluations += batch[i].report.evaluations, t->report.grazing += batch[i].report.grazing;
    free(batch[i].list);
  }
  return status ? cli_fail_status(status, "trace") : CLI_DONE;
}

static int trace_all(trace *t, FILE *f) {
  static crossings batch[BATCH];
  skf_progress progress = cli_progress("trace");
  fprintf(f, "ray,t,x,y,z,nx,ny,nz,body\n");
  for (size_t from = 0; from < t->n && !ferror(f); from += BATCH) {
    size_t n = t->n - from < BATCH ? t->n - from : BATCH;
    int status = trace_batch(t, from, n, batch, f);
    if (status != CLI_DONE) return status;
    if (progress.report(progress.user, (double)(from + n) / (double)t->n))
      return cli_fail(CLI_FAILED, "interrupted, nothing written");
  }
  cli_progress_end();
  return CLI_DONE;
}

static const char *check_ray(const double *row) {
  bool zero = row[3] == 0 && row[4] == 0 && row[5] == 0;
  return zero ? "the direction is zero, expected any other vector" : NULL;
}

static int make_tracers(trace *t) {
  t->tracers = calloc(t->scene->body_count + 1, sizeof(skf_tracer *));
  if (!t->tracers) return cli_fail(CLI_FAILED, "out of memory");
  for (size_t b = 0; b < t->scene->body_count; b++) {
    skf_status s = skf_tracer_new(t->scene->bodies[b].field, t->scene->bodies[b].iso, t->tracers + b);
    if (s) return cli_fail_status(s, t->scene->bodies[b].name);
  }
  return CLI_DONE;
}

static void say_report(const skf_ray_report *r, bool wanted) {
  if (wanted)
    cli_say("trace: %zu cells, %zu subdivisions, %zu evaluations, %zu grazing", r->cells, r->subdivisions,
            r->evaluations, r->grazing);
  else if (r->grazing)
    cli_say("trace: %zu places touch a surface too closely to decide whether they are crossed", r->grazing);
}

static int run_with(const cli *c, trace *t) {
  double *rows;
  int status = cli_csv(cli_operand(c, 1), "ox,oy,oz,dx,dy,dz", 6, check_ray, &rows, &t->n);
  if (status != CLI_DONE) return status;
  t->rows = rows;
  cli_out out = {0};
  status = make_tracers(t);
  if (status == CLI_DONE) status = cli_out_open(&out, cli_value(c, "output"));
  if (status == CLI_DONE) {
    status = trace_all(t, out.file);
    if (status == CLI_DONE)
      status = cli_out_commit(&out);
    else
      cli_out_abort(&out);
  }
  if (status == CLI_DONE) say_report(&t->report, cli_given(c, "report"));
  free(rows);
  return status;
}

static int run(cli *c) {
  skf_scene *scene;
  int status = cli_scene(c, cli_operand(c, 0), &scene);
  if (status != CLI_DONE) return status;
  trace t = {.scene = scene, .first = cli_given(c, "first")};
  status = run_with(c, &t);
  for (size_t b = 0; t.tracers && b < scene->body_count; b++) skf_tracer_free(t.tracers[b]);
  free(t.tracers);
  skf_scene_free(scene);
  return status;
}

static const cli_option options[] = {
    {'o', "output", "FILE", "where the hits go (default: stdout)"},
    {'f', "first", NULL, "only the first hit of each ray"},
    {'r', "report", NULL, "say on stderr what the certificates cost and what they left undecided"},
};

static const char notes[] =
    "in:  CSV with the header ox,oy,oz,dx,dy,dz: origins and directions of any length, in the inertial frame with the\n"
    "     bodies as they stand at t = 0; - reads stdin\n"
    "out: ray,t,x,y,z,nx,ny,nz,body: every crossing with t >= 0 along the normalised direction, by ray (from 0), then "
    "t;\n"
    "     the normal points out of the body. Each body is crossed on its own surface F = iso. A surface that is only\n"
    "     touched is not crossed, and a ray that starts on a surface does not hit its own start.\n"
    "     No crossing is missed: where rounding leaves a doubt, it is counted and said on stderr (grazing).\n"
    "example: skelfield trace data/donut.yaml rays.csv -o hits.csv";

static const char *const writes[] = {"output", NULL};

const cli_command cmd_trace = {
    .name = "trace",
    .operands = "SCENE RAYS.csv",
    .summary = "where rays cross the bodies' surfaces",
    .operand_count = 2,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .notes = notes,
    .run = run,
    .writes = writes,
};
