/* SPDX-License-Identifier: MIT */
/* Triangles that cross others, found with a hashed grid and separating directions. An answer that rounding could turn
   counts as a crossing, so that "none" is certain. */
#include "surface/mesher.h"

/* Products of differences of coordinates are good to a few ulp; a margin of this share decides their sign. */
static const double margin = 1e-13;

static double magnitude(skf_vec3 a) { return fabs(a.x) + fabs(a.y) + fabs(a.z); }

/* Sign of a . b, 0 when rounding could turn it. */
static int side(skf_vec3 axis, skf_vec3 d) {
  double x = v3_dot(axis, d), e = margin * magnitude(axis) * magnitude(d);
  return x > e ? 1 : x < -e ? -1 : 0;
}

/* Whether `axis` has a gap between the corners of two triangles. */
static bool gap(skf_vec3 axis, const skf_vec3 a[3], const skf_vec3 b[3]) {
  double lo_a = INFINITY, hi_a = -INFINITY, lo_b = INFINITY, hi_b = -INFINITY, size = 0;
  for (int k = 0; k < 3; k++) {
    double x = v3_dot(axis, a[k]), y = v3_dot(axis, b[k]);
    lo_a = fmin(lo_a, x), hi_a = fmax(hi_a, x), lo_b = fmin(lo_b, y), hi_b = fmax(hi_b, y);
    size = fmax(size, fmax(magnitude(a[k]), magnitude(b[k])));
  }
  double e = margin * magnitude(axis) * size;
  return lo_a > hi_b + e || lo_b > hi_a + e;
}

/* No common vertex. Corners are relative to a[0]. */
static bool apart(const skf_vec3 a[3], const skf_vec3 b[3]) {
  skf_vec3 ea[3], eb[3];
  for (int k = 0; k < 3; k++) ea[k] = v3_sub(a[(k + 1) % 3], a[k]), eb[k] = v3_sub(b[(k + 1) % 3], b[k]);
  skf_vec3 na = v3_cross(ea[0], ea[1]), nb = v3_cross(eb[0], eb[1]);
  if (gap(na, a, b) || gap(nb, a, b)) return true;
  for (int i = 0; i < 3; i++)
    if (gap(v3_cross(na, ea[i]), a, b) || gap(v3_cross(nb, eb[i]), a, b)) return true;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      if (gap(v3_cross(ea[i], eb[j]), a, b)) return true;
  return false;
}

/* One common vertex, at the origin: the cones of a[0], a[1] and of b[0], b[1] meet only there. */
static bool cones_apart(const skf_vec3 a[2], const skf_vec3 b[2]) {
  skf_vec3 na = v3_cross(a[0], a[1]), nb = v3_cross(b[0], b[1]);
  if (side(na, b[0]) * side(na, b[1]) > 0 || side(nb, a[0]) * side(nb, a[1]) > 0) return true;
  for (int i = 0; i < 2; i++) {
    skf_vec3 in_a = v3_cross(na, a[i]), in_b = v3_cross(nb, b[i]);
    int x = side(in_a, a[1 - i]), y = side(in_b, b[1 - i]);
    if (x && side(in_a, b[0]) == -x && side(in_a, b[1]) == -x) return true;
    if (y && side(in_b, a[0]) == -y && side(in_b, a[1]) == -y) return true;
    for (int j = 0; j < 2; j++) {
      skf_vec3 axis = v3_cross(a[i], b[j]);
      if (side(axis, a[1 - i]) * side(axis, b[1 - j]) < 0) return true;
    }
  }
  return false;
}

/* A common edge from the origin to e: the wings to a and b do not lie on each other. */
static bool wings_apart(skf_vec3 e, skf_vec3 a, skf_vec3 b) {
  skf_vec3 na = v3_cross(e, a), nb = v3_cross(e, b);
  return side(na, b) != 0 || side(na, nb) < 0;
}

static bool pair_apart(const skf_mesh *m, size_t s, size_t t) {
  const unsigned *p = m->triangles[s], *q = m->triangles[t];
  int common = 0, ip = 0, iq = 0; /* for one: the common corner; for two: the corner that is not common */
  int cp = 0, cq = 0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      if (p[i] == q[j]) common++, ip = i, iq = j, cp += i, cq += j;
  const skf_vec3 *x = m->vertices;
  skf_vec3 a[3], b[3];
  if (common >= 3) return false;
  if (common == 2) {
    skf_vec3 o = x[p[ip]];
    return wings_apart(v3_sub(x[p[cp - ip]], o), v3_sub(x[p[3 - cp]], o), v3_sub(x[q[3 - cq]], o));
  }
  skf_vec3 o = x[p[common ? ip : 0]];
  for (int k = 0; k < 3; k++) {
    a[k] = v3_sub(x[p[common ? (ip + k + 1) % 3 : k]], o);
    b[k] = v3_sub(x[q[common ? (iq + k + 1) % 3 : k]], o);
  }
  return common ? cones_apart(a, b) : apart(a, b);
}

/* The hashed grid: triangles by bucket. */
typedef struct grid {
  double cell;
  skf_vec3 lo;
  size_t mask, *start;
  unsigned *list;
  skf_box *boxes;
} grid;

static void cell_of(const grid *g, skf_vec3 p, long c[3]) {
  for (int i = 0; i < 3; i++) c[i] = (long)floor((v3_get(p, i) - v3_get(g->lo, i)) / g->cell);
}

static size_t bucket(const grid *g, const long c[3]) {
  uint64_t h = (uint64_t)c[0] * 0x9e3779b97f4a7c15u ^ (uint64_t)c[1] * 0xc2b2ae3d27d4eb4fu ^
               (uint64_t)c[2] * 0x165667b19e3779f9u;
  return (size_t)(h ^ h >> 29) & g->mask;
}

/* Walks the cells that a triangle's box meets; counts into start, or files the triangle. */
static void enter(grid *g, size_t t, bool file) {
  long lo[3], hi[3], c[3];
  cell_of(g, g->boxes[t].lo, lo), cell_of(g, g->boxes[t].hi, hi);
  for (c[0] = lo[0]; c[0] <= hi[0]; c[0]++)
    for (c[1] = lo[1]; c[1] <= hi[1]; c[1]++)
      for (c[2] = lo[2]; c[2] <= hi[2]; c[2]++) {
        size_t b = bucket(g, c);
        if (file)
          g->list[g->start[b + 1]++] = (unsigned)t;
        else
          g->start[b + 2]++;
      }
}

static skf_status grid_new(grid *g, const skf_mesh *m) {
  size_t n = m->triangle_count, slots = 64;
  double size = 0;
  skf_box all = box_empty();
  while (slots < 2 * n) slots *= 2;
  *g = (grid){0};
  g->mask = slots - 1;
  g->boxes = skf_alloc(n, sizeof *g->boxes), g->start = skf_alloc(slots + 2, sizeof *g->start);
  if (!g->boxes || !g->start) return SKF_ERR_NOMEM;
  for (size_t t = 0; t < n; t++) {
    skf_box b = box_empty();
    for (int k = 0; k < 3; k++) b = box_add(b, m->vertices[m->triangles[t][k]]);
    g->boxes[t] = b, all = box_join(all, b), size += box_diagonal(b);
  }
  g->lo = all.lo;
  g->cell = fmax(n ? 1.3 * size / (double)n : 1, 1e-6 * box_diagonal(all));
  if (!(g->cell > 0)) g->cell = 1;
  for (size_t t = 0; t < n; t++) enter(g, t, false);
  for (size_t i = 1; i < slots + 2; i++) g->start[i] += g->start[i - 1];
  g->list = skf_alloc(g->start[slots + 1], sizeof *g->list);
  if (!g->list) return SKF_ERR_NOMEM;
  for (size_t t = 0; t < n; t++) enter(g, t, true);
  return SKF_OK;
}

static bool overlap(const skf_box *a, const skf_box *b) {
  return a->lo.x <= b->hi.x && b->lo.x <= a->hi.x && a->lo.y <= b->hi.y && b->lo.y <= a->hi.y && a->lo.z <= b->hi.z &&
         b->lo.z <= a->hi.z;
}

/* Each pair is tested in the one bucket of the lowest corner of what their boxes share. */
static void one_bucket(const grid *g, const skf_mesh *m, size_t b, signed char *bad) {
  for (size_t i = g->start[b]; i < g->start[b + 1]; i++)
    for (size_t j = i + 1; j < g->start[b + 1]; j++) {
      unsigned s = g->list[i], t = g->list[j];
      const skf_box *x = g->boxes + s, *y = g->boxes + t;
      if (s == t || !overlap(x, y)) continue;
      long c[3];
      cell_of(g, v3(fmax(x->lo.x, y->lo.x), fmax(x->lo.y, y->lo.y), fmax(x->lo.z, y->lo.z)), c);
      if (bucket(g, c) != b || pair_apart(m, s, t)) continue;
#pragma omp atomic write
      bad[s] = 1;
#pragma omp atomic write
      bad[t] = 1;
    }
}

skf_status skf_mesh_crossings(const skf_mesh *m, signed char *bad, size_t *count) {
  grid g;
  skf_status s = grid_new(&g, m);
  for (size_t t = 0; t < m->triangle_count; t++) bad[t] = 0;
  *count = 0;
  if (!s) {
#pragma omp parallel for schedule(dynamic, 256)
    for (size_t b = 0; b <= g.mask; b++) one_bucket(&g, m, b, bad);
  }
  for (size_t t = 0; t < m->triangle_count; t++) *count += bad[t];
  skf_free(g.start), skf_free(g.list), skf_free(g.boxes);
  return s;
}
