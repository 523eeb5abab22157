/* SPDX-License-Identifier: MIT */
/* Blinn's handles: the isolated primitive's surface really lies at the radius, for every kernel on every primitive. */
#include "skelfield/handles.h"
#include "check.h"
#include "core/vec3.h"
#include "random.h"
#include <string.h>

static skf_element element(skf_kernel_type kernel, const skf_primitive *p) {
  return (skf_element){.primitive = *p, .kernel = {kernel, 1}, .strength = 1};
}

static void solve(const skf_handles *given, double iso, unsigned fixed, skf_element *e, size_t n, skf_handles *out) {
  const char *why = "";
  skf_status s = skf_handles_solve(given, iso, fixed, e, n, out, &why);
  if (s) fail_msg("%s: %s", skf_kernel_get(e->kernel.type)->name, why);
}

/* Where F = iso on the line beside the primitive, by bisection of our own: independent of what solved for it. */
static double surface(const skf_element *e, double iso, double guess) {
  skf_field *f;
  assert_int_equal(skf_field_new(e, 1, &f), SKF_OK);
  double lo = 0.5 * guess, hi = 1.5 * guess;
  assert_true(skf_field_at(f, skf_handles_place(&e->primitive, lo), NULL) > iso);
  assert_true(skf_field_at(f, skf_handles_place(&e->primitive, hi), NULL) < iso);
  for (int i = 0; i < 200; i++) {
    double mid = 0.5 * (lo + hi);
    *(skf_field_at(f, skf_handles_place(&e->primitive, mid), NULL) > iso ? &lo : &hi) = mid;
  }
  skf_field_free(f);
  return lo;
}

/* The only level that the potential of an infinite plane can take at this height with positive strength. */
static double level(const skf_element *e, double iso, double radius) {
  if (e->primitive.shape != SKF_PLANE || !skf_kernel_get(e->kernel.type)->singular) return iso;
  return e->kernel.type == SKF_INVERSE || radius > 1 ? -iso : iso;
}

enum { WITH_BLOBBINESS, WITH_INFLUENCE, WITH_PARAM, WITH_STRENGTH, WAYS };

static void check_pair(skf_kernel_type k, skf_shape shape, uint64_t *seed) {
  skf_primitive p;
  do rnd_primitive(seed, shape, pow(10, rnd(seed, -3, 3)), &p);
  while (skf_primitive_check(&p, NULL));
  double size = shape == SKF_POINT || shape == SKF_PLANE ? 1
                : shape == SKF_ARC                       ? p.arc.radius
                                                         : skf_primitive_measure(&p);
  if (shape == SKF_TRIANGLE) size = sqrt(size);
  double radius = size * pow(10, rnd(seed, -1, 0.5)), iso = pow(10, rnd(seed, -1, 1));
  for (int way = 0; way < WAYS; way++) {
    skf_element e = element(k, &p);
    bool has_param = skf_kernel_get(k)->param;
    skf_handles g = {.radius = radius}, out;
    double width = radius * rnd(seed, 1.2, 4), wanted = level(&e, iso, radius);
    unsigned fixed = 0;
    if (way == WITH_BLOBBINESS && has_param) g.blobbiness = -rnd(seed, 0.1, 1.9);
    if (way == WITH_INFLUENCE && has_param) g.influence = width;
    if (way == WITH_PARAM) e.kernel.param = skf_kernel_get(k)->compact ? width : 1 / width, fixed = SKF_FIXED_PARAM;
    if (way == WITH_STRENGTH && has_param) { /* less than what an endless width would make of it */
      double most = shape == SKF_PLANE ? radius * radius : skf_primitive_measure(&p);
      e.strength = iso / most * rnd(seed, 1.5, 30), fixed = SKF_FIXED_STRENGTH;
    }
    double before = way == WITH_PARAM ? e.kernel.param : e.strength;
    solve(&g, wanted, fixed, &e, 1, &out);
    check_close(surface(&e, wanted, radius), radius, 1e-10);
    check_close(skf_primitive_distance(&p, skf_handles_place(&p, radius)), radius, 1e-10);
    check_close(out.radius, radius, 1e-15);
    if (g.blobbiness < 0) check_close(out.blobbiness, g.blobbiness, 1e-12);
    if (g.influence > 0) check_close(out.influence, g.influence, 1e-14);
    if (way == WITH_PARAM || fixed) assert_true(before == (way == WITH_PARAM ? e.kernel.param : e.strength));
    assert_true(e.strength > 0);
    skf_handles found;
    assert_int_equal(skf_handles_find(&e, 1, wanted, &found), SKF_OK);
    check_close(found.radius, radius, 1e-10);
    if (has_param) check_close(found.blobbiness, out.blobbiness, 1e-9);
    assert_true(found.influence == out.influence);
  }
}

static void the_surface_lies_at_the_radius(void **state) {
  (void)state;
  uint64_t seed = 5;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = 0; s < SKF_SOLID; s++)
      for (int i = 0; i < 12; i++) check_pair((skf_kernel_type)k, (skf_shape)s, &seed);
}

/* Blinn's blob: D = b exp(-a r^2) = 1 at r = R with a = -B / R^2, b = exp(-B) [Blinn 1982]. */
static void gaussian_points_are_blinns(void **state) {
  (void)state;
  const skf_primitive p = {.shape = SKF_POINT, .point = {{1, 2, 3}}};
  skf_element e = element(SKF_GAUSSIAN, &p);
  solve(&(skf_handles){.radius = 0.25, .blobbiness = -0.3}, 1, 0, &e, 1, NULL);
  check_close(e.kernel.param, sqrt(0.3) / 0.25, 1e-15);
  check_close(e.strength, exp(0.3), 1e-15);
}

/* The slope that blobbiness is, by differences of h itself. */
static void blobbiness_is_the_slope(void **state) {
  (void)state;
  const skf_primitive p = {.shape = SKF_POINT};
  static const double some[] = {-0.05, -0.3, -0.5, -0.7, -1, -1.9, -3, -9};
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int i = 0; i < 8 && skf_kernel_get((skf_kernel_type)k)->param; i++) {
      if (k == SKF_CAUCHY && some[i] <= -2) continue;
      skf_element e = element((skf_kernel_type)k, &p);
      solve(&(skf_handles){.radius = 2, .blobbiness = some[i]}, 1, 0, &e, 1, NULL);
      double a[4], b[4], c = 1e-4;
      skf_kernel_eval(e.kernel, 4 * (1 - c), a), skf_kernel_eval(e.kernel, 4 * (1 + c), b);
      bool kink = k == SKF_METABALL && some[i] == -0.5;
      check_close(log(b[0] / a[0]) / (log1p(c) - log1p(-c)), some[i], kink ? 1e-3 : 1e-5);
    }
}

/* An influence is where the kernel ends, or a hundredth of its peak; with blobbiness it gives the radius. */
static void influence_is_the_depth(void **state) {
  (void)state;
  const skf_primitive p = {.shape = SKF_SEGMENT, .segment = {{0, 0, 0}, {0, 0, 3}}};
  for (int k = 0; k < SKF_KERNEL_COUNT; k++) {
    const skf_kernel_info *info = skf_kernel_get((skf_kernel_type)k);
    if (!info->param) continue;
    skf_element e = element((skf_kernel_type)k, &p);
    e.strength = 7;
    skf_handles out;
    double h[4];
    solve(&(skf_handles){.influence = 1.5}, 1, 0, &e, 1, &out);
    skf_kernel_eval(e.kernel, 1.5 * 1.5, h);
    check_scaled(h[0], info->compact ? 0 : SKF_INFLUENCE_SHARE, 1, 1e-15);
    assert_true(e.strength == 7 && out.radius == 0);
    solve(&(skf_handles){.influence = 1.5, .blobbiness = -0.8}, 0.4, 0, &e, 1, &out);
    check_close(out.blobbiness, -0.8, 1e-13);
    assert_true(out.radius > 0 && out.radius < 1.5);
    check_close(surface(&e, 0.4, out.radius), out.radius, 1e-10);
  }
}

/* A chain is one primitive: its pieces share the parameter and the strength. */
static void pieces_are_solved_together(void **state) {
  (void)state;
  skf_element e[3];
  static const double at[] = {0, 1, 4, 6};
  for (int i = 0; i < 3; i++)
    e[i] = element(SKF_CAUCHY, &(skf_primitive){.shape = SKF_SEGMENT, .segment = {{at[i], 0, 0}, {at[i + 1], 0, 0}}});
  skf_element whole = element(SKF_CAUCHY, &(skf_primitive){.shape = SKF_SEGMENT, .segment = {{0, 0, 0}, {6, 0, 0}}});
  skf_handles g = {.radius = 0.5, .blobbiness = -0.9};
  solve(&g, 2, 0, e, 3, NULL);
  assert_true(e[0].strength == e[2].strength && e[0].kernel.param == e[1].kernel.param);
  skf_field *f;
  assert_int_equal(skf_field_new(e, 3, &f), SKF_OK);
  check_close(skf_field_at(f, v3(2.5, 0, 0.5), NULL), 2, 1e-14); /* beside the middle of the longest */
  skf_field_free(f);
  solve(&g, 2, 0, &whole, 1, NULL);
  check_close(e[0].strength, whole.strength, 0.01);
}

static void refused(skf_kernel_type k, skf_handles g, double iso, unsigned fixed, skf_status want, const char *part) {
  const skf_primitive p = {.shape = SKF_POINT};
  skf_element e = element(k, &p);
  const char *why = "";
  assert_int_equal(skf_handles_solve(&g, iso, fixed, &e, 1, NULL, &why), want);
  if (!strstr(why, part) || !strstr(why, "expected")) fail_msg("'%s' has no '%s'", why, part);
}

static void what_cannot_be_is_refused(void **state) {
  (void)state;
  const unsigned P = SKF_FIXED_PARAM, W = SKF_FIXED_STRENGTH;
  refused(SKF_QUARTIC, (skf_handles){1, 0, 1}, 1, 0, SKF_ERR_RANGE, "radius is not less than influence");
  refused(SKF_CAUCHY, (skf_handles){2, 0, 1}, 1, 0, SKF_ERR_RANGE, "radius is not less than influence");
  refused(SKF_QUARTIC, (skf_handles){1, 0, 0}, 1, P, SKF_ERR_RANGE, "0 at the radius");
  refused(SKF_CAUCHY, (skf_handles){1, -2, 0}, 1, 0, SKF_ERR_RANGE, "between -2 and 0");
  refused(SKF_CAUCHY, (skf_handles){1, 0.3, 0}, 1, 0, SKF_ERR_RANGE, "blobbiness");
  refused(SKF_CAUCHY, (skf_handles){-1, -1, 0}, 1, 0, SKF_ERR_RANGE, "radius");
  refused(SKF_CAUCHY, (skf_handles){1, -1, 0}, 0, 0, SKF_ERR_RANGE, "iso > 0");
  refused(SKF_CAUCHY, (skf_handles){1, 0, 0}, -1, W, SKF_ERR_RANGE, "iso > 0");
  refused(SKF_INVERSE, (skf_handles){1, 0, 0}, -1, 0, SKF_ERR_RANGE, "iso > 0");
  refused(SKF_GAUSSIAN, (skf_handles){1, 0, 0}, 1.5, W, SKF_ERR_RANGE, "larger strength");
  refused(SKF_INVERSE, (skf_handles){1, -1, 0}, 1, 0, SKF_ERR_ARG, "no parameter");
  refused(SKF_INVERSE, (skf_handles){1, 0, 0}, 1, W, SKF_ERR_ARG, "both radius and strength");
  refused(SKF_CAUCHY, (skf_handles){1, 0, 0}, 1, 0, SKF_ERR_ARG, "radius alone");
  refused(SKF_CAUCHY, (skf_handles){0, -1, 0}, 1, 0, SKF_ERR_ARG, "blobbiness alone");
  refused(SKF_CAUCHY, (skf_handles){1, -1, 2}, 1, 0, SKF_ERR_ARG, "all of radius");
  refused(SKF_CAUCHY, (skf_handles){1, -1, 0}, 1, P, SKF_ERR_ARG, "kernel's parameter");
  refused(SKF_CAUCHY, (skf_handles){0, 0, 1}, 1, P, SKF_ERR_ARG, "both influence");
  refused(SKF_CAUCHY, (skf_handles){1, -1, 0}, 1, W, SKF_ERR_ARG, "strength beside");
  refused(SKF_CAUCHY, (skf_handles){1, 0, 0}, 1, P | W, SKF_ERR_ARG, "strength beside");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_surface_lies_at_the_radius), cmocka_unit_test(gaussian_points_are_blinns),
      cmocka_unit_test(blobbiness_is_the_slope),        cmocka_unit_test(influence_is_the_depth),
      cmocka_unit_test(pieces_are_solved_together),     cmocka_unit_test(what_cannot_be_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
