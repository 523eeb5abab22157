/* SPDX-License-Identifier: MIT */
/* Rays on bodies whose weight varies along them, also where it changes its sign. */
#include "ray/dense.h"
#include "core/vec3.h"

static const skf_profile_knot knots[] = {{0, 0, 1}, {0.25, 1.25, -0.5}, {0.625, 0.375, 2}, {1, -0.5, 0}};
static const skf_profile profiles[] = {
    {SKF_PROFILE_LINEAR, {1, 0}, NULL, 0, 0, 0},  {SKF_PROFILE_HAT, {0, 0}, NULL, 0, 0, 0},
    {SKF_PROFILE_SINE, {0, 0}, NULL, 0, 0, 0},    {SKF_PROFILE_CUBIC, {0, 0}, knots, 4, 0, 0},
    {SKF_PROFILE_LINEAR, {-1, 2}, NULL, 0, 0, 0},
};
enum { PROFILES = sizeof profiles / sizeof *profiles };

/* Every hit is a crossing; between samples the number of hits has the right parity. */
static size_t check_ray(const skf_tracer *t, const skf_field *f, double iso, const skf_ray *r) {
  enum { SAMPLES = 600 };
  skf_hit hits[DENSE_HITS];
  size_t n, k = 0;
  assert_int_equal(skf_tracer_all(t, r, DENSE_HITS, hits, &n, NULL), SKF_OK);
  for (size_t i = 0; i < n; i++) {
    double ulp = 1e-14 * (hits[i].t + 1), before = dense_value(f, r, hits[i].t - ulp),
           after = dense_value(f, r, hits[i].t + ulp);
    if ((before > iso) == (after > iso)) check_scaled(skf_field_at(f, hits[i].at, NULL), iso, 1 + fabs(iso), 1e-13);
  }
  double before = dense_value(f, r, 0);
  for (int q = 1; q <= SAMPLES; q++) {
    double at = 12. * q / SAMPLES, here = dense_value(f, r, at);
    size_t inside = 0;
    for (; k < n && hits[k].t <= at; k++) inside++;
    if (((before > iso) != (here > iso)) != (inside & 1) && fabs(here - iso) > 1e-10 && fabs(before - iso) > 1e-10)
      fail_msg("%zu hits up to %.17g, F - iso = %.3g, %.3g", inside, at, before - iso, here - iso);
    before = here;
  }
  return n;
}

static void every_crossing_is_found(void **state) {
  (void)state;
  uint64_t seed = 17;
  size_t hits = 0;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int i = 0; i < 2 * PROFILES; i++) {
      skf_element e[3];
      for (int j = 0; j < 3; j++) {
        double width = rnd(&seed, 0.3, 1);
        e[j] = (skf_element){
            .kernel = {(skf_kernel_type)k, skf_kernel_get((skf_kernel_type)k)->compact ? 2 * width : 1 / width},
            .strength = rnd(&seed, 0, 1) < 0.2 ? -1 : 1,
            .profile = profiles + (i + j) % PROFILES};
        rnd_primitive(&seed, j == 1 ? SKF_ARC : SKF_SEGMENT, 1, &e[j].primitive);
      }
      skf_field *f;
      skf_tracer *t;
      double iso = (i % 4 == 3 ? -1 : 1) * rnd(&seed, 0.1, 0.4);
      assert_int_equal(skf_field_new(e, 3, &f), SKF_OK);
      assert_int_equal(skf_tracer_new(f, iso, &t), SKF_OK);
      for (int j = 0; j < 6; j++) {
        skf_vec3 from = v3_scale(6, rnd_unit(&seed)), to = rnd_vec(&seed, 1);
        skf_ray ray = {.origin = from, .direction = v3_sub(to, from), .t_min = 0, .t_max = INFINITY};
        hits += check_ray(t, f, iso, &ray);
      }
      skf_tracer_free(t);
      skf_field_free(f);
    }
  assert_true(hits > 300);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(every_crossing_is_found)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
