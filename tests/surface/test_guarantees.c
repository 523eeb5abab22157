/* SPDX-License-Identifier: MIT */
/* What the mesher promises, on every kernel and shape, on ties, at any scale, with any number of threads, and where the
   lattice is much too coarse for the surface. */
#include "surface/mesher.h"
#include "worlds.h"
#include <omp.h>
#include <string.h>

static void check_no_crossings(const skf_mesh *m) {
  signed char *bad = skf_alloc(m->triangle_count, 1);
  size_t crossings = 1;
  assert_int_equal(skf_mesh_crossings(m, bad, &crossings), SKF_OK);
  skf_free(bad);
  assert_int_equal(crossings, 0);
}

/* Every pair meshes; the iso value is taken a little off the skeleton, so that there is a surface there. */
static void every_kernel_and_shape(void **state) {
  (void)state;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = 0; s < SKF_PLANE; s++) {
      const skf_kernel_info *info = skf_kernel_get((skf_kernel_type)k);
      skf_kernel kernel = {(skf_kernel_type)k, info->compact ? 1.0 : info->param ? 2.0 : 0};
      skf_element e[SKF_PLANE] = {world_point(v3(0.1, 0.2, 0.3), kernel),
                                  world_segment(v3(-1, 0, 0), v3(1, 0.5, 0.2), kernel), world_arc(1, 4, kernel),
                                  world_triangle(v3(0, 0, 0), v3(1.5, 0, 0.2), v3(0.3, 1.2, 0), kernel)};
      skf_field *f = world_field(e + s, 1);
      skf_vec3 near = v3_add(skf_primitive_point(&e[s].primitive, 0.5, 0.5), v3(0, 0, 0.3));
      double iso = skf_field_at(f, near, NULL);
      skf_mesh m;
      skf_mesh_report r;
      skf_mesh_measure q;
      skf_status status = skf_mesh_field(f, iso, &(skf_mesh_options){.edge = 0.15}, &m, &r);
      if (status) fail_msg("%s on %s: %s", info->name, skf_shape_get((skf_shape)s)->name, skf_status_text(status));
      check_sound(&m, &q);
      check_no_crossings(&m);
      if (q.components != 1 || q.genus != 0)
        fail_msg("%s on %s: %zu components, genus %ld", info->name, skf_shape_get((skf_shape)s)->name, q.components,
                 q.genus);
      assert_true(r.residual <= 1e-13);
      skf_mesh_free(&m), skf_field_free(f);
    }
}

/* The iso value is exactly what the field has at a node of the lattice: a tie there, and no promise is broken. */
static void ties_are_decided(void **state) {
  (void)state;
  skf_kernel gauss = {SKF_GAUSSIAN, 1.5};
  skf_element e[2] = {world_point(v3(0, 0, 0), gauss), world_point(v3(1.1, 0, 0), gauss)};
  skf_field *f = world_field(e, 2);
  static const skf_progress quiet = {NULL, NULL};
  int warped = 0;
  for (int k = 0; k < 24; k++) {
    skf_mesher m = {.field = f, .progress = &quiet, .limit = 1000000, .region = {{-2, -2, -2}, {3, 2, 2}}};
    assert_int_equal(skf_lattice_set(&m.lattice, m.region, 0.2), SKF_OK);
    int x[3];
    for (int j = 0; j < 3; j++)
      x[j] = 2 * (int)floor((v3_get(v3(0.2, 0.6, 0.1 + 0.03 * k), j) - v3_get(m.lattice.origin, j)) /
                            (2 * m.lattice.half)) +
             k % 2;
    /* In batches, as the mesher does: the tie must hold to the last bit. */
    skf_vec3 p = skf_lattice_at(&m.lattice, skf_key_of(x));
    assert_int_equal(skf_sample(f, 1, &p, &m.iso, NULL), SKF_OK);
    skf_mesh mesh;
    skf_mesh_measure q;
    assert_int_equal(skf_mesher_cells(&m), SKF_OK);
    assert_int_equal(skf_mesher_cuts(&m), SKF_OK);
    unsigned node = skf_nodes_find(&m.nodes, skf_key_of(x));
    assert_int_not_equal(node, SKF_NONE);
    assert_true(m.nodes.F[node] == m.iso);
    assert_int_equal(skf_mesher_warp(&m), SKF_OK);
    warped += m.nodes.zero[node];
    assert_int_equal(m.clamped, 0);
    assert_int_equal(skf_mesher_extract(&m, &mesh), SKF_OK);
    check_sound(&mesh, &q);
    check_no_crossings(&mesh);
    assert_int_equal(q.genus, 0);
    skf_mesher_free(&m), skf_mesh_free(&mesh);
  }
  assert_int_equal(warped, 24); /* the node itself becomes the vertex */
  skf_field_free(f);
}

/* Whichever allocation fails, the call says so and leaves nothing behind. */
static void memory_may_run_out(void **state) {
  (void)state;
  skf_element e = world_point(v3(0, 0, 0), (skf_kernel){SKF_GAUSSIAN, 1});
  skf_field *f = world_field(&e, 1);
  skf_mesh_options o = {.edge = 0.5};
  skf_status s = SKF_ERR_NOMEM;
  long k = 0;
  omp_set_num_threads(1);
  while (s == SKF_ERR_NOMEM) {
    skf_mesh m;
    skf_alloc_fail_after(++k);
    s = skf_mesh_field(f, 0.5, &o, &m, NULL);
    skf_alloc_fail_after(0);
    if (s == SKF_ERR_NOMEM) assert_null(m.vertices);
    skf_mesh_free(&m);
  }
  assert_int_equal(s, SKF_OK);
  assert_true(k > 50);
  skf_field_free(f);
}

/* The 1/r field of a scaled body is the scaled field: the same triangles, scaled vertices. */
static void scale_does_not_matter(void **state) {
  (void)state;
  static const double scales[3] = {1, 1e-7, 1e7};
  skf_mesh m[3];
  for (int k = 0; k < 3; k++) {
    double s = scales[k];
    skf_kernel inverse = {SKF_INVERSE, 0};
    skf_element e[2] = {world_arc(s, 2 * SKF_PI, inverse), world_segment(v3(0, 0, s), v3(0.5 * s, 0, 2 * s), inverse)};
    skf_field *f = world_field(e, 2);
    /* Length has measure and 1/r has none: F does not change with the scale. */
    assert_int_equal(skf_mesh_field(f, 7, &(skf_mesh_options){.edge = 0.08 * s}, m + k, NULL), SKF_OK);
    skf_field_free(f);
  }
  for (int k = 1; k < 3; k++) {
    assert_int_equal(m[k].triangle_count, m[0].triangle_count);
    assert_memory_equal(m[k].triangles, m[0].triangles, m[0].triangle_count * sizeof *m[0].triangles);
    for (size_t i = 0; i < m[0].vertex_count; i++) {
      skf_vec3 p = v3_scale(1 / scales[k], m[k].vertices[i]);
      assert_true(v3_dist(p, m[0].vertices[i]) <= 1e-11);
    }
  }
  for (int k = 0; k < 3; k++) skf_mesh_free(m + k);
}

static void threads_do_not_matter(void **state) {
  (void)state;
  skf_element e[2] = {world_segment(v3(-2, 0, 0), v3(2, 0, 0), (skf_kernel){SKF_CAUCHY, 2.5}),
                      world_arc(1, 5, (skf_kernel){SKF_CAUCHY, 2})};
  skf_field *f = world_field(e, 2);
  skf_mesh m[3];
  for (int k = 0; k < 3; k++) {
    omp_set_num_threads(1 + 2 * k);
    assert_int_equal(skf_mesh_field(f, 0.35, NULL, m + k, NULL), SKF_OK);
    assert_int_equal(m[k].vertex_count, m[0].vertex_count);
    assert_int_equal(m[k].triangle_count, m[0].triangle_count);
    assert_memory_equal(m[k].vertices, m[0].vertices, m[0].vertex_count * sizeof *m[0].vertices);
    assert_memory_equal(m[k].normals, m[0].normals, m[0].vertex_count * sizeof *m[0].normals);
    assert_memory_equal(m[k].triangles, m[0].triangles, m[0].triangle_count * sizeof *m[0].triangles);
  }
  for (int k = 0; k < 3; k++) skf_mesh_free(m + k);
  skf_field_free(f);
}

/* Crowds of points of both signs, with edges as long as their features: topology may be wrong, the mesh is sound. */
static void too_coarse_is_still_sound(void **state) {
  (void)state;
  unsigned long seed = 12345;
  size_t triangles = 0;
  for (int k = 0; k < 12; k++) {
    enum { N = 60 };
    skf_element e[N];
    for (int i = 0; i < N; i++) {
      double x[4];
      for (int j = 0; j < 4; j++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        x[j] = (double)(seed >> 33) / 2147483648.0;
      }
      e[i] = world_point(v3(2 * x[0] - 1, 2 * x[1] - 1, 2 * x[2] - 1), (skf_kernel){SKF_GAUSSIAN, 4 + k % 5});
      e[i].strength = x[3] < 0.3 ? -1 : 1;
    }
    skf_field *f = world_field(e, N);
    skf_mesh m;
    skf_mesh_report r;
    skf_mesh_measure q;
    assert_int_equal(skf_mesh_field(f, 0.4, &(skf_mesh_options){.edge = 0.08 + 0.01 * (k % 9)}, &m, &r), SKF_OK);
    check_sound(&m, &q);
    check_no_crossings(&m);
    assert_true(r.residual <= 1e-13 || r.clamped > 0);
    triangles += m.triangle_count;
    skf_mesh_free(&m), skf_field_free(f);
  }
  assert_true(triangles > 10000);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_kernel_and_shape),    cmocka_unit_test(ties_are_decided),
      cmocka_unit_test(scale_does_not_matter),     cmocka_unit_test(threads_do_not_matter),
      cmocka_unit_test(too_coarse_is_still_sound), cmocka_unit_test(memory_may_run_out),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
