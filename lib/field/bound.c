/* SPDX-License-Identifier: MIT */
/* Enclosures of fields in balls. A decreasing envelope M(r) of the kernel is summed over shells around the ball's
   center: integral of M dmu <= sum_k M(r_k) (m(r_k+1) - m(r_k)), where m(r) is at least the measure within r. */
#include "field/bound.h"
#include "field/kernel.h"
#include "core/vec3.h"
#include "field/weight.h"
#include "field/solid.h"

/* By how much each shell is thicker than the last: quick, for tables, for regions. */
#define COARSE 1.5
#define MEDIUM 1.2
#define FINE   1.05

/* How much of a primitive can lie within a distance r of a point. */
typedef struct reach {
  skf_shape shape;
  double total, near, far; /* measure; distances from the point */
  double h2, t0, t1;       /* segment: squared distance to its line, abscissae of its ends */
  double rho, k;           /* arc: its radius and the distance from its axis; k < 0: the worst one */
  bool beyond;             /* not a point, but all places at a height of at least `near` above a plane that the */
  double lean;             /* primitive does not reach over; |cosine| between the up and the segment or arc's normal */
} reach;

static reach reach_from(const skf_primitive *p, skf_vec3 x) {
  reach r = {.shape = p->shape,
             .total = skf_primitive_measure(p),
             .near = skf_primitive_distance(p, x),
             .far = skf_primitive_distance_max(p, x)};
  if (p->shape == SKF_SEGMENT) {
    skf_vec3 a = v3_unit(v3_sub(p->segment.to, p->segment.from));
    r.t0 = v3_dot(v3_sub(p->segment.from, x), a);
    r.t1 = v3_dot(v3_sub(p->segment.to, x), a);
    r.h2 = v3_norm2(v3_cross(v3_sub(p->segment.from, x), a));
  } else if (p->shape == SKF_ARC) {
    skf_vec3 n = v3_unit(p->arc.normal), d = v3_sub(x, p->arc.center);
    double z = v3_dot(d, n), k = v3_norm(v3_cross(d, n));
    r.rho = p->arc.radius, r.k = k;
    r.h2 = (k - r.rho) * (k - r.rho) + z * z;
  } else if (p->shape == SKF_TRIANGLE) {
    r.h2 = r.near * r.near; /* it is convex: all of it is beyond the plane across its nearest point */
  }
  return r;
}

/* r^2 = r_near^2 + 4 rho k sin^2(half the azimuth) on the circle. Over all places at a distance >= near the widest part
   of the arc is within r at k = min(rho - near, sqrt(rho^2 - r^2)). */
static double arc_within(const reach *m, double r, double T2) {
  double k = m->k;
  if (k < 0) {
    if (r >= m->rho) return m->total;
    k = fmin(m->rho - m->near, sqrt((m->rho - r) * (m->rho + r)));
    T2 = fmax(r * r - (m->rho - k) * (m->rho - k), 0);
  }
  double s2 = T2 / (4 * m->rho * k);
  return s2 < 1 ? 4 * m->rho * asin(sqrt(s2)) : m->total;
}

/* From above: a segment whose upper end is at height 0 and goes down by `lean` of its length. The best place is
   straight above the farthest point in reach, or where the part in reach starts at the upper end. */
static double segment_beyond(const reach *m, double r, double T2) {
  double c = m->lean, farthest = r - m->near;
  if (farthest <= 2 * r * c * c) return farthest / c;
  return 2 * fmax(sqrt((1 - c * c) * T2) - m->near * c, 0);
}

/* From above: with P = rho + near sin and the best distance y from the axis, r^2 = near^2 + 2 rho (P + y) sin^2(half).
 */
static double arc_beyond(const reach *m, double T2) {
  double P = m->rho + m->near * sqrt(1 - m->lean * m->lean), y2 = P * P - m->lean * m->lean * T2;
  double s2 = y2 > 0 ? T2 / (2 * m->rho * (P + sqrt(y2))) : 1;
  return s2 < 1 ? 4 * m->rho * asin(sqrt(s2)) : m->total;
}

static double within(const reach *m, double r) {
  double T2 = fmax(r * r - m->h2, 0);
  if (r >= m->far) return m->total;
  if (m->beyond) return fmin(m->total, m->shape == SKF_SEGMENT ? segment_beyond(m, r, T2) : arc_beyond(m, T2));
  switch (m->shape) {
  case SKF_SEGMENT: {
    double T = sqrt(T2);
    return fmin(m->total, fmax(fmin(m->t1, T) - fmax(m->t0, -T), 0));
  }
  case SKF_ARC: return fmin(m->total, arc_within(m, r, T2));
  case SKF_TRIANGLE: return fmin(m->total, SKF_PI * T2);
  default: return m->total;
  }
}

/* Sums the envelope over shells whose thickness grows with the distance. */
static skf_envelope shells(skf_kernel k, const reach *m, double radius, double growth) {
  skf_envelope sum = {0, 0, 0, 0};
  double r = m->near, width = skf_kernel_width(k), done = 0;
  double step = fmax(r - radius, width), T = (growth - 1) * sqrt(step * (1.6 * r + 0.4 * step)), base = r * r;
  if (!(step > 0)) return (skf_envelope){INFINITY, INFINITY, INFINITY, INFINITY}; /* a singular kernel, touched */
  for (int i = 0; done < m->total; i++, T *= growth) {
    double next = i < 200 ? sqrt(base + T * T) : m->far, upto = next >= m->far ? m->total : within(m, next);
    skf_envelope e = skf_kernel_envelope(k, r - radius);
    if (upto > done) {
      double mu = upto - done;
      sum.value += mu * e.value, sum.slope += mu * e.slope, sum.bend += mu * e.bend, sum.fourth += mu * e.fourth;
      done = upto;
    }
    if (!(e.value > 0)) break; /* beyond a finite support */
    r = next;
  }
  return sum;
}

/* Upper bound of the Hessian at distances >= d of compact kernels. Along a line it is at most the integral of h'' where
   that is positive, and at least that of h' / r. Neither depends on how a triangle lies: no shell holds more of it than
   its plane's, 2 pi r dr; nor a segment's more than at its middle. With y = r^2 / R^2 the quartic's h'' is (12 y - 4) /
   R^2, the soft object's (-44 + 204 y - 120 y^2) / (9 R^2), the metaball's 3 / R^2 from R / 3 on. Beside a quartic
   segment the integral is largest at y = 2 / 3. */
double skf_compact_bend(skf_shape shape, skf_kernel k, double d) {
  double u = fmax(d, 0) / k.param, y = u * u, loose = 1 + 1e-12, rise = INFINITY, fall = 0;
  if (k.type == SKF_USER_KERNEL || !skf_kernel_get(k.type)->compact) return INFINITY;
  if (u >= 1) return 0;
  if (shape == SKF_SEGMENT && k.type == SKF_QUARTIC) {
    y = fmax(y, 2.0 / 3);
    return loose * 16 * y * sqrt(1 - y + 1e-15) / k.param;
  }
  if (shape != SKF_TRIANGLE) return INFINITY;
  if (k.type == SKF_QUARTIC) {
    double z = fmax(y, 1.0 / 3);
    rise = (1 - z) * (2 + 6 * z), fall = 2 * (1 - y) * (1 - y);
  } else if (k.type == SKF_SOFT_OBJECT) { /* (z - 1)(...): both integrals are 0 at 1 */
    double z = fmax(y, 0.2535);
    rise = (1 - z) * (18 + 62 * z - 40 * z * z) / 9 + 1e-6, fall = (1 - y) * (18 - 26 * y + 8 * y * y) / 9;
  } else if (k.type == SKF_METABALL) {
    double z = fmax(u, 1.0 / 3);
    rise = 3 * (1 - z * z), fall = 6 * fmax(1.0 / 9 - y, 0) + 3 * (1 - z) * (1 - z);
  }
  return loose * SKF_PI * (fmax(rise, fall) + 1e-15);
}

static skf_bound plane_bound(const skf_element *e, double near, double far) {
  skf_envelope v = skf_plane_envelope(e->kernel, near);
  if (near <= 0 && e->kernel.type == SKF_INVERSE_SQUARED) v.value = INFINITY;
  if (skf_kernel_kinked(e->kernel, near, far)) v.fourth = INFINITY;
  return (skf_bound){skf_plane_envelope(e->kernel, far).value, v.value, v.slope, v.bend, v.fourth};
}

skf_bound skf_element_bound(const skf_element *e, skf_vec3 center, double radius) {
  skf_bound b;
  double tight = 1 - 1e-12, loose = 1 + 1e-12; /* rounding of the sums */
  if (!skf_kernel_has_bound(e->kernel, e->primitive.shape)) {
    b = (skf_bound){-INFINITY, INFINITY, INFINITY, INFINITY, INFINITY};
  } else if (e->primitive.shape == SKF_PLANE) {
    double z = skf_primitive_distance(&e->primitive, center);
    b = plane_bound(e, fmax(z - radius, 0), z + radius);
    double slack = 1e-12 * (z + radius) * b.gradient;
    if (isfinite(slack)) b.lo -= slack, b.hi += slack;
  } else if (e->primitive.shape == SKF_SOLID) {
    const skf_solid *s = e->primitive.solid;
    skf_envelope v = skf_solid_around(s, center, radius);
    double farthest = skf_solid_get(s)->volume / (skf_solid_distance_max(s, center) + radius);
    b = (skf_bound){tight * farthest, loose * v.value, v.slope, v.bend, v.fourth};
  } else {
    reach m = reach_from(&e->primitive, center);
    if (m.near - radius > skf_kernel_end(e->kernel) * (1 + 1e-9)) return (skf_bound){0, 0, 0, 0, 0};
    skf_envelope v = shells(e->kernel, &m, radius, COARSE);
    v.bend = fmin(v.bend, skf_compact_bend(m.shape, e->kernel, m.near - radius));
    double farthest = m.total * skf_kernel_envelope(e->kernel, m.far + radius).value;
    if (skf_kernel_kinked(e->kernel, fmax(m.near - radius, 0), m.far + radius)) v.fourth = INFINITY;
    b = (skf_bound){tight * farthest, loose * v.value, v.slope, v.bend, v.fourth};
  }
  skf_weight_range w = skf_element_weights(e);
  double a = loose * fmax(fabs(w.lo), fabs(w.hi));
  if (a == 0) return (skf_bound){0, 0, 0, 0, 0};
  skf_bound out = {.gradient = a * b.gradient, .hessian = a * b.hessian, .fourth = a * b.fourth};
  out.lo = skf_weight_times(
      w.lo, w.lo > 0 ? b.lo : b.hi); /* planes, whose field has any sign, have no profile: lo = hi there */
  out.hi = skf_weight_times(w.hi, w.hi > 0 ? b.hi : b.lo);
  return out;
}

skf_envelope skf_element_reach(const skf_element *e, double d) {
  const skf_primitive *p = &e->primitive;
  if (p->shape == SKF_PLANE) return skf_plane_envelope(e->kernel, d);
  if (p->shape == SKF_SOLID) return skf_solid_envelope((1 + 1e-12) * skf_primitive_measure(p), d, d);
  /* worst at a distance d: beside a segment's middle, above a triangle, for arcs see arc_within */
  reach m = {.shape = p->shape, .total = skf_primitive_measure(p), .near = d, .far = d, .h2 = d * d};
  if (p->shape == SKF_SEGMENT) {
    m.t1 = 0.5 * m.total, m.t0 = -m.t1;
    m.far = hypot(d, m.t1);
  } else if (p->shape == SKF_ARC) {
    m.rho = p->arc.radius, m.k = -1;
    m.far = fmax(d, m.rho);
  } else if (p->shape == SKF_TRIANGLE) {
    m.far = hypot(d, sqrt(m.total / SKF_PI));
  }
  skf_envelope v = shells(e->kernel, &m, 0, MEDIUM);
  v.bend = fmin(v.bend, skf_compact_bend(m.shape, e->kernel, d));
  double loose = 1 + 1e-12;
  return (skf_envelope){loose * v.value, loose * v.slope, loose * v.bend, loose * v.fourth};
}

double skf_element_beyond(const skf_element *e, skf_vec3 up, double height) {
  const skf_primitive *p = &e->primitive;
  skf_box b = skf_primitive_bounds(p);
  double top = 0, plain;
  for (int i = 0; i < 3; i++) top += fmax(v3_get(up, i) * v3_get(b.lo, i), v3_get(up, i) * v3_get(b.hi, i));
  if (height - top >= skf_kernel_end(e->kernel)) return 0;
  plain = skf_element_reach(e, fmax(height - top, 0)).value;
  if ((p->shape != SKF_SEGMENT && p->shape != SKF_ARC) || !(height > top)) return plain;
  reach m = {.shape = p->shape, .total = skf_primitive_measure(p), .beyond = true, .near = height - top};
  if (p->shape == SKF_SEGMENT) {
    m.lean = fmin(fabs(v3_dot(v3_sub(p->segment.to, p->segment.from), up)) / m.total, 1);
    m.far = m.near + m.total;
  } else {
    double cosine = fmin(fabs(v3_dot(v3_unit(p->arc.normal), up)), 1);
    m.lean = cosine, m.rho = p->arc.radius;
    m.near = height - (v3_dot(p->arc.center, up) + m.rho * sqrt(1 - cosine * cosine)); /* above the whole circle */
    m.far = m.near + 2 * m.rho;
    if (!(m.near > 0)) return plain;
  }
  m.h2 = m.near * m.near;
  return fmin(plain, shells(e->kernel, &m, 0, FINE).value * (1 + 1e-12));
}

bool skf_field_has_bound(const skf_field *field, size_t *element) {
  for (size_t i = 0, n = skf_field_size(field); i < n; i++) {
    const skf_element *e = skf_field_element(field, i);
    if (skf_kernel_has_bound(e->kernel, e->primitive.shape)) continue;
    if (element) *element = i;
    return false;
  }
  return true;
}

skf_bound skf_field_bound(const skf_field *field, skf_vec3 center, double radius) {
  skf_bound b = {0, 0, 0, 0, 0};
  for (size_t i = 0, n = skf_field_size(field); i < n; i++) {
    skf_bound e = skf_element_bound(skf_field_element(field, i), center, radius);
    b.lo += e.lo, b.hi += e.hi;
    b.gradient += e.gradient, b.hessian += e.hessian, b.fourth += e.fourth;
  }
  if (isnan(b.lo)) b.lo = -INFINITY;
  if (isnan(b.hi)) b.hi = INFINITY;
  if (!isfinite(b.gradient)) return b;
  /* the value at the center and what the derivatives allow around it */
  skf_vec3 g;
  double F = skf_field_at(field, center, &g), by1 = b.gradient * radius;
  double by2 = (v3_norm(g) + 0.5 * b.hessian * radius) * radius, step = by2 < by1 ? by2 : by1;
  double slack = 1e-9 * fmax(fabs(F), 1e-3 * fmax(fabs(b.lo), fabs(b.hi))); /* quadrature's own error */
  if (!isfinite(F)) return b;
  b.lo = fmax(b.lo, F - step - slack);
  b.hi = fmin(b.hi, F + step + slack);
  b.gradient = fmin(b.gradient, v3_norm(g) * (1 + 1e-9) + b.hessian * radius);
  return b;
}
