/* SPDX-License-Identifier: MIT */
/* One particle: steps, contacts, and what becomes of it. */
#include "motion/flight_inside.h"
#include "core/alloc.h"
#include "motion/scout.h"
#include <float.h>
#include <stddef.h>
#include <string.h>

/* The first step is this share of the shorter of the times that it takes to cross or to fall the world's length. */
#define FIRST_STEP 0.01
/* A particle that touches this often without time going on is wedged: it rests. */
#define WEDGED 8

static bool sound(const skf_flight_options *o, bool adaptive) {
  if (!(o->tolerance > 0 && o->tolerance <= 0.1) || !(o->max_step > 0)) return false;
  if ((unsigned)o->contact >= SKF_CONTACT_COUNT || (unsigned)o->search > SKF_SEARCH_FAST) return false;
  if (adaptive ? o->step != 0 : !(o->step > 0 && isfinite(o->step)) || o->max_step < INFINITY) return false;
  if (o->contact != SKF_CONTACT_BOUNCE) return true;
  return o->restitution >= 0 && o->restitution <= 1 && o->friction >= 0 && isfinite(o->friction);
}

/* Length over which the world changes, seen from p. */
static double length_at(const skf_world *w, skf_vec3 p) {
  double length = INFINITY;
  for (size_t i = 0; i < w->n; i++) {
    const skf_world_body *b = w->bodies + i;
    double d = b->radius + v3_dist(p, b->center);
    length = fmin(length, fmin(d, b->grain));
  }
  return length > 0 && isfinite(length) ? length : 1;
}

static double first_step(const skf_flight *f) {
  skf_vec3 a = {0, 0, 0};
  double L = length_at(f->world, f->orbit.x), v = v3_norm(f->orbit.v);
  skf_world_force(f->world, f->orbit.t, &f->orbit.x, &a, NULL);
  double h = FIRST_STEP * fmin(L / v, sqrt(L / v3_norm(a)));
  if (!(isfinite(h) && h > 0)) return 1;
  return fmax(h, 2 * skf_step_floor(f->orbit.t)); /* right above the middle of a body, say a plane's origin */
}

static double momentum_size(const skf_flight *f, skf_vec3 x, skf_vec3 v) {
  return v3_norm(f->world->axial ? v3_sub(x, f->world->about) : x) * v3_norm(v);
}

static void take_reference(skf_flight *f) {
  if (f->together) return;
  f->reference = skf_world_invariants_at(f->world, f->orbit.t, f->orbit.x, f->orbit.v);
  f->momentum_scale = momentum_size(f, f->orbit.x, f->orbit.v);
}

double skf_drift_worse(double drift, double now, double before, double scale) {
  double d = fabs(now - before) / scale;
  if (now == before) d = 0;
  return isnan(d) ? drift : isnan(drift) ? d : fmax(drift, d);
}

static void compare(const skf_flight *f, skf_vec3 x, skf_vec3 v, skf_clock t, skf_flight_report *r) {
  if (f->together) return;
  skf_invariants k = skf_world_invariants_at(f->world, t, x, v);
  const skf_invariants *a = &f->reference;
  double scale = fmax(k.scale, a->scale);
  r->energy_drift = skf_drift_worse(r->energy_drift, k.energy, a->energy, scale);
  r->jacobi_drift = skf_drift_worse(r->jacobi_drift, k.jacobi, a->jacobi, scale);
  scale = fmax(momentum_size(f, x, v), f->momentum_scale); /* either may be at rest */
  r->momentum_drift = skf_drift_worse(r->momentum_drift, k.axial_momentum, a->axial_momentum, scale);
}

/* Whether a blind flight has passed a join since it was last asked. */
static bool passes_join(skf_flight *f) {
  uint64_t before = f->zone;
  f->zone = skf_world_zone(f->world, f->orbit.t, v3_add(f->orbit.x, f->orbit.x_low));
  return f->zone != before;
}

skf_status skf_flight_restart(skf_flight *f) {
  take_reference(f);
  if (f->blind) passes_join(f);
  if (f->rail.n) return skf_slide_begin(f, first_step(f));
  return f->ops->begin(f->work, &f->ode, &f->orbit, first_step(f));
}

/* A bounce may end in a slide, which has an integrator of its own. */
static size_t work_size(const skf_integrator_ops *ops, skf_contact_mode contact) {
  size_t own = ops->work_size, slide = contact == SKF_CONTACT_BOUNCE ? skf_integrator_gauss_radau.work_size : 0;
  return own > slide ? own : slide;
}

skf_status skf_flight_new(const skf_world *world, const skf_flight_options *options, const skf_state *start,
                          skf_flight **out) {
  *out = NULL;
  skf_flight_options o = *options;
  if (o.tolerance == 0) o.tolerance = 1e-12;
  if (o.max_step == 0) o.max_step = INFINITY;
  const skf_integrator_ops *ops = skf_integrator_row(o.integrator);
  if (!ops || !sound(&o, ops->info.adaptive)) return SKF_ERR_ARG;
  if (world->force_count && ops->takes == SKF_TAKES_NONE) return SKF_ERR_UNSUPPORTED;
  if (world->dragged && ops->takes != SKF_TAKES_DRAG) return SKF_ERR_UNSUPPORTED;
  bool looks = o.approach || o.contact != SKF_CONTACT_NONE,
       certified = looks && (o.approach || o.search != SKF_SEARCH_FAST);
  if (certified && !skf_world_has_bound(world)) return SKF_ERR_UNSUPPORTED;
  if (!isfinite(start->t) || !v3_finite(start->position) || !v3_finite(start->velocity)) return SKF_ERR_RANGE;
  skf_status sent = looks ? skf_scout_send(world) : SKF_OK;
  if (sent) return sent;
  skf_flight *f = skf_alloc(1, sizeof *f);
  if (f) f->work_size = work_size(ops, o.contact), f->work = skf_alloc(1, f->work_size);
  bool passing = o.contact == SKF_CONTACT_PASS;
  if (f && passing) f->entry = skf_alloc(world->n, sizeof *f->entry);
  if (f && o.approach) f->near = skf_alloc(world->n, sizeof *f->near);
  if (!f || !f->work || (o.approach && !f->near) || (passing && !f->entry)) return skf_flight_free(f), SKF_ERR_NOMEM;
  for (size_t i = 0; i < world->n && f->near; i++) f->near[i].best.f = -INFINITY;
  f->horizon = INFINITY;
  f->world = world, f->options = o, f->ops = ops;
  f->blind = !ops->info.adaptive && skf_world_has_joins(world);
  f->ode = (skf_ode){.eval = skf_world_force,
                     .many = skf_world_force_many,
                     .jerk = skf_world_jerk,
                     .drag = world->dragged ? skf_world_drag : NULL,
                     .user = world,
                     .timed = !world->still,
                     .isa = skf_isa_pick()};
  f->ode.lone = skf_world_lone(world);
  if (f->ode.lone) f->ode.quick = skf_field_quick(f->ode.lone->is.field, f->ode.isa, &f->ode.tile);
  f->orbit = (skf_orbit){.t = {start->t, 0}, .x = start->position, .v = start->velocity};
  f->from = f->orbit.t;
  f->report.h_min = INFINITY;
  f->report.energy_drift = f->report.jacobi_drift = f->report.momentum_drift = NAN;
  f->body = o.contact != SKF_CONTACT_NONE ? skf_contact_born(world, f->orbit.t, f->orbit.x) : SIZE_MAX;
  skf_status s = skf_flight_restart(f);
  if (s) return skf_flight_free(f), s;
  return *out = f, SKF_OK;
}

void skf_flight_free(skf_flight *f) {
  if (f) skf_free(f->work), skf_free(f->near), skf_free(f->entry);
  skf_free(f);
}

enum { KEPT = sizeof(skf_flight) - offsetof(skf_flight, orbit) };

static size_t near_size(const skf_flight *f) { return f->near ? f->world->n * sizeof *f->near : 0; }
static size_t entry_size(const skf_flight *f) { return f->entry ? f->world->n * sizeof *f->entry : 0; }

size_t skf_flight_state_size(const skf_flight *f) {
  return KEPT + sizeof f->ode.evaluations + f->work_size + near_size(f) + entry_size(f);
}

void skf_flight_save(const skf_flight *f, void *bytes) {
  char *to = bytes;
  memcpy(to, (const char *)f + offsetof(skf_flight, orbit), KEPT), to += KEPT;
  memcpy(to, &f->ode.evaluations, sizeof f->ode.evaluations), to += sizeof f->ode.evaluations;
  memcpy(to, f->work, f->work_size), to += f->work_size;
  if (f->near) memcpy(to, f->near, near_size(f)), to += near_size(f);
  if (f->entry) memcpy(to, f->entry, entry_size(f));
}

void skf_flight_load(skf_flight *f, const void *bytes) {
  const char *from = bytes;
  memcpy((char *)f + offsetof(skf_flight, orbit), from, KEPT), from += KEPT;
  memcpy(&f->ode.evaluations, from, sizeof f->ode.evaluations), from += sizeof f->ode.evaluations;
  memcpy(f->work, from, f->work_size), from += f->work_size;
  if (f->near) memcpy(f->near, from, near_size(f)), from += near_size(f);
  if (f->entry) memcpy(f->entry, from, entry_size(f));
}

/* What the contact does to the flight: its new fate and velocity. */
static skf_outcome resolve(skf_flight *f, const skf_world_body *b, skf_contact *c) {
  switch (f->options.contact) {
  case SKF_CONTACT_STICK: return c->after = skf_body_velocity(b, c->position), SKF_OUTCOME_STICK;
  case SKF_CONTACT_BOUNCE:
    if (!(v3_norm(c->normal) > 0) || f->wedged >= WEDGED)
      return c->after = skf_body_velocity(b, c->position), f->rail.n = 0, SKF_OUTCOME_REST;
    if (f->together)
      return skf_contact_rebound(f->world, b, &f->options, f->orbit.t, c->position, c->normal, c->before, &f->hops,
                                 &c->after);
    return skf_slide_strike(f->world, &f->options, c->body, f->orbit.t, c->position, c->before, &f->rail, &c->after);
  case SKF_CONTACT_ABSORB: return c->after = v3(0, 0, 0), SKF_OUTCOME_ABSORB;
  case SKF_CONTACT_PASS: return c->after = c->before, SKF_OUTCOME_PASS;
  default: return c->after = v3(0, 0, 0), SKF_OUTCOME_STOP;
  }
}

void skf_flight_ride(skf_flight *f, size_t body) {
  skf_turn r = skf_turn_at(f->world->bodies + body, f->orbit.t);
  f->fate = SKF_FATE_RIDES, f->body = body;
  f->seat = skf_turn_point(&r, -1, f->orbit.x);
}

/* Surfaces that the path has left behind since it was told that it entered them, up to s, and the one that it enters
   there. */
static void mark_entries(skf_flight *f, const skf_touch *at) {
  for (size_t i = 0; i < f->world->n; i++) {
    if (!f->entry[i]) continue;
    skf_view v = skf_view_of(f->world, i, &f->path);
    skf_sight is = skf_view_at(&v, at->s);
    f->entry[i] = fabs(is.f) <= is.rough;
  }
  f->entry[at->body] = 1;
}

skf_status skf_flight_touch(skf_flight *f, const skf_touch *at, skf_contact *c, bool *silent) {
  const skf_world_body *b = f->world->bodies + at->body;
  skf_clock t = clock_add(f->path.t0, at->s * f->path.h);
  skf_vec3 x = skf_path_position(&f->path, at->s), v = skf_path_velocity(&f->path, at->s);
  if (f->rail.n) skf_rail_project(f->world, &f->rail, t, &x, &v);
  if (f->entry) mark_entries(f, at);
  f->wedged = fabs(clock_since(t.hi, f->from)) <= DBL_EPSILON * fabs(t.hi) ? f->wedged + 1 : 0;
  if (f->rail.n == 0) compare(f, x, v, t, &f->report);
  f->orbit = (skf_orbit){.t = t, .x = x, .v = v};
  *c = (skf_contact){.t = t.hi, .body = at->body, .position = x, .before = v, .normal = skf_contact_normal(b, t, x)};
  bool hopped = f->hops;
  c->outcome = resolve(f, b, c);
  *silent = f->hops && hopped;
  f->body = at->body;
  f->within = c->outcome == SKF_OUTCOME_PASS;
  f->orbit.v = c->after;
  f->report.contacts += !*silent;
  if (c->outcome == SKF_OUTCOME_BOUNCE || c->outcome == SKF_OUTCOME_SLIDE || f->within) return skf_flight_restart(f);
  skf_flight_ride(f, at->body);
  if (c->outcome == SKF_OUTCOME_STOP) f->fate = SKF_FATE_STOPPED;
  if (c->outcome == SKF_OUTCOME_ABSORB) f->fate = SKF_FATE_ABSORBED;
  return SKF_OK;
}

double skf_flight_longest(const skf_flight *f, const skf_orbit *at) {
  if (!f->world->grainy) return f->options.max_step;
  double leap = skf_world_leap(f->world, at->x);
  return fmin(f->options.max_step, leap / v3_norm(at->v)); /* at rest: infinity */
}

skf_status skf_flight_know_path(skf_flight *f) {
  if (f->dense) return SKF_OK;
  skf_status s = f->ops->dense(f->work, &f->ode, &f->path);
  f->dense = s == SKF_OK;
  return s;
}

skf_touch skf_flight_look(skf_flight *f) {
  if (f->options.contact == SKF_CONTACT_NONE) return (skf_touch){.found = false};
  skf_search_report search = {0};
  bool fast = f->options.search == SKF_SEARCH_FAST;
  skf_hunt hunt = {&f->path, 0, 1, f->body, f->within ? 1 : -1, fast, f->entry, f->rail.n ? &f->rail : NULL};
  skf_touch at = skf_contact_find(f->world, &hunt, &search);
  f->report.bounds += search.bounds, f->report.grazing += search.grazing;
  f->body = SIZE_MAX;
  if (f->entry && !at.found) memset(f->entry, 0, entry_size(f));
  return at;
}

void skf_flight_watch_until(skf_flight *f, double t) { f->horizon = t; }

/* Along the last step up to s_end, or the horizon. */
static void watch(skf_flight *f, double s_end) {
  s_end = fmin(s_end, clock_since(f->horizon, f->path.t0) / f->path.h);
  for (size_t i = 0; i < f->world->n; i++) {
    skf_nearest *n = f->near + i;
    skf_view v = skf_view_of(f->world, i, &f->path);
    double before = n->best.f;
    skf_view_summit(&v, 0, s_end, &n->best);
    if (n->best.f == before) continue;
    n->is = (skf_approach){clock_add(f->path.t0, n->best.s * f->path.h).hi, skf_path_position(&f->path, n->best.s),
                           n->best.f, n->best.f < 0 ? -n->best.f / n->best.steep : 0};
  }
}

skf_status skf_flight_approach(const skf_flight *f, size_t body, skf_approach *out) {
  if (!f->near || body >= f->world->n || !(f->near[body].best.f > -INFINITY)) return SKF_ERR_ARG;
  return *out = f->near[body].is, SKF_OK;
}

void skf_flight_moved(skf_flight *f, const skf_orbit *before) {
  double h = clock_since(f->orbit.t.hi, before->t) + f->orbit.t.lo;
  f->report.steps++;
  f->report.h_min = fmin(f->report.h_min, h);
  f->report.h_max = fmax(f->report.h_max, h);
  f->from = before->t;
  f->dense = false, f->last.n = 0;
  f->report.joins += f->blind && passes_join(f);
}

skf_status skf_flight_tell(skf_flight *f, const skf_touch *at, skf_contact *contact, bool *touched) {
  skf_contact c;
  bool silent;
  skf_status s = skf_flight_touch(f, at, &c, &silent);
  if (contact) *contact = c;
  if (touched) *touched = !silent;
  return s;
}

/* What the last step meets. */
static skf_status meet(skf_flight *f, skf_contact *contact, bool *touched) {
  if (f->options.contact == SKF_CONTACT_NONE && !f->near) return SKF_OK;
  skf_status s = skf_flight_know_path(f);
  if (s) return s;
  skf_touch at = skf_flight_look(f);
  if (f->near && f->report.contacts == 0) watch(f, at.found ? at.s : 1);
  if (!at.found) return SKF_OK;
  return skf_flight_tell(f, &at, contact, touched);
}

skf_status skf_flight_step(skf_flight *f, skf_contact *contact, bool *touched) {
  skf_step_control control = {f->options.tolerance, skf_flight_longest(f, &f->orbit), f->options.step};
  if (touched) *touched = false;
  if (f->fate != SKF_FATE_FLIES) return SKF_OK;
  if (f->rail.n) return skf_slide_step(f, contact, touched);
  skf_orbit before = f->orbit;
  skf_status s = f->ops->step(f->work, &f->ode, &control, &f->orbit, &f->report.rejected);
  if (s) return s;
  skf_flight_moved(f, &before);
  return meet(f, contact, touched);
}

bool skf_flight_in_flock(const skf_flight *f) {
  return f->ops->pass && ((f->options.contact == SKF_CONTACT_NONE && !f->near) || f->ops->path_is_free);
}

/* A lane's `moved`. */
static bool look_around(skf_lane *lane) {
  skf_flight *f = lane->flight;
  skf_contact c;
  bool touched = false;
  f->dense = false, f->last.n = 0;
  lane->status = meet(f, &c, &touched);
  if (touched && !lane->status) lane->status = lane->listener->told(lane->listener->user, lane->index, &c);
  return !lane->status && f->fate == SKF_FATE_FLIES && f->rail.n == 0;
}

/* Those that slide do so one after the other. */
static skf_status slide_on(skf_flight *f, size_t i, double t, const skf_listener *listener) {
  skf_status s = SKF_OK;
  while (!s && f->fate == SKF_FATE_FLIES && f->rail.n && f->orbit.t.hi < t) {
    skf_contact c;
    bool touched = false;
    s = skf_flight_step(f, &c, &touched);
    if (touched && !s) s = listener->told(listener->user, i, &c);
  }
  return s;
}

skf_status skf_flights_pass(skf_flight *const *flights, size_t n, double t, skf_status *status,
                            const skf_listener *listener) {
  skf_lane *lanes = skf_alloc(n, sizeof *lanes);
  if (!lanes) return SKF_ERR_NOMEM;
  size_t m;
  do { /* until all that fly have come to t, and those that slide have not taken off before */
    m = 0;
    for (size_t i = 0; i < n; i++) {
      skf_flight *f = flights[i];
      if (!status[i]) status[i] = slide_on(f, i, t, listener);
      if (status[i] || f->fate != SKF_FATE_FLIES || f->orbit.t.hi >= t) continue;
      f->dense = false;
      lanes[m++] = (skf_lane){.work = f->work,
                              .orbit = &f->orbit,
                              .from = &f->from,
                              .report = &f->report,
                              .evaluations = &f->ode.evaluations,
                              .tolerance = f->options.tolerance,
                              .longest = skf_flight_longest,
                              .moved = f->options.contact == SKF_CONTACT_NONE && !f->near ? NULL : look_around,
                              .flight = f,
                              .index = i,
                              .listener = listener};
    }
    if (m) flights[0]->ops->pass(&flights[0]->ode, lanes, m, t);
    for (size_t k = 0; k < m; k++) status[lanes[k].index] = lanes[k].status;
  } while (m);
  return skf_free(lanes), SKF_OK;
}

void skf_flight_span(const skf_flight *f, double *from, double *to) {
  *from = f->from.hi;
  *to = f->fate == SKF_FATE_FLIES ? f->orbit.t.hi : INFINITY;
}

skf_state skf_flight_seated(const skf_flight *f, double t) {
  skf_state s = {t, f->orbit.x, {0, 0, 0}};
  if (f->fate == SKF_FATE_STOPPED) return s;
  if (f->fate == SKF_FATE_ABSORBED) return (skf_state){t, {NAN, NAN, NAN}, {NAN, NAN, NAN}};
  const skf_world_body *b = f->world->bodies + f->body;
  skf_turn r = skf_turn_at(b, (skf_clock){t, 0});
  s.position = skf_turn_point(&r, 1, f->seat);
  s.velocity = skf_body_velocity(b, s.position);
  return s;
}

skf_status skf_flight_at(skf_flight *f, double t, skf_state *out) {
  double from, to;
  skf_flight_span(f, &from, &to);
  if (!(t >= from && t <= to)) return SKF_ERR_RANGE;
  if (f->fate != SKF_FATE_FLIES && t >= f->orbit.t.hi) return *out = skf_flight_seated(f, t), SKF_OK;
  if (t == f->orbit.t.hi) {
    *out = (skf_state){t, v3_add(f->orbit.x, f->orbit.x_low), v3_add(f->orbit.v, f->orbit.v_low)};
    return SKF_OK;
  }
  skf_status s = skf_flight_know_path(f);
  if (s) return s;
  double u = clock_since(t, f->path.t0) / f->path.h;
  *out = (skf_state){t, skf_path_position(&f->path, u), skf_path_velocity(&f->path, u)};
  if (f->last.n) skf_rail_project(f->world, &f->last, (skf_clock){t, 0}, &out->position, &out->velocity);
  return SKF_OK;
}

skf_flight_report skf_flight_get_report(const skf_flight *f) {
  skf_flight_report r = f->report;
  r.evaluations = f->ode.evaluations;
  if (f->fate == SKF_FATE_FLIES && f->rail.n == 0)
    compare(f, v3_add(f->orbit.x, f->orbit.x_low), v3_add(f->orbit.v, f->orbit.v_low), f->orbit.t, &r);
  return r;
}
