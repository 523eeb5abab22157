/* SPDX-License-Identifier: MIT */
#include "ray/source.h"
#include "core/alloc.h"
#include "core/vec3.h"
#include "field/bound.h"
#include "field/kernel.h"
#include "field/solid.h"
#include "skeleton/shape.h"
#include <float.h>
#include <stdint.h>
#include <string.h>

enum { PER_OCTAVE = 8 };

/* The nearest point of the primitive is at most d away; the measure within a length s of that point is at least
   mu (s / size)^power: one way along a segment, both ways around a circle, a triangle shrunk towards the point. */
static double infimum(const skf_source *s, double d) {
  skf_shape shape = s->element.primitive.shape;
  if (shape == SKF_SOLID) return s->measure / (d + 2 * s->reach) * (1 - 1e-12);
  if (d >= skf_kernel_end(s->element.kernel)) return 0;
  double size = shape == SKF_TRIANGLE ? 2 * s->reach : s->whole ? 0.5 * s->measure : s->measure, sum = 0, part[4];
  if (shape == SKF_POINT) {
    skf_kernel_eval(s->element.kernel, d * d, part);
    return part[0] * (1 - 1e-12);
  }
  double outer = 1, inner; /* lengths from the point, in units of size, downwards by half octaves */
  do {
    inner = outer * size > 0.1 * d && outer > 1e-18 ? 0.70710678118654752 * outer : 0;
    double r = d + outer * size;
    skf_kernel_eval(s->element.kernel, r * r, part);
    sum += (shape == SKF_TRIANGLE ? outer * outer - inner * inner : outer - inner) * part[0];
    outer = inner;
  } while (outer > 0);
  return s->measure * sum * (1 - 1e-12);
}

static void set_steps(skf_source *s) {
  double width = skf_kernel_width(s->element.kernel), size = 2 * s->reach;
  double first = width > 0 ? width / 16 : size / 4096;
  double last = fmin(8 * fmax(width, size), skf_kernel_end(s->element.kernel)); /* beyond there is nothing */
  last = fmax(last, first); /* of a user's kernel the width may be said wrongly */
  s->unit = exp2(floor(log2(first)));
  s->grades = (size_t)fmin(PER_OCTAVE * (1 + ceil(log2(last / s->unit))), 40 * PER_OCTAVE);
}

/* The table, or NULL when memory is out; made by whoever needs it first. Blobs in an octree never do. */
static const skf_grade *table_of(const skf_source *s) {
  _Atomic(skf_grade *) *place = &((skf_source *)(uintptr_t)s)->grade;
  skf_grade *g = atomic_load_explicit(place, memory_order_acquire), *other = NULL;
  if (g || !(g = skf_alloc(s->grades, sizeof *g))) return g;
  for (size_t i = 0; i < s->grades; i++) {
    double octave = ldexp(s->unit, (int)(i / PER_OCTAVE)), step = octave / PER_OCTAVE;
    double d = octave + (double)(i % PER_OCTAVE) * step;
    g[i].above = skf_element_reach(&s->element, d);
    g[i].below = infimum(s, d + step);
  }
  if (atomic_compare_exchange_strong(place, &other, g)) return g;
  skf_free(g); /* somebody else was faster */
  return other;
}

static void set_edges(skf_source *s) {
  const skf_vec3 *v = s->element.primitive.triangle.vertices;
  skf_vec3 n = v3_unit(v3_cross(v3_sub(v[1], v[0]), v3_sub(v[2], v[0]))), out[3];
  for (int i = 0; i < 3; i++) {
    out[i] = v3_unit(v3_cross(v3_sub(v[(i + 1) % 3], v[i]), n));
    s->edge[i] = fmax(v3_dot(out[i], v[i]), fmax(v3_dot(out[i], v[(i + 1) % 3]), v3_dot(out[i], v[(i + 2) % 3])));
  }
  s->a = out[0], s->b = out[1], s->c = out[2];
  bool sliver = !(s->measure > 1e-3 * s->reach * s->reach); /* its plane is not known well enough */
  s->aside = !sliver && skf_compact_bend(SKF_TRIANGLE, s->element.kernel, 0) < INFINITY;
}

static void frame(skf_source *s) {
  const skf_primitive *p = &s->element.primitive;
  if (p->shape == SKF_SEGMENT) {
    s->a = p->segment.from;
    s->b = v3_unit(v3_sub(p->segment.to, p->segment.from));
    s->length = s->measure;
  } else if (p->shape == SKF_ARC) {
    skf_arc_axes x = skf_arc_frame(&p->arc);
    double half = 0.5 * p->arc.sweep; /* a: towards the middle of the arc */
    s->a = v3_mad(v3_scale(cos(half), x.e), sin(half), x.f);
    s->b = x.n;
    s->c = p->arc.center;
    s->length = p->arc.radius;
    s->cosine = cos(half);
    s->whole = p->arc.sweep >= 2 * SKF_PI;
  } else if (p->shape == SKF_TRIANGLE) {
    s->disc = s->element.kernel.type == SKF_INVERSE_SQUARED;
    s->sheet = s->element.kernel.type == SKF_INVERSE;
    set_edges(s);
  } else if (p->shape == SKF_SOLID) {
    s->bulk = true;
  } else if (p->shape == SKF_PLANE) {
    s->a = p->plane.through;
    s->b = v3_unit(p->plane.normal);
  }
}

void skf_source_init(const skf_element *element, skf_source *s) {
  *s = (skf_source){.element = *element, .weight = element->strength};
  const skf_primitive *p = &s->element.primitive;
  skf_weight_range w = skf_element_weights(element);
  s->least = w.lo, s->most = w.hi;
  s->measure = skf_primitive_measure(p);
  if (p->shape == SKF_PLANE) {
    s->reach = INFINITY;
  } else {
    skf_box b = skf_primitive_bounds(p);
    s->middle = box_center(b);
    s->reach = fmin(0.5 * box_diagonal(b), skf_primitive_distance_max(p, s->middle)) * (1 + 1e-12);
  }
  s->end = (s->reach + skf_kernel_end(element->kernel)) * (1 + 1e-12);
  frame(s);
  if (p->shape != SKF_PLANE && p->shape != SKF_POINT) set_steps(s);
}

void skf_source_free(skf_source *s) { skf_free(s->grade); }

static double to_arc(const skf_source *s, skf_vec3 x) {
  skf_vec3 d = v3_sub(x, s->c);
  double z = v3_dot(d, s->b), k = sqrt(fmax(v3_norm2(d) - z * z, 0)), out = k - s->length;
  if (s->whole || v3_dot(d, s->a) >= k * s->cosine) return sqrt(out * out + z * z);
  return skf_primitive_distance(&s->element.primitive, x);
}

double skf_source_distance(const skf_source *s, skf_vec3 x) {
  switch (s->element.primitive.shape) {
  case SKF_POINT: return v3_dist(x, s->element.primitive.point.at);
  case SKF_SEGMENT: {
    skf_vec3 d = v3_sub(x, s->a);
    double u = fmin(fmax(v3_dot(d, s->b), 0), s->length);
    return v3_norm(v3_mad(d, -u, s->b));
  }
  case SKF_ARC: return to_arc(s, x);
  case SKF_PLANE: return fabs(v3_dot(v3_sub(x, s->a), s->b));
  default: return skf_primitive_distance(&s->element.primitive, x);
  }
}

double skf_source_descent(const skf_source *s, skf_vec3 direction) {
  double c = v3_dot(direction, s->b);
  return fabs(c) > 4 * DBL_EPSILON ? c : 0;
}

double skf_source_disc(const skf_source *s, skf_vec3 x, double radius) {
  const skf_vec3 *v = s->element.primitive.triangle.vertices;
  skf_vec3 n = v3_unit(v3_cross(v3_sub(v[1], v[0]), v3_sub(v[2], v[0])));
  double z = fabs(v3_dot(v3_sub(x, v[0]), n)) + radius, rho = INFINITY;
  for (int i = 0; i < 3; i++) {
    skf_vec3 inward = v3_unit(v3_cross(n, v3_sub(v[(i + 1) % 3], v[i])));
    rho = fmin(rho, v3_dot(v3_sub(x, v[i]), inward) - radius);
  }
  return rho > 0 ? SKF_PI * log1p(rho * rho / (z * z)) * (1 - 1e-12) : 0;
}

double skf_source_steepness(const skf_source *s, skf_vec3 x, double radius) {
  const skf_vec3 *v = s->element.primitive.triangle.vertices;
  double sum = 2 * SKF_PI;
  for (int i = 0; i < 3; i++) { /* an edge is worst beside its middle: 2 asinh(half / distance) */
    skf_primitive edge = {.shape = SKF_SEGMENT, .segment = {v[i], v[(i + 1) % 3]}};
    double d = skf_primitive_distance(&edge, x) * (1 - 1e-12) - radius;
    if (!(d > 0)) return INFINITY;
    sum += 2 * asinh(0.5 * v3_dist(v[i], v[(i + 1) % 3]) / d);
  }
  return sum * (1 + 1e-12);
}

/* A circle of radius r <= R about the foot of x, which is at least t beyond an edge's line, is beyond that line with a
   part acos(t / r) / pi. */
double skf_source_aside(const skf_source *s, skf_vec3 x, double radius, double near) {
  double t = fmax(v3_dot(s->a, x) - s->edge[0], fmax(v3_dot(s->b, x) - s->edge[1], v3_dot(s->c, x) - s->edge[2]));
  double R = skf_kernel_end(s->element.kernel), size = v3_norm(x) + v3_norm(s->middle) + s->reach + R;
  t -= radius + 4e-12 * size;
  if (!(t > 0)) return INFINITY;
  if (t >= R) return 0;
  return skf_compact_bend(SKF_TRIANGLE, s->element.kernel, near) * (acos(t / R) / SKF_PI) * (1 + 1e-12);
}

skf_envelope skf_source_bulk(const skf_source *s, skf_vec3 x, double radius) {
  return skf_solid_around(s->element.primitive.solid, x, radius);
}

/* Grade whose distance is the largest <= d; below the table: -1, beyond: grades. */
static long bin(const skf_source *s, double d) {
  double q = d / s->unit;
  if (!(q >= 1)) return -1;
  if (q >= 0x1p60) return (long)s->grades;
  uint64_t bits;
  memcpy(&bits, &q, sizeof bits);
  long k = (long)((bits >> 49) - ((uint64_t)1023 << 3)); /* exponent and three bits of the fraction */
  return k < (long)s->grades ? k : (long)s->grades;
}

static skf_envelope scaled(double mu, skf_envelope e) {
  return (skf_envelope){mu * e.value, mu * e.slope, mu * e.bend, mu * e.fourth};
}

skf_grade skf_source_grade(const skf_source *s, double near, double far) {
  const skf_element *e = &s->element;
  skf_shape shape = e->primitive.shape;
  skf_grade g;
  if (shape == SKF_PLANE) {
    g.above = skf_plane_envelope(e->kernel, near);
    g.below = skf_plane_envelope(e->kernel, far).value;
  } else if (shape == SKF_POINT) {
    g.above = skf_kernel_envelope(e->kernel, near);
    g.below = infimum(s, far);
  } else {
    long k = bin(s, near), m = bin(s, far), end = (long)s->grades;
    const skf_grade *table = (k >= 0 && k < end) || (m >= 0 && m < end) ? table_of(s) : NULL;
    if (k >= end)
      g.above = scaled(s->measure, skf_kernel_envelope(e->kernel, near));
    else
      g.above = k < 0 || !table ? skf_element_reach(e, near) : table[k].above;
    g.below = m >= 0 && m < end && table ? table[m].below : infimum(s, far);
    if (far > 1e300) g.below = 0;
  }
  double spread = shape == SKF_PLANE ? 0 : 2 * s->reach;
  if (skf_kernel_kinked(e->kernel, near, far + spread)) g.above.fourth = INFINITY;
  return g;
}
