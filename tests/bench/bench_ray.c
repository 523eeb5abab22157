/* SPDX-License-Identifier: MIT */
/* Rays a second, one thread: first hits and all hits of random rays. It only reports. */
#include "random.h"
#include "skelfield/ray.h"
#include <omp.h>
#include <stdio.h>

enum { RUNS = 3 };

static void report(const char *name, const skf_element *e, size_t n, double iso, int rays) {
  skf_field *f;
  skf_tracer *t;
  if (skf_field_new(e, n, &f) || skf_tracer_new(f, iso, &t)) return;
  double best[2] = {INFINITY, INFINITY};
  size_t hits = 0;
  skf_ray_report cost = {0};
  for (int run = 0; run < 2 * RUNS; run++) {
    uint64_t state = 1;
    double start = omp_get_wtime();
    for (int i = 0; i < rays; i++) {
      skf_ray r = {v3_scale(6, rnd_unit(&state)), {0, 0, 0}, 0, INFINITY};
      r.direction = v3_sub(rnd_vec(&state, 1.2), r.origin);
      skf_hit h[16];
      size_t count;
      bool found;
      if (run & 1)
        skf_tracer_all(t, &r, 16, h, &count, NULL);
      else
        skf_tracer_first(t, &r, h, &found, run ? NULL : &cost), hits += run == 0 && found;
    }
    best[run & 1] = fmin(best[run & 1], omp_get_wtime() - start);
  }
  printf("%-22s first %9.0f rays/s, all %9.0f rays/s; %2.0f %% hit, %.1f cells and %.1f evaluations a ray\n", name,
         rays / best[0], rays / best[1], 100.0 * (double)hits / rays, (double)cost.cells / rays,
         (double)cost.evaluations / rays);
  skf_tracer_free(t);
  skf_field_free(f);
}

int main(void) {
  skf_element torus = {.primitive = {.shape = SKF_ARC, .arc = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 1, 2 * SKF_PI}},
                       .kernel = {SKF_INVERSE, 0},
                       .strength = 1};
  report("inverse torus", &torus, 1, 7.38278, 40000);
  torus.kernel = (skf_kernel){SKF_CAUCHY, 3};
  report("cauchy torus", &torus, 1, 0.3, 40000);
  enum { MANY = 100 };
  skf_element e[MANY];
  uint64_t state = 9;
  for (int i = 0; i < MANY; i++) {
    skf_vec3 a = rnd_vec(&state, 1.2);
    e[i] = (skf_element){.primitive = {.shape = SKF_SEGMENT, .segment = {a, v3_add(a, rnd_vec(&state, 0.4))}},
                         .kernel = {SKF_CAUCHY, 8},
                         .strength = 1};
  }
  report("100 cauchy segments", e, MANY, 0.25, 2000);
  for (int i = 0; i < MANY; i++) e[i].kernel = (skf_kernel){SKF_QUARTIC, 0.3};
  report("100 quartic segments", e, MANY, 0.1, 2000);
  return 0;
}
