/* SPDX-License-Identifier: MIT */
/* Polygons cut into triangles: they cover the polygon once, and what is no polygon is refused. */
#include "check.h"
#include "random.h"
#include "skelfield/skeleton.h"
#include <string.h>

enum { MOST = 200 };

/* n - 2 triangles of one orientation whose areas add up to the shoelace's: they cover it once. */
static void check_cover(const char *name, const skf_vec3 *v, size_t n, double tol) {
  unsigned t[MOST][3];
  const char *why;
  size_t where;
  if (skf_polygon_triangulate(v, n, t, &why, &where)) fail_msg("%s: %s at vertex %zu", name, why, where);
  skf_vec3 area = {0, 0, 0};
  double sum = 0;
  for (size_t i = 0; i < n; i++) area = v3_add(area, v3_cross(v3_sub(v[i], v[0]), v3_sub(v[(i + 1) % n], v[0])));
  for (size_t i = 0; i + 2 < n; i++) {
    skf_primitive p = {.shape = SKF_TRIANGLE, .triangle.vertices = {v[t[i][0]], v[t[i][1]], v[t[i][2]]}};
    assert_int_equal(skf_primitive_check(&p, NULL), SKF_OK);
    const skf_vec3 *c = p.triangle.vertices;
    assert_true(v3_dot(v3_unit(area), v3_unit(v3_cross(v3_sub(c[1], c[0]), v3_sub(c[2], c[0])))) > 0);
    sum += skf_primitive_measure(&p);
  }
  check_close(sum, 0.5 * v3_norm(area), tol);
}

static void place(const double (*xy)[2], size_t n, double scale, skf_vec3 e, skf_vec3 f, skf_vec3 *v) {
  for (size_t i = 0; i < n; i++) v[i] = v3_scale(scale, v3_add(v3_scale(xy[i][0], e), v3_scale(xy[i][1], f)));
}

static const double ell[][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};
static const double comb[][2] = {{0, 0}, {7, 0}, {7, 3}, {6, 3}, {6, 1}, {5, 1}, {5, 3}, {4, 3},
                                 {4, 1}, {3, 1}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};
static const double flat_corners[][2] = {{0, 0}, {0.1, 0.1}, {0.3, 0.3}, {0.7, 0.7},
                                         {1, 1}, {1, 0.9},   {1, 0.2},   {1, 0}};
static const double spiral[][2] = {{0, 0}, {6, 0}, {6, 6}, {1, 6}, {1, 2}, {4, 2}, {4, 4},
                                   {3, 4}, {3, 3}, {2, 3}, {2, 5}, {5, 5}, {5, 1}, {0, 1}};

static void known_polygons(void **state) {
  (void)state;
  static const struct {
    const char *name;
    const double (*xy)[2];
    size_t n;
  } all[] = {{"an L", ell, 6}, {"a comb", comb, 16}, {"flat corners", flat_corners, 8}, {"a spiral", spiral, 14}};
  uint64_t seed = 5;
  for (size_t i = 0; i < sizeof all / sizeof *all; i++)
    for (int turn = 0; turn < 20; turn++) {
      skf_vec3 v[MOST], n = turn ? rnd_unit(&seed) : v3(0, 0, 1), e = v3_perp(n), f = v3_cross(n, e);
      double scale = turn % 4 == 3 ? 1e-150 : turn % 4 == 2 ? 1e150 : turn % 4 == 1 ? 1e-7 : 1;
      place(all[i].xy, all[i].n, scale, e, f, v);
      if (scale == 1 || scale == 1e-7) check_cover(all[i].name, v, all[i].n, 1e-14);
      unsigned t[MOST][3], u[MOST][3];
      assert_int_equal(skf_polygon_triangulate(v, all[i].n, t, NULL, NULL), SKF_OK);
      for (size_t k = 0; k < all[i].n; k++) v[k] = v3_scale(0x1p20, v[k]);
      assert_int_equal(skf_polygon_triangulate(v, all[i].n, u, NULL, NULL), SKF_OK);
      assert_memory_equal(t, u, (all[i].n - 2) * sizeof *t); /* the size changes nothing */
      for (size_t k = 0; 2 * k < all[i].n; k++) {            /* the other way round */
        skf_vec3 w = v[k];
        v[k] = v[all[i].n - 1 - k], v[all[i].n - 1 - k] = w;
      }
      assert_int_equal(skf_polygon_triangulate(v, all[i].n, t, NULL, NULL), SKF_OK);
    }
}

static void random_stars(void **state) {
  (void)state;
  uint64_t seed = 6;
  for (int round = 0; round < 200; round++) {
    size_t n = 3 + (size_t)rnd(&seed, 0, MOST - 3);
    skf_vec3 v[MOST], m = rnd_unit(&seed), e = v3_perp(m), f = v3_cross(m, e), shift = rnd_vec(&seed, 100);
    for (size_t i = 0; i < n; i++) {
      double phi = 2 * SKF_PI * (double)i / (double)n, r = rnd(&seed, 0.05, 1);
      v[i] = v3_add(shift, v3_add(v3_scale(r * cos(phi), e), v3_scale(r * sin(phi), f)));
    }
    check_cover("a star", v, n, 1e-11); /* the shift costs two digits */
  }
}

static void no_polygons(void **state) {
  (void)state;
  static const struct {
    const char *name, *part;
    size_t n, where;
    skf_vec3 v[8];
  } all[] = {
      {"two vertices", "less than three", 2, 0, {{0, 0, 0}, {1, 0, 0}}},
      {"a line", "zero area", 3, 0, {{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}},
      {"one place", "zero area", 3, 0, {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}},
      {"a bow tie", "touch or cross", 4, 3, {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {3, 2, 0}}},
      {"an even bow tie", "crosses itself", 4, 0, {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}},
      {"a vertex twice", "touch or cross", 4, 2, {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
      {"the first again", "touch or cross", 4, 2, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}}},
      {"a spike", "touch or cross", 5, 3, {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {3, 3, 0}, {1, 1, 0}}},
      {"a vertex on an edge", "touch or cross", 5, 2, {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 0, 0}, {0, 2, 0}}},
      {"not planar", "not planar", 4, 0, {{0, 0, 0}, {1, 0, 0}, {1, 1, 1e-3}, {0, 1, 0}}},
      {"not finite", "not finite", 3, 1, {{0, 0, 0}, {INFINITY, 0, 0}, {1, 1, 0}}},
  };
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
    unsigned t[8][3];
    const char *why = NULL;
    size_t where = 99;
    if (!skf_polygon_triangulate(all[i].v, all[i].n, t, &why, &where)) fail_msg("%s is accepted", all[i].name);
    if (!strstr(why, all[i].part)) fail_msg("%s: '%s'", all[i].name, why);
    assert_true(where < all[i].n);
    if (all[i].where && where != all[i].where) fail_msg("%s: at %zu", all[i].name, where);
  }
}

/* Six digits of a tilted plane are planar enough. */
static void rounded_files(void **state) {
  (void)state;
  const skf_vec3 v[] = {{0, 0, 0}, {1, 0, 0.333333}, {1, 1, 0.666667}, {0, 1, 0.333333}};
  check_cover("six digits", v, 4, 1e-6);
}

static void circles_are_full_arcs(void **state) {
  (void)state;
  uint64_t seed = 7;
  for (int i = 0; i < 50; i++) {
    skf_vec3 n = rnd_unit(&seed), c = rnd_vec(&seed, 3);
    skf_primitive p = {.shape = SKF_ARC, .arc = skf_arc_circle(c, v3_scale(1e5, n), 2)};
    assert_int_equal(skf_primitive_check(&p, NULL), SKF_OK);
    check_close(skf_primitive_measure(&p), 4 * SKF_PI, 1e-15);
    skf_vec3 q = skf_primitive_point(&p, rnd(&seed, 0, 1), 0);
    check_close(v3_dist(q, c), 2.0, 1e-14);
    check_scaled(v3_dot(v3_sub(q, c), n), 0, 1, 1e-14);
  }
  skf_primitive p = {.shape = SKF_ARC, .arc = skf_arc_circle(v3(0, 0, 0), v3(0, 0, 0), 1)};
  assert_int_equal(skf_primitive_check(&p, NULL), SKF_ERR_DEGENERATE);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(known_polygons), cmocka_unit_test(random_stars),          cmocka_unit_test(no_polygons),
      cmocka_unit_test(rounded_files),  cmocka_unit_test(circles_are_full_arcs),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
