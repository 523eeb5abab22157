/* SPDX-License-Identifier: MIT */
/* Meshes of isosurfaces: topology, distance from the surface, volume against closed forms. */
#include "surface/mesher.h"
#include "worlds.h"
#include <float.h>
#include <string.h>

static const skf_kernel inverse = {SKF_INVERSE, 0}, cauchy = {SKF_CAUCHY, 2.5};

static void mesh_of(const skf_field *f, double iso, double edge, skf_mesh *m, skf_mesh_report *r, skf_mesh_measure *q) {
  skf_mesh_options o = {.edge = edge};
  assert_int_equal(skf_mesh_field(f, iso, &o, m, r), SKF_OK);
  check_sound(m, q);
  signed char *bad = skf_alloc(m->triangle_count, 1);
  size_t crossings;
  assert_int_equal(skf_mesh_crossings(m, bad, &crossings), SKF_OK);
  assert_int_equal(crossings, 0);
  skf_free(bad);
  /* On the surface to rounding, relative to the size of the coordinates. */
  assert_true(r->residual <= 64 * DBL_EPSILON * box_diagonal(q->box));
  assert_int_equal(r->clamped, 0);
}

/* 1/r = iso is a sphere: area and volume come closer with the square of the edge. */
static void sphere_converges(void **state) {
  (void)state;
  skf_element e = world_point(v3(0.1, -0.2, 0.3), inverse);
  skf_field *f = world_field(&e, 1);
  double error[3], R = 1.25, volume = 4 * SKF_PI / 3 * R * R * R;
  for (int k = 0; k < 3; k++) {
    skf_mesh m;
    skf_mesh_report r;
    skf_mesh_measure q;
    mesh_of(f, 1 / R, ldexp(0.4, -k), &m, &r, &q);
    assert_int_equal(q.genus, 0);
    assert_int_equal(q.components, 1);
    check_scaled(q.edge_mean, r.edge, r.edge, 0.12);
    assert_true(q.angle_min > 20 * SKF_PI / 180);
    for (size_t i = 0; i < m.vertex_count; i++) {
      skf_vec3 d = v3_sub(m.vertices[i], e.primitive.point.at);
      check_close(v3_norm(d), R, 8 * DBL_EPSILON);
      check_close(v3_dot(d, m.normals[i]), R, 1e-14);
    }
    error[k] = volume - q.volume;
    skf_mesh_free(&m);
  }
  assert_true(error[2] > 0);
  for (int k = 0; k < 2; k++) check_scaled(error[k] / error[k + 1], 4, 4, 0.15);
  skf_field_free(f);
}

static void cross_has_genus_0(void **state) {
  (void)state;
  skf_element e[2] = {world_segment(v3(-2, 0, 0), v3(2, 0, 0), cauchy),
                      world_segment(v3(0, -2, 0), v3(0, 2, 0), cauchy)};
  skf_field *f = world_field(e, 2);
  skf_mesh m;
  skf_mesh_report r;
  skf_mesh_measure q;
  mesh_of(f, 0.35, 0.15, &m, &r, &q);
  assert_int_equal(q.genus, 0);
  assert_int_equal(q.components, 1);
  skf_mesh_free(&m);
  skf_field_free(f);
}

static void donut_has_genus_1(void **state) {
  (void)state;
  skf_element e = world_arc(1, 2 * SKF_PI, inverse);
  skf_field *f = world_field(&e, 1);
  skf_mesh m;
  skf_mesh_report r;
  skf_mesh_measure q;
  mesh_of(f, 10, 0.06, &m, &r, &q);
  assert_int_equal(q.genus, 1);
  assert_int_equal(q.components, 1);
  skf_mesh_free(&m);
  skf_field_free(f);
}

static void components_are_all_found(void **state) {
  (void)state;
  skf_kernel gauss = {SKF_GAUSSIAN, 3};
  skf_element e[3] = {world_point(v3(0, 0, 0), gauss), world_point(v3(3, 1, 0), gauss),
                      world_point(v3(-2, 0, 2), gauss)};
  e[2].strength = 0.51; /* a small one: radius 0.047 */
  skf_field *f = world_field(e, 3);
  skf_mesh m;
  skf_mesh_report r;
  skf_mesh_measure q;
  mesh_of(f, 0.5, 0, &m, &r, &q);
  assert_int_equal(q.components, 3);
  assert_int_equal(q.euler, 6);
  assert_int_equal(r.missed, 0);
  skf_mesh_free(&m);
  skf_mesh_options coarse = {.edge = 0.3};
  assert_int_equal(skf_mesh_field(f, 0.5, &coarse, &m, &r), SKF_OK);
  assert_int_equal(skf_mesh_measure_of(&m, &q), SKF_OK);
  assert_true(q.components == 3 || r.missed > 0);
  skf_mesh_free(&m);
  skf_field_free(f);
}

/* Where the inside is all around, the mesh encloses the outside: a shell of F < -1 with an island in it. */
static void a_hole_is_meshed(void **state) {
  (void)state;
  skf_element e[2] = {world_point(v3(1, 0, 0), (skf_kernel){SKF_CAUCHY, 1}),
                      world_point(v3(1, 0, 0), (skf_kernel){SKF_GAUSSIAN, 4})};
  e[0].strength = -2, e[1].strength = 1.5;
  for (int n = 1; n <= 2; n++) {
    skf_field *f = world_field(e, (size_t)n);
    skf_mesh m;
    skf_mesh_report r;
    skf_mesh_measure q;
    assert_int_equal(skf_mesh_field(f, -1, &(skf_mesh_options){.edge = 0.05}, &m, &r), SKF_OK);
    assert_true(r.around && r.missed == 0 && r.residual < 1e-14);
    assert_int_equal(skf_mesh_measure_of(&m, &q), SKF_OK);
    assert_true(q.closed && q.manifold && q.oriented && q.volume < 0);
    assert_int_equal(q.components, n);
    for (size_t i = 0; i < m.vertex_count && n == 1; i++) { /* 2 = (1 + r^2)^2 */
      skf_vec3 d = v3_sub(m.vertices[i], v3(1, 0, 0));
      check_close(v3_norm(d), sqrt(sqrt(2) - 1), 1e-14);
      check_close(-v3_dot(d, m.normals[i]), v3_norm(d), 1e-14);
    }
    if (n == 1) check_scaled(q.volume, -4 * SKF_PI / 3 * pow(sqrt(2) - 1, 1.5), 1, 0.01);
    skf_mesh_free(&m), skf_field_free(f);
  }
}

/* Parts far from each other have an edge of their own size, and a lattice of their own where one cannot reach. */
static void far_parts_are_meshed(void **state) {
  (void)state;
  skf_element e[3];
  double R = 0.54119610014619698, ball = 4 * SKF_PI / 3 * R * R * R; /* (1 - r^2)^2 = 1/2 */
  for (int k = 0; k < 3; k++) e[k] = world_point(v3(0, 0, 0), (skf_kernel){SKF_QUARTIC, 1});
  e[2].primitive.point.at = v3(0, 0, 7), e[2].kernel.param = 1e-2;
  for (double far = 1e3; far < 1e8; far *= 100)
    for (int k = 0; k < 2; k++) {
      e[1].primitive.point.at = v3(far, -0.5 * far, 0);
      size_t n = k ? 2 : 3; /* the small one is below the edge that is given */
      skf_field *f = world_field(e, n);
      skf_mesh m;
      skf_mesh_report r;
      skf_mesh_measure q;
      skf_box *boxes;
      size_t count;
      assert_int_equal(skf_mesh_field(f, 0.5, &(skf_mesh_options){.edge = k ? 0.04 : 0}, &m, &r), SKF_OK);
      check_sound(&m, &q);
      assert_int_equal(q.components, n);
      assert_int_equal(q.genus, 0);
      assert_true(r.missed == 0 && r.clamped == 0);
      check_scaled(q.volume, 2 * ball, ball, 0.01);
      assert_int_equal(skf_surface_parts(f, 0.5, &boxes, &count), SKF_OK);
      assert_int_equal(count, n);
      for (size_t i = 0; i < m.vertex_count; i++) {
        int in = 0;
        for (size_t j = 0; j < count; j++) {
          skf_box both = box_add(boxes[j], m.vertices[i]);
          in += !memcmp(&both, boxes + j, sizeof both);
        }
        assert_int_equal(in, 1);
      }
      skf_surface_parts_free(boxes), skf_mesh_free(&m), skf_field_free(f);
    }
}

/* Measures do not overflow before they must. */
static void any_size_is_measured(void **state) {
  (void)state;
  skf_mesh_measure q[3];
  for (int k = 0; k < 3; k++) {
    double s = ldexp(1, 300 * k - 300);
    skf_element e = world_point(v3(0, 0, 0), (skf_kernel){SKF_CAUCHY, 1});
    skf_field *f = world_field(&e, 1);
    skf_mesh m;
    assert_int_equal(skf_mesh_field(f, 0.5, &(skf_mesh_options){.edge = 0.2}, &m, NULL), SKF_OK);
    for (size_t i = 0; i < m.vertex_count; i++) m.vertices[i] = v3_scale(s, m.vertices[i]);
    assert_int_equal(skf_mesh_measure_of(&m, q + k), SKF_OK);
    assert_true(q[k].outward && q[k].degenerate == 0 && isfinite(q[k].area));
    assert_true(q[k].angle_min > 0.3 && q[k].angle_min < 1.05);
    assert_true(q[k].area == ldexp(q[0].area, 600 * k) && q[k].edge_max == ldexp(q[0].edge_max, 300 * k));
    skf_mesh_free(&m), skf_field_free(f);
  }
}

static void refusals_are_clear(void **state) {
  (void)state;
  skf_element e = world_point(v3(0, 0, 0), (skf_kernel){SKF_GAUSSIAN, 1});
  skf_element plane = {{.shape = SKF_PLANE, .plane = {{0, 0, 0}, {0, 0, 1}}}, {SKF_GAUSSIAN, 1}, 1};
  skf_field *f = world_field(&e, 1), *p = world_field(&plane, 1);
  skf_mesh m;
  skf_mesh_report r;
  assert_int_equal(skf_mesh_field(f, 1.5, NULL, &m, &r), SKF_ERR_EMPTY);
  assert_int_equal(skf_mesh_field(p, 0.5, NULL, &m, NULL), SKF_ERR_UNBOUNDED);
  assert_int_equal(skf_mesh_field(f, -0.1, NULL, &m, NULL), SKF_ERR_EMPTY); /* above it everywhere */
  assert_int_equal(skf_mesh_field(f, 0, NULL, &m, NULL), SKF_ERR_UNBOUNDED);
  assert_int_equal(skf_mesh_field(p, -0.1, NULL, &m, NULL), SKF_ERR_EMPTY);
  assert_int_equal(skf_mesh_field(f, 0.5, &(skf_mesh_options){.edge = -1}, &m, NULL), SKF_ERR_RANGE);
  assert_int_equal(skf_mesh_field(f, 0.5, &(skf_mesh_options){.edge = 1e-3, .max_triangles = 1000}, &m, NULL),
                   SKF_ERR_CAPACITY);
  assert_int_equal(skf_mesh_field(f, 0.5, &(skf_mesh_options){.edge = 1e-9}, &m, NULL), SKF_ERR_CAPACITY);
  assert_null(m.vertices);
  skf_field_free(f), skf_field_free(p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sphere_converges),     cmocka_unit_test(cross_has_genus_0),
      cmocka_unit_test(donut_has_genus_1),    cmocka_unit_test(components_are_all_found),
      cmocka_unit_test(refusals_are_clear),   cmocka_unit_test(a_hole_is_meshed),
      cmocka_unit_test(far_parts_are_meshed), cmocka_unit_test(any_size_is_measured),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
