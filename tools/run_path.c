/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Paths between the states that a run has kept. */
#include "run_csv.h"
#include "core/vec3.h"
#include <math.h>
#include <stdlib.h>

enum { PIECES = 24 }; /* straight pieces for each step between two states */

/* The cubic through both states at the share s of the time between them. */
static skf_vec3 between(const run_state *a, const run_state *b, double s) {
  double h = b->t - a->t, r = 1 - s;
  skf_vec3 p = v3_scale(r * r * (1 + 2 * s), a->x);
  p = v3_mad(p, s * s * (3 - 2 * s), b->x);
  p = v3_mad(p, s * r * r * h, a->v);
  return v3_mad(p, -s * s * r * h, b->v);
}

/* Whether the velocities explain the way between the states; they do not across a bounce, or when the steps are too
   long for a cubic. */
static bool smooth(const run_state *a, const run_state *b) {
  double h = b->t - a->t;
  skf_vec3 way = v3_sub(b->x, a->x), mean = v3_scale(h / 2, v3_add(a->v, b->v));
  return h > 0 && v3_norm(v3_sub(way, mean)) <= 0.35 * h * fmax(v3_norm(a->v), v3_norm(b->v));
}

/* The contact of this particle after time t and before `until`, the earliest one; NULL when there is none. */
static const run_contact *contact_after(const run_data *run, size_t particle, double t, double until) {
  const run_contact *first = NULL;
  for (size_t i = 0; i < run->contact_count; i++) {
    const run_contact *c = run->contacts + i;
    if (c->particle == particle && c->state.t > t && c->state.t < until && (!first || c->state.t < first->state.t))
      first = c;
  }
  return first;
}

typedef struct line {
  skf_vec3 *at;
  size_t n;
} line;

static bool put(line *l, skf_vec3 p) {
  if (!(l->n & (l->n - 1))) { /* full at powers of two */
    skf_vec3 *more = realloc(l->at, (l->n ? 2 * l->n : 1) * sizeof *more);
    if (!more) return false;
    l->at = more;
  }
  l->at[l->n++] = p;
  return true;
}

/* From a (already there) to b. After a contact only the end's velocity is known: then a parabola. */
static bool put_step(line *l, const run_state *a, const run_state *b, bool after_contact) {
  run_state from = *a;
  double h = b->t - a->t;
  if (after_contact && h > 0) from.v = v3_mad(v3_scale(2 / h, v3_sub(b->x, a->x)), -1, b->v);
  if (!smooth(&from, b)) return put(l, b->x);
  for (int k = 1; k <= PIECES; k++)
    if (!put(l, between(&from, b, (double)k / PIECES))) return false;
  return true;
}

skf_vec3 *run_path(const run_data *run, size_t particle, size_t *count) {
  const run_particle *p = run->particles + particle;
  line l = {NULL, 0};
  bool room = p->count == 0 || put(&l, p->states[0].x);
  for (size_t i = 1; i < p->count && room; i++) {
    run_state at = p->states[i - 1];
    const run_state *to = p->states + i;
    const run_contact *c;
    bool after = false;
    while (room && (c = contact_after(run, particle, at.t, to->t))) {
      room = put_step(&l, &at, &c->state, after);
      at = c->state, after = true;
    }
    room = room && put_step(&l, &at, to, after);
  }
  if (!room) free(l.at);
  *count = l.n;
  return room ? l.at : NULL;
}

/* The state at time t between two, past the contacts that lie between them. */
static run_state state_at(const run_data *run, size_t particle, const run_state *a, const run_state *b, double t) {
  run_state from = *a;
  const run_contact *c;
  bool after = false;
  while ((c = contact_after(run, particle, from.t, t))) from = c->state, after = true;
  double s = b->t > from.t ? (t - from.t) / (b->t - from.t) : 1;
  run_state out = {t, v3_mad(from.x, s, v3_sub(b->x, from.x)), b->v};
  if (!after && !contact_after(run, particle, t, b->t) && smooth(&from, b)) {
    double h = 1e-3 * (b->t - from.t), early = fmax(s - 1e-3, 0), late = fmin(s + 1e-3, 1);
    out.x = between(&from, b, s);
    out.v = v3_scale(1e-3 / (h * (late - early)), v3_sub(between(&from, b, late), between(&from, b, early)));
  }
  return out;
}

bool run_until(const run_data *run, double t, run_data *out) {
  *out = (run_data){.particles = calloc(run->particle_count + 1, sizeof *out->particles),
                    .contacts = calloc(run->contact_count + 1, sizeof *out->contacts)};
  if (!out->particles || !out->contacts) return false;
  for (size_t i = 0; i < run->particle_count; i++) {
    const run_particle *p = run->particles + i;
    run_particle *q = out->particles + out->particle_count++;
    *q = *p, q->count = 0;
    if (!(q->states = calloc(p->count + 1, sizeof *q->states))) return false;
    while (q->count < p->count && p->states[q->count].t <= t) q->states[q->count] = p->states[q->count], q->count++;
    size_t n = q->count;
    if (n && n < p->count && p->states[n - 1].t < t)
      q->states[q->count++] = state_at(run, i, p->states + n - 1, p->states + n, t);
  }
  for (size_t i = 0; i < run->contact_count; i++)
    if (run->contacts[i].state.t <= t) out->contacts[out->contact_count++] = run->contacts[i];
  return true;
}
