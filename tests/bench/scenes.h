/* SPDX-License-Identifier: MIT */
/* Bodies to time rays on: sphereflakes and a tree of finite supports, inverse distances, Cauchy segments. */
#ifndef SKF_BENCH_SCENES_H
#define SKF_BENCH_SCENES_H

#include "random.h"
#include "skelfield/ray.h"

typedef struct bench_scene {
  const char *name;
  double iso;
  skf_vec3 from, to; /* of the camera */
  skf_element *elements;
  size_t count, room;
} bench_scene;

static inline void bench_add(bench_scene *s, skf_element e) {
  if (s->count < s->room) s->elements[s->count++] = e;
}

/* A quartic kernel of this radius has its surface at 1 for iso = 1/2. */
#define BENCH_SUPPORT (1 / sqrt(1 - sqrt(0.5)))

/* A sphere; on it six of a third of its size around its equator and three above, and so on. */
static inline void bench_flake(bench_scene *s, skf_vec3 at, skf_vec3 up, double radius, int levels, skf_kernel kernel) {
  skf_kernel k = kernel;
  if (k.type == SKF_QUARTIC) k.param = radius * BENCH_SUPPORT;
  bench_add(s, (skf_element){.primitive = {.shape = SKF_POINT, .point = {at}},
                             .kernel = k,
                             .strength = k.type == SKF_QUARTIC ? 1 : radius});
  skf_vec3 u = v3_perp(up), v = v3_cross(up, u);
  for (int i = 0; i < 9 && levels > 1; i++) {
    double latitude = i < 6 ? 0 : 0.9547, longitude = i < 6 ? i * SKF_PI / 3 : (4 * i + 1) * SKF_PI / 6;
    skf_vec3 out = v3_add(v3_scale(cos(latitude) * cos(longitude), u), v3_scale(cos(latitude) * sin(longitude), v));
    out = v3_add(out, v3_scale(sin(latitude), up));
    bench_flake(s, v3_mad(at, 4. / 3 * radius, out), out, radius / 3, levels - 1, kernel);
  }
}

/* Branches split in three, breadth first. */
static inline void bench_tree(bench_scene *s, size_t count) {
  uint64_t state = 7;
  bench_add(s, (skf_element){.primitive = {.shape = SKF_SEGMENT, .segment = {{0, 0, 0}, {0, 1, 0}}},
                             .kernel = {SKF_QUARTIC, 0.11 * BENCH_SUPPORT}});
  for (size_t i = 0; i < count && s->count < count; i++) {
    skf_segment b = s->elements[i].primitive.segment;
    double length = v3_dist(b.from, b.to), turn = rnd(&state, 0, 2 * SKF_PI);
    skf_vec3 d = v3_unit(v3_sub(b.to, b.from)), u = v3_perp(d), v = v3_cross(d, u);
    for (int k = 0; k < 3 && s->count < count; k++) {
      double a = turn + 2 * SKF_PI / 3 * k, bend = rnd(&state, 0.44, 0.78);
      skf_vec3 side = v3_add(v3_scale(cos(a), u), v3_scale(sin(a), v));
      skf_vec3 along = v3_add(v3_scale(cos(bend), d), v3_scale(sin(bend), side));
      bench_add(
          s, (skf_element){.primitive = {.shape = SKF_SEGMENT, .segment = {b.to, v3_mad(b.to, 0.72 * length, along)}},
                           .kernel = {SKF_QUARTIC, 0.66 * s->elements[i].kernel.param}});
    }
  }
  /* On its axis a long segment's field is 16/15 R strength. POV-Ray's cylinders have round ends and add up where they
     meet; segments do neither: with 1.2 instead of 1 on the axis they cover as much. */
  for (size_t i = 0; i < s->count; i++) s->elements[i].strength = 1.2 * 15. / 16 / s->elements[i].kernel.param;
}

static inline void bench_cauchy(bench_scene *s, size_t count) {
  uint64_t state = 9;
  for (size_t i = 0; i < count; i++) {
    skf_vec3 a = rnd_vec(&state, 1.2), b = v3_add(a, rnd_vec(&state, 0.4));
    bench_add(s, (skf_element){
                     .primitive = {.shape = SKF_SEGMENT, .segment = {a, b}}, .kernel = {SKF_CAUCHY, 8}, .strength = 1});
  }
}

static inline void bench_inverse(bench_scene *s, size_t count) {
  uint64_t state = 11;
  for (size_t i = 0; i < count; i++)
    bench_add(s, (skf_element){.primitive = {.shape = SKF_POINT, .point = {rnd_vec(&state, 1)}},
                               .kernel = {SKF_INVERSE, 0},
                               .strength = 0.35});
}

enum { BENCH_SCENES = 7 };

/* The k-th scene in the given room, which is overwritten. */
static inline bench_scene bench_scene_make(int k, skf_element *room, size_t size) {
  static const bench_scene all[BENCH_SCENES] = {
      {.name = "flake91", .iso = 0.5, .from = {1.5, 2, -5}, .to = {0, 0.15, 0}},
      {.name = "flake820", .iso = 0.5, .from = {1.5, 2, -5}, .to = {0, 0.15, 0}},
      {.name = "flake7381", .iso = 0.5, .from = {1.5, 2, -5}, .to = {0, 0.15, 0}},
      {.name = "tree543", .iso = 0.5, .from = {0, 2, -7}, .to = {0, 1.5, 0}},
      {.name = "inverse10", .iso = 2.6, .from = {1.5, 2, -5}, .to = {0, 0, 0}},
      {.name = "inverse91", .iso = 8, .from = {1.5, 2, -5}, .to = {0, 0, 0}},
      {.name = "cauchy100", .iso = 0.02, .from = {1.5, 2, -5}, .to = {0, 0, 0}},
  };
  bench_scene s = all[k];
  s.elements = room, s.room = size;
  skf_vec3 up = v3_unit(v3(0.2, 1, 0.15));
  if (k < 3) bench_flake(&s, v3(0, 0, 0), up, 1, k + 3, (skf_kernel){SKF_QUARTIC, 0});
  if (k == 3) bench_tree(&s, 543);
  if (k == 4) bench_inverse(&s, 10);
  if (k == 5) bench_flake(&s, v3(0, 0, 0), up, 1, 3, (skf_kernel){SKF_INVERSE, 0});
  if (k == 6) bench_cauchy(&s, 100);
  return s;
}

/* The rays through the pixels of n x n, 40 degrees wide, row by row: `rows` of them, from row `first` on. */
static inline void bench_rows(const bench_scene *s, int n, int first, int rows, skf_ray *out) {
  skf_vec3 forward = v3_unit(v3_sub(s->to, s->from)), right = v3_unit(v3_cross(v3(0, 1, 0), forward));
  skf_vec3 up = v3_cross(forward, right);
  double t = tan(20 * SKF_PI / 180);
  for (int y = first; y < first + rows; y++)
    for (int x = 0; x < n; x++) {
      double a = (2 * (x + 0.5) / n - 1) * t, b = (1 - 2 * (y + 0.5) / n) * t;
      skf_vec3 d = v3_add(forward, v3_add(v3_scale(a, right), v3_scale(b, up)));
      *out++ = (skf_ray){s->from, d, 0, INFINITY};
    }
}

#endif
