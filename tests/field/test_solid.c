/* SPDX-License-Identifier: MIT */
/* Solids: a cube against its closed form, Gauss's law, sums against the expansion, what is refused. */
#include "check.h"
#include "field/solid.h"
#include "num/gauss.h"
#include "random.h"
#include "skelfield/surface.h"
#include <omp.h>
#include <stdlib.h>
#include <string.h>

static const skf_vec3 corners[8] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0},
                                    {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
static const unsigned sides[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};

static skf_solid *solid_of(const skf_vec3 *v, size_t nv, const unsigned (*f)[3], size_t nf) {
  skf_solid *s;
  skf_error e;
  if (skf_solid_new(v, nv, f, nf, &s, &e)) fail_msg("%s", e.text);
  return s;
}

/* A cube with a corner at `at` */
static skf_solid *cube(skf_vec3 at, double size) {
  skf_vec3 v[8];
  for (int i = 0; i < 8; i++) v[i] = v3_mad(at, size, corners[i]);
  return solid_of(v, 8, sides, 12);
}

static skf_field *field_of(const skf_solid *s, const char *isa) {
  skf_field *f;
  skf_element e = {.primitive = {.shape = SKF_SOLID, .solid = s}, .kernel = {.type = SKF_INVERSE}, .strength = 1};
  setenv("SKELFIELD_ISA", isa, 1);
  assert_int_equal(skf_field_new(&e, 1, &f), SKF_OK);
  unsetenv("SKELFIELD_ISA");
  return f;
}

static const char *const isas[] = {"scalar", "avx2"};

/* One place: F, the gradient, xx, xy, xz, yy, yz, zz; as a batch or by itself */
static void value(const skf_field *f, skf_vec3 x, bool batch, double out[10]) {
  if (batch) {
    const double *const p[3] = {&x.x, &x.y, &x.z};
    double *const g[3] = {out + 1, out + 2, out + 3};
    double *const h[6] = {out + 4, out + 5, out + 6, out + 7, out + 8, out + 9};
    assert_int_equal(skf_field_eval(f, 1, p, out, g, h), SKF_OK);
  } else {
    skf_vec3 g;
    out[0] = skf_field_tensor_at(f, x, &g, out + 4);
    out[1] = g.x, out[2] = g.y, out[3] = g.z;
  }
}

/* ln(z + r), r^2 = c2 + z^2; where it is infinite its factor is 0 */
static long double log_of(long double z, long double r, long double c2) {
  if (z >= 0) return z + r > 0 ? logl(z + r) : 0;
  return c2 > 0 ? logl(c2 / (r - z)) : 0;
}
static long double angle(long double yz, long double xr) { return yz == 0 ? 0 : xr == 0 ? 0 : atanl(yz / xr); }

/* The unit cube at the origin, corner by corner [MacMillan 1930, sec. 43]. */
static void closed_form(skf_vec3 at, double out[10]) {
  long double sum[10] = {0};
  for (int i = 0; i < 8; i++) {
    long double x = (long double)corners[i].x - at.x, y = (long double)corners[i].y - at.y,
                z = (long double)corners[i].z - at.z, r = sqrtl(x * x + y * y + z * z);
    long double s = (i & 1 ? 1 : -1) * (i & 2 ? 1 : -1) * (i & 4 ? 1 : -1);
    long double lx = log_of(x, r, y * y + z * z), ly = log_of(y, r, x * x + z * z), lz = log_of(z, r, x * x + y * y);
    long double ax = angle(y * z, x * r), ay = angle(z * x, y * r), az = angle(x * y, z * r);
    sum[0] += s * (x * y * lz + y * z * lx + z * x * ly - (x * x * ax + y * y * ay + z * z * az) / 2);
    sum[1] -= s * (y * lz + z * ly - x * ax), sum[2] -= s * (z * lx + x * lz - y * ay);
    sum[3] -= s * (x * ly + y * lx - z * az);
    sum[4] -= s * ax, sum[5] += s * lz, sum[6] += s * ly, sum[7] -= s * ay, sum[8] += s * lx, sum[9] -= s * az;
  }
  for (int k = 0; k < 10; k++) out[k] = (double)sum[k];
}

/* Largest errors of F, the gradient and the Hessian, each relative to itself (or to what it is made of where it is 0)
 */
static void compare(const double a[10], const double b[10], double size, double worst[3]) {
  double g = 0, dg = 0, h = 0, dh = 0;
  for (int k = 1; k < 4; k++) g += b[k] * b[k], dg += (a[k] - b[k]) * (a[k] - b[k]);
  for (int k = 4; k < 10; k++) h += b[k] * b[k], dh += (a[k] - b[k]) * (a[k] - b[k]);
  worst[0] = fmax(worst[0], fabs(a[0] / b[0] - 1));
  worst[1] = fmax(worst[1], sqrt(dg) / fmax(sqrt(g), 1e-3 * b[0] / size));
  worst[2] = fmax(worst[2], sqrt(dh) / fmax(sqrt(h), 1e-3 * b[0] / (size * size)));
}

/* i % 6: around, inside, next to a face, an edge, a corner, on a face */
static skf_vec3 place(uint64_t *seed, int i) {
  skf_vec3 x = v3(rnd(seed, 0, 1), rnd(seed, 0, 1), rnd(seed, 0, 1));
  double off = pow(10, rnd(seed, -9, -1));
  if (i % 6 == 0) x = v3_mad(v3(0.5, 0.5, 0.5), rnd(seed, 0.9, 3.4), rnd_unit(seed));
  if (i % 6 > 1 && i % 6 < 5) *v3_at(&x, i % 3) = i & 8 ? 1 : 0;
  if (i % 6 == 3 || i % 6 == 4) *v3_at(&x, (i + 1) % 3) = i & 16 ? 1 : 0;
  if (i % 6 == 4) *v3_at(&x, (i + 2) % 3) = i & 32 ? 1 : 0;
  if (i % 6 > 1 && i % 6 < 5) x = v3_mad(x, off, rnd_unit(seed));
  if (i % 6 == 5) *v3_at(&x, i % 3) = 0;
  return x;
}

static void cube_closed_form(void **state) {
  (void)state;
  skf_solid *s = cube(v3(0, 0, 0), 1);
  for (int isa = 0; isa < 2; isa++)
    for (int batch = 0; batch < 2; batch++) {
      uint64_t seed = 5;
      double worst[3] = {0}, a[10], b[10];
      skf_field *f = field_of(s, isas[isa]);
      for (int i = 0; i < 6000; i++) {
        skf_vec3 x = place(&seed, i);
        value(f, x, batch, a);
        closed_form(x, b);
        if (i % 6 == 5)
          memcpy(a + 4, b + 4, 6 * sizeof *a); /* on a face the Hessian jumps: its mean has its own test */
        compare(a, b, 1, worst);
      }
      print_message("%s, %s: F %.1e, gradient %.1e, Hessian %.1e\n", isas[isa], batch ? "batch" : "point", worst[0],
                    worst[1], worst[2]);
      assert_true(worst[0] < 1e-14 && worst[1] < 1e-13 && worst[2] < 1e-12);
      skf_field_free(f);
    }
  skf_solid_free(s);
}

/* Faces, edges, corners: F and the gradient go on; the Hessian is the mean of its two sides. */
static void cube_on_itself(void **state) {
  (void)state;
  skf_solid *s = cube(v3(-0.5, -0.5, -0.5), 1);
  const double corner = 1.1900386819897768, half = 1.4272601797003583; /* of the reference at 60 digits */
  for (int isa = 0; isa < 2; isa++) {
    skf_field *f = field_of(s, isas[isa]);
    double a[10], b[10], c[10];
    for (int i = 0; i < 8; i++) { /* and the signs of the octants */
      skf_vec3 x = v3_sub(corners[i], v3(0.5, 0.5, 0.5));
      value(f, x, i & 1, a);
      check_close(a[0], corner, 1e-15);
      for (int k = 0; k < 3; k++) check_close(a[1 + k], -2 * v3_get(x, k) * 0.96938805271256823, 4e-15);
    }
    value(f, v3(-0.5, 0, -0.5), true, a);
    check_close(a[0], half, 2e-15);
    value(f, v3(0, 0, 0), true, a);
    check_close(a[0], 3 * log(2 + sqrt(3)) - SKF_PI / 2, 2e-15);
    assert_true(fabs(a[1]) + fabs(a[2]) + fabs(a[3]) < 1e-15);
    for (int k = 4; k < 10; k++) assert_true(fabs(a[k] - (k == 4 || k == 7 || k == 9 ? -4 * SKF_PI / 3 : 0)) < 1e-14);
    value(f, v3(0.5, 0.1, 0.2), true, a);
    value(f, v3(0.5 - 1e-9, 0.1, 0.2), true, b);
    value(f, v3(0.5 + 1e-9, 0.1, 0.2), true, c);
    for (int k = 4; k < 10; k++) assert_true(fabs(a[k] - 0.5 * (b[k] + c[k])) < 1e-8);
    check_close(b[4] + b[7] + b[9], -4 * SKF_PI, 1e-14);
    assert_true(fabs(c[4] + c[7] + c[9]) < 1e-13);
    skf_field_free(f);
  }
  skf_solid_free(s);
}

/* An icosphere with bumps: 20 * 4^n faces. */
static skf_solid *pebble(int n, double size) {
  skf_mesh m = {0};
  const double t = 1.6180339887498949;
  static const unsigned ico[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                      {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                      {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                      {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  const skf_vec3 top[12] = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                            {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  size_t nf = 20;
  skf_vec3(*f)[3] = malloc(20 * sizeof *f << 2 * n); /* triangles of points: skf_solid_new joins them */
  for (int i = 0; i < 20; i++)
    for (int k = 0; k < 3; k++) f[i][k] = v3_unit(top[ico[i][k]]);
  for (int l = 0; l < n; l++, nf *= 4)
    for (size_t i = 0; i < nf; i++) {
      skf_vec3 a = f[i][0], b = f[i][1], c = f[i][2];
      skf_vec3 ab = v3_unit(v3_add(a, b)), bc = v3_unit(v3_add(b, c)), ca = v3_unit(v3_add(c, a));
      const skf_vec3 parts[4][3] = {{ab, bc, ca}, {a, ab, ca}, {b, bc, ab}, {c, ca, bc}};
      memcpy(f[i], parts[0], sizeof parts[0]);
      memcpy(f[nf + 3 * i], parts[1], 3 * sizeof parts[1]);
    }
  m.vertices = f[0];
  unsigned(*index)[3] = malloc(nf * sizeof *index);
  for (size_t i = 0; i < 3 * nf; i++) {
    skf_vec3 u = f[i / 3][i % 3];
    double r = 1 + 0.1 * sin(5 * u.x + 1) * cos(4 * u.y) + 0.05 * sin(9 * u.z);
    f[i / 3][i % 3] = v3(size * r * 1.6 * u.x, size * r * u.y, size * r * 0.8 * u.z);
    index[i / 3][i % 3] = (unsigned)i;
  }
  skf_solid *s = solid_of(m.vertices, 3 * nf, (const unsigned(*)[3])index, nf);
  free(f), free(index);
  return s;
}

/* -flux of the gradient through a sphere about the centre over 4 pi, by a product rule that converges like
   (body / sphere)^(2 n) */
static double mass_within(const skf_solid *s, double radius, int n) {
  skf_field *f = field_of(s, "avx2");
  const skf_gauss_node *node = skf_gauss_rule(n);
  size_t count = (size_t)(2 * n * n), at = 0;
  double *x = malloc(6 * count * sizeof *x), sum = 0;
  const double *const p[3] = {x, x + count, x + 2 * count};
  double *const g[3] = {x + 3 * count, x + 4 * count, x + 5 * count};
  skf_vec3 c = skf_solid_get(s)->center;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < 2 * n; j++, at++) {
      double phi = SKF_PI * (j + 0.5) / n, rho = sqrt(1 - node[i].x * node[i].x);
      x[at] = c.x + radius * rho * cos(phi), x[count + at] = c.y + radius * rho * sin(phi);
      x[2 * count + at] = c.z + radius * node[i].x;
    }
  assert_int_equal(skf_field_eval(f, count, p, NULL, g, NULL), SKF_OK);
  for (size_t k = 0; k < count; k++) {
    skf_vec3 u = v3_scale(1 / radius, v3_sub(v3(p[0][k], p[1][k], p[2][k]), c));
    sum += node[k / (size_t)(2 * n)].w * v3_dot(u, v3(g[0][k], g[1][k], g[2][k]));
  }
  free(x);
  skf_field_free(f);
  return -sum * SKF_PI / n * radius * radius / (4 * SKF_PI);
}

static void gauss_law(void **state) {
  (void)state;
  for (int k = 0; k < 3; k++) {
    skf_solid *s = k ? pebble(k + 1, 1) : cube(v3(0, 0, 0), 1);
    double V = skf_solid_get(s)->volume;
    check_close(mass_within(s, 2.5 * s->radius, 20), V, 1e-13);
    check_close(mass_within(s, 1.2 * s->far, 12), V, 1e-13);
    skf_solid_free(s);
  }
  char path[4096];
  const char *shared = getenv("SKF_SHARED"), *source = getenv("SKF_SOURCE_ROOT");
  snprintf(path, sizeof path, "%s%s/data/216-kleopatra.obj",
           shared   ? shared
           : source ? source
                    : ".",
           shared ? "" : "/../shared");
  skf_mesh m;
  if (skf_mesh_read(path, &m, NULL)) {
    print_message("no shape model of an asteroid here: skipped\n");
    return;
  }
  skf_solid *s = solid_of(m.vertices, m.vertex_count, (const unsigned(*)[3])m.triangles, m.triangle_count);
  double V = skf_solid_get(s)->volume, found = mass_within(s, 2 * s->radius, 24);
  print_message("Kleopatra: mass within a sphere off by %.1e\n", found / V - 1);
  check_close(found, V, 1e-12);
  skf_solid_free(s);
  skf_mesh_free(&m);
}

/* Beyond `far` the sum over the faces still holds: it loses the square of the distance over the size. */
static void sum_and_expansion(void **state) {
  (void)state;
  for (int k = 0; k < 4; k++) {
    skf_solid *s = k ? pebble(k, k == 2 ? 1e-7 : k == 3 ? 1e7 : 1) : cube(v3(1, 2, 3), 1);
    uint64_t seed = 7;
    double worst[3] = {0}, a[10], b[10];
    for (int i = 0; i < 60; i++) {
      double d = s->far * rnd(&seed, 1, 1.3);
      skf_vec3 x = v3_mad(s->info.center, d, rnd_unit(&seed));
      skf_solid near = {.radius = 0};
      memcpy(&near, s, sizeof near);
      near.far = INFINITY;
      skf_solid_scalar.point(&near, x, true, a);
      skf_solid_scalar.point(s, x, true, b);
      compare(a, b, d, worst);
    }
    print_message("%zu faces: F %.1e, gradient %.1e, Hessian %.1e\n", s->face_count, worst[0], worst[1], worst[2]);
    assert_true(worst[0] < 1e-13 && worst[1] < 2e-13 && worst[2] < 1e-12);
    double far = 1e6 * s->radius, V = s->info.volume;
    skf_solid_scalar.point(s, v3_mad(s->info.center, far, v3(0, 0, 1)), true, a);
    check_close(a[0], V / far, 1e-12); /* the quadrupole is 1e-12 of it */
    check_close(a[3], -V / (far * far), 1e-11);
    check_close(a[9], 2 * V / (far * far * far), 1e-11);
    skf_solid_free(s);
  }
}

/* Vectors against the sums point by point, whatever the neighbours and the threads. */
static void batches(void **state) {
  (void)state;
  enum { N = 301 };
  static double p[3][N], out[2][10][N];
  skf_solid *s = pebble(3, 1);
  uint64_t seed = 9;
  for (int i = 0; i < N; i++) {
    skf_vec3 x = v3_scale(i % 3 ? rnd(&seed, 0.2, 2) : pow(10, rnd(&seed, 0, 3)), rnd_unit(&seed));
    if (i % 7 == 0) x = s->vertices[(size_t)i];
    if (i % 7 == 1) x = v3_scale(0.5, v3_add(s->vertices[s->faces[i][0]], s->vertices[s->faces[i][1]]));
    p[0][i] = x.x, p[1][i] = x.y, p[2][i] = x.z;
  }
  skf_field *f = field_of(s, "avx2"), *plain = field_of(s, "scalar");
  int threads = omp_get_max_threads();
  double worst[3] = {0};
  for (int k = 0; k < 2; k++) {
    omp_set_num_threads(k ? 3 : 1);
    for (size_t from = 0, n = N; from < N; from += n) {
      n = !k ? N : from % 5 + 1 < N - from ? from % 5 + 1 : N - from;
      const double *const at[3] = {p[0] + from, p[1] + from, p[2] + from};
      double *const g[3] = {out[k][1] + from, out[k][2] + from, out[k][3] + from};
      double *const h[6] = {out[k][4] + from, out[k][5] + from, out[k][6] + from,
                            out[k][7] + from, out[k][8] + from, out[k][9] + from};
      assert_int_equal(skf_field_eval(f, n, at, out[k][0] + from, g, h), SKF_OK);
    }
  }
  omp_set_num_threads(threads);
  assert_memory_equal(out[0], out[1], sizeof out[0]);
  for (int i = 0; i < N; i++) {
    double a[10], b[10], c[10];
    for (int k = 0; k < 10; k++) a[k] = out[0][k][i];
    skf_vec3 x = v3(p[0][i], p[1][i], p[2][i]);
    value(plain, x, false, b);
    value(f, x, false, c);
    if (i % 7 == 0 || i % 7 == 1) /* infinite there */
      for (int k = 4; k < 10; k++) a[k] = c[k] = b[k];
    compare(a, b, 1, worst);
    compare(c, b, 1, worst);
  }
  print_message("vectors: F %.1e, gradient %.1e, Hessian %.1e\n", worst[0], worst[1], worst[2]);
  assert_true(worst[0] < 1e-13 && worst[1] < 2e-13 && worst[2] < 1e-12);
  /* F and the gradient are the same with and without the Hessian */
  const double *const at[3] = {p[0], p[1], p[2]};
  double *const g[3] = {out[1][1], out[1][2], out[1][3]};
  assert_int_equal(skf_field_eval(f, N, at, out[1][0], g, NULL), SKF_OK);
  assert_memory_equal(out[0], out[1], 4 * sizeof out[0][0]);
  skf_field_free(f), skf_field_free(plain);
  skf_solid_free(s);
}

/* Solids among other elements; who holds whom; no other kernel. */
static void company(void **state) {
  (void)state;
  skf_solid *s = cube(v3(0, 0, 0), 1);
  skf_element e[2] = {
      {.primitive = {.shape = SKF_SOLID, .solid = s}, .kernel = {.type = SKF_INVERSE}, .strength = 2},
      {.primitive = {.shape = SKF_POINT, .point = {{2, 0, 0}}}, .kernel = {.type = SKF_INVERSE}, .strength = -3}};
  skf_field *f, *alone = field_of(s, "avx2");
  assert_int_equal(skf_field_new(e, 2, &f), SKF_OK);
  skf_solid_free(s);
  double a[10], b[10];
  skf_vec3 x = v3(0.3, -0.4, 0.9);
  for (int batch = 0; batch < 2; batch++) {
    value(f, x, batch, a);
    value(alone, x, batch, b);
    check_close(a[0], 2 * b[0] - 3 / v3_dist(x, v3(2, 0, 0)), 1e-14);
    value(f, v3(2, 0, 0), batch, a);
    assert_true(a[0] == -INFINITY);
    for (int k = 1; k < 10; k++) assert_true(a[k] == 0);
  }
  skf_field_free(f);
  e[0].kernel = (skf_kernel){.type = SKF_CAUCHY, .param = 1};
  assert_int_equal(skf_field_new(e, 2, &f), SKF_ERR_UNSUPPORTED);
  skf_field_free(alone);
}

/* Bounds in balls, across faces too. */
static void bounds(void **state) {
  (void)state;
  uint64_t seed = 3;
  skf_solid *s = cube(v3(0, 0, 0), 1);
  skf_field *f = field_of(s, "avx2");
  int finite = 0;
  for (int i = 0; i < 400; i++) {
    skf_vec3 c = v3_mad(v3(0.5, 0.5, 0.5), rnd(&seed, 0, 1.5), rnd_unit(&seed));
    double radius = pow(10, rnd(&seed, -3, -0.3)), a[10];
    skf_bound b = skf_field_bound(f, c, radius);
    finite += b.hessian < INFINITY;
    for (int k = 0; k < 20; k++) {
      value(f, v3_mad(c, rnd(&seed, 0, radius), rnd_unit(&seed)), false, a);
      double h = 0;
      for (int j = 4; j < 10; j++) h = fmax(h, fabs(a[j]));
      assert_true(a[0] >= b.lo && a[0] <= b.hi);
      assert_true(v3_norm(v3(a[1], a[2], a[3])) <= b.gradient && h <= b.hessian);
    }
  }
  print_message("%d of 400 Hessians are bounded\n", finite);
  assert_true(finite > 200);
  skf_box box;
  assert_int_equal(skf_field_region(f, 1.5, &box), SKF_OK);
  assert_int_equal(skf_field_region(f, 2.5, &box), SKF_ERR_EMPTY);
  skf_field_free(f), skf_solid_free(s);
}

static void weights(void **state) {
  (void)state;
  skf_solid *s = cube(v3(1e6, -2e6, 3e6), 2);
  const skf_solid_info *i = skf_solid_get(s);
  assert_true(i->vertices == 8 && i->faces == 12 && i->edges == 18 && i->components == 1);
  assert_true(i->volume == 8 && i->area == 24);
  assert_true(i->center.x == 1e6 + 1 && i->center.y == -2e6 + 1 && i->center.z == 3e6 + 1);
  for (int k = 0; k < 6; k++) assert_true(fabs(i->inertia[k] - (k == 0 || k == 3 || k == 5 ? 8 * 4 / 6.0 : 0)) < 1e-14);
  assert_true(skf_solid_contains(s, v3(1e6 + 0.1, -2e6 + 1, 3e6 + 1.9)));
  assert_false(skf_solid_contains(s, v3(1e6 - 0.1, -2e6 + 1, 3e6 + 1.9)));
  skf_primitive p = {.shape = SKF_SOLID, .solid = s};
  check_close(skf_primitive_distance(&p, v3(1e6 - 3, -2e6 - 4, 3e6 + 1)), 5, 1e-15);
  assert_true(skf_primitive_distance(&p, i->center) == 0);
  check_close(skf_primitive_distance_max(&p, i->center), sqrt(3), 1e-15);
  skf_solid_free(s);
}

static void refuse(const skf_vec3 *v, size_t nv, const unsigned (*f)[3], size_t nf, skf_status status,
                   const char *text) {
  skf_solid *s;
  skf_error e;
  assert_int_equal(skf_solid_new(v, nv, f, nf, &s, &e), status);
  assert_null(s);
  if (!strstr(e.text, text)) fail_msg("'%s' without '%s'", e.text, text);
}

static void malformed(void **state) {
  (void)state;
  unsigned f[25][3];
  skf_vec3 v[17];
  memcpy(v, corners, sizeof corners);
  refuse(v, 8, sides, 0, SKF_ERR_DEGENERATE, "no faces");
  refuse(v, 8, sides, 11, SKF_ERR_DEGENERATE,
         "is not closed at the edge from (1, 0, 0) to (1, 0, 1), which has 1 face");
  memcpy(f, sides, sizeof sides);
  f[4][0] = 1, f[4][1] = 0;
  refuse(v, 8, (const unsigned(*)[3])f, 12, SKF_ERR_DEGENERATE, "inconsistent orientation");
  for (int i = 0; i < 12; i++) f[i][0] = sides[i][1], f[i][1] = sides[i][0], f[i][2] = sides[i][2];
  refuse(v, 8, (const unsigned(*)[3])f, 12, SKF_ERR_DEGENERATE, "faces inward (its volume is -1)");
  for (int i = 0; i < 24; i++) memcpy(f[i], sides[i % 12], sizeof f[i]);
  refuse(v, 8, (const unsigned(*)[3])f, 24, SKF_ERR_DEGENERATE, "has a face twice at the edge from (0, 0, 0) to");
  f[3][2] = 8;
  refuse(v, 8, (const unsigned(*)[3])f, 12, SKF_ERR_RANGE, "face 3 (from 0) has no vertex 8");
  v[2].y = NAN;
  refuse(v, 8, sides, 12, SKF_ERR_RANGE, "vertex 2 (from 0) is not finite");
  memcpy(v, corners, sizeof corners);
  for (int i = 0; i < 8; i++) v[i].z = 0;
  refuse(v, 8, sides, 12, SKF_ERR_DEGENERATE, "");
  /* a second cube: beside the first, as its cavity, as an island in its material, inside out beside it */
  memcpy(v, corners, sizeof corners);
  skf_solid *s;
  for (int k = 0; k < 4; k++) {
    for (int i = 0; i < 8; i++)
      v[8 + i] = v3_mad(k == 0 || k == 3 ? v3(2, 0, 0) : v3(0.25, 0.25, 0.25), 0.5, corners[i]);
    for (int i = 0; i < 24; i++)
      for (int j = 0; j < 3; j++) f[i][j] = i < 12 ? sides[i][j] : 8 + sides[i - 12][k == 1 || k == 3 ? 2 - j : j];
    if (k > 1) {
      refuse(v, 16, (const unsigned(*)[3])f, 24, SKF_ERR_DEGENERATE,
             k == 2 ? "lies inside of" : "faces inward and is no");
      continue;
    }
    s = solid_of(v, 16, (const unsigned(*)[3])f, 24);
    assert_true(skf_solid_get(s)->components == 2);
    check_close(skf_solid_get(s)->volume, k ? 0.875 : 1.125, 1e-15);
    assert_true(skf_solid_contains(s, k ? v3(0.1, 0.5, 0.5) : v3(2.1, 0.2, 0.2)) &&
                !skf_solid_contains(s, k ? v3(0.5, 0.5, 0.5) : v3(1.5, 0.2, 0.2)));
    skf_solid_free(s);
  }
  /* a face without area, an unused vertex and a repeated one do no harm */
  memcpy(f, sides, sizeof sides);
  v[8] = v3(9, 9, 9), v[9] = corners[7];
  f[12][0] = 3, f[12][1] = 7, f[12][2] = 9;
  f[11][1] = 9;
  s = solid_of(v, 10, (const unsigned(*)[3])f, 13);
  assert_true(skf_solid_get(s)->faces == 12 && skf_solid_get(s)->joined == 1 && skf_solid_get(s)->unused == 1);
  assert_true(skf_solid_get(s)->dropped == 1 && skf_solid_get(s)->volume == 1);
  skf_solid_free(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(cube_closed_form), cmocka_unit_test(cube_on_itself),
                                     cmocka_unit_test(gauss_law),        cmocka_unit_test(sum_and_expansion),
                                     cmocka_unit_test(batches),          cmocka_unit_test(company),
                                     cmocka_unit_test(bounds),           cmocka_unit_test(weights),
                                     cmocka_unit_test(malformed)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
