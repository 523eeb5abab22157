/* SPDX-License-Identifier: MIT */
/* The 12(10) Nystrom pair by many particles at once: each lane takes steps of its own until its particle is there, then
   the next particle. What a particle meets is what it meets alone, to the last bit. */
#include "motion/nystrom.h"

enum { LANES = SKF_FLOCK };

typedef struct flock {
  skf_nystrom_many s;
  skf_lane *of[LANES]; /* NULL: idle; it repeats its last attempt, which nobody reads */
  bool refused[LANES];
  skf_lane *next, *end;
  double until;
} flock;

static void put(double *to, int l, skf_vec3 p) { to[l] = p.x, to[LANES + l] = p.y, to[2 * LANES + l] = p.z; }
static skf_vec3 get(const double *p, int l) { return v3(p[l], p[LANES + l], p[2 * LANES + l]); }

static skf_orbit start_of(const skf_nystrom_many *s, int l) {
  return (skf_orbit){{s->t_hi[l], s->t_lo[l]}, get(s->x, l), get(s->v, l), get(s->x_low, l), get(s->v_low, l)};
}

static skf_orbit end_of(const skf_nystrom_many *s, int l) {
  return (skf_orbit){clock_add((skf_clock){s->t_hi[l], s->t_lo[l]}, s->h[l]), get(s->to_x, l), get(s->to_v, l),
                     get(s->to_x_low, l), get(s->to_v_low, l)};
}

static void set(skf_nystrom_many *s, int l, const skf_orbit *at) {
  s->t_hi[l] = at->t.hi, s->t_lo[l] = at->t.lo;
  put(s->x, l, at->x), put(s->x_low, l, at->x_low), put(s->v, l, at->v), put(s->v_low, l, at->v_low);
}

/* Whether a step of length h can be tried; else the particle stays where it is. */
static bool try(flock *k, int l, double h) {
  k->s.h[l] = h;
  if (h > skf_step_floor((skf_clock){k->s.t_hi[l], k->s.t_lo[l]}) && isfinite(h)) return true;
  k->of[l]->status = SKF_ERR_CONVERGENCE;
  k->s.h[l] = 0;
  return false;
}

static bool begin_step(flock *k, int l, const skf_orbit *at) {
  skf_lane *lane = k->of[l];
  k->refused[l] = false;
  double h = ((const skf_nystrom *)lane->work)->h, most = lane->longest(lane->flight, at);
  return try(k, l, h < most ? h : most);
}

/* The next particle that has a way to go; false when there is none. */
static bool refill(flock *k, int l) {
  for (k->of[l] = NULL; k->next < k->end && !k->of[l]; k->next++) {
    if (k->next->status || k->next->orbit->t.hi >= k->until) continue;
    k->of[l] = k->next;
    k->s.tolerance[l] = k->next->tolerance;
    set(&k->s, l, k->next->orbit);
    if (!begin_step(k, l, k->next->orbit)) k->of[l] = NULL;
  }
  return k->of[l] != NULL;
}

/* After an attempt: on with the step, with the next step, or with the next particle. */
static bool go_on(flock *k, int l) {
  skf_lane *lane = k->of[l];
  skf_nystrom *w = lane->work;
  double error = k->s.error[l], h = k->s.h[l], factor;
  *lane->evaluations += SKF_NYSTROM_STAGES;
  factor = skf_nystrom_factor(error, k->s.root[l], h, w->done, &w->root, k->refused[l]);
  if (!(error <= 1)) {
    lane->report->rejected++, k->refused[l] = true;
    return try(k, l, h * factor) || refill(k, l);
  }
  skf_orbit to = end_of(&k->s, l), *at = lane->orbit;
  *w = (skf_nystrom){h * factor, h, w->root, start_of(&k->s, l), to};
  skf_lane_count(lane, w->from.t, &to);
  *at = to;
  set(&k->s, l, at);
  return (at->t.hi < k->until && begin_step(k, l, at)) || refill(k, l);
}

void skf_nystrom_pass(const skf_ode *ode, skf_lane *lanes, size_t n, double until) {
  const skf_nystrom_ops *ops = skf_nystrom_get(ode->isa);
  flock k = {.next = lanes, .end = lanes + n, .until = until};
  int busy = 0;
  for (int l = 0; l < LANES; l++) busy += refill(&k, l);
  while (busy > 0) {
    ops->many(&k.s, ode);
    for (int l = 0; l < LANES; l++) busy -= k.of[l] && !go_on(&k, l);
  }
}
