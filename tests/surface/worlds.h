/* SPDX-License-Identifier: MIT */
/* Small bodies that the surface tests share. */
#ifndef SKF_TESTS_SURFACE_WORLDS_H
#define SKF_TESTS_SURFACE_WORLDS_H

#include "skelfield/surface.h"
#include "check.h"
#include "core/vec3.h"

static inline skf_element world_point(skf_vec3 at, skf_kernel k) {
  return (skf_element){{.shape = SKF_POINT, .point = {at}}, k, 1};
}
static inline skf_element world_segment(skf_vec3 a, skf_vec3 b, skf_kernel k) {
  return (skf_element){{.shape = SKF_SEGMENT, .segment = {a, b}}, k, 1};
}
static inline skf_element world_arc(double radius, double sweep, skf_kernel k) {
  return (skf_element){{.shape = SKF_ARC, .arc = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, radius, sweep}}, k, 1};
}
static inline skf_element world_triangle(skf_vec3 a, skf_vec3 b, skf_vec3 c, skf_kernel k) {
  return (skf_element){{.shape = SKF_TRIANGLE, .triangle = {{a, b, c}}}, k, 1};
}

static inline skf_field *world_field(const skf_element *e, size_t n) {
  skf_field *f = NULL;
  assert_int_equal(skf_field_new(e, n, &f), SKF_OK);
  return f;
}

/* Fails unless the mesh is what the mesher promises. */
static inline void check_sound(const skf_mesh *m, skf_mesh_measure *q) {
  assert_int_equal(skf_mesh_measure_of(m, q), SKF_OK);
  assert_true(m->triangle_count > 0);
  assert_true(q->closed && q->manifold && q->oriented && q->outward);
  assert_int_equal(q->degenerate + q->duplicates + q->unused_vertices, 0);
}

#endif
