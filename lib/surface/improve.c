/* SPDX-License-Identifier: MIT */
/* Better triangles on the same surface: edge flips and smoothing along the surface. */
#include "surface/edges.h"
#include "surface/mesher.h"
#include <string.h>

/* The mesh with, for each side of a triangle, the side that meets it. */
typedef struct linked {
  skf_mesh *mesh;
  unsigned *twin;
  unsigned *first; /* a side that starts at the vertex */
  unsigned *valence;
  const signed char *locked;
} linked;

static unsigned next(unsigned s) { return s % 3 == 2 ? s - 2 : s + 1; }
static unsigned prev(unsigned s) { return s % 3 == 0 ? s + 2 : s - 1; }
static unsigned from(const linked *l, unsigned s) { return l->mesh->triangles[s / 3][s % 3]; }

static skf_status link_sides(linked *l) {
  skf_side *sides;
  size_t n = 3 * l->mesh->triangle_count;
  skf_status e = skf_sides_sorted(l->mesh, &sides);
  l->twin = skf_alloc(n, sizeof *l->twin);
  l->first = skf_alloc(l->mesh->vertex_count, sizeof *l->first);
  l->valence = skf_alloc(l->mesh->vertex_count, sizeof *l->valence);
  if (!e && !(l->twin && l->first && l->valence)) e = SKF_ERR_NOMEM;
  for (size_t i = 0; i + 1 < n && !e; i += 2) {
    if (sides[i].lo != sides[i + 1].lo || sides[i].hi != sides[i + 1].hi) e = SKF_ERR_ARG; /* not closed */
    l->twin[sides[i].side] = (unsigned)sides[i + 1].side, l->twin[sides[i + 1].side] = (unsigned)sides[i].side;
  }
  for (unsigned s = 0; s < n && !e; s++) l->first[from(l, s)] = s, l->valence[from(l, s)]++;
  skf_free(sides);
  return e;
}

static bool neighbours(const linked *l, unsigned a, unsigned b) {
  unsigned s = l->first[a];
  do {
    if (from(l, next(s)) == b) return true;
    s = l->twin[prev(s)];
  } while (s != l->first[a]);
  return false;
}

static skf_vec3 area_vector(const skf_vec3 *p, unsigned a, unsigned b, unsigned c) {
  return v3_cross(v3_sub(p[b], p[a]), v3_sub(p[c], p[a]));
}

/* Cosine-like measure of the angle at c in triangle a b c: its sign decides Delaunay flips without trigonometry. */
static double cotangent(const skf_vec3 *p, unsigned a, unsigned b, unsigned c) {
  skf_vec3 u = v3_sub(p[a], p[c]), v = v3_sub(p[b], p[c]);
  return v3_dot(u, v) / v3_norm(v3_cross(u, v));
}

/* Flipping edge a b to c d would make the angles better, and neither turns a triangle nor bends the surface. */
static bool should_flip(const linked *l, unsigned s, unsigned o) {
  const skf_vec3 *p = l->mesh->vertices;
  unsigned a = from(l, s), b = from(l, next(s)), c = from(l, prev(s)), d = from(l, prev(o));
  if (l->locked[a] || l->locked[b] || l->locked[c] || l->locked[d]) return false;
  if (l->valence[a] <= 4 || l->valence[b] <= 4 || c == d) return false;
  if (!(cotangent(p, a, b, c) + cotangent(p, b, a, d) < -1e-9)) return false;
  skf_vec3 n1 = v3_unit(area_vector(p, a, b, c)), n2 = v3_unit(area_vector(p, b, a, d));
  skf_vec3 m1 = v3_unit(area_vector(p, c, d, b)), m2 = v3_unit(area_vector(p, d, c, a)), n = v3_unit(v3_add(n1, n2));
  if (v3_dot(n1, n2) < 0.8 || v3_dot(m1, m2) < 0.8 || v3_dot(m1, n) < 0.8 || v3_dot(m2, n) < 0.8) return false;
  return !neighbours(l, c, d);
}

/* Replaces triangles (a b c), (b a d) by (c d b), (d c a). */
static void flip(linked *l, unsigned s, unsigned o) {
  unsigned t = s / 3, u = o / 3;
  unsigned a = from(l, s), b = from(l, next(s)), c = from(l, prev(s)), d = from(l, prev(o));
  unsigned bc = l->twin[next(s)], ca = l->twin[prev(s)], ad = l->twin[next(o)], db = l->twin[prev(o)];
  memcpy(l->mesh->triangles[t], (unsigned[3]){c, d, b}, sizeof(unsigned[3]));
  memcpy(l->mesh->triangles[u], (unsigned[3]){d, c, a}, sizeof(unsigned[3]));
  unsigned pair[5][2] = {{3 * t, 3 * u}, {3 * t + 1, db}, {3 * t + 2, bc}, {3 * u + 1, ca}, {3 * u + 2, ad}};
  for (int k = 0; k < 5; k++) l->twin[pair[k][0]] = pair[k][1], l->twin[pair[k][1]] = pair[k][0];
  l->first[a] = 3 * u + 2, l->first[b] = 3 * t + 2, l->first[c] = 3 * t, l->first[d] = 3 * u;
  l->valence[a]--, l->valence[b]--, l->valence[c]++, l->valence[d]++;
}

static size_t flip_pass(linked *l) {
  size_t flips = 0;
  for (unsigned s = 0; s < 3 * l->mesh->triangle_count; s++) {
    unsigned o = l->twin[s];
    if (s < o && should_flip(l, s, o)) flip(l, s, o), flips++;
  }
  return flips;
}

/* Where smoothing wants a vertex: half way to the centre of its triangles, weighted by their areas, in its tangent
   plane. */
static skf_vec3 target(const linked *l, unsigned v) {
  const skf_vec3 *p = l->mesh->vertices;
  skf_vec3 n = {0, 0, 0}, c = {0, 0, 0};
  double area = 0;
  unsigned s = l->first[v];
  do {
    unsigned b = from(l, next(s)), d = from(l, prev(s));
    skf_vec3 k = area_vector(p, v, b, d), mid = v3_scale(1 / 3.0, v3_add(v3_sub(p[b], p[v]), v3_sub(p[d], p[v])));
    double w = v3_norm(k);
    n = v3_add(n, k), c = v3_mad(c, w, mid), area += w;
    s = l->twin[prev(s)];
  } while (s != l->first[v]);
  if (!(area > 0)) return p[v];
  n = v3_unit(n), c = v3_scale(0.7 / area, c);
  return v3_add(p[v], v3_mad(c, -v3_dot(c, n), n));
}

/* Whether the triangles around v keep facing the way they did with v at q. */
static bool keeps_faces(const linked *l, unsigned v, skf_vec3 q) {
  const skf_vec3 *p = l->mesh->vertices;
  unsigned s = l->first[v];
  do {
    skf_vec3 b = p[from(l, next(s))], d = p[from(l, prev(s))];
    skf_vec3 before = v3_unit(v3_cross(v3_sub(b, p[v]), v3_sub(d, p[v]))),
             after = v3_unit(v3_cross(v3_sub(b, q), v3_sub(d, q)));
    if (v3_dot(before, after) < 0.7) return false;
    s = l->twin[prev(s)];
  } while (s != l->first[v]);
  return true;
}

static skf_status smooth_pass(linked *l, const skf_field *field, double iso, double edge, skf_vec3 *q,
                              signed char *moved) {
  size_t n = l->mesh->vertex_count;
#pragma omp parallel for schedule(static)
  for (size_t v = 0; v < n; v++) q[v] = l->locked[v] ? l->mesh->vertices[v] : target(l, (unsigned)v);
  skf_status e = skf_polish_points(field, iso, 0.5 * edge, n, q, moved);
  for (unsigned v = 0; v < n && !e; v++)
    if (moved[v] && !l->locked[v] && keeps_faces(l, v, q[v])) l->mesh->vertices[v] = q[v];
  return e;
}

skf_status skf_mesh_improve(skf_mesh *mesh, const skf_field *field, double iso, double edge, int rounds,
                            const signed char *locked) {
  linked l = {mesh, NULL, NULL, NULL, locked};
  skf_vec3 *q = skf_alloc(mesh->vertex_count, sizeof *q);
  signed char *moved = skf_alloc(mesh->vertex_count, 1);
  skf_status e = q && moved ? link_sides(&l) : SKF_ERR_NOMEM;
  for (int k = 0; k < rounds && !e; k++) {
    flip_pass(&l);
    e = smooth_pass(&l, field, iso, edge, q, moved);
  }
  if (!e) flip_pass(&l);
  skf_free(q), skf_free(moved), skf_free(l.twin), skf_free(l.first), skf_free(l.valence);
  return e;
}
