/* SPDX-License-Identifier: MIT */
/* The same bits for every number of lanes, and whether lanes are points or elements. The eight lanes of AVX-512 are
   compiled here without its instructions, so that they can run: they are the same source, and vec.h promises one IEEE
   operation per lane. */
#include "check.h"
#include "core/vec3.h"
#include "field/batch.h"
#include "field/kernel.h"
#include "random.h"
#include <string.h>

extern const skf_batch_ops skf_batch_wide;

enum { POINTS = 203, COPIES = 13, ELEMENTS = COPIES * SKF_KERNEL_COUNT * SKF_SHAPE_COUNT };

typedef struct result {
  double F[POINTS], g[3][POINTS];
} result;

static skf_prepared elements[ELEMENTS];
static double points[3][POINTS];

static void evaluate(const skf_batch_ops *ops, size_t from, size_t count, size_t step, result *r) {
  skf_batch b;
  memset(r, 0, sizeof *r);
  assert_int_equal(skf_batch_new(ops, elements + from, count, &b), SKF_OK);
  for (size_t i = 0; i < POINTS; i += step) {
    const double *const in[3] = {points[0] + i, points[1] + i, points[2] + i};
    double *const g[3] = {r->g[0] + i, r->g[1] + i, r->g[2] + i};
    skf_batch_eval(&b, step < POINTS - i ? step : POINTS - i, in, r->F + i, g);
  }
  skf_batch_free(&b);
}

/* Points anywhere, and next to the elements: all branches of a form. */
static void fill(void) {
  uint64_t seed = 21;
  size_t n = 0;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = 0; s < SKF_SOLID; s++)
      for (int i = 0; i < COPIES; i++) {
        skf_element e = {.kernel = {(skf_kernel_type)k, rnd(&seed, 0.3, 3)}, .strength = rnd(&seed, -1, 1)};
        rnd_primitive(&seed, (skf_shape)s, 1, &e.primitive);
        skf_prepare(&e, elements + n++);
      }
  for (size_t i = 0; i < POINTS; i++) {
    const skf_primitive *p = &elements[i * 7 % ELEMENTS].primitive;
    skf_vec3 on = skf_primitive_point(p, rnd(&seed, 0, 1), rnd(&seed, 0, 1)), x = rnd_vec(&seed, 2);
    if (i % 3 == 1) x = v3_mad(on, pow(10, rnd(&seed, -12, 3)), rnd_unit(&seed));
    if (i % 12 == 5) x = on;
    for (int k = 0; k < 3; k++) points[k][i] = v3_get(x, k);
  }
}

/* Whether one of the elements has a form in `first` alone. */
static bool missing(const skf_batch_ops *first, const skf_batch_ops *ops, size_t from, size_t count) {
  for (size_t i = from; i < from + count; i++)
    if (skf_batch_form_of(first, elements + i) != skf_batch_form_of(ops, elements + i)) return true;
  return false;
}

static void compare(const skf_batch_ops *first, const skf_batch_ops *ops, const char *name) {
  static result a, b;
  const size_t sets[3] = {COPIES, ELEMENTS, 1}; /* pair after pair, all together, elements alone */
  size_t compared = 0;
  for (int i = 0; i < 3; i++)
    for (size_t from = 0; from < ELEMENTS; from += i == 2 ? COPIES : sets[i]) {
      if (missing(first, ops, from, sets[i])) continue;
      compared++;
      evaluate(first, from, sets[i], POINTS, &a);
      evaluate(ops, from, sets[i], POINTS, &b);
      if (memcmp(&a, &b, sizeof a)) fail_msg("%s: elements from %zu on differ", name, from);
      evaluate(ops, from, sets[i], 1, &b);
      if (memcmp(&a, &b, sizeof a)) fail_msg("%s: elements from %zu on differ for single points", name, from);
    }
  print_message("%s: %zu sets of elements\n", name, compared);
  assert_true(compared > 20);
}

static void test_lanes(void **state) {
  (void)state;
  const skf_batch_ops *best = skf_batch_get(skf_isa_pick());
  if (best == &skf_batch_scalar) skip();
  compare(best, best, "elements as lanes");
  compare(best, &skf_batch_wide, "eight lanes");
#ifdef SKF_HAVE_AVX512
  if (best == &skf_batch_avx512)
    compare(&skf_batch_avx2, best, "AVX-512");
  else
    print_message("no AVX-512 here: its source ran without its instructions\n");
#endif
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_lanes)};
  fill();
  return cmocka_run_group_tests(tests, NULL, NULL);
}
