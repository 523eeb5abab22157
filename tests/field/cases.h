/* SPDX-License-Identifier: MIT */
/* Random primitives, kernels and places, by region, and how far a result is from the oracle: a point by itself and in a
   batch. */
#ifndef SKF_TESTS_FIELD_CASES_H
#define SKF_TESTS_FIELD_CASES_H

#include "field/oracle.h"
#include "random.h"

typedef enum case_region { CASE_NEAR, CASE_EDGE, CASE_LINE, CASE_MIDDLE, CASE_FAR, CASE_RIM, CASE_REGIONS } case_region;

static const char *const case_region_name[CASE_REGIONS] = {"near the body", "near its ends", "on its lines",
                                                           "around it",     "far away",      "at the rim"};

typedef struct field_case {
  skf_element element;
  skf_vec3 x;
  double size, distance; /* length, radius, longest side; to the body */
} field_case;

static inline double rnd_power(uint64_t *seed, double lo, double hi) { return pow(10, rnd(seed, lo, hi)); }
static inline bool rnd_one_in(uint64_t *seed, int n) { return rnd(seed, 0, n) < 1; }
static inline double rnd_sign(uint64_t *seed) { return rnd_one_in(seed, 2) ? 1 : -1; }

static inline skf_vec3 rnd_across(uint64_t *seed, skf_vec3 a) {
  skf_vec3 b = rnd_unit(seed);
  return v3_unit(v3_mad(b, -v3_dot(a, b) / v3_norm2(a), a));
}

static inline skf_vec3 rnd_axis(uint64_t *seed) {
  static const skf_vec3 axis[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  return rnd_one_in(seed, 3) ? axis[(int)rnd(seed, 0, 3)] : rnd_unit(seed);
}

/* From 1e-6 through most of a turn to the last 1e-9 of it, and full circles. */
static inline double rnd_sweep(uint64_t *seed) {
  switch ((int)rnd(seed, 0, 6)) {
  case 0: return 2 * SKF_PI;
  case 1: return rnd_power(seed, -6, -1);
  case 2: return 2 * SKF_PI - rnd_power(seed, -9, -1);
  case 3: return SKF_PI;
  default: return rnd(seed, 0.1, 2 * SKF_PI);
  }
}

/* Where the place is measured from, and in which direction it lies. */
typedef struct case_anchor {
  skf_vec3 at, to;
} case_anchor;

static inline case_anchor case_segment(uint64_t *s, case_region r, double size, skf_vec3 off, skf_primitive *p) {
  skf_vec3 a = rnd_axis(s), end = v3_mad(off, size, a);
  p->segment = (skf_segment){off, end};
  double share = r == CASE_EDGE ? rnd_one_in(s, 2) : rnd(s, 0, 1);
  if (r == CASE_LINE && rnd_one_in(s, 2)) return (case_anchor){end, a};
  if (r == CASE_LINE) share = rnd_power(s, 0, 6);
  return (case_anchor){v3_mad(off, share * size, a), r == CASE_LINE ? rnd_across(s, a) : rnd_unit(s)};
}

static inline case_anchor case_arc(uint64_t *s, case_region r, double size, skf_vec3 off, skf_primitive *p) {
  skf_vec3 n = rnd_axis(s), e = rnd_across(s, n);
  double sweep = rnd_sweep(s), at = r == CASE_EDGE ? (rnd_one_in(s, 2) ? 0 : sweep) : rnd(s, 0, sweep);
  p->arc = (skf_arc){off, n, e, size, sweep};
  if (r == CASE_NEAR && rnd_one_in(s, 4)) at = rnd(s, 0, 2 * SKF_PI); /* at the circle, not at the arc */
  skf_vec3 f = v3_cross(n, e), out = v3_mad(v3_scale(cos(at), e), sin(at), f), on = v3_mad(off, size, out);
  if (r == CASE_EDGE && rnd_one_in(s, 3)) return (case_anchor){on, v3_scale(rnd_sign(s), v3_cross(n, out))};
  if (r != CASE_LINE) return (case_anchor){on, rnd_unit(s)};
  if (rnd_one_in(s, 3)) return (case_anchor){off, v3_scale(rnd_sign(s), n)};             /* the axis */
  if (rnd_one_in(s, 2)) return (case_anchor){v3_mad(off, size * rnd(s, -2, 2), n), out}; /* beside it */
  return (case_anchor){on, v3_scale(rnd_sign(s), out)};                                  /* its plane */
}

/* One in three is a sliver, down to 1e-9. */
static inline case_anchor case_triangle(uint64_t *s, case_region r, double size, skf_vec3 off, skf_primitive *p) {
  skf_vec3 n = rnd_axis(s), t = rnd_across(s, n), m = v3_cross(n, t), *v = p->triangle.vertices;
  double thin = rnd_one_in(s, 3) ? rnd_power(s, -9, -1) : rnd(s, 0.03, 1.2);
  int first = (int)rnd(s, 0, 3);
  v[first] = off;
  v[(first + 1) % 3] = v3_mad(off, size, t);
  v[(first + 2) % 3] = v3_mad(v3_mad(off, size * rnd(s, -1, 2), t), size * thin, m);
  double share = r == CASE_LINE ? rnd(s, -3, 4) : rnd_one_in(s, 3) ? 0 : rnd(s, 0, 1);
  if (r == CASE_EDGE || (r == CASE_LINE && rnd_one_in(s, 2)))
    return (case_anchor){v3_mad(v[0], share, v3_sub(v[1], v[0])), r == CASE_LINE ? n : rnd_unit(s)};
  skf_vec3 in = skf_primitive_point(p, rnd(s, 0, 1), rnd(s, 0, 1));
  double turn = rnd(s, -SKF_PI, SKF_PI);
  skf_vec3 flat = v3_mad(v3_scale(cos(turn), t), sin(turn), m);
  return (case_anchor){in, r == CASE_LINE ? flat : rnd_one_in(s, 3) ? v3_scale(rnd_sign(s), n) : rnd_unit(s)};
}

static inline case_anchor case_anchor_of(uint64_t *s, case_region r, double size, skf_vec3 off, skf_primitive *p) {
  skf_vec3 n = rnd_axis(s);
  switch (p->shape) {
  case SKF_SEGMENT: return case_segment(s, r, size, off, p);
  case SKF_ARC: return case_arc(s, r, size, off, p);
  case SKF_TRIANGLE: return case_triangle(s, r, size, off, p);
  case SKF_PLANE:
    p->plane = (skf_plane){off, v3_scale(rnd_power(s, -3, 3), n)};
    return (case_anchor){v3_mad(off, size * rnd_power(s, -3, 3), rnd_across(s, n)), v3_scale(rnd_sign(s), n)};
  default: p->point.at = off; return (case_anchor){off, n};
  }
}

/* Widths from 1e-4 of the body to 1e4 of it, about the distance, or wide; supports up to 1e6 of the body, whose rims,
   or the metaball's inner ones, just reach the body, cross it, or just hold it. */
static inline double case_param(uint64_t *s, const skf_kernel_info *k, case_region r, double size, double d,
                                double far) {
  double wide = fmax(d, size);
  if (!k->param) return 0;
  if (!k->compact) {
    int kind = (int)rnd(s, 0, 3);
    return 1 / (kind == 0   ? size * rnd_power(s, -4, 4)
                : kind == 1 ? d * rnd_power(s, -0.7, 1)
                            : wide * rnd_power(s, -1, 2));
  }
  if (r == CASE_RIM) {
    double inner = rnd_one_in(s, 8) ? 3 : 1;
    if (rnd_one_in(s, 4)) return inner * fmin(far, 1e6 * wide) * (1 + rnd_power(s, -9, 1));
    return inner * (rnd_one_in(s, 2) ? d * (1 + rnd_power(s, -10, 0)) : d + rnd(s, 0, 1) * (fmin(far, 1e6 * wide) - d));
  }
  return fmax(d * rnd_power(s, 0.05, 3), rnd_one_in(s, 2) ? size * rnd_power(s, -4, 6) : 0);
}

/* False when this draw is no case: on a singular set, F = 0 or about to underflow, at the metaball's inner rim, where
   the Hessian jumps. */
static inline bool case_draw(uint64_t *s, skf_kernel_type kernel, skf_shape shape, case_region r, field_case *c) {
  const skf_kernel_info *k = skf_kernel_get(kernel);
  double size = rnd_one_in(s, 4) ? rnd_power(s, -7, 7) : 1;
  skf_vec3 off = v3_scale(size * (rnd_one_in(s, 8) ? 1e6 : rnd_one_in(s, 8) ? 1e3 : 1), rnd_vec(s, 1));
  memset(c, 0, sizeof *c);
  c->element.kernel.type = kernel, c->element.strength = 1;
  skf_primitive *p = &c->element.primitive;
  p->shape = shape;
  case_anchor a = case_anchor_of(s, r, size, off, p);
  double d = r == CASE_MIDDLE ? rnd_power(s, -1, 1) : r == CASE_FAR ? rnd_power(s, 1, 6) : rnd_power(s, -9, -1);
  if (r == CASE_LINE || r == CASE_RIM) d = rnd_power(s, -9, 6);
  c->x = v3_mad(a.at, d * size, a.to);
  c->size = shape == SKF_SEGMENT || shape == SKF_ARC || shape == SKF_TRIANGLE ? size : 0;
  c->distance = skf_primitive_distance(p, c->x);
  if (!(c->distance > 1e-10 * size) || skf_primitive_check(p, NULL)) return false;
  double R = case_param(s, k, r, size, c->distance, skf_primitive_distance_max(p, c->x));
  c->element.kernel.param = R;
  if (k->param && k->compact && (R < 1e-4 * size || !(R > c->distance) || fabs(R / 3 - c->distance) < 1e-6 * R))
    return false;
  return !(kernel == SKF_GAUSSIAN && R * c->distance > 25);
}

/* Relative to |F|; to the larger of |gradient| and |F| / L; to the larger of |Hessian| and |F| / L^2, with L =
   max(size, distance). Infinite for NaN. */
typedef struct field_error {
  double F, g, h;
} field_error;

typedef struct field_result {
  double F, g[3], h[6];
} field_result;

static inline quad case_norm(const quad *x, int n) {
  quad sum = 0;
  for (int i = 0; i < n; i++) sum += (n == 6 && (i == 1 || i == 2 || i == 4) ? 2 : 1) * x[i] * x[i];
  return sqrtq(sum);
}

static inline double case_ratio(quad off, quad scale) {
  quad ratio = off == 0 ? 0 : off / scale;
  return ratio == ratio ? (double)ratio : INFINITY;
}

static inline field_error case_differ(const field_case *c, const oracle_value *want, const oracle_value *got) {
  quad F = fabsq(want->F), L = fmax(c->size, c->distance), dg[3], dh[6];
  for (int i = 0; i < 3; i++) dg[i] = got->g[i] - want->g[i];
  for (int i = 0; i < 6; i++) dh[i] = got->h[i] - want->h[i];
  quad scale = c->element.primitive.shape == SKF_PLANE && c->element.kernel.type == SKF_INVERSE_SQUARED ? 2 * M_PIq : 0;
  quad g = fmaxq(case_norm(want->g, 3), F / L), h = fmaxq(case_norm(want->h, 6), F / (L * L));
  return (field_error){case_ratio(fabsq(got->F - want->F), fmaxq(F, scale)), case_ratio(case_norm(dg, 3), g),
                       case_ratio(case_norm(dh, 6), h)};
}

static inline field_error case_error(const field_case *c, const oracle_value *want, const field_result *got) {
  oracle_value v = {.F = got->F};
  for (int i = 0; i < 3; i++) v.g[i] = got->g[i];
  for (int i = 0; i < 6; i++) v.h[i] = got->h[i];
  return case_differ(c, want, &v);
}

static inline double case_step(double x, int ulps) { return x + ulps * (nextafter(fabs(x), INFINITY) - fabs(x)); }

/* What a move of a coordinate of x by eight ulps changes (0 <= i < 6), or of an arc's sweep by two ulps of pi (i < 8).
 */
static inline field_error case_moved(const field_case *c, const oracle_value *want,
                                     oracle_value (*truth)(const skf_element *, skf_vec3), int i) {
  field_case moved = *c;
  skf_arc *arc = &moved.element.primitive.arc;
  if (i < 6) {
    double *x = v3_at(&moved.x, i / 2);
    *x = case_step(*x, i & 1 ? 8 : -8);
  } else if (c->element.primitive.shape == SKF_ARC && arc->sweep < 2 * SKF_PI) {
    arc->sweep += i & 1 ? 0x1p-50 : -0x1p-50;
  } else {
    return (field_error){0, 0, 0};
  }
  oracle_value v = truth(&moved.element, moved.x);
  return case_differ(c, want, &v);
}

static inline bool error_within(field_error e, field_error limit) {
  return e.F <= limit.F && e.g <= limit.g && e.h <= limit.h;
}

static inline field_error error_max(field_error a, field_error b) {
  return (field_error){fmax(a.F, b.F), fmax(a.g, b.g), fmax(a.h, b.h)};
}

/* The worst of all of them. */
static inline field_error case_moves(const field_case *c, const oracle_value *want,
                                     oracle_value (*truth)(const skf_element *, skf_vec3)) {
  field_error most = {0, 0, 0};
  for (int i = 0; i < 8; i++) most = error_max(most, case_moved(c, want, truth, i));
  return most;
}

/* What moves of all the body's own numbers by up to eight ulps change. */
static inline field_error case_body_moves(const field_case *c, const oracle_value *want,
                                          oracle_value (*truth)(const skf_element *, skf_vec3)) {
  const skf_shape_info *shape = skf_shape_get(c->element.primitive.shape);
  field_error most = {0, 0, 0};
  uint64_t seed = 1;
  for (int round = 0; round < 16 && c->element.primitive.shape != SKF_SOLID; round++) {
    field_case moved = *c;
    for (int i = 0; i < shape->param_count; i++) {
      const skf_param *p = shape->params + i;
      double *x = (double *)(void *)((char *)&moved.element.primitive + p->offset);
      int n = p->type == SKF_PARAM_VECTOR ? 3 : p->type == SKF_PARAM_VECTORS ? 3 * p->count : 1;
      if (p->type == SKF_PARAM_ANGLE && *x >= 2 * SKF_PI) n = 0;
      for (int k = 0; k < n; k++) x[k] = case_step(x[k], (int)lround(rnd(&seed, -8, 8)));
    }
    oracle_value v = truth(&moved.element, c->x);
    most = error_max(most, case_differ(c, want, &v));
  }
  return most;
}

/* The place among others close to it. */
enum { CASE_BATCH = 5, CASE_PLACE = 2 };

static inline field_result case_in_batch(const skf_field *f, skf_vec3 x) {
  double p[3][CASE_BATCH], F[CASE_BATCH], g[3][CASE_BATCH], h[6][CASE_BATCH];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < CASE_BATCH; j++) p[i][j] = v3_get(x, i) * (j == CASE_PLACE ? 1 : 1 + 1e-3 * j);
  const double *const in[3] = {p[0], p[1], p[2]};
  double *const out[3] = {g[0], g[1], g[2]}, *const out6[6] = {h[0], h[1], h[2], h[3], h[4], h[5]};
  field_result r = {.F = NAN};
  if (skf_field_eval(f, CASE_BATCH, in, F, out, out6)) return r;
  r.F = F[CASE_PLACE];
  for (int i = 0; i < 3; i++) r.g[i] = g[i][CASE_PLACE];
  for (int i = 0; i < 6; i++) r.h[i] = h[i][CASE_PLACE];
  return r;
}

static inline field_result case_alone(const skf_field *f, skf_vec3 x) {
  skf_vec3 g;
  field_result r;
  r.F = skf_field_tensor_at(f, x, &g, r.h);
  for (int i = 0; i < 3; i++) r.g[i] = v3_get(g, i);
  return r;
}

#endif
