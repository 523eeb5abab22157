/* SPDX-License-Identifier: MIT */
/* Rays against spheres, cylinders, tori and planes, and against what is left of them in the hull of a primitive: the
   places that are as far from the primitive as the hull is. */
#include "ray/offset.h"
#include <float.h>

/* A ray that looks for the nearest place of one hull. */
typedef struct probe {
  const skf_hull *h;
  skf_vec3 o, d;
  double from, t;
  skf_vec3 normal;
  bool found;
} probe;

static void offer(probe *p, double t, skf_vec3 normal) {
  if (!(t > p->from && t < p->t)) return;
  skf_vec3 at = v3_mad(p->o, t, p->d);
  double off = fabs(skf_primitive_distance(&p->h->primitive, at) - p->h->radius);
  double reach = fmax(fabs(at.x), fmax(fabs(at.y), fabs(at.z)));
  if (!(off <= 1e-9 * (p->h->radius > 0 ? p->h->radius : p->h->size) + 32 * DBL_EPSILON * (reach + t))) return;
  p->t = t, p->normal = normal, p->found = true;
}

/* From a root of |m + s e|^2 = r^2 with m perpendicular to e, |e| <= 1: half the chord, or negative. */
static double half_chord(double m2, double e2, double r) {
  double left = r * r - m2;
  return left >= 0 && e2 > 0 ? sqrt(left / e2) : -1;
}

static void ball(probe *p, skf_vec3 center) {
  skf_vec3 to = v3_sub(p->o, center);
  double middle = -v3_dot(to, p->d), r = p->h->radius;
  double half = half_chord(v3_norm2(v3_mad(to, middle, p->d)), 1, r);
  for (int side = -1; side <= 1 && half >= 0; side += 2) {
    double t = middle + side * half;
    offer(p, t, v3_unit(v3_mad(to, t, p->d)));
  }
}

static void tube(probe *p, skf_vec3 a, skf_vec3 b) {
  skf_vec3 axis = v3_unit(v3_sub(b, a)), to = v3_sub(p->o, a);
  skf_vec3 m = v3_mad(to, -v3_dot(to, axis), axis), e = v3_mad(p->d, -v3_dot(p->d, axis), axis);
  double e2 = v3_norm2(e), middle = -v3_dot(m, e) / e2;
  if (!(e2 > 1e-30)) return; /* along it: only the ends are met */
  double half = half_chord(v3_norm2(v3_mad(m, middle, e)), e2, p->h->radius);
  for (int side = -1; side <= 1 && half >= 0; side += 2) {
    double t = middle + side * half;
    offer(p, t, v3_unit(v3_mad(m, t, e)));
  }
}

static void sheet(probe *p, skf_vec3 at, skf_vec3 n) {
  double down = v3_dot(p->d, n), r = p->h->radius;
  if (down == 0) return;
  for (int side = -1; side <= 1; side += 2) {
    skf_vec3 out = r > 0 ? v3_scale(side, n) : v3_scale(down > 0 ? -1 : 1, n);
    offer(p, v3_dot(v3_sub(v3_mad(at, side * r, n), p->o), n) / down, out);
  }
}

static double quartic_at(double p, double q, double r, double t) { return ((t * t + p) * t + q) * t + r; }
static double cubic_at(double p, double q, double t) { return (4 * t * t + 2 * p) * t + q; }

/* The root between a and b, where the polynomial has different signs. */
static double root_between(double p, double q, double r, bool slope, double a, double b) {
  double fa = slope ? cubic_at(p, q, a) : quartic_at(p, q, r, a);
  double x = (a + b) / 2;
  for (int k = 0; k < 200; k++) {
    double f = slope ? cubic_at(p, q, x) : quartic_at(p, q, r, x), df = slope ? 12 * x * x + 2 * p : cubic_at(p, q, x);
    if (f == 0) return x;
    if ((f > 0) == (fa > 0))
      a = x;
    else
      b = x;
    double next = x - f / df, before = x; /* Newton, where it stays inside; else halves */
    x = next > fmin(a, b) && next < fmax(a, b) ? next : (a + b) / 2;
    if (fabs(x - before) <= 4 * DBL_EPSILON * fabs(x) || x == a || x == b) return x;
  }
  return x;
}

int skf_quartic(double p, double q, double r, double reach, double roots[4]) {
  double knots[6], bend = p < 0 ? sqrt(-p / 6) : 0, ends[4] = {-reach, -bend, bend, reach};
  int n = 0, count = 0;
  knots[n++] = -reach;
  for (int i = 0; i < 3; i++) { /* the slope is monotonic between its extrema */
    double a = fmax(ends[i], -reach), b = fmin(ends[i + 1], reach);
    if (a < b && (cubic_at(p, q, a) > 0) != (cubic_at(p, q, b) > 0)) knots[n++] = root_between(p, q, 0, true, a, b);
  }
  knots[n++] = reach;
  for (int i = 0; i + 1 < n; i++)
    if (count < 4 && (quartic_at(p, q, r, knots[i]) > 0) != (quartic_at(p, q, r, knots[i + 1]) > 0))
      roots[count++] = root_between(p, q, r, false, knots[i], knots[i + 1]);
  return count;
}

/* |p|^2 = t^2 + m^2 from the middle of the ray on: (|p|^2 + R^2 - r^2)^2 = 4 R^2 (x^2 + y^2), in units of R. */
static void ring(probe *p, const skf_arc *a) {
  skf_vec3 n = v3_unit(a->normal), to = v3_scale(1 / a->radius, v3_sub(p->o, a->center));
  double middle = -v3_dot(to, p->d), r = p->h->radius / a->radius;
  skf_vec3 m = v3_mad(to, middle, p->d);
  double mz = v3_dot(m, n), dz = v3_dot(p->d, n), m2 = v3_norm2(m);
  double k = m2 + 1 - r * r, across = 1 - dz * dz, mixed = -mz * dz, out = m2 - mz * mz, roots[4];
  if (m2 > (1 + r) * (1 + r)) return;
  int count = skf_quartic(2 * k - 4 * across, -8 * mixed, k * k - 4 * out, 1 + r + 1e-9, roots);
  for (int i = 0; i < count; i++) {
    double t = roots[i];
    for (int step = 0; step < 3; step++) { /* on (rho - 1)^2 + z^2 = r^2, which cancels less */
      double z = mz + t * dz, rho = sqrt(fmax(out + t * (2 * mixed + t * across), 1e-300));
      double f = (rho - 1) * (rho - 1) + z * z - r * r, df = 2 * ((rho - 1) * (mixed + t * across) / rho + z * dz);
      if (fabs(f) < 0.1 * r * fabs(df)) t -= f / df;
    }
    skf_vec3 at = v3_mad(m, t, p->d);
    double z = v3_dot(at, n);
    skf_vec3 flat = v3_mad(at, -z, n), foot = v3_unit(flat);
    offer(p, a->radius * (middle + t), v3_unit(v3_sub(at, foot)));
  }
}

static void ends_of(probe *p, const skf_arc *a) {
  skf_primitive arc = {.shape = SKF_ARC, .arc = *a};
  if (a->sweep >= 2 * SKF_PI) return;
  ball(p, skf_primitive_point(&arc, 0, 0)), ball(p, skf_primitive_point(&arc, 1, 0));
}

static void flat(probe *p, const skf_vec3 v[3]) {
  sheet(p, v[0], v3_unit(v3_cross(v3_sub(v[1], v[0]), v3_sub(v[2], v[0]))));
  for (int i = 0; i < 3 && p->h->radius > 0; i++) tube(p, v[i], v[(i + 1) % 3]), ball(p, v[i]);
}

bool skf_hull_hit(const skf_hull *h, skf_vec3 o, skf_vec3 d, double from, double *t, skf_vec3 *normal) {
  probe p = {.h = h, .o = o, .d = d, .from = from, .t = *t};
  const skf_primitive *e = &h->primitive;
  switch (e->shape) {
  case SKF_POINT: ball(&p, e->point.at); break;
  case SKF_SEGMENT: tube(&p, e->segment.from, e->segment.to), ball(&p, e->segment.from), ball(&p, e->segment.to); break;
  case SKF_ARC: ring(&p, &e->arc), ends_of(&p, &e->arc); break;
  case SKF_TRIANGLE: flat(&p, e->triangle.vertices); break;
  case SKF_PLANE: sheet(&p, e->plane.through, v3_unit(e->plane.normal)); break;
  default: break;
  }
  if (!p.found) return false;
  *t = p.t, *normal = p.normal;
  return true;
}
