/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks of a mesh by itself: the library counts edges, CGAL does the exact geometry. */
#include "adapt/check.h"
#include "core/vec3.h"
#include "validate.h"
#include <math.h>
#include <stdlib.h>

static void topology(const skf_mesh_measure *q, section *s) {
  section_check(s, "closed", q->closed, "%zu edges with one triangle", q->boundary_edges);
  section_check(s, "manifold", q->manifold, "%zu edges with more than two triangles, %zu vertices with several fans",
                q->nonmanifold_edges, q->nonmanifold_vertices);
  section_check(s, "oriented", q->oriented, "%zu edges whose two triangles disagree", q->misoriented_edges);
  section_check(s, "no duplicates", q->duplicates == 0, "%zu triangles with the same vertices as another",
                q->duplicates);
  section_check(s, "no degenerate faces", q->degenerate == 0, "%zu triangles without area", q->degenerate);
}

static void outwards(bool sound, bool outward, section *s) {
  section_check(s, "outwards", sound && outward, "%s",
                !sound    ? "no inside to speak of: not a closed oriented mesh"
                : outward ? "triangles run counter-clockwise seen from outside"
                          : "triangles run clockwise seen from outside");
}

static void with_cgal(const skf_mesh_measure *q, const check_mesh_report *c, section *s) {
  outwards(q->closed && q->oriented && c->mesh, c->outward && q->outward, s);
  section_check(s, "no self-intersections", c->self_intersections == 0, "%zu pairs of triangles (CGAL, exact)",
                c->self_intersections);
  if (c->mesh && c->closed && c->self_intersections == 0)
    section_check(s, "bounds a volume", c->bounds, "components are nested and oriented %s (CGAL, exact)",
                  c->bounds ? "as in- and outsides" : "wrongly");
  /* CGAL sums tetrahedra from the origin. */
  double far = fmax(v3_norm(q->box.lo), v3_norm(q->box.hi)), slack = 1e-14 * far * far * far;
  bool same = !c->mesh || (c->components == q->components && c->euler == q->euler && c->closed == q->closed &&
                           fabs(c->area - q->area) <= 1e-9 * q->area &&
                           (!c->closed || fabs(c->volume - q->volume) <= 1e-9 * q->area * sqrt(q->area) + slack));
  section_check(s, "second count", same, "components, Euler characteristic, area and volume by %s",
                c->mesh ? same ? "CGAL agree" : "CGAL differ" : "CGAL: only for meshes");
}

static skf_status without_cgal(const skf_mesh *mesh, const skf_mesh_measure *q, section *s) {
  signed char *bad = malloc(mesh->triangle_count + 1);
  size_t crossings = 0;
  skf_status e = bad ? skf_mesh_crossings(mesh, bad, &crossings) : SKF_ERR_NOMEM;
  free(bad);
  outwards(q->closed && q->oriented, q->outward, s);
  section_check(s, "no self-intersections", crossings == 0, "%zu triangles cross or nearly cross another", crossings);
  section_note(s, "no CGAL", "this build has no CGAL: its exact checks are left out");
  return e;
}

static void figures(const skf_mesh *mesh, const skf_mesh_measure *q, section *s) {
  const double degrees = 180 / 3.14159265358979323846;
  section_count(s, "triangles", (double)mesh->triangle_count);
  section_count(s, "vertices", (double)mesh->vertex_count);
  section_count(s, "components", (double)q->components);
  section_count(s, "Euler characteristic", (double)q->euler);
  if (q->closed && q->manifold && q->oriented) section_count(s, "genus", (double)q->genus);
  section_number(s, "area", "L^2", q->area);
  if (q->closed && q->oriented) section_number(s, "volume", "L^3", q->volume);
  section_number(s, "shortest edge", "L", q->edge_min);
  section_number(s, "mean edge", "L", q->edge_mean);
  section_number(s, "longest edge", "L", q->edge_max);
  section_number(s, "smallest angle", "deg", q->angle_min * degrees);
  section_number(s, "mean smallest angle", "deg", q->angle_mean * degrees);
}

static skf_status check_as_is(const skf_mesh *mesh, section *s) {
  skf_mesh_measure q;
  check_mesh_report c;
  skf_status e = skf_mesh_measure_of(mesh, &q);
  if (e) return e;
  topology(&q, s);
  e = check_mesh(mesh, &c);
  if (!e)
    with_cgal(&q, &c, s);
  else if (e == SKF_ERR_UNSUPPORTED)
    e = without_cgal(mesh, &q, s);
  if (e) return e;
  if (q.unused_vertices) section_note(s, "unused vertices", "%zu vertices that no triangle uses", q.unused_vertices);
  figures(mesh, &q, s);
  return SKF_OK;
}

skf_status validate_mesh(const skf_mesh *mesh, bool around, section *s) {
  if (!around) return check_as_is(mesh, s);
  skf_mesh turned = *mesh; /* borrowed, but for the triangles */
  turned.triangles = malloc((mesh->triangle_count + 1) * sizeof *turned.triangles);
  if (!turned.triangles) return SKF_ERR_NOMEM;
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    const unsigned *v = mesh->triangles[t];
    turned.triangles[t][0] = v[0], turned.triangles[t][1] = v[2], turned.triangles[t][2] = v[1];
  }
  section_note(s, "turned over", "the body is around the surface: what follows is about the outside that it encloses");
  skf_status e = check_as_is(&turned, s);
  free(turned.triangles);
  return e;
}
