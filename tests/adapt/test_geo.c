/* SPDX-License-Identifier: MIT */
/* Surface coordinates on oblate, spherical and prolate ellipsoids. */
#include "adapt/geo.h"
#include "check.h"
#include "core/vec3.h"

static const double half_turn = 3.14159265358979323846;

static skf_geo *geo_of(double equatorial, double polar, skf_vec3 center, skf_vec3 axis, skf_vec3 meridian) {
  skf_ellipsoid e = {true, equatorial, polar, center, axis, meridian};
  skf_geo *g;
  skf_status s = skf_geo_new(&e, &g);
  if (s == SKF_ERR_UNSUPPORTED) {
    print_message("this build has no GeographicLib\n");
    skip();
  }
  assert_int_equal(s, SKF_OK);
  return g;
}

/* Places on the surface solve the ellipsoid's equation, the horizon is orthonormal, its `up` is the normal. */
static void places_lie_on_the_ellipsoid(void **state) {
  (void)state;
  const double polar[] = {0.2, 0.9, 1, 1.5, 4};
  for (size_t i = 0; i < 5; i++)
    for (int lat = -90; lat <= 90; lat += 15)
      for (int lon = -165; lon <= 180; lon += 45) {
        skf_geo *g = geo_of(1, polar[i], v3(0, 0, 0), v3(0, 0, 1), v3(1, 0, 0));
        skf_vec3 p;
        skf_horizon h;
        assert_int_equal(skf_geo_point(g, (skf_place){lat * half_turn / 180, lon * half_turn / 180, 0}, &p, &h),
                         SKF_OK);
        double c2 = polar[i] * polar[i];
        check_scaled(p.x * p.x + p.y * p.y + p.z * p.z / c2, 1, 1, 1e-14);
        skf_vec3 normal = v3_unit(v3(p.x, p.y, p.z / c2));
        check_scaled(v3_dist(h.up, normal), 0, 1, 1e-13);
        check_scaled(v3_dist(v3_cross(h.east, h.north), h.up), 0, 1, 1e-14);
        check_scaled(h.east.z, 0, 1, 1e-15);
        skf_geo_free(g);
      }
}

/* There and back at heights, with a tilted and shifted frame, at three scales. */
static void round_trips(void **state) {
  (void)state;
  const double polar[] = {0.3, 1, 2.5};
  for (int k = -7; k <= 7; k += 7)
    for (size_t i = 0; i < 3; i++)
      for (int lat = -75; lat <= 75; lat += 15) {
        double L = pow(10, k), lon = lat * 0.03, height = 0.1 * L;
        skf_geo *g = geo_of(L, polar[i] * L, v3(3 * L, -2 * L, L), v3(1, 1, 2), v3(1, 0, 0));
        skf_vec3 p, up;
        skf_horizon h;
        skf_place q;
        assert_int_equal(skf_geo_point(g, (skf_place){lat * half_turn / 180, lon, height}, &p, &h), SKF_OK);
        assert_int_equal(skf_geo_place(g, p, &q), SKF_OK);
        check_scaled(q.latitude, lat * half_turn / 180, 1, 1e-13);
        check_scaled(q.longitude, lon, 1, 1e-13);
        check_scaled(q.height, height, L, 1e-13);
        up = v3_scale(1 / (0.1 * L), v3_sub(p, v3_mad(p, -height, h.up)));
        check_scaled(v3_dist(up, h.up), 0, 1, 1e-13);
        skf_geo_free(g);
      }
}

static void bad_ellipsoids_are_refused(void **state) {
  (void)state;
  skf_geo *g = geo_of(1, 1, v3(0, 0, 0), v3(0, 0, 1), v3(1, 0, 0));
  skf_place p;
  skf_vec3 x;
  assert_int_equal(skf_geo_place(g, v3(NAN, 0, 0), &p), SKF_ERR_RANGE);
  assert_int_equal(skf_geo_point(g, (skf_place){1.6, 0, 0}, &x, NULL), SKF_ERR_RANGE);
  assert_int_equal(skf_geo_point(g, (skf_place){half_turn / 2, 0, 0}, &x, NULL), SKF_OK);
  skf_geo_free(g);
  skf_ellipsoid flat = {true, 1, 0, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}},
                twisted = {true, 1, 1, {0, 0, 0}, {0, 0, 1}, {0, 0, 2}};
  assert_int_equal(skf_geo_new(&flat, &g), SKF_ERR_RANGE);
  assert_int_equal(skf_geo_new(&twisted, &g), SKF_ERR_DEGENERATE);
  assert_null(g);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(places_lie_on_the_ellipsoid),
      cmocka_unit_test(round_trips),
      cmocka_unit_test(bad_ellipsoids_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
