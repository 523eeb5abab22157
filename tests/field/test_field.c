/* SPDX-License-Identifier: MIT */
/* Fields as objects: what they refuse, singular sets, sums, batches, threads, memory. */
#include "check.h"
#include "core/alloc.h"
#include "random.h"
#include "skelfield/field.h"
#include <omp.h>
#include <string.h>

static const skf_element unit_segment = {
    {.shape = SKF_SEGMENT, .segment = {{-1, 0, 0}, {1, 0, 0}}}, {SKF_INVERSE, 0}, 1};

static skf_field *make(const skf_element *e, size_t n) {
  skf_field *f;
  assert_int_equal(skf_field_new(e, n, &f), SKF_OK);
  return f;
}

static skf_primitive unit(skf_shape shape) {
  skf_primitive p = {.shape = shape};
  switch (shape) {
  case SKF_POINT: p.point.at = v3(0, 0, 0); break;
  case SKF_SEGMENT: p.segment = (skf_segment){{-1, 0, 0}, {1, 0, 0}}; break;
  case SKF_ARC: p.arc = (skf_arc){{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 1, SKF_PI}; break;
  case SKF_TRIANGLE: p.triangle = (skf_triangle){{{-1, -1, 0}, {2, -1, 0}, {-1, 2, 0}}}; break;
  default: p.plane = (skf_plane){{0, 0, 0}, {0, 0, 2}};
  }
  return p;
}

static double at(skf_kernel_type k, skf_shape s, skf_vec3 x, skf_vec3 *g, double h[6]) {
  skf_element e = {unit(s), {k, 1.5}, 1};
  skf_field *f = make(&e, 1);
  double F = skf_field_tensor_at(f, x, g, h);
  skf_field_free(f);
  return F;
}

static void check_infinite(skf_kernel_type k, skf_shape s, skf_vec3 x) {
  skf_vec3 g;
  double h[6];
  assert_true(at(k, s, x, &g, h) == INFINITY);
  assert_true(g.x == 0 && g.y == 0 && g.z == 0);
  for (int i = 0; i < 6; i++) assert_true(h[i] == 0);
}

static void check_finite(skf_kernel_type k, skf_shape s, skf_vec3 x) {
  skf_vec3 g;
  double h[6], F = at(k, s, x, &g, h);
  assert_true(isfinite(F) && v3_finite(g));
  for (int i = 0; i < 6; i++) assert_true(isfinite(h[i]));
}

static void test_singular(void **state) {
  (void)state;
  for (int i = 0; i < 2; i++) {
    skf_kernel_type k = i ? SKF_INVERSE_SQUARED : SKF_INVERSE;
    check_infinite(k, SKF_POINT, v3(0, 0, 0));
    for (double t = -1; t <= 1; t += 0.25) check_infinite(k, SKF_SEGMENT, v3(t, 0, 0));
    check_finite(k, SKF_SEGMENT, v3(1.25, 0, 0)); /* the extension line is no part of it */
    check_finite(k, SKF_SEGMENT, v3(-7, 0, 0));
    check_infinite(k, SKF_ARC, v3(1, 0, 0));
    check_infinite(k, SKF_ARC, v3(0, 1, 0));
    check_finite(k, SKF_ARC, v3(0, -1, 0)); /* nor the rest of the circle */
    check_finite(k, SKF_ARC, v3(0, 0, 0));
    check_finite(k, SKF_ARC, v3(0, 0, 2));
  }
  check_infinite(SKF_INVERSE_SQUARED, SKF_TRIANGLE, v3(0, 0, 0));
  check_infinite(SKF_INVERSE_SQUARED, SKF_PLANE, v3(3, 4, 0));
  skf_vec3 g;
  double h[6];
  assert_true(at(SKF_INVERSE, SKF_PLANE, v3(3, 4, 0), &g, h) == 0 && g.z == 0);
  check_close(at(SKF_INVERSE, SKF_PLANE, v3(3, 4, 1e-30), &g, h), -2 * SKF_PI * 1e-30, 1e-15);
  check_close(g.z, -2 * SKF_PI, 1e-15);
  check_finite(SKF_INVERSE, SKF_TRIANGLE, v3(0, 0, 0));
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = 0; s < SKF_SOLID; s++) {
      skf_pair_info info = skf_pair_get((skf_kernel_type)k, (skf_shape)s);
      bool singular = skf_kernel_get((skf_kernel_type)k)->singular;
      assert_true((info.singular != NULL) == singular);
      assert_true(info.error > 0 && info.error <= 1e-10);
      skf_primitive body = unit((skf_shape)s);
      skf_vec3 on = skf_primitive_point(&body, 0.5, 0.5);
      if (!singular) check_finite((skf_kernel_type)k, (skf_shape)s, on);
    }
  assert_null(skf_pair_get(SKF_KERNEL_COUNT, SKF_POINT).singular);
}

/* On the body itself: kernels without singularity have the value of the integral. */
static void test_on_body(void **state) {
  (void)state;
  skf_vec3 g;
  double h[6];
  /* int_{-1}^{1} dt / (1 + s^2 t^2)^2 with s = 3/2 */
  double s = 1.5, want = 1 / (1 + s * s) + atan(s) / s;
  check_close(at(SKF_CAUCHY, SKF_SEGMENT, v3(0, 0, 0), &g, h), want, 1e-15);
  assert_true(v3_norm(g) == 0);
  check_close(at(SKF_GAUSSIAN, SKF_SEGMENT, v3(0, 0, 0), &g, h), sqrt(SKF_PI) * erf(1.5) / 1.5, 1e-15);
  check_close(at(SKF_QUARTIC, SKF_SEGMENT, v3(0, 0, 0), &g, h), 2 * (1 - 2 / 6.75 + 1 / 25.3125), 1e-15);
  check_close(at(SKF_QUARTIC, SKF_ARC, v3(0, 0, 0), &g, h), SKF_PI * pow(1 - 1 / 2.25, 2), 1e-15);
}

/* Far over a plane Cauchy's kernel leaves pi s^-4 z^-2, as long as a double can say so, in any direction. */
static void test_far_plane(void **state) {
  (void)state;
  for (double z = 1e10; z < 1e150; z *= 1e7)
    for (int k = 0; k < 2; k++) {
      skf_element e = {unit(SKF_PLANE), {SKF_CAUCHY, 1.5}, 1};
      if (k) e.primitive.plane.normal = v3(1, 2, -2);
      skf_vec3 g, n = v3_unit(e.primitive.plane.normal);
      skf_field *f = make(&e, 1);
      const double F = skf_field_at(f, v3_scale(z, n), &g), want = SKF_PI / 5.0625 / z / z;
      check_close(F, want, 1e-14);
      if (z < 1e95) check_close(v3_dot(g, n), -2 * want / z, 1e-14);
      skf_field_free(f);
    }
}

static void test_refusals(void **state) {
  (void)state;
  skf_field *f;
  skf_element e = unit_segment;
  e.strength = NAN;
  assert_int_equal(skf_field_new(&e, 1, &f), SKF_ERR_RANGE);
  assert_null(f);
  e = unit_segment;
  e.kernel = (skf_kernel){SKF_CAUCHY, 0};
  assert_int_equal(skf_field_new(&e, 1, &f), SKF_ERR_RANGE);
  e.kernel.param = INFINITY;
  assert_int_equal(skf_field_new(&e, 1, &f), SKF_ERR_RANGE);
  e.kernel.type = SKF_KERNEL_COUNT;
  assert_int_equal(skf_field_new(&e, 1, &f), SKF_ERR_ARG);
  e = unit_segment;
  e.primitive.segment.to = e.primitive.segment.from;
  assert_int_equal(skf_field_new(&e, 1, &f), SKF_ERR_DEGENERATE);
}

static void test_empty(void **state) {
  (void)state;
  skf_field *f = make(NULL, 0);
  skf_vec3 g = {1, 1, 1};
  assert_true(skf_field_at(f, v3(1, 2, 3), &g) == 0 && g.x == 0 && g.y == 0 && g.z == 0);
  assert_int_equal(skf_field_size(f), 0);
  assert_null(skf_field_element(f, 0));
  skf_field_free(f);
  skf_field_free(NULL);
}

/* Two opposite strengths leave the small third exactly as it is. */
static void test_sum(void **state) {
  (void)state;
  skf_element e[3] = {unit_segment, unit_segment, unit_segment};
  e[0].strength = 1e16, e[1].strength = 0.75, e[2].strength = -1e16;
  skf_field *all = make(e, 3), *one = make(e + 1, 1);
  skf_vec3 x = {0.3, 0.4, 0.5}, g, want;
  double F = skf_field_at(all, x, &g);
  check_close(F, skf_field_at(one, x, &want), 1e-15);
  check_scaled(v3_dist(g, want), 0, v3_norm(want), 2e-15);
  skf_field_free(all);
  skf_field_free(one);
}

static void test_alloc_failure(void **state) {
  (void)state;
  skf_status s = SKF_ERR_NOMEM;
  long k = 1;
  for (; s == SKF_ERR_NOMEM; k++) {
    skf_field *f;
    skf_alloc_fail_after(k);
    s = skf_field_new(&unit_segment, 1, &f);
    skf_alloc_fail_after(0);
    if (s == SKF_OK)
      skf_field_free(f);
    else
      assert_null(f);
  }
  assert_int_equal(s, SKF_OK);
  assert_true(k > 3);
}

enum { POINTS = 997 };

/* Without vector instructions the batch equals the single point bit for bit, with any number of threads and any subset
   of outputs. */
static void test_batch(void **state) {
  (void)state;
  uint64_t seed = 5;
  skf_element e[SKF_SHAPE_COUNT * SKF_KERNEL_COUNT];
  size_t n = 0;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = 0; s < SKF_SOLID; s++, n++) {
      e[n] = (skf_element){.kernel = {(skf_kernel_type)k, 1.5}, .strength = rnd(&seed, -1, 1)};
      rnd_primitive(&seed, (skf_shape)s, 1, &e[n].primitive);
    }
  setenv("SKELFIELD_ISA", "scalar", 1);
  skf_field *f = make(e, n);
  unsetenv("SKELFIELD_ISA");
  static double p[3][POINTS], F[2][POINTS], g[2][3][POINTS], h[2][6][POINTS], only[POINTS];
  for (int i = 0; i < POINTS; i++)
    for (int k = 0; k < 3; k++) p[k][i] = rnd(&seed, -2, 2);
  const double *const in[3] = {p[0], p[1], p[2]};
  int before = omp_get_max_threads();
  for (int t = 0; t < 2; t++) {
    double *G[3] = {g[t][0], g[t][1], g[t][2]}, *H[6];
    for (int k = 0; k < 6; k++) H[k] = h[t][k];
    omp_set_num_threads(t ? 3 : 1);
    assert_int_equal(skf_field_eval(f, POINTS, in, F[t], G, H), SKF_OK);
  }
  omp_set_num_threads(before);
  assert_memory_equal(F[0], F[1], sizeof F[0]);
  assert_memory_equal(g[0], g[1], sizeof g[0]);
  assert_memory_equal(h[0], h[1], sizeof h[0]);
  for (int i = 0; i < POINTS; i++) {
    skf_vec3 x = v3(p[0][i], p[1][i], p[2][i]), G;
    double H[6], v = skf_field_at(f, x, &G);
    assert_true(v == F[0][i] && G.x == g[0][0][i] && G.y == g[0][1][i] && G.z == g[0][2][i]);
    assert_true(skf_field_tensor_at(f, x, NULL, H) == v);
    for (int k = 0; k < 6; k++) assert_true(H[k] == h[0][k][i]);
  }
  double *const no_g[3] = {NULL, only, NULL};
  assert_int_equal(skf_field_eval(f, POINTS, in, NULL, no_g, NULL), SKF_OK);
  assert_memory_equal(only, g[0][1], sizeof only);
  assert_int_equal(skf_field_eval(f, POINTS, in, only, NULL, NULL), SKF_OK);
  assert_memory_equal(only, F[0], sizeof only);
  skf_field_free(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_singular),  cmocka_unit_test(test_on_body),       cmocka_unit_test(test_refusals),
      cmocka_unit_test(test_far_plane), cmocka_unit_test(test_empty),         cmocka_unit_test(test_sum),
      cmocka_unit_test(test_batch),     cmocka_unit_test(test_alloc_failure),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
