/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks of a skeleton: degenerate and duplicate primitives, triangles and segments that overlap. */
#include "adapt/check.h"
#include "core/vec3.h"
#include "validate.h"
#include <stdlib.h>
#include <string.h>

enum { SHOWN = 4 }; /* pairs named in the report */

/* Pairs of primitives, the first few with their lines in the file. */
typedef struct pairs {
  size_t count;
  char text[160];
} pairs;

static void note_pair(pairs *p, const skf_body *b, size_t i, size_t j) {
  size_t n = strlen(p->text);
  if (p->count++ < SHOWN)
    snprintf(p->text + n, sizeof p->text - n, "%s lines %ld and %ld", n ? "," : ":", b->element_lines[i],
             b->element_lines[j]);
}

static double size_of(skf_vec3 a) { return fmax(fabs(a.x), fmax(fabs(a.y), fabs(a.z))); }

/* Equal up to the rounding of the file's decimals. */
static bool same_point(skf_vec3 a, skf_vec3 b) { return size_of(v3_sub(a, b)) <= 1e-14 * fmax(size_of(a), size_of(b)); }

static int sort_key(const skf_vec3 *a, const skf_vec3 *b) {
  for (int k = 0; k < 3; k++)
    if (v3_get(*a, k) != v3_get(*b, k)) return v3_get(*a, k) < v3_get(*b, k) ? -1 : 1;
  return 0;
}

/* Points that describe where a primitive is, in an order that does not depend on its direction. */
static int landmarks(const skf_primitive *p, skf_vec3 at[4]) {
  static const double s[SKF_SHAPE_COUNT][4] = {
      [SKF_POINT] = {0}, [SKF_SEGMENT] = {0, 1}, [SKF_ARC] = {0, 0.25, 0.5, 1}, [SKF_PLANE] = {0}, [SKF_SOLID] = {0}};
  static const int counts[SKF_SHAPE_COUNT] = {
      [SKF_POINT] = 1, [SKF_SEGMENT] = 2, [SKF_ARC] = 4, [SKF_TRIANGLE] = 3, [SKF_PLANE] = 2, [SKF_SOLID] = 3};
  int n = counts[p->shape];
  for (int k = 0; k < n; k++)
    at[k] = p->shape == SKF_TRIANGLE ? p->triangle.vertices[k] : skf_primitive_point(p, s[p->shape][k], 0);
  if (p->shape == SKF_SOLID) {
    const skf_solid_info *solid = skf_solid_get(p->solid);
    at[0] = solid->bounds.lo, at[1] = solid->bounds.hi, at[2] = solid->center;
  }
  if (p->shape == SKF_PLANE) {
    skf_vec3 u = v3_unit(p->plane.normal);
    at[0] = v3_scale(v3_dot(u, p->plane.through), u); /* the foot of the origin */
    at[1] = v3(fabs(u.x), fabs(u.y), fabs(u.z));
  }
  for (int i = 1; i < n && p->shape != SKF_PLANE; i++)
    for (int j = i; j > 0 && sort_key(at + j, at + j - 1) < 0; j--) {
      skf_vec3 t = at[j];
      at[j] = at[j - 1], at[j - 1] = t;
    }
  return n;
}

static bool is_duplicate(const skf_element *a, const skf_element *b) {
  if (a->primitive.shape != b->primitive.shape || a->kernel.type != b->kernel.type ||
      a->kernel.param != b->kernel.param)
    return false;
  skf_vec3 p[4], q[4];
  int n = landmarks(&a->primitive, p);
  landmarks(&b->primitive, q);
  for (int k = 0; k < n; k++)
    if (!same_point(p[k], q[k])) return false;
  return true;
}

/* Whether two segments lie on one line and share a length. */
static bool share_length(const skf_segment *a, const skf_segment *b) {
  skf_vec3 d = v3_sub(a->to, a->from), u = v3_unit(d);
  double length = v3_norm(d), size = fmax(length, v3_dist(b->from, b->to));
  skf_vec3 p = v3_sub(b->from, a->from), q = v3_sub(b->to, a->from);
  double s = v3_dot(p, u), t = v3_dot(q, u);
  if (v3_norm(v3_mad(p, -s, u)) > 1e-12 * size || v3_norm(v3_mad(q, -t, u)) > 1e-12 * size) return false;
  return fmin(length, fmax(s, t)) - fmax(0, fmin(s, t)) > 1e-12 * size;
}

static skf_status triangles(const skf_body *b, section *out) {
  size_t n = 0, count = 0;
  for (size_t i = 0; i < b->element_count; i++) n += b->elements[i].primitive.shape == SKF_TRIANGLE;
  if (n < 2) return SKF_OK;
  enum { KEEP = 4096 };
  skf_vec3(*corners)[3] = malloc(n * sizeof *corners);
  size_t *which = malloc(n * sizeof *which);
  check_pair *found = malloc(KEEP * sizeof *found);
  skf_status e = corners && which && found ? SKF_OK : SKF_ERR_NOMEM;
  n = 0;
  for (size_t i = 0; i < b->element_count && !e; i++)
    if (b->elements[i].primitive.shape == SKF_TRIANGLE) {
      for (int k = 0; k < 3; k++) corners[n][k] = b->elements[i].primitive.triangle.vertices[k];
      which[n++] = i;
    }
  if (!e) e = check_triangles(n, (const skf_vec3(*)[3])corners, KEEP, found, &count);
  pairs overlaps = {0, ""}, crossings = {0, ""};
  for (size_t k = 0; k < count && k < KEEP && !e; k++)
    note_pair(found[k].overlap ? &overlaps : &crossings, b, which[found[k].first], which[found[k].second]);
  if (!e)
    section_check(out, "triangles apart", overlaps.count == 0, "%zu pairs overlap%s", overlaps.count, overlaps.text);
  if (!e && crossings.count) section_note(out, "triangles that cross", "%zu pairs%s", crossings.count, crossings.text);
  if (e == SKF_ERR_UNSUPPORTED) section_note(out, "no CGAL", "overlaps of the %zu triangles are not checked", n);
  free(corners), free(which), free(found);
  return e == SKF_ERR_UNSUPPORTED ? SKF_OK : e;
}

/* An element's box along x, for the sweep that finds neighbours. */
typedef struct span {
  size_t i;
  double lo, hi;
} span;

static int by_lo(const void *a, const void *b) {
  const span *x = a, *y = b;
  if (x->lo != y->lo) return x->lo < y->lo ? -1 : 1;
  return x->i < y->i ? -1 : x->i > y->i;
}

static void compare(const skf_body *b, size_t i, size_t j, pairs *duplicates, pairs *overlaps) {
  const skf_element *x = b->elements + i, *y = b->elements + j;
  if (is_duplicate(x, y))
    note_pair(duplicates, b, i, j);
  else if (x->primitive.shape == SKF_SEGMENT && y->primitive.shape == SKF_SEGMENT &&
           share_length(&x->primitive.segment, &y->primitive.segment))
    note_pair(overlaps, b, i, j);
}

skf_status validate_skeleton(const skf_body *b, section *s) {
  size_t degenerate = 0, n = b->element_count;
  pairs duplicates = {0, ""}, overlaps = {0, ""};
  span *spans = malloc((n + 1) * sizeof *spans);
  if (!spans) return SKF_ERR_NOMEM;
  for (size_t i = 0; i < n; i++) {
    skf_box box = skf_primitive_bounds(&b->elements[i].primitive);
    double slack = 1e-12 * fmax(fabs(box.lo.x), fabs(box.hi.x));
    spans[i] = (span){i, box.lo.x - slack, box.hi.x + slack};
    degenerate += skf_primitive_check(&b->elements[i].primitive, NULL) != SKF_OK;
  }
  qsort(spans, n, sizeof *spans, by_lo);
  for (size_t i = 0; i < n; i++)
    for (size_t j = i + 1; j < n && spans[j].lo <= spans[i].hi; j++) {
      size_t first = spans[i].i < spans[j].i ? spans[i].i : spans[j].i;
      compare(b, first, spans[i].i + spans[j].i - first, &duplicates, &overlaps);
    }
  free(spans);
  section_check(s, "no degenerate parts", degenerate == 0, "%zu of %zu primitives", degenerate, n);
  section_check(s, "no duplicates", duplicates.count == 0, "%zu pairs of equal primitives%s", duplicates.count,
                duplicates.text);
  section_check(s, "segments apart", overlaps.count == 0, "%zu pairs share a length%s", overlaps.count, overlaps.text);
  return triangles(b, s);
}
