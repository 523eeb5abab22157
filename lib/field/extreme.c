/* SPDX-License-Identifier: MIT */
#include "field/extreme.h"
#include "field/simple.h"
#include <string.h>

static const double big = 1e50, small = 1e-50;

static double largest(skf_vec3 a) { return fmax(fabs(a.x), fmax(fabs(a.y), fabs(a.z))); }

/* The positions of a primitive, and its radius. */
static int positions(skf_primitive *p, skf_vec3 *at[3], double **radius) {
  *radius = NULL;
  switch (p->shape) {
  case SKF_POINT: return at[0] = &p->point.at, 1;
  case SKF_SEGMENT: return at[0] = &p->segment.from, at[1] = &p->segment.to, 2;
  case SKF_ARC: return at[0] = &p->arc.center, *radius = &p->arc.radius, 1;
  case SKF_TRIANGLE:
    for (int i = 0; i < 3; i++) at[i] = p->triangle.vertices + i;
    return 3;
  case SKF_PLANE: return at[0] = &p->plane.through, 1;
  default: return 0;
  }
}

/* Largest extent in one coordinate; 1 for points and planes. */
static double extent(skf_primitive p) {
  skf_vec3 *at[3];
  double *radius, size = 0;
  int n = positions(&p, at, &radius);
  if (radius) return *radius;
  for (int i = 1; i < n; i++) size = fmax(size, largest(v3_sub(*at[i], *at[i - 1])));
  return n == 1 ? 1 : size;
}

static double reach(skf_primitive p) {
  skf_vec3 *at[3];
  double *radius, size = 0;
  int n = positions(&p, at, &radius);
  for (int i = 0; i < n; i++) size = fmax(size, largest(*at[i]));
  return radius ? fmax(size, *radius) : size;
}

bool skf_moderate(const skf_element *e) {
  double p = e->kernel.type < SKF_KERNEL_COUNT && skf_kernel_get(e->kernel.type)->param ? e->kernel.param : 1;
  return reach(e->primitive) < big && extent(e->primitive) > small && p > small && p < big;
}

static int exponent(double a) {
  int power;
  frexp(a, &power);
  return power;
}

static skf_vec3 times(skf_vec3 a, int power) { return v3(ldexp(a.x, power), ldexp(a.y, power), ldexp(a.z, power)); }

void skf_element_scale(skf_element *e, int power) {
  skf_vec3 *at[3];
  double *radius;
  int n = positions(&e->primitive, at, &radius);
  for (int i = 0; i < n; i++) *at[i] = times(*at[i], power);
  if (radius) *radius = ldexp(*radius, power);
  const skf_kernel_info *info = skf_kernel_get(e->kernel.type);
  if (info->param) e->kernel.param = ldexp(e->kernel.param, info->compact ? power : -power);
}

/* Kernels that are 1e70 times narrower than the lengths are evaluated as if they were `factor` times as wide: beside
   the body Cauchy's has the fourth power of it too much, on it all have one for each dimension of the body. */
static void narrower(const skf_element *e, skf_vec3 x, double factor, skf_value *v) {
  int dimension = e->primitive.shape == SKF_POINT ? 0 : e->primitive.shape < SKF_TRIANGLE ? 1 : 2;
  double by = pow(factor, skf_primitive_distance(&e->primitive, x) < 1e-40 ? -dimension : -4);
  v->F *= by, v->g = v3_scale(by, v->g);
  for (int k = 0; k < 6; k++) v->h[k] *= by;
}

/* What the closed form gives. */
static void closed(skf_element e, skf_vec3 x, int order, skf_value *v) {
  skf_prepared p;
  const skf_kernel_info *info = skf_kernel_get(e.kernel.type);
  double narrow = e.primitive.shape == SKF_PLANE ? 1e150 : 1e70;
  double given = !info->param ? 0 : info->compact ? 1 / e.kernel.param : e.kernel.param;
  if (given > narrow) e.kernel.param = info->compact ? 1 / narrow : narrow;
  skf_prepare(&e, &p);
  memset(v, 0, sizeof *v);
  skf_kernel_row(e.kernel.type)->closed[e.primitive.shape](&p, x, order, v);
  if (given > narrow) narrower(&e, x, given / narrow, v);
}

static skf_vec3 centroid(const skf_primitive *p) {
  skf_vec3 mid = skf_primitive_point(p, 0.5, 0), c = p->arc.center;
  double half = 0.5 * p->arc.sweep;
  if (p->shape == SKF_ARC) return v3_mad(c, sin(half) / half, v3_sub(mid, c));
  if (p->shape != SKF_TRIANGLE) return mid;
  const skf_vec3 *v = p->triangle.vertices;
  return v3_scale(1. / 3, v3_add(v[0], v3_add(v[1], v[2])));
}

/* Makes a body that is tiny beside the other lengths a point with its measure, ldexp(the result, *power). */
static double shrink(skf_element *e, int *power) {
  int own = exponent(extent(e->primitive));
  skf_element unit = *e;
  skf_element_scale(&unit, -own);
  *power = own * (e->primitive.shape == SKF_TRIANGLE ? 2 : 1);
  e->primitive = (skf_primitive){.shape = SKF_POINT, .point.at = times(centroid(&unit.primitive), own)};
  return skf_primitive_measure(&unit.primitive);
}

int skf_element_dimension(const skf_element *e) {
  int kernel = e->kernel.type == SKF_INVERSE ? 1 : e->kernel.type == SKF_INVERSE_SQUARED ? 2 : 0;
  int shape = e->primitive.shape == SKF_POINT ? 0 : e->primitive.shape < SKF_TRIANGLE ? 1 : 2;
  return shape - kernel;
}

/* NaN comes from infinity times 0, next to a singular set or far beyond all lengths. */
static void mend(skf_value *v, bool singular) {
  if (isnan(v->F + 0 * (v->g.x + v->g.y + v->g.z))) {
    bool near = singular && !(fabs(v->F) < 1);
    if (near || isnan(v->F)) v->F = near ? INFINITY : 0;
    v->g = v3(0, 0, 0);
  }
  for (int k = 0; k < 6; k++)
    if (isnan(v->h[k]) || isinf(v->F)) v->h[k] = 0;
  if (isinf(v->F)) v->g = v3(0, 0, 0);
}

void skf_extreme_value(const skf_prepared *prepared, skf_vec3 x, int order, skf_value *v) {
  skf_element e = {prepared->primitive, prepared->kernel, 1};
  if (e.primitive.shape == SKF_POINT) { /* no length but the distance */
    skf_vec3 half = v3_sub(v3_scale(0.5, x), v3_scale(0.5, e.primitive.point.at));
    if (largest(half) < 1e300) x = v3_sub(x, e.primitive.point.at), e.primitive.point.at = v3(0, 0, 0);
  }
  if (e.primitive.shape == SKF_PLANE) {
    const skf_vec3 zero = {0, 0, 0};
    x = skf_plane_seen(prepared, x, zero);
    e.primitive.plane.through = skf_plane_seen(prepared, e.primitive.plane.through, zero);
  }
  const skf_kernel_info *info = skf_kernel_get(e.kernel.type);
  double width = !info->param ? 0 : info->compact ? e.kernel.param : 1 / e.kernel.param;
  double all = fmax(fmax(largest(x), width), reach(e.primitive));
  if (!(all > 0 && all < INFINITY)) return;
  int power = exponent(all), n = skf_element_dimension(&e), own = 0;
  double measure = 1;
  skf_element_scale(&e, -power);
  x = times(x, -power);
  if (extent(e.primitive) < small) measure = shrink(&e, &own);
  closed(e, x, order, v);
  mend(v, info->singular);
  if (isinf(v->F)) return;
  if (e.primitive.shape == SKF_PLANE && e.kernel.type == SKF_INVERSE_SQUARED) v->F -= 2 * SKF_PI * log(2) * power;
  v->F = ldexp(measure * v->F, own + power * n);
  v->g = times(v3_scale(measure, v->g), own + power * (n - 1));
  for (int k = 0; k < 6; k++) v->h[k] = ldexp(measure * v->h[k], own + power * (n - 2));
}
