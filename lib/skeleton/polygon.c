/* SPDX-License-Identifier: MIT */
/* Polygons cut into triangles by ears, best shape first [Meisters 1975: every simple polygon has two ears]. */
#include "skelfield/polygon.h"
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

/* The plane of a polygon: seen along the axis that is nearest to its normal, which looks against it if `mirrored`. */
typedef struct view {
  int axis;
  bool mirrored;
  double extent, largest; /* of the outline, of all coordinates */
} view;

/* Refuses what is not planar; *where is the worst of all n vertices, the first `rim` of which are the outline. */
static const char *find_plane(const skf_vec3 *v, size_t rim, size_t n, view *out, size_t *where) {
  skf_box box = box_empty();
  double worst = 0;
  out->largest = 0;
  for (size_t i = 0; i < n; i++) {
    if (i < rim) box = box_add(box, v[i]);
    out->largest = fmax(out->largest, fmax(fabs(v[i].x), fmax(fabs(v[i].y), fabs(v[i].z))));
  }
  double extent = fmax(box.hi.x - box.lo.x, fmax(box.hi.y - box.lo.y, box.hi.z - box.lo.z));
  if (!(extent > 0) || !isfinite(extent)) return "a polygon of zero area";
  skf_vec3 area = {0, 0, 0}, middle = {0, 0, 0};
  for (size_t i = 0; i < rim; i++) {
    skf_vec3 a = v3_scale(1 / extent, v3_sub(v[i], v[0])), b = v3_scale(1 / extent, v3_sub(v[(i + 1) % rim], v[0]));
    area = v3_add(area, v3_cross(a, b));
    middle = v3_mad(middle, 1 / (double)rim, a);
  }
  if (!(v3_norm(area) > 8e-16 * (1 + out->largest / extent)))
    return "a polygon of zero area, or one that crosses itself";
  skf_vec3 normal = v3_unit(area), m = v3(fabs(normal.x), fabs(normal.y), fabs(normal.z));
  out->axis = m.x >= m.y && m.x >= m.z ? 0 : m.y >= m.z ? 1 : 2;
  out->mirrored = v3_get(normal, out->axis) < 0;
  out->extent = extent;
  for (size_t i = 0; i < n; i++) {
    double off = fabs(v3_dot(v3_sub(v3_scale(1 / extent, v3_sub(v[i], v[0])), middle), normal));
    if (off > worst) worst = off, *where = i;
  }
  return worst > 1e-6 ? "a polygon that is not planar" : NULL; /* six digits in a file are enough */
}

static flat seen(const view *from, skf_vec3 a) {
  double x = v3_get(a, (from->axis + 1) % 3), y = v3_get(a, (from->axis + 2) % 3);
  return from->mirrored ? (flat){y, x} : (flat){x, y};
}

/* Projects. */
static const char *flatten(const skf_vec3 *v, outline *o, size_t *where) {
  view from;
  const char *why = find_plane(v, o->n, o->n, &from, where);
  if (why) return why;
  o->noise = from.largest / from.extent;
  for (size_t i = 0; i < o->n; i++) o->p[i] = seen(&from, v3_scale(1 / from.extent, v3_sub(v[i], v[0])));
  return NULL;
}

skf_status skf_polygon_cut(const skf_vec3 *v, size_t rings, const size_t *sizes, skf_ring_cutter *cutter,
                           unsigned (*triangles)[3], size_t *count, const char **why, size_t *where) {
  const char *ignored;
  size_t nowhere, n = 0;
  if (!why) why = &ignored;
  if (!where) where = &nowhere;
  *why = NULL, *where = 0, *count = 0;
  for (size_t k = 0; k < rings; n += sizes[k++])
    if (sizes[k] < 3) return *why = "a ring with less than three vertices", *where = n, SKF_ERR_DEGENERATE;
  if (rings < 1 || n > 0xffffffffu) return SKF_ERR_ARG;
  for (size_t i = 0; i < n; i++)
    if (!v3_finite(v[i])) return *where = i, *why = "a number is not finite", SKF_ERR_RANGE;
  view from;
  if ((*why = find_plane(v, sizes[0], n, &from, where))) return SKF_ERR_DEGENERATE;
  double(*xy)[2] = skf_alloc(n, sizeof *xy);
  if (!xy) return SKF_ERR_NOMEM;
  for (size_t i = 0; i < n; i++) { /* as they are: the cutter may be exact */
    flat p = seen(&from, v[i]);
    xy[i][0] = p.x, xy[i][1] = p.y;
  }
  skf_status s = cutter((const double(*)[2])xy, rings, sizes, triangles, count, why, where);
  skf_free(xy);
  return s;
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
