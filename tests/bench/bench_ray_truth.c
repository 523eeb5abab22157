/* SPDX-License-Identifier: MIT */
/* Random rays on random bodies against samples along them: crossings that were missed, and hits that are none.
     bench_ray_truth [RAYS]   a million unless told */
#include "random.h"
#include "skelfield/ray.h"
#include <stdio.h>
#include <stdlib.h>

enum { PER_SCENE = 2000, SAMPLES = 192, FINE = 64, HITS = 64, ELEMENTS = 3 };

typedef struct tally {
  size_t rays, hits, missed, invented, off, grazing, refused;
} tally;

static double at(const skf_field *f, const skf_ray *r, double t) {
  return skf_field_at(f, v3_mad(r->origin, t, v3_unit(r->direction)), NULL);
}

static void sample(const skf_field *f, const skf_ray *r, double a, double b, int n, double *F) {
  double x[SAMPLES + 1], y[SAMPLES + 1], z[SAMPLES + 1];
  const double *const p[3] = {x, y, z};
  skf_vec3 d = v3_unit(r->direction);
  for (int i = 0; i <= n; i++) {
    skf_vec3 q = v3_mad(r->origin, a + (b - a) * i / n, d);
    x[i] = q.x, y[i] = q.y, z[i] = q.z;
  }
  skf_field_eval(f, (size_t)n + 1, p, F, NULL, NULL);
}

static double bisect(const skf_field *f, double iso, const skf_ray *r, double a, double b) {
  bool up = at(f, r, b) > iso;
  for (int i = 0; i < 60; i++) {
    double m = 0.5 * (a + b);
    *((at(f, r, m) > iso) == up ? &b : &a) = m;
  }
  return b;
}

/* One ray: where samples differ in sign from what the hits say, they are taken more closely. */
static void check(const skf_field *f, double iso, const skf_ray *r, const skf_hit *h, size_t n, tally *sum) {
  double F[SAMPLES + 1], upto = 8, G[FINE + 1];
  size_t k = 0;
  sample(f, r, 0, upto, SAMPLES, F);
  for (int i = 0; i < SAMPLES; i++) {
    double a = upto * i / SAMPLES, b = upto * (i + 1) / SAMPLES;
    size_t inside = 0, flips = 0;
    for (; k < n && h[k].t <= b; k++) inside++;
    bool flip = (F[i] > iso) != (F[i + 1] > iso);
    if (flip && inside == 1) {
      sum->off += fabs(bisect(f, iso, r, a, b) - h[k - 1].t) > 1e-9;
      continue;
    }
    if (!flip && !inside) continue;
    sample(f, r, a, b, FINE, G);
    for (int j = 0; j < FINE; j++) flips += (G[j] > iso) != (G[j + 1] > iso);
    if (flips > inside) sum->missed += flips - inside;
    if (inside > flips && ((inside - flips) & 1)) sum->invented++;
    for (size_t j = k - inside; j < k; j++) { /* pairs between samples: each hit must be a crossing */
      double ulp = 1e-13 * (h[j].t + 8), before = at(f, r, h[j].t - ulp), after = at(f, r, h[j].t + ulp);
      sum->invented += inside > flips && (before > iso) == (after > iso) && fabs(before - iso) > 1e-11 * iso;
    }
  }
}

/* The first crossing, which is found in other ways, against all. */
static void check_first(const skf_tracer *t, const skf_ray *r, const skf_hit *h, size_t n, tally *sum) {
  skf_hit first;
  bool found;
  if (skf_tracer_first(t, r, &first, &found, NULL)) exit(1);
  sum->missed += n && (!found || first.t > h->t + 1e-9), sum->invented += found && (!n || first.t < h->t - 1e-9);
}

/* An octahedron with axes of its own. */
static skf_solid *octahedron(uint64_t *state) {
  skf_vec3 c = rnd_vec(state, 0.7), axis[3], v[6];
  unsigned f[8][3];
  axis[0] = rnd_unit(state), axis[1] = v3_perp(axis[0]), axis[2] = v3_cross(axis[0], axis[1]);
  for (int k = 0; k < 6; k++) v[k] = v3_mad(c, (k & 1 ? -1 : 1) * rnd(state, 0.2, 0.6), axis[k / 2]);
  for (unsigned k = 0; k < 8; k++) {
    unsigned x = k & 1, y = 2 + (k >> 1 & 1), z = 4 + (k >> 2), odd = (k ^ k >> 1 ^ k >> 2) & 1;
    f[k][0] = x, f[k][1] = odd ? z : y, f[k][2] = odd ? y : z;
  }
  skf_solid *s;
  if (skf_solid_new(v, 6, (const unsigned(*)[3])f, 8, &s, NULL)) exit(1);
  return s;
}

/* Three elements of one kernel; triangles only of those whose closed forms are quick. *solid: the caller frees it. */
static skf_field *scene(uint64_t *state, int kernel, double *iso, skf_solid **solid) {
  skf_element e[ELEMENTS];
  bool compact = skf_kernel_get((skf_kernel_type)kernel)->compact;
  for (int i = 0; i < ELEMENTS; i++) {
    double width = rnd(state, 0.2, 0.6), pick = rnd(state, 0, 4);
    skf_shape shape = pick < 1.4 ? SKF_POINT : pick < 2.6 ? SKF_SEGMENT : pick < 3.7 ? SKF_ARC : SKF_TRIANGLE;
    if (shape == SKF_TRIANGLE && kernel != SKF_INVERSE && kernel != SKF_CAUCHY) shape = SKF_SEGMENT;
    e[i] = (skf_element){.kernel = {(skf_kernel_type)kernel, compact ? 2 * width : 1 / width, NULL},
                         .strength = rnd(state, 0.6, 1.4)};
    rnd_primitive(state, shape, 1, &e[i].primitive);
  }
  skf_field *f = NULL;
  *solid = kernel == SKF_INVERSE && rnd(state, 0, 1) < 0.5 ? octahedron(state) : NULL;
  if (*solid) e[1].primitive = (skf_primitive){.shape = SKF_SOLID, .solid = *solid}, e[1].strength *= 10;
  if (skf_field_new(e, ELEMENTS, &f)) exit(1);
  skf_vec3 near = v3_mad(skf_primitive_point(&e->primitive, 0.4, 0.3), rnd(state, 0.1, 0.5), rnd_unit(state));
  *iso = skf_field_at(f, near, NULL);
  return f;
}

int main(int argc, char **argv) {
  size_t total = argc > 1 ? strtoull(argv[1], NULL, 10) : 1000000;
  tally sum = {0};
  uint64_t state = 2026;
  for (int kernel = 0; sum.rays < total; kernel = (kernel + 1) % SKF_KERNEL_COUNT) {
    double iso;
    skf_solid *solid;
    skf_field *f = scene(&state, kernel, &iso, &solid);
    skf_tracer *t = NULL;
    if (!(iso > 1e-6) || skf_tracer_new(f, iso, &t)) {
      skf_field_free(f);
      skf_solid_free(solid);
      continue;
    }
    skf_ray_report report = {0};
    for (int i = 0; i < PER_SCENE && sum.rays < total; i++, sum.rays++) {
      skf_ray r = {v3_scale(4, rnd_unit(&state)), {0, 0, 0}, 0, 8};
      r.direction = v3_sub(rnd_vec(&state, 1.2), r.origin);
      skf_hit h[HITS];
      size_t n;
      if (skf_tracer_all(t, &r, HITS, h, &n, &report) || n > HITS) {
        sum.refused++;
        continue;
      }
      sum.hits += n;
      check(f, iso, &r, h, n, &sum);
      check_first(t, &r, h, n, &sum);
    }
    sum.grazing += report.grazing;
    skf_tracer_free(t);
    skf_field_free(f);
    skf_solid_free(solid);
  }
  printf("%zu rays, %zu hits: %zu missed, %zu invented, %zu off by more than 1e-9, %zu grazing, %zu not answered\n",
         sum.rays, sum.hits, sum.missed, sum.invented, sum.off, sum.grazing, sum.refused);
  return 0;
}
