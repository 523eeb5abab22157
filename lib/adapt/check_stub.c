/* SPDX-License-Identifier: MIT */
/* In place of CGAL, where the build has none. */
#include "adapt/check.h"

bool check_available(void) { return false; }

skf_status check_mesh(const skf_mesh *mesh, check_mesh_report *out) {
  (void)mesh;
  *out = (check_mesh_report){0};
  return SKF_ERR_UNSUPPORTED;
}

skf_status check_tree_new(const skf_mesh *mesh, check_tree **out) {
  (void)mesh;
  *out = NULL;
  return SKF_ERR_UNSUPPORTED;
}

void check_tree_free(check_tree *tree) { (void)tree; }

skf_status check_tree_all(const check_tree *tree, skf_vec3 origin, skf_vec3 direction, size_t capacity, double *t,
                          size_t *count) {
  (void)tree, (void)origin, (void)direction, (void)capacity, (void)t;
  *count = 0;
  return SKF_ERR_UNSUPPORTED;
}

skf_status check_triangles(size_t n, const skf_vec3 (*corners)[3], size_t capacity, check_pair *pairs, size_t *count) {
  (void)n, (void)corners, (void)capacity, (void)pairs;
  *count = 0;
  return SKF_ERR_UNSUPPORTED;
}
