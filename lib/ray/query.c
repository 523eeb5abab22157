/* SPDX-License-Identifier: MIT */
/* Queries: what is met on a ray, polished and handed out. */
#include "ray/ask.h"
#include "ray/frame.h"
#include <omp.h>

static skf_status end(const skf_question *q, skf_status s, skf_ray_report *report) {
  if (report) skf_report_add(report, &q->report);
  return s;
}

/* A crossing, at once or when the room is served. */
static void hit_at(skf_room *room, skf_hit *hit, skf_walk *w, const skf_knot *a, const skf_knot *b, double guess) {
  if (w->bow) {
    if (room->count >= SKF_ROOM) skf_room_serve(room, w->tracer, &w->report);
    skf_room_add(room, hit, w, a, b, guess);
    return;
  }
  skf_knot k = skf_walk_polish(w, a, b, guess);
  *hit = (skf_hit){k.t, k.at, v3_unit(v3_sub(v3(0, 0, 0), k.gradient)), b->f > a->f};
}

static void serve(skf_question *q, skf_room *room) {
  while (room->count) skf_room_serve(room, q->tracer, &q->report);
}

typedef struct collector {
  size_t capacity, count;
  skf_hit *hits;
  skf_room room;
} collector;

static bool collect(void *user, skf_walk *w, const skf_knot *a, const skf_knot *b, double guess) {
  collector *c = user;
  if (c->count < c->capacity) hit_at(&c->room, c->hits + c->count, w, a, b, guess);
  c->count++;
  return true;
}

/* Where nothing can be told of the ray. */
static skf_status lose(skf_ray_report *report) {
  if (report) report->grazing++;
  return SKF_OK;
}

static skf_status all(const skf_tracer *tracer, const skf_ray *ray, size_t capacity, skf_hit *hits, size_t *count,
                      skf_ray_report *report) {
  collector c;
  skf_question q = {.tracer = tracer, .found = collect};
  int last;
  c.capacity = capacity, c.count = 0, c.hits = hits, c.room.count = 0;
  skf_status s = skf_ask(&q, ray, &c, &last);
  serve(&q, &c.room);
  *count = c.count;
  return end(&q, s, report);
}

skf_status skf_tracer_all(const skf_tracer *tracer, const skf_ray *ray, size_t capacity, skf_hit *hits, size_t *count,
                          skf_ray_report *report) {
  if (!skf_frame_needed(tracer, ray)) return all(tracer, ray, capacity, hits, count, report);
  skf_frame f = skf_frame_of(tracer, ray);
  *count = 0;
  if (f.lost) return lose(report);
  skf_status s = all(f.tracer, &f.ray, capacity, hits, count, report);
  for (size_t i = 0; i < *count && i < capacity; i++) skf_frame_leave(&f, tracer, hits + i);
  return s;
}

typedef struct span_list {
  size_t capacity, count;
  skf_span *spans;
  skf_hit start; /* of the ray */
  bool inside;
  skf_room room;
} span_list;

/* Where an end of the span goes; NULL: there is no room for it. */
static skf_hit *open_span(span_list *l, bool with_ray) {
  l->inside = true;
  if (l->count >= l->capacity) return NULL;
  l->spans[l->count].starts_inside = with_ray;
  return &l->spans[l->count].in;
}

static skf_hit *close_span(span_list *l, bool with_ray) {
  l->inside = false;
  if (l->count++ >= l->capacity) return NULL;
  l->spans[l->count - 1].ends_inside = with_ray;
  return &l->spans[l->count - 1].out;
}

static void set_hit(skf_hit *to, skf_hit h) {
  if (to) *to = h;
}

static bool add_crossing(void *user, skf_walk *w, const skf_knot *a, const skf_knot *b, double guess) {
  span_list *l = user;
  bool entering = b->f > a->f;
  if (!entering && !l->inside) set_hit(open_span(l, true), l->start);
  skf_hit *to = entering ? open_span(l, false) : close_span(l, false);
  if (to) hit_at(&l->room, to, w, a, b, guess);
  return true;
}

static skf_hit end_of_ray(const skf_ray *ray, double t) {
  skf_hit h = {.t = t, .at = ray->origin, .normal = {0, 0, 0}};
  skf_vec3 d = v3_unit(ray->direction);
  for (int i = 0; i < 3; i++)
    if (v3_get(d, i) != 0) *v3_at(&h.at, i) += t * v3_get(d, i);
  return h;
}

static skf_status all_spans(const skf_tracer *tracer, const skf_ray *ray, size_t capacity, skf_span *spans,
                            size_t *count, skf_ray_report *report) {
  span_list l;
  skf_question q = {.tracer = tracer, .found = add_crossing};
  int last;
  l.capacity = capacity, l.count = l.room.count = 0, l.spans = spans, l.inside = false;
  l.start = end_of_ray(ray, ray->t_min), l.start.entering = true;
  skf_status s = skf_ask(&q, ray, &l, &last);
  serve(&q, &l.room);
  if (!s && ray->t_min < ray->t_max) {
    if (!l.inside && !l.count && last > 0) set_hit(open_span(&l, true), l.start);
    if (l.inside) set_hit(close_span(&l, true), end_of_ray(ray, ray->t_max));
  }
  *count = l.count;
  return end(&q, s, report);
}

skf_status skf_tracer_spans(const skf_tracer *tracer, const skf_ray *ray, size_t capacity, skf_span *spans,
                            size_t *count, skf_ray_report *report) {
  if (!skf_frame_needed(tracer, ray)) return all_spans(tracer, ray, capacity, spans, count, report);
  skf_frame f = skf_frame_of(tracer, ray);
  *count = 0;
  if (f.lost) return lose(report);
  skf_status s = all_spans(f.tracer, &f.ray, capacity, spans, count, report);
  for (size_t i = 0; i < *count && i < capacity; i++) {
    skf_frame_leave(&f, tracer, &spans[i].in), skf_frame_leave(&f, tracer, &spans[i].out);
    if (spans[i].starts_inside) spans[i].in.t = ray->t_min, spans[i].in.at = end_of_ray(ray, ray->t_min).at;
    if (spans[i].ends_inside) spans[i].out.t = ray->t_max, spans[i].out.at = end_of_ray(ray, ray->t_max).at;
  }
  return s;
}

static bool take_first(void *user, skf_walk *w, const skf_knot *a, const skf_knot *b, double guess) {
  const skf_answer *c = user;
  *c->found = true;
  hit_at(c->room, c->hit, w, a, b, guess);
  return false;
}

static bool stop(void *user, skf_walk *w, const skf_knot *a, const skf_knot *b, double guess) {
  (void)w, (void)a, (void)b, (void)guess;
  *((skf_answer *)user)->found = true;
  return false;
}

/* Rays for a thread at a time: it changes no result. */
enum { SHARE = 1024 };

static skf_status first(const skf_tracer *tracer, const skf_ray *ray, skf_hit *hit, bool *found,
                        skf_ray_report *report) {
  skf_question q = {.tracer = tracer, .found = take_first, .first = true, .exact = true};
  int last;
  skf_room room;
  room.count = 0;
  *found = false;
  skf_status s = skf_ask(&q, ray, &(skf_answer){hit, found, &room}, &last);
  serve(&q, &room);
  return end(&q, s, report);
}

skf_status skf_tracer_first(const skf_tracer *tracer, const skf_ray *ray, skf_hit *hit, bool *found,
                            skf_ray_report *report) {
  if (!skf_frame_needed(tracer, ray)) return first(tracer, ray, hit, found, report);
  skf_frame f = skf_frame_of(tracer, ray);
  *found = false;
  if (f.lost) return lose(report);
  skf_status s = first(f.tracer, &f.ray, hit, found, report);
  if (*found) skf_frame_leave(&f, tracer, hit);
  return s;
}

skf_status skf_tracer_occluded(const skf_tracer *tracer, const skf_ray *ray, bool *occluded, skf_ray_report *report) {
  skf_frame f = {tracer, *ray, 0, false};
  if (skf_frame_needed(tracer, ray)) f = skf_frame_of(tracer, ray);
  skf_question q = {.tracer = f.tracer, .found = stop, .first = true};
  int last;
  *occluded = false;
  if (f.lost) return lose(report);
  skf_status s = skf_ask(&q, &f.ray, &(skf_answer){.found = occluded}, &last);
  return end(&q, s, report);
}

/* Rays of which one needs a frame, one by one. hits may be NULL */
static skf_status answer_framed(skf_question *q, size_t n, const skf_ray *rays, skf_hit *hits, bool *found) {
  skf_status status = SKF_OK, s;
  for (size_t i = 0; i < n; i++) {
    if (hits)
      s = skf_tracer_first(q->tracer, rays + i, hits + i, found + i, &q->report);
    else
      s = skf_tracer_occluded(q->tracer, rays + i, found + i, &q->report);
    status = s ? s : status;
  }
  return status;
}

/* hits may be NULL */
static skf_status answer_share(skf_question *q, size_t n, const skf_ray *rays, skf_hit *hits, bool *found) {
  skf_room room;
  skf_status status = SKF_OK;
  room.count = 0;
  for (size_t from = 0; from < n; from += SKF_PACKET) {
    skf_answer a[SKF_PACKET];
    size_t m = n - from < SKF_PACKET ? n - from : SKF_PACKET;
    for (size_t i = 0; i < m; i++)
      found[from + i] = false, a[i] = (skf_answer){hits ? hits + from + i : NULL, found + from + i, &room};
    bool framed = false;
    for (size_t i = 0; i < m; i++) framed = framed || skf_frame_needed(q->tracer, rays + from + i);
    skf_status s = framed ? answer_framed(q, m, rays + from, hits ? hits + from : NULL, found + from)
                          : skf_ask_many(q, m, rays + from, a);
    status = s ? s : status;
    while (room.count >= SKF_ROOM) skf_room_serve(&room, q->tracer, &q->report);
  }
  serve(q, &room);
  return status;
}

/* So many shares at a time for a thread: results of several are not written to the same pages in turns, and none waits
   for another's last ones. */
static int chunk_of(size_t n) {
  enum { LARGE = 16, PER_THREAD = 32 };
  size_t chunk = n / SHARE / PER_THREAD / (size_t)omp_get_max_threads();
  return chunk < 1 ? 1 : chunk < LARGE ? (int)chunk : LARGE;
}

static skf_status answer_all(const skf_question *kind, size_t n, const skf_ray *rays, skf_hit *hits, bool *found,
                             skf_ray_report *report) {
  if (n <= SHARE) { /* a team of one, too, costs two calls of the system where it lies within another */
    skf_question q = *kind;
    skf_status s = answer_share(&q, n, rays, hits, found);
    return end(&q, s, report);
  }
  size_t cells = 0, subdivisions = 0, evaluations = 0, grazing = 0;
  int worst = SKF_OK, chunk = chunk_of(n);
#pragma omp parallel for schedule(dynamic, chunk) if (n > 2 * SHARE) \
    reduction(+ : cells, subdivisions, evaluations, grazing) reduction(max : worst)
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
