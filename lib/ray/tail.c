/* SPDX-License-Identifier: MIT */
/* The rest of a ray, out to infinity: needed where the surface is not bounded. */
#include "core/vec3.h"
#include "ray/walk.h"

typedef struct range {
  double lo, hi;
} range;

static bool is_drifting(const skf_source *s) {
  return s->element.primitive.shape == SKF_PLANE &&
         skf_kernel_get(s->element.kernel.type)->singular; /* users' kernels have no planes here */
}

/* Planes of the singular kernels: sum of -2 pi w |z| and -2 pi w ln |z|. Encloses it beyond t. */
static range drift(const skf_walk *w, double t) {
  double value = 0, B = 0, lo = 0, hi = 0; /* slope of the linear ones; t times the slope of the others */
  for (size_t i = 0; i < w->tracer->n; i++) {
    const skf_source *s = w->tracer->sources + i;
    if (!is_drifting(s)) continue;
    bool linear = s->element.kernel.type == SKF_INVERSE;
    double z0 = v3_dot(v3_sub(w->origin, s->a), s->b), dz = skf_source_descent(s, w->direction), z = z0 + t * dz;
    double c = -2 * SKF_PI * s->weight;
    if (dz * z < 0) return (range){-INFINITY, INFINITY}; /* not yet past it */
    value += linear ? c * fabs(z) : c * log(fabs(z));
    if (linear) {
      B += c * fabs(dz);
    } else if (dz != 0) {
      double ratio = t * dz / z; /* goes to 1 monotonically */
      lo += fmin(c * ratio, c), hi += fmax(c * ratio, c);
    }
  }
  if (isnan(value)) return (range){-INFINITY, INFINITY};
  bool rises = B * t + lo >= 0 && B >= 0, falls = B * t + hi <= 0 && B <= 0;
  return (range){rises ? value : -INFINITY, falls ? value : INFINITY};
}

/* The others: they fade, or stay what they are for planes along the ray. */
static range fading(const skf_walk *w, double t) {
  range r = {0, 0};
  skf_vec3 p = v3_mad(w->origin, t, w->direction);
  for (size_t i = w->tracer->linear; i < w->tracer->n; i++) {
    const skf_source *s = w->tracer->sources + i;
    double near, far = INFINITY;
    if (is_drifting(s)) continue;
    if (s->element.primitive.shape == SKF_PLANE) {
      double z = v3_dot(v3_sub(p, s->a), s->b), dz = skf_source_descent(s, w->direction);
      near = z * dz >= 0 ? fabs(z) : 0;
      if (dz == 0) far = fabs(z);
    } else {
      double past = v3_dot(v3_sub(p, s->middle), w->direction), d = v3_dist(p, s->middle);
      if (past < 0) d = sqrt(fmax(d * d - past * past, 0));
      near = fmax(d * (1 - 1e-12) - s->reach, 0);
    }
    skf_grade g = skf_source_grade(s, near, far);
    r.lo += skf_weight_times(s->least, s->least > 0 ? g.below : g.above.value);
    r.hi += skf_weight_times(s->most, s->most > 0 ? g.above.value : g.below);
  }
  return r;
}

/* When everything fades to iso = 0 and the signs are mixed, the slowest power decides: encloses its coefficient. */
static bool leading_sign(const skf_walk *w, double t) {
  static const int powers[SKF_KERNEL_COUNT] = {
      [SKF_CAUCHY] = 4, [SKF_INVERSE] = 1, [SKF_INVERSE_SQUARED] = 2}; /* 0: faster than any */
  int slowest = 0;
  range c = {0, 0};
  for (size_t i = 0; i < w->tracer->n; i++) {
    if (w->tracer->sources[i].element.kernel.type == SKF_USER_KERNEL) return false; /* its law is not known */
    int k = powers[w->tracer->sources[i].element.kernel.type];
    if (k && (!slowest || k < slowest)) slowest = k;
  }
  for (size_t i = 0; i < w->tracer->n; i++) {
    const skf_source *s = w->tracer->sources + i;
    double R = v3_dist(s->middle, w->origin) + s->reach, near = t - R, far = t + R, scale = pow(t, slowest), d[4], e[4];
    if (s->element.primitive.shape == SKF_PLANE || !(near > 0.5 * t)) return false;
    skf_kernel_eval(s->element.kernel, near * near, d);
    skf_kernel_eval(s->element.kernel, far * far, e);
    double a = s->measure * scale * d[0], b = s->measure * scale * e[0], limit = a;
    if (powers[s->element.kernel.type] == slowest) {
      double width = skf_kernel_width(s->element.kernel);
      limit = s->measure * (width > 0 ? pow(width, slowest) : 1);
    } else if (t < 8 * skf_kernel_width(s->element.kernel)) {
      return false; /* r^k h(r) may still rise */
    } else {
      b = 0;
    }
    double least = fmin(fmin(a, b), limit), most = fmax(fmax(a, b), limit);
    c.lo += s->least * (s->least > 0 ? least : most), c.hi += s->most * (s->most > 0 ? most : least);
  }
  return c.lo > 0 || c.hi < 0;
}

bool skf_walk_tail_clear(const skf_walk *w, double t) {
  range d = drift(w, t), f = fading(w, t);
  double iso = w->tracer->iso, lo = d.lo + f.lo, hi = d.hi + f.hi;
  if (hi <= iso || lo >= iso) return true;
  return iso == 0 && leading_sign(w, t);
}
