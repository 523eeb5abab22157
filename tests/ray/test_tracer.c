/* SPDX-License-Identifier: MIT */
/* Hits against dense sampling, for every kernel on every shape. */
#include "ray/dense.h"

static void random_scenes(void **unused) {
  (void)unused;
  uint64_t state = 11;
  size_t hits = 0;
  skf_ray_report report = {0};
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int shape = 0; shape < SKF_SHAPE_COUNT; shape++)
      for (int mixed = 0; mixed < 2; mixed++) {
        skf_element e[2] = {dense_element(&state, k, shape, 1), dense_element(&state, k, SKF_POINT, 1)};
        if (mixed) e[1].strength = -e[1].strength;
        skf_field *f;
        skf_tracer *t;
        assert_int_equal(skf_field_new(e, 2, &f), SKF_OK);
        skf_vec3 near = v3_add(skf_primitive_point(&e->primitive, 0.4, 0.3), v3(0.2, 0.15, 0.1));
        double iso = rnd(&state, 0.3, 1) * skf_field_at(f, near, NULL);
        assert_int_equal(skf_tracer_new(f, iso, &t), SKF_OK);
        for (int i = 0; i < 8; i++) {
          skf_ray r = {rnd_vec(&state, 1.5), v3_scale(rnd(&state, 0.1, 9), rnd_unit(&state)), 0, INFINITY};
          if (i & 1) r.origin = v3_mad(r.origin, -rnd(&state, 1, 3), v3_unit(r.direction));
          hits += dense_check(t, f, iso, &r, 6, 150, 1, &report);
        }
        skf_tracer_free(t);
        skf_field_free(f);
      }
  print_message("%zu hits, %zu cells, %zu evaluations, %zu grazing\n", hits, report.cells, report.evaluations,
                report.grazing);
  assert_true(hits > 300);
  assert_int_equal(report.grazing, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(random_scenes)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
