/* SPDX-License-Identifier: MIT */
/* Rays through the octree, cell by cell in their order. */
#include "core/vec3.h"
#include "ray/walk.h"

typedef struct passage {
  skf_walk *w;
  skf_octree *tree;
  double o[3], per[3]; /* origin, 1 / direction */
  int backwards;       /* a bit for each negative coordinate of the direction */
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

static bool through(passage *p, skf_branch *branch, double a, double b) {
  const double *m = &branch->middle.x;
  double t0 = (m[0] - p->o[0]) * p->per[0], t1 = (m[1] - p->o[1]) * p->per[1], t2 = (m[2] - p->o[2]) * p->per[2];
  while (a < b) {
    int k = ((t0 <= a) | (t1 <= a) << 1 | (t2 <= a) << 2) ^ p->backwards;
    double next = t0 > a && t0 < b ? t0 : b;
    next = t1 > a && t1 < next ? t1 : next;
    next = t2 > a && t2 < next ? t2 : next;
    skf_cell c = skf_octree_child(p->tree, branch, k);
    switch (c & SKF_CELL_KIND) {
    case SKF_CELL_OUTSIDE: p->w->last = -1; break;
    case SKF_CELL_INSIDE: p->w->last = 1; break;
    case SKF_CELL_BRANCH:
      if (!through(p, skf_cell_branch(c), a, next)) return false;
      break;
    case SKF_CELL_LEAF:
      if (!through_leaf(p, skf_cell_leaf(c), a, next)) return false;
      break;
    default:
      if (!walk(p, NULL, a, next)) return false;
    }
    a = next;
  }
  return true;
}

bool skf_walk_octree(skf_walk *w, double from, double to, skf_crossing_fn *found, void *user) {
  skf_octree *tree = w->tracer->tree;
  passage p = {.w = w, .tree = tree, .found = found, .user = user};
  for (int i = 0; i < 3; i++) {
    double d = v3_get(w->direction, i);
    p.o[i] = v3_get(w->origin, i);
    p.per[i] = fabs(d) > 1e-300 ? 1 / d : 1e300; /* what does not move is before a middle or behind it */
    p.backwards |= (d < -1e-300) << i;
  }
  skf_cell cube = skf_octree_child(tree, skf_octree_top(tree), 0);
  switch (cube & SKF_CELL_KIND) {
  case SKF_CELL_OUTSIDE:
  case SKF_CELL_INSIDE: return true;
  case SKF_CELL_BRANCH: return through(&p, skf_cell_branch(cube), from, to);
  case SKF_CELL_LEAF: return through_leaf(&p, skf_cell_leaf(cube), from, to);
  default: return walk(&p, NULL, from, to);
  }
}
