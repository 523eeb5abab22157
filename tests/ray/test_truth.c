/* SPDX-License-Identifier: MIT */
/* Hits on sums of points against samples in long double, 256 to each length over which the field changes; packets
   against single rays. */
#include "ray/dense.h"
#include <stdlib.h>
#include <string.h>

enum { MOST = 40, HITS = 128 };

static long double law(skf_kernel k, long double w) {
  long double R = k.param, y = w / (R * R), u = sqrtl(y), m = 1 - y;
  switch (k.type) {
  case SKF_CAUCHY: return 1 / ((1 + w * R * R) * (1 + w * R * R));
  case SKF_GAUSSIAN: return expl(-R * R * w);
  case SKF_INVERSE: return 1 / sqrtl(w);
  case SKF_INVERSE_SQUARED: return 1 / w;
  case SKF_METABALL: return u >= 1 ? 0 : 3 * u <= 1 ? 1 - 3 * y : 1.5L * (1 - u) * (1 - u);
  case SKF_SOFT_OBJECT: return m <= 0 ? 0 : m * m * (5 + 4 * m) / 9;
  default: return m <= 0 ? 0 : m * m;
  }
}

typedef struct scene {
  skf_element e[MOST];
  size_t n;
  double iso, width; /* width: the least over which F changes */
  skf_field *field;
  skf_tracer *tracer;
} scene;

static long double truth(const scene *s, const skf_ray *r, long double t) {
  skf_vec3 d = r->direction;
  long double F = -s->iso, x = d.x, y = d.y, z = d.z, per = 1 / sqrtl(x * x + y * y + z * z);
  for (size_t i = 0; i < s->n; i++) {
    skf_vec3 c = s->e[i].primitive.point.at;
    long double dx = r->origin.x + t * per * x - c.x, dy = r->origin.y + t * per * y - c.y,
                dz = r->origin.z + t * per * z - c.z;
    F += s->e[i].strength * law(s->e[i].kernel, dx * dx + dy * dy + dz * dz);
  }
  return F;
}

static void make(scene *s) {
  assert_int_equal(skf_field_new(s->e, s->n, &s->field), SKF_OK);
  assert_int_equal(skf_tracer_new(s->field, s->iso, &s->tracer), SKF_OK);
}

static void drop(scene *s) {
  skf_tracer_free(s->tracer);
  skf_field_free(s->field);
}

/* Points of one kernel, or of several, in a cube of half-width L. */
static void cloud(scene *s, uint64_t *state, int kernel, size_t n, double L) {
  s->n = n, s->width = INFINITY;
  for (size_t i = 0; i < n; i++) {
    skf_kernel k = {(skf_kernel_type)(kernel < 0 ? SKF_SOFT_OBJECT + (int)(i & 1) : kernel), 0, NULL};
    bool compact = skf_kernel_get(k.type)->compact;
    double width = L * rnd(state, 0.15, 0.6) / (n > 4 ? 1.5 : 1);
    k.param = compact ? 2 * width : 1 / width;
    double weight = k.type == SKF_INVERSE ? width : k.type == SKF_INVERSE_SQUARED ? width * width : 1;
    s->e[i] = (skf_element){.primitive = {.shape = SKF_POINT, .point = {rnd_vec(state, L)}},
                            .kernel = k,
                            .strength = weight * rnd(state, 0.6, 1.4)};
    s->width = fmin(s->width, width);
  }
}

/* The number of crossings and each of their places; `slack`: |F - iso| that samples cannot tell from rounding. */
static size_t compare(const scene *s, const skf_ray *r, double L, skf_ray_report *report) {
  skf_hit hits[HITS];
  size_t n, k = 0, found = 0;
  assert_int_equal(skf_tracer_all(s->tracer, r, HITS, hits, &n, report), SKF_OK);
  assert_true(n <= HITS);
  double upto = 8 * L;
  int samples = (int)fmin(256 * upto / s->width, 20000);
  bool before = truth(s, r, r->t_min) > 0;
  for (int i = 1; i <= samples; i++) {
    long double b = upto * (long double)i / samples, a = upto * (long double)(i - 1) / samples;
    bool now = truth(s, r, b) > 0;
    if (now == before) continue;
    while (b - a > 1e-17L * L) {
      long double m = 0.5L * (a + b);
      if (m <= a || m >= b) break;
      *((truth(s, r, m) > 0) == now ? &b : &a) = m;
    }
    if (k == n) fail_msg("missed a crossing at %.17Lg of %zu", b, n);
    check_scaled(hits[k].t, (double)b, L, 1e-9);
    assert_int_equal(hits[k].entering, now);
    k++, found++, before = now;
  }
  /* what samples leap over comes in pairs that are closer than a step */
  for (; k + 1 < n; k += 2) assert_true(hits[k + 1].t - hits[k].t < 2 * upto / samples);
  assert_int_equal(k, n);
  return found;
}

static void points_of_every_kernel(void **unused) {
  (void)unused;
  uint64_t state = 41;
  size_t found = 0;
  skf_ray_report report = {0};
  static const double scales[] = {1, 1e-7, 1e7};
  for (int kernel = -1; kernel < SKF_KERNEL_COUNT; kernel++)
    for (int many = 0; many < 3; many++)
      for (int q = 0; q < 3; q++) {
        scene s;
        double L = scales[q];
        cloud(&s, &state, kernel, many == 0 ? 2 : many == 1 ? 5 : 24, L);
        skf_field *f;
        assert_int_equal(skf_field_new(s.e, s.n, &f), SKF_OK);
        s.iso =
            rnd(&state, 0.5, 0.9) * skf_field_at(f, v3_mad(s.e[0].primitive.point.at, s.width, rnd_unit(&state)), NULL);
        skf_field_free(f);
        make(&s);
        for (int i = 0; i < 7; i++) {
          skf_ray r = {v3_scale(3 * L, rnd_unit(&state)), {0, 0, 0}, 0, INFINITY};
          skf_vec3 aim = i & 1 ? s.e[i % (int)s.n].primitive.point.at : rnd_vec(&state, L);
          r.direction = v3_sub(v3_mad(aim, i & 1 ? 0.1 * s.width : 0, rnd_unit(&state)), r.origin);
          if (i == 4) r.origin = rnd_vec(&state, L);                                   /* anywhere, inside too */
          if (i == 5) r.origin = s.e[0].primitive.point.at, r.direction = v3(0, 1, 0); /* from a point, along an axis */
          if (i == 5 && skf_kernel_get(s.e[0].kernel.type)->singular) continue;
          if (i == 6) r.direction = v3_sub(s.e[1].primitive.point.at, r.origin); /* through a point */
          if (i == 6 && skf_kernel_get(s.e[1].kernel.type)->singular) continue;
          found += compare(&s, &r, L, &report);
        }
        drop(&s);
      }
  print_message("%zu crossings, %zu grazing\n", found, report.grazing);
  assert_true(found > 500);
  assert_int_equal(report.grazing, 0);
}

/* Rays that pass one ball of a cloud of one at 1 +- 10^-k of its radius. */
static void tangents_to_a_ball(void **unused) {
  (void)unused;
  uint64_t state = 42;
  for (int kernel = SKF_SOFT_OBJECT; kernel <= SKF_QUARTIC; kernel++)
    for (int i = 0; i < 40; i++) {
      scene s = {.n = 1, .width = 1};
      double d[4], radius = rnd(&state, 0.2, 0.8);
      skf_vec3 c = rnd_vec(&state, 1), u = rnd_unit(&state), side = v3_perp(u);
      s.e[0] = (skf_element){
          .primitive = {.shape = SKF_POINT, .point = {c}}, .kernel = {(skf_kernel_type)kernel, 1}, .strength = 1};
      skf_kernel_eval(s.e[0].kernel, radius * radius, d);
      s.iso = d[0];
      make(&s);
      for (int k = 1; k < 13; k++)
        for (int sign = -1; sign <= 1; sign += 2) {
          skf_hit h[4];
          size_t n;
          double off = radius * (1 + sign * pow(10, -k));
          skf_ray r = {v3_mad(v3_mad(c, off, side), -3, u), u, 0, INFINITY};
          assert_int_equal(skf_tracer_all(s.tracer, &r, 4, h, &n, NULL), SKF_OK);
          assert_int_equal(n, sign < 0 ? 2 : 0);
          if (n)
            check_scaled(h[1].t - h[0].t, 2 * sqrt((radius - off) * (radius + off)), 1,
                         1e-9 + 1e-14 * pow(10, 0.5 * k));
        }
      drop(&s);
    }
}

/* A ray that starts on a hit goes on to the next one, in any direction. */
static void from_the_surface(void **unused) {
  (void)unused;
  uint64_t state = 43;
  size_t rays = 0;
  for (int kernel = 0; kernel < SKF_KERNEL_COUNT; kernel++) {
    scene s;
    cloud(&s, &state, kernel, 6, 1);
    s.iso = 0.45;
    make(&s);
    for (int i = 0; i < 40; i++) {
      skf_ray r = {v3_scale(3, rnd_unit(&state)), {0, 0, 0}, 0, INFINITY};
      r.direction = v3_sub(s.e[i % 6].primitive.point.at, r.origin);
      skf_hit h[16], on[16];
      size_t n, m;
      assert_int_equal(skf_tracer_all(s.tracer, &r, 16, h, &n, NULL), SKF_OK);
      for (size_t k = 0; k < n; k++) {
        skf_ray next = {h[k].at, r.direction, 0, INFINITY};
        assert_int_equal(skf_tracer_all(s.tracer, &next, 16, on, &m, NULL), SKF_OK);
        assert_int_equal(m, n - k - 1);
        for (size_t j = 0; j < m; j++) check_scaled(on[j].t, h[k + 1 + j].t - h[k].t, 1, 1e-9);
        rays++;
      }
    }
    drop(&s);
  }
  assert_true(rays > 300);
}

/* Spans against crossings, and against F in the middle of each and between them. */
static void spans(void **unused) {
  (void)unused;
  uint64_t state = 45;
  size_t whole = 0, started = 0, ended = 0, between = 0;
  for (int kernel = -1; kernel < SKF_KERNEL_COUNT; kernel++) {
    scene s;
    cloud(&s, &state, kernel, 8, 1);
    s.iso = 0.3;
    make(&s);
    for (int i = 0; i < 120; i++) {
      skf_ray r = {rnd_vec(&state, 1.2), rnd_unit(&state), rnd(&state, -2, 0), rnd(&state, 0.01, 4)};
      if (i & 1) r.t_min = 0, r.t_max = i & 2 ? INFINITY : 0.02;
      skf_span in[16];
      skf_hit h[32];
      size_t n, m, k = 0;
      assert_int_equal(skf_tracer_spans(s.tracer, &r, 16, in, &n, NULL), SKF_OK);
      assert_int_equal(skf_tracer_all(s.tracer, &r, 32, h, &m, NULL), SKF_OK);
      double before = r.t_min;
      for (size_t j = 0; j < n; j++) {
        double far = fmin(in[j].out.t, 10);
        assert_true(in[j].in.t < in[j].out.t && in[j].in.t >= before);
        assert_true(truth(&s, &r, 0.5L * (in[j].in.t + far)) > 0);
        if (in[j].in.t > before) assert_true(truth(&s, &r, 0.5L * (in[j].in.t + before)) < 0), between++;
        assert_int_equal(in[j].starts_inside, j == 0 && truth(&s, &r, r.t_min) > 0);
        if (!in[j].starts_inside) assert_true(in[j].in.t == h[k++].t);
        if (!in[j].ends_inside) assert_true(in[j].out.t == h[k++].t);
        if (in[j].ends_inside) assert_true(j == n - 1 && in[j].out.t == r.t_max), ended++;
        started += in[j].starts_inside;
        whole += in[j].starts_inside && in[j].ends_inside;
        before = in[j].out.t;
      }
      assert_int_equal(k, m);
      if (!n) assert_true(truth(&s, &r, r.t_min) < 0);
      size_t all;
      assert_int_equal(skf_tracer_spans(s.tracer, &r, 0, NULL, &all, NULL), SKF_OK);
      assert_int_equal(all, n);
    }
    drop(&s);
  }
  assert_true(whole > 20 && started > 50 && ended > 50 && between > 100);
}

static bool same(const skf_hit *a, const skf_hit *b) {
  return !memcmp(&a->t, &b->t, sizeof a->t) && !memcmp(&a->at, &b->at, sizeof a->at) &&
         !memcmp(&a->normal, &b->normal, sizeof a->normal) && a->entering == b->entering;
}

/* Many rays at once, in any company and by any instructions: what each alone meets. */
static void packets(void **unused) {
  (void)unused;
  enum { RAYS = 1500 };
  static skf_ray rays[RAYS];
  static skf_hit alone[RAYS], hits[RAYS];
  static bool met[RAYS], found[RAYS], hidden[RAYS];
  uint64_t state = 44;
  for (int kernel = -1; kernel < SKF_KERNEL_COUNT; kernel++) {
    scene s;
    cloud(&s, &state, kernel, 30, 1);
    s.iso = kernel == SKF_INVERSE || kernel == SKF_INVERSE_SQUARED ? 6 : 0.45;
    make(&s);
    for (int i = 0; i < RAYS; i++) {
      bool camera = i < RAYS / 2; /* a row of pixels, or any rays */
      rays[i] = (skf_ray){camera ? v3(0.5, 0.4, -4) : rnd_vec(&state, 2), rnd_unit(&state), 0, INFINITY};
      if (camera) rays[i].direction = v3(-0.4 + 1.2 * i / RAYS, 0.1 * (i % 7) - 0.3, 1);
      if (i % 97 == 5) rays[i].t_max = rnd(&state, 0.1, 4);
      if (i % 131 == 7) rays[i].origin.x = 1e9; /* too far off for the octree */
      if (i % 201 == 9) rays[i].direction = v3(0, 0, i & 1 ? 1 : -1);
    }
    skf_ray_report one = {0}, all = {0};
    for (int i = 0; i < RAYS; i++) {
      bool dark;
      assert_int_equal(skf_tracer_first(s.tracer, rays + i, alone + i, met + i, &one), SKF_OK);
      assert_int_equal(skf_tracer_occluded(s.tracer, rays + i, &dark, NULL), SKF_OK);
      assert_int_equal(dark, met[i]);
    }
    for (int isa = 0; isa < 2; isa++) {
      skf_tracer *t;
      if (isa) setenv("SKELFIELD_ISA", "scalar", 1);
      assert_int_equal(skf_tracer_new(s.field, s.iso, &t), SKF_OK);
      unsetenv("SKELFIELD_ISA");
      for (int shift = 0; shift < 3; shift++) {
        size_t n = (size_t)(RAYS - shift);
        assert_int_equal(skf_tracer_first_many(t, n, rays + shift, hits, found, isa || shift ? NULL : &all), SKF_OK);
        assert_int_equal(skf_tracer_occluded_many(t, n, rays + shift, hidden, NULL), SKF_OK);
        for (size_t i = 0; i < n; i++) {
          assert_int_equal(found[i], met[i + (size_t)shift]);
          assert_int_equal(hidden[i], found[i]);
          if (found[i]) assert_true(same(hits + i, alone + i + shift));
        }
      }
      skf_tracer_free(t);
    }
    assert_memory_equal(&one, &all, sizeof one);
    /* a bad one spoils no other */
    rays[3].direction = v3(0, 0, 0);
    assert_int_equal(skf_tracer_first_many(s.tracer, 8, rays, hits, found, NULL), SKF_ERR_ARG);
    for (int i = 0; i < 8; i++) assert_int_equal(found[i], i != 3 && met[i]);
    drop(&s);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(points_of_every_kernel), cmocka_unit_test(tangents_to_a_ball),
                                     cmocka_unit_test(from_the_surface), cmocka_unit_test(spans),
                                     cmocka_unit_test(packets)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
