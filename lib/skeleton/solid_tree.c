/* SPDX-License-Identifier: MIT */
/* The tree of boxes over a solid's faces, and what is asked of it. */
#include "core/alloc.h"
#include "skeleton/solid.h"
#include "skeleton/shape.h"
#include <stdint.h>

/* The tree's depth: its halves differ by a block at most. */
enum { LEAF = 4, STACK = 96 };

/* fmin and fmax are calls that look for NaN. */
static double low(double a, double b) { return a < b ? a : b; }
static double high(double a, double b) { return a > b ? a : b; }
static skf_box joined(skf_box a, skf_box b) {
  return (skf_box){{low(a.lo.x, b.lo.x), low(a.lo.y, b.lo.y), low(a.lo.z, b.lo.z)},
                   {high(a.hi.x, b.hi.x), high(a.hi.y, b.hi.y), high(a.hi.z, b.hi.z)}};
}
static skf_box added(skf_box a, skf_vec3 p) { return joined(a, (skf_box){p, p}); }

static skf_box box_of(const skf_solid_mesh *m, const unsigned t[3]) {
  return added(added((skf_box){m->v[t[0]], m->v[t[0]]}, m->v[t[1]]), m->v[t[2]]);
}

/* Centre of the box of a face, twice. */
static double key_of(const skf_solid_mesh *m, const unsigned t[3], int axis) {
  double a = v3_get(m->v[t[0]], axis), b = v3_get(m->v[t[1]], axis), c = v3_get(m->v[t[2]], axis);
  return low(a, low(b, c)) + high(a, high(b, c));
}

static void swap(unsigned (*f)[3], size_t i, size_t j) {
  for (int k = 0; k < 3; k++) {
    unsigned t = f[i][k];
    f[i][k] = f[j][k], f[j][k] = t;
  }
}

/* Puts the `half` smallest keys first [Hoare 1961]. */
static void select_half(const skf_solid_mesh *m, unsigned (*f)[3], size_t n, size_t half, int axis) {
  size_t lo = 0, hi = n - 1;
  while (lo < hi) {
    double pivot = key_of(m, f[lo + (hi - lo) / 2], axis);
    size_t i = lo, j = hi;
    for (;;) {
      while (key_of(m, f[i], axis) < pivot) i++;
      while (key_of(m, f[j], axis) > pivot) j--;
      if (i >= j) break;
      swap(f, i++, j--);
    }
    if (half <= j)
      hi = j;
    else
      lo = j + 1;
  }
}

/* Halves a range of faces, above the size of a block at a multiple of it. */
static unsigned build(skf_solid_mesh *m, skf_solid_node *nodes, unsigned at, unsigned first, unsigned n) {
  skf_solid_node *x = nodes + at;
  *x = (skf_solid_node){.box = box_empty(), .first = first, .count = n};
  skf_box centers = box_empty();
  for (unsigned i = first; i < first + n; i++) {
    skf_box b = box_of(m, m->f[i]);
    x->box = joined(x->box, b), centers = added(centers, box_center(b));
  }
  if (n <= LEAF) return at + 1;
  skf_vec3 d = v3_sub(centers.hi, centers.lo);
  int axis = d.x >= d.y && d.x >= d.z ? 0 : d.y >= d.z ? 1 : 2;
  unsigned half = n <= SKF_SOLID_BLOCK ? n / 2 : (n / SKF_SOLID_BLOCK + 1) / 2 * SKF_SOLID_BLOCK;
  select_half(m, m->f + first, n, half, axis);
  unsigned right = build(m, nodes, at + 1, first, half);
  nodes[at].right = right;
  return build(m, nodes, right, first + half, n - half);
}

skf_status skf_solid_tree(skf_solid_mesh *m, skf_solid_node **nodes) {
  *nodes = skf_alloc(2 * m->nf, sizeof **nodes);
  if (!*nodes) return SKF_ERR_NOMEM;
  build(m, *nodes, 0, 0, (unsigned)m->nf);
  return SKF_OK;
}

static double square(double x) { return x * x; }

static double to_box2(const skf_box *b, skf_vec3 x) {
  double sum = 0;
  for (int k = 0; k < 3; k++)
    sum += square(high(0, high(v3_get(b->lo, k) - v3_get(x, k), v3_get(x, k) - v3_get(b->hi, k))));
  return sum;
}

static double to_far_corner2(const skf_box *b, skf_vec3 x) {
  double sum = 0;
  for (int k = 0; k < 3; k++)
    sum += square(high(fabs(v3_get(b->lo, k) - v3_get(x, k)), fabs(v3_get(x, k) - v3_get(b->hi, k))));
  return sum;
}

/* The least of a measure of the faces, which is at least the distance to their boxes; those at `best` or farther are
   not looked at. */
typedef double face_measure(const skf_solid *s, unsigned face, skf_vec3 x);

static double nearest(const skf_solid *s, skf_vec3 x, face_measure *measure, double best) {
  unsigned stack[STACK], depth = 0;
  stack[depth++] = 0;
  while (depth) {
    const skf_solid_node *n = s->nodes + stack[--depth];
    if (to_box2(&n->box, x) >= best * best) continue;
    if (!n->right) {
      for (unsigned i = n->first; i < n->first + n->count; i++) best = fmin(best, measure(s, i, x));
      continue;
    }
    unsigned left = (unsigned)(n - s->nodes) + 1;
    bool swapped = to_box2(&s->nodes[left].box, x) > to_box2(&s->nodes[n->right].box, x);
    stack[depth++] = swapped ? left : n->right; /* the nearer one is taken first */
    stack[depth++] = swapped ? n->right : left;
  }
  return best;
}

static double to_face(const skf_solid *s, unsigned face, skf_vec3 x) {
  const unsigned *t = s->faces[face];
  skf_primitive p = {.shape = SKF_TRIANGLE, .triangle = {{s->vertices[t[0]], s->vertices[t[1]], s->vertices[t[2]]}}};
  return skf_shape_triangle.distance(&p, x);
}

static double to_edges(const skf_solid *s, unsigned face, skf_vec3 x) {
  double d = INFINITY;
  for (int i = 0; i < 3; i++) {
    if (!(s->sharp[face] >> i & 1)) continue;
    skf_primitive p = {.shape = SKF_SEGMENT,
                       .segment = {s->vertices[s->faces[face][i]], s->vertices[s->faces[face][(i + 1) % 3]]}};
    d = fmin(d, skf_shape_segment.distance(&p, x));
  }
  return d;
}

double skf_solid_to_surface(const skf_solid *s, skf_vec3 x) { return nearest(s, x, to_face, INFINITY); }
double skf_solid_to_edges(const skf_solid *s, skf_vec3 x, double upto) { return nearest(s, x, to_edges, upto); }

size_t skf_solid_faces_within(const skf_solid *s, skf_vec3 x, double r, size_t most) {
  unsigned stack[STACK], depth = 0;
  size_t count = 0;
  stack[depth++] = 0;
  while (depth && count < most) {
    const skf_solid_node *n = s->nodes + stack[--depth];
    if (to_box2(&n->box, x) >= r * r) continue;
    if (n->right)
      stack[depth++] = n->right, stack[depth++] = (unsigned)(n - s->nodes) + 1;
    else
      for (unsigned i = n->first; i < n->first + n->count; i++) count += to_face(s, i, x) < r;
  }
  return count;
}

double skf_solid_distance_max(const skf_solid *s, skf_vec3 x) {
  unsigned stack[STACK], depth = 0;
  double best = 0;
  stack[depth++] = 0;
  while (depth) {
    const skf_solid_node *n = s->nodes + stack[--depth];
    if (to_far_corner2(&n->box, x) <= best * best) continue;
    if (n->right)
      stack[depth++] = n->right, stack[depth++] = (unsigned)(n - s->nodes) + 1;
    else
      for (unsigned i = n->first; i < n->first + n->count; i++)
        for (int k = 0; k < 3; k++) best = fmax(best, v3_dist(x, s->vertices[s->faces[i][k]]));
  }
  return best;
}

/* A line through x in direction u against one face: the sign of the crossing ahead, 0: none; 2: too close to an edge,
   or to x, to tell. */
static int crossing(const skf_solid *s, unsigned face, skf_vec3 x, skf_vec3 u) {
  const unsigned *t = s->faces[face];
  skf_vec3 a[3];
  double size = 0, part[3];
  for (int i = 0; i < 3; i++) a[i] = v3_sub(s->vertices[t[i]], x), size = fmax(size, v3_norm(a[i]));
  double slack = 1e-14 * size * size;
  int plus = 0, minus = 0;
  for (int i = 0; i < 3; i++) {
    part[i] = v3_dot(u, v3_cross(a[i], a[(i + 1) % 3]));
    plus += part[i] > slack, minus += part[i] < -slack;
  }
  if (plus && minus) return 0;
  if (plus + minus < 3) return 2;
  double height = v3_dot(a[0], v3_cross(a[1], a[2])) / (part[0] + part[1] + part[2]); /* along u */
  if (fabs(height) <= 1e-14 * size) return 2;
  return height < 0 ? 0 : plus ? 1 : -1;
}

/* Whether the ray meets the box, with slack. */
static bool meets(const skf_box *b, skf_vec3 x, skf_vec3 u, double slack) {
  double from = 0, to = INFINITY;
  for (int k = 0; k < 3; k++) {
    double o = v3_get(x, k), d = v3_get(u, k), lo = (v3_get(b->lo, k) - slack - o) / d,
           hi = (v3_get(b->hi, k) + slack - o) / d;
    from = fmax(from, fmin(lo, hi)), to = fmin(to, fmax(lo, hi));
  }
  return from <= to;
}

static bool count_along(const skf_solid *s, skf_vec3 x, skf_vec3 u, int *winding) {
  unsigned stack[STACK], depth = 0;
  double slack = 1e-12 * (s->radius + v3_dist(x, s->info.center));
  *winding = 0;
  stack[depth++] = 0;
  while (depth) {
    const skf_solid_node *n = s->nodes + stack[--depth];
    if (!meets(&n->box, x, u, slack)) continue;
    if (n->right) {
      stack[depth++] = n->right, stack[depth++] = (unsigned)(n - s->nodes) + 1;
      continue;
    }
    for (unsigned i = n->first; i < n->first + n->count; i++) {
      int c = crossing(s, i, x, u);
      if (c == 2) return false;
      *winding += c;
    }
  }
  return true;
}

bool skf_solid_contains(const skf_solid *s, skf_vec3 x) {
  const skf_box *b = &s->info.bounds;
  if (!(x.x > b->lo.x && x.y > b->lo.y && x.z > b->lo.z && x.x < b->hi.x && x.y < b->hi.y && x.z < b->hi.z))
    return false;
  int winding;
  uint64_t state = 88172645463325252u;
  for (int i = 0; i < 24; i++) {
    double u[3];
    for (int k = 0; k < 3; k++) { /* xorshift: some direction off the axes */
      state ^= state << 13, state ^= state >> 7, state ^= state << 17;
      u[k] = 0.1 + (double)(state >> 11) * 0x1p-53;
      if (state & 1) u[k] = -u[k];
    }
    if (count_along(s, x, v3_unit(v3(u[0], u[1], u[2])), &winding)) return winding > 0;
  }
  double sum = 0; /* on the surface, or next to it */
  for (size_t i = 0; i < s->face_count; i++) {
    const unsigned *t = s->faces[i];
    sum += skf_solid_winding(v3_sub(s->vertices[t[0]], x), v3_sub(s->vertices[t[1]], x), v3_sub(s->vertices[t[2]], x));
  }
  return sum > 0.5;
}
