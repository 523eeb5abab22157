/* SPDX-License-Identifier: MIT */
/* Queries: rays made ready, those that can go through the octree side by side, what is met handed out. */
#include "core/alloc.h"
#include "core/vec3.h"
#include "field/some.h"
#include "ray/packet.h"
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

/* One question: rays, what to do with their crossings, how much it cost. */
typedef struct question {
  const skf_tracer *tracer;
  skf_crossing_fn *found;
  bool first, exact; /* see skf_packet */
  skf_ray_report report;
} question;

static void add_report(skf_ray_report *sum, const skf_ray_report *r) {
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
static skf_status begin(question *q, const skf_ray *ray, void *user, candidate *c, bool *left, int *last) {
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
  add_report(&q->report, &w.report);
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

static void set_out(const question *q, skf_packet *p) {
  p->tracer = q->tracer, p->first = q->first, p->exact = q->exact, p->found = q->found;
  p->below = p->above = p->walking = p->crossed = 0, p->cells = p->looks = 0;
}

static void go(question *q, skf_packet *p, int lanes) {
  skf_packet_get(q->tracer->isa, lanes)(p);
  for (unsigned left = p->walking; left; left &= left - 1) add_report(&q->report, &p->walk[__builtin_ctz(left)].report);
  q->report.cells += p->cells, q->report.evaluations += p->looks;
}

/* Those of n candidates that go the same way as the first, together; returns a bit for each. *last: the sign of the
   last one's field at its end. */
static unsigned travel(question *q, const candidate *c, unsigned left, int *last) {
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

static skf_status ask(question *q, const skf_ray *ray, void *user, int *last) {
  candidate c;
  bool left;
  skf_status s = begin(q, ray, user, &c, &left, last);
  if (left) travel(q, &c, 1, last);
  return s;
}

/* Eight rays that go the same way, the common case, together and at once; false: they are not. */
static bool ask_eight(question *q, const skf_ray *rays, skf_answer *user) {
  skf_packet p;
  if (!q->tracer->tree) return false;
  set_out(q, &p);
  if (!skf_packet_board(&p, rays)) return false;
  for (int i = 0; i < SKF_PACKET; i++) p.user[i] = user + i;
  if (p.alive) go(q, &p, SKF_PACKET);
  return true;
}

static skf_status ask_many(question *q, size_t n, const skf_ray *rays, skf_answer *user) {
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

static skf_status end(const question *q, skf_status s, skf_ray_report *report) {
  if (report) add_report(report, &q->report);
  return s;
}

static skf_hit hit_of(const skf_knot *k, bool entering) {
  return (skf_hit){k->t, k->at, unit(v3_sub(v3(0, 0, 0), k->gradient)), entering};
}

static skf_hit hit_at(skf_walk *w, const skf_knot *a, const skf_knot *b, double guess) {
  skf_knot k = skf_walk_polish(w, a, b, guess);
  return hit_of(&k, b->f > a->f);
}

typedef struct collector {
  size_t capacity, count;
  skf_hit *hits;
} collector;

static bool collect(void *user, skf_walk *w, const skf_knot *a, const skf_knot *b, double guess) {
  collector *c = user;
  if (c->count < c->capacity) c->hits[c->count] = hit_at(w, a, b, guess);
  c->count++;
  return true;
}

skf_status skf_tracer_all(const skf_tracer *tracer, const skf_ray *ray, size_t capacity, skf_hit *hits, size_t *count,
                          skf_ray_report *report) {
  collector c = {capacity, 0, hits};
  question q = {.tracer = tracer, .found = collect};
  int last;
  skf_status s = ask(&q, ray, &c, &last);
  *count = c.count;
  return end(&q, s, report);
}

typedef struct span_list {
  size_t capacity, count;
  skf_span *spans;
  skf_hit start; /* of the ray */
  bool inside;
} span_list;

static void open_span(span_list *l, skf_hit in, bool with_ray) {
  if (l->count < l->capacity) l->spans[l->count].in = in, l->spans[l->count].starts_inside = with_ray;
  l->inside = true;
}

static void close_span(span_list *l, skf_hit out, bool with_ray) {
  if (l->count < l->capacity) l->spans[l->count].out = out, l->spans[l->count].ends_inside = with_ray;
  l->inside = false;
  l->count++;
}

static bool add_crossing(void *user, skf_walk *w, const skf_knot *a, const skf_knot *b, double guess) {
  span_list *l = user;
  skf_hit h = hit_at(w, a, b, guess);
  if (h.entering) {
    open_span(l, h, false);
  } else {
    if (!l->inside) open_span(l, l->start, true);
    close_span(l, h, false);
  }
  return true;
}

static skf_hit end_of_ray(const skf_ray *ray, double t) {
  skf_hit h = {.t = t, .at = ray->origin, .normal = {0, 0, 0}};
  skf_vec3 d = v3_unit(ray->direction);
  for (int i = 0; i < 3; i++)
    if (v3_get(d, i) != 0) *v3_at(&h.at, i) += t * v3_get(d, i);
  return h;
}

skf_status skf_tracer_spans(const skf_tracer *tracer, const skf_ray *ray, size_t capacity, skf_span *spans,
                            size_t *count, skf_ray_report *report) {
  span_list l = {.capacity = capacity, .spans = spans, .start = end_of_ray(ray, ray->t_min)};
  question q = {.tracer = tracer, .found = add_crossing};
  int last;
  l.start.entering = true;
  skf_status s = ask(&q, ray, &l, &last);
  if (!s && ray->t_min < ray->t_max) {
    if (!l.inside && !l.count && last > 0) open_span(&l, l.start, true);
    if (l.inside) close_span(&l, end_of_ray(ray, ray->t_max), true);
  }
  *count = l.count;
  return end(&q, s, report);
}

/* A first crossing that waits for the field at its guess; t: the next one. */
struct skf_waiting {
  skf_hit *hit;
  skf_walk walk;
  skf_bow bow;
  skf_knot a, b;
  double guess, t;
};

static bool take_first(void *user, skf_walk *w, const skf_knot *a, const skf_knot *b, double guess) {
  skf_answer *c = user;
  *c->found = true;
  if (!w->bow) {
    *c->hit = hit_at(w, a, b, guess);
    return false;
  }
  skf_waiting *wait = c->waiting + (*c->waits)++;
  wait->hit = c->hit, wait->bow = *w->bow, wait->a = *a, wait->b = *b, wait->guess = wait->t = guess;
  wait->walk = (skf_walk){.tracer = w->tracer, .origin = w->origin, .direction = w->direction, .leaf = w->leaf};
  return false;
}

static bool stop(void *user, skf_walk *w, const skf_knot *a, const skf_knot *b, double guess) {
  (void)w, (void)a, (void)b, (void)guess;
  *((skf_answer *)user)->found = true;
  return false;
}

/* Rays for a thread at a time: it changes no result. */
enum { SHARE = 64 };

/* The field at the guesses of n <= SHARE crossings, all at once where that is possible. */
static void look_all(skf_waiting *const *wait, size_t n, skf_knot *k) {
  double at[3][SHARE], out[4][SHARE];
  size_t m = 0, which[SHARE];
  for (size_t i = 0; i < n; i++) {
    skf_walk *w = &wait[i]->walk;
    if (w->tracer->plus || n == 1) {
      skf_walk_look(w, wait[i]->t, k + i);
      continue;
    }
    skf_vec3 p = v3_mad(w->origin, wait[i]->t, w->direction);
    at[0][m] = p.x, at[1][m] = p.y, at[2][m] = p.z, which[m++] = i;
  }
  if (!m) return;
  const double *const p[3] = {at[0], at[1], at[2]};
  double *const F[4] = {out[0], out[1], out[2], out[3]};
  skf_field_serial(wait[0]->walk.tracer->field, m, p, F);
  for (size_t i = 0; i < m; i++) {
    skf_waiting *w = wait[which[i]];
    w->walk.report.evaluations++;
    k[which[i]] = skf_walk_knot(&w->walk, w->t, (const double[4]){out[0][i], out[1][i], out[2][i], out[3][i]});
  }
}

/* n <= SHARE; round after round with those that are not good enough yet */
static void settle_all(question *q, size_t n, skf_waiting *all) {
  skf_waiting *wait[SHARE];
  size_t left = n;
  for (size_t i = 0; i < n; i++) wait[i] = all + i, all[i].walk.bow = &all[i].bow;
  for (int round = 0; round < 3 && left; round++) {
    skf_knot k[SHARE], root;
    size_t still = 0;
    look_all(wait, left, k);
    for (size_t i = 0; i < left; i++) {
      skf_waiting *w = wait[i];
      if (skf_walk_settle(&w->walk, w->guess, k + i, &root))
        *w->hit = hit_of(&root, w->b.f > w->a.f);
      else
        w->t = root.t, wait[still++] = w;
    }
    left = still;
  }
  for (size_t i = 0; i < left; i++) {
    skf_waiting *w = wait[i];
    w->walk.bow = NULL;
    *w->hit = hit_at(&w->walk, &w->a, &w->b, w->guess);
  }
  for (size_t i = 0; i < n; i++) add_report(&q->report, &all[i].walk.report);
}

skf_status skf_tracer_first(const skf_tracer *tracer, const skf_ray *ray, skf_hit *hit, bool *found,
                            skf_ray_report *report) {
  question q = {.tracer = tracer, .found = take_first, .first = true, .exact = true};
  int last;
  skf_waiting waiting;
  size_t waits = 0;
  *found = false;
  skf_status s = ask(&q, ray, &(skf_answer){hit, found, &waiting, &waits}, &last);
  settle_all(&q, waits, &waiting);
  return end(&q, s, report);
}

skf_status skf_tracer_occluded(const skf_tracer *tracer, const skf_ray *ray, bool *occluded, skf_ray_report *report) {
  question q = {.tracer = tracer, .found = stop, .first = true};
  int last;
  *occluded = false;
  skf_status s = ask(&q, ray, &(skf_answer){.found = occluded}, &last);
  return end(&q, s, report);
}

/* n <= SHARE; hits may be NULL */
static skf_status answer_share(question *q, size_t n, const skf_ray *rays, skf_hit *hits, bool *found) {
  skf_answer a[SHARE];
  skf_waiting waiting[SHARE];
  size_t waits = 0;
  for (size_t i = 0; i < n; i++)
    found[i] = false, a[i] = (skf_answer){hits ? hits + i : NULL, found + i, waiting, &waits};
  skf_status s = ask_many(q, n, rays, a);
  settle_all(q, waits, waiting);
  return s;
}

static skf_status answer_all(const question *kind, size_t n, const skf_ray *rays, skf_hit *hits, bool *found,
                             skf_ray_report *report) {
  size_t cells = 0, subdivisions = 0, evaluations = 0, grazing = 0;
  int worst = SKF_OK;
#pragma omp parallel for schedule(dynamic) if (n > 2 * SHARE) reduction(+ : cells, subdivisions, evaluations, grazing) \
    reduction(max : worst)
  for (size_t from = 0; from < n; from += SHARE) {
    question q = *kind;
    size_t m = n - from < SHARE ? n - from : SHARE;
    int s = (int)answer_share(&q, m, rays + from, hits ? hits + from : NULL, found + from);
    worst = s > worst ? s : worst;
    cells += q.report.cells, subdivisions += q.report.subdivisions;
    evaluations += q.report.evaluations, grazing += q.report.grazing;
  }
  if (report) add_report(report, &(skf_ray_report){cells, subdivisions, evaluations, grazing});
  return (skf_status)worst;
}

skf_status skf_tracer_first_many(const skf_tracer *tracer, size_t n, const skf_ray *rays, skf_hit *hits, bool *found,
                                 skf_ray_report *report) {
  question q = {.tracer = tracer, .found = take_first, .first = true, .exact = true};
  return answer_all(&q, n, rays, hits, found, report);
}

skf_status skf_tracer_occluded_many(const skf_tracer *tracer, size_t n, const skf_ray *rays, bool *occluded,
                                    skf_ray_report *report) {
  question q = {.tracer = tracer, .found = stop, .first = true};
  return answer_all(&q, n, rays, NULL, occluded, report);
}
