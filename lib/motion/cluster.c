/* SPDX-License-Identifier: MIT */
#include "motion/cluster.h"
#include "core/alloc.h"
#include "motion/crowd.h"
#include "motion/flight_inside.h"
#include "motion/pairs.h"
#include <float.h>
#include <string.h>
#include <omp.h>

/* Contacts so close, as a part of the step, are one. */
#define AT_ONCE 1e-12
/* Targets that a thread takes at a time; below so many pairs there is one thread. */
enum { SHARE = 64, FEW_PAIRS = 65536 };

struct skf_cluster {
  const skf_world *world;
  skf_flight *const *flights;
  size_t n;
  const double *gm;
  double softening2;
  skf_pairs_pull *pull;
  size_t *flying; /* the crowd's members */
  skf_crowd crowd;
  skf_touch *touch;
  double *numbers;                           /* what the following point into */
  double *x[3], *a[3], *t_hi, *t_lo, *rough; /* of targets */
  double *s[3], *sm;                         /* of pullers */
  unsigned *same;
};

static skf_flight *member(const skf_cluster *c, size_t k) { return c->flights[c->flying[k]]; }

/* Those that pull at time t: first the crowd at x, then those that fly no more. */
static skf_pullers pullers(const skf_cluster *c, double t, const skf_vec3 *x) {
  skf_pullers p = {0, {c->s[0], c->s[1], c->s[2]}, c->sm, c->softening2};
  for (size_t pass = 0; pass < 2; pass++)
    for (size_t i = 0, k = 0; i < c->n; i++) {
      const skf_flight *f = c->flights[i];
      bool flies = k < c->crowd.n && c->flying[k] == i;
      skf_vec3 at = {0, 0, 0};
      if (flies) at = x[k++];
      if (c->gm[i] == 0 || flies == (pass == 1) || (!flies && f->fate == SKF_FATE_ABSORBED)) continue;
      if (!flies) at = skf_flight_seated(f, t).position;
      c->s[0][p.n] = at.x, c->s[1][p.n] = at.y, c->s[2][p.n] = at.z, c->sm[p.n++] = c->gm[i];
    }
  return p;
}

/* Members first ... first + m - 1: the bodies' fields, then the pullers, then what depends on the velocity. */
static bool feel(const skf_cluster *c, const skf_pullers *p, skf_clock t, size_t first, size_t m, const skf_vec3 *v,
                 skf_vec3 *sums, double *noise) {
  const double *const x[3] = {c->x[0] + first, c->x[1] + first, c->x[2] + first};
  double *const a[3] = {c->a[0] + first, c->a[1] + first, c->a[2] + first};
  for (size_t k = first; k < first + m; k++) c->t_hi[k] = t.hi, c->t_lo[k] = t.lo, c->same[k] = 0, c->rough[k] = 0;
  skf_world_force_many(c->world, m, c->t_hi + first, c->t_lo + first, x, a, noise ? noise + first : NULL);
  c->pull(p, m, x, a, c->rough + first, c->same + first);
  bool fine = true;
  for (size_t k = first; k < first + m; k++) {
    skf_vec3 sum = v3(c->a[0][k], c->a[1][k], c->a[2][k]);
    bool itself = c->gm[c->flying[k]] != 0 && c->softening2 == 0;
    if (v && !skf_world_drag(c->world, t, v3(c->x[0][k], c->x[1][k], c->x[2][k]), v[k], &sum)) fine = false;
    if (noise) noise[k] += DBL_EPSILON * c->rough[k];
    fine = fine && v3_finite(sum) && c->same[k] == (itself ? 1 : 0);
    sums[k] = sum;
  }
  return fine;
}

static bool feel_all(void *user, skf_clock t, const skf_vec3 *x, const skf_vec3 *v, skf_vec3 *a, double *noise) {
  skf_cluster *c = user;
  size_t n = c->crowd.n, bad = 0;
  skf_pullers p = pullers(c, t.hi, x);
  for (size_t k = 0; k < n; k++) {
    c->x[0][k] = x[k].x, c->x[1][k] = x[k].y, c->x[2][k] = x[k].z;
    member(c, k)->ode.evaluations++;
  }
#pragma omp parallel for schedule(static) reduction(+ : bad) if (n * p.n > FEW_PAIRS)
  for (size_t first = 0; first < n; first += SHARE)
    bad += !feel(c, &p, t, first, n - first < SHARE ? n - first : SHARE, v, a, noise);
  return bad == 0;
}

static void gather(skf_cluster *c) {
  c->crowd.n = 0;
  for (size_t i = 0; i < c->n; i++) {
    skf_flight *f = c->flights[i];
    if (f->fate != SKF_FATE_FLIES) continue;
    c->crowd.work[c->crowd.n] = f->work, c->crowd.orbit[c->crowd.n] = &f->orbit;
    c->flying[c->crowd.n++] = i;
  }
}

/* Constants of all that have a mass, and the scale of an energy; NAN where they are none. */
typedef struct totals {
  skf_invariants is;
  double momentum_scale;
} totals;

static totals sums(skf_cluster *c) {
  totals all = {{0, 0, 0, 0}, 0};
  bool held = false; /* some pull from a place that does not move */
  double t = skf_cluster_time(c), potential = 0;
  for (size_t k = 0; k < c->crowd.n; k++) c->crowd.x[k] = v3_add(c->crowd.orbit[k]->x, c->crowd.orbit[k]->x_low);
  skf_pullers p = pullers(c, t, c->crowd.x);
  for (size_t i = 0; i < c->n; i++) {
    const skf_flight *f = c->flights[i];
    if (c->gm[i] == 0 || f->fate == SKF_FATE_FLIES) continue;
    held = true;
    if (f->fate == SKF_FATE_RIDES && f->world->bodies[f->body].rate != 0) all.is.energy = NAN;
  }
  for (size_t k = 0, own = 0; k < c->crowd.n; k++) {
    const skf_orbit *o = c->crowd.orbit[k];
    double m = c->gm[c->flying[k]], u = 0;
    if (m == 0) continue;
    skf_vec3 v = v3_add(o->v, o->v_low), x = c->crowd.x[k];
    skf_invariants one = skf_world_invariants_at(c->world, o->t, x, v);
    for (size_t j = ++own; j < p.n; j++) { /* each pair once: this one is the own-th puller */
      double r2 = v3_norm2(v3_sub(v3(p.x[0][j], p.x[1][j], p.x[2][j]), x)) + p.softening2;
      u -= m * p.gm[j] / sqrt(r2);
    }
    potential += u;
    all.is.energy += m * one.energy, all.is.jacobi += m * one.jacobi;
    all.is.axial_momentum += m * one.axial_momentum, all.is.scale += fabs(m) * one.scale + fabs(u);
    all.momentum_scale += fabs(m) * v3_norm(v3_sub(x, c->world->about)) * v3_norm(v);
  }
  all.is.energy += potential, all.is.jacobi += potential;
  if (held) all.is.jacobi = all.is.axial_momentum = NAN;
  return all;
}

static void take_reference(skf_cluster *c) {
  totals now = sums(c);
  c->flights[0]->reference = now.is, c->flights[0]->momentum_scale = now.momentum_scale;
}

void skf_cluster_compare(skf_cluster *c) {
  if (c->crowd.n == 0) return;
  skf_flight *first = c->flights[0];
  const skf_invariants *a = &first->reference;
  totals now = sums(c);
  double scale = fmax(now.is.scale, a->scale);
  skf_flight_report *r = &first->report;
  r->energy_drift = skf_drift_worse(r->energy_drift, now.is.energy, a->energy, scale);
  r->jacobi_drift = skf_drift_worse(r->jacobi_drift, now.is.jacobi, a->jacobi, scale);
  scale = fmax(now.momentum_scale, first->momentum_scale);
  r->momentum_drift = skf_drift_worse(r->momentum_drift, now.is.axial_momentum, a->axial_momentum, scale);
}

/* A first step from a crowd's accelerations: a part of the shortest time in which one of two comes to the other. */
static double first_step(skf_cluster *c) {
  double h = INFINITY;
  for (size_t k = 0; k < c->crowd.n; k++) {
    const skf_gauss_radau *w = member(c, k)->work;
    h = fmin(h, w->h); /* of the flight alone */
    skf_vec3 x = member(c, k)->orbit.x, v = member(c, k)->orbit.v;
    for (size_t j = 0; j < k; j++) {
      const skf_orbit *o = &member(c, j)->orbit;
      double r = sqrt(v3_norm2(v3_sub(o->x, x)) + c->softening2), g = c->gm[c->flying[j]] + c->gm[c->flying[k]];
      if (g > 0 && r > 0) h = fmin(h, 0.01 * fmin(r / v3_norm(v3_sub(o->v, v)), sqrt(r * r * r / g)));
    }
  }
  return h;
}

static skf_status begin(skf_cluster *c, double h) {
  gather(c);
  if (c->crowd.n) take_reference(c);
  return skf_crowd_begin(&c->crowd, h);
}

static bool allocate(skf_cluster *c) {
  size_t n = c->n;
  skf_crowd *w = &c->crowd;
  c->flying = skf_alloc(n, sizeof *c->flying), c->touch = skf_alloc(n, sizeof *c->touch);
  c->same = skf_alloc(n, sizeof *c->same), c->numbers = skf_alloc(13 * n, sizeof *c->numbers);
  w->work = skf_alloc(n, sizeof *w->work), w->orbit = skf_alloc(n, sizeof *w->orbit);
  w->x = skf_alloc(n, sizeof *w->x), w->v = skf_alloc(n, sizeof *w->v), w->a = skf_alloc(n, sizeof *w->a);
  w->noise = skf_alloc(n, sizeof *w->noise);
  w->guess = skf_alloc(n, sizeof *w->guess), w->before = skf_alloc(n, sizeof *w->before);
  if (!c->numbers) return false;
  double **const into[] = {c->x,     c->x + 1,  c->x + 2, c->a,     c->a + 1, c->a + 2, &c->t_hi,
                           &c->t_lo, &c->rough, c->s,     c->s + 1, c->s + 2, &c->sm};
  for (size_t k = 0; k < sizeof into / sizeof *into; k++) *into[k] = c->numbers + k * n;
  return c->flying && c->touch && c->same && w->work && w->orbit && w->x && w->v && w->a && w->noise && w->guess &&
         w->before;
}

skf_status skf_cluster_new(const skf_world *world, skf_flight *const *flights, size_t n, const double *gm,
                           double softening, skf_cluster **out) {
  *out = NULL;
  if (n == 0 || !(softening >= 0) || !isfinite(softening)) return SKF_ERR_ARG;
  for (size_t i = 0; i < n; i++)
    if (!isfinite(gm[i])) return SKF_ERR_RANGE;
  if (flights[0]->ops != &skf_integrator_gauss_radau) return SKF_ERR_UNSUPPORTED;
  skf_cluster *c = skf_alloc(1, sizeof *c);
  if (!c) return SKF_ERR_NOMEM;
  c->world = world, c->flights = flights, c->n = n, c->gm = gm, c->softening2 = softening * softening;
  c->pull = skf_pairs_pick(skf_isa_pick());
  if (!allocate(c)) return skf_cluster_free(c), SKF_ERR_NOMEM;
  c->crowd.ops = skf_radau_get(skf_isa_pick());
  c->crowd.eval = feel_all, c->crowd.user = c, c->crowd.drags = world->dragged;
  for (size_t i = 0; i < n; i++) flights[i]->together = true;
  gather(c);
  skf_status s = begin(c, first_step(c));
  if (s) return skf_cluster_free(c), s;
  return *out = c, SKF_OK;
}

void skf_cluster_resume(skf_cluster *c) { gather(c); }

void skf_cluster_free(skf_cluster *c) {
  if (!c) return;
  skf_crowd *w = &c->crowd;
  skf_free(c->flying), skf_free(c->touch), skf_free(c->same), skf_free(c->numbers);
  skf_free(w->work), skf_free(w->orbit), skf_free(w->x), skf_free(w->v), skf_free(w->a), skf_free(w->noise);
  skf_free(w->guess), skf_free(w->before);
  skf_free(c);
}

double skf_cluster_time(const skf_cluster *c) { return c->crowd.n ? c->crowd.orbit[0]->t.hi : INFINITY; }

/* The first contact of each member; the share of the step at which the first of all happens, or INFINITY. */
static skf_status look(skf_cluster *c, double *first) {
  skf_status worst = SKF_OK;
  double soonest = INFINITY;
#pragma omp parallel for schedule(dynamic, 8) reduction(min : soonest) if (c->crowd.n > SHARE)
  for (size_t k = 0; k < c->crowd.n; k++) {
    skf_flight *f = member(c, k);
    skf_status s = skf_flight_know_path(f);
    c->touch[k] = s ? (skf_touch){.found = false} : skf_flight_look(f);
    if (c->touch[k].found) soonest = fmin(soonest, c->touch[k].s);
    if (s) {
#pragma omp critical
      worst = s;
    }
  }
  return *first = soonest, worst;
}

/* All members at share s of the step, those that touch there after it. */
static skf_status cut(skf_cluster *c, double s, const skf_listener *to) {
  skf_status worst = SKF_OK;
  double h = ((const skf_gauss_radau *)member(c, 0)->work)->h;
  for (size_t k = 0; k < c->crowd.n; k++) {
    skf_flight *f = member(c, k);
    skf_vec3 x = skf_path_position(&f->path, s), v = skf_path_velocity(&f->path, s);
    f->orbit = (skf_orbit){.t = clock_add(f->path.t0, s * f->path.h), .x = x, .v = v};
  }
  skf_cluster_compare(c);
  for (size_t k = 0; k < c->crowd.n && !worst; k++) {
    skf_touch *at = c->touch + k;
    if (!at->found || at->s > s + AT_ONCE) continue;
    skf_contact contact;
    bool silent;
    at->s = s;
    worst = skf_flight_touch(member(c, k), at, &contact, &silent);
    if (!worst && !silent) worst = to->told(to->user, c->flying[k], &contact);
  }
  return worst ? worst : begin(c, h);
}

/* The particle that has been pulled most in the last attempt. */
static size_t pressed(const skf_cluster *c) {
  size_t most = 0;
  double pull = -1;
  for (size_t k = 0; k < c->crowd.n; k++) {
    double a = v3_finite(c->crowd.a[k]) ? v3_norm(c->crowd.a[k]) : INFINITY;
    if (a > pull) pull = a, most = k;
  }
  return c->flying[most];
}

skf_status skf_cluster_step(skf_cluster *c, const skf_listener *listener, size_t *failed) {
  const skf_flight_options *o = &c->flights[0]->options;
  double h_max = INFINITY, first;
  size_t rejected = 0;
  if (c->crowd.n == 0) return SKF_OK;
  for (size_t k = 0; k < c->crowd.n; k++) h_max = fmin(h_max, skf_flight_longest(member(c, k), &member(c, k)->orbit));
  skf_status s = skf_crowd_step(&c->crowd, o->tolerance, h_max, &rejected);
  if (s) return *failed = pressed(c), s;
  for (size_t k = 0; k < c->crowd.n; k++) {
    skf_flight_moved(member(c, k), &c->crowd.before[k].from);
    member(c, k)->report.rejected += rejected;
  }
  if (o->contact == SKF_CONTACT_NONE) return SKF_OK;
  s = look(c, &first);
  return s || !(first < INFINITY) ? s : cut(c, first, listener);
}
