/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Triangles of a skeleton that overlap or cross, with exact arithmetic. */
#include "adapt/check.h"
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <algorithm>
#include <numeric>
#include <vector>

namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Point = Kernel::Point_3;
using Segment = Kernel::Segment_3;
using Triangle = Kernel::Triangle_3;

Triangle triangle_of(const skf_vec3 *p) {
  return Triangle(Point(p[0].x, p[0].y, p[0].z), Point(p[1].x, p[1].y, p[1].z), Point(p[2].x, p[2].y, p[2].z));
}

bool strictly_inside(const Triangle &t, const Point &p) {
  for (int k = 0; k < 3; k++)
    if (Segment(t[k], t[k + 1]).has_on(p)) return false;
  return true; /* p is on t */
}

/* 0: they share at most edges and corners, 1: their interiors cross along a line, 2: they share an area. */
int relation(const Triangle &a, const Triangle &b) {
  if (!CGAL::do_intersect(a, b)) return 0;
  const auto shared = CGAL::intersection(a, b);
  if (!shared) return 0;
  if (boost::get<Triangle>(&*shared) || boost::get<std::vector<Point>>(&*shared)) return 2;
  const Segment *s = boost::get<Segment>(&*shared);
  if (!s) return 0;
  const Point middle = CGAL::midpoint(s->source(), s->target());
  return strictly_inside(a, middle) && strictly_inside(b, middle);
}

struct Span {
  double lo[3], hi[3];
};

Span span_of(const skf_vec3 *p) {
  const double x[3][3] = {{p[0].x, p[1].x, p[2].x}, {p[0].y, p[1].y, p[2].y}, {p[0].z, p[1].z, p[2].z}};
  Span s;
  for (int k = 0; k < 3; k++) {
    s.lo[k] = std::min({x[k][0], x[k][1], x[k][2]});
    s.hi[k] = std::max({x[k][0], x[k][1], x[k][2]});
  }
  return s;
}

bool apart(const Span &a, const Span &b) {
  for (int k = 1; k < 3; k++)
    if (a.hi[k] < b.lo[k] || b.hi[k] < a.lo[k]) return true;
  return false;
}

/* Sweep along x: only triangles whose boxes meet are looked at. */
void sweep(std::size_t n, const skf_vec3 (*corners)[3], std::size_t capacity, check_pair *pairs, std::size_t &count) {
  std::vector<Span> spans(n);
  std::vector<std::size_t> order(n);
  for (std::size_t i = 0; i < n; i++) spans[i] = span_of(corners[i]);
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return spans[a].lo[0] != spans[b].lo[0] ? spans[a].lo[0] < spans[b].lo[0] : a < b;
  });
  for (std::size_t i = 0; i < n; i++) {
    const Triangle first = triangle_of(corners[order[i]]);
    for (std::size_t j = i + 1; j < n && spans[order[j]].lo[0] <= spans[order[i]].hi[0]; j++) {
      if (apart(spans[order[i]], spans[order[j]])) continue;
      const int kind = relation(first, triangle_of(corners[order[j]]));
      if (kind == 0) continue;
      if (count < capacity) pairs[count] = {std::min(order[i], order[j]), std::max(order[i], order[j]), kind == 2};
      count++;
    }
  }
}

} // namespace

skf_status check_triangles(size_t n, const skf_vec3 (*corners)[3], size_t capacity, check_pair *pairs, size_t *count) {
  *count = 0;
  try {
    sweep(n, corners, capacity, pairs, *count);
    return SKF_OK;
  } catch (...) { return SKF_ERR_NOMEM; }
}
