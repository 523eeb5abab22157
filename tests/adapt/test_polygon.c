/* SPDX-License-Identifier: MIT */
/* Polygons with holes, cut by CGAL: areas, fields, any orientation and plane, and what is refused at which vertex. */
#include "adapt/check.h"
#include "adapt/polygon.h"
#include "check.h"
#include "random.h"
#include "skelfield/scene.h"
#include <string.h>

enum { MOST = 4000 };
static unsigned triangles[MOST][3];

static bool has_cgal(void) {
  if (polygon_cutter()) return true;
  print_message("no CGAL in this build\n");
  skip();
  return false;
}

/* A random place: an orthonormal frame and an origin. */
typedef struct frame {
  skf_vec3 o, e, f;
} frame;

static frame random_frame(uint64_t *seed) {
  frame a = {rnd_vec(seed, 3), rnd_unit(seed), {0, 0, 0}};
  skf_vec3 n = v3_perp(a.e);
  a.f = v3_cross(n, a.e);
  return a;
}

static skf_vec3 place(const frame *a, double x, double y) { return v3_mad(v3_mad(a->o, x, a->e), y, a->f); }

/* A star-shaped ring, counter-clockwise or not. */
static void ring(const frame *a, uint64_t *seed, double x, double y, double r, size_t n, bool back, skf_vec3 *out) {
  for (size_t i = 0; i < n; i++) {
    double phi = 2 * SKF_PI * (double)(back ? n - 1 - i : i) / (double)n, q = r * rnd(seed, 0.6, 1);
    out[i] = place(a, x + q * cos(phi), y + q * sin(phi));
  }
}

static double area_of(const skf_vec3 *v, size_t n) {
  skf_vec3 sum = {0, 0, 0};
  for (size_t i = 0; i < n; i++) sum = v3_add(sum, v3_cross(v3_sub(v[i], v[0]), v3_sub(v[(i + 1) % n], v[0])));
  return 0.5 * v3_norm(sum);
}

static skf_field *field_of(const skf_vec3 *v, size_t n, double strength) {
  skf_element *e = calloc(n, sizeof *e);
  for (size_t i = 0; i < n; i++)
    e[i] = (skf_element){
        {.shape = SKF_TRIANGLE, .triangle.vertices = {v[triangles[i][0]], v[triangles[i][1]], v[triangles[i][2]]}},
        {SKF_CAUCHY, 1.5},
        strength};
  skf_field *f;
  assert_int_equal(skf_field_new(e, n, &f), SKF_OK);
  free(e);
  return f;
}

/* Outline minus holes, each by ears: the same area and the same field. */
static void holes(void **state) {
  (void)state;
  if (!has_cgal()) return;
  uint64_t seed = 31;
  for (int round = 0; round < 30; round++) {
    frame a = random_frame(&seed);
    size_t sizes[4] = {40 + (size_t)round, 5, 12, 3}, n = 0, made;
    static skf_vec3 v[200];
    static const double at[4][3] = {{0, 0, 2}, {0.5, 0.3, 0.3}, {-0.5, -0.2, 0.3}, {0.1, -0.7, 0.2}};
    for (int k = 0; k < 4; n += sizes[k++])
      ring(&a, &seed, at[k][0], at[k][1], at[k][2], sizes[k], rnd(&seed, 0, 1) < 0.5, v + n);
    const char *why;
    size_t where;
    skf_status s = skf_polygon_cut(v, 4, sizes, polygon_cutter(), triangles, &made, &why, &where);
    if (s) fail_msg("round %d: %s at %zu", round, why, where);
    assert_int_equal(made, n + 2 * 3 - 2);
    double area = 0, want = area_of(v, sizes[0]);
    skf_vec3 up = {0, 0, 0}, side;
    for (size_t i = 0; i < sizes[0]; i++)
      up = v3_add(up, v3_cross(v3_sub(v[i], v[0]), v3_sub(v[(i + 1) % sizes[0]], v[0])));
    for (size_t i = 0; i < made; i++) {
      const unsigned *t = triangles[i];
      side = v3_cross(v3_sub(v[t[1]], v[t[0]]), v3_sub(v[t[2]], v[t[0]]));
      assert_true(v3_dot(side, up) > 0);
      area += 0.5 * v3_norm(side);
    }
    skf_field *all[5];
    all[0] = field_of(v, made, 1);
    for (size_t k = 0, first = 0; k < 4; first += sizes[k++]) {
      assert_int_equal(skf_polygon_triangulate(v + first, sizes[k], triangles, NULL, NULL), SKF_OK);
      all[k + 1] = field_of(v + first, sizes[k] - 2, k ? -1 : 1);
      if (k) want -= area_of(v + first, sizes[k]);
    }
    check_close(area, want, 1e-13);
    for (int i = 0; i < 10; i++) {
      skf_vec3 x = v3_add(a.o, rnd_vec(&seed, 2)), g, part;
      double F = skf_field_at(all[0], x, &g), sum = 0;
      skf_vec3 G = {0, 0, 0};
      for (int k = 1; k < 5; k++) sum += skf_field_at(all[k], x, &part), G = v3_add(G, part);
      check_scaled(F, sum, skf_field_at(all[1], x, &part), 1e-13);
      check_scaled(v3_dist(g, G), 0, v3_norm(part) + skf_field_at(all[1], x, NULL), 1e-12);
    }
    for (int k = 0; k < 5; k++) skf_field_free(all[k]);
  }
}

/* By ears or by CGAL: the field of a polygon is the same. */
static void triangulations_agree(void **state) {
  (void)state;
  if (!has_cgal()) return;
  uint64_t seed = 32;
  for (int round = 0; round < 20; round++) {
    frame a = random_frame(&seed);
    size_t n = 5 + (size_t)round * 3, made;
    skf_vec3 v[100];
    ring(&a, &seed, 0, 0, 1, n, round % 2, v);
    assert_int_equal(skf_polygon_cut(v, 1, &n, polygon_cutter(), triangles, &made, NULL, NULL), SKF_OK);
    assert_int_equal(made, n - 2);
    skf_field *cgal = field_of(v, made, 1);
    assert_int_equal(skf_polygon_triangulate(v, n, triangles, NULL, NULL), SKF_OK);
    skf_field *ears = field_of(v, n - 2, 1);
    for (int i = 0; i < 10; i++) {
      skf_vec3 x = v3_add(a.o, rnd_vec(&seed, 1)), g, h;
      double F = skf_field_at(cgal, x, &g), want = skf_field_at(ears, x, &h);
      check_close(F, want, 1e-13);
      check_scaled(v3_dist(g, h), 0, v3_norm(h) + want, 1e-13);
    }
    skf_field_free(cgal), skf_field_free(ears);
  }
}

static void faults(void **state) {
  (void)state;
  if (!has_cgal()) return;
#define SQUARE(x, y, r)                                                                                                \
  {x - r, y - r, 0}, {x + r, y - r, 0}, {x + r, y + r, 0}, { x - r, y + r, 0 }
  static const struct {
    const char *why;
    size_t where, rings, sizes[3];
    skf_vec3 v[16];
  } all[] = {
      {"a hole outside of the outline", 4, 2, {4, 4}, {SQUARE(0, 0, 2), SQUARE(5, 0, 1)}},
      {"a hole around the outline", 4, 2, {4, 4}, {SQUARE(0, 0, 2), SQUARE(0, 0, 3)}},
      {"a hole inside another hole", 8, 3, {4, 4, 4}, {SQUARE(0, 0, 3), SQUARE(0, 0, 2), SQUARE(0, 0, 1)}},
      {"a polygon whose edges touch or cross", 8, 3, {4, 4, 4}, {SQUARE(0, 0, 4), SQUARE(0, 0, 1), SQUARE(1, 0.5, 1)}},
      {"a polygon whose edges touch or cross", 4, 2, {4, 4}, {SQUARE(0, 0, 2), SQUARE(2, 0, 1)}},
      {"a polygon whose edges touch", 1, 2, {4, 4}, {SQUARE(0, 0, 2), SQUARE(1, 0, 1)}},
      {"a polygon with two equal vertices",
       7,
       2,
       {4, 4},
       {SQUARE(0, 0, 2), {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 2, 0}}},
      {"a polygon with two equal vertices", 4, 2, {4, 4}, {SQUARE(0, 0, 2), SQUARE(0, 0, 2)}},
      {"a polygon whose edges touch or cross", 3, 1, {4}, {{0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {2, 2.5, 0}}},
      {"a polygon that is not planar", 6, 2, {4, 4}, {SQUARE(0, 0, 2), {0, 0, 0}, {1, 0, 0}, {1, 1, 0.1}, {0, 1, 0}}},
      {"a ring with less than three vertices", 4, 2, {4, 2}, {SQUARE(0, 0, 2), {0, 0, 0}, {1, 0, 0}}},
      {"a polygon of zero area, or one that crosses itself", 0, 1, {3}, {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}},
      {"a number is not finite", 1, 1, {3}, {{0, 0, 0}, {INFINITY, 1, 1}, {2, 2, 0}}},
  };
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
    const char *why = NULL;
    size_t where = 99, made;
    skf_status s =
        skf_polygon_cut(all[i].v, all[i].rings, all[i].sizes, polygon_cutter(), triangles, &made, &why, &where);
    if (s == SKF_OK || strcmp(why, all[i].why) != 0 || where != all[i].where)
      fail_msg("case %zu: '%s' at %zu, expected '%s' at %zu", i, why ? why : "accepted", where, all[i].why,
               all[i].where);
  }
}

/* Exact: a hole's corner 1e-15 off the outline's slanted edge is inside, or outside, or on it. */
static void exactness(void **state) {
  (void)state;
  if (!has_cgal()) return;
  skf_vec3 v[6] = {{0, 0, 0}, {3, 3, 0}, {0, 4, 0}, {1, 1, 0}, {1, 2, 0}, {0.5, 2, 0}};
  size_t sizes[2] = {3, 3}, made;
  const char *why;
  assert_int_equal(skf_polygon_cut(v, 2, sizes, polygon_cutter(), triangles, &made, &why, NULL), SKF_ERR_DEGENERATE);
  assert_string_equal(why, "a polygon whose edges touch");
  v[3].y = nextafter(1, 2);
  assert_int_equal(skf_polygon_cut(v, 2, sizes, polygon_cutter(), triangles, &made, &why, NULL), SKF_OK);
  v[3].y = nextafter(1, 0);
  assert_int_equal(skf_polygon_cut(v, 2, sizes, polygon_cutter(), triangles, &made, &why, NULL), SKF_ERR_DEGENERATE);
  assert_string_equal(why, "a polygon whose edges touch or cross");
}

#define SCENE                                                                                                          \
  "skelfield: 1\nbodies:\n- name: a\n  iso: 1\n  kernel: {type: inverse}\n  skeleton:\n"                               \
  "  - polygon:\n      vertices: [[-2, -2, 1], [2, -2, 1], [2, 2, 1], [-2, 2, 1]]\n      holes:\n"
static const char good[] = SCENE "      - [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]\n"
                                 "      - [[-1, -1, 1], [-0.5, -1, 1], [-1, -0.5, 1]]\n";

static void scenes(void **state) {
  (void)state;
  skf_scene *s;
  skf_error e;
  assert_int_equal(skf_scene_parse(good, sizeof good - 1, ".", &s, &e), SKF_ERR_UNSUPPORTED);
  assert_int_equal(e.line, 10);
  assert_string_equal(e.text, "holes need CGAL, which this build has not, expected a polygon without holes");
  if (!has_cgal()) return;
  const skf_scene_hooks hooks = {polygon_cutter()};
  if (skf_scene_parse_with(good, sizeof good - 1, ".", &hooks, &s, &e)) fail_msg("line %ld: %s", e.line, e.text);
  double area = 0;
  assert_int_equal(s->bodies[0].element_count, 4 + 4 + 3 + 4 - 2);
  for (size_t i = 0; i < s->bodies[0].element_count; i++)
    area += skf_primitive_measure(&s->bodies[0].elements[i].primitive);
  check_close(area, 16 - 1 - 0.125, 1e-15);
  skf_scene_free(s);
  static const struct {
    const char *text, *want;
    long line;
  } bad[] = {
      {SCENE
       "      - [[0, 0, 1], [1, 0, 1], [1, 1, 1]]\n      - - [0.2, 0.1, 1]\n        - [0.3, 0.1, 1]\n        - [0.2, "
       "0.15, 1]\n",
       "a hole inside another hole (vertex 1 of hole 2), expected a simple and planar polygon with its holes apart "
       "inside",
       11},
      {SCENE "      - - [0, 0, 1]\n        - [1, 0, 1]\n        - [0, 1, 1.5]\n",
       "a polygon that is not planar (vertex 3 of hole 1), expected a simple and planar polygon with its holes apart "
       "inside",
       12},
      {SCENE "      - [[0, 0, 1], [1, 0, 1]]\n", "2 vertices of a hole, expected at least 3", 10},
      {SCENE "      - 3\n", "a hole is '3', expected a list of points [x, y, z]", 10},
      {SCENE "      - [[0, 0, 1], [1, 0, 1], [1, 0]]\n", "a point has 2 entries, expected [x, y, z]", 10},
  };
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    assert_true(skf_scene_parse_with(bad[i].text, strlen(bad[i].text), ".", &hooks, &s, &e) != SKF_OK);
    assert_string_equal(e.text, bad[i].want);
    assert_int_equal(e.line, bad[i].line);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(holes),  cmocka_unit_test(triangulations_agree),
      cmocka_unit_test(faults), cmocka_unit_test(exactness),
      cmocka_unit_test(scenes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
