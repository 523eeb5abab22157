/* SPDX-License-Identifier: MIT */
/* Rays made ready; those that can go through the octree do so side by side, the others alone. */
#include "ray/ask.h"
#include "core/alloc.h"
#include "core/vec3.h"
#include <float.h>

static double larger(double a, double b) { return a > b ? a : b; }
static double smaller(double a, double b) { return a < b ? a : b; }

static double largest(skf_vec3 a) { return larger(fabs(a.x), larger(fabs(a.y), fabs(a.z))); }

/* v3_unit, to the bit */
static skf_vec3 unit(skf_vec3 a) {
  double m = largest(a);
  if (!(m > 0)) return a;
  a = v3(a.x / m, a.y / m, a.z / m);
  double n = v3_norm(a);
  return v3(a.x / n, a.y / n, a.z / n);
}

/* The part of the ray inside the region. */
static bool clip(const skf_tracer *t, const skf_walk *w, double *from, double *to) {
  if (t->reach == SKF_ERR_EMPTY) return false;
  for (int i = 0; i < 3 && t->reach == SKF_OK; i++) {
    double o = v3_get(w->origin, i), d = v3_get(w->direction, i);
    double lo = v3_get(t->region.lo, i) - o, hi = v3_get(t->region.hi, i) - o;
    if (d == 0) {
      if (lo > 0 || hi < 0) return false;
      continue;
    }
    double slack = 4 * DBL_EPSILON * fabs(o), per = 1 / d, enter = (lo - slack) * per, leave = (hi + slack) * per;
    *from = larger(*from, smaller(enter, leave)), *to = smaller(*to, larger(enter, leave));
  }
  return *from <= *to;
}

/* The next place where the ray meets a linear plane; sets the sides up to there. */
static double next_break(const skf_walk *w, double from, double to, double *side) {
  for (size_t i = 0; i < w->tracer->linear; i++) {
    const skf_source *s = w->tracer->sources + i;
    double z = v3_dot(v3_sub(w->origin, s->a), s->b), dz = skf_source_descent(s, w->direction), t = -z / dz;
    side[i] = dz == 0 ? (z < 0 ? -1 : 1) : (from < t) == (dz > 0) ? -1 : 1;
    if (dz != 0 && t > from) to = fmin(to, t);
  }
  return to;
}

/* A length to begin with, where the ray goes on for ever. */
static double first_stride(const skf_walk *w, double from) {
  skf_vec3 p = v3_mad(w->origin, from, w->direction);
  double stride = 0;
  for (size_t i = 0; i < w->tracer->n; i++) {
    const skf_source *s = w->tracer->sources + i;
    bool plane = s->element.primitive.shape == SKF_PLANE;
    stride = fmax(stride, plane ? skf_source_distance(s, p) : v3_dist(p, s->middle) + s->reach);
    stride = fmax(stride, skf_kernel_width(s->element.kernel));
  }
  return stride > 0 ? stride : 1;
}

/* Whether places on the ray are known well enough for the octree's cells; *shift: by what rounding moves them. */
static bool fits(const skf_walk *w, double to, double *shift) {
  if (!w->tracer->tree) return false;
  double size = largest(w->origin) + largest(v3_mad(w->origin, to, w->direction));
  *shift = 8 * DBL_EPSILON * size;
  return 2 * *shift < 1e-8 * skf_octree_least(w->tracer->tree);
}

static void follow(skf_walk *w, double from, double to, double *side, skf_crossing_fn *found, void *user) {
  skf_knot a = {.t = from};
  double stride = isinf(to) ? first_stride(w, from) : 0;
  w->side = side;
  while (a.t < to) {
    double end = next_break(w, a.t, to, side);
    if (isinf(end)) {
      if (skf_walk_tail_clear(w, a.t)) return;
      end = a.t + stride;
      stride *= 2;
      if (stride > 1e150) {
        w->report.grazing++; /* undecided at infinity */
        return;
      }
    }
    if (w->tracer->linear) a.known = false; /* its slope belongs to the last piece */
    if (!skf_walk_piece(w, &a, end, found, user)) return;
  }
}

/* A ray that the octree cannot take. */
static skf_status alone(skf_walk *w, double from, double to, skf_crossing_fn *found, void *user) {
  enum { FEW = 32 };
  double few[FEW], *side = few;
  size_t n = w->tracer->linear;
  if (n > FEW && !(side = skf_alloc(n, sizeof *side))) return SKF_ERR_NOMEM;
  follow(w, from, to, side, found, user);
  if (side != few) skf_free(side);
  return SKF_OK;
}

void skf_report_add(skf_ray_report *sum, const skf_ray_report *r) {
  sum->cells += r->cells, sum->subdivisions += r->subdivisions;
  sum->evaluations += r->evaluations, sum->grazing += r->grazing;
}

/* A ray that the octree takes. */
typedef struct candidate {
  skf_vec3 origin, direction;
  double from, to, shift;
  int backwards;
  void *user;
} candidate;

/* Answers what needs no octree; *left tells that it does. */
static skf_status begin(skf_question *q, const skf_ray *ray, void *user, candidate *c, bool *left, int *last) {
  skf_walk w = {.tracer = q->tracer, .origin = ray->origin, .direction = unit(ray->direction)};
  double from = ray->t_min, to = ray->t_max;
  bool valid = v3_finite(w.origin) && v3_finite(ray->direction) && v3_norm2(w.direction) > 0;
  *left = false, *last = q->tracer->iso < 0 ? 1 : -1; /* what is outside of the region */
  if (!valid || !isfinite(from) || isnan(to)) return SKF_ERR_ARG;
  if (from > to || !clip(q->tracer, &w, &from, &to)) return SKF_OK;
  *left = fits(&w, to, &c->shift);
  if (*left) {
    skf_vec3 d = w.direction;
    c->origin = w.origin, c->direction = d, c->from = from, c->to = to, c->user = user;
    c->backwards = (d.x < 0) | (d.y < 0) << 1 | (d.z < 0) << 2;
    return SKF_OK;
  }
  skf_status s = alone(&w, from, to, q->found, user);
  skf_report_add(&q->report, &w.report);
  *last = w.last;
  return s;
}

static void board(skf_packet *p, int lane, const candidate *c) {
  const double *o = &c->origin.x, *d = &c->direction.x;
  for (int i = 0; i < 3; i++) {
    p->o[i][lane] = o[i], p->d[i][lane] = d[i];
    p->per[i][lane] = fabs(d[i]) > 1e-300 ? 1 / d[i] : d[i] < 0 ? -1e300 : 1e300; /* middles are before or behind it */
  }
  p->from[lane] = c->from, p->to[lane] = c->to, p->shift[lane] = c->shift;
  p->user[lane] = c->user;
}

static void set_out(const skf_question *q, skf_packet *p) {
  p->tracer = q->tracer, p->first = q->first, p->exact = q->exact, p->found = q->found;
  p->below = p->above = p->walking = p->crossed = 0, p->cells = p->looks = 0;
}

static void go(skf_question *q, skf_packet *p, int lanes) {
  skf_packet_get(q->tracer->isa, lanes)(p);
  for (unsigned left = p->walking; left; left &= left - 1)
    skf_report_add(&q->report, &p->walk[__builtin_ctz(left)].report);
  q->report.cells += p->cells, q->report.evaluations += p->looks;
}

/* Those of n candidates that go the same way as the first, together; returns a bit for each. *last: the sign of the
   last one's field at its end. */
static unsigned travel(skf_question *q, const candidate *c, unsigned left, int *last) {
  skf_packet p;
  unsigned taken = 0;
  int lanes = 0, lane = __builtin_ctz(left);
  set_out(q, &p);
  p.backwards = c[lane].backwards;
  for (; left; left &= left - 1) {
    lane = __builtin_ctz(left);
    if (c[lane].backwards == p.backwards) board(&p, lanes++, c + lane), taken |= 1u << lane;
  }
  p.alive = (1u << lanes) - 1;
  for (int i = lanes; i < (lanes > 4 ? SKF_PACKET : 4); i++) board(&p, i, c + lane), p.to[i] = -INFINITY;
  go(q, &p, lanes);
  *last = p.above >> (lanes - 1) & 1 ? 1 : p.below >> (lanes - 1) & 1 ? -1 : 0;
  return taken;
}

skf_status skf_ask(skf_question *q, const skf_ray *ray, void *user, int *last) {
  candidate c;
  bool left;
  skf_status s = begin(q, ray, user, &c, &left, last);
  if (left) travel(q, &c, 1, last);
  return s;
}

/* Eight rays that go the same way, the common case, together and at once; false: they are not. */
static bool ask_eight(skf_question *q, const skf_ray *rays, skf_answer *user) {
  skf_packet p;
  if (!q->tracer->tree) return false;
  set_out(q, &p);
  if (!skf_packet_board(&p, rays)) return false;
  for (int i = 0; i < SKF_PACKET; i++) p.user[i] = user + i;
  if (p.alive) go(q, &p, SKF_PACKET);
  return true;
}

skf_status skf_ask_many(skf_question *q, size_t n, const skf_ray *rays, skf_answer *user) {
  skf_status status = SKF_OK;
  for (size_t i = 0; i < n; i += SKF_PACKET) {
    candidate c[SKF_PACKET];
    unsigned left = 0;
    int last;
    if (i + SKF_PACKET <= n && ask_eight(q, rays + i, user + i)) continue;
    for (size_t k = 0; k < SKF_PACKET && i + k < n; k++) {
      bool on;
      skf_status s = begin(q, rays + i + k, user + i + k, c + k, &on, &last);
      if (s) status = s;
      left |= (unsigned)on << k;
    }
    while (left) left &= ~travel(q, c, left, &last);
  }
  return status;
}
