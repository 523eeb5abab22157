/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An outline and its holes, by CGAL's constrained Delaunay triangulation with exact predicates. */
#include "adapt/polygon.h"
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <list>
#include <new>
#include <vector>

namespace {

constexpr std::size_t NONE = std::size_t(-1);

struct Number {
  std::size_t of = NONE;
};
struct Depth {
  int of = -1; /* how many rings are around a face */
};

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Triangulation_vertex_base_with_info_2<Number, Kernel>;
using Face =
    CGAL::Constrained_triangulation_face_base_2<Kernel, CGAL::Triangulation_face_base_with_info_2<Depth, Kernel>>;
using Data = CGAL::Triangulation_data_structure_2<Vertex, Face>;
using Cdt = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Data, CGAL::No_constraint_intersection_tag>;

struct Rings {
  std::size_t count;
  const std::size_t *sizes;
  std::vector<Cdt::Vertex_handle> vertex;
  const char *why = nullptr;
  std::size_t where = 0;
};

bool fault(Rings &r, const char *why, std::size_t where) {
  r.why = why, r.where = where;
  return false;
}

bool insert_vertices(Cdt &cdt, const double (*xy)[2], std::size_t n, Rings &r) {
  Cdt::Face_handle near;
  for (std::size_t i = 0; i < n; i++) {
    Cdt::Vertex_handle v = cdt.insert(Kernel::Point_2(xy[i][0], xy[i][1]), near);
    if (v->info().of != NONE) return fault(r, "a polygon with two equal vertices", i);
    v->info().of = i;
    near = v->face();
    r.vertex.push_back(v);
  }
  return true;
}

bool insert_edges(Cdt &cdt, Rings &r) {
  std::size_t first = 0;
  for (std::size_t k = 0; k < r.count; first += r.sizes[k++])
    for (std::size_t i = 0; i < r.sizes[k]; i++) {
      Cdt::Vertex_handle a = r.vertex[first + i], b = r.vertex[first + (i + 1) % r.sizes[k]];
      try {
        cdt.insert_constraint(a, b);
      } catch (const Cdt::Intersection_of_constraints_exception &) {
        return fault(r, "a polygon whose edges touch or cross", first + i);
      }
      if (!cdt.is_edge(a, b)) return fault(r, "a polygon whose edges touch", first + i); /* a vertex lies on it */
    }
  return true;
}

/* Floods the faces from outside; each constrained edge leads one ring deeper. */
void find_depths(Cdt &cdt) {
  std::list<Cdt::Face_handle> now{cdt.infinite_face()}, next;
  for (int depth = 0; !now.empty(); depth++, now.swap(next), next.clear())
    while (!now.empty()) {
      Cdt::Face_handle f = now.front();
      now.pop_front();
      if (f->info().of >= 0) continue;
      f->info().of = depth;
      for (int i = 0; i < 3; i++)
        if (f->neighbor(i)->info().of < 0) (f->is_constrained(i) ? next : now).push_back(f->neighbor(i));
    }
}

/* How many rings are around this one. */
int depth_of(const Cdt &cdt, const Rings &r, std::size_t first) {
  Cdt::Face_handle f;
  int i;
  cdt.is_edge(r.vertex[first], r.vertex[first + 1], f, i);
  return std::min(f->info().of, f->neighbor(i)->info().of);
}

bool check_nesting(const Cdt &cdt, Rings &r) {
  bool enclosed = depth_of(cdt, r, 0) > 0;
  std::size_t first = 0;
  for (std::size_t k = 0; k < r.count; first += r.sizes[k++]) {
    int depth = depth_of(cdt, r, first);
    if (k && depth == 0)
      return fault(r, enclosed ? "a hole around the outline" : "a hole outside of the outline", first);
    if (k && depth > 1) return fault(r, "a hole inside another hole", first);
  }
  return true;
}

skf_status cut(const double (*xy)[2], std::size_t count, const std::size_t *sizes, unsigned (*triangles)[3],
               std::size_t *made, Rings &r) {
  std::size_t n = 0;
  for (std::size_t k = 0; k < count; k++) n += sizes[k];
  Cdt cdt;
  if (!insert_vertices(cdt, xy, n, r) || !insert_edges(cdt, r)) return SKF_ERR_DEGENERATE;
  if (cdt.dimension() < 2) return fault(r, "a polygon of zero area", 0), SKF_ERR_DEGENERATE;
  find_depths(cdt);
  if (!check_nesting(cdt, r)) return SKF_ERR_DEGENERATE;
  for (Cdt::Face_handle f : cdt.finite_face_handles()) {
    if (f->info().of != 1) continue;
    for (int i = 0; i < 3; i++) triangles[*made][i] = unsigned(f->vertex(i)->info().of);
    ++*made;
  }
  return SKF_OK;
}

skf_status cutter(const double (*xy)[2], size_t count, const size_t *sizes, unsigned (*triangles)[3], size_t *made,
                  const char **why, size_t *where) {
  *made = 0;
  try {
    Rings r{count, sizes, {}};
    const skf_status s = cut(xy, count, sizes, triangles, made, r);
    *why = r.why, *where = r.where;
    return s;
  } catch (const std::bad_alloc &) { return SKF_ERR_NOMEM; } catch (...) {
    *why = "a polygon that CGAL refuses", *where = 0;
    return SKF_ERR_DEGENERATE;
  }
}

} // namespace

skf_ring_cutter *polygon_cutter(void) { return cutter; }
