/* SPDX-License-Identifier: MIT */
#include "ray/room.h"
#include "core/vec3.h"
#include "field/some.h"

/* More looks than this: the crossing is left to the walk. */
enum { LOOKS = 3 };

void skf_room_add(skf_room *r, skf_hit *hit, const skf_walk *w, const skf_knot *a, const skf_knot *b, double guess) {
  size_t i = r->count++;
  const skf_bow *bow = w->bow;
  r->hit[i] = hit, r->leaf[i] = w->leaf, r->looks[i] = 0, r->t[i] = guess;
  for (int k = 0; k < 3; k++) {
    r->o[k][i] = v3_get(w->origin, k), r->d[k][i] = v3_get(w->direction, k);
    r->turn[k][i] = v3_get(bow->turn, k);
  }
  r->c2[i] = bow->c2, r->c3[i] = bow->c3, r->off[i] = bow->off, r->per[i] = w->leaf->patch->per;
  r->bend[i] = w->leaf->bend, r->loose[i] = bow->loose;
  r->from[i] = a->t, r->from_f[i] = a->f, r->to[i] = b->t, r->to_f[i] = b->f;
}

static void move(skf_room *r, size_t i, size_t to) {
  if (i == to) return;
  r->hit[to] = r->hit[i], r->leaf[to] = r->leaf[i], r->looks[to] = r->looks[i], r->t[to] = r->t[i];
  for (int k = 0; k < 3; k++) r->o[k][to] = r->o[k][i], r->d[k][to] = r->d[k][i], r->turn[k][to] = r->turn[k][i];
  r->c2[to] = r->c2[i], r->c3[to] = r->c3[i], r->off[to] = r->off[i], r->per[to] = r->per[i];
  r->bend[to] = r->bend[i], r->loose[to] = r->loose[i];
  r->from[to] = r->from[i], r->from_f[to] = r->from_f[i], r->to[to] = r->to[i], r->to_f[to] = r->to_f[i];
}

static skf_walk walk_of(const skf_room *r, size_t i, const skf_tracer *tracer) {
  return (skf_walk){.tracer = tracer,
                    .origin = {r->o[0][i], r->o[1][i], r->o[2][i]},
                    .direction = {r->d[0][i], r->d[1][i], r->d[2][i]},
                    .leaf = r->leaf[i]};
}

/* By the walk's own bounds. */
static void polish(skf_room *r, size_t i, const skf_tracer *tracer, skf_ray_report *report) {
  skf_walk w = walk_of(r, i, tracer);
  skf_knot a = {.t = r->from[i], .f = r->from_f[i]}, b = {.t = r->to[i], .f = r->to_f[i]};
  skf_knot k = skf_walk_polish(&w, &a, &b, r->t[i]);
  *r->hit[i] = (skf_hit){k.t, k.at, v3_unit(v3_sub(v3(0, 0, 0), k.gradient)), b.f > a.f};
  report->evaluations += w.report.evaluations;
}

/* One point at a time: where strengths of both signs meet, the magnitudes count. */
static void look_alone(const skf_room *r, size_t i, const skf_tracer *tracer, skf_sights *s) {
  skf_walk w = walk_of(r, i, tracer);
  skf_knot k;
  skf_walk_look(&w, r->t[i], &k);
  s->F[i] = k.f, s->size[i] = k.size;
  s->g[0][i] = k.gradient.x, s->g[1][i] = k.gradient.y, s->g[2][i] = k.gradient.z;
}

static void look(const skf_room *r, size_t m, const skf_tracer *tracer, skf_sights *s) {
  double at[3][SKF_ROOM];
  const double *const p[3] = {at[0], at[1], at[2]};
  double *const out[4] = {s->F, s->g[0], s->g[1], s->g[2]};
  if (m == 1 || tracer->plus) {
    for (size_t i = 0; i < m; i++) look_alone(r, i, tracer, s);
    return;
  }
  for (int k = 0; k < 3; k++)
    for (size_t i = 0; i < m; i++) at[k][i] = r->o[k][i] + r->t[i] * r->d[k][i];
  skf_field_serial(tracer->field, m, p, out);
  for (size_t i = 0; i < m; i++) s->size[i] = fabs(s->F[i]) + fabs(tracer->iso), s->F[i] -= tracer->iso;
}

/* The last one again up to a whole vector: nobody waits there. */
static void fill_up(skf_room *r, size_t m, skf_sights *s) {
  for (size_t i = m; i % 4; i++) {
    move(r, m - 1, i);
    s->F[i] = s->F[m - 1], s->size[i] = s->size[m - 1];
    for (int k = 0; k < 3; k++) s->g[k][i] = s->g[k][m - 1];
  }
}

void skf_room_serve(skf_room *r, const skf_tracer *tracer, skf_ray_report *report) {
  skf_sights s;
  bool done[SKF_ROOM];
  size_t m = r->count < SKF_ROOM ? r->count : SKF_ROOM, left = 0;
  if (!m) return;
  look(r, m, tracer, &s);
  fill_up(r, m, &s);
  report->evaluations += m;
  skf_settle_fn *settle = skf_room_settle_scalar;
#ifdef SKF_HAVE_AVX2
  if (tracer->isa != SKF_ISA_SCALAR) settle = skf_room_settle_avx2;
#endif
  settle(tracer, r, m, &s, done);
  for (size_t i = 0; i < m; i++) {
    if (done[i]) continue;
    if (++r->looks[i] < LOOKS)
      move(r, i, left++);
    else
      polish(r, i, tracer, report);
  }
  for (size_t i = m; i < r->count; i++) move(r, i, left++);
  r->count = left;
}
