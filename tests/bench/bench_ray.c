/* SPDX-License-Identifier: MIT */
/* Rays of a camera on bodies of many elements. It only reports. */
#include "scenes.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { RUNS = 5, ROOM = 8000 };

static double cpu(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void frame(const skf_tracer *t, const skf_ray *rays, size_t n, skf_hit *hits, bool *found, skf_ray_report *r) {
  if (getenv("ONE"))
    for (size_t i = 0; i < n; i++) skf_tracer_first(t, rays + i, hits + i, found + i, r);
  else
    skf_tracer_first_many(t, n, rays, hits, found, r);
}

static void report(const bench_scene *s, int size) {
  size_t n = (size_t)size * (size_t)size, hit = 0;
  skf_ray *rays = malloc(n * sizeof *rays);
  skf_hit *hits = malloc(n * sizeof *hits);
  bool *found = malloc(n);
  skf_field *f = NULL;
  skf_tracer *t = NULL;
  if (!rays || !hits || !found || skf_field_new(s->elements, s->count, &f)) exit(1);
  for (int y = 0; y < size; y++)
    for (int x = 0; x < size; x++) rays[y * size + x] = bench_ray(s, size, x, y);
  double make = cpu(), cold = INFINITY, warm = INFINITY;
  if (skf_tracer_new(f, s->iso, &t)) exit(1);
  make = cpu() - make;
  skf_ray_report cost;
  for (int run = 0; run < RUNS; run++) {
    memset(&cost, 0, sizeof cost);
    double start = cpu();
    frame(t, rays, n, hits, found, &cost);
    double took = cpu() - start;
    if (run == 0)
      cold = took;
    else if (took < warm)
      warm = took;
  }
  for (size_t i = 0; i < n; i++) hit += found[i];
  double per = 1 / (double)n;
  printf("%-10s %5zu elements, %4.1f %% hit; made in %5.1f ms, first frame %6.0f ns/ray, then %6.0f ns/ray; "
         "%.2f cells, %.2f evaluations a ray, %zu grazing\n",
         s->name, s->count, 100 * per * (double)hit, 1e3 * make, 1e9 * per * cold, 1e9 * per * warm,
         per * (double)cost.cells, per * (double)cost.evaluations, cost.grazing);
  skf_tracer_free(t);
  skf_field_free(f);
  free(rays), free(hits), free(found);
}

int main(int argc, char **argv) {
  static skf_element room[ROOM];
  for (int k = 0; k < BENCH_SCENES; k++) {
    bench_scene s = bench_scene_make(k, room, ROOM);
    if (argc > 2 && strcmp(argv[2], s.name)) continue;
    report(&s, argc > 1 ? atoi(argv[1]) : 512);
  }
  return 0;
}
