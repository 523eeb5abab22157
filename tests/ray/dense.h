/* SPDX-License-Identifier: MIT */
/* Hits against dense samples of F along the ray. */
#ifndef SKF_TESTS_RAY_DENSE_H
#define SKF_TESTS_RAY_DENSE_H

#include "check.h"
#include "random.h"
#include "skelfield/ray.h"
#include <float.h>

enum { DENSE_HITS = 64 };

static inline double dense_value(const skf_field *f, const skf_ray *r, double t) {
  return skf_field_at(f, v3_mad(r->origin, t, v3_unit(r->direction)), NULL);
}

static inline double dense_bisect(const skf_field *f, double iso, const skf_ray *r, double a, double b) {
  bool up = dense_value(f, r, b) > iso;
  for (int i = 0; i < 100; i++) {
    double m = 0.5 * (a + b);
    if (!(m > a && m < b)) break;
    *((dense_value(f, r, m) > iso) == up ? &b : &a) = m;
  }
  return b;
}

/* Sum of the magnitudes that F is made of. */
static inline double dense_size(const skf_field *f, skf_vec3 p) {
  double size = 0;
  for (size_t i = 0; i < skf_field_size(f); i++) {
    skf_field *one;
    assert_int_equal(skf_field_new(skf_field_element(f, i), 1, &one), SKF_OK);
    size += fabs(skf_field_at(one, p, NULL));
    skf_field_free(one);
  }
  return size;
}

/* Every hit is a crossing to rounding; between samples the number of hits has the right parity and, where it is one,
   the right place. Returns the number of hits. */
static inline size_t dense_check(const skf_tracer *tracer, const skf_field *f, double iso, const skf_ray *r,
                                 double upto, int samples, double scale, skf_ray_report *report) {
  skf_hit hits[DENSE_HITS];
  size_t n, k = 0;
  assert_int_equal(skf_tracer_all(tracer, r, DENSE_HITS, hits, &n, report), SKF_OK);
  assert_true(n <= DENSE_HITS);
  for (size_t i = 0; i < n; i++) {
    skf_vec3 g, p = hits[i].at;
    double F = skf_field_at(f, p, &g), coordinates = fabs(p.x) + fabs(p.y) + fabs(p.z) + v3_norm(r->origin);
    double ulp = DBL_EPSILON * coordinates, before = dense_value(f, r, hits[i].t - 4 * ulp);
    bool tight = (before > iso) != (dense_value(f, r, hits[i].t + 4 * ulp) > iso); /* no better place exists */
    if (!tight) check_scaled(F, iso, 4 * dense_size(f, p) + fabs(iso) + coordinates * v3_norm(g), DBL_EPSILON);
    assert_true(hits[i].t >= r->t_min && hits[i].t <= r->t_max);
    assert_true(i == 0 || hits[i].t > hits[i - 1].t);
    check_close(v3_norm(hits[i].normal), 1.0, 1e-14);
    assert_true(v3_dot(hits[i].normal, g) <= 0);
  }
  double ta = r->t_min, Fa = dense_value(f, r, ta);
  for (int q = 1; q <= samples; q++) {
    double tb = r->t_min + (upto - r->t_min) * q / samples, Fb = dense_value(f, r, tb);
    size_t inside = 0;
    for (; k < n && hits[k].t <= tb; k++) inside++;
    bool flip = (Fa > iso) != (Fb > iso);
    if (flip != (inside & 1) && fabs(Fb - iso) > 1e-12 * fabs(iso) && fabs(Fa - iso) > 1e-12 * fabs(iso))
      fail_msg("%zu hits in [%.17g, %.17g], F - iso = %.3g, %.3g", inside, ta, tb, Fa - iso, Fb - iso);
    if (flip && inside == 1) {
      assert_true(hits[k - 1].entering == (Fb > iso));
      check_scaled(hits[k - 1].t, dense_bisect(f, iso, r, ta, tb), scale, 1e-9);
    }
    ta = tb, Fa = Fb;
  }
  return n;
}

/* A random element whose kernel's width is comparable to `scale`. */
static inline skf_element dense_element(uint64_t *state, int kernel, int shape, double scale) {
  skf_element e = {.kernel = {(skf_kernel_type)kernel, 0}, .strength = rnd(state, 0.5, 2)};
  double width = scale * rnd(state, 0.3, 2);
  e.kernel.param = skf_kernel_get(e.kernel.type)->compact ? 2 * width : 1 / width;
  rnd_primitive(state, (skf_shape)shape, scale, &e.primitive);
  return e;
}

#endif
