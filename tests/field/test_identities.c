/* SPDX-License-Identifier: MIT */
/* What must hold for every kernel on every shape, whatever the formulas. */
#include "check.h"
#include "field/kernel.h"
#include "random.h"
#include <string.h>

enum { ROUNDS = 40 };

static skf_value value(const skf_element *e, skf_vec3 x) {
  skf_field *f;
  skf_value v;
  assert_int_equal(skf_field_new(e, 1, &f), SKF_OK);
  v.F = skf_field_tensor_at(f, x, &v.g, v.h);
  skf_field_free(f);
  return v;
}

static double norm6(const double h[6]) {
  return sqrt(h[0] * h[0] + h[3] * h[3] + h[5] * h[5] + 2 * (h[1] * h[1] + h[2] * h[2] + h[4] * h[4]));
}

static skf_element random_element(uint64_t *seed, int kernel, int shape) {
  skf_element e = {.kernel.type = (skf_kernel_type)kernel, .strength = 1};
  const skf_kernel_info *info = skf_kernel_get(e.kernel.type);
  double width = pow(10, rnd(seed, -0.5, 0.7));
  if (info->param) e.kernel.param = info->compact ? 2 * width : 1 / width;
  rnd_primitive(seed, (skf_shape)shape, 1, &e.primitive);
  return e;
}

/* At a distance between 0.02 and 3 from somewhere on it. */
static skf_vec3 random_place(uint64_t *seed, const skf_primitive *p) {
  return v3_mad(skf_primitive_point(p, rnd(seed, 0, 1), rnd(seed, 0, 1)), pow(10, rnd(seed, -1.7, 0.5)),
                rnd_unit(seed));
}

typedef void (*property)(uint64_t *seed, const skf_element *e, skf_vec3 x);

static void for_all(property check) {
  uint64_t seed = 7;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = 0; s < SKF_SOLID; s++)
      for (int i = 0; i < ROUNDS; i++) {
        skf_element e = random_element(&seed, k, s);
        skf_vec3 x = random_place(&seed, &e.primitive);
        if (!skf_primitive_check(&e.primitive, NULL)) check(&seed, &e, x);
      }
}

static double distance(const skf_element *e, skf_vec3 x) { return skf_primitive_distance(&e->primitive, x); }

/* Fourth-order central differences of F against g, and of g against h. */
static void differences(uint64_t *seed, const skf_element *e, skf_vec3 x) {
  (void)seed;
  const skf_kernel_info *info = skf_kernel_get(e->kernel.type);
  double d = distance(e, x), step = 2e-3 * fmin(d, info->param && !info->compact ? 1 / e->kernel.param : d);
  if (d < 0.05) return; /* edges and vertices are nearer than the step then */
  skf_value v = value(e, x), m[4];
  double g = fmax(v3_norm(v.g), fabs(v.F) / fmax(d, 1)), h = fmax(norm6(v.h), g / fmax(d, 1));
  static const double at[4] = {-2, -1, 1, 2}, weight[4] = {1 / 12., -2 / 3., 2 / 3., -1 / 12.};
  static const int index[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  for (int i = 0; i < 3; i++) {
    double slope = 0, bend[3] = {0};
    for (int j = 0; j < 4; j++) {
      skf_vec3 y = x;
      *v3_at(&y, i) += at[j] * step;
      m[j] = value(e, y);
      slope += weight[j] * m[j].F / step;
      for (int k = 0; k < 3; k++) bend[k] += weight[j] * v3_get(m[j].g, k) / step;
    }
    /* compact kernels: a rim between the places costs an order or two */
    check_scaled(slope, v3_get(v.g, i), g, info->compact ? 1e-4 : 1e-7);
    for (int k = 0; k < 3; k++) check_scaled(bend[k], v.h[index[i][k]], h, info->compact ? 0.05 : 1e-6);
  }
}

static void test_differences(void **state) {
  (void)state;
  for_all(differences);
}

/* 1/r is harmonic off the body. */
static void laplace(uint64_t *seed, const skf_element *e, skf_vec3 x) {
  (void)seed;
  if (e->kernel.type != SKF_INVERSE) return;
  skf_value v = value(e, x);
  check_scaled(v.h[0] + v.h[3] + v.h[5], 0, norm6(v.h), 2e-13);
}

static void test_laplace(void **state) {
  (void)state;
  for_all(laplace);
}

/* A primitive is the sum of its parts. */
static int parts(uint64_t *seed, const skf_element *e, skf_element out[3]) {
  double s = rnd(seed, 0.1, 0.9);
  out[0] = out[1] = out[2] = *e;
  if (e->primitive.shape == SKF_SEGMENT) {
    skf_vec3 m = skf_primitive_point(&e->primitive, s, 0);
    out[0].primitive.segment.to = out[1].primitive.segment.from = m;
    return 2;
  }
  if (e->primitive.shape == SKF_ARC) {
    double sweep = e->primitive.arc.sweep;
    out[0].primitive.arc.sweep = s * sweep;
    out[1].primitive.arc.sweep = sweep - s * sweep;
    out[1].primitive.arc.start = v3_sub(skf_primitive_point(&e->primitive, s, 0), e->primitive.arc.center);
    return 2;
  }
  if (e->primitive.shape == SKF_TRIANGLE) {
    skf_vec3 m = skf_primitive_point(&e->primitive, s, rnd(seed, 0.2, 0.8));
    for (int i = 0; i < 3; i++) out[i].primitive.triangle.vertices[i] = m;
    return 3;
  }
  return 0;
}

/* The cut is rounded: what an ulp of it moves is allowed on top, near the cut. */
static void splits(uint64_t *seed, const skf_element *e, skf_vec3 x) {
  skf_element part[3];
  int n = parts(seed, e, part);
  if (n == 0 || distance(e, x) < 0.1) return;
  skf_field *f;
  for (int i = 0; i < n; i++)
    if (skf_primitive_check(&part[i].primitive, NULL)) return;
  assert_int_equal(skf_field_new(part, (size_t)n, &f), SKF_OK);
  skf_value v = value(e, x), w;
  w.F = skf_field_tensor_at(f, x, &w.g, w.h);
  skf_field_free(f);
  double d = distance(e, x), g = fmax(v3_norm(v.g), v.F / d), h = fmax(norm6(v.h), v.F / (d * d)), D[6];
  if (v.F < 1e-20) return; /* in the far tail an ulp of the place counts for many */
  for (int k = 0; k < 6; k++) D[k] = v.h[k] - w.h[k];
  bool rim = skf_kernel_get(e->kernel.type)->compact; /* F falls to 0 there and its conditioning with it */
  check_scaled(w.F, v.F, v.F + (rim ? 1e-3 * skf_primitive_measure(&e->primitive) : 0), 1e-13);
  check_scaled(v3_dist(v.g, w.g), 0, g, 1e-13);
  check_scaled(norm6(D), 0, h, 1e-13);
}

static void test_splits(void **state) {
  (void)state;
  for_all(splits);
}

/* Lengths times 2^power: F changes by the power of it that its dimension says, exactly, and nothing else does. */
static void scaled(const skf_element *e, skf_vec3 x, int power) {
  double c = ldexp(1, power);
  const skf_kernel_info *info = skf_kernel_get(e->kernel.type);
  skf_element s = *e;
  skf_primitive *p = &s.primitive;
  if (info->param) s.kernel.param *= info->compact ? c : 1 / c;
  switch (p->shape) {
  case SKF_POINT: p->point.at = v3_scale(c, p->point.at); break;
  case SKF_SEGMENT: p->segment.from = v3_scale(c, p->segment.from), p->segment.to = v3_scale(c, p->segment.to); break;
  case SKF_ARC: p->arc.center = v3_scale(c, p->arc.center), p->arc.radius *= c; break;
  case SKF_TRIANGLE:
    for (int i = 0; i < 3; i++) p->triangle.vertices[i] = v3_scale(c, p->triangle.vertices[i]);
    break;
  default: p->plane.through = v3_scale(c, p->plane.through);
  }
  int dimension = (p->shape == SKF_POINT                            ? 0
                   : p->shape == SKF_SEGMENT || p->shape == SKF_ARC ? 1
                                                                    : 2) -
                  (e->kernel.type == SKF_INVERSE           ? 1
                   : e->kernel.type == SKF_INVERSE_SQUARED ? 2
                                                           : 0);
  skf_value v = value(e, x), w = value(&s, v3_scale(c, x));
  double F = v.F * pow(c, dimension), offset = 0;
  if (p->shape == SKF_PLANE && e->kernel.type == SKF_INVERSE_SQUARED) offset = 2 * SKF_PI * log(c);
  check_scaled(w.F + offset, F, fabs(F) + fabs(offset), 1e-14);
  for (int k = 0; k < 3; k++) check_close(v3_get(w.g, k), v3_get(v.g, k) * pow(c, dimension - 1), 1e-14);
  for (int k = 0; k < 6; k++) check_close(w.h[k], v.h[k] * pow(c, dimension - 2), 1e-14);
}

static void scaling(uint64_t *seed, const skf_element *e, skf_vec3 x) {
  (void)seed;
  scaled(e, x, 24); /* 1.7e7 */
  scaled(e, x, -24);
  scaled(e, x, 240); /* 1e72: what is out of range only on the way to the result does not count */
  scaled(e, x, -240);
}

/* Bodies and distances of any size, on the body's lines, which pass through the origin: nothing is NaN, alone or in a
   batch, with the Hessian or without; next to a singular set F is infinite and the rest 0. */
static void extreme(const skf_element *e, skf_vec3 x) {
  enum { N = 5 };
  skf_vec3 g;
  double h[6], p[3][N], F[N], out[3][N];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < N; j++) p[i][j] = v3_get(x, i);
  const double *const in[3] = {p[0], p[1], p[2]};
  double *const to[3] = {out[0], out[1], out[2]};
  skf_field *f;
  if (skf_field_new(e, 1, &f)) return; /* too small to be told from nothing */
  double one = skf_field_tensor_at(f, x, &g, h);
  assert_int_equal(skf_field_eval(f, N, in, F, to, NULL), SKF_OK);
  skf_field_free(f);
  assert_false(isnan(one) || isnan(F[1]));
  for (int i = 0; i < 3; i++) assert_false(isnan(v3_get(g, i)) || isnan(out[i][1]));
  for (int i = 0; i < 6; i++) assert_false(isnan(h[i]));
  for (int i = 0; i < 3 && isinf(one); i++) assert_true(v3_get(g, i) == 0);
}

static void test_extremes(void **state) {
  (void)state;
  static const skf_vec3 way[] = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {0.6, 0, 0.8}};
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = 0; s < SKF_SOLID; s++)
      for (int size = -300; size <= 300; size += 20)
        for (int d = -310; d <= 300; d += size ? 50 : 5)
          for (int w = 0; w < 4; w++) {
            double L = pow(10, size);
            const skf_kernel_info *info = skf_kernel_get((skf_kernel_type)k);
            skf_element e = {.kernel = {(skf_kernel_type)k, info->compact ? 2 * L : 1 / L, NULL}, .strength = 1};
            skf_primitive *p = &e.primitive;
            p->shape = (skf_shape)s;
            if (s == SKF_SEGMENT) p->segment = (skf_segment){v3(-L, 0, 0), v3(L, 0, 0)};
            if (s == SKF_ARC) p->arc = (skf_arc){v3(-L, 0, 0), v3(0, 0, 1), v3(1, 0, 0), L, d % 2 ? 1 : 2 * SKF_PI};
            if (s == SKF_TRIANGLE) p->triangle = (skf_triangle){{v3(0, 0, 0), v3(L, 0, 0), v3(0, L, 0)}};
            if (s == SKF_PLANE) p->plane.normal = v3(0, 0, 1);
            extreme(&e, v3_scale(pow(10, d), way[w]));
          }
}

/* Far beyond a narrow kernel's width, and on the body itself */
static void test_narrowest(void **state) {
  (void)state;
  skf_element e = {.kernel = {SKF_CAUCHY, 1e80, NULL}, .strength = 1, .primitive = {.shape = SKF_SEGMENT}};
  e.primitive.segment = (skf_segment){v3(-1, 0, 0), v3(1, 0, 0)};
  check_close(value(&e, v3(0, 0, 0)).F, 0.5 * SKF_PI * 1e-80, 1e-14);
  e.kernel.param = 1e72;
  check_close(value(&e, v3(0, 1, 0)).F, (0.25 * SKF_PI + 0.5) * 1e-288, 1e-12);
  e.primitive = (skf_primitive){.shape = SKF_POINT};
  check_close(value(&e, v3(0, 2, 0)).F, 6.25e-290, 1e-12);
  e.kernel.param = 1;
  assert_true(value(&e, v3(1e300, 0, 0)).F == 0);
}

static void test_scaling(void **state) {
  (void)state;
  for_all(scaling);
}

static skf_vec3 turn(const skf_vec3 m[3], skf_vec3 a) { return v3(v3_dot(m[0], a), v3_dot(m[1], a), v3_dot(m[2], a)); }

/* A rigid motion: coordinates are rounded anew, so places near the body or the rim are left out. */
static void motion(uint64_t *seed, const skf_element *e, skf_vec3 x) {
  skf_vec3 m[3], shift = rnd_vec(seed, 1);
  m[0] = rnd_unit(seed), m[1] = v3_perp(m[0]), m[2] = v3_cross(m[0], m[1]);
  if (distance(e, x) < 0.3) return;
  skf_element s = *e;
  skf_primitive *p = &s.primitive;
#define MOVE(a) (a) = v3_add(turn(m, (a)), shift)
  switch (p->shape) {
  case SKF_POINT: MOVE(p->point.at); break;
  case SKF_SEGMENT: MOVE(p->segment.from), MOVE(p->segment.to); break;
  case SKF_ARC:
    MOVE(p->arc.center);
    p->arc.normal = turn(m, p->arc.normal), p->arc.start = turn(m, p->arc.start);
    break;
  case SKF_TRIANGLE:
    for (int i = 0; i < 3; i++) MOVE(p->triangle.vertices[i]);
    break;
  default: MOVE(p->plane.through), p->plane.normal = turn(m, p->plane.normal);
  }
#undef MOVE
  skf_value v = value(e, x), w = value(&s, v3_add(turn(m, x), shift));
  skf_vec3 g = turn(m, v.g);
  double d = distance(e, x), scale = fmax(v3_norm(g), fabs(v.F) / d);
  /* an ulp of each coordinate moves F by |g| ulps */
  check_scaled(w.F, v.F, fabs(v.F) + 5 * v3_norm(g), 1e-13);
  check_scaled(v3_dist(w.g, g), 0, scale + 5 * norm6(v.h), 1e-13);
  check_scaled(norm6(w.h), norm6(v.h), norm6(v.h) + scale / d, skf_kernel_get(e->kernel.type)->compact ? 1e-9 : 1e-12);
}

static void test_motion(void **state) {
  (void)state;
  for_all(motion);
}

/* Far away, and for kernels wider than the body, a body is its measure at a point. */
static void test_limits(void **state) {
  (void)state;
  uint64_t seed = 11;
  for (int s = 0; s < SKF_PLANE; s++)
    for (int i = 0; i < ROUNDS; i++) {
      skf_element e = random_element(&seed, SKF_INVERSE, s);
      skf_vec3 x = v3_scale(1e9, rnd_unit(&seed));
      double mu = skf_primitive_measure(&e.primitive);
      check_close(value(&e, x).F, mu / 1e9, 1e-8);
      e.kernel.type = SKF_INVERSE_SQUARED;
      check_close(value(&e, x).F, mu / 1e18, 1e-8);
      e.kernel = (skf_kernel){SKF_CAUCHY, 1e-6};
      check_close(value(&e, v3(0, 0, 0)).F, mu, 1e-10);
      e.kernel = (skf_kernel){SKF_GAUSSIAN, 1e-6};
      check_close(value(&e, v3(0, 0, 0)).F, mu, 1e-10);
      for (int k = SKF_METABALL; k <= SKF_QUARTIC; k++) {
        e.kernel = (skf_kernel){(skf_kernel_type)k, 1e6};
        check_close(value(&e, v3(0, 0, 0)).F, mu, 1e-10);
      }
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_differences), cmocka_unit_test(test_laplace),   cmocka_unit_test(test_splits),
      cmocka_unit_test(test_scaling),     cmocka_unit_test(test_motion),    cmocka_unit_test(test_limits),
      cmocka_unit_test(test_extremes),    cmocka_unit_test(test_narrowest),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
