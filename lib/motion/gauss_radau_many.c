/* SPDX-License-Identifier: MIT */
/* Gauss-Radau steps of many particles that do not feel each other. Each has steps of its own and is wherever it is in
   them; what they have in common is that the forces on all of them are evaluated at once. */
#include "motion/gauss_radau.h"

/* The node past the others: the end of the step. */
enum { END = SKF_RADAU_NODES };

/* A particle and how far the step is that it tries. */
typedef struct seat {
  skf_lane *lane;
  int node, sweep;
  double h, last, q;
  skf_orbit next;
  skf_gauss_radau before;
  skf_radau_guess u;
} seat;

typedef struct flock {
  const skf_ode *ode;
  const skf_radau_ops *ops;
  skf_lane *next, *end;
  double until;
  size_t n; /* seats in use, the first ones of `at` */
  seat *at[SKF_FLOCK], seats[SKF_FLOCK];
  double t_hi[SKF_FLOCK], t_lo[SKF_FLOCK], x[3][SKF_FLOCK], a[3][SKF_FLOCK], noise[SKF_FLOCK];
  skf_vec3 v[SKF_FLOCK];
} flock;

static void begin_sweep(seat *s) {
  s->u.size = skf_radau_size(((const skf_gauss_radau *)s->lane->work)->a0);
  s->node = 1;
}

static bool try(const flock *k, seat *s, double h) {
  skf_gauss_radau *w = s->lane->work;
  if (!(h > skf_step_floor(w->from.t)) || !isfinite(h)) return s->lane->status = SKF_ERR_CONVERGENCE, false;
  s->h = h, s->before = *w, s->sweep = 0, s->last = INFINITY;
  skf_radau_predict(k->ops, w, h, &s->u);
  begin_sweep(s);
  return true;
}

static bool begin_step(const flock *k, seat *s) {
  skf_gauss_radau *w = s->lane->work;
  double most = s->lane->longest(s->lane->flight, s->lane->orbit);
  w->from = *s->lane->orbit;
  return try(k, s, fmin(w->h, most));
}

/* The next particle that has a way to go; false when there is none. */
static bool refill(flock *k, seat *s) {
  for (; k->next < k->end; k->next++) {
    if (k->next->status || k->next->orbit->t.hi >= k->until) continue;
    s->lane = k->next;
    if (begin_step(k, s)) return k->next++, true;
  }
  return false;
}

static bool refuse(flock *k, seat *s, double q) {
  s->lane->report->rejected++;
  return try(k, s, s->h * q) || refill(k, s);
}

/* Where the force is wanted. */
static void ask(flock *k, size_t i) {
  seat *s = k->at[i];
  skf_gauss_radau *w = s->lane->work;
  skf_clock t = s->next.t;
  skf_vec3 x, *v = k->ode->drag ? k->v + i : NULL;
  if (s->node == END) {
    x = v3_add(s->next.x, s->next.x_low);
    if (v) *v = v3_add(s->next.v, s->next.v_low);
  } else {
    t = clock_add(w->from.t, s->h * skf_radau_node[s->node]);
    s->u.ops->place(&s->u, s->h, s->node, &x, v);
  }
  k->t_hi[i] = t.hi, k->t_lo[i] = t.lo, k->x[0][i] = x.x, k->x[1][i] = x.y, k->x[2][i] = x.z;
  ++*s->lane->evaluations;
}

/* The guess will do: on to the end of the step, unless its error is too large. */
static bool solved(flock *k, seat *s) {
  skf_gauss_radau *w = s->lane->work;
  s->q = skf_radau_share(w, &s->u, s->h, s->lane->tolerance);
  if (s->q < SKF_RADAU_REFUSE) return refuse(k, s, fmax(s->q, 0.1));
  s->next = *s->lane->orbit, s->node = END;
  skf_radau_finish(w, &s->u, s->h, &s->next);
  return true;
}

/* A sweep is over. */
static bool judge(flock *k, seat *s) {
  const skf_radau_guess *u = &s->u;
  if (skf_radau_settled(u)) return solved(k, s);
  if (s->sweep > 1 && u->change >= s->last)
    return skf_radau_will_do(s->lane->work, u) ? solved(k, s) : refuse(k, s, 0.25);
  s->last = u->change;
  if (++s->sweep == SKF_RADAU_SWEEPS) return u->change <= 1e-9 * u->size ? solved(k, s) : refuse(k, s, 0.25);
  return begin_sweep(s), true;
}

/* The step is done. */
static bool accept(flock *k, seat *s, skf_vec3 a) {
  skf_gauss_radau *w = s->lane->work;
  skf_lane *lane = s->lane;
  w->a0 = a, w->h = s->h * s->q;
  *lane->orbit = s->next;
  skf_lane_count(lane, w->from.t, lane->orbit);
  bool goes_on = !lane->moved || lane->moved(lane);
  return (goes_on && lane->orbit->t.hi < k->until && begin_step(k, s)) || refill(k, s);
}

/* Takes the force; false when the seat is free. */
static bool answer(flock *k, size_t i) {
  seat *s = k->at[i];
  skf_gauss_radau *w = s->lane->work;
  skf_vec3 a = v3(k->a[0][i], k->a[1][i], k->a[2][i]);
  bool fine = v3_finite(a);
  if (fine && k->ode->drag) {
    skf_clock t = {k->t_hi[i], k->t_lo[i]};
    fine = k->ode->drag(k->ode->user, t, v3(k->x[0][i], k->x[1][i], k->x[2][i]), k->v[i], &a);
  }
  if (s->node == END) {
    if (fine && skf_radau_meets(w, s->h, s->u.size, s->lane->tolerance, a)) return accept(k, s, a);
    *w = s->before;
    return refuse(k, s, 0.25);
  }
  if (!fine) return refuse(k, s, 0.25);
  skf_radau_learn(w, s->node, a, skf_radau_listens(s->node) ? k->noise[i] : 0, &s->u);
  return ++s->node < END || judge(k, s);
}

static void feel(flock *k) {
  const skf_ode *ode = k->ode;
  if (k->n > 1) {
    ode->many(ode->user, k->n, k->t_hi, k->t_lo, (const double *const[]){k->x[0], k->x[1], k->x[2]},
              (double *const[]){k->a[0], k->a[1], k->a[2]}, k->noise);
    return;
  }
  skf_vec3 x = v3(k->x[0][0], k->x[1][0], k->x[2][0]), a; /* the last one: without the costs of a batch */
  if (!ode->eval(ode->user, (skf_clock){k->t_hi[0], k->t_lo[0]}, &x, &a, k->noise)) a = v3(NAN, NAN, NAN);
  k->a[0][0] = a.x, k->a[1][0] = a.y, k->a[2][0] = a.z;
}

void skf_radau_pass(const skf_ode *ode, skf_lane *lanes, size_t n, double until) {
  flock k = {.ode = ode, .ops = skf_radau_get(ode->isa), .next = lanes, .end = lanes + n, .until = until};
  for (size_t i = 0; i < SKF_FLOCK; i++) {
    k.at[k.n] = k.seats + i;
    k.n += refill(&k, k.at[k.n]);
  }
  while (k.n > 0) {
    for (size_t i = 0; i < k.n; i++) ask(&k, i);
    feel(&k);
    size_t left = 0;
    for (size_t i = 0; i < k.n; i++) {
      seat *s = k.at[i];
      if (answer(&k, i)) k.at[left++] = s;
    }
    k.n = left;
  }
}
