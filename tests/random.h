/* SPDX-License-Identifier: MIT */
/* Seeded random numbers and random primitives. */
#ifndef SKF_TESTS_RANDOM_H
#define SKF_TESTS_RANDOM_H

#include "core/vec3.h"
#include "skelfield/skeleton.h"
#include <stdint.h>

static inline double rnd(uint64_t *state, double lo, double hi) { /* splitmix64 */
  uint64_t z = (*state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return lo + (hi - lo) * ((double)((z ^ (z >> 31)) >> 11) * 0x1p-53);
}

static inline skf_vec3 rnd_vec(uint64_t *state, double size) {
  double x = rnd(state, -size, size), y = rnd(state, -size, size);
  return v3(x, y, rnd(state, -size, size));
}

static inline skf_vec3 rnd_unit(uint64_t *state) {
  double z = rnd(state, -1, 1), phi = rnd(state, -SKF_PI, SKF_PI), r = sqrt(1 - z * z);
  return v3(r * cos(phi), r * sin(phi), z);
}

/* A primitive of the given kind in a cube of half-width `scale`. */
static inline void rnd_primitive(uint64_t *state, skf_shape shape, double scale, skf_primitive *p) {
  *p = (skf_primitive){.shape = shape};
  skf_vec3 a = rnd_vec(state, scale), b = rnd_vec(state, scale), c = rnd_vec(state, scale), n = rnd_unit(state);
  switch (shape) {
  case SKF_POINT: p->point.at = a; break;
  case SKF_SEGMENT: p->segment = (skf_segment){a, b}; break;
  case SKF_ARC: {
    double sweep = rnd(state, 0, 1) < 0.4 ? 2 * SKF_PI : rnd(state, 0.2, 6);
    p->arc = (skf_arc){v3_scale(0.3, a), n, v3_perp(n), scale * rnd(state, 0.3, 1), sweep};
    break;
  }
  case SKF_TRIANGLE: p->triangle = (skf_triangle){{a, b, c}}; break;
  case SKF_PLANE: /* a third of all along an axis, facing either way */
    if (fabs(n.x) > 0.9) n = v3(n.x, 0, 0);
    if (fabs(n.y) > 0.9) n = v3(0, n.y, 0);
    if (fabs(n.z) > 0.9) n = v3(0, 0, n.z);
    p->plane = (skf_plane){v3_scale(0.3, a), n};
    break;
  case SKF_SOLID: /* it has tests of its own */
  case SKF_SHAPE_COUNT: break;
  }
}

#endif
