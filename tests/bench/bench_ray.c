/* SPDX-License-Identifier: MIT */
/* Rays of a camera on bodies of many elements: nanoseconds a ray on one thread, what two threads gain, what silhouettes
   cost. It only reports.
     bench_ray [SIZE [SCENE]]             SIZE x SIZE pixels of each scene
     bench_ray --once SIZE SCENE          one first frame and nothing else, to be measured from outside
     bench_ray --cover SIZE SCENE PPM     the share of pixels on which hits agree with what is not black in the picture
     bench_ray --pov DIR                  writes the scenes that POV-Ray can draw there, the same for skelfield, and
                                          where the camera is; see povray.sh */
#include "quiet.h"
#include "scenes.h"
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { RUNS = 5, FRAMES = 12, PIECE = 1024, ROOM = 8000 };

typedef struct picture {
  int size;
  size_t n;
  skf_ray *rays;
  skf_hit *hits;
  bool *found;
} picture;

static int compare(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double median(double *x, size_t n) {
  qsort(x, n, sizeof *x, compare);
  return n ? x[n / 2] : NAN;
}

/* What pixels cost that have a neighbour across the outline, by the median of all pixels with a hit. */
typedef struct outline_cost {
  double median, mean, most; /* most: of 95 % */
} outline_cost;

static outline_cost outline(const skf_tracer *t, const picture *p) {
  double *cost = malloc(p->n * sizeof *cost), *edge = malloc(p->n * sizeof *edge), *hit = malloc(p->n * sizeof *hit);
  size_t edges = 0, hits = 0, m = (size_t)p->size;
  outline_cost o = {.mean = 0};
  if (!cost || !edge || !hit) exit(1);
  for (size_t i = 0; i < p->n; i++) cost[i] = INFINITY;
  for (int run = 0; run < RUNS; run++)
    for (size_t i = 0; i < p->n; i++) {
      double start = omp_get_wtime();
      skf_tracer_first(t, p->rays + i, p->hits + i, p->found + i, NULL);
      cost[i] = fmin(cost[i], omp_get_wtime() - start);
    }
  for (size_t i = m; i + m < p->n; i++) {
    bool is = p->found[i];
    if (is) hit[hits++] = cost[i];
    if (is != p->found[i - 1] || is != p->found[i + 1] || is != p->found[i - m] || is != p->found[i + m])
      edge[edges++] = cost[i], o.mean += cost[i];
  }
  double per = 1 / median(hit, hits);
  o.median = median(edge, edges) * per, o.mean *= per / (double)edges,
  o.most = edges ? edge[edges * 95 / 100] * per : 0;
  free(cost), free(edge), free(hit);
  return o;
}

/* Skips comments in a PPM's head. */
static int number(FILE *f) {
  int n = -1, c;
  while ((c = fgetc(f)) == '#' || c == '\n' || c == ' ')
    if (c == '#')
      while ((c = fgetc(f)) != '\n' && c != EOF) continue;
  ungetc(c, f);
  return fscanf(f, "%d", &n) == 1 ? n : -1;
}

static int compare_picture(const picture *p, const char *name) {
  FILE *f = fopen(name, "rb");
  if (!f) return perror(name), 1;
  char kind[3] = "";
  bool good = fscanf(f, "%2s", kind) == 1 && !strcmp(kind, "P6") && number(f) == p->size && number(f) == p->size &&
              number(f) == 255 && fgetc(f) != EOF;
  size_t agree = 0, ours = 0, theirs = 0;
  for (size_t i = 0; good && i < p->n; i++) {
    int r = fgetc(f), g = fgetc(f), b = fgetc(f);
    bool drawn = r > 0 || g > 0 || b > 0;
    good = b != EOF;
    agree += drawn == p->found[i], ours += p->found[i], theirs += drawn;
  }
  if (good)
    printf("%.3f %% (%zu here, %zu there)", 100 * (double)agree / (double)p->n, ours, theirs);
  else
    fprintf(stderr, "%s: not a PPM of that size\n", name);
  fclose(f);
  return !good;
}

/* The gain of two threads, and what they gain in the same run where nothing but cores is needed: other users of the
   machine count in both. */
static double two_threads(const skf_tracer *t, const picture *p, double *control) {
  double best[2] = {INFINITY, INFINITY}, plain[2] = {INFINITY, INFINITY};
  for (int run = 0; run < 6 * RUNS; run++) {
    bool both = run % 3 > 0; /* twice: after one with a single thread the other has to be started */
    omp_set_num_threads(1 + both);
    double start = omp_get_wtime();
    skf_tracer_first_many(t, p->n, p->rays, p->hits, p->found, NULL);
    double middle = omp_get_wtime();
    best[both] = fmin(best[both], middle - start);
#pragma omp parallel for schedule(dynamic)
    for (int i = 0; i < 1000; i++) quiet_multiply(QUIET_ROUNDS);
    plain[both] = fmin(plain[both], omp_get_wtime() - middle);
  }
  omp_set_num_threads(1);
  *control = plain[0] / plain[1];
  return best[0] / best[1];
}

static picture open_picture(const bench_scene *s, int size) {
  picture p = {.size = size, .n = (size_t)size * (size_t)size};
  p.rays = malloc(p.n * sizeof *p.rays), p.hits = malloc(p.n * sizeof *p.hits), p.found = malloc(p.n);
  if (!p.rays || !p.hits || !p.found) exit(1);
  memset(p.hits, 1, p.n * sizeof *p.hits), memset(p.found, 1, p.n); /* no page is new */
  bench_rows(s, size, 0, size, p.rays);
  return p;
}

static void close_picture(picture *p) { free(p->rays), free(p->hits), free(p->found); }

/* A tracer as render makes it. */
static skf_tracer *tracer_of(const skf_field *f, const bench_scene *s) {
  skf_tracer *t = NULL;
  if (skf_tracer_new_with(f, s->iso, &(skf_tracer_options){.normals = 1e-8}, &t)) exit(1);
  return t;
}

/* One frame, some rows at a time; what it covers beside another picture, where there is one. */
static int once(const bench_scene *s, int size, const char *other) {
  enum { ROWS = 8 };
  picture p = {.size = size, .n = (size_t)size * (size_t)size};
  p.rays = malloc(ROWS * (size_t)size * sizeof *p.rays), p.hits = malloc(ROWS * (size_t)size * sizeof *p.hits);
  p.found = malloc(p.n);
  if (!p.rays || !p.hits || !p.found) exit(1);
  skf_field *f = NULL;
  omp_set_num_threads(1);
  if (skf_field_new(s->elements, s->count, &f)) exit(1);
  skf_tracer *t = tracer_of(f, s);
  for (int y = 0; y < size; y += ROWS) {
    int rows = size - y < ROWS ? size - y : ROWS;
    bench_rows(s, size, y, rows, p.rays);
    skf_tracer_first_many(t, (size_t)rows * (size_t)size, p.rays, p.hits, p.found + (size_t)y * (size_t)size, NULL);
  }
  int status = other ? compare_picture(&p, other) : 0;
  skf_tracer_free(t);
  skf_field_free(f);
  close_picture(&p);
  return status;
}

/* A frame piece by piece, each on a core at rest unless the wall clock shows `end`. */
static void time_frame(quiet_state *q, double end, const skf_tracer *t, const picture *p, quiet_series *pieces,
                       skf_ray_report *cost) {
  for (size_t from = 0; from < p->n; from += PIECE) {
    size_t n = p->n - from < PIECE ? p->n - from : PIECE;
    quiet_wait(q, end);
    quiet_start(q);
    skf_tracer_first_many(t, n, p->rays + from, p->hits + from, p->found + from, cost);
    double cycles = quiet_stop(q);
    quiet_keep(pieces + from / PIECE, cycles, quiet_probe(q));
  }
}

static double sum_of(const quiet_series *pieces, size_t n) {
  double sum = 0;
  for (size_t i = 0; i < n; i++) sum += quiet_median(pieces + i);
  return sum;
}

static void report(quiet_state *q, const bench_scene *s, int size) {
  picture p = open_picture(s, size);
  size_t hit = 0;
  skf_field *f = NULL;
  skf_tracer *t = NULL;
  if (skf_field_new(s->elements, s->count, &f)) exit(1);
  size_t pieces = (p.n + PIECE - 1) / PIECE;
  quiet_series *frame[2] = {calloc(pieces, sizeof **frame), calloc(pieces, sizeof **frame)};
  if (!frame[0] || !frame[1]) exit(1);
  for (size_t i = 0; i < pieces; i++) quiet_clear(frame[0] + i), quiet_clear(frame[1] + i);
  double make = INFINITY, end = quiet_now(CLOCK_MONOTONIC) + 6e9;
  skf_ray_report cost;
  omp_set_num_threads(1);
  for (int run = 0; run < FRAMES; run++) { /* with a tracer that has seen no rays, and again */
    skf_tracer_free(t);
    double start = quiet_cpu();
    t = tracer_of(f, s);
    make = fmin(make, 1e-6 * (quiet_cpu() - start));
    time_frame(q, end, t, &p, frame[0], NULL);
    memset(&cost, 0, sizeof cost);
    time_frame(q, end, t, &p, frame[1], &cost);
  }
  double cold = sum_of(frame[0], pieces), warm = sum_of(frame[1], pieces), second = 1e-9 * q->cycle_ns;
  free(frame[0]), free(frame[1]);
  for (size_t i = 0; i < p.n; i++) hit += p.found[i];
  double per = 1 / (double)p.n;
  printf("%-10s made %6.1f ms, first frame %6.1f M cycles = %6.3f s, then %6.1f M = %6.3f s = %5.0f ns/ray; "
         "%4.1f %% hit, %.2f cells, %.2f evaluations a ray, %zu grazing; ",
         s->name, make, 1e-6 * cold, second * cold, 1e-6 * warm, second * warm, 1e9 * per * second * warm,
         100 * per * (double)hit, per * (double)cost.cells, per * (double)cost.evaluations, cost.grazing);
  double control, gain = two_threads(t, &p, &control);
  outline_cost o = outline(t, &p);
  printf("outline / median hit %.2f, mean %.2f, 95 %% below %.2f; two threads %.2f, of bare cores %.2f\n", o.median,
         o.mean, o.most, gain, control);
  fflush(stdout);
  skf_tracer_free(t);
  skf_field_free(f);
  close_picture(&p);
}

/* Blobs of the same kernel, cylinders in place of segments, an isosurface in place of sums of 1 / r. */
static void write_pov(const bench_scene *s, FILE *o) {
  fprintf(o, "#version 3.7;\nglobal_settings { assumed_gamma 1 max_trace_level 1 }\n#include \"functions.inc\"\n");
  fprintf(o, "camera { location <%g,%g,%g> up y right x angle 40 look_at <%g,%g,%g> }\n", s->from.x, s->from.y,
          s->from.z, s->to.x, s->to.y, s->to.z);
  fprintf(o, "light_source { <6,8,-8> rgb 1 shadowless }\n");
  bool inverse = s->elements->kernel.type == SKF_INVERSE;
  double size = 0;
  if (inverse)
    fprintf(o, "isosurface { function { %.9g/(0", s->iso);
  else
    fprintf(o, "blob { threshold %g\n", s->iso);
  for (size_t i = 0; i < s->count; i++) {
    const skf_element *e = s->elements + i;
    skf_vec3 a = e->primitive.point.at, b = e->primitive.segment.to;
    size = fmax(size, v3_norm(a));
    if (inverse)
      fprintf(o, "+%.9g/f_r(x-(%.9g),y-(%.9g),z-(%.9g))", e->strength, a.x, a.y, a.z);
    else if (e->primitive.shape == SKF_POINT)
      fprintf(o, "sphere { <%.9g,%.9g,%.9g>, %.9g, 1 }\n", a.x, a.y, a.z, e->kernel.param);
    else
      fprintf(o, "cylinder { <%.9g,%.9g,%.9g>, <%.9g,%.9g,%.9g>, %.9g, 1 }\n", a.x, a.y, a.z, b.x, b.y, b.z,
              e->kernel.param);
  }
  if (inverse) fprintf(o, ") - 1 } contained_by { sphere { 0, %.9g } } accuracy 0.0001 max_gradient 1.7\n", size + 0.7);
  fprintf(o, "pigment { rgb <0.8,0.6,0.3> } finish { ambient 0.15 diffuse 0.8 } }\n");
}

static void write_yaml(const bench_scene *s, FILE *o) {
  static const char *const kernels[] = {[SKF_INVERSE] = "type: inverse", [SKF_QUARTIC] = "type: quartic"};
  fprintf(o, "skelfield: 1\nbodies:\n  - name: body\n    iso: %.17g\n    skeleton:\n", s->iso);
  for (size_t i = 0; i < s->count; i++) {
    const skf_element *e = s->elements + i;
    skf_vec3 a = e->primitive.point.at, b = e->primitive.segment.to;
    if (e->primitive.shape == SKF_POINT)
      fprintf(o, "      - point: {at: [%.17g, %.17g, %.17g]", a.x, a.y, a.z);
    else
      fprintf(o, "      - segment: {from: [%.17g, %.17g, %.17g], to: [%.17g, %.17g, %.17g]", a.x, a.y, a.z, b.x, b.y,
              b.z);
    fprintf(o, ", strength: %.17g, kernel: {%s", e->strength, kernels[e->kernel.type]);
    if (e->kernel.type == SKF_QUARTIC) fprintf(o, ", R: %.17g", e->kernel.param);
    fprintf(o, "}}\n");
  }
}

static void write_camera(const bench_scene *s, FILE *o) {
  fprintf(o, "%g,%g,%g %g,%g,%g\n", s->from.x, s->from.y, s->from.z, s->to.x, s->to.y, s->to.z);
}

static bool write_one(const bench_scene *s, const char *where, const char *ending,
                      void (*print)(const bench_scene *s, FILE *o)) {
  char name[4096];
  snprintf(name, sizeof name, "%s/%s.%s", where, s->name, ending);
  FILE *o = fopen(name, "w");
  if (o) print(s, o);
  if (o && !fclose(o)) return true;
  return perror(name), false;
}

static int write_all(const char *where) {
  static skf_element room[ROOM];
  for (int k = 0; k < BENCH_SCENES; k++) {
    bench_scene s = bench_scene_make(k, room, ROOM);
    if (s.elements->kernel.type == SKF_CAUCHY) continue;
    if (!write_one(&s, where, "pov", write_pov) || !write_one(&s, where, "yaml", write_yaml) ||
        !write_one(&s, where, "camera", write_camera))
      return 1;
  }
  return 0;
}

int main(int argc, char **argv) {
  static skf_element room[ROOM];
  if (argc > 2 && !strcmp(argv[1], "--pov")) return write_all(argv[2]);
  bool single = argc > 3 && (!strcmp(argv[1], "--once") || (argc > 4 && !strcmp(argv[1], "--cover")));
  const char *name = single ? argv[3] : argc > 2 ? argv[2] : NULL;
  int size = argc > 1 ? atoi(argv[single ? 2 : 1]) : 512;
  if (size < 1) return fprintf(stderr, "bench_ray: no size\n"), 2;
  quiet_state q = {.counter = -1};
  if (!single) q = quiet_begin(); /* once: there are few counters */
  for (int k = 0; k < BENCH_SCENES; k++) {
    bench_scene s = bench_scene_make(k, room, ROOM);
    if (name && strcmp(name, s.name)) continue;
    if (single) return once(&s, size, argc > 4 ? argv[4] : NULL);
    report(&q, &s, size);
  }
  return 0;
}
