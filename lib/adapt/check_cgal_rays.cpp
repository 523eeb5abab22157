/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rays against a mesh, by CGAL's AABB tree. */
#include "adapt/check.h"
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <algorithm>
#include <cmath>
#include <new>
#include <vector>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Triangle = Kernel::Triangle_3;
using Triangles = std::vector<Triangle>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Point point_of(const skf_vec3 &p) { return Point(p.x, p.y, p.z); }

} // namespace

struct check_tree {
  Triangles triangles;
  Tree tree;
};

skf_status check_tree_new(const skf_mesh *mesh, check_tree **out) {
  *out = nullptr;
  try {
    check_tree *t = new check_tree;
    *out = t;
    for (std::size_t i = 0; i < mesh->triangle_count; i++) {
      const unsigned *v = mesh->triangles[i];
      Triangle triangle(point_of(mesh->vertices[v[0]]), point_of(mesh->vertices[v[1]]), point_of(mesh->vertices[v[2]]));
      if (!triangle.is_degenerate()) t->triangles.push_back(triangle);
    }
    t->tree.insert(t->triangles.cbegin(), t->triangles.cend());
    t->tree.build();
    return SKF_OK;
  } catch (...) {
    delete *out;
    *out = nullptr;
    return SKF_ERR_NOMEM;
  }
}

void check_tree_free(check_tree *tree) { delete tree; }

skf_status check_tree_all(const check_tree *tree, skf_vec3 origin, skf_vec3 direction, size_t capacity, double *t,
                          size_t *count) {
  *count = 0;
  try {
    using Hit = Tree::Intersection_and_primitive_id<Kernel::Ray_3>::Type;
    std::vector<Hit> hits;
    std::vector<double> found;
    Point from = point_of(origin);
    Kernel::Vector_3 along(direction.x, direction.y, direction.z);
    tree->tree.all_intersections(Kernel::Ray_3(from, along), std::back_inserter(hits));
    double length = std::sqrt(along.squared_length());
    for (const Hit &hit : hits)
      if (const Point *p = boost::get<Point>(&hit.first)) found.push_back((*p - from) * along / length);
    std::sort(found.begin(), found.end());
    for (std::size_t i = 0; i < found.size() && i < capacity; i++) t[i] = found[i];
    *count = found.size();
    return SKF_OK;
  } catch (...) { return SKF_ERR_NOMEM; }
}
