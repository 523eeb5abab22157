/* SPDX-License-Identifier: MIT */
/* Queries: what is met on a ray, polished and handed out. */
#include "core/vec3.h"
#include "field/some.h"
#include "ray/ask.h"

static skf_status end(const skf_question *q, skf_status s, skf_ray_report *report) {
  if (report) skf_report_add(report, &q->report);
  return s;
}

static skf_hit hit_of(const skf_knot *k, bool entering) {
  return (skf_hit){k->t, k->at, v3_unit(v3_sub(v3(0, 0, 0), k->gradient)), entering};
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
  skf_question q = {.tracer = tracer, .found = collect};
  int last;
  skf_status s = skf_ask(&q, ray, &c, &last);
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
  skf_question q = {.tracer = tracer, .found = add_crossing};
  int last;
  l.start.entering = true;
  skf_status s = skf_ask(&q, ray, &l, &last);
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
static void settle_all(skf_question *q, size_t n, skf_waiting *all) {
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
  for (size_t i = 0; i < n; i++) skf_report_add(&q->report, &all[i].walk.report);
}

skf_status skf_tracer_first(const skf_tracer *tracer, const skf_ray *ray, skf_hit *hit, bool *found,
                            skf_ray_report *report) {
  skf_question q = {.tracer = tracer, .found = take_first, .first = true, .exact = true};
  int last;
  skf_waiting waiting;
  size_t waits = 0;
  *found = false;
  skf_status s = skf_ask(&q, ray, &(skf_answer){hit, found, &waiting, &waits}, &last);
  settle_all(&q, waits, &waiting);
  return end(&q, s, report);
}

skf_status skf_tracer_occluded(const skf_tracer *tracer, const skf_ray *ray, bool *occluded, skf_ray_report *report) {
  skf_question q = {.tracer = tracer, .found = stop, .first = true};
  int last;
  *occluded = false;
  skf_status s = skf_ask(&q, ray, &(skf_answer){.found = occluded}, &last);
  return end(&q, s, report);
}

/* n <= SHARE; hits may be NULL */
static skf_status answer_share(skf_question *q, size_t n, const skf_ray *rays, skf_hit *hits, bool *found) {
  skf_answer a[SHARE];
  skf_waiting waiting[SHARE];
  size_t waits = 0;
  for (size_t i = 0; i < n; i++)
    found[i] = false, a[i] = (skf_answer){hits ? hits + i : NULL, found + i, waiting, &waits};
  skf_status s = skf_ask_many(q, n, rays, a);
  settle_all(q, waits, waiting);
  return s;
}

static skf_status answer_all(const skf_question *kind, size_t n, const skf_ray *rays, skf_hit *hits, bool *found,
                             skf_ray_report *report) {
  size_t cells = 0, subdivisions = 0, evaluations = 0, grazing = 0;
  int worst = SKF_OK;
#pragma omp parallel for schedule(dynamic) if (n > 2 * SHARE) reduction(+ : cells, subdivisions, evaluations, grazing) \
    reduction(max : worst)
  for (size_t from = 0; from < n; from += SHARE) {
    skf_question q = *kind;
    size_t m = n - from < SHARE ? n - from : SHARE;
    int s = (int)answer_share(&q, m, rays + from, hits ? hits + from : NULL, found + from);
    worst = s > worst ? s : worst;
    cells += q.report.cells, subdivisions += q.report.subdivisions;
    evaluations += q.report.evaluations, grazing += q.report.grazing;
  }
  if (report) skf_report_add(report, &(skf_ray_report){cells, subdivisions, evaluations, grazing});
  return (skf_status)worst;
}

skf_status skf_tracer_first_many(const skf_tracer *tracer, size_t n, const skf_ray *rays, skf_hit *hits, bool *found,
                                 skf_ray_report *report) {
  skf_question q = {.tracer = tracer, .found = take_first, .first = true, .exact = true};
  return answer_all(&q, n, rays, hits, found, report);
}

skf_status skf_tracer_occluded_many(const skf_tracer *tracer, size_t n, const skf_ray *rays, bool *occluded,
                                    skf_ray_report *report) {
  skf_question q = {.tracer = tracer, .found = stop, .first = true};
  return answer_all(&q, n, rays, NULL, occluded, report);
}
