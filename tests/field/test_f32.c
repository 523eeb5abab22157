/* SPDX-License-Identifier: MIT */
/* Fields in floats against doubles: the error that field.h states, for every pair, in every frame, and for sums. */
#include "check.h"
#include "chords.h"
#include "core/vec3.h"
#include "random.h"
#include "skelfield/field.h"
#include <omp.h>
#include <string.h>

enum { POINTS = 600 };
static const double ulp = 0x1p-24;

static float p[3][POINTS], F[POINTS], g[3][POINTS];

static skf_field *make(const skf_element *e, size_t n) {
  skf_field *f;
  assert_int_equal(skf_field_new(e, n, &f), SKF_OK);
  return f;
}

static void eval(const skf_field *f, skf_vec3 origin, double unit) {
  const float *const in[3] = {p[0], p[1], p[2]};
  float *const out[3] = {g[0], g[1], g[2]};
  skf_field_f32 *f32;
  assert_int_equal(skf_field_f32_new(f, origin, unit, &f32), SKF_OK);
  assert_int_equal(skf_field_f32_eval(f32, POINTS, in, F, out), SKF_OK);
  skf_field_f32_free(f32);
}

static skf_vec3 local(int i) { return v3((double)p[0][i], (double)p[1][i], (double)p[2][i]); }

/* In the frame of the element: a third anywhere, a third near the body, the rest on it or on its axis. */
static void scatter(uint64_t *seed, const skf_primitive *at) {
  for (int i = 0; i < POINTS; i++) {
    skf_vec3 on = skf_primitive_point(at, rnd(seed, 0, 1), rnd(seed, 0, 1)), x = rnd_vec(seed, 2);
    if (i % 3 == 1) x = v3_mad(on, pow(10, rnd(seed, -7, 1)), rnd_unit(seed));
    if (i % 24 == 2) x = on;
    for (int k = 0; k < 3; k++) p[k][i] = (float)v3_get(x, k);
  }
}

/* How many times the allowed error; `moved`: by how much the point may be off [L]. */
static double excess(const skf_field *f, skf_vec3 x, double moved, double units, double floor, int i) {
  double h[6], H = 0;
  skf_vec3 G, got = v3((double)g[0][i], (double)g[1][i], (double)g[2][i]);
  double want = skf_field_tensor_at(f, x, &G, h);
  if (!isfinite(want)) return 0; /* on the body, which is rounded too */
  for (int k = 0; k < 6; k++) H += fabs(h[k]) * (k == 1 || k == 2 || k == 4 ? 2 : 1);
  double slack = units * ulp * fabs(want) + moved * v3_norm(G) + moved * moved * H + floor;
  double slack_g = units * ulp * v3_norm(G) + moved * H + floor;
  return fmax(fabs((double)F[i] - want) / slack, v3_dist(got, G) / slack_g);
}

/* The worst of an element at all points, in allowed errors */
static double points_excess(const skf_element *e, double units) {
  double worst = 0;
  skf_field *f = make(e, 1);
  eval(f, v3(0, 0, 0), 1);
  for (int i = 0; i < POINTS; i++) {
    skf_vec3 x = local(i);
    double d = skf_primitive_distance(&e->primitive, x), size = fmax(v3_norm(x), 1.8), moved = 4 * ulp * size;
    if (d < 8 * moved) continue; /* where the point ends up is anyone's guess */
    double off = excess(f, x, moved, units, 1e-36, i), depth = 2 * moved / e->kernel.param;
    /* at the rim a metaball's segment may give what it does as deep as the point may move */
    if (e->kernel.type == SKF_METABALL && e->primitive.shape == SKF_SEGMENT && fabs(d - e->kernel.param) < moved)
      off = fmin(off, fmax(fabs((double)F[i]) / (1.5 * depth * depth * 2 * e->kernel.param),
                           v3_norm(v3((double)g[0][i], (double)g[1][i], (double)g[2][i])) / (6 * depth)));
    worst = fmax(worst, off);
  }
  skf_field_free(f);
  return worst;
}

static double element_excess(uint64_t *seed, const skf_element *e, double units) {
  scatter(seed, &e->primitive);
  return points_excess(e, units);
}

static void test_pairs(void **state) {
  (void)state;
  uint64_t seed = 31;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = 0; s < SKF_SOLID; s++) {
      double worst = 0, units = s == SKF_TRIANGLE ? 512 : 16;
      int repeats = s == SKF_TRIANGLE && k != SKF_INVERSE ? 4 : 9;
      for (int n = 0; n < repeats; n++) {
        skf_element e = {.kernel = {(skf_kernel_type)k, rnd(&seed, 0.3, 3), NULL}, .strength = n % 2 ? -0.7 : 1};
        rnd_primitive(&seed, (skf_shape)s, 1, &e.primitive);
        worst = fmax(worst, element_excess(&seed, &e, units));
      }
      print_message("%-16s %-9s %.2f of the allowed error\n", skf_kernel_get((skf_kernel_type)k)->name,
                    skf_shape_get((skf_shape)s)->name, worst);
      assert_true(worst <= 1);
    }
}

/* Supports many times as large as what is in them */
static void test_wide(void **state) {
  (void)state;
  static const skf_kernel_type kernels[] = {SKF_METABALL, SKF_SOFT_OBJECT, SKF_QUARTIC};
  static const skf_shape shapes[] = {SKF_SEGMENT, SKF_ARC};
  uint64_t seed = 34;
  for (int n = 0; n < 120; n++) {
    skf_element e = {.kernel = {kernels[n % 3], pow(10, rnd(&seed, 0, 1.5)), NULL}, .strength = 1};
    rnd_primitive(&seed, shapes[n / 3 % 2], 1, &e.primitive);
    double worst = element_excess(&seed, &e, 16);
    if (!(worst <= 2)) fail_msg("%s, R = %g: %.2f", skf_kernel_get(kernels[n % 3])->name, e.kernel.param, worst);
  }
}

/* Short arcs from where the products of distances to their ends leave the range of floats */
static void test_far_arcs(void **state) {
  (void)state;
  uint64_t seed = 35;
  for (int n = 0; n < 60; n++) {
    skf_element e = {.kernel = {n % 3 ? SKF_CAUCHY : SKF_INVERSE_SQUARED, pow(10, rnd(&seed, -1, 1.2)), NULL},
                     .strength = 1};
    rnd_primitive(&seed, SKF_ARC, 1, &e.primitive);
    e.primitive.arc.sweep = pow(10, rnd(&seed, -3, -1));
    for (int i = 0; i < POINTS; i++) {
      const skf_vec3 x = v3_scale(pow(10, rnd(&seed, 1, 4)), rnd_unit(&seed));
      for (int k = 0; k < 3; k++) p[k][i] = (float)v3_get(x, k);
    }
    skf_field *f = make(&e, 1);
    eval(f, v3(0, 0, 0), 1);
    for (int i = 0; i < POINTS; i++) {
      const double worst = excess(f, local(i), 4 * ulp * v3_norm(local(i)), 16, 1e-36, i);
      if (!(worst <= 2))
        fail_msg("sweep %g, s = %g, from %g: %.2f", e.primitive.arc.sweep, e.kernel.param, v3_norm(local(i)), worst);
    }
    skf_field_free(f);
  }
}

/* The worst at points at distances of 10^from to 10^to of the origin, in allowed errors */
static double far_excess(uint64_t *seed, const skf_element *e, double from, double to) {
  double worst = 0;
  for (int i = 0; i < POINTS; i++) {
    const skf_vec3 x = v3_scale(pow(10, rnd(seed, from, to)), rnd_unit(seed));
    for (int k = 0; k < 3; k++) p[k][i] = (float)v3_get(x, k);
  }
  skf_field *f = make(e, 1);
  eval(f, v3(0, 0, 0), 1);
  for (int i = 0; i < POINTS; i++) worst = fmax(worst, excess(f, local(i), 4 * ulp * v3_norm(local(i)), 16, 1e-36, i));
  skf_field_free(f);
  return worst;
}

/* 1 / r along short arcs, whose elliptic integrals have huge arguments; Cauchy's circles, whose gradient is tiny */
static void test_far(void **state) {
  (void)state;
  uint64_t seed = 36;
  for (int n = 0; n < 80; n++) {
    skf_element e = {.kernel = {n % 2 ? SKF_CAUCHY : SKF_INVERSE, pow(10, rnd(&seed, -6, 0)), NULL}, .strength = 1};
    rnd_primitive(&seed, SKF_ARC, 1, &e.primitive);
    e.primitive.arc.sweep = n % 2 ? 2 * SKF_PI : pow(10, rnd(&seed, -6, -1));
    const double worst = far_excess(&seed, &e, 1, 8);
    if (!(worst <= 2)) fail_msg("sweep %g, s = %g: %.2f", e.primitive.arc.sweep, e.kernel.param, worst);
  }
}

/* Cauchy's kernel along short arcs whose centre is much farther from the origin than they are and where they are seen
   from */
static void test_bent(void **state) {
  (void)state;
  uint64_t seed = 38;
  for (int n = 0; n < 200; n++) {
    skf_element e = {.primitive.shape = SKF_ARC, .kernel = {SKF_CAUCHY, pow(10, rnd(&seed, -2, 1.5)), NULL}};
    skf_arc *arc = &e.primitive.arc;
    e.strength = 1;
    arc->radius = pow(10, rnd(&seed, -0.3, 1)), arc->sweep = pow(10, rnd(&seed, -4, -1));
    arc->normal = rnd_unit(&seed), arc->start = v3_unit(v3_cross(arc->normal, rnd_unit(&seed)));
    arc->center = v3_mad(rnd_vec(&seed, 0.05), -arc->radius, arc->start);
    for (int i = 0; i < POINTS; i++) {
      const skf_vec3 on = skf_primitive_point(&e.primitive, rnd(&seed, 0, 1), 0);
      const skf_vec3 x = v3_mad(on, pow(10, rnd(&seed, -5, 0.5)), rnd_unit(&seed));
      for (int k = 0; k < 3; k++) p[k][i] = (float)v3_get(x, k);
    }
    skf_field *f = make(&e, 1);
    eval(f, v3(0, 0, 0), 1);
    const double size = fmax(0.05, box_diagonal(skf_primitive_bounds(&e.primitive)));
    for (int i = 0; i < POINTS; i++) {
      const double moved = 4 * ulp * fmax(1.7 * size, v3_norm(local(i)));
      if (skf_primitive_distance(&e.primitive, local(i)) < 8 * moved) continue;
      const double worst = excess(f, local(i), moved, 16, 1e-36, i);
      if (!(worst <= 2)) fail_msg("sweep %g, s = %g: %.2f", arc->sweep, e.kernel.param, worst);
    }
    skf_field_free(f);
  }
}

/* Circles on the axis: at the rim of their support, and in huge ones */
static void test_axis(void **state) {
  (void)state;
  static const skf_kernel_type kernels[] = {SKF_SOFT_OBJECT, SKF_QUARTIC};
  uint64_t seed = 37;
  for (int n = 0; n < 200; n++) {
    skf_element e = {.kernel = {kernels[n % 2], 1, NULL}, .strength = 1};
    rnd_primitive(&seed, SKF_ARC, 1, &e.primitive);
    skf_arc *arc = &e.primitive.arc;
    arc->sweep = 2 * SKF_PI;
    e.kernel.param = arc->radius * (n / 2 % 2 ? pow(10, rnd(&seed, 4, 8)) : 1 + pow(10, rnd(&seed, -2, -0.5)));
    for (int i = 0; i < POINTS; i++) {
      const skf_vec3 x = v3_mad(arc->center, arc->radius * pow(10, rnd(&seed, -8, -1)), rnd_unit(&seed));
      for (int k = 0; k < 3; k++) p[k][i] = (float)v3_get(x, k);
    }
    const double worst = points_excess(&e, 16);
    if (!(worst <= 2)) fail_msg("R / rho = %g: %.2f", e.kernel.param / arc->radius, worst);
  }
}

/* Places above the lines of a triangle's edges, at its support's rim, near it; half of the triangles are slivers. */
static void scatter_triangle(uint64_t *seed, const skf_element *e) {
  const skf_vec3 *v = e->primitive.triangle.vertices;
  const skf_vec3 n = v3_unit(v3_cross(v3_sub(v[1], v[0]), v3_sub(v[2], v[0])));
  for (int i = 0; i < POINTS; i++) {
    const skf_vec3 a = v[i % 3], on = v3_mad(a, rnd(seed, -0.5, 1.5), v3_sub(v[(i + 1) % 3], a));
    const double near = e->kernel.param * (1 - pow(10, rnd(seed, -7, -0.3)));
    skf_vec3 x = v3_mad(on, rnd(seed, -1, 1), n);
    if (i / 3 % 3 == 1) x = v3_mad(i % 2 ? a : on, near, rnd_unit(seed));
    if (i / 3 % 3 == 2) x = v3_mad(on, pow(10, rnd(seed, -5, 1)), rnd_unit(seed));
    for (int k = 0; k < 3; k++) p[k][i] = (float)v3_get(x, k);
  }
}

static void test_triangles(void **state) {
  (void)state;
  static const skf_kernel_type kernels[] = {SKF_INVERSE, SKF_INVERSE_SQUARED, SKF_METABALL, SKF_SOFT_OBJECT,
                                            SKF_QUARTIC};
  uint64_t seed = 35;
  for (int k = 0; k < 5; k++) {
    double most = 0;
    for (int n = 0; n < 24; n++) {
      skf_element e = {.kernel = {kernels[k], pow(10, rnd(&seed, -1, 1)), NULL}, .strength = 1};
      rnd_primitive(&seed, SKF_TRIANGLE, 1, &e.primitive);
      skf_vec3 *v = e.primitive.triangle.vertices;
      if (n % 2)
        v[2] = v3_mad(v3_mad(v[0], rnd(&seed, -0.1, 1.1), v3_sub(v[1], v[0])), pow(10, rnd(&seed, -3, -0.5)), v[2]);
      for (int i = 0; i < 3; i++)
        v[i] = v3(rint(v[i].x * 0x1p20) * 0x1p-20, rint(v[i].y * 0x1p20) * 0x1p-20, rint(v[i].z * 0x1p20) * 0x1p-20);
      scatter_triangle(&seed, &e);
      const double worst = points_excess(&e, 512);
      most = fmax(most, worst);
    }
    print_message("%-16s triangles %.2f of the allowed error\n", skf_kernel_get(kernels[k])->name, most);
    assert_true(most <= 1);
  }
}

/* Metaballs along segments, from much shorter than their support to much longer, seen from all that their forms tell
   apart but for what is at the rim to the last digits */
static void test_chords(void **state) {
  (void)state;
  uint64_t seed = 35;
  double most = 0;
  for (int n = 0; n < 400; n++) {
    const double L = n % 2 ? rnd(&seed, 0.2, 2) : pow(10, rnd(&seed, -4, 0)), R = n % 4 < 2 ? 1 : rnd(&seed, 0.02, 1);
    skf_element e = {.primitive.shape = SKF_SEGMENT, .kernel = {SKF_METABALL, R}, .strength = n % 2 ? -0.7 : 1};
    skf_segment *s = &e.primitive.segment;
    s->from = rnd_vec(&seed, n % 3 * 0.5), s->to = v3_mad(s->from, L, rnd_unit(&seed));
    for (int i = 0; i < POINTS; i++) {
      const skf_vec3 x = rnd_chord(&seed, s, R);
      for (int k = 0; k < 3; k++) p[k][i] = (float)v3_get(x, k);
    }
    const double worst = points_excess(&e, 16);
    if (!(worst <= 1)) fail_msg("L / R = %g: %.2f", L / R, worst);
    most = fmax(most, worst);
  }
  print_message("metaballs along segments: %.2f of the allowed error\n", most);
}

/* The same body and points a million lengths away and ten million times larger give the same floats, scaled. */
static void test_frame(void **state) {
  (void)state;
  uint64_t seed = 32;
  static float F0[POINTS], g0[3][POINTS];
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = 0; s < SKF_TRIANGLE; s++) {
      double unit = 0x1p23;
      skf_vec3 origin = v3(0x1p43, -0x1p42, 0x1p40); /* exact sums: vertices are rounded to multiples of 2^-20 */
      skf_element e = {.kernel = {(skf_kernel_type)k, 1.5, NULL}, .strength = 1}, far;
      rnd_primitive(&seed, (skf_shape)s, 1, &e.primitive);
      skf_vec3 *at[2] = {&e.primitive.segment.from, &e.primitive.segment.to};
      int vertices = s == SKF_SEGMENT ? 2 : 1; /* a point's and an arc's come first */
      for (int i = 0; i < vertices; i++)
        *at[i] =
            v3(rint(at[i]->x * 0x1p20) * 0x1p-20, rint(at[i]->y * 0x1p20) * 0x1p-20, rint(at[i]->z * 0x1p20) * 0x1p-20);
      far = e;
      skf_vec3 *to[2] = {&far.primitive.segment.from, &far.primitive.segment.to};
      for (int i = 0; i < vertices; i++) *to[i] = v3_mad(origin, unit, *at[i]);
      if (s == SKF_ARC) far.primitive.arc.radius *= unit;
      far.kernel.param *= skf_kernel_get(e.kernel.type)->compact ? unit : 1 / unit;
      int power = (s == SKF_POINT ? 0 : 1) - (k == SKF_INVERSE ? 1 : k == SKF_INVERSE_SQUARED ? 2 : 0);
      scatter(&seed, &e.primitive);
      skf_field *near = make(&e, 1), *there = make(&far, 1);
      eval(near, v3(0, 0, 0), 1);
      memcpy(F0, F, sizeof F), memcpy(g0, g, sizeof g);
      eval(there, origin, unit);
      for (int i = 0; i < POINTS; i++) {
        double scale = pow(unit, power), d = skf_primitive_distance(&e.primitive, local(i));
        if (d < 1e-3 || !(fabs((double)F0[i]) > 1e-20)) continue;
        check_close((double)F[i], scale * (double)F0[i], 4e-6);
        for (int j = 0; j < 3; j++)
          check_scaled((double)g[j][i], scale / unit * (double)g0[j][i], scale / unit * (fabs((double)F0[i]) / d),
                       4e-5);
      }
      skf_field_free(near);
      skf_field_free(there);
    }
}

/* Strengths beyond the range of floats, both signs, many elements; any length of batch and number of threads. */
static void test_sum(void **state) {
  (void)state;
  enum { N = 200 };
  uint64_t seed = 33;
  skf_element e[N];
  static float F0[POINTS], g0[3][POINTS];
  for (int i = 0; i < N; i++) {
    skf_kernel_type kernel[4] = {SKF_CAUCHY, SKF_INVERSE, SKF_QUARTIC, SKF_GAUSSIAN};
    e[i] = (skf_element){.kernel = {kernel[i % 4], 1.2, NULL}, .strength = 1e40 * rnd(&seed, -1, 1)};
    rnd_primitive(&seed, i % 3 ? SKF_SEGMENT : SKF_POINT, 1, &e[i].primitive);
  }
  scatter(&seed, &e[0].primitive);
  skf_field *f = make(e, N);
  eval(f, v3(0, 0, 0), 1);
  for (int i = 0; i < N; i++) e[i].strength *= 1e-40;
  skf_field *small = make(e, N);
  for (int i = 0; i < N; i++) e[i].strength = fabs(e[i].strength);
  skf_field *sizes = make(e, N);
  for (int i = 0; i < POINTS; i++) assert_true(!isfinite((double)F[i]) || fabs((double)F[i]) < 1e39);
  eval(small, v3(0, 0, 0), 1);
  for (int i = 0; i < POINTS; i++) {
    double size = skf_field_at(sizes, local(i), NULL);
    if (i % 3 == 0) check_scaled((double)F[i], skf_field_at(small, local(i), NULL), size, 32 * ulp);
  }
  memcpy(F0, F, sizeof F), memcpy(g0, g, sizeof g);
  int threads = omp_get_max_threads();
  omp_set_num_threads(3);
  eval(small, v3(0, 0, 0), 1);
  omp_set_num_threads(threads);
  assert_memory_equal(F, F0, sizeof F);
  assert_memory_equal(g, g0, sizeof g);
  skf_field_f32 *f32;
  assert_int_equal(skf_field_f32_new(small, v3(0, 0, 0), 1, &f32), SKF_OK);
  for (size_t from = 0, n = 1; from < POINTS; from += n, n = 1 + n * 5 % 41) {
    size_t length = n < POINTS - from ? n : POINTS - from;
    const float *const in[3] = {p[0] + from, p[1] + from, p[2] + from};
    float *const out[3] = {g[0] + from, NULL, g[2] + from};
    memset(F + from, 0, length * sizeof *F);
    assert_int_equal(skf_field_f32_eval(f32, length, in, F + from, out), SKF_OK);
  }
  assert_memory_equal(F, F0, sizeof F);
  assert_memory_equal(g, g0, sizeof g);
  skf_field_f32_free(f32);
  assert_int_equal(skf_field_f32_new(small, v3(0, 0, 0), 0, &f32), SKF_ERR_RANGE);
  assert_int_equal(skf_field_f32_new(small, v3(0, NAN, 0), 1, &f32), SKF_ERR_RANGE);
  assert_null(f32);
  skf_field_free(f);
  skf_field_free(small);
  skf_field_free(sizes);
}

/* Many equal terms, which round alike: tiles are summed apart. */
static void test_ring(void **state) {
  (void)state;
  enum { N = 200 };
  skf_element e[N];
  for (int k = 0; k < SKF_KERNEL_COUNT; k++) {
    const skf_kernel_type kernel = (skf_kernel_type)k;
    double worst = 0;
    for (int i = 0; i < N; i++) {
      const double turn = 2 * SKF_PI * i / N;
      e[i] = (skf_element){.kernel = {kernel, skf_kernel_get(kernel)->compact ? 4 : 0.7, NULL}, .strength = 0.7};
      e[i].primitive.shape = SKF_POINT, e[i].primitive.point.at = v3(cos(turn), sin(turn), 0);
    }
    for (int i = 0; i < POINTS; i++) p[0][i] = p[1][i] = 0, p[2][i] = (float)(0.3 * (i + 1) / POINTS);
    skf_field *f = make(e, N);
    eval(f, v3(0, 0, 0), 1);
    for (int i = 0; i < POINTS; i++) worst = fmax(worst, fabs((double)F[i] / skf_field_at(f, local(i), NULL) - 1));
    print_message("%s, %d points: %.1f units\n", skf_kernel_get(kernel)->name, N, worst / ulp);
    assert_true(worst <= 10 * ulp);
    skf_field_free(f);
  }
}

/* Gaussian points that are weak beside another, wide, or narrow and seen from many widths away */
static void test_gaussians(void **state) {
  (void)state;
  static const double cases[][3] = {
      {1, 1e-33, 0.5}, {1, 1e-35, 0.5}, {1e-17, 1, 1}, {1e10, 1, 1.02e-9}, {1e16, 1, 1.02e-15}};
  for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
    const double a = cases[n][0], units = 40 + 16 * a * a * cases[n][2] * cases[n][2];
    skf_element e[2] = {{.kernel = {SKF_GAUSSIAN, a, NULL}, .strength = cases[n][1]},
                        {.kernel = {SKF_GAUSSIAN, 1, NULL}, .strength = 1}};
    e[0].primitive.shape = e[1].primitive.shape = SKF_POINT;
    e[1].primitive.point.at = v3(50, 0, 0);
    for (int i = 0; i < POINTS; i++) p[0][i] = (float)cases[n][2], p[1][i] = p[2][i] = 0;
    skf_field *f = make(e, cases[n][1] < 1 ? 2 : 1);
    skf_vec3 G;
    eval(f, v3(0, 0, 0), 1);
    const double want = skf_field_at(f, local(0), &G);
    if (fabs(want) > 1e-36) check_close((double)F[0], want, units * ulp);
    check_close((double)g[0][0], G.x, units * ulp);
    skf_field_free(f);
  }
}

/* Where floats overflow the gradient does so too, wherever the point is in its batch and whatever is asked for. */
static void test_overflow(void **state) {
  (void)state;
  enum { N = 37 };
  skf_element e = {{.shape = SKF_POINT, .point = {{0, 0, 0}}}, {SKF_INVERSE, 0, NULL}, 1e19};
  skf_field *f = make(&e, 1);
  for (int i = 0; i < POINTS; i++) p[0][i] = 1e-30f, p[1][i] = p[2][i] = 0;
  eval(f, v3(0, 0, 0), 1);
  skf_field_f32 *f32;
  assert_int_equal(skf_field_f32_new(f, v3(0, 0, 0), 1, &f32), SKF_OK);
  const float *const in[3] = {p[0], p[1], p[2]};
  float x[N], *const out[3] = {x, NULL, NULL};
  assert_int_equal(skf_field_f32_eval(f32, N, in, NULL, out), SKF_OK);
  for (int i = 0; i < POINTS; i++) assert_true(F[i] == INFINITY && g[0][i] == -INFINITY && g[1][i] == 0);
  for (int i = 0; i < N; i++) assert_true(x[i] == -INFINITY);
  skf_field_f32_free(f32), skf_field_free(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_pairs),     cmocka_unit_test(test_wide),   cmocka_unit_test(test_far_arcs),
      cmocka_unit_test(test_far),       cmocka_unit_test(test_axis),   cmocka_unit_test(test_bent),
      cmocka_unit_test(test_triangles), cmocka_unit_test(test_chords), cmocka_unit_test(test_frame),
      cmocka_unit_test(test_sum),       cmocka_unit_test(test_ring),   cmocka_unit_test(test_gaussians),
      cmocka_unit_test(test_overflow)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
