/* SPDX-License-Identifier: MIT */
/* Random places around random primitives against 113-bit quadrature, for each kernel on each shape: near the body, at
   its ends, on its lines, far away, at supports' rims; slivers, short arcs, tiny and huge widths, at scales of 1e-7 to
   1e7 and a million sizes off the origin. And cubes, boxes and slabs as solids against their closed form.
     bench_field_truth [PLACES [SEED [KERNEL [SHAPE]]]]   2000 for each pair unless told
   Worst errors of F, gradient and Hessian, of a point by itself and in a batch, where they are within 1e-12, 1e-11 and
   1e-10; of the others, how many are within what eight ulps of the place (two of an arc's angle) move, how many within
   what eight ulps of the body's own numbers do, and how many are wrong. These are printed as elements of a scene. The
   status is 1 if there are any. */
#include <stdio.h>
#ifndef SKF_HAVE_QUADMATH

int main(void) {
  puts("skipped: the compiler has no libquadmath");
  return 77;
}

#else
#include "field/cases.h"
#include "field/oracle_box.h"
#include <stdlib.h>

static const field_error target = {1e-12, 1e-11, 1e-10};

typedef struct tally {
  field_error worst;
  size_t seen, limited[2], wrong, split;
} tally;

static void print_vector(const char *before, skf_vec3 a) { printf("%s[%.17g, %.17g, %.17g]", before, a.x, a.y, a.z); }

/* As a line of a skeleton, and the place. */
static void print_case(const field_case *c) {
  const skf_shape_info *shape = skf_shape_get(c->element.primitive.shape);
  const skf_kernel_info *kernel = skf_kernel_get(c->element.kernel.type);
  printf("  - %s: {", shape->name);
  for (int i = 0; i < shape->param_count && c->element.primitive.shape != SKF_SOLID; i++) {
    const skf_param *p = shape->params + i;
    const double *at = (const double *)(const void *)((const char *)&c->element.primitive + p->offset);
    printf("%s: ", p->name);
    if (p->type == SKF_PARAM_NUMBER) printf("%.17g", *at);
    if (p->type == SKF_PARAM_ANGLE) printf("%.17g", *at * (180 / SKF_PI));
    if (p->type == SKF_PARAM_VECTOR) print_vector("", v3(at[0], at[1], at[2]));
    for (int k = 0; p->type == SKF_PARAM_VECTORS && k < p->count; k++)
      print_vector(k ? ", " : "[", v3(at[3 * k], at[3 * k + 1], at[3 * k + 2]));
    printf(p->type == SKF_PARAM_VECTORS ? "], " : ", ");
  }
  printf("kernel: {type: %s", kernel->name);
  if (kernel->param) printf(", %s: %.17g", kernel->param, c->element.kernel.param);
  print_vector("}}  at ", c->x);
}

/* The batch's bits are those of a batch of one. */
static bool same_alone(const skf_field *f, skf_vec3 x, const field_result *many) {
  field_result one;
  double *const g[3] = {one.g, one.g + 1, one.g + 2};
  double *const h[6] = {one.h, one.h + 1, one.h + 2, one.h + 3, one.h + 4, one.h + 5};
  if (skf_field_eval(f, 1, (const double *const[3]){&x.x, &x.y, &x.z}, &one.F, g, h)) return false;
  return !memcmp(&one, many, sizeof one);
}

static void check(const field_case *c, oracle_value (*truth)(const skf_element *, skf_vec3), tally *sum) {
  skf_field *f;
  oracle_value want = truth(&c->element, c->x);
  if (!(fabsq(want.F) > 1e-280Q) || skf_field_new(&c->element, 1, &f)) return;
  field_result one = case_alone(f, c->x), many = case_in_batch(f, c->x);
  field_error a = case_error(c, &want, &one), b = case_error(c, &want, &many), e = error_max(a, b);
  sum->seen++;
  sum->split += !same_alone(f, c->x, &many);
  skf_field_free(f);
  if (error_within(e, target)) {
    sum->worst = error_max(sum->worst, e);
    return;
  }
  field_error moves = case_moves(c, &want, truth);
  bool place = error_within(e, error_max(target, moves));
  if (!place) moves = error_max(moves, case_body_moves(c, &want, truth));
  if (error_within(e, error_max(target, moves))) {
    sum->limited[place ? 0 : 1]++;
    return;
  }
  sum->wrong++;
  print_case(c);
  printf(
      "\n    F, gradient, Hessian off by %.2g %.2g %.2g, in the batch %.2g %.2g %.2g; eight ulps move %.2g %.2g %.2g\n",
      a.F, a.g, a.h, b.F, b.g, b.h, moves.F, moves.g, moves.h);
}

static bool report(const char *kernel, const char *shape, const tally *sum) {
  printf("%-16s %-9s %6zu  %8.1e %8.1e %8.1e  %8zu %8zu  %5zu\n", kernel, shape, sum->seen, sum->worst.F, sum->worst.g,
         sum->worst.h, sum->limited[0], sum->limited[1], sum->wrong);
  if (sum->split) printf("  %zu depend on their neighbours in the batch\n", sum->split);
  fflush(stdout);
  return !sum->wrong && !sum->split;
}

/* Every place has a seed of its own. */
static uint64_t seed_of(uint64_t seed, int kernel, int shape, size_t i) {
  uint64_t s = seed * 0x100000001b3u + (uint64_t)(kernel * 8 + shape);
  rnd(&s, 0, 1);
  return s * 0x9e3779b97f4a7c15u + i;
}

static bool pair(skf_kernel_type kernel, skf_shape shape, size_t places, uint64_t seed) {
  tally sum = {.seen = 0};
  for (size_t i = 0; i < places; i++) {
    field_case c;
    uint64_t s = seed_of(seed, (int)kernel, (int)shape, i);
    if (case_draw(&s, kernel, shape, (case_region)(i % CASE_REGIONS), &c)) check(&c, oracle, &sum);
  }
  return report(skf_kernel_get(kernel)->name, skf_shape_get(shape)->name, &sum);
}

static bool boxes(size_t places, uint64_t seed) {
  tally sum = {.seen = 0};
  for (size_t i = 0; i < places; i++) {
    field_case c;
    uint64_t s = seed_of(seed, SKF_INVERSE, SKF_SOLID, i);
    if (!case_box(&s, (case_region)(i % CASE_REGIONS), &c)) continue;
    check(&c, oracle_box, &sum);
    skf_solid_free(c.element.primitive.solid);
  }
  return report("inverse", "solid", &sum);
}

static bool chosen(const char *word, const char *name) { return !word || !strcmp(word, name); }

int main(int argc, char **argv) {
  size_t places = argc > 1 ? strtoull(argv[1], NULL, 10) : 2000;
  uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
  const char *kernel = argc > 3 ? argv[3] : NULL, *shape = argc > 4 ? argv[4] : NULL;
  bool fine = true;
  puts("kernel           shape     places         F gradient  Hessian  by place  by body  wrong");
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = 0; s < SKF_SOLID; s++)
      if (chosen(kernel, skf_kernel_get((skf_kernel_type)k)->name) && chosen(shape, skf_shape_get((skf_shape)s)->name))
        fine &= pair((skf_kernel_type)k, (skf_shape)s, places, seed);
  if (chosen(kernel, "inverse") && chosen(shape, "solid")) fine &= boxes(places, seed);
  return fine ? 0 : 1;
}
#endif
