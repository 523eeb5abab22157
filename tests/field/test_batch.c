/* SPDX-License-Identifier: MIT */
/* Batches: every instruction set against the closed forms, in any place of any batch, on any number of threads. */
#include "check.h"
#include "chords.h"
#include "core/vec3.h"
#include "field/batch.h"
#include "field/some.h"
#include "num/gauss.h"
#include "random.h"
#include "skelfield/field.h"
#include <omp.h>
#include <string.h>

static const char *const isas[] = {"scalar", "avx2"};
enum { ISAS = 2, POINTS = 512 };

typedef struct cloud {
  double p[3][POINTS], F[POINTS], g[3][POINTS];
} cloud;

static skf_field *make(const char *isa, const skf_element *e, size_t n) {
  skf_field *f;
  setenv("SKELFIELD_ISA", isa, 1);
  assert_int_equal(skf_field_new(e, n, &f), SKF_OK);
  unsetenv("SKELFIELD_ISA");
  return f;
}

static void eval(const skf_field *f, size_t from, size_t n, cloud *c) {
  const double *const in[3] = {c->p[0] + from, c->p[1] + from, c->p[2] + from};
  double *const g[3] = {c->g[0] + from, c->g[1] + from, c->g[2] + from};
  assert_int_equal(skf_field_eval(f, n, in, c->F + from, g, NULL), SKF_OK);
}

static skf_vec3 place(const cloud *c, size_t i) { return v3(c->p[0][i], c->p[1][i], c->p[2][i]); }
static skf_vec3 slope(const cloud *c, size_t i) { return v3(c->g[0][i], c->g[1][i], c->g[2][i]); }

/* A third anywhere, a third at any distance from the body between 1e-9 and 1e4 of the scale, the rest on its axis
   or plane, on itself, at an end. */
static void scatter(uint64_t *seed, const skf_primitive *p, double scale, cloud *c) {
  for (size_t i = 0; i < POINTS; i++) {
    skf_vec3 on = skf_primitive_point(p, rnd(seed, 0, 1), rnd(seed, 0, 1)), x = rnd_vec(seed, 2 * scale);
    if (i % 3 == 1) x = v3_mad(on, scale * pow(10, rnd(seed, -9, 4)), rnd_unit(seed));
    if (i % 6 == 2)
      x = v3_mad(on, rnd(seed, -2, 2), v3_sub(skf_primitive_point(p, 1, 0), skf_primitive_point(p, 0, 0)));
    if (i % 24 == 5) x = on;
    if (i % 24 == 11) x = skf_primitive_point(p, i % 48 == 11, 0);
    for (int k = 0; k < 3; k++) c->p[k][i] = v3_get(x, k);
  }
}

static double extent(const skf_primitive *p) {
  return p->shape == SKF_PLANE ? 0 : box_diagonal(skf_primitive_bounds(p));
}

/* The differences of F and the gradient over |F| and max(|g|, |F| / distance), each per unit of the field's own
   conditioning there: how many times its relative change exceeds that of the point. */
static double difference(const skf_primitive *p, const cloud *a, const cloud *b, size_t i) {
  double d = fmax(extent(p), skf_primitive_distance(p, place(a, i))), F = fabs(a->F[i]);
  skf_vec3 off = v3_sub(slope(b, i), slope(a, i));
  if (a->F[i] == b->F[i] && off.x == 0 && off.y == 0 && off.z == 0) return 0;
  if (!(F > 1e-290)) return !(fabs(b->F[i]) < 2e-290);
  double G = fmax(d * v3_norm(v3_scale(1 / F, slope(a, i))), 1), g = d * v3_norm(v3_scale(1 / F, off)) / G;
  return fmax(fabs(b->F[i] - a->F[i]) / F, g) / (1 + G);
}

/* What field.h grants a plane whose normal is along no axis, by what it grants others: x is farther from the origin
   than from the plane. */
static double allowance(const skf_primitive *p, skf_vec3 x) {
  const skf_vec3 n = p->plane.normal;
  if (p->shape != SKF_PLANE || (n.x != 0) + (n.y != 0) + (n.z != 0) == 1) return 1;
  return 1 + 0.2 * fmin(v3_norm(x) / skf_primitive_distance(p, x), 2000);
}

/* Whether some elements of this pair have a vector form */
static bool has_form(skf_kernel_type type, skf_shape at) {
  const skf_batch_ops *ops = skf_batch_get(SKF_ISA_AVX2);
#define X(name, kernel, shape, fits)                                                                                   \
  if (type == (kernel) && at == (shape) && ops->form[SKF_FORM_##name].add) return true;
  SKF_BATCH_FORMS(X)
#undef X
  return false;
}

/* The bounds that field.h states */
static double bound(int shape) {
  return (shape == SKF_TRIANGLE ? 1000 : shape == SKF_ARC ? 200 : shape == SKF_SEGMENT ? 60 : 20) * 1.1e-16;
}

/* An element at the points of a, without and with vector instructions */
static void eval_both(const skf_element *e, cloud *a, cloud *b) {
  memcpy(b, a, sizeof *a);
  skf_field *fa = make(isas[0], e, 1), *fb = make(isas[1], e, 1);
  eval(fa, 0, POINTS, a);
  eval(fb, 0, POINTS, b);
  skf_field_free(fa);
  skf_field_free(fb);
}

static void test_isas(void **state) {
  (void)state;
  uint64_t seed = 11;
  static cloud a, b;
  int vector = 0;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = 0; s < SKF_SOLID; s++) {
      double worst = 0;
      skf_vec3 where = {0, 0, 0};
      skf_element body;
      if (!has_form((skf_kernel_type)k, (skf_shape)s)) continue;
      vector++;
      for (int n = 0; n < 60; n++) {
        double scale = n % 3 == 0 ? 1 : n % 3 == 1 ? 1e7 : 1e-7;
        skf_element e = {.kernel = {(skf_kernel_type)k, pow(10, rnd(&seed, -3, 3))}, .strength = n % 2 ? 0.7 : 1};
        e.kernel.param *= skf_kernel_get(e.kernel.type)->compact ? scale : 1 / scale;
        rnd_primitive(&seed, (skf_shape)s, scale, &e.primitive);
        scatter(&seed, &e.primitive, scale, &a);
        eval_both(&e, &a, &b);
        for (size_t i = 0; i < POINTS; i++) {
          double d = difference(&e.primitive, &a, &b, i) / allowance(&e.primitive, place(&a, i));
          if (d <= worst) continue;
          worst = d, where = place(&a, i), body = e;
        }
      }
      print_message("%-16s %-9s %.0f ulps\n", skf_kernel_get((skf_kernel_type)k)->name,
                    skf_shape_get((skf_shape)s)->name, worst / 1.1e-16);
      if (!(worst <= bound(s)))
        fail_msg("at (%.17g, %.17g, %.17g), %g from the body", where.x, where.y, where.z,
                 skf_primitive_distance(&body.primitive, where));
    }
  if (!vector) print_message("no vector instructions here: only the closed forms\n");
}

/* Gaussian segments have forms by their lengths in widths of the kernel. */
static void test_widths(void **state) {
  (void)state;
  static const double width[] = {0.99, 1.01, 2, 3, 3.99, 4.01, 20, 300};
  uint64_t seed = 17;
  static cloud a, b;
  double worst = 0;
  if (!has_form(SKF_GAUSSIAN, SKF_SEGMENT)) return;
  for (int n = 0; n < 80; n++) {
    const double scale = pow(10, rnd(&seed, -7, 7));
    skf_element e = {.kernel = {SKF_GAUSSIAN, 1}, .strength = rnd(&seed, -1, 1)};
    rnd_primitive(&seed, SKF_SEGMENT, scale, &e.primitive);
    e.kernel.param = width[n % 8] / v3_norm(v3_sub(e.primitive.segment.to, e.primitive.segment.from));
    scatter(&seed, &e.primitive, scale, &a);
    eval_both(&e, &a, &b);
    for (size_t i = 0; i < POINTS; i++) {
      const double d = difference(&e.primitive, &a, &b, i);
      worst = fmax(worst, d);
      if (!(d <= bound(SKF_SEGMENT))) fail_msg("%g ulps, %g widths", d / 1.1e-16, width[n % 8]);
    }
  }
  print_message("Gaussian segments: %.0f ulps\n", worst / 1.1e-16);
}

/* Metaballs along segments, from much shorter than their support to much longer, seen from all that their forms tell
   apart. */
static void test_chords(void **state) {
  (void)state;
  uint64_t seed = 17;
  static cloud a, b;
  double worst = 0;
  for (int n = 0; n < 400; n++) {
    const double R = pow(10, rnd(&seed, -7, 7));
    skf_element e = {.primitive.shape = SKF_SEGMENT, .kernel = {SKF_METABALL, R}, .strength = n % 2 ? -0.7 : 1};
    skf_segment *s = &e.primitive.segment;
    const double L = R * (n % 4 == 0 ? pow(10, rnd(&seed, -6, 4)) : n % 4 == 1 ? rnd(&seed, 0.2, 3) : rnd(&seed, 0, 1));
    s->from = rnd_vec(&seed, n % 3 * L), s->to = v3_mad(s->from, L, n % 5 ? rnd_unit(&seed) : v3(0, 1, 0));
    for (size_t i = 0; i < POINTS; i++) {
      const skf_vec3 x = rnd_chord(&seed, s, R);
      for (int k = 0; k < 3; k++) a.p[k][i] = v3_get(x, k);
    }
    eval_both(&e, &a, &b);
    for (size_t i = 0; i < POINTS; i++) {
      const double d = difference(&e.primitive, &a, &b, i);
      if (!(d <= bound(SKF_SEGMENT))) {
        const skf_vec3 x = place(&a, i);
        fail_msg("%g units, L / R = %g, at (%.17g, %.17g, %.17g)", d / 1.1e-16, L / R, x.x, x.y, x.z);
      }
      worst = fmax(worst, d);
    }
  }
  print_message("metaballs along segments: %.0f ulps\n", worst / 1.1e-16);
}

/* Tilted planes next to and far from the origin, their points far along them, seen from next to them to far away. */
static void test_tilted(void **state) {
  (void)state;
  uint64_t seed = 23;
  static cloud a, b;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++) {
    double worst = 0;
    if (!has_form((skf_kernel_type)k, SKF_PLANE)) return;
    for (int n = 0; n < 300; n++) {
      const double scale = pow(10, rnd(&seed, -7, 7)), far = n % 3 ? scale * pow(10, rnd(&seed, -2, 6)) : 0;
      const skf_vec3 normal = rnd_unit(&seed), along = v3_cross(normal, rnd_unit(&seed)), foot = v3_scale(far, normal);
      skf_element e = {.kernel = {(skf_kernel_type)k, pow(10, rnd(&seed, -3, 3))}, .strength = n % 2 ? -0.7 : 1};
      e.kernel.param *= skf_kernel_get(e.kernel.type)->compact ? scale : 1 / scale;
      e.primitive.shape = SKF_PLANE;
      e.primitive.plane.through = v3_mad(foot, n % 5 ? 0 : scale * pow(10, rnd(&seed, 0, 9)), along);
      e.primitive.plane.normal = v3_scale(pow(10, rnd(&seed, -3, 3)), normal);
      for (size_t i = 0; i < POINTS; i++) {
        const double height = scale * rnd(&seed, -2, 2) * (i % 2 ? 1 : pow(10, rnd(&seed, -12, 2)));
        skf_vec3 x = v3_add(v3_mad(foot, height, normal), rnd_vec(&seed, scale));
        if (i % 2 == 0) x = v3_mad(x, height - v3_dot(normal, v3_sub(x, foot)), normal);
        for (int c = 0; c < 3; c++) a.p[c][i] = v3_get(x, c);
      }
      eval_both(&e, &a, &b);
      for (size_t i = 0; i < POINTS; i++) {
        const skf_vec3 x = place(&a, i);
        const double d = difference(&e.primitive, &a, &b, i) / allowance(&e.primitive, x);
        if (!(d <= bound(SKF_PLANE)))
          fail_msg("%s: %g units, %g from the plane, %g from the origin", skf_kernel_get(e.kernel.type)->name,
                   d / 1.1e-16, skf_primitive_distance(&e.primitive, x), v3_norm(x));
        worst = fmax(worst, d);
      }
    }
    print_message("%s, tilted planes: %.0f ulps\n", skf_kernel_get((skf_kernel_type)k)->name, worst / 1.1e-16);
  }
}

/* Largest relative errors of F and the gradient of a Gaussian arc in the plane z = 0 about the origin, that begins at
   (cos H, -sin H), at the points of c */
static void arc_errors(const skf_element *e, const cloud *c, double *F, double *g) {
  enum { PANELS = 4, NODES = 24 };
  const skf_gauss_node *node = skf_gauss_rule(NODES);
  const skf_arc *arc = &e->primitive.arc;
  const long double R = arc->radius, s2 = (long double)e->kernel.param * e->kernel.param;
  const long double step = (long double)arc->sweep / PANELS, H = (long double)arc->sweep / 2;
  for (size_t i = 0; i < POINTS; i++) {
    const long double x = c->p[0][i], y = c->p[1][i], z = c->p[2][i];
    long double sum = 0, u = 0, v = 0;
    for (int k = 0; k < PANELS * NODES; k++) {
      const long double phi = step * (k % PANELS + 0.5L + 0.5L * node[k / PANELS].x) - H;
      const long double dx = x - R * cosl(phi), dy = y - R * sinl(phi);
      const long double h = node[k / PANELS].w * expl(-s2 * (dx * dx + dy * dy + z * z));
      sum += h, u += h * dx, v += h * dy;
    }
    const long double by = R * step / 2, G = -2 * s2 * by, gx = G * u, gy = G * v, gz = G * sum * z;
    const long double ex = c->g[0][i] - gx, ey = c->g[1][i] - gy, ez = c->g[2][i] - gz;
    *F = fmax(*F, (double)fabsl(c->F[i] / (by * sum) - 1));
    *g = fmax(*g, (double)sqrtl((ex * ex + ey * ey + ez * ez) / (gx * gx + gy * gy + gz * gz)));
  }
}

/* No less exact than Gauss's rule with the C library's exponential, which leaves 2.1e-15 and 1.8e-15 */
static void test_gaussian_arcs(void **state) {
  (void)state;
  uint64_t seed = 19;
  static cloud a;
  double F = 0, g = 0;
  if (!has_form(SKF_GAUSSIAN, SKF_ARC)) return;
  skf_element e = {.primitive.shape = SKF_ARC, .kernel = {SKF_GAUSSIAN, 1.5}, .strength = 1};
  e.primitive.arc = (skf_arc){{0, 0, 0}, {0, 0, 1}, {cos(1), -sin(1), 0}, 1, 2};
  skf_field *f = make(isas[1], &e, 1);
  for (int n = 0; n < 8; n++) {
    for (size_t i = 0; i < POINTS; i++)
      for (int k = 0; k < 3; k++) a.p[k][i] = rnd(&seed, -1.5, 1.5);
    eval(f, 0, POINTS, &a);
    arc_errors(&e, &a, &F, &g);
  }
  print_message("Gaussian arc: %.1e %.1e\n", F, g);
  assert_true(F < 1.8e-15 && g < 1.8e-15);
  skf_field_free(f);
}

/* Metaballs over triangles much smaller than their support, whose edges are seen from far beside them */
static void test_small_triangles(void **state) {
  (void)state;
  uint64_t seed = 19;
  static cloud a, b;
  double worst = 0;
  for (int n = 0; n < 300; n++) {
    skf_element e = {.kernel = {SKF_METABALL, pow(10, rnd(&seed, 0, 1.8))}, .strength = 1};
    rnd_primitive(&seed, SKF_TRIANGLE, 1, &e.primitive);
    skf_vec3 *v = e.primitive.triangle.vertices;
    if (n % 2) v[2] = v3_mad(v3_mad(v[0], rnd(&seed, -0.1, 1.1), v3_sub(v[1], v[0])), 0.1, v[2]);
    for (size_t i = 0; i < POINTS; i++) {
      const skf_vec3 x = v3_mad(v[i % 3], e.kernel.param * rnd(&seed, 0, 1.02), rnd_unit(&seed));
      for (int k = 0; k < 3; k++) a.p[k][i] = v3_get(x, k);
    }
    eval_both(&e, &a, &b);
    for (size_t i = 0; i < POINTS; i++) {
      const double d = difference(&e.primitive, &a, &b, i);
      if (!(d <= bound(SKF_TRIANGLE))) fail_msg("%g units, R = %g", d / 1.1e-16, e.kernel.param);
      worst = fmax(worst, d);
    }
  }
  print_message("metaballs over small triangles: %.0f ulps\n", worst / 1.1e-16);
}

/* Circles next to the axis at the rim of their support, where R - rho counts and moving the point changes nothing */
static void test_rim_on_axis(void **state) {
  (void)state;
  static const skf_kernel_type kernels[] = {SKF_SOFT_OBJECT, SKF_QUARTIC};
  uint64_t seed = 19;
  static cloud a, b;
  double worst = 0;
  for (int n = 0; n < 200; n++) {
    skf_element e = {.kernel = {kernels[n % 2], 1}, .strength = 1};
    rnd_primitive(&seed, SKF_ARC, 1, &e.primitive);
    skf_arc *arc = &e.primitive.arc;
    arc->sweep = 2 * SKF_PI;
    e.kernel.param = arc->radius * (1 + pow(10, rnd(&seed, -4, -0.5)));
    for (size_t i = 0; i < POINTS; i++) {
      const skf_vec3 x = v3_mad(arc->center, arc->radius * pow(10, rnd(&seed, -16, -1)), rnd_unit(&seed));
      for (int k = 0; k < 3; k++) a.p[k][i] = v3_get(x, k);
    }
    eval_both(&e, &a, &b);
    for (size_t i = 0; i < POINTS; i++) {
      b.g[0][i] = a.g[0][i], b.g[1][i] = a.g[1][i], b.g[2][i] = a.g[2][i]; /* its change is large there, F's is not */
      const double d = difference(&e.primitive, &a, &b, i);
      if (!(d <= bound(SKF_ARC))) fail_msg("%g units, R / rho = %g", d / 1.1e-16, e.kernel.param / arc->radius);
      worst = fmax(worst, d);
    }
  }
  print_message("circles on the axis at the rim: %.0f ulps\n", worst / 1.1e-16);
}

/* Of a point over a plane across an axis the other coordinates do not matter, whatever they are: in a batch, alone, and
   for the Hessian. */
static void test_other_coordinates(void **state) {
  (void)state;
  static const double other[] = {1e49, 1e51, 1e160, 1e300, 1.7e308, -1.7e308, INFINITY, NAN};
  enum { N = sizeof other / sizeof *other };
  static cloud a;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int n = 0; n < 6 * ISAS; n++) {
      const int axis = n % 3, across = (axis + 1 + n / 3 % 2) % 3;
      double normal[3] = {0, 0, 0}, H[6], h[6];
      normal[axis] = n % 2 ? 3 : -1;
      skf_element e = {.primitive.shape = SKF_PLANE, .kernel = {(skf_kernel_type)k, 1.5}, .strength = -0.7};
      e.primitive.plane = (skf_plane){{0.1, -0.2, 0.3}, {normal[0], normal[1], normal[2]}};
      skf_field *f = make(isas[n / 6], &e, 1);
      for (int i = 0; i <= N; i++) {
        for (int j = 0; j < 3; j++) a.p[j][i] = 0.7;
        if (i < N) a.p[across][i] = other[i];
      }
      eval(f, 0, N + 1, &a);
      skf_vec3 G, g;
      const double F = skf_field_tensor_at(f, place(&a, N), &G, H);
      for (int i = 0; i < N; i++) {
        const double at = skf_field_tensor_at(f, place(&a, (size_t)i), &g, h);
        assert_true(a.F[i] == a.F[N] && at == F && v3_dist(slope(&a, (size_t)i), slope(&a, N)) == 0);
        assert_true(v3_dist(g, G) == 0);
        for (int j = 0; j < 6; j++) assert_true(h[j] == H[j]);
      }
      skf_field_free(f);
    }
}

/* All pairs, some twice. */
static size_t everything(uint64_t *seed, skf_element *e) {
  size_t n = 0;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = 0; s < SKF_SOLID; s++, n++) {
      e[n] = (skf_element){.kernel = {(skf_kernel_type)k, 1.5}, .strength = rnd(seed, -1, 1)};
      rnd_primitive(seed, (skf_shape)s, 1, &e[n].primitive);
    }
  return n;
}

/* The same bits for a point alone, in batches of any length that begin anywhere, and on any number of threads. */
static void test_place(void **state) {
  (void)state;
  uint64_t seed = 12;
  static cloud a, b;
  skf_element e[SKF_KERNEL_COUNT * SKF_SHAPE_COUNT];
  size_t n = everything(&seed, e);
  scatter(&seed, &e[SKF_SEGMENT].primitive, 1, &a);
  memcpy(&b, &a, sizeof a);
  int threads = omp_get_max_threads();
  for (int i = 0; i < ISAS; i++) {
    skf_field *f = make(isas[i], e, n);
    eval(f, 0, POINTS, &a);
    omp_set_num_threads(3);
    eval(f, 0, POINTS, &b);
    omp_set_num_threads(threads);
    assert_memory_equal(&a, &b, sizeof a);
    memset(b.F, 0, sizeof b.F);
    for (size_t from = 0, length = 1; from < POINTS; from += length, length = 1 + (length * 5 + 2) % 23)
      eval(f, from, length < POINTS - from ? length : POINTS - from, &b);
    assert_memory_equal(&a, &b, sizeof a);
    skf_field_free(f);
  }
}

static void same_point(const skf_field *f, cloud *c) {
  eval(f, 0, POINTS, c);
  for (size_t i = 0; i < POINTS; i++) {
    double v[4];
    skf_vec3 p = place(c, i);
    skf_field_point(f, &p, v);
    assert_true(v[0] == c->F[i] && v[1] == c->g[0][i] && v[2] == c->g[1][i] && v[3] == c->g[2][i]);
  }
}

/* What is not finite disturbs no other point. */
static void test_infinite(void **state) {
  (void)state;
  uint64_t seed = 16;
  static cloud a, b;
  skf_element e[SKF_KERNEL_COUNT * SKF_SHAPE_COUNT];
  size_t n = everything(&seed, e);
  const double bad[] = {INFINITY, -INFINITY, NAN, 1e308};
  for (int isa = 0; isa < ISAS; isa++)
    for (size_t k = 0; k < n; k++) {
      scatter(&seed, &e[k].primitive, 1, &a);
      memcpy(&b, &a, sizeof a);
      for (size_t i = k % 5; i < POINTS; i += 5) b.p[i % 3][i] = bad[i % 4];
      skf_field *f = make(isas[isa], e + k, 1);
      eval(f, 0, POINTS, &a);
      eval(f, 0, POINTS, &b);
      for (size_t i = 0; i < POINTS; i++)
        if (i % 5 != k % 5)
          assert_true(a.F[i] == b.F[i] && a.g[0][i] == b.g[0][i] && a.g[1][i] == b.g[1][i] && a.g[2][i] == b.g[2][i]);
      skf_field_free(f);
    }
}

/* Along an axis; the zeros of either sign */
static skf_vec3 along_axis(uint64_t *seed, int axis, double length) {
  double v[3];
  for (int c = 0; c < 3; c++) v[c] = c == axis ? length : rnd(seed, 0, 1) < 0.5 ? -0. : 0.;
  return v3(v[0], v[1], v[2]);
}

/* Arcs along axes, seen from the axes through their centres, where products are zeros of either sign */
static void test_axes(void **state) {
  (void)state;
  uint64_t seed = 18;
  static cloud a, b;
  double worst = 0;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int n = 0; n < 48; n++) {
      skf_element e = {{.shape = SKF_ARC}, {.type = (skf_kernel_type)k, .param = rnd(&seed, 0.3, 2)}, 1};
      const skf_vec3 at = rnd_vec(&seed, n % 2), normal = along_axis(&seed, n % 3, 1),
                     start = along_axis(&seed, (n + 1) % 3, n / 2 % 2 ? -1 : 1);
      e.primitive.arc = (skf_arc){at, normal, start, 1, n % 4 ? rnd(&seed, 0.2, 6) : 2 * SKF_PI};
      for (size_t i = 0; i < POINTS; i++)
        for (int c = 0; c < 3; c++) a.p[c][i] = v3_get(at, c) + ((i + (size_t)c) % 3 ? 0 : rnd(&seed, -2, 2));
      eval_both(&e, &a, &b);
      for (size_t i = 0; i < POINTS; i++) worst = fmax(worst, difference(&e.primitive, &a, &b, i));
    }
  print_message("arcs from axes: %.0f ulps\n", worst / 1.1e-16);
  assert_true(worst <= 2 * bound(SKF_ARC)); /* the closed forms' own error, too */
}

/* A batch of one gives what a longer one does, to the sign of zero; lying in planes of symmetry, the body itself,
   negative. */
static void test_sign(void **state) {
  (void)state;
  uint64_t seed = 15;
  static cloud a, b;
  for (int isa = 0; isa < ISAS; isa++)
    for (int k = 0; k < SKF_KERNEL_COUNT; k++)
      for (int s = 0; s < SKF_SOLID; s++)
        for (size_t n = 1; n < 4; n += 2) {
          skf_element e[3] = {{{.shape = (skf_shape)s}, {.type = (skf_kernel_type)k, .param = 1.5}, -1}};
          skf_primitive *at = &e->primitive;
          if (s == SKF_SEGMENT) at->segment = (skf_segment){{-1, 0, 0}, {1, 0, 0}};
          if (s == SKF_ARC) at->arc = (skf_arc){{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 1, n > 1 ? 2 : 2 * SKF_PI};
          if (s == SKF_TRIANGLE) at->triangle = (skf_triangle){{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}};
          if (s == SKF_PLANE) at->plane = (skf_plane){{0, 0, 0}, {0, 0, n > 1 ? 1 : -1}};
          e[1] = e[2] = e[0];
          skf_field *f = make(isas[isa], e, n);
          for (size_t i = 0; i < POINTS; i++)
            for (int c = 0; c < 3; c++) {
              double far = pow(10, rnd(&seed, -200, 200)), choice[] = {-1, 0, 0.5, 1, far, -far};
              a.p[c][i] = choice[(int)rnd(&seed, 0, 6)];
            }
          memcpy(&b, &a, sizeof a);
          eval(f, 0, POINTS, &a);
          for (size_t i = 0; i < POINTS; i++) eval(f, i, 1, &b);
          assert_memory_equal(&a, &b, sizeof a);
          skf_field_free(f);
        }
}

/* skf_field_point is a batch of one: for each pair, alone and several times, and for all together. */
static void test_point(void **state) {
  (void)state;
  uint64_t seed = 14;
  static cloud a;
  skf_element e[SKF_KERNEL_COUNT * SKF_SHAPE_COUNT], copies[9];
  size_t n = everything(&seed, e);
  for (int isa = 0; isa < ISAS; isa++)
    for (size_t k = 0; k <= n; k++) {
      scatter(&seed, &e[k < n ? k : 0].primitive, 1, &a);
      for (size_t j = 0; j < 9; j++) {
        copies[j] = e[k < n ? k : 0];
        if (j) rnd_primitive(&seed, copies[j].primitive.shape, 1, &copies[j].primitive);
      }
      for (size_t m = 1; m < 10; m += 4) {
        skf_field *f = k < n ? make(isas[isa], copies, m) : make(isas[isa], e, n);
        same_point(f, &a);
        skf_field_free(f);
      }
    }
}

/* Without vector instructions a batch is the single point, bit for bit; the Hessian always is. */
static void test_scalar(void **state) {
  (void)state;
  uint64_t seed = 13;
  static cloud a;
  static double h[6][POINTS];
  skf_element e[SKF_KERNEL_COUNT * SKF_SHAPE_COUNT];
  size_t n = everything(&seed, e);
  scatter(&seed, &e[SKF_SEGMENT].primitive, 1, &a);
  const double *const in[3] = {a.p[0], a.p[1], a.p[2]};
  double *const g[3] = {a.g[0], a.g[1], a.g[2]}, *const H[6] = {h[0], h[1], h[2], h[3], h[4], h[5]};
  for (int t = 0; t < ISAS; t++) {
    skf_field *f = make(isas[t], e, n);
    assert_int_equal(skf_field_eval(f, POINTS, in, a.F, g, H), SKF_OK);
    for (size_t i = 0; i < POINTS; i++) {
      double want[6];
      skf_vec3 G;
      double F = skf_field_tensor_at(f, place(&a, i), &G, want);
      for (int k = 0; k < 6; k++) assert_true(want[k] == h[k][i]);
      if (t == 0) assert_true(F == a.F[i] && G.x == a.g[0][i] && G.y == a.g[1][i] && G.z == a.g[2][i]);
    }
    skf_field_free(f);
  }
}

/* Some elements at eight points: each as it is alone, to the bit, wherever the field keeps it. */
static void test_eight(void **state) {
  (void)state;
  enum { MANY = 90, SOME = 3 };
  const bool vectors = skf_isa_pick() != SKF_ISA_SCALAR;
  uint64_t seed = 5;
  static cloud c;
  skf_element e[MANY];
  uint32_t at[MANY];
  skf_vec3 p[8];
  for (int i = 0; i < MANY; i++) {
    e[i] = (skf_element){.kernel = {i % 2 ? SKF_QUARTIC : SKF_CAUCHY, 1.5}, .strength = i % 5 ? 0.7 : -0.3};
    rnd_primitive(&seed, i % 3 ? SKF_TRIANGLE : SKF_SEGMENT, 1, &e[i].primitive);
  }
  for (int i = 0; i < 8; i++) {
    p[i] = rnd_vec(&seed, 1);
    for (int k = 0; k < 3; k++) c.p[k][i] = v3_get(p[i], k);
  }
  skf_field *f = make("scalar", e, MANY);
  skf_field_places(f, at);
  for (int i = 0; i < MANY; i++) assert_true(at[i] == SKF_NOWHERE);
  skf_field_free(f);
  f = make("avx2", e, MANY);
  skf_field_places(f, at);
  for (int i = 0; i < MANY; i++) assert_true((at[i] != SKF_NOWHERE) == vectors);
  for (uint32_t i = 0; vectors && i + 2 < MANY; i++) {
    const uint32_t which[SOME] = {i + 2, i, i + 1};
    skf_made all[8], sum[8] = {{0}};
    skf_field_some_eight(f, at, which, SOME, p, all);
    for (int n = 0; n < SOME; n++) {
      skf_field *one = make("avx2", e + which[n], 1);
      eval(one, 0, 8, &c);
      for (size_t k = 0; k < 8; k++) {
        sum[k].F += c.F[k], sum[k].size += fabs(c.F[k]);
        sum[k].g = v3_add(sum[k].g, slope(&c, k));
      }
      skf_field_free(one);
    }
    for (int k = 0; k < 8; k++) {
      assert_true(all[k].F == sum[k].F && all[k].size == sum[k].size);
      assert_true(v3_norm(v3_sub(all[k].g, sum[k].g)) == 0);
    }
  }
  skf_field_free(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_isas),          cmocka_unit_test(test_widths),
                                     cmocka_unit_test(test_chords),        cmocka_unit_test(test_tilted),
                                     cmocka_unit_test(test_gaussian_arcs), cmocka_unit_test(test_small_triangles),
                                     cmocka_unit_test(test_rim_on_axis),   cmocka_unit_test(test_other_coordinates),
                                     cmocka_unit_test(test_axes),          cmocka_unit_test(test_place),
                                     cmocka_unit_test(test_point),         cmocka_unit_test(test_sign),
                                     cmocka_unit_test(test_infinite),      cmocka_unit_test(test_scalar),
                                     cmocka_unit_test(test_eight)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
