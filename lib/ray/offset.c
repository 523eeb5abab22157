/* SPDX-License-Identifier: MIT */
/* Hard surfaces around primitives: their union, in a tree of boxes. */
#include "ray/offset.h"
#include "core/alloc.h"
#include <float.h>
#include <stdlib.h>

enum { LEAF = 2, DEEP = 64 };

typedef struct node {
  skf_box box;
  size_t first, count; /* of the hulls, when it is a leaf; else count = 0 and first is its second child, the first one
                          comes next */
} node;

struct skf_offsets {
  skf_hull *hulls;
  size_t n, endless; /* the last ones are planes, in no box */
  node *nodes;
  size_t node_count;
};

static skf_hull make_hull(const skf_primitive *p, double radius, size_t item) {
  skf_hull h = {.primitive = *p, .radius = radius, .item = item, .size = radius};
  if (p->shape == SKF_PLANE) return h;
  skf_box b = skf_primitive_bounds(p);
  h.size = box_diagonal(b) + 2 * radius;
  double rounding = fmax(v3_norm(b.lo), v3_norm(b.hi));
  h.box = box_grow(b, radius * (1 + 1e-9) + 32 * DBL_EPSILON * rounding);
  return h;
}

static size_t hulls_of(const skf_offset *item) {
  return item->primitive.shape == SKF_SOLID ? skf_solid_get(item->primitive.solid)->faces : 1;
}

static void add(skf_offsets *o, const skf_offset *item, size_t index) {
  if (item->primitive.shape != SKF_SOLID) {
    o->hulls[o->n++] = make_hull(&item->primitive, item->radius, index);
    return;
  }
  const skf_vec3 *v = skf_solid_vertices(item->primitive.solid);
  const unsigned *f = skf_solid_faces(item->primitive.solid);
  for (size_t i = 0; i < hulls_of(item); i++) {
    skf_primitive face = {.shape = SKF_TRIANGLE, .triangle = {{v[f[3 * i]], v[f[3 * i + 1]], v[f[3 * i + 2]]}}};
    o->hulls[o->n++] = make_hull(&face, item->radius, index);
  }
}

/* Sorts by the middles of boxes; equal ones by item, so that the tree is always the same. */
static int compare(const skf_hull *a, const skf_hull *b, int axis) {
  double x = v3_get(a->box.lo, axis) + v3_get(a->box.hi, axis), y = v3_get(b->box.lo, axis) + v3_get(b->box.hi, axis);
  return x < y ? -1 : x > y ? 1 : (a->item > b->item) - (a->item < b->item);
}
static int by_x(const void *a, const void *b) { return compare(a, b, 0); }
static int by_y(const void *a, const void *b) { return compare(a, b, 1); }
static int by_z(const void *a, const void *b) { return compare(a, b, 2); }

static void build(skf_offsets *o, size_t first, size_t count) {
  static int (*const order[3])(const void *, const void *) = {by_x, by_y, by_z};
  size_t here = o->node_count++;
  skf_box all = box_empty(), middles = box_empty();
  for (size_t i = first; i < first + count; i++)
    all = box_join(all, o->hulls[i].box), middles = box_add(middles, box_center(o->hulls[i].box));
  o->nodes[here] = (node){all, first, count};
  if (count <= LEAF) return;
  skf_vec3 s = v3_sub(middles.hi, middles.lo);
  qsort(o->hulls + first, count, sizeof *o->hulls, order[s.x >= s.y && s.x >= s.z ? 0 : s.y >= s.z ? 1 : 2]);
  build(o, first, count / 2);
  o->nodes[here].count = 0, o->nodes[here].first = o->node_count;
  build(o, first + count / 2, count - count / 2);
}

static skf_status check(const skf_offset *item) {
  skf_shape shape = item->primitive.shape;
  bool flat = shape == SKF_TRIANGLE || shape == SKF_PLANE || shape == SKF_SOLID;
  if (!isfinite(item->radius) || item->radius < 0 || (!flat && item->radius == 0)) return SKF_ERR_RANGE;
  return shape == SKF_SOLID ? SKF_OK : skf_primitive_check(&item->primitive, NULL);
}

skf_status skf_offsets_new(const skf_offset *items, size_t n, skf_offsets **out) {
  size_t total = 0;
  *out = NULL;
  for (size_t i = 0; i < n; i++) {
    skf_status s = check(items + i);
    if (s) return s;
    total += hulls_of(items + i);
  }
  skf_offsets *o = skf_alloc(1, sizeof *o);
  if (!o) return SKF_ERR_NOMEM;
  o->hulls = skf_alloc(total, sizeof *o->hulls);
  o->nodes = skf_alloc(2 * total + 1, sizeof *o->nodes);
  if (!o->hulls || !o->nodes) return skf_offsets_free(o), SKF_ERR_NOMEM;
  for (int plane = 0; plane < 2; plane++)
    for (size_t i = 0; i < n; i++)
      if ((items[i].primitive.shape == SKF_PLANE) == plane) add(o, items + i, i), o->endless += plane;
  if (o->n > o->endless) build(o, 0, o->n - o->endless);
  return *out = o, SKF_OK;
}

void skf_offsets_free(skf_offsets *o) {
  if (!o) return;
  skf_free(o->hulls), skf_free(o->nodes);
  skf_free(o);
}

/* Where the ray enters a box; INFINITY when it misses it. */
static double enters(skf_box b, skf_vec3 o, skf_vec3 inverse, double from, double to) {
  for (int k = 0; k < 3; k++) {
    double x = v3_get(o, k), i = v3_get(inverse, k), a = (v3_get(b.lo, k) - x) * i, c = (v3_get(b.hi, k) - x) * i;
    if (isnan(a) || isnan(c)) continue; /* along a face, counts as inside */
    from = fmax(from, fmin(a, c)), to = fmin(to, fmax(a, c));
  }
  return from <= to * (1 + 1e-12) + 1e-300 ? from : INFINITY;
}

typedef struct search {
  skf_vec3 o, d, inverse;
  double from, t; /* t: where the nearest place so far is */
  skf_vec3 normal;
  size_t item;
  bool found;
} search;

static void try_hull(search *s, const skf_hull *h) {
  double rounding = 32 * DBL_EPSILON * fmax(fabs(s->o.x), fmax(fabs(s->o.y), fabs(s->o.z)));
  double own = 1e-9 * h->size + rounding; /* its start may lie on this very hull */
  if (skf_hull_hit(h, s->o, s->d, fmax(s->from, own), &s->t, &s->normal)) s->item = h->item, s->found = true;
}

static void descend(const skf_offsets *o, search *s) {
  size_t stack[DEEP];
  int depth = 0;
  if (o->node_count) stack[depth++] = 0;
  while (depth) {
    const node *at = o->nodes + stack[--depth];
    if (isinf(enters(at->box, s->o, s->inverse, s->from, s->t))) continue;
    for (size_t i = 0; i < at->count; i++) try_hull(s, o->hulls + at->first + i);
    if (at->count) continue;
    size_t a = (size_t)(at - o->nodes) + 1, b = at->first;
    double ta = enters(o->nodes[a].box, s->o, s->inverse, s->from, s->t);
    double tb = enters(o->nodes[b].box, s->o, s->inverse, s->from, s->t);
    bool swap = tb < ta; /* the nearer one is looked at first: it goes on top */
    stack[depth++] = swap ? a : b, stack[depth++] = swap ? b : a;
  }
  for (size_t i = o->n - o->endless; i < o->n; i++) try_hull(s, o->hulls + i);
}

static bool holds(skf_box b, skf_vec3 p) {
  return p.x >= b.lo.x && p.y >= b.lo.y && p.z >= b.lo.z && p.x <= b.hi.x && p.y <= b.hi.y && p.z <= b.hi.z;
}

static bool deep_in(const skf_hull *h, skf_vec3 p) {
  return skf_primitive_distance(&h->primitive, p) < h->radius * (1 - 1e-8);
}

/* Whether a place lies within the union, not on its surface. */
static bool within(const skf_offsets *o, skf_vec3 p) {
  size_t stack[DEEP];
  int depth = 0;
  if (o->node_count) stack[depth++] = 0;
  while (depth) {
    const node *at = o->nodes + stack[--depth];
    if (!holds(at->box, p)) continue;
    for (size_t i = 0; i < at->count; i++)
      if (deep_in(o->hulls + at->first + i, p)) return true;
    if (!at->count) stack[depth++] = (size_t)(at - o->nodes) + 1, stack[depth++] = at->first;
  }
  for (size_t i = o->n - o->endless; i < o->n; i++)
    if (deep_in(o->hulls + i, p)) return true;
  return false;
}

bool skf_offsets_first(const skf_offsets *o, const skf_ray *ray, skf_hit *hit, size_t *item) {
  skf_vec3 d = v3_unit(ray->direction);
  search s = {.o = ray->origin, .d = d, .inverse = {1 / d.x, 1 / d.y, 1 / d.z}, .from = ray->t_min};
  if (!v3_finite(s.o) || !(v3_norm2(d) > 0) || !v3_finite(d)) return false;
  for (;;) {
    s.t = ray->t_max, s.found = false;
    descend(o, &s);
    if (!s.found) return false;
    skf_vec3 at = v3_mad(s.o, s.t, d);
    if (!within(o, at)) {
      *hit = (skf_hit){s.t, at, s.normal, v3_dot(s.normal, d) < 0};
      if (item) *item = s.item;
      return true;
    }
    s.from = s.t; /* it enters or leaves one hull inside of another */
  }
}
