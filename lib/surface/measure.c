/* SPDX-License-Identifier: MIT */
/* Measures and defects of a mesh, without any other library. */
#include "core/sum.h"
#include "core/vec3.h"
#include "surface/edges.h"
#include <float.h>

static double size_of(skf_vec3 p) { return fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))); }

static void shapes(const skf_mesh *m, skf_mesh_measure *r, skf_vec3 center) {
  skf_sum area = {0, 0}, volume = {0, 0}, angles = {0, 0};
  r->angle_min = m->triangle_count ? SKF_PI : 0;
  for (size_t t = 0; t < m->triangle_count; t++) {
    const unsigned *v = m->triangles[t];
    skf_vec3 p[3];
    for (int k = 0; k < 3; k++) p[k] = v3_sub(m->vertices[v[k]], center);
    skf_vec3 e[3] = {v3_sub(p[1], p[0]), v3_sub(p[2], p[1]), v3_sub(p[0], p[2])};
    double two = v3_norm(v3_cross(e[0], e[1])), longest = 0, smallest = SKF_PI, size = 0;
    for (int k = 0; k < 3; k++) {
      longest = fmax(longest, v3_norm(e[k]));
      size = fmax(size, size_of(m->vertices[v[k]]));
      smallest = fmin(smallest, atan2(two, -v3_dot(e[k], e[(k + 1) % 3])));
    }
    bool repeated = v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
    r->degenerate += repeated || !(two > 4 * DBL_EPSILON * size * longest);
    sum_add(&area, 0.5 * two);
    sum_add(&volume, v3_dot(p[0], v3_cross(p[1], p[2])) / 6);
    sum_add(&angles, smallest);
    r->angle_min = fmin(r->angle_min, smallest);
  }
  r->area = sum_total(area), r->volume = sum_total(volume);
  r->angle_mean = m->triangle_count ? sum_total(angles) / (double)m->triangle_count : 0;
}

static unsigned opposite(const skf_mesh *m, size_t side) {
  return m->triangles[side / 3][(side + 2 - side / 3 * 3) % 3];
}

/* One edge with all its sides. Corners of triangles that share an edge are in one fan of their vertex. */
static void one_edge(const skf_mesh *m, const skf_side *s, size_t n, unsigned *fans, skf_mesh_measure *r) {
  r->edges++;
  if (n == 1)
    r->boundary_edges++;
  else if (n > 2)
    r->nonmanifold_edges++;
  else if (s[0].forward == s[1].forward)
    r->misoriented_edges++;
  for (size_t i = 0; i < n; i++) {
    size_t t = s[i].side / 3, a = s[i].side, b = 3 * t + (a + 1) % 3, first = s[0].side,
           next = first / 3 * 3 + (first + 1) % 3;
    if (s[i].forward == s[0].forward)
      skf_join(fans, first, a), skf_join(fans, next, b);
    else
      skf_join(fans, first, b), skf_join(fans, next, a);
    unsigned apex = opposite(m, s[i].side);
    if (apex < s[i].hi) continue;
    for (size_t j = 0; j < i; j++)
      if (opposite(m, s[j].side) == apex) {
        r->duplicates++;
        break;
      }
  }
  double length = v3_dist(m->vertices[s->lo], m->vertices[s->hi]);
  r->edge_min = fmin(r->edge_min, length), r->edge_max = fmax(r->edge_max, length), r->edge_mean += length;
}

/* Solid angle of a triangle from p, over 4 pi [Van Oosterom & Strackee 1983, eq. 8]. */
static double winding(const skf_mesh *m, size_t t, skf_vec3 p) {
  skf_vec3 a = v3_sub(m->vertices[m->triangles[t][0]], p), b = v3_sub(m->vertices[m->triangles[t][1]], p);
  skf_vec3 c = v3_sub(m->vertices[m->triangles[t][2]], p);
  double la = v3_norm(a), lb = v3_norm(b), lc = v3_norm(c);
  double y = v3_dot(a, v3_cross(b, c));
  double x = la * lb * lc + v3_dot(a, b) * lc + v3_dot(b, c) * la + v3_dot(c, a) * lb;
  return atan2(y, x) / (2 * SKF_PI);
}

/* A component that encloses a negative volume is a cavity when the others wind around it. */
static bool faces_out(const skf_mesh *m, unsigned *parts, const double *volumes) {
  for (size_t v = 0; v < m->vertex_count; v++) {
    if (parts[v] != v || volumes[v] >= 0) continue;
    double around = 0;
    for (size_t t = 0; t < m->triangle_count; t++)
      if (skf_root_of(parts, m->triangles[t][0]) != v) around += winding(m, t, m->vertices[v]);
    if (around < 0.5) return false;
  }
  return true;
}

/* parts: sets of vertices; fans: sets of corners; seen: marks. */
static void topology(const skf_mesh *m, skf_mesh_measure *r, unsigned *parts, const unsigned *fans, unsigned *seen) {
  size_t used = 0;
  for (size_t s = 0; s < 3 * m->triangle_count; s++)
    if (fans[s] == s) seen[m->triangles[s / 3][s % 3]]++;
  for (size_t v = 0; v < m->vertex_count; v++) {
    used += seen[v] > 0;
    r->nonmanifold_vertices += seen[v] > 1;
    r->components += seen[v] && parts[v] == v;
  }
  r->unused_vertices = m->vertex_count - used;
  r->euler = (long)used - (long)r->edges + (long)m->triangle_count;
  r->genus = (long)r->components - r->euler / 2;
  r->closed = m->triangle_count && !r->boundary_edges;
  r->manifold = !r->nonmanifold_edges && !r->nonmanifold_vertices;
  r->oriented = !r->misoriented_edges;
}

static skf_status measure_of(const skf_mesh *m, skf_mesh_measure *r) {
  *r = (skf_mesh_measure){.box = box_empty(), .edge_min = INFINITY};
  size_t nv = m->vertex_count, ns = 3 * m->triangle_count;
  if (ns >= 0xffffffffu) return SKF_ERR_CAPACITY;
  skf_side *sides = NULL;
  skf_status s = skf_sides_sorted(m, &sides);
  unsigned *parts = skf_alloc(nv, sizeof *parts), *seen = skf_alloc(nv, sizeof *seen);
  unsigned *fans = skf_alloc(ns, sizeof *fans);
  double *volumes = skf_alloc(nv, sizeof *volumes);
  if (!s && !(parts && fans && seen && volumes)) s = SKF_ERR_NOMEM;
  if (!s) {
    for (size_t v = 0; v < nv; v++) parts[v] = (unsigned)v, r->box = box_add(r->box, m->vertices[v]);
    for (size_t i = 0; i < ns; i++) fans[i] = (unsigned)i;
    for (size_t i = 0, j; i < ns; i = j) {
      for (j = i + 1; j < ns && sides[j].lo == sides[i].lo && sides[j].hi == sides[i].hi;) j++;
      one_edge(m, sides + i, j - i, fans, r);
      skf_join(parts, sides[i].lo, sides[i].hi);
    }
    skf_vec3 center = nv ? box_center(r->box) : v3(0, 0, 0);
    for (size_t t = 0; t < m->triangle_count; t++) {
      const unsigned *v = m->triangles[t];
      skf_vec3 p[3];
      size_t root = skf_root_of(parts, v[0]);
      for (int k = 0; k < 3; k++) p[k] = v3_sub(m->vertices[v[k]], m->vertices[root]);
      volumes[root] += v3_dot(p[0], v3_cross(p[1], p[2]));
    }
    for (size_t v = 0; v < nv; v++) parts[v] = (unsigned)skf_root_of(parts, v);
    for (size_t i = 0; i < ns; i++) fans[i] = (unsigned)skf_root_of(fans, i);
    shapes(m, r, center);
    topology(m, r, parts, fans, seen);
    if (r->components > 1 && sqrt(r->area) < 1e-2 * box_diagonal(r->box)) { /* far parts: nothing is left of the sum */
      skf_sum sum = {0, 0};
      for (size_t v = 0; v < nv; v++) sum_add(&sum, volumes[v] / 6);
      r->volume = sum_total(sum);
    }
    if (!r->edges)
      r->edge_min = 0;
    else
      r->edge_mean /= (double)r->edges;
    r->outward = r->closed && r->oriented && r->volume > 0 && faces_out(m, parts, volumes);
  }
  skf_free(sides), skf_free(parts), skf_free(fans), skf_free(seen), skf_free(volumes);
  return s;
}

static skf_vec3 times(skf_vec3 a, int power) { return v3(ldexp(a.x, power), ldexp(a.y, power), ldexp(a.z, power)); }

/* Sizes whose fourth powers would leave the range of doubles are measured in units of a power of two. */
skf_status skf_mesh_measure_of(const skf_mesh *m, skf_mesh_measure *r) {
  double size = 0;
  int power;
  for (size_t i = 0; i < m->vertex_count; i++) size = fmax(size, size_of(m->vertices[i]));
  if (!(size > 0 && size < INFINITY) || (size > 1e-60 && size < 1e60)) return measure_of(m, r);
  frexp(size, &power);
  skf_mesh unit = *m; /* borrowed, but for the vertices */
  unit.vertices = skf_alloc(m->vertex_count, sizeof *unit.vertices);
  if (!unit.vertices) return *r = (skf_mesh_measure){0}, SKF_ERR_NOMEM;
  for (size_t i = 0; i < m->vertex_count; i++) unit.vertices[i] = times(m->vertices[i], -power);
  skf_status s = measure_of(&unit, r);
  skf_free(unit.vertices);
  r->area = ldexp(r->area, 2 * power), r->volume = ldexp(r->volume, 3 * power);
  r->box.lo = times(r->box.lo, power), r->box.hi = times(r->box.hi, power);
  r->edge_min = ldexp(r->edge_min, power), r->edge_mean = ldexp(r->edge_mean, power);
  r->edge_max = ldexp(r->edge_max, power);
  return s;
}
