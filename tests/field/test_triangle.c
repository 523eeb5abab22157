/* SPDX-License-Identifier: MIT */
/* Triangles: reference values, derivatives, symmetries, limits, singular sets. Every test loops over the kernels. */
#include "triangle_check.h"
#include "field/quadrature.h"
#include "num/gauss.h"

#define EACH_KERNEL(k) for (skf_kernel_type k = 0; k < SKF_KERNEL_COUNT; k++)

static double uniform(uint64_t *seed, double lo, double hi) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return lo + (hi - lo) * (double)(*seed >> 11) * 0x1p-53;
}

static skf_vec3 somewhere(uint64_t *seed, double size) {
  return v3(uniform(seed, -size, size), uniform(seed, -size, size), uniform(seed, -size, size));
}

/* A kernel whose width is about that of a triangle of size 1, or 5 times less, or 5 times more. */
static skf_kernel some_kernel(uint64_t *seed, skf_kernel_type type) {
  double width = pow(5, uniform(seed, -1, 1));
  return (skf_kernel){type, skf_kernel_get(type)->compact ? 1.5 * width : 1 / width};
}

static tri_case some_case(uint64_t *seed, skf_kernel_type type) {
  tri_case c = {.kernel = some_kernel(seed, type)};
  for (int i = 0; i < 3; i++) c.triangle.vertices[i] = somewhere(seed, 1);
  c.x = somewhere(seed, uniform(seed, 0, 1) < 0.5 ? 0.8 : 2.5);
  return c;
}

static void reference_values(void **state) {
  (void)state;
  static const struct {
    tri_case c;
    double F;
    skf_vec3 g;
    double h[6];
  } rows[] = {
#include "triangle_reference.inc"
  };
  double worst[SKF_KERNEL_COUNT][3] = {{0}};
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    skf_value v = tri_eval(&rows[i].c, 2);
    double S = tri_size(&rows[i].c), g = fmax(v3_norm(rows[i].g), 1e-3 * fabs(rows[i].F) / S);
    double h = fmax(tri_norm_h(rows[i].h), 1e-3 * fabs(rows[i].F) / (S * S));
    double error[3] = {fabs(v.F - rows[i].F) / rows[i].F, tri_diff_g(v.g, rows[i].g, g), tri_diff_h(v.h, rows[i].h, h)};
    static const double allowed[3] = {1e-12, 1e-11, 1e-11};
    for (int k = 0; k < 3; k++) {
      double *w = &worst[rows[i].c.kernel.type][k];
      *w = fmax(*w, error[k]);
      if (!(error[k] <= allowed[k]))
        fail_msg("row %zu, %s: derivative %d is off by %.3g", i, skf_kernel_get(rows[i].c.kernel.type)->name, k,
                 error[k]);
    }
  }
  EACH_KERNEL(k)
  print_message("%-16s F to %.1e, grad to %.1e, Hessian to %.1e\n", skf_kernel_get(k)->name, worst[k][0], worst[k][1],
                worst[k][2]);
}

static void derivatives_match_differences(void **state) {
  (void)state;
  uint64_t seed = 7;
  EACH_KERNEL(k) {
    for (int i = 0; i < 300; i++) {
      tri_case c = some_case(&seed, k);
      skf_value v = tri_eval(&c, 2), first = tri_eval(&c, 1);
      assert_true(first.F == v.F && first.g.x == v.g.x && first.g.y == v.g.y && first.g.z == v.g.z);
      double step = 1e-6, row[3][3], h[6], gs[3];
      for (int a = 0; a < 3; a++) {
        tri_case up = c, down = c;
        *v3_at(&up.x, a) += step;
        *v3_at(&down.x, a) -= step;
        skf_value u = tri_eval(&up, 1), d = tri_eval(&down, 1);
        gs[a] = (u.F - d.F) / (2 * step);
        for (int b = 0; b < 3; b++) row[a][b] = (v3_get(u.g, b) - v3_get(d.g, b)) / (2 * step);
      }
      for (int a = 0, n = 0; a < 3; a++)
        for (int b = a; b < 3; b++) h[n++] = 0.5 * (row[a][b] + row[b][a]);
      /* third derivatives go like 1 / distance, or jump at a rim */
      double near =
          fmax(tri_size(&c) > 0
                   ? skf_primitive_distance(&(skf_primitive){.shape = SKF_TRIANGLE, .triangle = c.triangle}, c.x)
                   : 0,
               1e-3);
      double tol = skf_kernel_get(k)->compact ? 1e-4 : 1e-7 / (near * near) + 1e-7;
      if (v.F == 0 && v3_norm(v.g) == 0) continue;
      double g_error = tri_diff_g(v.g, v3(gs[0], gs[1], gs[2]), v3_norm(v.g) + fabs(v.F));
      double h_error = tri_diff_h(v.h, h, tri_norm_h(v.h) + v3_norm(v.g) + fabs(v.F));
      if (!(g_error <= tol)) fail_msg("%s, case %d: gradient off by %.3g", skf_kernel_get(k)->name, i, g_error);
      if (!(h_error <= tol)) fail_msg("%s, case %d: Hessian off by %.3g", skf_kernel_get(k)->name, i, h_error);
    }
  }
}

static void potential_is_harmonic(void **state) {
  (void)state;
  uint64_t seed = 11;
  for (int i = 0; i < 500; i++) {
    tri_case c = some_case(&seed, SKF_INVERSE);
    skf_value v = tri_eval(&c, 2);
    check_scaled(v.h[0] + v.h[3] + v.h[5], 0, tri_norm_h(v.h), 1e-12);
  }
}

static void check_same(skf_value got, skf_value want, double S, double tol, const char *what, int i) {
  double g = fmax(v3_norm(want.g), fabs(want.F) / S), h = fmax(tri_norm_h(want.h), fabs(want.F) / (S * S));
  if (want.F == 0) {
    assert_true(got.F == 0 && v3_norm(got.g) == 0 && tri_norm_h(got.h) == 0);
    return;
  }
  if (!(fabs(got.F - want.F) <= tol * fabs(want.F)) || !(tri_diff_g(got.g, want.g, g) <= 10 * tol) ||
      !(tri_diff_h(got.h, want.h, h) <= 100 * tol))
    fail_msg("%s, case %d: off by %.3g, %.3g, %.3g", what, i, fabs(got.F / want.F - 1), tri_diff_g(got.g, want.g, g),
             tri_diff_h(got.h, want.h, h));
}

static void parts_add_up(void **state) {
  (void)state;
  uint64_t seed = 13;
  EACH_KERNEL(k) {
    for (int i = 0; i < 200; i++) {
      tri_case c = some_case(&seed, k), part = c;
      skf_vec3 *v = c.triangle.vertices, mid = v3_scale(0.25, v3_add(v3_add(v[0], v[1]), v3_scale(2, v[2])));
      /* an exact point of the triangle: corners rounded so that the middle is a double */
      for (int j = 0; j < 3; j++)
        v[j] = v3(rint(v[j].x * 256) / 256, rint(v[j].y * 256) / 256, rint(v[j].z * 256) / 256);
      mid = v3_scale(0.25, v3_add(v3_add(v[0], v[1]), v3_scale(2, v[2])));
      skf_value sum = {0}, whole = tri_eval(&c, 2);
      for (int j = 0; j < 3; j++) {
        part.triangle = (skf_triangle){{v[j], v[(j + 1) % 3], mid}};
        skf_value p = tri_eval(&part, 2);
        sum.F += p.F;
        sum.g = v3_add(sum.g, p.g);
        for (int a = 0; a < 6; a++) sum.h[a] += p.h[a];
      }
      check_same(sum, whole, tri_size(&c), 1e-12, skf_kernel_get(k)->name, i);
    }
  }
}

static void order_of_vertices_is_free(void **state) {
  (void)state;
  static const int orders[5][3] = {{1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  uint64_t seed = 17;
  EACH_KERNEL(k) {
    for (int i = 0; i < 100; i++) {
      tri_case c = some_case(&seed, k), other = c;
      skf_value want = tri_eval(&c, 2);
      for (int j = 0; j < 5; j++) {
        for (int a = 0; a < 3; a++) other.triangle.vertices[a] = c.triangle.vertices[orders[j][a]];
        check_same(tri_eval(&other, 2), want, tri_size(&c), 1e-12, skf_kernel_get(k)->name, i);
      }
    }
  }
}

static skf_vec3 turn(skf_vec3 a) { /* a rotation with exact entries */
  return v3((2 * a.x - a.y + 2 * a.z) / 3, (2 * a.x + 2 * a.y - a.z) / 3, (-a.x + 2 * a.y + 2 * a.z) / 3);
}

/* Rotated and scaled by 1e+-7: F goes like size^2 times h, whatever the units. */
static void units_and_axes_are_free(void **state) {
  (void)state;
  uint64_t seed = 19;
  EACH_KERNEL(k) {
    for (int i = 0; i < 100; i++) {
      tri_case c = some_case(&seed, k), other = c;
      double size = i % 2 ? 1e7 : 1e-7, power = k == SKF_INVERSE ? 1 : k == SKF_INVERSE_SQUARED ? 0 : 2;
      other.kernel.param *= skf_kernel_get(k)->compact ? size : 1 / size;
      for (int a = 0; a < 3; a++) other.triangle.vertices[a] = v3_scale(size, turn(c.triangle.vertices[a]));
      other.x = v3_scale(size, turn(c.x));
      skf_value a = tri_eval(&c, 2), b = tri_eval(&other, 2);
      double F = a.F * pow(size, power), S = tri_size(&c), rim = skf_kernel_get(k)->compact ? 1e-7 : 1e-11;
      if (fabs(a.F) < 1e-9 && skf_kernel_get(k)->compact) continue; /* grazing: conditioned by R / (R - dist) */
      check_close(b.F, F, rim);
      double g = fmax(v3_norm(a.g), fabs(a.F) / S), h = fmax(tri_norm_h(a.h), fabs(a.F) / (S * S));
      check_scaled(v3_norm(b.g) / pow(size, power - 1), v3_norm(a.g), g, 10 * rim);
      assert_true(tri_diff_g(v3_scale(pow(size, 1 - power), b.g), turn(a.g), g) <= 10 * rim);
      check_scaled(tri_norm_h(b.h) * pow(size, 2 - power), tri_norm_h(a.h), h, 100 * rim);
    }
  }
}

/* n x n Gauss over the triangle, by the public kernel alone. */
static skf_value brute(const tri_case *c, int n) {
  const skf_gauss_node *g = skf_gauss_rule(n);
  const skf_vec3 *v = c->triangle.vertices;
  double twice = v3_norm(v3_cross(v3_sub(v[1], v[0]), v3_sub(v[2], v[0]))), d[4];
  skf_value s = {0};
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) {
      double a = 0.5 * (1 + g[i].x), b = 0.5 * (1 + g[j].x), w = 0.25 * g[i].w * g[j].w * a * twice;
      skf_vec3 q = v3_mad(v3_mad(v[0], a * (1 - b), v3_sub(v[1], v[0])), a * b, v3_sub(v[2], v[0]));
      skf_vec3 X = v3_sub(c->x, q);
      skf_kernel_eval(c->kernel, v3_norm2(X), d);
      s.F += w * d[0];
      s.g = v3_mad(s.g, 2 * w * d[1], X);
      const double x[6] = {X.x * X.x, X.x * X.y, X.x * X.z, X.y * X.y, X.y * X.z, X.z * X.z};
      for (int k = 0; k < 6; k++) s.h[k] += w * (4 * d[2] * x[k] + (k == 0 || k == 3 || k == 5 ? 2 * d[1] : 0));
    }
  return s;
}

static void slivers_match_brute_force(void **state) {
  (void)state;
  uint64_t seed = 23;
  static const skf_kernel_type smooth[] = {SKF_CAUCHY, SKF_GAUSSIAN, SKF_INVERSE, SKF_INVERSE_SQUARED};
  for (int k = 0; k < 4; k++)
    for (int i = 0; i < 150; i++) {
      double thin = pow(10, -2 - i % 5);
      tri_case c = {.kernel = {smooth[k], uniform(&seed, 0.4, 2)}};
      skf_vec3 *v = c.triangle.vertices;
      v[0] = somewhere(&seed, 0.2);
      v[1] = v3_add(v[0], v3(1, uniform(&seed, -0.2, 0.2), 0));
      v[2] = v3_mad(v3_mad(v[0], uniform(&seed, -0.1, 1.1), v3_sub(v[1], v[0])), thin, v3(0, 1, 0.5));
      c.x = v3_add(v3_mad(v[0], 0.5, v3_sub(v[1], v[0])),
                   v3_scale(uniform(&seed, 0.6, 1.4), v3_unit(somewhere(&seed, 1))));
      if (skf_primitive_distance(&(skf_primitive){.shape = SKF_TRIANGLE, .triangle = c.triangle}, c.x) < 0.4) continue;
      /* the test's own area is good to the aspect times the rounding */
      check_same(brute(&c, 32), tri_eval(&c, 2), tri_size(&c), fmax(1e-11, 1e-15 / thin),
                 skf_kernel_get(smooth[k])->name, i);
    }
}

/* Thin triangles cut in two across, the point anywhere from on them to a few lengths away. */
static void slivers_add_up(void **state) {
  (void)state;
  uint64_t seed = 29;
  EACH_KERNEL(k)
  for (int i = 0; i < 200; i++) {
    double thin = pow(2, -7 - 3 * (i % 5)), off = pow(10, uniform(&seed, -7, 0.3));
    tri_case c = {.kernel = some_kernel(&seed, k)};
    skf_vec3 *v = c.triangle.vertices;
    /* multiples of 2^-20, so that the middle of the side is a double */
    v[0] = v3(0.25, -0.125, 0.5);
    v[1] = v3_add(v[0], v3(1, 0.25, -0.125));
    v[2] = v3_add(v3_add(v[0], v3(0.375, 0.09375, -0.046875)), v3(-0.25 * thin, thin, 0.5 * thin));
    c.x = v3_mad(skf_primitive_point(&(skf_primitive){.shape = SKF_TRIANGLE, .triangle = c.triangle},
                                     uniform(&seed, 0, 1), uniform(&seed, 0, 1)),
                 off, v3_unit(somewhere(&seed, 1)));
    skf_vec3 mid = v3_scale(0.5, v3_add(v[0], v[1]));
    tri_case left = c, right = c;
    left.triangle.vertices[1] = mid;
    right.triangle.vertices[0] = mid;
    skf_value a = tri_eval(&left, 2), b = tri_eval(&right, 2);
    a.F += b.F;
    a.g = v3_add(a.g, b.g);
    for (int j = 0; j < 6; j++) a.h[j] += b.h[j];
    check_same(a, tri_eval(&c, 2), tri_size(&c), 1e-11, skf_kernel_get(k)->name, i);
  }
}

/* Adaptive quadrature of h and its derivatives over the area shares nothing with the edge sums. */
static void quadrature_agrees(void **state) {
  (void)state;
  uint64_t seed = 31;
  EACH_KERNEL(k)
  for (int i = 0; i < 40; i++) {
    tri_case c = some_case(&seed, k);
    skf_element e = {.kernel = c.kernel, .strength = 1};
    e.primitive = (skf_primitive){.shape = SKF_TRIANGLE, .triangle = c.triangle};
    skf_prepared p;
    skf_prepare(&e, &p);
    skf_value want = {0};
    skf_quadrature(&p, c.x, 2, &want);
    check_same(tri_eval(&c, 2), want, tri_size(&c), 1e-11, skf_kernel_get(k)->name, i);
  }
}

static void rims(void **state) {
  (void)state;
  static const skf_kernel_type compact[] = {SKF_METABALL, SKF_SOFT_OBJECT, SKF_QUARTIC};
  const skf_triangle T = {{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}}};
  for (int k = 0; k < 3; k++) {
    tri_case c = {{compact[k], 1}, T, {2, 2, 0.5}};
    double all = tri_eval(&c, 1).F;
    assert_true(all > 0);
    c.x = v3(2.5, 1.75, 0.5); /* the disc is inside: the field of a plane */
    check_close(tri_eval(&c, 1).F, all, 1e-14);
    check_scaled(v3_norm(v3(tri_eval(&c, 1).g.x, tri_eval(&c, 1).g.y, 0)), 0, all, 1e-14);
    c.x = v3(3, 0, 0.5); /* one chord through the middle */
    check_close(tri_eval(&c, 1).F, all / 2, 1e-13);
    c.x = v3(0, 0, 0.5); /* a corner of 90 degrees */
    check_close(tri_eval(&c, 1).F, all / 4, 1e-13);
    c.x = v3(8, 0, 0.5); /* and of 45 */
    check_close(tri_eval(&c, 1).F, all / 8, 1e-13);
    skf_value a, b;
    c.x = v3(3, 0.3, 0.5), a = tri_eval(&c, 2); /* the two sides of an edge make the plane */
    c.x = v3(3, -0.3, 0.5), b = tri_eval(&c, 2);
    check_close(a.F + b.F, all, 1e-13);
    check_scaled(a.g.y, b.g.y, fabs(a.g.y), 1e-12);
    check_scaled(a.h[3], -b.h[3], fabs(a.h[3]), 1e-11);
    /* out of reach by height, beside an edge, beyond a corner: exactly 0 */
    static const skf_vec3 out[] = {{2, 2, 1}, {2, 2, -1.5}, {3, -1, 0}, {3, -0.8, 0.6}, {-1, 0, 0}, {-0.6, -0.8, 0}};
    for (int i = 0; i < 6; i++) {
      c.x = out[i];
      skf_value v = tri_eval(&c, 2);
      assert_true(v.F == 0 && v3_norm(v.g) == 0 && tri_norm_h(v.h) == 0);
    }
    for (double off = -1e-4; off < 2e-4 && compact[k] == SKF_METABALL; off += 3e-5) { /* where it turns from its core */
      double r = (1 + off) / 3, core = 9 * r * r - 1, shell = 1.5 * (1 - r) * (3 * r - 1);
      c.x = v3(2, 2, r);
      check_scaled(tri_eval(&c, 2).h[5], 2 * SKF_PI * (off < 0 ? core : shell), 1, 1e-13);
    }
    c.x = v3(3, -0.999, 0); /* grazing: F ~ (1 - dist/R)^(n + 3/2), small, positive, monotone */
    double graze = tri_eval(&c, 1).F;
    c.x.y = -0.998;
    assert_true(graze > 0 && tri_eval(&c, 1).F > 5 * graze);
  }
}

static void singular_sets(void **state) {
  (void)state;
  tri_case c = {{SKF_INVERSE_SQUARED, 0}, {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}}, {1, 1, 0}};
  static const skf_vec3 on[] = {{1, 1, 0}, {2, 0, 0}, {0, 0, 0}, {4, 0, 0}, {2, 2, 0}};
  for (int i = 0; i < 5; i++) {
    c.x = on[i];
    skf_value v = tri_eval(&c, 2);
    assert_true(isinf(v.F) && v.F > 0 && v3_norm(v.g) == 0 && tri_norm_h(v.h) == 0);
  }
  c.x = v3(-1, 1, 0); /* in its plane, outside: regular */
  skf_value beside = tri_eval(&c, 2);
  assert_true(isfinite(beside.F) && beside.g.z == 0 && isfinite(tri_norm_h(beside.h)));

  /* the normal part of the attraction jumps by 4 pi: its mean is 0 on the surface */
  c.kernel.type = SKF_INVERSE;
  c.x = v3(1, 1, 0);
  skf_value at = tri_eval(&c, 2);
  assert_true(at.g.z == 0 && isfinite(tri_norm_h(at.h)));
  c.x.z = 1e-12;
  check_close(tri_eval(&c, 1).g.z, -2 * SKF_PI, 1e-11);
  check_close(tri_eval(&c, 1).F, at.F, 1e-11);
  c.x.z = -1e-12;
  check_close(tri_eval(&c, 1).g.z, 2 * SKF_PI, 1e-11);
  for (int i = 1; i < 5; i++) { /* on edges and corners F is finite and continuous */
    c.x = on[i];
    at = tri_eval(&c, 2);
    c.x.z = 1e-13;
    check_close(at.F, tri_eval(&c, 1).F, 1e-11);
    assert_true(isfinite(v3_norm(at.g)) && isfinite(tri_norm_h(at.h)));
  }
  /* the right-angled corner: int over theta of the ray's length, exactly 4 ln(1 + sqrt 2) sqrt 2 */
  c.x = v3(0, 0, 0);
  check_close(tri_eval(&c, 1).F, 4 * sqrt(2) * log(1 + sqrt(2)), 1e-15);
}

static void smooth_on_the_triangle(void **state) {
  (void)state;
  static const skf_kernel_type regular[] = {SKF_CAUCHY, SKF_GAUSSIAN, SKF_METABALL, SKF_SOFT_OBJECT, SKF_QUARTIC};
  static const skf_vec3 on[] = {{1, 1, 0}, {2, 0, 0}, {0, 0, 0}, {4, 0, 0}, {2, 2, 0}, {-1, 1, 0}};
  for (int k = 0; k < 5; k++)
    for (int i = 0; i < 6; i++) {
      tri_case c = {{regular[k], 1.25}, {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}}, on[i]}, near = c;
      near.x = v3_add(near.x, v3(1e-9, -1e-9, 1e-9));
      skf_value a = tri_eval(&c, 2), b = tri_eval(&near, 2);
      if (a.F == 0) continue;
      check_close(a.F, b.F, 1e-7);
      assert_true(tri_diff_g(a.g, b.g, fabs(a.F) + v3_norm(a.g)) < 1e-7);
      assert_true(tri_diff_h(a.h, b.h, tri_norm_h(a.h)) < 1e-6);
      near.x = v3_add(c.x, v3(0, 0, 1e-170)); /* whose square underflows */
      b = tri_eval(&near, 2);
      check_close(a.F, b.F, 1e-12);
      assert_true(tri_diff_g(a.g, b.g, fabs(a.F) + v3_norm(a.g)) < 1e-12);
      assert_true(tri_diff_h(a.h, b.h, tri_norm_h(a.h)) < 1e-10);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(reference_values),
      cmocka_unit_test(derivatives_match_differences),
      cmocka_unit_test(potential_is_harmonic),
      cmocka_unit_test(parts_add_up),
      cmocka_unit_test(order_of_vertices_is_free),
      cmocka_unit_test(units_and_axes_are_free),
      cmocka_unit_test(slivers_match_brute_force),
      cmocka_unit_test(rims),
      cmocka_unit_test(quadrature_agrees),
      cmocka_unit_test(slivers_add_up),
      cmocka_unit_test(singular_sets),
      cmocka_unit_test(smooth_on_the_triangle),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
