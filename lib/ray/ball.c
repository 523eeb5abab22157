/* SPDX-License-Identifier: MIT */
#include "ray/ball.h"
#include "core/vec3.h"

/* Cells whose edge is smaller than this part of a ball's radius are not looked at: halving the ball is cheaper. */
#define FINEST 0.5

enum { MEETS_OUTSIDE = 1, MEETS_INSIDE = 2, MEETS_SURFACE = 4, MEETS_LEAF = 8, MEETS_BOTH = 3 };

typedef struct query {
  skf_octree *tree;
  skf_vec3 p;
  double r;
} query;

/* By how much x is outside of [lo, lo + edge]. */
static inline double apart(double x, double lo, double edge) {
  double below = lo - x, above = x - lo - edge;
  return below > 0 ? below : above > 0 ? above : 0;
}

static bool reaches(const query *q, skf_vec3 lo, double edge) {
  double x = apart(q->p.x, lo.x, edge), y = apart(q->p.y, lo.y, edge), z = apart(q->p.z, lo.z, edge);
  return x * x + y * y + z * z <= q->r * q->r * (1 + 1e-12);
}

static bool holds(const query *q, skf_vec3 lo, double edge) {
  double x = q->p.x - lo.x, y = q->p.y - lo.y, z = q->p.z - lo.z, r = q->r, s = edge - r;
  return x >= r && y >= r && z >= r && x <= s && y <= s && z <= s;
}

/* The linear model of a leaf over what of the ball is in it. */
static int in_leaf(const query *q, const skf_leaf *l) {
  double f = l->f + v3_dot(l->g, v3_sub(q->p, l->center)), change = v3_norm(l->g) * q->r * (1 + 1e-12) + l->flat;
  return f < -change ? MEETS_OUTSIDE : f > change ? MEETS_INSIDE : MEETS_SURFACE | MEETS_LEAF;
}

static skf_vec3 corner(const skf_branch *b, int k) {
  return v3(b->middle.x - (k & 1 ? 0 : b->half), b->middle.y - (k & 2 ? 0 : b->half),
            b->middle.z - (k & 4 ? 0 : b->half));
}

static int in_branch(const query *q, skf_branch *b, int met);

static int in_cell(const query *q, skf_cell c, int met) {
  switch (c & SKF_CELL_KIND) {
  case SKF_CELL_OUTSIDE: return met | MEETS_OUTSIDE;
  case SKF_CELL_INSIDE: return met | MEETS_INSIDE;
  case SKF_CELL_LEAF: return met | in_leaf(q, skf_cell_leaf(c));
  case SKF_CELL_BRANCH: return in_branch(q, skf_cell_branch(c), met);
  default: return met | MEETS_SURFACE | MEETS_LEAF;
  }
}

/* What the ball meets in a branch; the child with the center comes first. */
static int in_branch(const query *q, skf_branch *b, int met) {
  if (b->half < FINEST * q->r) return met | MEETS_SURFACE;
  int first = (q->p.x > b->middle.x) | (q->p.y > b->middle.y) << 1 | (q->p.z > b->middle.z) << 2;
  for (int i = 0; i < 8; i++) {
    int k = first ^ i;
    if (!reaches(q, corner(b, k), b->half)) continue;
    met = in_cell(q, skf_octree_child(q->tree, b, k), met);
    if ((met & MEETS_SURFACE) || (met & MEETS_BOTH) == MEETS_BOTH) return met | MEETS_SURFACE;
  }
  return met;
}

skf_ball skf_octree_ball(skf_octree *tree, skf_vec3 center, double radius) {
  skf_branch *b = skf_octree_top(tree);
  query q = {tree, center, radius};
  skf_ball ball = {.list = b->list, .count = b->count};
  int met = 0, k = 0;
  if (!holds(&q, corner(b, 0), b->half)) {
    met = skf_octree_beyond(tree) < 0 ? MEETS_OUTSIDE : MEETS_INSIDE;
    if (reaches(&q, corner(b, 0), b->half)) met = in_cell(&q, skf_octree_child(tree, b, 0), met);
  } else {
    for (;;) { /* down to the smallest branch that holds it */
      skf_cell c = skf_octree_child(tree, b, k);
      if ((c & SKF_CELL_KIND) == SKF_CELL_LEAF) ball.leaf = skf_cell_leaf(c);
      if (skf_cell_is_leaf(c)) ball.list = skf_cell_leaf(c)->list, ball.count = skf_cell_leaf(c)->count;
      if ((c & SKF_CELL_KIND) != SKF_CELL_BRANCH) {
        met = in_cell(&q, c, 0);
        break;
      }
      b = skf_cell_branch(c), ball.list = b->list, ball.count = b->count;
      k = (center.x > b->middle.x) | (center.y > b->middle.y) << 1 | (center.z > b->middle.z) << 2;
      if (holds(&q, corner(b, k), b->half)) continue;
      met = in_branch(&q, b, 0);
      break;
    }
  }
  ball.side = met == MEETS_OUTSIDE ? -1 : met == MEETS_INSIDE ? 1 : 0;
  ball.exhausted = met & MEETS_LEAF;
  return ball;
}

skf_outlook skf_octree_enclose(const skf_octree *tree, const skf_ball *ball, skf_vec3 center, double radius) {
  skf_outlook o = {0, 0, 0, 0, 0};
  for (uint32_t i = 0; i < ball->count; i++) skf_octree_add(tree, ball->list[i], center, radius, &o);
  return o;
}
