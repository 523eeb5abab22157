/* SPDX-License-Identifier: MIT */
/* Triangles as a stack of segments, planes in polar coordinates. */
#include "field/quadrature.h"
#include "field/envelope.h"
#include "field/simple.h"

enum { SIZE = SKF_QUADRATURE_SIZE };

/* Axes u along the longest side, m to the opposite corner; everything relative to the foot of x: the longest side lies
   at y = y0 from u0 to u0 + length, the corner at (uc, yc). */
typedef struct stack {
  const skf_prepared *e;
  skf_vec3 u, m, up; /* up: x minus its foot */
  double u0, y0, length, uc, yc;
  double z2, near, delta; /* y = near + delta sinh v */
} stack;

static void slice_at(const void *context, double v, double out[SIZE]) {
  const stack *c = context;
  double y = c->near + c->delta * sinh(v), s = (y - c->y0) / (c->yc - c->y0);
  s = fmin(1, fmax(0, s));
  for (int k = 0; k < SIZE; k++) out[k] = 0;
  skf_quadrature_line(c->e, v3_mad(c->up, -y, c->m), c->u, c->z2 + y * y, c->u0 + s * (c->uc - c->u0),
                      c->u0 + c->length + s * (c->uc - c->u0 - c->length), out);
  for (int k = 0; k < SIZE; k++) out[k] *= c->delta * cosh(v);
}

/* Where the side from (ua, ya) to (ub, yb) crosses the circle of radius^2 rho2, in y */
static int crossings(double ua, double ya, double ub, double yb, double rho2, double *out) {
  double du = ub - ua, dy = yb - ya, a = du * du + dy * dy, b = ua * du + ya * dy, c = ua * ua + ya * ya - rho2;
  double q = b * b - a * c;
  if (q < 0) return 0;
  out[0] = ya + dy * (-b - sqrt(q)) / a;
  out[1] = ya + dy * (-b + sqrt(q)) / a;
  return 2;
}

static int stack_breaks(const stack *c, double *y) {
  int n = 0;
  y[n++] = 0;
  double end = c->u0 + c->length, radii[SKF_KERNEL_BREAKS];
  for (int i = skf_kernel_breaks(c->e->kernel, radii) - 1; i >= 0; i--) {
    double s = radii[i], rho2 = s * s - c->z2;
    if (rho2 <= 0) continue;
    y[n++] = sqrt(rho2), y[n++] = -sqrt(rho2);
    n += crossings(c->u0, c->y0, c->uc, c->yc, rho2, y + n);
    n += crossings(end, c->y0, c->uc, c->yc, rho2, y + n);
  }
  return n;
}

void skf_quadrature_triangle(const skf_prepared *e, skf_vec3 x, double out[SIZE]) {
  const skf_vec3 *p = e->primitive.triangle.vertices;
  int base = 0;
  for (int i = 1; i < 3; i++)
    if (v3_dist(p[i], p[(i + 1) % 3]) > v3_dist(p[base], p[(base + 1) % 3])) base = i;
  skf_vec3 A = v3_sub(p[base], x), B = v3_sub(p[(base + 1) % 3], x), C = v3_sub(p[(base + 2) % 3], x);
  skf_vec3 side = v3_sub(p[(base + 1) % 3], p[base]), up = v3_sub(p[(base + 2) % 3], p[base]);
  stack c = {.e = e, .u = v3_unit(side), .length = v3_norm(side)};
  skf_vec3 n = v3_unit(v3_cross(side, up));
  c.m = v3_cross(n, c.u);
  double z = -v3_dot(A, n);
  c.up = v3_scale(z, n);
  c.z2 = z * z;
  c.u0 = v3_norm2(A) < v3_norm2(B) ? v3_dot(A, c.u) : v3_dot(B, c.u) - c.length;
  c.y0 = v3_dot(A, c.m);
  c.uc = v3_dot(C, c.u);
  c.yc = v3_dot(C, c.m);
  if (skf_kernel_singular(e->kernel) && skf_primitive_distance(&e->primitive, x) == 0 &&
      e->kernel.type != SKF_INVERSE) {
    out[0] = INFINITY;
    return;
  }
  c.near = fmin(fmax(0, c.y0), c.yc);
  double width = c.yc - c.y0;
  c.delta = fmin(fmax(fmax(fabs(z), 1e-12 * width), skf_kernel_grain(e->kernel)), width);
  double y[6 * SKF_KERNEL_BREAKS + 3];
  int count = stack_breaks(&c, y);
  for (int i = 0; i < count; i++) y[i] = asinh((y[i] - c.near) / c.delta);
  count = skf_breaks(asinh((c.y0 - c.near) / c.delta), asinh((c.yc - c.near) / c.delta), count, y);
  skf_integrate(&(skf_integrand){slice_at, &c}, count, y, out);
}

/* Rings of radius delta sinh u; the mean over the angle is taken exactly. */
typedef struct rings {
  const skf_prepared *e;
  double z, delta;
} rings;

static void ring_at(const void *context, double u, double out[SIZE]) {
  const rings *c = context;
  double rho = c->delta * sinh(u), w = 2 * SKF_PI * rho * c->delta * cosh(u), d[4];
  skf_kernel_eval(c->e->kernel, c->z * c->z + rho * rho, d);
  for (int k = 0; k < SIZE; k++) out[k] = 0;
  out[0] = w * d[0];
  out[1] = w * 2 * d[1] * c->z;
  out[4] = w * (2 * d[1] + 4 * d[2] * c->z * c->z);
}

/* The potentials that diverge are integrated from the reference height instead. */
static double reference(skf_kernel_type type, double a) {
  return type == SKF_INVERSE ? -2 * SKF_PI * a : -2 * SKF_PI * log(a);
}

void skf_quadrature_plane(const skf_prepared *e, skf_vec3 x, double out[SIZE]) {
  double z = skf_plane_height(e, x), R = skf_kernel_end(e->kernel), breaks[SKF_KERNEL_BREAKS + 2];
  double end = 45, radii[SKF_KERNEL_BREAKS]; /* sinh 45 is 1e19 */
  bool compact = R < INFINITY, singular = skf_kernel_singular(e->kernel), user = e->kernel.type == SKF_USER_KERNEL;
  rings c = {e, z, compact ? R : singular ? fabs(z) : fmax(fabs(z), skf_kernel_width(e->kernel))};
  int n = 0;
  if (singular && z == 0) {
    out[0] = e->kernel.type == SKF_INVERSE ? 0 : INFINITY;
    return;
  }
  if (compact && fabs(z) >= R) return;
  if (compact)
    end = asinh(sqrt((R - z) * (R + z)) / R);
  else if (user) /* what is beyond falls like exp(-(decay - 2) u) */
    end = 37 / fmin(e->kernel.user->decay - 2, 0.8);
  for (int i = skf_kernel_breaks(e->kernel, radii) - 1; i >= 0; i--)
    if (radii[i] > fabs(z)) breaks[n++] = asinh(sqrt((radii[i] - z) * (radii[i] + z)) / c.delta);
  n = skf_breaks(0, end, n, breaks);
  double y[SIZE] = {0};
  skf_integrate(&(skf_integrand){ring_at, &c}, n, breaks, y);
  skf_value v = {.F = 0};
  skf_plane_result(e, singular && !user ? reference(e->kernel.type, fabs(z)) : y[0], y[1], y[4], 2, &v);
  out[0] = v.F, out[1] = v.g.x, out[2] = v.g.y, out[3] = v.g.z;
  for (int k = 0; k < 6; k++) out[4 + k] = v.h[k];
}
