/* SPDX-License-Identifier: MIT */
/* Large skeletons: expansions against the direct sum, for each kernel and shape and in layouts made to be difficult. */
#include "check.h"
#include "core/alloc.h"
#include "field/some.h"
#include "random.h"
#include "skelfield/field.h"
#include <omp.h>
#include <string.h>

enum { ELEMENTS = 4100, MANY = 8200, POINTS = 36 };

static const skf_kernel_type kernels[] = {SKF_INVERSE, SKF_INVERSE_SQUARED, SKF_CAUCHY};
static const skf_shape shapes[] = {SKF_POINT, SKF_SEGMENT, SKF_ARC, SKF_TRIANGLE};

static skf_element elements[MANY];
static size_t count = ELEMENTS; /* of elements in use */
static double p[3][POINTS], F[POINTS], g[3][POINTS], h[6][POINTS];

static skf_field *make(size_t n, double accuracy) {
  skf_field *f;
  assert_int_equal(skf_field_new_with(elements, n, &(skf_field_options){.accuracy = accuracy}, &f), SKF_OK);
  return f;
}

static void eval(const skf_field *f, size_t from, size_t n, double *F_out, double *const g_out[3], bool second) {
  const double *const in[3] = {p[0] + from, p[1] + from, p[2] + from};
  double *const hessian[6] = {h[0] + from, h[1] + from, h[2] + from, h[3] + from, h[4] + from, h[5] + from};
  assert_int_equal(skf_field_eval(f, n, in, F_out, g_out, second ? hessian : NULL), SKF_OK);
}

/* Where the elements are */
typedef enum layout { CLOUD, CLUSTERS, LINE, HUGE_ONE, DUPLICATES, SHELL, LAYOUTS } layout;

static skf_vec3 middle(uint64_t *seed, layout where, size_t i) {
  skf_vec3 at = rnd_vec(seed, 1);
  if (where == CLUSTERS) return v3_mad(i % 3 ? v3(0.7, 0.7, 0.7) : v3(-0.9, 0.1, 0.3), 0.01, at);
  if (where == LINE) return v3(at.x, 0.1 * at.x, -0.3 * at.x);
  if (where == DUPLICATES) return v3(i % 2 ? 0.5 : -0.5, i % 4 < 2 ? 0.1 : 0.2, 0);
  if (where == SHELL) return v3_unit(at);
  return at;
}

static void fill(uint64_t *seed, skf_kernel_type kernel, skf_shape shape, layout where, double scale, skf_vec3 offset) {
  for (size_t i = 0; i < count; i++) {
    skf_element *e = elements + i;
    double size = where == CLUSTERS ? 1e-3 : where == HUGE_ONE && i == 7 ? 2 : 0.04;
    *e = (skf_element){.kernel = {.type = kernel, .param = 3 / scale}, .strength = rnd(seed, 0.5, 1.5)};
    if (i % 5 == 0) e->strength = -0.3 * e->strength;
    rnd_primitive(seed, shape, size * scale, &e->primitive);
    skf_vec3 m = v3_mad(offset, scale, middle(seed, where, i));
    skf_primitive *q = &e->primitive;
    if (shape == SKF_POINT) q->point.at = m;
    if (shape == SKF_SEGMENT) q->segment.from = v3_add(q->segment.from, m), q->segment.to = v3_add(q->segment.to, m);
    if (shape == SKF_ARC) q->arc.center = v3_add(q->arc.center, m);
    for (int k = 0; k < 3 && shape == SKF_TRIANGLE; k++) q->triangle.vertices[k] = v3_add(q->triangle.vertices[k], m);
  }
}

/* In the box, beside and next to elements, on some, around the box and far away. */
static void scatter(uint64_t *seed, double scale, skf_vec3 offset) {
  for (size_t i = 0; i < POINTS; i++) {
    const skf_primitive *q = &elements[i * 113].primitive;
    skf_vec3 on = skf_primitive_point(q, rnd(seed, 0, 1), rnd(seed, 0, 1)), x = v3_mad(offset, scale, rnd_vec(seed, 1));
    if (i % 3 == 1) x = v3_mad(on, scale * pow(10, rnd(seed, -6, 0)), rnd_unit(seed));
    if (i % 12 == 2) x = v3_mad(offset, scale * pow(10, rnd(seed, 0, 3)), rnd_unit(seed));
    if (i % 12 == 5) x = v3_mad(offset, scale, rnd_vec(seed, 4));
    if (i % 12 == 8 && q->shape != SKF_ARC) x = skf_primitive_point(q, 0, 0);
    for (int k = 0; k < 3; k++) p[k][i] = v3_get(x, k);
  }
}

/* The worst differences from the direct sum at the points, each in its natural scale. */
typedef struct worst {
  double F, g, h;
} worst;

static worst compare(const skf_field *field) {
  static double want_h[6];
  worst w = {0, 0, 0};
  skf_field *direct = make(count, 0);
  const skf_prepared *all = skf_field_prepared(direct);
  double *const slope[3] = {g[0], g[1], g[2]};
  eval(field, 0, POINTS, F, slope, true);
  for (size_t i = 0; i < POINTS; i++) {
    skf_vec3 x = v3(p[0][i], p[1][i], p[2][i]), want_g, got_g = v3(g[0][i], g[1][i], g[2][i]);
    double want = skf_field_tensor_at(direct, x, &want_g, want_h), sF = 0, sg = 0, sh = 0;
    if (isinf(want)) {
      assert_true(F[i] == want && v3_norm(got_g) == 0 && h[0][i] == 0);
      continue;
    }
    for (size_t k = 0; k < count; k++) {
      skf_value v = {.F = 0};
      skf_element_value(all + k, x, 2, &v);
      double s = fabs(all[k].strength), r = skf_primitive_distance(&all[k].primitive, x), norm = 0;
      for (int m = 0; m < 6; m++) norm = fmax(norm, fabs(v.h[m]));
      sF += s * v.F, sg += s * fmax(v3_norm(v.g), v.F / r), sh += s * fmax(norm, v.F / (r * r));
    }
    w.F = fmax(w.F, fabs(F[i] - want) / sF);
    w.g = fmax(w.g, v3_dist(got_g, want_g) / sg);
    for (int m = 0; m < 6; m++) w.h = fmax(w.h, fabs(h[m][i] - want_h[m]) / sh);
  }
  skf_field_free(direct);
  return w;
}

static void check_accuracy(const char *name, double accuracy) {
  skf_field *f = make(count, accuracy);
  worst w = compare(f);
  print_message("%-28s %.0e: F %.1e, gradient %.1e, Hessian %.1e\n", name, accuracy, w.F, w.g, w.h);
  skf_field_free(f);
  if (!(w.F <= accuracy && w.g <= accuracy && w.h <= 30 * accuracy)) fail_msg("%s: not within %g", name, accuracy);
}

static void test_pairs(void **state) {
  (void)state;
  uint64_t seed = 21;
  const skf_vec3 origin = {0, 0, 0};
  for (size_t k = 0; k < 3; k++)
    for (size_t s = 0; s < 4; s++) {
      char name[64];
      fill(&seed, kernels[k], shapes[s], CLOUD, 1, origin);
      scatter(&seed, 1, origin);
      snprintf(name, sizeof name, "%s, %s", skf_kernel_get(kernels[k])->name, skf_shape_get(shapes[s])->name);
      check_accuracy(name, s == 1 ? 1e-7 : s == 3 ? 1e-3 : 1e-6);
    }
}

/* The finest accuracy. */
static void test_fine(void **state) {
  (void)state;
  uint64_t seed = 28;
  count = MANY;
  fill(&seed, SKF_INVERSE, SKF_SEGMENT, CLOUD, 1, v3(0, 0, 0));
  scatter(&seed, 1, v3(0, 0, 0));
  check_accuracy("inverse, segment", 1e-12);
  count = ELEMENTS;
}

static void test_layouts(void **state) {
  (void)state;
  static const char *const names[LAYOUTS] = {"cloud", "clusters", "line", "huge one", "duplicates", "shell"};
  uint64_t seed = 22;
  const skf_vec3 origin = {0, 0, 0};
  for (int l = 0; l < LAYOUTS; l++) {
    double scale = l == CLOUD ? 1e-7 : l == SHELL ? 1e7 : 1;
    skf_vec3 offset = l == LINE ? v3(40, -30, 20) : origin;
    fill(&seed, kernels[l % 3], SKF_SEGMENT, (layout)l, scale, offset);
    scatter(&seed, scale, offset);
    check_accuracy(names[l], 1e-6);
    if (l != CLUSTERS) continue;
    fill(&seed, SKF_INVERSE, SKF_TRIANGLE, HUGE_ONE, scale, offset);
    scatter(&seed, scale, offset);
    check_accuracy("huge triangle", 1e-6);
  }
}

/* Nearly all there is in one place, where cells of all sizes have a corner; the points are at the corners of cells that
   face it. Each pair of cells counts by itself. */
static void corners(uint64_t *seed, skf_kernel_type kernel, skf_shape shape) {
  fill(seed, kernel, shape, CLOUD, 1, v3(0, 0, 0));
  for (size_t i = 0; i < count; i++) {
    skf_primitive *q = &elements[i].primitive;
    double scale = i < 8 ? 1 : pow(10, -2 - 3 * rnd(seed, 0, 1));
    skf_vec3 m = i < 8 ? v3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)
                       : v3_scale(scale, v3(rnd(seed, 0, 1), rnd(seed, 0, 1), rnd(seed, 0, 1)));
    if (i >= 8) elements[i].strength = fabs(elements[i].strength);
    if (shape == SKF_POINT)
      q->point.at = m;
    else
      q->segment.from = m, q->segment.to = v3_mad(m, 0.01 * scale, v3_scale(-1, v3_unit(m)));
    for (int k = 0; k < 3 && i < 8 && shape == SKF_SEGMENT; k++) *v3_at(&q->segment.to, k) = 0.99 * v3_get(m, k);
  }
  for (size_t i = 0; i < POINTS; i++) {
    double cell = ldexp(1, -(int)(i % 12) / 2), nearly = 1 + pow(10, rnd(seed, -12, -2));
    int turned = (int)(i % 3);
    for (int k = 0; k < 3; k++) {
      double away = k == turned ? -nearly : i % 2 ? 1e-9 : i % 5 ? -1e-9 : -nearly;
      p[k][i] = cell * away;
    }
  }
}

/* Points as near to the whole as those can be that see it from outside, all that counts in its corners. */
static void outside(uint64_t *seed) {
  for (size_t i = 0; i < 8; i++) elements[i].strength = pow(1e3, (double)i);
  for (size_t i = 0; i < POINTS; i++)
    for (size_t k = 0; k < 3; k++)
      p[k][i] = k == i % 3 ? 3.000001 * (i & 1 ? 1 : -1) : i < 8 ? (i >> k & 1 ? 1 : -1) : rnd(seed, -1.1, 1.1);
}

static void test_corners(void **state) {
  (void)state;
  uint64_t seed = 33;
  for (int k = 0; k < 3; k++)
    for (int s = 0; s < 2; s++) {
      char name[64];
      corners(&seed, kernels[k], shapes[s]);
      snprintf(name, sizeof name, "corners, %s, %s", skf_kernel_get(kernels[k])->name, skf_shape_get(shapes[s])->name);
      check_accuracy(name, 1e-6);
      if (k == 0) check_accuracy(name, 1e-2), check_accuracy(name, 1e-9);
      outside(&seed);
      check_accuracy("outside", 1e-6);
      if (k == 0) check_accuracy("outside", 1e-2);
    }
}

/* Strengths that all but cancel: errors are of the sum of magnitudes. Far from the origin. */
static void test_cancelling(void **state) {
  (void)state;
  uint64_t seed = 34;
  for (int k = 0; k < 3; k++) {
    double away = k ? 1e3 : 1e6;
    fill(&seed, kernels[k], SKF_SEGMENT, CLOUD, 1, v3(away, -away, 0.5 * away));
    for (size_t i = 1; i < count; i += 2) { /* each next to its opposite */
      elements[i].primitive = elements[i - 1].primitive;
      elements[i].primitive.segment.to.x += 1e-3;
      elements[i].strength = -elements[i - 1].strength;
    }
    scatter(&seed, 1, v3(away, -away, 0.5 * away));
    check_accuracy("cancelling", k ? 1e-6 : 1e-5);
  }
}

/* Where squares and cubes of distances overflow. */
static void test_distant(void **state) {
  (void)state;
  uint64_t seed = 30;
  for (int k = 0; k < 3; k++) {
    fill(&seed, kernels[k], SKF_POINT, CLOUD, 1, v3(0, 0, 0));
    skf_field *f = make(count, 1e-6), *direct = make(count, 0);
    for (int power = 2; power < (k == 0 ? 280 : k == 1 ? 100 : 60); power++) {
      skf_vec3 x = v3_scale(pow(10, power), rnd_unit(&seed)), slope, want;
      double F_far = skf_field_at(f, x, &slope), F_want = skf_field_at(direct, x, &want),
             size = F_want / pow(10, power);
      check_close(F_far, F_want, 1e-5);
      for (int m = 0; m < 3; m++) check_scaled(v3_get(slope, m), v3_get(want, m), fmax(size, 1e-300), 1e-5);
    }
    skf_field_free(f), skf_field_free(direct);
  }
}

static void narrow(uint64_t *seed, skf_shape shape, layout where, double scale) {
  fill(seed, SKF_GAUSSIAN, shape, where, scale, v3(0, 0, 0));
  for (size_t i = 0; i < count; i++) elements[i].kernel.param = (where == CLUSTERS ? 2000 : 20) / scale;
  scatter(seed, scale, v3(0, 0, 0));
}

/* Narrow Gaussians: what is passed over is less than the accuracy of what is left, between them and far away. */
static void test_narrow(void **state) {
  (void)state;
  static const char *const names[3] = {"gaussian, point", "gaussian, segment", "gaussian, arc"};
  static const layout layouts[3] = {CLOUD, CLUSTERS, SHELL};
  uint64_t seed = 29;
  for (int s = 0; s < 3; s++)
    for (int l = 0; l < 3; l++) {
      narrow(&seed, shapes[s], layouts[l], l == 1 ? 1e7 : l == 2 ? 1e-7 : 1);
      skf_field *f = make(count, 1e-6);
      assert_false(skf_field_is_direct(f));
      skf_field_free(f);
      check_accuracy(names[s], s == 0 ? 1e-12 : 1e-6);
      check_accuracy(names[s], 1e-3);
    }
}

/* Gaussians from much wider than the whole to a tenth of it: polynomials in a grid of cells and around it. */
static void test_wide(void **state) {
  (void)state;
  static const double widths[] = {0.05, 0.6, 3, 7};
  uint64_t seed = 35;
  for (int l = 0; l < 4; l++)
    for (int s = 0; s < 4; s++) {
      static const layout layouts[4] = {CLOUD, LINE, HUGE_ONE, SHELL};
      char name[64];
      double scale = l == 1 ? 1e7 : l == 2 ? 1e-7 : 1;
      fill(&seed, SKF_GAUSSIAN, shapes[s], layouts[(l + s) % 4], scale, v3(0, 0, 0));
      for (size_t i = 0; i < count; i++) elements[i].kernel.param = widths[l] / scale;
      scatter(&seed, scale, v3(0, 0, 0));
      snprintf(name, sizeof name, "gaussian, %s, %g", skf_shape_get(shapes[s])->name, widths[l]);
      skf_field *f = make(count, 1e-6);
      assert_false(skf_field_is_direct(f));
      skf_field_free(f);
      check_accuracy(name, 1e-6);
      if (s == l) check_accuracy(name, l < 2 ? 1e-12 : l == 2 ? 1e-9 : 1e-3);
    }
}

/* The same bits whatever the number of threads, in any order, alone, and by itself. */
static void check_place(void) {
  static double F2[POINTS], g2[3][POINTS];
  double *const slope[3] = {g[0], g[1], g[2]};
  int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  skf_field *a = make(ELEMENTS, 1e-3);
  eval(a, 0, POINTS, F, slope, false);
  omp_set_num_threads(3);
  skf_field *b = make(ELEMENTS, 1e-3);
  for (size_t i = 0; i < POINTS; i++) {
    double *const at[3] = {g2[0] + i, g2[1] + i, g2[2] + i};
    eval(b, i, 1, F2 + i, at, false);
  }
  assert_memory_equal(F, F2, sizeof F);
  assert_memory_equal(g, g2, sizeof g);
  double *const again[3] = {g2[0], g2[1], g2[2]};
  memset(F2, 0, sizeof F2), memset(g2, 0, sizeof g2);
  eval(b, 0, POINTS, F2, again, false);
  assert_memory_equal(F, F2, sizeof F);
  assert_memory_equal(g, g2, sizeof g);
  memset(g2, 0, sizeof g2);
  eval(b, 0, POINTS, NULL, again, false); /* without F */
  assert_memory_equal(g, g2, sizeof g);
  for (size_t i = 0; i < POINTS; i++) {
    skf_vec3 slope_at;
    assert_true(skf_field_at(b, v3(p[0][i], p[1][i], p[2][i]), &slope_at) == F[i]);
    assert_true(slope_at.x == g[0][i] && slope_at.y == g[1][i] && slope_at.z == g[2][i]);
  }
  omp_set_num_threads(threads);
  skf_field_free(a);
  skf_field_free(b);
}

static void test_place(void **state) {
  (void)state;
  uint64_t seed = 23;
  for (int k = 0; k < 2; k++) {
    fill(&seed, kernels[k], SKF_SEGMENT, CLOUD, 1, v3(0, 0, 0));
    scatter(&seed, 1, v3(0, 0, 0));
    check_place();
  }
  narrow(&seed, SKF_SEGMENT, CLOUD, 1);
  check_place();
  for (size_t i = 0; i < count; i++) elements[i].kernel.param = 2; /* wide */
  check_place();
}

/* Small fields, other kernels and fields that did not ask are summed as ever. */
static void test_switch(void **state) {
  (void)state;
  uint64_t seed = 24;
  static double F2[POINTS], g2[3][POINTS];
  double *const slope[3] = {g[0], g[1], g[2]}, *const other[3] = {g2[0], g2[1], g2[2]};
  fill(&seed, SKF_INVERSE, SKF_SEGMENT, CLOUD, 1, v3(0, 0, 0));
  scatter(&seed, 1, v3(0, 0, 0));
  for (int c = 0; c < 3; c++) {
    size_t n = c == 0 ? 3999 : ELEMENTS;
    for (size_t i = 0; c == 1 && i < n; i++) elements[i].kernel = (skf_kernel){.type = SKF_QUARTIC, .param = 3};
    skf_field *plain, *f = make(n, c == 2 ? 0 : 1e-3);
    assert_int_equal(skf_field_new(elements, n, &plain), SKF_OK);
    eval(plain, 0, POINTS, F, slope, false);
    eval(f, 0, POINTS, F2, other, false);
    assert_memory_equal(F, F2, sizeof F);
    assert_memory_equal(g, g2, sizeof g);
    skf_field_free(f);
    skf_field_free(plain);
  }
}

/* Kernels and planes mixed: groups by expansions, the rest directly. */
static void test_mixed(void **state) {
  (void)state;
  uint64_t seed = 25;
  fill(&seed, SKF_INVERSE, SKF_SEGMENT, CLOUD, 1, v3(0, 0, 0));
  elements[3].kernel = (skf_kernel){.type = SKF_QUARTIC, .param = 0.5};
  elements[5].kernel = (skf_kernel){.type = SKF_CAUCHY, .param = 2};
  elements[9].primitive = (skf_primitive){.shape = SKF_PLANE, .plane = {{0, 0, -2}, {0, 0.6, 0.8}}};
  elements[9].kernel = (skf_kernel){.type = SKF_CAUCHY, .param = 1};
  elements[11].strength = 0;
  scatter(&seed, 1, v3(0, 0, 0));
  check_accuracy("mixed", 1e-6);
}

static void test_range(void **state) {
  (void)state;
  static const double bad[] = {-1, 0.9e-12, 0.011, NAN, INFINITY};
  uint64_t seed = 26;
  skf_field *f;
  fill(&seed, SKF_INVERSE, SKF_POINT, CLOUD, 1, v3(0, 0, 0));
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    assert_int_equal(skf_field_new_with(elements, 1, &(skf_field_options){.accuracy = bad[i]}, &f), SKF_ERR_RANGE);
    assert_null(f);
  }
  for (size_t i = 0; i < ELEMENTS; i++) elements[i].primitive.point.at = v3(1, 2, 3); /* no cloud: summed directly */
  f = make(ELEMENTS, 1e-6);
  check_close(skf_field_at(f, v3(1, 2, 5), NULL), 0.5 * skf_field_at(f, v3(1, 2, 4), NULL), 1e-12);
  skf_field_free(f);
}

/* Whichever allocation fails, nothing is lost and nothing is wrong. */
static void test_memory(void **state) {
  (void)state;
  uint64_t seed = 27;
  double *const slope[3] = {g[0], g[1], g[2]};
  static const skf_kernel_type each[2] = {SKF_CAUCHY, SKF_INVERSE};
  for (int i = 0; i < 3; i++) {
    if (i == 2)
      narrow(&seed, SKF_POINT, CLOUD, 1);
    else
      fill(&seed, each[i], SKF_POINT, CLOUD, 1, v3(0, 0, 0)), scatter(&seed, 1, v3(0, 0, 0));
    skf_field *f = make(ELEMENTS, 0.01);
    eval(f, 0, POINTS, F, slope, false);
    skf_field_free(f);
    for (long k = 1; k < 400; k += k < 30 ? 5 : 97) {
      skf_alloc_fail_after(k);
      skf_status s = skf_field_new_with(elements, ELEMENTS, &(skf_field_options){.accuracy = 0.01}, &f);
      skf_alloc_fail_after(0);
      assert_true(s == SKF_OK || (s == SKF_ERR_NOMEM && !f));
      skf_field_free(f);
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_pairs),   cmocka_unit_test(test_fine),    cmocka_unit_test(test_layouts),
      cmocka_unit_test(test_place),   cmocka_unit_test(test_switch),  cmocka_unit_test(test_mixed),
      cmocka_unit_test(test_range),   cmocka_unit_test(test_memory),  cmocka_unit_test(test_narrow),
      cmocka_unit_test(test_distant), cmocka_unit_test(test_corners), cmocka_unit_test(test_cancelling),
      cmocka_unit_test(test_wide),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
