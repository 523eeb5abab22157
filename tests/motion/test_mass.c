/* SPDX-License-Identifier: MIT */
/* Masses of the solids inside isosurfaces: spheres in closed form, others by Pappus, symmetry, scale and turns. */
#include "motion/worlds.h"
#include "skelfield/rigid.h"

static skf_mass mass_of(const skf_element *e, size_t n, double iso, double tolerance) {
  skf_mass m;
  skf_field *f = field_of(e, n);
  assert_int_equal(skf_mass_of(f, iso, tolerance, &m), SKF_OK);
  skf_field_free(f);
  return m;
}

static void spheres(void **state) {
  (void)state;
  const skf_kernel kernels[] = {newton, {SKF_CAUCHY, 0.7}, {SKF_GAUSSIAN, 1.1}, {SKF_QUARTIC, 3}};
  for (int k = 0; k < 4; k++)
    for (int scale = k ? 0 : -7; scale <= 7; scale += 7) {
      double L = pow(10, scale), R = 1.3 * L, d[4];
      skf_kernel kernel = kernels[k];
      kernel.param *= kernel.type == SKF_QUARTIC ? L : 1 / L;
      skf_element e = point_at(2 * L, -L, 3 * L, kernel);
      skf_kernel_eval(kernel, R * R, d);
      skf_mass m = mass_of(&e, 1, d[0], 1e-10);
      double V = 4.0 / 3 * SKF_PI * R * R * R, I = 0.4 * V * R * R;
      check_close(m.volume, V, 1e-10);
      check_close(m.center.x, 2 * L, 1e-10);
      check_close(m.center.y, -L, 1e-10);
      check_close(m.center.z, 3 * L, 1e-10);
      for (int i = 0; i < 6; i++) check_scaled(m.inertia[i], i == 0 || i == 3 || i == 5 ? I : 0, I, 1e-9);
      assert_true(m.error < 1e-8 && fabs(m.volume / V - 1) <= m.error + 1e-13);
    }
}

/* Around a ring the tube's cross section is that of F in the half plane: V = 2 pi times the integral of r over it by
   equal steps in polar coordinates about the ring. */
static double edge_of_tube(const skf_field *f, double iso, double angle) {
  double lo = 0, hi = 0.99;
  for (int i = 0; i < 200 && lo < hi; i++) {
    double mid = 0.5 * (lo + hi);
    if (mid == lo || mid == hi) break;
    *(skf_field_at(f, v3(1 + mid * cos(angle), 0, mid * sin(angle)), NULL) > iso ? &lo : &hi) = mid;
  }
  return lo;
}

static void torus_by_pappus(void **state) {
  (void)state;
  skf_element e = ring_of(1, newton, 1);
  double iso = 7.38278, V = 0, Izz = 0;
  skf_field *f = field_of(&e, 1);
  enum { N = 400 }; /* equal steps of a periodic function converge faster than any power */
  for (int i = 0; i < N; i++) {
    double a = TAU * i / N, t = edge_of_tube(f, iso, a), c = cos(a);
    V += TAU / N * TAU * (t * t / 2 + t * t * t * c / 3);
    double t2 = t * t, t4 = t2 * t2;
    Izz += TAU / N * TAU * (t2 / 2 + t2 * t * c + 0.75 * t4 * c * c + 0.2 * t4 * t * c * c * c);
  }
  skf_mass m;
  assert_int_equal(skf_mass_of(f, iso, 1e-11, &m), SKF_OK);
  check_close(m.volume, V, 1e-11);
  check_close(m.inertia[5], Izz, 1e-10);
  check_close(m.inertia[0], m.inertia[3], 1e-10);
  check_scaled(v3_norm(m.center), 0, 1, 1e-11);
  assert_true(m.error < 1e-9);
  skf_field_free(f);
}

/* A turned and moved body has the turned inertia; what the tolerance asks for is kept. */
static void frames_and_tolerances(void **state) {
  (void)state;
  const skf_kernel k = {SKF_CAUCHY, 3};
  skf_element e[3] = {segment_of(v3(-1, 0, 0), v3(1, 0, 0), k, 1), segment_of(v3(0, 0, 0), v3(0, 1.5, 0.2), k, 1.3),
                      point_at(0.3, -0.4, 0.5, k)};
  skf_mass fine = mass_of(e, 3, 0.2, 1e-12);
  const double tolerances[] = {1e-3, 1e-6, 1e-9};
  for (int i = 0; i < 3; i++) {
    skf_mass m = mass_of(e, 3, 0.2, tolerances[i]);
    check_close(m.volume, fine.volume, fmin(tolerances[i], m.error + 1e-13));
    check_scaled(v3_dist(m.center, fine.center), 0, 1, tolerances[i]);
    for (int c = 0; c < 6; c++) check_scaled(m.inertia[c], fine.inertia[c], fine.inertia[0], tolerances[i]);
  }
  double c = cos(0.7), s = sin(0.7); /* about z */
  skf_element t[3];
  for (int i = 0; i < 3; i++) {
    t[i] = e[i];
    skf_vec3 *p = i < 2 ? &t[i].primitive.segment.from : &t[i].primitive.point.at;
    for (int n = 0; n < (i < 2 ? 2 : 1); n++)
      p[n] = v3(c * p[n].x - s * p[n].y + 5, s * p[n].x + c * p[n].y - 4, p[n].z + 2);
  }
  skf_mass m = mass_of(t, 3, 0.2, 1e-12);
  skf_vec3 x = fine.center;
  check_close(m.volume, fine.volume, 1e-12);
  check_scaled(v3_dist(m.center, v3(c * x.x - s * x.y + 5, s * x.x + c * x.y - 4, x.z + 2)), 0, 1, 1e-12);
  const double *I = fine.inertia;
  check_close(m.inertia[0], c * c * I[0] - 2 * c * s * I[1] + s * s * I[3], 1e-11);
  check_close(m.inertia[5], I[5], 1e-11);
  check_scaled(m.inertia[2], c * I[2] - s * I[4], I[0], 1e-11);
}

static void refusals(void **state) {
  (void)state;
  skf_mass m;
  skf_element e = point_at(0, 0, 0, newton), plane = {{.shape = SKF_PLANE, .plane = {{0, 0, 0}, {0, 0, 1}}}, newton, 1};
  skf_field *f = field_of(&e, 1), *g = field_of(&plane, 1);
  assert_int_equal(skf_mass_of(f, 1, 1e-20, &m), SKF_ERR_RANGE);
  assert_int_equal(skf_mass_of(f, -1, 0, &m), SKF_ERR_UNBOUNDED);
  assert_int_equal(skf_mass_of(g, -1, 0, &m), SKF_ERR_UNBOUNDED);
  skf_field_free(f), skf_field_free(g);
  e.kernel = (skf_kernel){SKF_CAUCHY, 1};
  f = field_of(&e, 1);
  assert_int_equal(skf_mass_of(f, 2, 0, &m), SKF_ERR_EMPTY);
  skf_field_free(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(spheres),
      cmocka_unit_test(torus_by_pappus),
      cmocka_unit_test(frames_and_tolerances),
      cmocka_unit_test(refusals),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
