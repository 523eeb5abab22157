/* SPDX-License-Identifier: MIT */
/* Kernels of the caller's own: those of the registry, handed in from outside, against their closed forms on every
   primitive; others against formulas; what is refused without bounds, and what works with them. */
#include "check.h"
#include "field/envelope.h"
#include "random.h"
#include "skelfield/motion.h"
#include "skelfield/surface.h"
#include <omp.h>

/* A kernel of the registry as a user would write it. */
static void mirror(const void *user, double r2, double d[4]) { skf_kernel_eval(*(const skf_kernel *)user, r2, d); }
static skf_envelope mirror_bound(const void *user, double a) {
  return skf_kernel_envelope(*(const skf_kernel *)user, a);
}

typedef struct mine {
  skf_kernel model;
  double breaks[1];
  skf_user_kernel kernel;
} mine;

static const double decays[SKF_KERNEL_COUNT] = {[SKF_CAUCHY] = 4, [SKF_GAUSSIAN] = INFINITY};

static void make(mine *m, skf_kernel_type type, double width) {
  const skf_kernel_info *info = skf_kernel_get(type);
  m->model = (skf_kernel){type, info->compact ? 2 * width : 1 / width};
  m->breaks[0] = m->model.param / 3;
  m->kernel = (skf_user_kernel){.name = info->name,
                                .eval = mirror,
                                .user = &m->model,
                                .width = width,
                                .radius = info->compact ? m->model.param : 0,
                                .decay = decays[type],
                                .singular = info->singular,
                                .break_count = type == SKF_METABALL,
                                .breaks = m->breaks};
}

static skf_kernel using(const skf_user_kernel *k) { return (skf_kernel){.type = SKF_USER_KERNEL, .user = k}; }

static skf_field *field_of(const skf_primitive *p, skf_kernel k) {
  skf_field *f;
  skf_element e = {*p, k, 1};
  assert_int_equal(skf_field_new(&e, 1, &f), SKF_OK);
  return f;
}

static double norm6(const double h[6]) {
  return sqrt(h[0] * h[0] + h[3] * h[3] + h[5] * h[5] + 2 * (h[1] * h[1] + h[2] * h[2] + h[4] * h[4]));
}

static skf_vec3 place(uint64_t *seed, const skf_primitive *p, int i) {
  skf_vec3 at = skf_primitive_point(p, rnd(seed, 0, 1), rnd(seed, 0, 1));
  if (i % 6 == 5 && p->shape == SKF_ARC) return v3_mad(p->arc.center, rnd(seed, -1, 1), p->arc.normal);
  return v3_mad(at, pow(10, rnd(seed, -3, 1)), rnd_unit(seed));
}

static void the_registry_from_outside(void **state) {
  (void)state;
  uint64_t seed = 7;
  for (skf_kernel_type k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = 0; s < SKF_SOLID; s++) {
      double worst[3] = {0};
      if (s == SKF_PLANE && skf_kernel_get(k)->singular) continue;
      for (int i = 0; i < (s == SKF_TRIANGLE ? 12 : 200); i++) {
        mine m;
        make(&m, k, pow(10, rnd(&seed, -1.5, 1)));
        skf_primitive p;
        rnd_primitive(&seed, (skf_shape)s, 1, &p);
        skf_field *a = field_of(&p, using(&m.kernel)), *b = field_of(&p, m.model);
        skf_vec3 x = place(&seed, &p, i), g, G;
        double h[6], H[6], d = fmax(1e-3, skf_primitive_distance(&p, x));
        double f = skf_field_tensor_at(a, x, &g, h), F = skf_field_tensor_at(b, x, &G, H);
        for (int j = 0; j < 6; j++) h[j] -= H[j];
        if (fabs(F) > 1e-100) {
          worst[0] = fmax(worst[0], fabs(f - F) / fabs(F));
          worst[1] = fmax(worst[1], v3_dist(g, G) / fmax(v3_norm(G), fabs(F) / d));
          worst[2] = fmax(worst[2], norm6(h) / fmax(norm6(H), fabs(F) / (d * d)));
        } else
          assert_true(fabs(f) <= 1e-100);
        skf_field_free(a), skf_field_free(b);
      }
      print_message("%-16s %-9s F %.1e  gradient %.1e  Hessian %.1e\n", skf_kernel_get(k)->name,
                    skf_shape_get((skf_shape)s)->name, worst[0], worst[1], worst[2]);
      for (int j = 0; j < 3; j++) assert_true(worst[j] <= 1e-10);
    }
}

/* 1 / sqrt(r^2 + b^2) is Newton's kernel seen from a height b in a fourth dimension. */
static void plummer(const void *user, double r2, double d[4]) {
  double b = *(const double *)user, w = r2 + b * b, h = 1 / sqrt(w);
  d[0] = h, d[1] = -h / (2 * w), d[2] = 3 * h / (4 * w * w), d[3] = -15 * h / (8 * w * w * w);
}
static const double core = 0.1;
static const skf_user_kernel plummer_kernel = {
    .name = "plummer", .eval = plummer, .user = &core, .width = 0.1, .decay = 1};

/* (1 - r^2 / R^2)^3, of Wyvill's kind */
static void cubic(const void *user, double r2, double d[4]) {
  double R = *(const double *)user, k = -1 / (R * R), m = 1 + k * r2;
  d[0] = m * m * m, d[1] = 3 * k * m * m, d[2] = 6 * k * k * m, d[3] = 6 * k * k * k;
}
static const double reach = 3;
static const skf_user_kernel cubic_kernel = {.name = "cubic", .eval = cubic, .user = &reach, .width = 3, .radius = 3};

static void others_against_formulas(void **state) {
  (void)state;
  skf_primitive line = {.shape = SKF_SEGMENT, .segment = {{-1, 0, 0}, {1, 0, 0}}};
  skf_field *f = field_of(&line, using(&plummer_kernel)), *c = field_of(&line, using(&cubic_kernel));
  uint64_t seed = 8;
  for (int i = 0; i < 200; i++) {
    double t = rnd(&seed, -1, 1), h = i % 4 ? pow(10, rnd(&seed, -4, 0)) : 0, q = sqrt(h * h + 0.01);
    skf_vec3 x = v3(t, 0.6 * h, 0.8 * h), g;
    double u = 1 + t, v = 1 - t, F = skf_field_at(f, x, &g);
    check_close(F, asinh(u / q) + asinh(v / q), 1e-12);
    double slope = -h / (q * q) * (u / hypot(u, q) + v / hypot(v, q));
    check_scaled(g.y, 0.6 * slope, fabs(slope) + 1e-300, 1e-11);
    check_scaled(g.x, 1 / hypot(u, q) - 1 / hypot(v, q), 10, 1e-12);
    double k = 1 - h * h / 9, p[4] = {k * k * k, -k * k / 3, k / 27, -1.0 / 729}, want = 0; /* (k - s^2/9)^3 */
    for (int j = 0; j < 4; j++) want += p[j] * (pow(u, 2 * j + 1) + pow(v, 2 * j + 1)) / (2 * j + 1);
    check_close(skf_field_at(c, x, NULL), want, 1e-12);
  }
  skf_field_free(f), skf_field_free(c);
}

/* 1 / r^3 over a plane: 2 pi / |z|; exp(-r) / r, which is singular, as well: 2 pi exp(-|z|). */
static void cube(const void *user, double r2, double d[4]) {
  (void)user;
  d[0] = 1 / (r2 * sqrt(r2)), d[1] = -1.5 * d[0] / r2, d[2] = -2.5 * d[1] / r2, d[3] = -3.5 * d[2] / r2;
}
static void yukawa(const void *user, double r2, double d[4]) {
  (void)user;
  double r = sqrt(r2), e = exp(-r), u = 1 / r, u2 = u * u; /* d/dw = (1 / 2r) d/dr, three times */
  d[0] = e * u;
  d[1] = -0.5 * e * u2 * (1 + u);
  d[2] = 0.25 * e * u2 * u * (1 + 3 * u * (1 + u));
  d[3] = -0.125 * e * u2 * u2 * (1 + u * (6 + 15 * u * (1 + u)));
}
static const skf_user_kernel cube_kernel = {.name = "cube", .eval = cube, .width = 1, .decay = 3, .singular = true},
                             yukawa_kernel = {
                                 .name = "yukawa", .eval = yukawa, .width = 1, .decay = 99, .singular = true};

static void planes(void **state) {
  (void)state;
  skf_primitive plane = {.shape = SKF_PLANE, .plane = {{0, 0, 0}, {0, 0, 1}}};
  skf_field *c = field_of(&plane, using(&cube_kernel)), *y = field_of(&plane, using(&yukawa_kernel)), *f;
  for (int i = -8; i < 8; i++) {
    double z = pow(3, i), h[6];
    skf_vec3 x = v3(1, 2, -z), g;
    check_close(skf_field_tensor_at(c, x, &g, h), 2 * SKF_PI / z, 1e-12);
    check_close(g.z, 2 * SKF_PI / (z * z), 1e-11);
    check_close(h[5], 4 * SKF_PI / (z * z * z), 1e-11);
    if (z > 500) continue;
    check_close(skf_field_tensor_at(y, x, &g, h), 2 * SKF_PI * exp(-z), 1e-11);
    check_close(g.z, 2 * SKF_PI * exp(-z), 1e-11);
    check_close(h[5], 2 * SKF_PI * exp(-z), 1e-10);
  }
  assert_true(skf_field_at(c, v3(5, 5, 0), NULL) == INFINITY);
  skf_field_free(c), skf_field_free(y);
  skf_element e = {plane, using(&plummer_kernel), 1};
  assert_int_equal(skf_field_new(&e, 1, &f), SKF_ERR_UNSUPPORTED);
  e.kernel = using(&cubic_kernel);
  assert_int_equal(skf_field_new(&e, 1, &f), SKF_OK);
  check_close(skf_field_at(f, v3(0, 0, 1), NULL), SKF_PI * 9 / 4 * pow(8.0 / 9, 4), 1e-12);
  skf_field_free(f);
}

static void nonsense_is_refused(void **state) {
  (void)state;
  skf_field *f;
  skf_user_kernel k = plummer_kernel;
  static const double falling[2] = {2, 1};
  skf_element e = {{.shape = SKF_POINT}, using(NULL), 1};
  assert_int_equal(skf_field_new(&e, 1, &f), SKF_ERR_ARG);
  e.kernel.user = &k;
  assert_int_equal(skf_field_new(&e, 1, &f), SKF_OK);
  skf_field_free(f);
  k.eval = NULL;
  assert_int_equal(skf_field_new(&e, 1, &f), SKF_ERR_ARG);
  k = plummer_kernel, k.width = 0;
  assert_int_equal(skf_field_new(&e, 1, &f), SKF_ERR_RANGE);
  k = plummer_kernel, k.radius = NAN;
  assert_int_equal(skf_field_new(&e, 1, &f), SKF_ERR_RANGE);
  k = plummer_kernel, k.break_count = 2;
  assert_int_equal(skf_field_new(&e, 1, &f), SKF_ERR_ARG);
  k.breaks = falling;
  assert_int_equal(skf_field_new(&e, 1, &f), SKF_ERR_RANGE);
  assert_null(skf_kernel_get(SKF_USER_KERNEL));
  assert_true(skf_pair_get(SKF_USER_KERNEL, SKF_POINT).closed && !skf_pair_get(SKF_USER_KERNEL, SKF_ARC).closed);
}

static void no_bounds_no_guesses(void **state) {
  (void)state;
  mine m;
  make(&m, SKF_GAUSSIAN, 1);
  skf_element e[2] = {{{.shape = SKF_POINT}, m.model, 1}, {{.shape = SKF_POINT}, using(&m.kernel), 1}};
  skf_field *f;
  assert_int_equal(skf_field_new(e, 2, &f), SKF_OK);
  size_t which = 7;
  assert_false(skf_field_has_bound(f, &which));
  assert_int_equal(which, 1);
  skf_box box;
  skf_tracer *tracer;
  skf_mesh mesh;
  assert_int_equal(skf_field_region(f, 0.5, &box), SKF_ERR_UNSUPPORTED);
  assert_int_equal(skf_tracer_new(f, 0.5, &tracer), SKF_ERR_UNSUPPORTED);
  assert_int_equal(skf_mesh_field(f, 0.5, NULL, &mesh, NULL), SKF_ERR_UNSUPPORTED);
  skf_bound b = skf_field_bound(f, v3(9, 0, 0), 1);
  assert_true(b.lo == -INFINITY && b.hi == INFINITY && b.gradient == INFINITY && b.hessian == INFINITY);
  skf_attractor body = {.field = f, .iso = 0.5, .gain = 1};
  skf_world *world;
  assert_int_equal(skf_world_new(&body, 1, &world), SKF_OK);
  skf_flight_options options = {.contact = SKF_CONTACT_STOP};
  skf_state start = {0, {3, 0, 0}, {0, 0, 0}}, end;
  skf_flight *flight;
  assert_int_equal(skf_flight_new(world, &options, &start, &flight), SKF_ERR_UNSUPPORTED);
  options.contact = SKF_CONTACT_NONE; /* to fly through it needs none */
  assert_int_equal(skf_flight_new(world, &options, &start, &flight), SKF_OK);
  assert_int_equal(skf_flight_step(flight, NULL, NULL), SKF_OK);
  double from, to;
  skf_flight_span(flight, &from, &to);
  assert_int_equal(skf_flight_at(flight, to, &end), SKF_OK);
  assert_true(end.velocity.x < 0);
  skf_flight_free(flight), skf_world_free(world), skf_field_free(f);
}

/* Every kernel on points and curves: the user's hits are the registry's. A triangle takes too long here. */
static void bounds_make_rays_work(void **state) {
  (void)state;
  uint64_t seed = 9;
  size_t hits = 0;
  for (skf_kernel_type k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = 0; s < SKF_TRIANGLE; s++) {
      mine m;
      make(&m, k, 0.5);
      m.kernel.bound = mirror_bound;
      skf_element e[2] = {{.kernel = m.model, .strength = 1}, {.kernel = m.model, .strength = -0.3}};
      for (int i = 0; i < 2; i++) rnd_primitive(&seed, i ? SKF_POINT : (skf_shape)s, 1, &e[i].primitive);
      skf_field *f[2];
      skf_tracer *t[2];
      assert_int_equal(skf_field_new(e, 2, f), SKF_OK);
      double iso = 0.5 * skf_field_at(f[0], skf_primitive_point(&e[0].primitive, 0.3, 0.4), NULL);
      if (!(iso < 3)) iso = 3;
      e[0].kernel = e[1].kernel = using(&m.kernel);
      assert_int_equal(skf_field_new(e, 2, f + 1), SKF_OK);
      for (int i = 0; i < 2; i++) assert_int_equal(skf_tracer_new(f[i], iso, t + i), SKF_OK);
      for (int i = 0; i < 10; i++) {
        skf_vec3 from = v3_scale(4, rnd_unit(&seed));
        skf_vec3 to = skf_primitive_point(&e[0].primitive, rnd(&seed, 0, 1), rnd(&seed, 0, 1));
        skf_ray ray = {from, v3_sub(to, from), 0, INFINITY};
        skf_hit hit[2][8];
        size_t n[2];
        for (int j = 0; j < 2; j++) assert_int_equal(skf_tracer_all(t[j], &ray, 8, hit[j], n + j, NULL), SKF_OK);
        if (n[0] != n[1]) fail_msg("%s: %zu hits, expected %zu", m.kernel.name, n[1], n[0]);
        for (size_t j = 0; j < n[0] && j < 8; j++) check_close(hit[1][j].t, hit[0][j].t, 1e-8);
        hits += n[0];
      }
      for (int i = 0; i < 2; i++) skf_tracer_free(t[i]), skf_field_free(f[i]);
    }
  assert_true(hits > 150);
}

static void bounds_make_meshes_and_contact_work(void **state) {
  (void)state;
  mine m;
  make(&m, SKF_GAUSSIAN, 1);
  m.kernel.bound = mirror_bound;
  skf_primitive p = {.shape = SKF_SEGMENT, .segment = {{-1, 0, 0}, {1, 0, 0}}};
  skf_field *mine_too = field_of(&p, using(&m.kernel)), *theirs = field_of(&p, m.model);
  skf_mesh_options coarse = {.edge = 0.3};
  skf_mesh a, b;
  assert_int_equal(skf_mesh_field(mine_too, 0.5, &coarse, &a, NULL), SKF_OK);
  assert_int_equal(skf_mesh_field(theirs, 0.5, &coarse, &b, NULL), SKF_OK);
  assert_int_equal(a.triangle_count, b.triangle_count);
  for (size_t i = 0; i < a.vertex_count; i++) check_scaled(v3_dist(a.vertices[i], b.vertices[i]), 0, 1, 1e-9);
  skf_mesh_free(&a), skf_mesh_free(&b);
  skf_contact c[2];
  for (int i = 0; i < 2; i++) {
    skf_attractor body = {.field = i ? theirs : mine_too, .iso = 0.5, .gain = 1};
    skf_world *world;
    skf_flight *flight;
    bool touched = false;
    assert_int_equal(skf_world_new(&body, 1, &world), SKF_OK);
    skf_flight_options options = {.contact = SKF_CONTACT_STOP};
    skf_state start = {0, {0.3, 3, 0}, {0, -1, 0}};
    assert_int_equal(skf_flight_new(world, &options, &start, &flight), SKF_OK);
    for (int k = 0; k < 200 && !touched; k++) assert_int_equal(skf_flight_step(flight, c + i, &touched), SKF_OK);
    assert_true(touched);
    skf_flight_free(flight), skf_world_free(world);
  }
  check_close(c[0].t, c[1].t, 1e-9);
  skf_field_free(mine_too), skf_field_free(theirs);
}

/* Batches are skf_field_at, point for point, whatever the threads. */
static void batches(void **state) {
  (void)state;
  enum { N = 999 };
  skf_element e[3] = {{{.shape = SKF_SEGMENT, .segment = {{-1, 0, 0}, {1, 0, 0}}}, using(&plummer_kernel), 2},
                      {{.shape = SKF_ARC, .arc = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 1, 2}}, {SKF_GAUSSIAN, 1}, 1},
                      {{.shape = SKF_POINT}, using(&cubic_kernel), 1}};
  skf_field *f;
  assert_int_equal(skf_field_new(e, 3, &f), SKF_OK);
  static double p[3][N], F[2][N], g[2][3][N], h[2][6][N];
  uint64_t seed = 10;
  for (int i = 0; i < N; i++)
    for (int k = 0; k < 3; k++) p[k][i] = rnd(&seed, -3, 3);
  int threads = omp_get_max_threads();
  for (int t = 0; t < 2; t++) {
    omp_set_num_threads(t ? 3 : 1);
    double *G[3], *H[6];
    for (int k = 0; k < 3; k++) G[k] = g[t][k];
    for (int k = 0; k < 6; k++) H[k] = h[t][k];
    assert_int_equal(skf_field_eval(f, N, (const double *const[3]){p[0], p[1], p[2]}, F[t], G, H), SKF_OK);
  }
  omp_set_num_threads(threads);
  assert_memory_equal(F[0], F[1], sizeof F[0]);
  assert_memory_equal(g[0], g[1], sizeof g[0]);
  assert_memory_equal(h[0], h[1], sizeof h[0]);
  for (int i = 0; i < N; i++) check_close(F[0][i], skf_field_at(f, v3(p[0][i], p[1][i], p[2][i]), NULL), 1e-14);
  skf_field_free(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_registry_from_outside),
      cmocka_unit_test(others_against_formulas),
      cmocka_unit_test(planes),
      cmocka_unit_test(nonsense_is_refused),
      cmocka_unit_test(no_bounds_no_guesses),
      cmocka_unit_test(bounds_make_rays_work),
      cmocka_unit_test(batches),
      cmocka_unit_test(bounds_make_meshes_and_contact_work),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
