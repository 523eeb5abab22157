/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Congruent skeletons, by three places of each from elements in the same order. */
#include "same_shape.h"
#include "core/vec3.h"

enum { PLACES = 3 };

/* Places that determine an element: ends and middle, corners, or thirds of an arc, which may be closed. */
static skf_vec3 place(const skf_body *b, size_t k) {
  const skf_primitive *p = &b->elements[k / PLACES].primitive;
  if (p->shape == SKF_TRIANGLE) return p->triangle.vertices[k % PLACES];
  return skf_primitive_point(p, (double)(k % PLACES) / (p->shape == SKF_ARC ? PLACES : PLACES - 1), 0);
}

static bool alike(const skf_element *a, const skf_element *b) {
  skf_shape shape = a->primitive.shape;
  bool known = shape == SKF_POINT || shape == SKF_SEGMENT || shape == SKF_ARC || shape == SKF_TRIANGLE;
  return known && shape == b->primitive.shape && !a->profile && !b->profile && a->strength == b->strength &&
         a->kernel.type == b->kernel.type && a->kernel.type != SKF_USER_KERNEL && a->kernel.param == b->kernel.param &&
         (shape != SKF_ARC || fabs(a->primitive.arc.sweep) == fabs(b->primitive.arc.sweep));
}

typedef struct frame {
  skf_vec3 o, x, y, z;
} frame;

static frame frame_of(const skf_body *b, size_t i, size_t j, size_t k) {
  frame f = {.o = place(b, i)};
  f.x = v3_unit(v3_sub(place(b, j), f.o));
  f.z = v3_unit(v3_cross(f.x, v3_sub(place(b, k), f.o)));
  f.y = v3_cross(f.z, f.x);
  return f;
}

/* A direction of one frame in the other. */
static skf_vec3 carry(const frame *a, const frame *b, skf_vec3 v) {
  double x = v3_dot(v, a->x), y = v3_dot(v, a->y), z = v3_dot(v, a->z);
  return v3_add(v3_scale(x, b->x), v3_add(v3_scale(y, b->y), v3_scale(z, b->z)));
}

/* The place farthest from the first one, and that farthest from the line through both. */
static void choose(const skf_body *a, size_t n, size_t *j, size_t *k) {
  skf_vec3 o = place(a, 0), x;
  *j = *k = 0;
  for (size_t i = 1; i < n; i++)
    if (v3_dist(place(a, i), o) > v3_dist(place(a, *j), o)) *j = i;
  x = v3_unit(v3_sub(place(a, *j), o));
  for (size_t i = 1; i < n; i++)
    if (v3_norm(v3_cross(x, v3_sub(place(a, i), o))) > v3_norm(v3_cross(x, v3_sub(place(a, *k), o)))) *k = i;
}

static skf_vec3 row(const double I[6], int i) {
  return i == 0 ? v3(I[0], I[1], I[2]) : i == 1 ? v3(I[1], I[3], I[4]) : v3(I[2], I[4], I[5]);
}

/* R I R^T by its values for the axes. */
static void turn_inertia(const frame *a, const frame *b, const double I[6], double out[6]) {
  const skf_vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  int n = 0;
  for (int i = 0; i < 3; i++)
    for (int j = i; j < 3; j++) {
      skf_vec3 u = carry(b, a, axes[i]), v = carry(b, a, axes[j]);
      out[n++] = v3_dot(u, v3(v3_dot(row(I, 0), v), v3_dot(row(I, 1), v), v3_dot(row(I, 2), v)));
    }
}

bool same_shape(const skf_body *a, const skf_body *b, const skf_mass *of_a, skf_mass *of_b) {
  size_t n = a->element_count * PLACES, j, k;
  if (b->element_count != a->element_count || a->iso != b->iso || n == 0) return false;
  for (size_t i = 0; i < a->element_count; i++)
    if (!alike(a->elements + i, b->elements + i)) return false;
  choose(a, n, &j, &k);
  frame f = frame_of(a, 0, j, k), g = frame_of(b, 0, j, k);
  double size = v3_dist(place(a, j), f.o);
  if (!(v3_norm(f.z) > 0.5 && v3_norm(g.z) > 0.5)) return false; /* all on a line */
  for (size_t i = 0; i < n; i++) {
    skf_vec3 want = v3_add(g.o, carry(&f, &g, v3_sub(place(a, i), f.o)));
    if (!(v3_dist(want, place(b, i)) <= 1e-10 * size)) return false;
  }
  *of_b = *of_a;
  of_b->center = v3_add(g.o, carry(&f, &g, v3_sub(of_a->center, f.o)));
  turn_inertia(&f, &g, of_a->inertia, of_b->inertia);
  return true;
}
