/* SPDX-License-Identifier: MIT */
/* Envelopes of the kernels. With w = r^2, h = phi(w) and t the coordinate along a line, x = t^2 <= w:
   h'''' along the line = 12 phi'' + 48 x phi''' + 16 x^2 phi''''.
   Decimals that stand for an extremum are rounded up. */
#include "field/envelope.h"
#include "field/kernel.h"

static skf_envelope cauchy(double s, double a) {
  double y = s * s * a * a, W = 1 + y, X = y / W, s2 = s * s, V = 1 / W, V2 = V * V;
  double y1 = fmax(y, 0.2), slope = 4 * s * sqrt(y1) / ((1 + y1) * (1 + y1) * (1 + y1));
  /* 4 s^2 max(W^-3, (5y - 1) W^-4); the second peaks at y = 3/5 */
  double bend = y < 0.6 ? fmax(V * V2, 0.30518) : (5 * y - 1) * V2 * V2;
  /* 72 s^4 W^-4 |1 - 16 X + 80/3 X^2|, extreme at X = 0, 0.196, 0.3 (inner zero slope), 0.637 */
  double q;
  if (X < 0.196)
    q = fmax(V2 * V2, 0.4645);
  else if (X < 0.3)
    q = fmax(V2 * V2 * (16 * X - 80.0 / 3 * X * X - 1), 0.3362);
  else if (X < 0.638)
    q = fmax(1.4 * V2 * V2, 0.0284);
  else
    q = V2 * V2 * (80.0 / 3 * X * X - 16 * X + 1);
  return (skf_envelope){V2, slope, 4 * s2 * bend, 72 * s2 * s2 * q};
}

static skf_envelope gaussian(double s, double a) {
  double y = s * s * a * a, e = exp(-y), s2 = s * s, y1 = fmax(y, 0.5);
  double bend = y < 1.5 ? fmax(2 * e, 0.89253) : (4 * y - 2) * e;
  /* (12 - 48 x + 16 x^2) exp(-y), x <= y: extreme at y = 0, 0.919, 1.5 (inner zero slope), 4.081 */
  double q;
  if (y < 0.919)
    q = fmax(12 * e, 7.4197);
  else if (y < 1.5)
    q = fmax((48 * y - 16 * y * y - 12) * e, 5.3552);
  else if (y < 4.082)
    q = fmax(24 * e, 1.3957);
  else
    q = (12 - 48 * y + 16 * y * y) * e;
  return (skf_envelope){e, 2 * s * sqrt(y1) * exp(-y1), s2 * bend, s2 * s2 * q};
}

static skf_envelope inverse(double s, double a) {
  (void)s;
  double v = 1 / a, v2 = v * v; /* r^-1, and n! P_n(cos) r^-(n+1) */
  return (skf_envelope){v, v2, 2 * v * v2, 24 * v * v2 * v2};
}

static skf_envelope inverse_squared(double s, double a) {
  (void)s;
  double v = 1 / a, v2 = v * v; /* fourth: (24 - 288 x + 384 x^2) r^-6 with x <= 1 */
  return (skf_envelope){v2, 2 * v * v2, 6 * v2 * v2, 120 * v2 * v2 * v2};
}

static skf_envelope metaball(double R, double a) {
  double u = a / R, m = (R - a) / R, R2 = R * R;
  if (m <= 0) return (skf_envelope){0, 0, 0, 0};
  if (3 * u <= 1) return (skf_envelope){1 - 3 * u * u, 2 / R, 6 / R2, 243 / (R2 * R2)};
  /* the outer branch's fourth derivative is that of -3 r / R: at most 9 / (R r^3) */
  return (skf_envelope){1.5 * m * m, 3 * m / R, fmax(3, 3 * m / u) / R2, 9 / (R * a * a * a)};
}

static skf_envelope soft_object(double R, double a) {
  double y = a / R * (a / R), m = (R - a) * (R + a) / (R * R), R2 = R * R;
  if (m <= 0) return (skf_envelope){0, 0, 0, 0};
  double y1 = fmax(y, 0.2535), slope = 2 * sqrt(y1) * (1 - y1) * (22 - 12 * y1) / 9;
  double rise = y < 0.85 ? 42.7 : -44 + 204 * y - 120 * y * y; /* 9 R^2 h'' peaks at y = 0.85 */
  return (skf_envelope){m * m * (5 + 4 * m) / 9, slope / R, fmax(m * (44 - 24 * y), rise) / (9 * R2),
                        1032 / (9 * R2 * R2)};
}

static skf_envelope quartic(double R, double a) {
  double y = a / R * (a / R), m = (R - a) * (R + a) / (R * R), R2 = R * R;
  if (m <= 0) return (skf_envelope){0, 0, 0, 0};
  double y1 = fmax(y, 1.0 / 3);
  return (skf_envelope){m * m, 4 * sqrt(y1) * (1 - y1) / R, 8 / R2, 24 / (R2 * R2)};
}

typedef skf_envelope envelope_fn(double param, double a);

/* `peak` is where z h(z) is largest, in units of the width. */
static const struct row {
  envelope_fn *of;
  double peak;
} rows[SKF_KERNEL_COUNT] = {
    [SKF_CAUCHY] = {cauchy, 0.5773502691896258},
    [SKF_GAUSSIAN] = {gaussian, 0.7071067811865476},
    [SKF_INVERSE] = {inverse, 0},
    [SKF_INVERSE_SQUARED] = {inverse_squared, 0},
    [SKF_METABALL] = {metaball, 1.0 / 3},
    [SKF_SOFT_OBJECT] = {soft_object, 0.41546},
    [SKF_QUARTIC] = {quartic, 0.4472135954999579},
};

static skf_envelope of_user(skf_kernel k, double a) {
  double d[4];
  if (a >= skf_kernel_end(k)) return (skf_envelope){0, 0, 0, 0};
  skf_envelope e = k.user->bound(k.user->user, a);
  skf_kernel_eval(k, a * a, d);
  e.value = a == 0 && k.user->singular ? INFINITY : d[0];
  return e;
}

skf_envelope skf_kernel_envelope(skf_kernel k, double a) {
  return k.type == SKF_USER_KERNEL ? of_user(k, fmax(a, 0)) : rows[k.type].of(k.param, fmax(a, 0));
}

skf_envelope skf_plane_envelope(skf_kernel k, double a) {
  a = fmax(a, 0);
  double s2 = k.param * k.param, z = fmax(a, rows[k.type].peak * skf_kernel_width(k));
  skf_envelope e = rows[k.type].of(k.param, a);
  double slope = 2 * SKF_PI * z * rows[k.type].of(k.param, z).value, m = 1 - a * a / s2;
  switch (k.type) {
  case SKF_INVERSE: /* -2 pi |z| */
    return (skf_envelope){-2 * SKF_PI * a, 2 * SKF_PI, a > 0 ? 0 : INFINITY, a > 0 ? 0 : INFINITY};
  case SKF_INVERSE_SQUARED: /* -2 pi ln |z| */
    return (skf_envelope){-2 * SKF_PI * log(a), 2 * SKF_PI / a, 2 * SKF_PI / (a * a), 12 * SKF_PI / (a * a * a * a)};
  case SKF_CAUCHY: { /* |d^n (1 + x^2)^-1| <= n! (1 + x^2)^(-(n + 1) / 2) */
    double W = 1 + s2 * a * a;
    return (skf_envelope){SKF_PI / (s2 * W), slope, 2 * SKF_PI / (W * sqrt(W)), 24 * SKF_PI * s2 / (W * W * sqrt(W))};
  }
  case SKF_GAUSSIAN: /* (pi / a^2) h */
    return (skf_envelope){SKF_PI / s2 * e.value, slope, SKF_PI / s2 * e.bend, SKF_PI / s2 * e.fourth};
  case SKF_METABALL: {
    double v = 1 - m, n = 1 - a / k.param;
    if (n <= 0) break;
    double F = 9 * v <= 1 ? 13.0 / 54 - v + 1.5 * v * v : n * n * n * (1 - 0.75 * n);
    return (skf_envelope){SKF_PI * s2 * F, slope, 2 * SKF_PI, 36 * SKF_PI / s2};
  }
  case SKF_SOFT_OBJECT: /* F'''' R^2 = -2 pi (-132 + 1020 y - 840 y^2) / 9 */
    if (m <= 0) break;
    return (skf_envelope){SKF_PI * s2 * m * m * m * (5 + 3 * m) / 27, slope, 2 * SKF_PI, 2 * SKF_PI * 177.7 / (9 * s2)};
  case SKF_QUARTIC: /* F'''' R^2 = -2 pi (60 y - 12) */
    if (m <= 0) break;
    return (skf_envelope){SKF_PI * s2 * m * m * m / 3, slope, 2 * SKF_PI, 96 * SKF_PI / s2};
  default: break;
  }
  return (skf_envelope){0, 0, 0, 0};
}

bool skf_kernel_kinked(skf_kernel k, double a, double b) {
  double at[SKF_KERNEL_BREAKS];
  for (int i = skf_kernel_breaks(k, at) - 1; i >= 0; i--)
    if (a <= at[i] * (1 + 1e-12) && b >= at[i] * (1 - 1e-12)) return true; /* distances come with rounding */
  return false;
}

double skf_kernel_width(skf_kernel k) {
  if (k.type == SKF_USER_KERNEL) return k.user->width;
  const skf_kernel_info *info = skf_kernel_get(k.type);
  if (!info->param) return 0;
  return info->compact ? k.param : 1 / k.param;
}
