/* SPDX-License-Identifier: MIT */
/* Rays through the octree, cell by cell in their order. */
#include "core/vec3.h"
#include "ray/walk.h"

typedef struct passage {
  skf_walk *w;
  skf_octree *tree;
  double o[3], d[3], per[3]; /* origin, direction, 1 / direction */
  skf_crossing_fn *found;
  void *user;
  skf_knot knot; /* at the end of the last leaf */
} passage;

static bool walk(passage *p, const skf_leaf *leaf, double a, double b) {
  skf_walk *w = p->w;
  skf_knot k = p->knot.known && p->knot.t == a ? p->knot : (skf_knot){.t = a};
  w->leaf = leaf;
  bool on = skf_walk_piece(w, &k, b, p->found, p->user);
  w->leaf = NULL;
  p->knot = k;
  return on;
}

/* A leaf over [a, b]: its linear model tells most rays from the surface. */
static bool through_leaf(passage *p, const skf_leaf *leaf, double a, double b) {
  skf_walk *w = p->w;
  double fa = leaf->f + v3_dot(leaf->g, v3_sub(v3_mad(w->origin, a, w->direction), leaf->center));
  double fb = fa + (b - a) * v3_dot(leaf->g, w->direction);
  if (fmin(fa, fb) > leaf->flat || fmax(fa, fb) < -leaf->flat) {
    w->report.cells++;
    w->last = fa > 0 ? 1 : -1;
    return true;
  }
  return walk(p, leaf->bend < INFINITY || leaf->fourth < INFINITY ? leaf : NULL, a, b);
}

static bool through(passage *p, skf_cell cell, const double lo[3], double size, double a, double b) {
  if (cell.kind == SKF_CELL_LEAF) return through_leaf(p, cell.leaf, a, b);
  if (cell.kind == SKF_CELL_UNKNOWN) return walk(p, NULL, a, b);
  if (cell.kind != SKF_CELL_BRANCH) {
    p->w->last = cell.kind == SKF_CELL_OUTSIDE ? -1 : 1;
    return true;
  }
  double half = 0.5 * size, middle[3], t[3];
  for (int i = 0; i < 3; i++) {
    middle[i] = lo[i] + half;
    t[i] = p->d[i] != 0 ? (middle[i] - p->o[i]) * p->per[i] : p->o[i] < middle[i] ? INFINITY : -INFINITY;
  }
  while (a < b) {
    double next = b, at[3];
    int k = 0;
    for (int i = 0; i < 3; i++) {
      bool passed = t[i] <= a, upper = passed != (p->d[i] < 0);
      if (!passed) next = fmin(next, t[i]);
      at[i] = upper ? middle[i] : lo[i];
      k |= upper << i;
    }
    if (!through(p, skf_octree_child(p->tree, cell.branch, k, at, half), at, half, a, next)) return false;
    a = next;
  }
  return true;
}

bool skf_walk_octree(skf_walk *w, double from, double to, skf_crossing_fn *found, void *user) {
  skf_octree *tree = w->tracer->tree;
  passage p = {.w = w, .tree = tree, .found = found, .user = user};
  for (int i = 0; i < 3; i++) {
    p.o[i] = v3_get(w->origin, i), p.d[i] = v3_get(w->direction, i);
    p.per[i] = 1 / p.d[i];
  }
  skf_vec3 lo;
  double size;
  skf_cell root = skf_octree_root(tree, &lo, &size);
  return through(&p, root, (const double[3]){lo.x, lo.y, lo.z}, size, from, to);
}
