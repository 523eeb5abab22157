/* SPDX-License-Identifier: MIT */
/* Many elements of finite support: tiles out of reach are passed over, and nothing changes. */
#include "check.h"
#include "core/vec3.h"
#include "random.h"
#include "skelfield/field.h"
#include <float.h>
#include <stdlib.h>
#include <string.h>

enum { ELEMENTS = 3000, POINTS = 1500 };

static skf_element elements[ELEMENTS];
static double p[3][POINTS], F[POINTS], g[3][POINTS];

static void make(double scale) {
  uint64_t state = 77;
  const skf_kernel_type kernels[5] = {SKF_QUARTIC, SKF_SOFT_OBJECT, SKF_METABALL, SKF_GAUSSIAN, SKF_CAUCHY};
  for (int i = 0; i < ELEMENTS; i++) {
    skf_vec3 a = rnd_vec(&state, scale), b = v3_add(a, rnd_vec(&state, 0.1 * scale));
    skf_element e = {.kernel = {kernels[i % 300 == 7 ? 4 : i % 4], 0.1 * scale}, .strength = rnd(&state, -1, 2)};
    if (e.kernel.type == SKF_CAUCHY) e.kernel.param = 5 / scale;     /* no finite support: in reach everywhere */
    if (e.kernel.type == SKF_GAUSSIAN) e.kernel.param = 280 / scale; /* exp(-800) is 0 */
    e.primitive = (skf_primitive){.shape = SKF_POINT, .point = {a}};
    if (i % 5 == 1) e.primitive = (skf_primitive){.shape = SKF_SEGMENT, .segment = {a, b}};
    if (i % 5 == 2) e.primitive = (skf_primitive){.shape = SKF_ARC, .arc = {a, {0, 0, 1}, {1, 0, 0}, 0.05 * scale, 2}};
    if (i % 50 == 3)
      e.primitive =
          (skf_primitive){.shape = SKF_TRIANGLE, .triangle = {{a, b, v3_add(a, v3(0, 0.1 * scale, 0.05 * scale))}}};
    elements[i] = e;
  }
  for (int i = 0; i < POINTS; i++) {
    skf_vec3 x = rnd_vec(&state, i % 10 == 9 ? 30 * scale : 1.2 * scale);
    for (int k = 0; k < 3; k++) p[k][i] = v3_get(x, k);
  }
}

static void evaluate(const skf_field *f, size_t from, size_t n) {
  const double *const in[3] = {p[0] + from, p[1] + from, p[2] + from};
  double *const out[3] = {g[0] + from, g[1] + from, g[2] + from};
  assert_int_equal(skf_field_eval(f, n, in, F + from, out, NULL), SKF_OK);
}

/* Against the sum of all elements, each by itself. */
static void sums(void **unused) {
  (void)unused;
  for (int pass = 0; pass < 3; pass++) {
    double scale = pass == 0 ? 1 : pass == 1 ? 1e7 : 1e-7;
    skf_field *f;
    make(scale);
    assert_int_equal(skf_field_new(elements, ELEMENTS, &f), SKF_OK);
    evaluate(f, 0, POINTS);
    for (int i = 0; i < POINTS; i += 37) {
      skf_vec3 x = v3(p[0][i], p[1][i], p[2][i]), G = {0, 0, 0};
      double sum = 0, size = 0, slopes = 0;
      for (int j = 0; j < ELEMENTS; j++) {
        skf_field *one;
        skf_vec3 h;
        assert_int_equal(skf_field_new(elements + j, 1, &one), SKF_OK);
        double v = skf_field_at(one, x, &h);
        sum += v, size += fabs(v), slopes += v3_norm(h), G = v3_add(G, h);
        skf_field_free(one);
      }
      check_scaled(F[i], sum, size, 1e-12);
      check_scaled(v3_dist(v3(g[0][i], g[1][i], g[2][i]), G), 0, slopes + size / scale, 1e-11);
      check_scaled(skf_field_at(f, x, NULL), sum, size, 1e-12);
    }
    skf_field_free(f);
  }
}

/* The same bits alone, in small batches, in large ones, for any number of threads. */
static void neighbours(void **unused) {
  (void)unused;
  static double F1[POINTS], g1[3][POINTS];
  skf_field *f;
  make(1);
  assert_int_equal(skf_field_new(elements, ELEMENTS, &f), SKF_OK);
  evaluate(f, 0, POINTS);
  memcpy(F1, F, sizeof F), memcpy(g1, g, sizeof g);
  const size_t parts[3] = {1, 3, 100};
  for (int k = 0; k < 3; k++) {
    for (size_t i = 0; i < POINTS; i += parts[k]) evaluate(f, i, POINTS - i < parts[k] ? POINTS - i : parts[k]);
    assert_memory_equal(F, F1, sizeof F);
    assert_memory_equal(g, g1, sizeof g);
  }
  skf_field_free(f);
}

/* Beyond all supports F is exactly 0; a place that is none spoils no other. */
static void nowhere(void **unused) {
  (void)unused;
  skf_field *f;
  make(1);
  size_t n = 0;
  for (int i = 0; i < ELEMENTS; i++)
    if (elements[i].kernel.type != SKF_CAUCHY) elements[n++] = elements[i];
  assert_int_equal(skf_field_new(elements, n, &f), SKF_OK);
  static double before[POINTS];
  evaluate(f, 0, POINTS);
  memcpy(before, F, sizeof F);
  int zeros = 0;
  for (int i = 9; i < POINTS; i += 10)
    if (fabs(p[0][i]) > 1.5) assert_true(F[i] == 0 && g[0][i] == 0 && g[1][i] == 0 && g[2][i] == 0), zeros++;
  assert_true(zeros > 50);
  p[0][5] = NAN, p[1][700] = INFINITY;
  evaluate(f, 0, POINTS);
  for (int i = 0; i < POINTS; i++)
    if (i != 5 && i != 700) assert_memory_equal(F + i, before + i, sizeof *F);
  skf_field_free(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(sums), cmocka_unit_test(neighbours), cmocka_unit_test(nowhere)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
