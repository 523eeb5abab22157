/* SPDX-License-Identifier: MIT */
/* Bounds and regions against random samples, for every kernel on every shape. */
#include "check.h"
#include "core/vec3.h"
#include "field/bound.h"
#include "skelfield/field.h"
#include "random.h"

static skf_element element(uint64_t *state, int k, int shape, double scale) {
  skf_element e = {.kernel = {(skf_kernel_type)k, 0}, .strength = rnd(state, 0.5, 2)};
  double width = scale * rnd(state, 0.3, 2);
  e.kernel.param = skf_kernel_get(e.kernel.type)->compact ? 2 * width : 1 / width;
  rnd_primitive(state, (skf_shape)shape, scale, &e.primitive);
  return e;
}

/* Mean of d^4 F / dt^4 over a stencil of half-width 2 d, from five values. */
static double fourth(const skf_field *f, skf_vec3 p, skf_vec3 u, double d, double *noise) {
  static const double c[5] = {1, -4, 6, -4, 1};
  double sum = 0;
  *noise = 0;
  for (int i = 0; i < 5; i++) {
    double F = skf_field_at(f, v3_mad(p, (i - 2) * d, u), NULL);
    sum += c[i] * F;
    *noise += fabs(c[i] * F) * 1e-9;
  }
  *noise /= d * d * d * d;
  return sum / (d * d * d * d);
}

static void check_ball(const skf_field *f, const skf_element *e, uint64_t *state, double scale) {
  skf_vec3 c = rnd_vec(state, 2 * scale);
  double away = skf_primitive_distance(&e->primitive, c), radius = rnd(state, 0.01, 0.95) * fmin(away, scale);
  if (skf_kernel_get(e->kernel.type)->singular == false && rnd(state, 0, 1) < 0.3) radius = rnd(state, 0, 1) * scale;
  skf_bound b = skf_field_bound(f, c, radius);
  double size = fmax(fabs(b.lo), fabs(b.hi)), slack = 1e-9;
  if (!(b.lo <= b.hi && size < INFINITY))
    fail_msg("%s on %s: no bound, [%.9g, %.9g]", skf_kernel_get(e->kernel.type)->name,
             skf_shape_get(e->primitive.shape)->name, b.lo, b.hi);
  for (int i = 0; i < 12; i++) {
    skf_vec3 u = rnd_unit(state), p = v3_mad(c, radius * cbrt(rnd(state, 0, 1)), u), g, g1;
    double F = skf_field_at(f, p, &g);
    if (!(F >= b.lo - slack * size && F <= b.hi + slack * size))
      fail_msg("%s on %s: F = %.17g outside of [%.17g, %.17g]", skf_kernel_get(e->kernel.type)->name,
               skf_shape_get(e->primitive.shape)->name, F, b.lo, b.hi);
    assert_true(v3_norm(g) <= b.gradient * (1 + slack) + 1e-300);
    skf_vec3 inward = v3_unit(v3_sub(c, p)), v = rnd_unit(state);
    if (v3_dot(inward, v) < 0.5) v = inward;
    double d = 0.02 * radius, noise;
    skf_field_at(f, v3_mad(p, d, v), &g1);
    if (!(v3_dist(g, g1) <= b.hessian * d * (1 + 1e-7) + 1e-9 * v3_norm(g) + 1e-300))
      fail_msg("%s on %s: Hessian %.9g above its bound %.9g", skf_kernel_get(e->kernel.type)->name,
               skf_shape_get(e->primitive.shape)->name, v3_dist(g, g1) / d, b.hessian);
    double f4 = fourth(f, v3_mad(c, 0.3 * radius, u), v, 0.2 * radius, &noise);
    if (!(fabs(f4) <= b.fourth * (1 + 1e-9) + noise))
      fail_msg("%s on %s: fourth derivative %.9g above its bound %.9g", skf_kernel_get(e->kernel.type)->name,
               skf_shape_get(e->primitive.shape)->name, f4, b.fourth);
  }
}

static void bounds_hold(void **unused) {
  (void)unused;
  uint64_t state = 20240607;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int shape = 0; shape < SKF_SOLID; shape++)
      for (int trial = 0; trial < 24; trial++) {
        double scale = trial % 4 == 3 ? 1e-7 : trial % 4 == 2 ? 1e7 : 1;
        skf_element e = element(&state, k, shape, scale);
        if (trial % 5 == 4) e.strength = -e.strength;
        skf_field *f;
        assert_int_equal(skf_field_new(&e, 1, &f), SKF_OK);
        check_ball(f, &e, &state, scale);
        skf_field_free(f);
      }
}

/* Largest |eigenvalue|, by squaring: at least 0.98 of it. */
static double spectral(const double h[6]) {
  double a[3][3] = {{h[0], h[1], h[2]}, {h[1], h[3], h[4]}, {h[2], h[4], h[5]}}, b[3][3], scale = 1, size = 0;
  for (int n = 0; n < 6; n++) {
    size = 0;
    for (int i = 0; i < 9; i++) size = fmax(size, fabs(a[i / 3][i % 3]));
    if (!(size > 0)) return 0;
    scale *= pow(size, 1. / (1 << n));
    for (int i = 0; i < 9; i++) a[i / 3][i % 3] /= size;
    for (int i = 0; i < 9; i++) {
      int r = i / 3, c = i % 3;
      b[r][c] = a[r][0] * a[0][c] + a[r][1] * a[1][c] + a[r][2] * a[2][c];
    }
    for (int i = 0; i < 9; i++) a[i / 3][i % 3] = b[i / 3][i % 3];
  }
  return scale * pow(fmax((a[0][0] + a[1][1] + a[2][2]) / 3, 0), 1. / 64); /* the trace: sum of 64th powers */
}

/* Hessians of compact kernels, whose bounds do not come from the shells: over cells of all sizes, where the kernel ends
   and where it is widest; how near the bounds come. */
static void hessians_hold(void **unused) {
  (void)unused;
  uint64_t state = 4711;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int shape = SKF_SEGMENT; shape <= SKF_TRIANGLE; shape++) {
      double most = 0;
      if (!skf_kernel_get((skf_kernel_type)k)->compact) continue;
      for (int trial = 0; trial < 1500; trial++) {
        double scale = trial % 4 == 3 ? 1e-7 : trial % 4 == 2 ? 1e7 : 1;
        skf_element e = element(&state, k, shape, scale);
        if (trial % 3) e.kernel.param *= exp(rnd(&state, -3, 1));
        if (trial % 5 == 4) e.strength = -e.strength;
        double R = e.kernel.param, radius = R * exp(rnd(&state, -8, 0));
        skf_vec3 foot = rnd_vec(&state, scale), c = v3_mad(foot, rnd(&state, 0, 1.1) * R, rnd_unit(&state));
        skf_bound b = skf_element_bound(&e, c, radius);
        skf_field *f;
        assert_int_equal(skf_field_new(&e, 1, &f), SKF_OK);
        for (int i = 0; i < 8; i++) {
          skf_vec3 g;
          double h[6], size;
          skf_field_tensor_at(f, v3_mad(c, radius * cbrt(rnd(&state, 0, 1)), rnd_unit(&state)), &g, h);
          size = spectral(h);
          if (!(size <= b.hessian * (1 + 1e-9) + 1e-12 * fabs(e.strength) * skf_element_measure(&e) / (R * R)))
            fail_msg("%s on %s: Hessian %.9g above its bound %.9g", skf_kernel_get(e.kernel.type)->name,
                     skf_shape_get(e.primitive.shape)->name, size, b.hessian);
          if (radius < 1e-2 * R && b.hessian > 0) most = fmax(most, size / b.hessian);
        }
        skf_field_free(f);
      }
      print_message("%s on %s: up to %.2f of the bound\n", skf_kernel_get((skf_kernel_type)k)->name,
                    skf_shape_get((skf_shape)shape)->name, most);
      assert_true(most > 0.3);
    }
}

/* Nothing at or above iso outside of the box, and the box is not much larger than the surface. */
static void regions_hold(void **unused) {
  (void)unused;
  uint64_t state = 77;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int shape = 0; shape < SKF_SOLID; shape++) {
      if (shape == SKF_PLANE) continue;
      skf_element e[2] = {element(&state, k, shape, 1), element(&state, k, SKF_POINT, 1)};
      if (k & 1) e[1].strength = -e[1].strength;
      skf_field *f;
      assert_int_equal(skf_field_new(e, 2, &f), SKF_OK);
      double iso = 0.4 * skf_field_at(f, v3_add(skf_primitive_point(&e->primitive, 0.4, 0.3), v3(0.1, 0.1, 0.1)), NULL);
      skf_box b, seen = box_empty();
      if (!(iso > 0)) iso = 0.1;
      skf_status s = skf_field_region(f, iso, &b);
      assert_true(s == SKF_OK || s == SKF_ERR_EMPTY);
      if (s == SKF_ERR_EMPTY) b = (skf_box){{-2, -2, -2}, {2, 2, 2}};
      int count = 0;
      for (int i = 0; i < 1500; i++) {
        skf_vec3 c = box_center(b), h = v3_scale(i & 1 ? 0.5 : 0.75, v3_sub(b.hi, b.lo));
        skf_vec3 p = v3_add(c, v3(h.x * rnd(&state, -1, 1), h.y * rnd(&state, -1, 1), h.z * rnd(&state, -1, 1)));
        if (!(skf_field_at(f, p, NULL) >= iso)) continue;
        seen = box_add(seen, p), count++;
        assert_true(s == SKF_OK);
        assert_true(p.x >= b.lo.x && p.y >= b.lo.y && p.z >= b.lo.z);
        assert_true(p.x <= b.hi.x && p.y <= b.hi.y && p.z <= b.hi.z);
      }
      if (count > 50) {
        double ratio = box_diagonal(b) / box_diagonal(seen);
        if (ratio > 2)
          fail_msg("%s on %s: region %.3g times too large", skf_kernel_get((skf_kernel_type)k)->name,
                   skf_shape_get((skf_shape)shape)->name, ratio);
      }
      skf_field_free(f);
    }
}

static void regions_refuse(void **unused) {
  (void)unused;
  skf_element e[2] = {
      {.primitive = {.shape = SKF_POINT}, .kernel = {SKF_GAUSSIAN, 1}, .strength = 2},
      {.primitive = {.shape = SKF_PLANE, .plane = {{0, 0, 0}, {0, 0, 1}}}, .kernel = {SKF_CAUCHY, 1}, .strength = 1}};
  skf_field *f, *both, *none;
  skf_box b;
  assert_int_equal(skf_field_new(e, 1, &f), SKF_OK);
  assert_int_equal(skf_field_new(e, 2, &both), SKF_OK);
  assert_int_equal(skf_field_new(NULL, 0, &none), SKF_OK);
  assert_int_equal(skf_field_region(f, 0, &b), SKF_ERR_UNBOUNDED);
  assert_int_equal(skf_field_region(f, -1, &b), SKF_ERR_UNBOUNDED);
  assert_int_equal(skf_field_region(f, 2.1, &b), SKF_ERR_EMPTY);
  assert_int_equal(skf_field_region(f, 1.9, &b), SKF_OK);
  assert_true(b.hi.x < 0.3 && b.hi.x * b.hi.x > log(2 / 1.9));
  assert_int_equal(skf_field_region(both, 1, &b), SKF_ERR_UNBOUNDED);
  assert_int_equal(skf_field_region(both, 10, &b), SKF_ERR_EMPTY);
  assert_int_equal(skf_field_region(none, 1, &b), SKF_ERR_EMPTY);
  assert_int_equal(skf_field_region(f, NAN, &b), SKF_ERR_ARG);
  skf_field_free(f), skf_field_free(both), skf_field_free(none);
}

/* The envelopes decrease and stay above the kernel's own derivatives. */
static void envelopes_hold(void **unused) {
  (void)unused;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++) {
    skf_kernel kernel = {(skf_kernel_type)k, 1.7};
    skf_envelope last = {INFINITY, INFINITY, INFINITY, INFINITY};
    for (double r = 0.01; r < 5; r += 0.003) {
      skf_envelope e = skf_kernel_envelope(kernel, r);
      double d[4], up = 1 + 1e-12;
      skf_kernel_eval(kernel, r * r, d);
      assert_true(e.value <= last.value && e.slope <= last.slope && e.bend <= last.bend && e.fourth <= last.fourth);
      assert_true(d[0] <= e.value * up);
      assert_true(fabs(2 * r * d[1]) <= e.slope * up);
      assert_true(fabs(2 * d[1]) <= e.bend * up && fabs(2 * d[1] + 4 * r * r * d[2]) <= e.bend * up);
      /* d^4 / dt^4 = d^2 / dt^2 of h'' = 2 phi' + 4 x phi'', here by central differences of what is exact */
      for (double x = 0; x <= r * r && !skf_kernel_kinked(kernel, r - 0.01, r + 0.01); x += 0.09 * r * r) {
        double b2 = r * r - x, t = sqrt(x), step = 1e-3 * r, f2[3];
        for (int i = 0; i < 3; i++) {
          double tt = t + (i - 1) * step;
          skf_kernel_eval(kernel, b2 + tt * tt, d);
          f2[i] = 2 * d[1] + 4 * tt * tt * d[2];
        }
        double f4 = (f2[0] - 2 * f2[1] + f2[2]) / (step * step);
        assert_true(fabs(f4) <= e.fourth * (1 + 1e-4) + 1e-9 * fabs(f2[1]) / (step * step));
      }
      last = e;
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(envelopes_hold), cmocka_unit_test(bounds_hold),
                                     cmocka_unit_test(hessians_hold), cmocka_unit_test(regions_hold),
                                     cmocka_unit_test(regions_refuse)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
