/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run_approaches.h"
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static int check(const run_approaches *a, const cli *c) {
  if (strcmp(a->path, "-") == 0) return cli_fail(CLI_BAD, "--approach: expected a file name");
  for (size_t i = 0; i < a->scene->particle_count; i++)
    if (a->scene->particles[i].mass != 0)
      return cli_fail(CLI_BAD, "%s:%ld: particle '%s' has a mass, expected none for --approach", cli_operand(c, 0),
                      a->scene->particles[i].line, a->scene->particles[i].name);
  return CLI_DONE;
}

int run_approaches_new(run_approaches *a, const cli *c, const skf_scene *scene, const skf_world *world) {
  *a = (run_approaches){.path = cli_value(c, "approach"), .scene = scene, .world = world};
  int status = a->path ? check(a, c) : CLI_DONE;
  if (!a->path || status) return status;
  a->of = calloc(scene->particle_count * scene->body_count, sizeof *a->of);
  return a->of ? CLI_DONE : cli_fail(CLI_FAILED, "out of memory");
}

int run_approaches_open(run_approaches *a) {
  int status = a->path ? cli_out_open(&a->out, a->path) : CLI_DONE;
  a->open = a->path && status == CLI_DONE;
  return status;
}

static void put(FILE *f, double x) {
  putc(',', f);
  cli_put(f, x);
}

int run_approaches_close(run_approaches *a, size_t frame, bool keep) {
  if (!a->open) return CLI_DONE;
  a->open = false;
  if (!keep) return cli_out_abort(&a->out), CLI_DONE;
  FILE *f = a->out.file;
  fputs("particle,body,t,x,y,z,distance,level\n", f);
  for (size_t i = 0; i < a->scene->particle_count; i++)
    for (size_t b = 0; b < a->scene->body_count; b++) {
      const skf_approach *n = a->of + i * a->scene->body_count + b;
      skf_vec3 p = frame == SIZE_MAX ? n->position : skf_world_to_body(a->world, frame, n->t, n->position);
      const double row[] = {n->t, p.x, p.y, p.z, n->distance, n->level};
      fprintf(f, "%s,%s", a->scene->particles[i].name, a->scene->bodies[b].name);
      for (size_t k = 0; k < sizeof row / sizeof *row; k++) put(f, row[k]);
      putc('\n', f);
    }
  return cli_out_commit(&a->out);
}

void run_approaches_free(run_approaches *a) {
  run_approaches_close(a, SIZE_MAX, false);
  free(a->of);
}
