/* SPDX-License-Identifier: MIT */
/* Every kernel on every shape: the closed form against adaptive quadrature, Hessian included. */
#include "check.h"
#include "field/quadrature.h"
#include "random.h"
#include <string.h>

/* Widths of the kernels from a tenth of the primitive to ten times it. */
static skf_kernel random_kernel(uint64_t *seed, skf_kernel_type type) {
  double width = pow(10, rnd(seed, -1, 1));
  const skf_kernel_info *info = skf_kernel_get(type);
  return (skf_kernel){type, !info->param ? 0 : info->compact ? 2 * width : 1 / width};
}

/* Somewhere near the primitive: at a distance between 1e-3 and 30, some on its axis or its extension. */
static skf_vec3 random_place(uint64_t *seed, const skf_primitive *p, int i) {
  double distance = pow(10, rnd(seed, -3, 1.5));
  skf_vec3 from = skf_primitive_point(p, rnd(seed, 0, 1), rnd(seed, 0, 1)), to = rnd_unit(seed);
  if (i % 5 == 1 && p->shape == SKF_ARC) return v3_mad(p->arc.center, distance, p->arc.normal);
  if (i % 5 == 1 && p->shape == SKF_SEGMENT)
    return v3_mad(p->segment.to, distance, v3_sub(p->segment.to, p->segment.from));
  if (i % 5 == 2 && p->shape == SKF_ARC) { /* in its plane */
    to = v3_unit(v3_cross(p->arc.normal, to));
    return v3_mad(p->arc.center, distance, to);
  }
  return v3_mad(from, distance, to);
}

static double norm6(const double h[6]) {
  return sqrt(h[0] * h[0] + h[3] * h[3] + h[5] * h[5] + 2 * (h[1] * h[1] + h[2] * h[2] + h[4] * h[4]));
}

typedef struct errors {
  double F, g, h;
} errors;

static errors differ(const skf_value *a, const skf_value *b, double size) {
  double d[6];
  for (int k = 0; k < 6; k++) d[k] = a->h[k] - b->h[k];
  double F = fabs(b->F), g = fmax(v3_norm(b->g), F / size), h = fmax(norm6(b->h), F / (size * size));
  if (F == 0 && a->F == 0) return (errors){0, 0, 0};
  return (errors){fabs(a->F - b->F) / F, v3_dist(a->g, b->g) / g, norm6(d) / h};
}

static void test_against_quadrature(void **state) {
  (void)state;
  uint64_t seed = 20261122;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = 0; s < SKF_SOLID; s++) {
      const skf_kernel_ops *row = skf_kernel_row((skf_kernel_type)k);
      errors worst = {0, 0, 0};
      int seen = 0;
      int count = s == SKF_TRIANGLE ? 10 : 300;
      for (int i = 0; i < count; i++) {
        skf_element e = {.kernel = random_kernel(&seed, (skf_kernel_type)k), .strength = 1};
        rnd_primitive(&seed, (skf_shape)s, 1, &e.primitive);
        if (skf_primitive_check(&e.primitive, NULL)) continue;
        skf_vec3 x = random_place(&seed, &e.primitive, i);
        skf_prepared p;
        skf_prepare(&e, &p);
        skf_value a = {.F = 0}, b = {.F = 0};
        skf_element_value(&p, x, 2, &a);
        skf_quadrature(&p, x, 2, &b);
        if (fabs(b.F) < 1e-100) continue;
        errors d = differ(&a, &b, fmax(1e-3, skf_primitive_distance(&e.primitive, x)));
        seen++;
        worst = (errors){fmax(worst.F, d.F), fmax(worst.g, d.g), fmax(worst.h, d.h)};
      }
      print_message("%-16s %-9s F %.1e  gradient %.1e  Hessian %.1e\n", row->info.name,
                    skf_shape_get((skf_shape)s)->name, worst.F, worst.g, worst.h);
      assert_true(skf_pair_get((skf_kernel_type)k, (skf_shape)s).closed == (row->closed[s] != NULL));
      assert_true(seen > count / 3);
      assert_true(worst.F < 5e-12 && worst.g < 5e-12 && worst.h < 5e-11);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_against_quadrature)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
