/* SPDX-License-Identifier: MIT */
/* Hits against dense sampling, for every kernel on every shape. */
#include "ray/dense.h"

static void random_scenes(void **unused) {
  (void)unused;
  uint64_t state = 11;
  size_t hits = 0;
  skf_ray_report report = {0};
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int shape = 0; shape < SKF_SOLID; shape++)
      for (int mixed = 0; mixed < 2; mixed++) {
        skf_element e[2] = {dense_element(&state, k, shape, 1), dense_element(&state, k, SKF_POINT, 1)};
        if (mixed) e[1].strength = -e[1].strength;
        skf_field *f;
        skf_tracer *t;
        assert_int_equal(skf_field_new(e, 2, &f), SKF_OK);
        skf_vec3 near = v3_add(skf_primitive_point(&e->primitive, 0.4, 0.3), v3(0.2, 0.15, 0.1));
        double iso = rnd(&state, 0.3, 1) * skf_field_at(f, near, NULL);
        assert_int_equal(skf_tracer_new(f, iso, &t), SKF_OK);
        for (int i = 0; i < 8; i++) {
          skf_ray r = {rnd_vec(&state, 1.5), v3_scale(rnd(&state, 0.1, 9), rnd_unit(&state)), 0, INFINITY};
          if (i & 1) r.origin = v3_mad(r.origin, -rnd(&state, 1, 3), v3_unit(r.direction));
          hits += dense_check(t, f, iso, &r, 6, 150, 1, &report);
        }
        skf_tracer_free(t);
        skf_field_free(f);
      }
  print_message("%zu hits, %zu cells, %zu evaluations, %zu grazing\n", hits, report.cells, report.evaluations,
                report.grazing);
  assert_true(hits > 300);
  assert_int_equal(report.grazing, 0);
}

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

static skf_element donut(double scale) {
  return (skf_element){.primitive = {.shape = SKF_ARC, .arc = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, scale, 2 * SKF_PI}},
                       .kernel = {SKF_INVERSE, 0},
                       .strength = 1};
}

static size_t hits_of(const skf_tracer *t, skf_vec3 o, skf_vec3 d, skf_hit *hits) {
  skf_ray r = {o, d, 0, INFINITY};
  size_t n;
  assert_int_equal(skf_tracer_all(t, &r, DENSE_HITS, hits, &n, NULL), SKF_OK);
  return n;
}

/* A sphere: every hit is known. */
static void sphere(void **unused) {
  (void)unused;
  uint64_t state = 3;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++) {
    skf_kernel kernel = {(skf_kernel_type)k, skf_kernel_get((skf_kernel_type)k)->compact ? 3 : 0.7};
    skf_element e = {.primitive = {.shape = SKF_POINT}, .kernel = kernel, .strength = 1.5};
    double d[4], radius = 1.3, scale = 1;
    skf_kernel_eval(kernel, radius * radius, d);
    skf_field *f;
    skf_tracer *t = tracer_of(&e, 1, 1.5 * d[0], &f);
    for (int i = 0; i < 300; i++) {
      skf_hit hits[DENSE_HITS];
      skf_vec3 o = rnd_vec(&state, 4), u = rnd_unit(&state);
      double b = v3_dot(o, u), c = v3_norm2(o) - radius * radius, D = b * b - c;
      if (fabs(D) < 1e-6 || fabs(c) < 1e-6) continue;
      size_t want = D < 0 ? 0 : (-b + sqrt(D) > 0) + (-b - sqrt(D) > 0);
      size_t n = hits_of(t, o, v3_scale(3, u), hits);
      assert_int_equal(n, want);
      if (n) check_scaled(hits[n - 1].t, -b + sqrt(D), scale / sqrt(D), 1e-13);
      if (n) assert_false(hits[n - 1].entering);
      for (size_t j = 0; j < n; j++) check_scaled(v3_dist(hits[j].normal, v3_unit(hits[j].at)), 0.0, 1.0, 1e-12);
      /* from the hit itself, on: the start is not found again */
      if (n == 2) {
        skf_hit again[DENSE_HITS];
        assert_int_equal(hits_of(t, hits[0].at, u, again), 1);
        check_scaled(again[0].t, hits[1].t - hits[0].t, 1.0 / sqrt(D), 1e-13);
        assert_int_equal(hits_of(t, hits[0].at, v3_scale(-1, u), again), 0);
        assert_int_equal(hits_of(t, hits[1].at, u, again), 0);
      }
    }
    done_with(t, f);
  }
}

/* Through the hole, along the axis, through the ring itself, tangent to it; inside starts. */
static void through_the_donut(void **unused) {
  (void)unused;
  skf_field *f;
  skf_element e = donut(1);
  skf_hit h[DENSE_HITS];
  skf_tracer *t = tracer_of(&e, 1, 7.38278, &f);
  assert_int_equal(hits_of(t, v3(0, 0, 5), v3(0, 0, -2), h), 0);
  assert_int_equal(hits_of(t, v3(5, 0, 0), v3(-1, 0, 0), h), 4); /* through the singular circle, twice */
  check_close(h[0].at.x, 1.1608440, 1e-6);
  check_close(h[1].at.x, 0.7000009, 1e-6);
  check_close(h[2].at.x, -h[1].at.x, 1e-14);
  check_close(h[3].at.x, -h[0].at.x, 1e-14);
  assert_int_equal(hits_of(t, v3(0, 0, 0), v3(0, 1, 0), h), 2);
  assert_int_equal(hits_of(t, v3(1, 0, 0), v3(0, 1, 0), h), 1);  /* starts on the circle, where F is infinite */
  assert_int_equal(hits_of(t, v3(1, -3, 0), v3(0, 1, 0), h), 2); /* touches the circle */
  double outer = 1.16084399;
  for (int i = 1; i < 12; i++) { /* ever closer to touching the outside: two hits, never one */
    double in = outer - pow(10, -i), out = outer + 1e-6 + pow(10, -i);
    assert_int_equal(hits_of(t, v3(in, -3, 0), v3(0, 1, 0), h), i < 7 && in < 0.7 ? 4 : i < 7 ? 2 : 2);
    assert_int_equal(hits_of(t, v3(out, -3, 0), v3(0, 1, 0), h), 0);
  }
  done_with(t, f);
}

/* The same scene at three scales gives the same hits, scaled. */
static void scales(void **unused) {
  (void)unused;
  uint64_t state = 21;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int i = 0; i < 4; i++) {
      skf_element e[2] = {dense_element(&state, k, SKF_SEGMENT, 1), dense_element(&state, k, SKF_POINT, 1)};
      skf_ray r = {rnd_vec(&state, 2), {0, 0, 0}, 0, INFINITY};
      r.direction = v3_sub(rnd_vec(&state, 0.4), r.origin);
      size_t count[3];
      double t[3][DENSE_HITS];
      for (int j = 0; j < 3; j++) {
        double s = j == 0 ? 1 : j == 1 ? 1e-7 : 1e7;
        bool compact = skf_kernel_get((skf_kernel_type)k)->compact;
        skf_element x[2] = {e[0], e[1]};
        for (int n = 0; n < 2; n++) x[n].kernel.param *= compact ? s : 1 / s;
        x[0].primitive.segment =
            (skf_segment){v3_scale(s, e[0].primitive.segment.from), v3_scale(s, e[0].primitive.segment.to)};
        x[1].primitive.point.at = v3_scale(s, e[1].primitive.point.at);
        /* bring both fields to one unit: the segment's measure has a length in it */
        double unit = k == SKF_INVERSE ? s : k == SKF_INVERSE_SQUARED ? s * s : 1;
        x[0].strength *= unit / s, x[1].strength *= unit;
        skf_field *f, *f1;
        skf_tracer *tr = tracer_of(e, 2, 1, &f1);
        double iso =
            0.5 * skf_field_at(f1, v3_scale(0.5, v3_add(e[0].primitive.segment.from, e[1].primitive.point.at)), NULL);
        done_with(tr, f1);
        tr = tracer_of(x, 2, iso, &f);
        skf_hit h[DENSE_HITS];
        count[j] = hits_of(tr, v3_scale(s, r.origin), v3_scale(s, r.direction), h);
        for (size_t n = 0; n < count[j]; n++) t[j][n] = h[n].t / s;
        done_with(tr, f);
      }
      assert_int_equal(count[0], count[1]);
      assert_int_equal(count[0], count[2]);
      for (size_t n = 0; n < count[0]; n++) {
        check_scaled(t[1][n], t[0][n], 1.0, 1e-9);
        check_scaled(t[2][n], t[0][n], 1.0, 1e-9);
      }
    }
}

/* Times a power of two: the hits are the same, all digits of them. */
static void huge_and_tiny(void **unused) {
  (void)unused;
  static const int powers[] = {-480, -330, -200, 200, 330, 480};
  size_t hits = 0;
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int shape = 0; shape < 3; shape++)
      for (int j = 0; j < 6; j++) {
        double s = ldexp(1, powers[j]), width = skf_kernel_get((skf_kernel_type)k)->compact ? 1.5 : 1.2;
        skf_element e = {.kernel = {(skf_kernel_type)k, width}, .strength = 1}, x;
        e.primitive.shape = (skf_shape[]){SKF_POINT, SKF_SEGMENT, SKF_ARC}[shape];
        if (shape == 1) e.primitive.segment = (skf_segment){{-1, 0, 0}, {1, 0, 0}};
        if (shape == 2) e.primitive.arc = (skf_arc){{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 1, 2 * SKF_PI};
        x = e;
        x.kernel.param *= width > 1.3 ? s : 1 / s;
        if (shape == 1) x.primitive.segment = (skf_segment){{-s, 0, 0}, {s, 0, 0}};
        if (shape == 2) x.primitive.arc.radius = s;
        int dimension = (shape > 0) - (k == SKF_INVERSE) - 2 * (k == SKF_INVERSE_SQUARED);
        double iso = shape == 0 ? 0.4 : shape == 1 ? 1.1 : 1.5;
        skf_field *f, *g;
        skf_tracer *t = tracer_of(&e, 1, iso, &f), *u = tracer_of(&x, 1, ldexp(iso, dimension * powers[j]), &g);
        skf_ray r[9];
        skf_hit first[9], h[DENSE_HITS], l[DENSE_HITS];
        bool found[9], hidden;
        for (int i = 0; i < 9; i++) {
          skf_vec3 o = v3(0.1 * i, -4, 0.02 * i);
          size_t n = hits_of(t, o, v3(0.02, 1, 0.01), h);
          r[i] = (skf_ray){v3_scale(s, o), {0.02, 1, 0.01}, 0, INFINITY};
          assert_int_equal(hits_of(u, r[i].origin, r[i].direction, l), n);
          for (size_t m = 0; m < n; m++) {
            check_close(l[m].t / s, h[m].t, 1e-13);
            check_scaled(v3_dist(v3_scale(1 / s, l[m].at), h[m].at), 0.0, 1.0, 1e-12);
            check_scaled(v3_dist(l[m].normal, h[m].normal), 0.0, 1.0, 1e-10);
          }
          skf_span span[4];
          size_t spans;
          assert_int_equal(skf_tracer_spans(u, r + i, 4, span, &spans, NULL), SKF_OK);
          if (n % 2 == 0) assert_int_equal(2 * spans, n); /* else it starts inside */
          for (size_t m = 0; m < spans && n % 2 == 0; m++)
            assert_true(span[m].in.t == l[2 * m].t && span[m].out.t == l[2 * m + 1].t);
          assert_int_equal(skf_tracer_occluded(u, r + i, &hidden, NULL), SKF_OK);
          assert_true(hidden == (n > 0));
          hits += n;
        }
        assert_int_equal(skf_tracer_first_many(u, 9, r, first, found, NULL), SKF_OK);
        for (int i = 0; i < 9; i++) {
          bool alone;
          assert_int_equal(skf_tracer_first(u, r + i, l, &alone, NULL), SKF_OK);
          assert_true(found[i] == alone);
          if (alone) assert_true(first[i].t == l[0].t && first[i].at.x == l[0].at.x);
          assert_int_equal(hits_of(u, r[i].origin, r[i].direction, l) > 0, alone);
          if (alone) check_close(first[i].t / s, l[0].t / s, 1e-14);
        }
        done_with(t, f), done_with(u, g);
      }
  print_message("huge and tiny: %zu hits\n", hits);
  assert_true(hits > 500);
}

/* A ray keeps its place to rounding of the sphere, however far away it starts. */
static void from_afar(void **unused) {
  (void)unused;
  skf_element e = {.primitive = {.shape = SKF_POINT}, .kernel = {SKF_CAUCHY, 1}, .strength = 1};
  skf_field *f;
  skf_tracer *t = tracer_of(&e, 1, 0.25, &f);
  for (int power = 5; power <= 22; power++) {
    double far = pow(10, power);
    for (int turn = 0; turn < 3; turn++) { /* 3 x - 4 z, 3 z + 4 x are exact where far is */
      skf_vec3 o = turn == 0 ? v3(far, 0.5, 0) : turn == 1 ? v3(0.5, -far, 0) : v3(3 * far, 0.5, 4 * far);
      skf_vec3 d = turn == 0 ? v3(-1, 0, 0) : turn == 1 ? v3(0, 1e-3, 0) : v3(-3, 0, -4);
      skf_ray r = {o, d, 0, INFINITY}, back = {o, v3_scale(-1, d), 0, INFINITY};
      skf_hit h[DENSE_HITS];
      size_t n;
      skf_ray_report report = {0};
      bool found, any;
      assert_int_equal(skf_tracer_all(t, &r, DENSE_HITS, h, &n, &report), SKF_OK);
      assert_int_equal(n, 2);
      assert_int_equal(report.grazing, 0);
      check_close(h[0].t, (turn == 2 ? 5 : 1) * far - sqrt(0.75), 4e-16);
      check_scaled(v3_norm(h[0].at), 1.0, 1.0, 1e-14);
      check_scaled(fabs(turn == 1 ? h[0].at.x : h[0].at.y), 0.5, 1.0, 1e-14);
      skf_hit one;
      assert_int_equal(skf_tracer_first_many(t, 1, &r, &one, &found, NULL), SKF_OK);
      assert_true(found && one.t == h[0].t);
      assert_int_equal(skf_tracer_occluded_many(t, 1, &back, &any, NULL), SKF_OK);
      assert_false(any);
      r.t_max = 0.5 * far;
      assert_int_equal(skf_tracer_occluded(t, &r, &any, NULL), SKF_OK);
      assert_false(any);
    }
  }
  done_with(t, f);
}

/* Lengths that no doubles hold at once: it ends, and what is not decided is counted. */
static void far_apart(void **unused) {
  (void)unused;
  for (int power = 10; power <= 300; power += 10) {
    skf_element e[2] = {{.primitive = {.shape = SKF_POINT}, .kernel = {SKF_CAUCHY, 2.5}, .strength = 1},
                        {.primitive = {.shape = SKF_SEGMENT}, .kernel = {SKF_CAUCHY, 2.5}, .strength = 1}};
    e[0].primitive.point.at = v3(0, 0, pow(10, power));
    e[1].primitive.segment = (skf_segment){{-2, 0, 0}, {2, 0, 0}};
    skf_field *f;
    skf_tracer *t;
    assert_int_equal(skf_field_new(e, 2, &f), SKF_OK);
    assert_int_equal(skf_tracer_new(f, 0.35, &t), power <= 150 ? SKF_OK : SKF_ERR_RANGE);
    if (power > 150) {
      skf_field_free(f);
      continue;
    }
    skf_ray r = {{0.1, 0.02, 5}, {0, 0.001, -1}, 0, INFINITY};
    skf_hit h[DENSE_HITS];
    size_t n;
    skf_ray_report report = {0};
    assert_int_equal(skf_tracer_all(t, &r, DENSE_HITS, h, &n, &report), SKF_OK);
    assert_true(n == 2 || report.grazing > 0);

    assert_true(report.cells < 10000000);
    done_with(t, f);
  }
}

/* Planes: the surface has no bounds, the ray may run for ever. */
static void planes(void **unused) {
  (void)unused;
  uint64_t state = 31;
  size_t hits = 0;
  skf_ray_report report = {0};
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int trial = 0; trial < 12; trial++) {
      skf_element e[3] = {dense_element(&state, k, SKF_PLANE, 1),
                          dense_element(&state, (k + trial) % SKF_KERNEL_COUNT, SKF_PLANE, 1),
                          dense_element(&state, trial % SKF_KERNEL_COUNT, SKF_POINT, 1)};
      if (trial & 1) e[0].strength = -e[0].strength;
      if (trial & 2) e[2].strength = -e[2].strength;
      skf_field *f;
      size_t n = trial % 3 ? 3 : 1;
      double iso = trial % 4 == 3 ? 0 : rnd(&state, -3, 3);
      skf_tracer *t = tracer_of(e, n, iso, &f);
      for (int i = 0; i < 8; i++) {
        skf_ray r = {rnd_vec(&state, 1.5), rnd_unit(&state), 0, INFINITY};
        if (i == 0) r.direction = v3_perp(v3_unit(e[0].primitive.plane.normal)); /* along it */
        hits += dense_check(t, f, iso, &r, 40, 600, 1, &report);
      }
      done_with(t, f);
    }
  print_message("planes: %zu hits, %zu grazing\n", hits, report.grazing);
  assert_true(hits > 200);
}

/* A tangent is no crossing, and not searched for ever. */
static void tangents(void **unused) {
  (void)unused;
  skf_element e = {.primitive = {.shape = SKF_POINT, .point = {{0, 0, 0}}}, .kernel = {SKF_INVERSE, 0}, .strength = 1};
  skf_field *f;
  skf_tracer *t = tracer_of(&e, 1, 1, &f);
  for (int i = 0; i < 60; i++) {
    double phi = 0.1 * i, c = cos(phi), s = sin(phi);
    skf_ray r = {{c + 3 * s, s - 3 * c, 0}, {-s, c, 0}, 0, INFINITY};
    skf_hit h[DENSE_HITS];
    size_t n;
    skf_ray_report report = {0};
    assert_int_equal(skf_tracer_all(t, &r, DENSE_HITS, h, &n, &report), SKF_OK);
    for (size_t k = 0; k < n; k++) check_scaled(h[k].t, 3, 1, 1e-7); /* rounding of the ray itself */
    assert_in_range(report.cells, 1, 3000);
  }
  done_with(t, f);
}

/* One plane: hits in closed form, however far. */
static void one_plane(void **unused) {
  (void)unused;
  skf_element e = {
      .primitive = {.shape = SKF_PLANE, .plane = {{0, 0, 0}, {0, 0, 1}}}, .kernel = {SKF_INVERSE, 0}, .strength = 1};
  skf_field *f;
  skf_hit h[DENSE_HITS];
  skf_tracer *t = tracer_of(&e, 1, -2 * SKF_PI * 1e9, &f);
  assert_int_equal(hits_of(t, v3(0, 0, 3), v3(0, 0, -1), h), 1);
  check_close(h[0].t, 1e9 + 3, 1e-15);
  assert_int_equal(hits_of(t, v3(0, 0, 3), v3(1, 0, 1), h), 1);
  check_close(h[0].at.z, 1e9, 1e-14);
  assert_int_equal(hits_of(t, v3(0, 0, 2e9), v3(0, 0, -1), h), 2);
  check_close(h[1].at.z, -1e9, 1e-14);
  assert_int_equal(hits_of(t, v3(0, 0, 3), v3(1, 0, 0), h), 0);
  done_with(t, f);
  t = tracer_of(&e, 1, 0, &f); /* F touches 0 at the plane and does not cross it */
  assert_int_equal(hits_of(t, v3(0.3, 0, 1.7), v3(0.1, 0.2, -1), h), 0);
  done_with(t, f);
  e.kernel.type = SKF_INVERSE_SQUARED; /* F = -2 pi ln |z| = iso at |z| = e */
  t = tracer_of(&e, 1, -2 * SKF_PI, &f);
  assert_int_equal(hits_of(t, v3(0, 0, 5), v3(0, 0, -1), h), 2);
  check_close(h[0].at.z, exp(1), 1e-14);
  done_with(t, f);
}

/* First and occluded agree with all; capacity is respected; what is wrong is refused. */
static void queries(void **unused) {
  (void)unused;
  skf_element e = donut(1);
  skf_field *f;
  skf_tracer *t = tracer_of(&e, 1, 7, &f);
  uint64_t state = 8;
  for (int i = 0; i < 500; i++) {
    skf_ray r = {rnd_vec(&state, 2), rnd_unit(&state), 0, rnd(&state, 0, 1) < 0.5 ? INFINITY : rnd(&state, 0.5, 3)};
    skf_hit h[DENSE_HITS], one;
    size_t n, m;
    bool found, hidden;
    skf_ray_report a = {0}, b = {0};
    assert_int_equal(skf_tracer_all(t, &r, DENSE_HITS, h, &n, &a), SKF_OK);
    assert_int_equal(skf_tracer_all(t, &r, 1, &one, &m, NULL), SKF_OK);
    assert_int_equal(m, n);
    assert_int_equal(skf_tracer_first(t, &r, &one, &found, &b), SKF_OK);
    assert_int_equal(skf_tracer_occluded(t, &r, &hidden, NULL), SKF_OK);
    assert_true(found == (n > 0) && hidden == found && b.cells <= a.cells);
    if (n) assert_true(one.t == h[0].t && one.entering == h[0].entering);
    if (n) assert_true(h[n - 1].t <= r.t_max);
  }
  skf_ray bad[] = {{{0, 0, 0}, {0, 0, 0}, 0, 1},
                   {{NAN, 0, 0}, {1, 0, 0}, 0, 1},
                   {{0, 0, 0}, {INFINITY, 0, 0}, 0, 1},
                   {{0, 0, 0}, {1, 0, 0}, 0, NAN}};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    bool found;
    assert_int_equal(skf_tracer_occluded(t, bad + i, &found, NULL), SKF_ERR_ARG);
  }
  done_with(t, f);
  skf_tracer *none;
  assert_int_equal(skf_field_new(NULL, 0, &f), SKF_OK);
  assert_int_equal(skf_tracer_new(f, NAN, &none), SKF_ERR_ARG);
  for (int iso = -1; iso < 2; iso++) {
    skf_hit h[1];
    assert_int_equal(skf_tracer_new(f, iso, &none), SKF_OK);
    assert_int_equal(hits_of(none, v3(1, 2, 3), v3(1, 0, 0), h), 0);
    skf_tracer_free(none);
  }
  skf_field_free(f);
}

/* Rays along a thin segment and in a triangle, from within and from before: few cells, however thin they are. */
static void along(void **unused) {
  (void)unused;
  skf_element e[2] = {{.kernel = {SKF_INVERSE_SQUARED, 0}, .strength = 1, .primitive = {.shape = SKF_SEGMENT}},
                      {.kernel = {SKF_INVERSE_SQUARED, 0}, .strength = 1, .primitive = {.shape = SKF_TRIANGLE}}};
  e[0].primitive.segment = (skf_segment){{0.3, -0.1, 0.2}, {1.7, 0.9, -0.4}};
  e[1].primitive.triangle = (skf_triangle){{{0, 0, 3}, {2, 0, 3}, {0.3, 1, 3.1}}};
  skf_field *f;
  skf_tracer *t = tracer_of(e, 2, 1e8, &f);
  for (int from = 0; from < 2; from++) {
    skf_vec3 d = v3_sub(e[0].primitive.segment.to, e[0].primitive.segment.from);
    skf_ray r = {v3_mad(e[0].primitive.segment.from, from ? -1 : 0.3, d), d, 0, INFINITY};
    skf_hit hits[DENSE_HITS];
    size_t n;
    skf_ray_report report = {0};
    assert_int_equal(skf_tracer_all(t, &r, DENSE_HITS, hits, &n, &report), SKF_OK);
    assert_int_equal(n, from ? 2 : 1);
    check_close(hits[n - 1].t, (from ? 2 : 0.7) * v3_norm(d), 1e-7);
    assert_true(report.cells < 20000); /* once 3e8 */
  }
  done_with(t, f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sphere),        cmocka_unit_test(through_the_donut), cmocka_unit_test(scales),
      cmocka_unit_test(planes),        cmocka_unit_test(one_plane),         cmocka_unit_test(tangents),
      cmocka_unit_test(queries),       cmocka_unit_test(random_scenes),     cmocka_unit_test(along),
      cmocka_unit_test(huge_and_tiny), cmocka_unit_test(from_afar),         cmocka_unit_test(far_apart)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
