/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The report on a mesh, by CGAL's Polygon Mesh Processing. */
#include "adapt/check.h"
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Polygon_mesh_processing/shape_predicates.h>
#include <CGAL/Surface_mesh.h>
#include <array>
#include <new>
#include <utility>
#include <vector>

namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;
using Polygon = std::vector<std::size_t>;

struct Soup {
  std::vector<Point> points;
  std::vector<Polygon> polygons;
};

/* Vertices that no triangle uses are left out; so are triangles with a repeated vertex, which are counted. */
Soup soup_of(const skf_mesh &mesh, std::size_t &repeated) {
  Soup soup;
  std::vector<std::size_t> number(mesh.vertex_count, mesh.vertex_count);
  for (std::size_t t = 0; t < mesh.triangle_count; t++) {
    const unsigned *v = mesh.triangles[t];
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
      repeated++;
      continue;
    }
    Polygon polygon(3);
    for (int k = 0; k < 3; k++) {
      std::size_t &n = number[v[k]];
      if (n == mesh.vertex_count) {
        n = soup.points.size();
        const skf_vec3 &p = mesh.vertices[v[k]];
        soup.points.emplace_back(p.x, p.y, p.z);
      }
      polygon[std::size_t(k)] = n;
    }
    soup.polygons.push_back(polygon);
  }
  return soup;
}

std::size_t crossings(const Mesh &mesh) {
  std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> pairs;
  pmp::self_intersections(mesh, std::back_inserter(pairs));
  return pairs.size();
}

void measure(Mesh &mesh, check_mesh_report &out) {
  auto component = mesh.add_property_map<Mesh::Face_index, std::size_t>("f:component", 0).first;
  out.components = pmp::connected_components(mesh, component);
  out.euler = long(mesh.number_of_vertices()) - long(mesh.number_of_edges()) + long(mesh.number_of_faces());
  out.area = CGAL::to_double(pmp::area(mesh));
  out.closed = CGAL::is_closed(mesh);
  for (Mesh::Face_index f : mesh.faces()) out.degenerate += pmp::is_degenerate_triangle_face(f, mesh);
  if (!out.closed) return;
  out.genus = long(out.components) - out.euler / 2;
  out.volume = CGAL::to_double(pmp::volume(mesh));
  out.outward = pmp::is_outward_oriented(mesh);
  if (!out.self_intersections && !out.degenerate) out.bounds = pmp::does_bound_a_volume(mesh);
}

void report(const skf_mesh &mesh, check_mesh_report &out) {
  Soup soup = soup_of(mesh, out.degenerate);
  out.mesh = !out.degenerate && pmp::is_polygon_soup_a_polygon_mesh(soup.polygons);
  /* What is not a mesh is cut apart where it is not, so that its crossings can be counted all the same. */
  if (!out.mesh) pmp::orient_polygon_soup(soup.points, soup.polygons);
  Mesh built;
  pmp::polygon_soup_to_polygon_mesh(soup.points, soup.polygons, built);
  out.self_intersections = crossings(built);
  if (out.mesh) measure(built, out);
}

} // namespace

bool check_available(void) { return true; }

skf_status check_mesh(const skf_mesh *mesh, check_mesh_report *out) {
  *out = check_mesh_report{};
  try {
    report(*mesh, *out);
    return SKF_OK;
  } catch (const std::bad_alloc &) { return SKF_ERR_NOMEM; } catch (...) {
    return SKF_ERR_DEGENERATE; /* CGAL's preconditions */
  }
}
