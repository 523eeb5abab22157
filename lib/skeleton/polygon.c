/* SPDX-License-Identifier: MIT */
/* Polygons cut into triangles by ears, best shape first [Meisters 1975: every simple polygon has two ears]. */
#include "skeleton/shape.h"
#include "core/alloc.h"
#include <float.h>
#include <string.h>

typedef struct flat {
  double x, y;
} flat;

/* The polygon seen along the axis that is nearest to its normal, counter-clockwise, with extent 1. */
typedef struct outline {
  size_t n;
  flat *p;
  double noise; /* rounding of the coordinates, in units of DBL_EPSILON */
} outline;

/* 1 when c is left of the line from a to b, -1 when right, 0 when rounding of the coordinates may decide. */
static int side(const outline *o, size_t a, size_t b, size_t c) {
  double ux = o->p[b].x - o->p[a].x, uy = o->p[b].y - o->p[a].y;
  double vx = o->p[c].x - o->p[a].x, vy = o->p[c].y - o->p[a].y;
  double left = ux * vy, right = uy * vx;
  double reach = fabs(ux) + fabs(uy) + fabs(vx) + fabs(vy);
  double slack = 4 * DBL_EPSILON * (fabs(left) + fabs(right) + o->noise * reach);
  return (left - right > slack) - (left - right < -slack);
}

/* Whether c, on the line through a and b, is between them. */
static bool between(const outline *o, size_t a, size_t b, size_t c) {
  const flat *p = o->p;
  return (p[a].x - p[c].x) * (p[b].x - p[c].x) + (p[a].y - p[c].y) * (p[b].y - p[c].y) <= 0;
}

static bool touch(const outline *o, size_t a, size_t b, size_t c, size_t d) {
  int ac = side(o, a, b, c), ad = side(o, a, b, d), ca = side(o, c, d, a), cb = side(o, c, d, b);
  if (ac * ad < 0 && ca * cb < 0) return true;
  return (!ac && between(o, a, b, c)) || (!ad && between(o, a, b, d)) || (!ca && between(o, c, d, a)) ||
         (!cb && between(o, c, d, b));
}

/* The first vertex whose outgoing edge touches another one beyond the vertex they share; n when there is none. */
static size_t first_crossing(const outline *o) {
  size_t n = o->n;
  for (size_t i = 0; i < n; i++) {
    size_t b = (i + 1) % n, c = (i + 2) % n;
    if (!side(o, i, b, c) && !between(o, i, c, b)) return b; /* it runs back into itself */
    for (size_t j = i + 2; j < n; j++)
      if ((j + 1) % n != i && touch(o, i, b, j, (j + 1) % n)) return j;
  }
  return n;
}

static size_t *ring_at(size_t *ring, size_t left, size_t i) { return ring + i % left; }

/* Area over the square of the longest side; 0 when the corner b is no ear. */
static double ear(const outline *o, size_t *ring, size_t left, size_t i, double better_than) {
  size_t a = *ring_at(ring, left, i + left - 1), b = ring[i], c = *ring_at(ring, left, i + 1);
  if (side(o, a, b, c) <= 0) return 0;
  flat u = {o->p[b].x - o->p[a].x, o->p[b].y - o->p[a].y}, v = {o->p[c].x - o->p[a].x, o->p[c].y - o->p[a].y};
  double longest =
      fmax(fmax(u.x * u.x + u.y * u.y, v.x * v.x + v.y * v.y), (v.x - u.x) * (v.x - u.x) + (v.y - u.y) * (v.y - u.y));
  double shape = (u.x * v.y - u.y * v.x) / longest;
  if (shape <= better_than) return 0;
  for (size_t k = 2; k + 1 < left; k++) {
    size_t q = *ring_at(ring, left, i + k);
    if (side(o, a, b, q) >= 0 && side(o, b, c, q) >= 0 && side(o, c, a, q) >= 0) return 0;
  }
  return shape;
}

/* The vertex at which no ear was left, or n. */
static size_t clip(const outline *o, size_t *ring, unsigned (*triangles)[3]) {
  size_t left = o->n, made = 0;
  for (size_t i = 0; i < left; i++) ring[i] = i;
  for (; left > 2; left--) {
    size_t at = left;
    double best = 0;
    for (size_t i = 0; i < left; i++) {
      double shape = ear(o, ring, left, i, best);
      if (shape > best) best = shape, at = i;
    }
    if (at == left) return ring[0];
    triangles[made][0] = (unsigned)*ring_at(ring, left, at + left - 1);
    triangles[made][1] = (unsigned)ring[at];
    triangles[made++][2] = (unsigned)*ring_at(ring, left, at + 1);
    memmove(ring + at, ring + at + 1, (left - at - 1) * sizeof *ring);
  }
  return o->n;
}

/* Projects, and refuses what is not planar; *where is the worst vertex. */
static const char *flatten(const skf_vec3 *v, outline *o, size_t *where) {
  skf_box box = box_empty();
  double largest = 0, worst = 0;
  for (size_t i = 0; i < o->n; i++) {
    box = box_add(box, v[i]);
    largest = fmax(largest, fmax(fabs(v[i].x), fmax(fabs(v[i].y), fabs(v[i].z))));
  }
  double extent = fmax(box.hi.x - box.lo.x, fmax(box.hi.y - box.lo.y, box.hi.z - box.lo.z));
  if (!(extent > 0) || !isfinite(extent)) return "a polygon of zero area";
  skf_vec3 area = {0, 0, 0}, middle = {0, 0, 0};
  for (size_t i = 0; i < o->n; i++) {
    skf_vec3 a = v3_scale(1 / extent, v3_sub(v[i], v[0])), b = v3_scale(1 / extent, v3_sub(v[(i + 1) % o->n], v[0]));
    area = v3_add(area, v3_cross(a, b));
    middle = v3_mad(middle, 1 / (double)o->n, a);
  }
  o->noise = largest / extent;
  if (!(v3_norm(area) > 8e-16 * (1 + o->noise))) return "a polygon of zero area, or one that crosses itself";
  skf_vec3 n = v3_unit(area), m = v3(fabs(n.x), fabs(n.y), fabs(n.z));
  int axis = m.x >= m.y && m.x >= m.z ? 0 : m.y >= m.z ? 1 : 2;
  bool mirrored = v3_get(n, axis) < 0;
  for (size_t i = 0; i < o->n; i++) {
    skf_vec3 a = v3_scale(1 / extent, v3_sub(v[i], v[0]));
    double x = v3_get(a, (axis + 1) % 3), y = v3_get(a, (axis + 2) % 3), off = fabs(v3_dot(v3_sub(a, middle), n));
    o->p[i] = mirrored ? (flat){y, x} : (flat){x, y};
    if (off > worst) worst = off, *where = i;
  }
  return worst > 1e-6 ? "a polygon that is not planar" : NULL; /* six digits in a file are enough */
}

skf_status skf_polygon_triangulate(const skf_vec3 *v, size_t n, unsigned (*triangles)[3], const char **why,
                                   size_t *where) {
  const char *ignored;
  size_t nowhere;
  if (!why) why = &ignored;
  if (!where) where = &nowhere;
  *why = NULL, *where = 0;
  if (n < 3 || n > 0xffffffffu) return *why = "a polygon with less than three vertices", SKF_ERR_DEGENERATE;
  for (size_t i = 0; i < n; i++)
    if (!v3_finite(v[i])) return *where = i, *why = "a number is not finite", SKF_ERR_RANGE;
  outline o = {.n = n, .p = skf_alloc(n, sizeof *o.p)};
  size_t *ring = skf_alloc(n, sizeof *ring);
  skf_status s = o.p && ring ? SKF_OK : SKF_ERR_NOMEM;
  if (!s) *why = flatten(v, &o, where);
  if (!s && !*why && (*where = first_crossing(&o)) < n) *why = "a polygon whose edges touch or cross";
  if (!s && !*why && (*where = clip(&o, ring, triangles)) < n) *why = "a polygon whose edges almost touch";
  skf_free(o.p), skf_free(ring);
  return s ? s : *why ? SKF_ERR_DEGENERATE : SKF_OK;
}
