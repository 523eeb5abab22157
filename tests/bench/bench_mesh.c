/* SPDX-License-Identifier: MIT */
/* Triangles a second of the mesher on ten Gaussian points, exp(-9 r^2), iso 0.5; with and without smoothing. */
#include "skelfield/surface.h"
#include <stdio.h>
#include <time.h>

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void time_one(const skf_field *f, double edge, int rounds) {
  double best = 1e9;
  size_t triangles = 0;
  skf_mesh_report r = {0};
  for (int k = 0; k < 5; k++) {
    skf_mesh m;
    double start = now();
    if (skf_mesh_field(f, 0.5, &(skf_mesh_options){.edge = edge, .rounds = rounds}, &m, &r)) return;
    double seconds = now() - start;
    best = seconds < best ? seconds : best;
    triangles = m.triangle_count;
    skf_mesh_free(&m);
  }
  printf("edge %-8g %-10s %8zu triangles %8.1f ms %8.1f k triangles/s, %zu cells, %zu samples\n", edge,
         rounds < 0 ? "plain" : "smoothed", triangles, 1e3 * best, 1e-3 * (double)triangles / best, r.cells, r.samples);
}

int main(void) {
  static const skf_vec3 at[10] = {
      {0.31, -0.62, 0.18},  {-0.44, 0.27, 0.71}, {0.66, 0.52, -0.33}, {-0.12, -0.38, -0.77}, {0.05, 0.69, 0.41},
      {-0.73, -0.21, 0.09}, {0.48, -0.07, 0.74}, {-0.29, 0.58, -0.5}, {0.17, 0.11, -0.04},   {-0.55, -0.7, 0.45},
  };
  skf_element e[10];
  for (int i = 0; i < 10; i++) e[i] = (skf_element){{.shape = SKF_POINT, .point = {at[i]}}, {SKF_GAUSSIAN, 3}, 1};
  skf_field *f;
  if (skf_field_new(e, 10, &f)) return 1;
  for (int k = 0; k < 4; k++) time_one(f, 0.08 / (1 << k), -1), time_one(f, 0.08 / (1 << k), 0);
  skf_field_free(f);
  return 0;
}
