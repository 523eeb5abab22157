/* SPDX-License-Identifier: MIT */
/* Rays through the octree: bodies of many elements against dense sampling, the same hits whatever came before. */
#include "core/alloc.h"
#include "ray/dense.h"
#include "ray/walk.h"

static skf_tracer *tracer_of(const skf_element *e, size_t n, double iso, skf_field **f) {
  skf_tracer *t;
  assert_int_equal(skf_field_new(e, n, f), SKF_OK);
  assert_int_equal(skf_tracer_new(*f, iso, &t), SKF_OK);
  return t;
}

static void done_with(skf_tracer *t, skf_field *f) {
  skf_tracer_free(t);
  skf_field_free(f);
}

/* A cloud of small elements within 1.5 `scale` of the origin, around `at`. */
static void cloud(uint64_t *state, int kernel, int shape, skf_vec3 at, double scale, skf_element *e, size_t n) {
  for (size_t i = 0; i < n; i++) {
    skf_vec3 a = v3_add(at, rnd_vec(state, scale)), b = v3_add(a, rnd_vec(state, 0.3 * scale));
    skf_primitive p = {.shape = (skf_shape)shape};
    switch (p.shape) {
    case SKF_POINT: p.point.at = a; break;
    case SKF_SEGMENT: p.segment = (skf_segment){a, b}; break;
    case SKF_ARC: p.arc = (skf_arc){a, rnd_unit(state), rnd_unit(state), rnd(state, 0.1, 0.3) * scale, 3}; break;
    default: p.triangle = (skf_triangle){{a, b, v3_add(a, rnd_vec(state, 0.3 * scale))}};
    }
    double width = rnd(state, 0.15, 0.35) * scale;
    bool compact = skf_kernel_get((skf_kernel_type)kernel)->compact;
    e[i] = (skf_element){p, {(skf_kernel_type)kernel, compact ? 2 * width : 1 / width}, rnd(state, 0.5, 2)};
  }
}

static skf_ray ray_at(uint64_t *state, skf_vec3 at, double scale, bool inside) {
  skf_vec3 o = inside ? rnd_vec(state, scale) : v3_scale(6 * scale, rnd_unit(state));
  return (skf_ray){v3_add(at, o), v3_sub(rnd_vec(state, 1.2 * scale), o), 0, INFINITY};
}

static void clouds(uint64_t seed, skf_vec3 at, double scale) {
  enum { N = 24, RAYS = 24 };
  uint64_t state = seed;
  size_t hits = 0;
  skf_ray_report report = {0};
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int shape = 0; shape < SKF_PLANE; shape++)
      for (int mixed = 0; mixed < 2; mixed++) {
        skf_element e[N];
        cloud(&state, k, shape, at, scale, e, N);
        for (int i = 0; mixed && i < N; i += 4) e[i].strength = -e[i].strength;
        skf_field *f;
        skf_tracer *t;
        assert_int_equal(skf_field_new(e, N, &f), SKF_OK);
        skf_vec3 near = v3_add(skf_primitive_point(&e[1].primitive, 0.4, 0.3), v3(0.1 * scale, 0.06 * scale, 0));
        double iso = fabs(skf_field_at(f, near, NULL)) * rnd(&state, 0.5, 1);
        assert_int_equal(skf_tracer_new(f, iso, &t), SKF_OK);
        assert_non_null(t->tree);
        int rays = shape == SKF_TRIANGLE ? RAYS / 6 : RAYS;
        for (int i = 0; i < rays; i++) {
          skf_ray r = ray_at(&state, at, scale, i & 1);
          hits += dense_check(t, f, iso, &r, 12 * scale, 150, scale, &report);
        }
        done_with(t, f);
      }
  print_message("%zu hits, %zu cells, %zu evaluations, %zu grazing\n", hits, report.cells, report.evaluations,
                report.grazing);
  assert_true(hits > 500);
  assert_int_equal(report.grazing, 0);
}

static void many_elements(void **unused) {
  (void)unused;
  clouds(21, v3(0, 0, 0), 1);
}

static void small_and_far_off(void **unused) {
  (void)unused;
  clouds(22, v3(3e-5, -2e-5, 1e-5), 1e-7);
}

/* Spikes much thinner than the cube's cells: rays that just touch them or just miss. */
static void needles(void **unused) {
  (void)unused;
  enum { N = 30 };
  uint64_t state = 5;
  skf_element e[N];
  double R = 2e-4;
  for (int i = 0; i < N; i++)
    e[i] = (skf_element){{.shape = SKF_SEGMENT, .segment = {{0, 0, 0}, rnd_unit(&state)}}, {SKF_QUARTIC, R}, 1};
  /* far from its ends a segment's field is 16/15 R (1 - h^2/R^2)^(5/2) */
  double iso = 0.5 * R, radius = R * sqrt(1 - pow(iso * 15 / (16 * R), 0.4));
  skf_field *f;
  skf_tracer *t = tracer_of(e, N, iso, &f);
  for (int k = 0; k < 2000; k++) {
    skf_vec3 a = e[k % N].primitive.segment.to, u = v3_perp(a), w = v3_cross(a, u);
    double turn = rnd(&state, 0, 6), off = radius * (k & 1 ? 1 + 1e-6 : 1 - 1e-6);
    skf_vec3 side = v3_mad(v3_scale(cos(turn), u), sin(turn), w), along = v3_cross(a, side);
    skf_vec3 at = v3_mad(v3_scale(rnd(&state, 0.5, 0.9), a), off, side);
    skf_ray r = {v3_mad(at, -3, along), along, 0, INFINITY};
    skf_hit hits[8];
    size_t n, near = 0;
    assert_int_equal(skf_tracer_all(t, &r, 8, hits, &n, NULL), SKF_OK);
    for (size_t i = 0; i < n && i < 8; i++) near += fabs(hits[i].t - 3) < R;
    assert_int_equal(near, k & 1 ? 0 : 2);
  }
  done_with(t, f);
}

/* The same ray before and after others, by one tracer and by a new one. */
static void history(void **unused) {
  (void)unused;
  enum { N = 60, RAYS = 400 };
  uint64_t state = 7;
  skf_element e[N];
  cloud(&state, SKF_SOFT_OBJECT, SKF_SEGMENT, v3(0, 0, 0), 1, e, N);
  skf_field *f;
  skf_tracer *forward = tracer_of(e, N, 0.08, &f), *backward;
  assert_int_equal(skf_tracer_new(f, 0.08, &backward), SKF_OK);
  static skf_hit first[RAYS], again[RAYS];
  static bool found[RAYS], found_again[RAYS];
  static skf_ray rays[RAYS];
  for (int i = 0; i < RAYS; i++) rays[i] = ray_at(&state, v3(0, 0, 0), 1, false);
#pragma omp parallel for schedule(dynamic) num_threads(4)
  for (int i = 0; i < RAYS; i++) skf_tracer_first(forward, rays + i, first + i, found + i, NULL);
  for (int i = RAYS - 1; i >= 0; i--) skf_tracer_first(backward, rays + i, again + i, found_again + i, NULL);
  size_t hits = 0;
  for (int i = 0; i < RAYS; i++) {
    assert_int_equal(found[i], found_again[i]);
    if (!found[i]) continue;
    assert_memory_equal(&first[i].t, &again[i].t, sizeof first->t);
    assert_memory_equal(&first[i].at, &again[i].at, sizeof first->at);
    assert_memory_equal(&first[i].normal, &again[i].normal, sizeof first->normal);
    hits++;
  }
  assert_true(hits > 50);
  skf_tracer_free(backward);
  done_with(forward, f);
}

/* First crossings are found in other ways than all of them. */
static void first_of_all(void **unused) {
  (void)unused;
  enum { N = 40, RAYS = 300 };
  uint64_t state = 9;
  size_t hits = 0, on = 0;
  for (int k = 0; k < 12; k++) {
    skf_element e[N];
    double scale = k % 3 == 0 ? 1 : k % 3 == 1 ? 1e-7 : 1e7;
    cloud(&state, k & 1 ? SKF_QUARTIC : SKF_SOFT_OBJECT, SKF_POINT, v3(0, 0, 0), scale, e, N);
    if (k & 2) cloud(&state, k & 4 ? SKF_QUARTIC : SKF_SOFT_OBJECT, SKF_SEGMENT, v3(0, 0, 0), scale, e, N / 2);
    for (int i = 0; k & 2 && i < N / 2; i++) e[i].strength /= scale;
    for (int i = 0; i < N; i++) e[i].kernel.param *= k > 5 ? 0.3 : 1;
    skf_field *f;
    skf_tracer *t = tracer_of(e, N, rnd(&state, 0.1, 0.9), &f);
    for (int i = 0; i < RAYS; i++) {
      skf_ray r = ray_at(&state, v3(0, 0, 0), scale, i & 1);
      if (i % 7 == 0) r.t_max = rnd(&state, 0.1, 6) * scale;
      skf_hit all[32], first;
      size_t n;
      bool found;
      assert_int_equal(skf_tracer_all(t, &r, 32, all, &n, NULL), SKF_OK);
      assert_int_equal(skf_tracer_first(t, &r, &first, &found, NULL), SKF_OK);
      assert_int_equal(found, n > 0);
      if (!n) continue;
      hits++;
      check_scaled(first.t, all->t, scale, 1e-12);
      assert_int_equal(first.entering, all->entering);
      /* on from there */
      r.origin = first.at, r.t_max = INFINITY, r.direction = i & 4 ? rnd_unit(&state) : r.direction;
      assert_int_equal(skf_tracer_all(t, &r, 32, all, &n, NULL), SKF_OK);
      assert_int_equal(skf_tracer_first(t, &r, &first, &found, NULL), SKF_OK);
      assert_int_equal(found, n > 0);
      if (!n) continue;
      check_scaled(first.t, all->t, scale, 1e-12);
      on++;
    }
    done_with(t, f);
  }
  assert_true(hits > 500 && on > 100);
}

/* A ball's poles are on the cells' walls: rays inwards from there begin in one cell and go on in the next. */
static void from_walls(void **unused) {
  (void)unused;
  uint64_t state = 3;
  size_t n = 0;
  for (int i = 0; i < 40 * SKF_KERNEL_COUNT; i++) {
    skf_kernel_type kernel = (skf_kernel_type)(i % SKF_KERNEL_COUNT);
    skf_vec3 c = rnd_vec(&state, 1);
    skf_element e = {{.shape = SKF_POINT, .point = {c}}, {kernel, 1}, 1};
    skf_field *f;
    skf_tracer *t = tracer_of(&e, 1, 0.4, &f);
    for (int k = 0; k < 6; k++) {
      double sign = k & 1 ? -1 : 1;
      skf_vec3 d = k < 2 ? v3(sign, 0, 0) : k < 4 ? v3(0, sign, 0) : v3(0, 0, sign);
      skf_hit pole, hit;
      bool found;
      assert_int_equal(skf_tracer_first(t, &(skf_ray){v3_mad(c, -5, d), d, 0, 10}, &pole, &found, NULL), SKF_OK);
      assert_true(found);
      skf_vec3 u = rnd_unit(&state);
      if (v3_dot(u, d) < 0.05) continue;
      assert_int_equal(skf_tracer_first(t, &(skf_ray){pole.at, u, 0, INFINITY}, &hit, &found, NULL), SKF_OK);
      assert_true(found && !hit.entering && hit.t > 0.05);
      n++;
    }
    done_with(t, f);
  }
  assert_true(n > 500);
}

/* Memory that runs out leaves cells unexplored: hits stay, to rounding. */
static void without_memory(void **unused) {
  (void)unused;
  enum { N = 300 };
  uint64_t state = 8;
  static skf_element e[N];
  cloud(&state, SKF_QUARTIC, SKF_POINT, v3(0, 0, 0), 1, e, N);
  skf_field *f;
  skf_tracer *t = tracer_of(e, N, 0.3, &f);
  for (int i = 0; i < 50; i++) {
    skf_ray r = ray_at(&state, v3(0, 0, 0), 1, i & 1);
    skf_hit poor[16], rich[16];
    size_t n, m;
    skf_alloc_fail_after(1 + i % 3);
    assert_int_equal(skf_tracer_all(t, &r, 16, poor, &n, NULL), SKF_OK);
    skf_alloc_fail_after(0);
    assert_int_equal(skf_tracer_all(t, &r, 16, rich, &m, NULL), SKF_OK);
    assert_int_equal(n, m);
    for (size_t k = 0; k < n && k < 16; k++) check_scaled(poor[k].t, rich[k].t, 8.0, 1e-13);
  }
  done_with(t, f);
}

/* Beside the edges of triangles of compact kernels, against Hessians all over random cells. */
static void beside_edges(void **unused) {
  (void)unused;
  uint64_t state = 1848;
  double most = 0;
  size_t beside = 0;
  for (int trial = 0; trial < 6000; trial++) {
    double scale = trial % 4 == 3 ? 1e-7 : trial % 4 == 2 ? 1e7 : 1;
    skf_kernel_type k = trial % 3 == 0 ? SKF_QUARTIC : trial % 3 == 1 ? SKF_SOFT_OBJECT : SKF_METABALL;
    skf_element e = {.kernel = {k, scale * exp(rnd(&state, -2.5, 1))}, .strength = 1};
    rnd_primitive(&state, SKF_TRIANGLE, scale, &e.primitive);
    double R = e.kernel.param, radius = R * exp(rnd(&state, -7, 0));
    skf_vec3 on = skf_primitive_point(&e.primitive, trial % 5 ? rnd(&state, 0, 1) : 1, rnd(&state, 0, 1));
    skf_vec3 c = v3_mad(on, rnd(&state, 0, 1) * R, rnd_unit(&state));
    skf_source s;
    skf_source_init(&e, &s);
    double near = fmax(skf_source_distance(&s, c) * (1 - 1e-12) - radius, 0);
    double bend = s.aside ? skf_source_aside(&s, c, radius, near) : INFINITY;
    skf_source_free(&s);
    if (!(bend < INFINITY)) continue;
    skf_field *f;
    assert_int_equal(skf_field_new(&e, 1, &f), SKF_OK);
    for (int i = 0; i < 8; i++) {
      skf_vec3 g;
      double h[6];
      skf_field_tensor_at(f, v3_mad(c, radius * cbrt(rnd(&state, 0, 1)), rnd_unit(&state)), &g, h);
      for (int n = 0; n < 12; n++) {
        skf_vec3 u = rnd_unit(&state);
        double size = v3_norm(v3(h[0] * u.x + h[1] * u.y + h[2] * u.z, h[1] * u.x + h[3] * u.y + h[4] * u.z,
                                 h[2] * u.x + h[4] * u.y + h[5] * u.z));
        assert_true(size <= bend + 1e-12);
        if (radius < 0.02 * R && bend > 0) most = fmax(most, size / bend);
      }
    }
    skf_field_free(f);
    beside++;
  }
  print_message("%zu cells beside edges, up to %.2f of the bound\n", beside, most);
  assert_true(beside > 500 && most > 0.3);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(many_elements),  cmocka_unit_test(small_and_far_off), cmocka_unit_test(needles),
      cmocka_unit_test(history),        cmocka_unit_test(first_of_all),      cmocka_unit_test(from_walls),
      cmocka_unit_test(without_memory), cmocka_unit_test(beside_edges),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
