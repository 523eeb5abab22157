/* SPDX-License-Identifier: MIT */
/* Weights along segments and arcs: against numbers with 36 digits, against adaptive quadrature, and what must hold
   whatever the formulas. */
#include "check.h"
#include "field/quadrature.h"
#include "random.h"
#include "skelfield/field.h"
#include <string.h>

static const skf_profile_knot knots[] = {{0, 0, 1}, {0.25, 1.25, -0.5}, {0.625, 0.375, 2}, {1, -0.5, 0}};

typedef struct row {
  skf_kernel_type kernel;
  double param;
  skf_shape shape;
  double v[11];
  skf_profile profile;
  double x[3], want[10];
} row;

static const row rows[] = {
#include "profile_reference.inc"
};

static skf_vec3 at(const double *x) { return v3(x[0], x[1], x[2]); }

static skf_element element_of(const row *r) {
  skf_element e = {.kernel = {r->kernel, r->param}, .strength = 1, .profile = &r->profile};
  e.primitive.shape = r->shape;
  if (r->shape == SKF_SEGMENT)
    e.primitive.segment = (skf_segment){at(r->v), at(r->v + 3)};
  else
    e.primitive.arc = (skf_arc){at(r->v), at(r->v + 3), at(r->v + 6), r->v[9], r->v[10]};
  return e;
}

static skf_value value(const skf_element *e, size_t n, skf_vec3 x) {
  skf_field *f;
  skf_value v;
  assert_int_equal(skf_field_new(e, n, &f), SKF_OK);
  v.F = skf_field_tensor_at(f, x, &v.g, v.h);
  skf_field_free(f);
  return v;
}

static double norm6(const double h[6]) {
  return sqrt(h[0] * h[0] + h[3] * h[3] + h[5] * h[5] + 2 * (h[1] * h[1] + h[2] * h[2] + h[4] * h[4]));
}

/* Errors of F, gradient and Hessian. Their scales are those of the weight's absolute value: where it changes sign the
   field may vanish. */
typedef struct errors {
  double F, g, h;
} errors;

static errors compare(const skf_value *got, const skf_value *want, const skf_value *scale, double d) {
  double D[6], g = fmax(v3_norm(scale->g), scale->F / d), h = fmax(norm6(scale->h), g / d);
  for (int k = 0; k < 6; k++) D[k] = got->h[k] - want->h[k];
  return (errors){fabs(got->F - want->F) / scale->F, v3_dist(got->g, want->g) / g, norm6(D) / h};
}

/* The same element of constant weight, the largest of the profile. */
static skf_value bulk(const skf_element *e, skf_vec3 x) {
  skf_element whole = *e;
  double most = 0;
  for (int i = 0; i <= 64; i++) most = fmax(most, fabs(skf_profile_at(e->profile, i / 64.)));
  whole.profile = NULL, whole.strength = most;
  return value(&whole, 1, x);
}

/* How far the field moves when each coordinate of x moves by eight ulps of what it is made of. */
static errors conditioning(const skf_element *e, skf_vec3 x, const skf_value *scale, double d) {
  errors c = {0, 0, 0};
  skf_value here = value(e, 1, x);
  for (int i = 0; i < 6; i++) {
    skf_vec3 y = x;
    double *at = v3_at(&y, i / 2), step = 8 * 2.3e-16 * fmax(fabs(*at), d);
    *at += i & 1 ? step : -step;
    skf_value there = value(e, 1, y);
    errors moved = compare(&there, &here, scale, d);
    c = (errors){fmax(c.F, moved.F), fmax(c.g, moved.g), fmax(c.h, moved.h)};
  }
  return c;
}

static void reference(void **state) {
  (void)state;
  errors worst = {0, 0, 0};
  size_t n = sizeof rows / sizeof *rows, limited = 0;
  assert_true(n > 200);
  for (size_t i = 0; i < n; i++) {
    const row *r = rows + i;
    skf_element e = element_of(r);
    skf_vec3 x = at(r->x);
    skf_value got = value(&e, 1, x), want = {.F = r->want[0], .g = at(r->want + 1)}, scale;
    memcpy(want.h, r->want + 4, sizeof want.h);
    scale = want;
    scale.F = fmax(fabs(want.F), 1e-3 * bulk(&e, x).F); /* where the weight changes its sign, F may vanish */
    double size = r->shape == SKF_ARC ? r->v[9] : skf_primitive_measure(&e.primitive);
    double d = fmax(size, skf_primitive_distance(&e.primitive, x));
    errors err = compare(&got, &want, &scale, d);
    if (err.F <= 1e-12 && err.g <= 1e-11 && err.h <= 1e-10) {
      worst = (errors){fmax(worst.F, err.F), fmax(worst.g, err.g), fmax(worst.h, err.h)};
      continue;
    }
    errors c = conditioning(&e, x, &scale, d);
    limited++;
    if (!(err.F <= fmax(1e-12, c.F)) || !(err.g <= fmax(1e-11, c.g)) || !(err.h <= fmax(1e-10, c.h)))
      fail_msg("row %zu (%s, %s, profile %d): F %.2g, gradient %.2g, Hessian %.2g", i + 1,
               skf_kernel_get(r->kernel)->name, r->shape == SKF_ARC ? "arc" : "segment", r->profile.type, err.F, err.g,
               err.h);
  }
  print_message("%zu rows: F %.2g, gradient %.2g, Hessian %.2g; %zu more within eight ulps of the place\n", n - limited,
                worst.F, worst.g, worst.h, limited);
  assert_true(limited < n / 20);
}

static const skf_profile profiles[] = {
    {SKF_PROFILE_LINEAR, {1, 0}, NULL, 0, 0, 0}, {SKF_PROFILE_LINEAR, {-0.5, 2}, NULL, 0, 0, 0},
    {SKF_PROFILE_HAT, {0, 0}, NULL, 0, 0, 0},    {SKF_PROFILE_SINE, {0, 0}, NULL, 0, 0, 0},
    {SKF_PROFILE_CUBIC, {0, 0}, knots, 4, 0, 0}, {SKF_PROFILE_HAT, {0, 0}, NULL, 0, 0.2, 0.9},
    {SKF_PROFILE_SINE, {0, 0}, NULL, 0, 0.3, 1}, {SKF_PROFILE_CUBIC, {0, 0}, knots, 4, 0.1, 0.5},
};
enum { PROFILES = sizeof profiles / sizeof *profiles };

static skf_element random_element(uint64_t *seed, int kernel, skf_shape shape) {
  skf_element e = {.kernel.type = (skf_kernel_type)kernel, .strength = 1};
  const skf_kernel_info *info = skf_kernel_get(e.kernel.type);
  double width = pow(10, rnd(seed, -0.7, 0.7));
  if (info->param) e.kernel.param = info->compact ? 2 * width : 1 / width;
  rnd_primitive(seed, shape, 1, &e.primitive);
  return e;
}

static skf_vec3 random_place(uint64_t *seed, const skf_primitive *p) {
  return v3_mad(skf_primitive_point(p, rnd(seed, 0, 1), 0), pow(10, rnd(seed, -2, 0.5)), rnd_unit(seed));
}

typedef void (*property)(uint64_t *seed, skf_element *e, skf_vec3 x);

static void for_all(property check, int rounds) {
  uint64_t seed = 3;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = SKF_SEGMENT; s <= SKF_ARC; s++)
      for (int i = 0; i < rounds * PROFILES; i++) {
        skf_element e = random_element(&seed, k, (skf_shape)s);
        e.profile = profiles + i % PROFILES;
        check(&seed, &e, random_place(&seed, &e.primitive));
      }
}

/* Adaptive quadrature, which shares the frames and the weights alone. */
static void quadrature(uint64_t *seed, skf_element *e, skf_vec3 x) {
  (void)seed;
  skf_prepared p;
  skf_value want = {.F = 0}, got = value(e, 1, x), scale = bulk(e, x);
  skf_weight *w;
  skf_prepare(e, &p);
  assert_int_equal(skf_weight_new(e->profile, &w), SKF_OK);
  p.weight = w;
  skf_quadrature(&p, x, 2, &want);
  skf_weight_free(w);
  if (scale.F < 1e-6) return; /* near the rim quadrature has no relative accuracy */
  errors err = compare(&got, &want, &scale, skf_primitive_distance(&e->primitive, x));
  if (!(err.F < 2e-11 && err.g < 2e-11 && err.h < 1e-9))
    fail_msg("%s on %s, profile %d: F %.2g, gradient %.2g, Hessian %.2g", skf_kernel_get(e->kernel.type)->name,
             skf_shape_get(e->primitive.shape)->name, (int)(e->profile - profiles), err.F, err.g, err.h);
}

static void agrees_with_quadrature(void **state) {
  (void)state;
  for_all(quadrature, 5);
}

static void close_to(const skf_value *a, const skf_value *b, const skf_value *scale, double d, double tol) {
  errors err = compare(a, b, scale, d);
  check_scaled(err.F, 0, 1, tol);
  check_scaled(err.g, 0, 1, 10 * tol);
  check_scaled(err.h, 0, 1, 100 * tol);
}

/* Cut anywhere, each part carries its part of the profile. */
static void splits(uint64_t *seed, skf_element *e, skf_vec3 x) {
  double s = rnd(seed, 0.1, 0.9), d = skf_primitive_distance(&e->primitive, x);
  double from = e->profile->from, to = e->profile->to > 0 ? e->profile->to : 1, mid = from + s * (to - from);
  skf_profile first = *e->profile, second = *e->profile;
  first.to = second.from = mid, second.to = to;
  skf_element part[2] = {*e, *e};
  part[0].profile = &first, part[1].profile = &second;
  skf_vec3 m = skf_primitive_point(&e->primitive, s, 0);
  if (e->primitive.shape == SKF_SEGMENT)
    part[0].primitive.segment.to = part[1].primitive.segment.from = m;
  else {
    double sweep = e->primitive.arc.sweep;
    part[0].primitive.arc.sweep = s * sweep, part[1].primitive.arc.sweep = sweep - s * sweep;
    part[1].primitive.arc.start = v3_sub(m, e->primitive.arc.center);
  }
  skf_value whole = value(e, 1, x), sum = value(part, 2, x), scale = bulk(e, x);
  if (d > 0.2 && scale.F > 1e-4) close_to(&sum, &whole, &scale, d, 2e-13);
}

static void parts_add_up(void **state) {
  (void)state;
  for_all(splits, 3);
}

/* The cut of a linear profile in two linear halves. */
static void linear_halves(void **state) {
  (void)state;
  const skf_profile whole = {.ends = {3, 1}}, left = {.ends = {3, 2}}, right = {.ends = {2, 1}};
  for (int k = 0; k < SKF_KERNEL_COUNT; k++) {
    skf_element e = {.kernel = {(skf_kernel_type)k, k < SKF_METABALL ? 1.5 : 3}, .strength = 1, .profile = &whole};
    e.primitive = (skf_primitive){.shape = SKF_SEGMENT, .segment = {{-1, 0, 0}, {1, 0, 0}}};
    skf_element half[2] = {e, e};
    half[0].primitive.segment.to = half[1].primitive.segment.from = v3(0, 0, 0);
    half[0].profile = &left, half[1].profile = &right;
    for (int i = 0; i < 20; i++) {
      skf_vec3 x = v3(-1.9 + 0.2 * i, 0.5, 0.25);
      skf_value a = value(&e, 1, x), b = value(half, 2, x), scale = bulk(&e, x);
      close_to(&a, &b, &scale, 0.5, 1e-13);
    }
  }
}

static void constant(uint64_t *seed, skf_element *e, skf_vec3 x) {
  (void)seed;
  static const skf_profile_knot flat[] = {{0, 1, 0}, {0.3, 1, 0}, {1, 1, 0}};
  const skf_profile one[2] = {{.ends = {1, 1}}, {.type = SKF_PROFILE_CUBIC, .knots = flat, .knot_count = 3}};
  double d = skf_primitive_distance(&e->primitive, x);
  e->profile = NULL;
  skf_value want = value(e, 1, x);
  if (want.F < 1e-8) return;
  for (int i = 0; i < 2; i++) {
    e->profile = one + i;
    skf_value got = value(e, 1, x);
    close_to(&got, &want, &want, d, 1e-12);
  }
}

static void a_weight_of_one_is_none(void **state) {
  (void)state;
  for_all(constant, 3);
}

/* Far beside short bodies a length is not the difference of two abscissae, wherever kernels or profiles cut it. */
static void short_bodies_keep_their_length(void **state) {
  (void)state;
  static const skf_profile_knot flat[] = {{0, 1, 0}, {0.3, 1, 0}, {1, 1, 0}};
  static const skf_profile one = {.type = SKF_PROFILE_CUBIC, .knots = flat, .knot_count = 3};
  uint64_t seed = 9;
  for (int i = 0; i < 600; i++) {
    double D = pow(10, rnd(&seed, 3, 6)), near = pow(10, rnd(&seed, -6, -1)), at = rnd(&seed, 0, 1);
    skf_element e = {.kernel.type = (skf_kernel_type)(SKF_METABALL + i % 3), .strength = 1};
    e.primitive.shape = i & 1 ? SKF_ARC : SKF_SEGMENT;
    if (i & 1)
      e.primitive.arc = (skf_arc){rnd_vec(&seed, 3), rnd_unit(&seed), rnd_unit(&seed), 0.1 * D, 10 / D};
    else
      e.primitive.segment.to = v3_add(e.primitive.segment.from = rnd_vec(&seed, 3), rnd_unit(&seed));
    skf_vec3 x = v3_mad(skf_primitive_point(&e.primitive, at, 0), D, rnd_unit(&seed));
    double R = skf_primitive_distance(&e.primitive, x) * (i & 3 ? 3 : 1); /* core or rim */
    e.kernel.param = R * (1 + near);
    skf_value want = value(&e, 1, x), got;
    e.profile = &one, got = value(&e, 1, x);
    close_to(&got, &want, &want, D, 1e-12);
  }
}

/* Lengths times 2^24, 1.7e7, and back: only the dimension counts. */
static void scaled(uint64_t *seed, skf_element *e, skf_vec3 x) {
  (void)seed;
  const skf_kernel_info *info = skf_kernel_get(e->kernel.type);
  skf_value v = value(e, 1, x), scale = bulk(e, x);
  for (int power = -24; power <= 24; power += 48) {
    double c = ldexp(1, power), unit = e->kernel.type == SKF_INVERSE           ? 1
                                       : e->kernel.type == SKF_INVERSE_SQUARED ? c
                                                                               : 1 / c;
    skf_element s = *e;
    if (info->param) s.kernel.param *= info->compact ? c : 1 / c;
    if (e->primitive.shape == SKF_SEGMENT) {
      skf_segment *t = &s.primitive.segment;
      t->from = v3_scale(c, t->from), t->to = v3_scale(c, t->to);
    } else
      s.primitive.arc.center = v3_scale(c, s.primitive.arc.center), s.primitive.arc.radius *= c;
    skf_value w = value(&s, 1, v3_scale(c, x));
    w.F *= unit, w.g = v3_scale(unit * c, w.g);
    for (int k = 0; k < 6; k++) w.h[k] *= unit * c * c;
    if (scale.F > 0) close_to(&w, &v, &scale, skf_primitive_distance(&e->primitive, x), 1e-14);
  }
}

static void scale_does_not_matter(void **state) {
  (void)state;
  for_all(scaled, 1);
}

static void turned(uint64_t *seed, skf_element *e, skf_vec3 x) {
  skf_vec3 m[3];
  m[0] = rnd_unit(seed), m[1] = v3_perp(m[0]), m[2] = v3_cross(m[0], m[1]);
#define TURN(a) v3(v3_dot(m[0], a), v3_dot(m[1], a), v3_dot(m[2], a))
  skf_element s = *e;
  if (e->primitive.shape == SKF_SEGMENT)
    s.primitive.segment = (skf_segment){TURN(e->primitive.segment.from), TURN(e->primitive.segment.to)};
  else {
    skf_arc *a = &s.primitive.arc;
    a->center = TURN(a->center), a->normal = TURN(a->normal), a->start = TURN(a->start);
  }
  double d = skf_primitive_distance(&e->primitive, x);
  skf_value v = value(e, 1, x), w = value(&s, 1, TURN(x)), scale = bulk(e, x);
  v.g = TURN(v.g);
  if (d < 0.3 || scale.F < 1e-3) return;
  memcpy(v.h, w.h, sizeof v.h);
  close_to(&w, &v, &scale, fmin(d, 1), 2e-13);
#undef TURN
}

static void direction_does_not_matter(void **state) {
  (void)state;
  for_all(turned, 2);
}

/* 1/r is harmonic whatever the weight; and differences of the gradient are the Hessian. */
static void derivatives(uint64_t *seed, skf_element *e, skf_vec3 x) {
  (void)seed;
  double d = skf_primitive_distance(&e->primitive, x), step = 1e-4 * d;
  skf_value v = value(e, 1, x), scale = bulk(e, x);
  double h = fmax(norm6(scale.h), v3_norm(scale.g) / d);
  if (e->kernel.type == SKF_INVERSE) check_scaled(v.h[0] + v.h[3] + v.h[5], 0, h, 2e-13);
  static const int index[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  if (d < 0.05 || scale.F < 1e-8 || skf_kernel_get(e->kernel.type)->compact) return;
  for (int i = 0; i < 3; i++) {
    skf_vec3 a = x, b = x;
    *v3_at(&a, i) -= step, *v3_at(&b, i) += step;
    skf_value lo = value(e, 1, a), hi = value(e, 1, b);
    check_scaled((hi.F - lo.F) / (2 * step), v3_get(v.g, i), fmax(v3_norm(scale.g), scale.F / d), 1e-6);
    for (int k = 0; k < 3; k++)
      check_scaled((v3_get(hi.g, k) - v3_get(lo.g, k)) / (2 * step), v.h[index[i][k]], h, 1e-6);
  }
}

static void derivatives_are_differences(void **state) {
  (void)state;
  for_all(derivatives, 1);
}

/* The bounds of the field and the box of the surface hold, also where the weight changes its sign. */
static void bounds(uint64_t *seed, skf_element *e, skf_vec3 x) {
  skf_field *f;
  skf_box box;
  e->strength = rnd(seed, 0, 1) < 0.3 ? -2 : 1.5;
  assert_int_equal(skf_field_new(e, 1, &f), SKF_OK);
  double radius = pow(10, rnd(seed, -2, 0.3));
  skf_bound b = skf_field_bound(f, x, radius);
  skf_status s = skf_field_region(f, 0.3, &box);
  for (int i = 0; i < 60; i++) {
    skf_vec3 g, p = v3_mad(x, radius * cbrt(rnd(seed, 0, 1)), rnd_unit(seed));
    double F = skf_field_at(f, p, &g);
    assert_true(F >= b.lo - 1e-12 * fabs(F) && F <= b.hi + 1e-12 * fabs(F));
    assert_true(!isfinite(F) || v3_norm(g) <= b.gradient * (1 + 1e-12));
    p = rnd_vec(seed, 4);
    bool inside = s == SKF_OK && p.x >= box.lo.x && p.y >= box.lo.y && p.z >= box.lo.z && p.x <= box.hi.x &&
                  p.y <= box.hi.y && p.z <= box.hi.z;
    if (!inside) assert_true(skf_field_at(f, p, NULL) < 0.3);
  }
  skf_field_free(f);
}

static void bounds_hold(void **state) {
  (void)state;
  for_all(bounds, 2);
}

/* Batches give the same bits as single points. */
static void batches(void **state) {
  (void)state;
  enum { N = 300, M = 2 * PROFILES + 6 };
  uint64_t seed = 5;
  skf_element e[M];
  for (int i = 0; i < M; i++) {
    e[i] = random_element(&seed, i % SKF_KERNEL_COUNT, i & 1 ? SKF_ARC : SKF_SEGMENT);
    e[i].profile = i < 2 * PROFILES ? profiles + i / 2 : NULL;
  }
  static double p[3][N], F[N], g[3][N];
  for (int i = 0; i < N; i++)
    for (int k = 0; k < 3; k++) p[k][i] = rnd(&seed, -2, 2);
  skf_field *all, *each[M];
  assert_int_equal(skf_field_new(e, 2 * PROFILES, &all), SKF_OK);
  for (int i = 0; i < M; i++) assert_int_equal(skf_field_new(e + i, 1, each + i), SKF_OK);
  const double *const in[3] = {p[0], p[1], p[2]};
  double *const out[3] = {g[0], g[1], g[2]};
  assert_int_equal(skf_field_eval(all, N, in, F, out, NULL), SKF_OK);
  for (int i = 0; i < N; i++) {
    skf_vec3 G, x = v3(p[0][i], p[1][i], p[2][i]);
    double want = skf_field_at(all, x, &G);
    check_close(F[i], want, 1e-14);
    assert_true(fabs(g[0][i] - G.x) <= 1e-13 * v3_norm(G) && fabs(g[2][i] - G.z) <= 1e-13 * v3_norm(G));
  }
  for (int i = 0; i < 2 * PROFILES; i++) {
    assert_int_equal(skf_field_eval(each[i], N, in, F, out, NULL), SKF_OK);
    for (int k = 0; k < N; k++) assert_true(F[k] == skf_field_at(each[i], v3(p[0][k], p[1][k], p[2][k]), NULL));
  }
  for (int i = 0; i < M; i++) skf_field_free(each[i]);
  skf_field_free(all);
}

/* Fields in floats know the weights, too. */
static void floats(void **state) {
  (void)state;
  const skf_profile half = {.ends = {0, 1}};
  skf_element e = {.kernel = {SKF_INVERSE, 1}, .strength = 1, .profile = &half};
  e.primitive = (skf_primitive){.shape = SKF_SEGMENT, .segment = {{-1, 0, 0}, {1, 0, 0}}};
  skf_field *f;
  skf_field_f32 *g;
  float p[3][8] = {{0}, {1, 1, 1, 1, 1, 1, 1, 1}, {0}}, F[8];
  for (int i = 0; i < 8; i++) p[0][i] = -2 + 0.5f * (float)i;
  const float *const in[3] = {p[0], p[1], p[2]};
  assert_int_equal(skf_field_new(&e, 1, &f), SKF_OK);
  assert_int_equal(skf_field_f32_new(f, v3(0, 0, 0), 1, &g), SKF_OK);
  assert_int_equal(skf_field_f32_eval(g, 8, in, F, NULL), SKF_OK);
  for (int i = 0; i < 8; i++) check_close(F[i], skf_field_at(f, v3(p[0][i], 1, 0), NULL), 1e-5);
  skf_field_f32_free(g), skf_field_free(f);
}

/* On the body itself: infinite by the weight there, finite at its zeros for 1/r. */
static void on_the_body(void **state) {
  (void)state;
  skf_element e = {.kernel = {SKF_INVERSE, 1}, .strength = 1, .profile = profiles + 1};
  e.primitive = (skf_primitive){.shape = SKF_SEGMENT, .segment = {{0, 0, 0}, {5, 0, 0}}};
  skf_value v = value(&e, 1, v3(3, 0, 0));
  assert_true(v.F == INFINITY && v3_norm(v.g) == 0);
  assert_true(value(&e, 1, v3(0.5, 0, 0)).F == -INFINITY);
  v = value(&e, 1, v3(1, 0, 0)); /* the weight is (x - 1) / 2: int sign(x - 1) / 2 dx */
  check_close(v.F, 0.5 * (4 - 1), 1e-13);
  assert_true(v3_norm(v.g) == 0);
  e.primitive = (skf_primitive){.shape = SKF_ARC, .arc = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 2, SKF_PI}};
  e.profile = profiles + 3;
  assert_true(value(&e, 1, v3(0, 2, 0)).F == INFINITY);
  v = value(&e, 1, v3(2, 0, 0)); /* int sin^2(phi) / (4 sin(phi / 2)) 2 dphi = int 2 sin cos^2 (phi / 2) = 4 / 3 */
  check_close(v.F, 4. / 3, 1e-13);
}

static void measures(void **state) {
  (void)state;
  for (int i = 0; i < PROFILES; i++) {
    const skf_profile *p = profiles + i;
    skf_element e = {.primitive = {.shape = SKF_SEGMENT, .segment = {{0, 0, 0}, {0, 0, 4}}}, .profile = p};
    double sum = 0;
    enum { N = 40000 };
    for (int k = 0; k < N; k++) sum += 4. / N * skf_profile_at(p, (k + 0.5) / N);
    check_scaled(skf_element_measure(&e), sum, 1, 1e-8);
    e.kernel = (skf_kernel){SKF_GAUSSIAN, 1e-9}, e.strength = 1; /* so wide that F is the measure */
    check_close(value(&e, 1, v3(1, 1, 1)).F, skf_element_measure(&e), 1e-13);
  }
}

/* Without the Hessian fewer nodes do. */
static void fewer_nodes(void **state) {
  (void)state;
  uint64_t seed = 20;
  errors worst = {0, 0, 0};
  for (int i = 0; i < 20000; i++) {
    skf_profile p = profiles[i % PROFILES];
    skf_element e = {.kernel = {SKF_GAUSSIAN, exp(rnd(&seed, -3, 3))}, .strength = 1, .profile = &p}, whole = e;
    double sweep = fmin(2 * SKF_PI, exp(rnd(&seed, -4, 2.2)));
    e.primitive = (skf_primitive){.shape = SKF_ARC, .arc = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 1, sweep}};
    whole.primitive = e.primitive, whole.profile = NULL;
    for (int k = 0; k <= 64; k++) whole.strength = fmax(whole.strength, fabs(skf_profile_at(&p, k / 64.)));
    skf_vec3 x = v3(rnd(&seed, -1.4, 1.4), rnd(&seed, -1.4, 1.4), exp(rnd(&seed, -8, 0)));
    skf_value want = value(&e, 1, x), scale = value(&whole, 1, x), got = want;
    skf_field *f;
    assert_int_equal(skf_field_new(&e, 1, &f), SKF_OK);
    got.F = skf_field_at(f, x, &got.g);
    skf_field_free(f);
    if (!(scale.F > 1e-250)) continue;
    errors now = compare(&got, &want, &scale, 1 / e.kernel.param);
    worst.F = fmax(worst.F, now.F), worst.g = fmax(worst.g, now.g);
  }
  print_message("fewer nodes: F %.2g, gradient %.2g\n", worst.F, worst.g);
  assert_true(worst.F < 1e-13 && worst.g < 1e-13);
}

static void refused(const skf_profile *p, skf_shape shape, skf_status want) {
  uint64_t seed = 1;
  skf_element e = {.kernel = {SKF_CAUCHY, 1}, .strength = 1, .profile = p};
  skf_field *f;
  rnd_primitive(&seed, shape, 1, &e.primitive);
  assert_int_equal(skf_field_new(&e, 1, &f), want);
  assert_null(f);
}

static void bad_profiles_are_refused(void **state) {
  (void)state;
  static const skf_profile_knot back[] = {{0, 1, 0}, {0.6, 1, 0}, {0.5, 1, 0}, {1, 1, 0}},
                                none[] = {{0, 0, 0}, {1, 0, 0}}, late[] = {{0.1, 1, 0}, {1, 1, 0}},
                                nan[] = {{0, NAN, 0}, {1, 1, 0}};
#define CUBIC(k) (&(skf_profile){.type = SKF_PROFILE_CUBIC, .knots = k, .knot_count = sizeof k / sizeof *k})
  refused(CUBIC(back), SKF_SEGMENT, SKF_ERR_RANGE);
  refused(CUBIC(none), SKF_SEGMENT, SKF_ERR_RANGE);
  refused(CUBIC(late), SKF_ARC, SKF_ERR_RANGE);
  refused(CUBIC(nan), SKF_ARC, SKF_ERR_RANGE);
  refused(&(skf_profile){.type = SKF_PROFILE_CUBIC, .knots = back, .knot_count = 1}, SKF_SEGMENT, SKF_ERR_RANGE);
  refused(&(skf_profile){.type = SKF_PROFILE_COUNT}, SKF_SEGMENT, SKF_ERR_ARG);
  refused(&(skf_profile){.ends = {0, 0}}, SKF_SEGMENT, SKF_ERR_RANGE);
  refused(&(skf_profile){.ends = {0, INFINITY}}, SKF_SEGMENT, SKF_ERR_RANGE);
  refused(&(skf_profile){.ends = {0, 1}, .from = 0.5, .to = 0.5}, SKF_SEGMENT, SKF_ERR_RANGE);
  for (int s = 0; s < SKF_SHAPE_COUNT; s++)
    if (s != SKF_SEGMENT && s != SKF_ARC) refused(profiles, (skf_shape)s, SKF_ERR_ARG);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(reference),
      cmocka_unit_test(agrees_with_quadrature),
      cmocka_unit_test(parts_add_up),
      cmocka_unit_test(linear_halves),
      cmocka_unit_test(a_weight_of_one_is_none),
      cmocka_unit_test(short_bodies_keep_their_length),
      cmocka_unit_test(scale_does_not_matter),
      cmocka_unit_test(direction_does_not_matter),
      cmocka_unit_test(derivatives_are_differences),
      cmocka_unit_test(bounds_hold),
      cmocka_unit_test(batches),
      cmocka_unit_test(floats),
      cmocka_unit_test(on_the_body),
      cmocka_unit_test(measures),
      cmocka_unit_test(fewer_nodes),
      cmocka_unit_test(bad_profiles_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
