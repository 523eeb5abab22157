/* SPDX-License-Identifier: MIT */
/* Rigid bodies in time: steps, and what happens where two of them meet. */
#include "motion/swarm.h"
#include "core/alloc.h"
#include <float.h>
#include <string.h>

/* The two are together when they are closer than this part of their size, */
#define CLOSE 1e-9
/* towards which a step goes this part of the way: the parabolas and turns that stand for the motion are known the
   better the shorter the step is, which is 0.9 the first time and then a small part of that. */
#define TOWARDS 0.9
#define NEARER  0.999
/* Those stand-ins are never further from the motion than this part of the size, as far as that is known. */
#define ASTRAY 1e-7
/* No body turns further in one step, where another one may be near [rad]. */
#define TURN 0.1

static skf_mover *body(const skf_swarm *s, size_t i) { return s->bodies + i; }

static bool invert(const double I[6], double J[6]) {
  double c0 = I[3] * I[5] - I[4] * I[4], c1 = I[2] * I[4] - I[1] * I[5], c2 = I[1] * I[4] - I[2] * I[3];
  double det = I[0] * c0 + I[1] * c1 + I[2] * c2;
  const double adj[6] = {c0, c1, c2, I[0] * I[5] - I[2] * I[2], I[1] * I[2] - I[0] * I[4], I[0] * I[3] - I[1] * I[1]};
  for (int k = 0; k < 6; k++) J[k] = adj[k] / det;
  return I[0] > 0 && c0 > 0 && det > 0;
}

static skf_status set(skf_mover *m, const skf_rigid_body *from) {
  if (!from->field || !(from->mass >= 0) || !isfinite(from->mass) || !isfinite(from->density)) return SKF_ERR_ARG;
  const skf_rigid_state *at = &from->start;
  double q = 0;
  for (int k = 0; k < 4; k++) q += at->q[k] * at->q[k];
  if (!v3_finite(at->position) || !v3_finite(at->velocity) || !v3_finite(at->angular_velocity)) return SKF_ERR_RANGE;
  if (!(q > 0) || !isfinite(q)) return SKF_ERR_RANGE;
  m->is = *from, m->free = from->mass > 0;
  if (m->free) {
    m->center = from->solid.center;
    if (!(from->solid.volume > 0) || !v3_finite(m->center)) return SKF_ERR_ARG;
    for (int k = 0; k < 6; k++) m->inertia[k] = from->solid.inertia[k] * (from->mass / from->solid.volume);
    if (!invert(m->inertia, m->inverse)) return SKF_ERR_ARG;
  }
  skf_status s = skf_collider_new(from->field, from->iso, &m->hull);
  if (!s && m->free && !m->hull->bounded) s = SKF_ERR_UNSUPPORTED;
  if (!s) m->hull->origin = m->center;
  return s ? s : skf_mover_place_nodes(m);
}

static void start(const skf_mover *m, double *y) {
  const skf_rigid_state *at = &m->is.start;
  double q[4] = {at->q[0], at->q[1], at->q[2], at->q[3]};
  quat_normalize(q);
  skf_vec3 w = skf_mover_spun(m, q, at->angular_velocity);
  const double all[SKF_MOVER_STATE] = {at->position.x,
                                       at->position.y,
                                       at->position.z,
                                       at->velocity.x,
                                       at->velocity.y,
                                       at->velocity.z,
                                       q[0],
                                       q[1],
                                       q[2],
                                       q[3],
                                       w.x,
                                       w.y,
                                       w.z};
  memcpy(y, all, sizeof all);
  if (!m->free) memset(y + 3, 0, 3 * sizeof *y), memset(y + 10, 0, 3 * sizeof *y);
}

double skf_swarm_pace(const skf_swarm *s, const double *slope) {
  double T = INFINITY;
  for (size_t i = 0; i < s->n; i++) {
    if (!body(s, i)->free) continue;
    skf_attitude a = skf_mover_at(s, s->y, i);
    const double *d = slope + i * SKF_MOVER_STATE + 3;
    double R = body(s, i)->hull->radius, fall = v3_norm(v3(d[0], d[1], d[2]));
    T = fmin(T, fmin(R / v3_norm(a.v), fmin(1 / v3_norm(a.w), sqrt(R / fall))));
  }
  return isfinite(T) ? T : 1;
}

skf_status skf_swarm_new(const skf_rigid_body *bodies, size_t n, const skf_rigid_options *options, skf_swarm **out) {
  *out = NULL;
  skf_rigid_options o = *options;
  if (o.tolerance == 0) o.tolerance = 1e-12;
  bool fine = o.tolerance > 0 && o.tolerance <= 0.1 && o.restitution >= 0 && o.restitution <= 1;
  fine = fine && o.friction >= 0 && o.rolling >= 0 && isfinite(o.rolling);
  if (!fine || !isfinite(o.G) || !v3_finite(o.gravity) || !isfinite(o.friction)) return SKF_ERR_ARG;
  skf_swarm *s = skf_alloc(1, sizeof *s);
  if (!s) return SKF_ERR_NOMEM;
  s->n = n, s->options = o;
  s->bodies = skf_alloc(n, sizeof *s->bodies);
  s->y = skf_alloc(2 * n * SKF_MOVER_STATE, sizeof *s->y);
  s->work = skf_alloc(skf_swarm_work(n), sizeof *s->work);
  s->slope = skf_alloc(n * (2 * SKF_MOVER_STATE + 6), sizeof *s->slope);
  s->group = skf_alloc(n, sizeof *s->group);
  skf_status bad = s->bodies && s->y && s->work && s->slope && s->group ? SKF_OK : SKF_ERR_NOMEM;
  if (!bad) s->ideal = s->slope + n * SKF_MOVER_STATE, s->speeds = s->ideal + n * SKF_MOVER_STATE;
  for (size_t i = 0; i < n && !bad; i++) {
    bad = set(s->bodies + i, bodies + i);
    if (!bad) start(s->bodies + i, s->y + i * SKF_MOVER_STATE);
  }
  if (bad) return skf_swarm_free(s), bad;
  s->h = skf_swarm_slope(s, s->y, s->slope) ? 0.1 * skf_swarm_pace(s, s->slope) : 1e-3;
  return *out = s, SKF_OK;
}

void skf_swarm_free(skf_swarm *s) {
  if (!s) return;
  for (size_t i = 0; i < s->n && s->bodies; i++) skf_collider_free(s->bodies[i].hull), skf_free(s->bodies[i].node);
  skf_free(s->bodies), skf_free(s->y), skf_free(s->work), skf_free(s->slope), skf_free(s->group);
  skf_bonds_clear(&s->here);
  skf_free(s->here.bond), skf_free(s->there.bond), skf_free(s->spare.bond), skf_free(s->press);
  skf_free(s);
}

/* The motion of a body's frame from one state to the next, as a parabola and a constant turn about the center of mass,
   which is the hull's origin. */
static skf_rigid_motion motion_of(const skf_swarm *s, const double *y, const double *to, size_t i, double h) {
  skf_attitude a = skf_mover_at(s, y, i), b = skf_mover_at(s, to, i);
  double back[4] = {a.q[0], -a.q[1], -a.q[2], -a.q[3]}, turn[4];
  skf_rigid_motion m = {.t = 0, .pose = {a.x, {a.q[0], a.q[1], a.q[2], a.q[3]}}, .velocity = a.v};
  if (!body(s, i)->free) return m;
  m.acceleration = v3_scale(2 / (h * h), v3_sub(v3_sub(b.x, a.x), v3_scale(h, a.v)));
  quat_times(b.q, back, turn);
  double sign = turn[0] < 0 ? -1 : 1, sine = sqrt(turn[1] * turn[1] + turn[2] * turn[2] + turn[3] * turn[3]);
  double angle = 2 * atan2(sine, sign * turn[0]), per = sine > 0 ? sign * angle / (sine * h) : 0;
  m.angular_velocity = v3(per * turn[1], per * turn[2], per * turn[3]);
  return m;
}

/* The longest step that the turns of bodies near to each other allow. */
static double longest(const skf_swarm *s, double h) {
  for (size_t i = 0; i < s->n; i++)
    for (size_t j = i + 1; j < s->n; j++) {
      if (!body(s, i)->free && !body(s, j)->free) continue;
      skf_attitude a = skf_mover_at(s, s->y, i), b = skf_mover_at(s, s->y, j);
      double way = 2 * h * (v3_norm(a.v) + v3_norm(b.v)) + 2 * h * h * v3_norm(s->options.gravity);
      if (!skf_swarm_close(s, i, j, way)) continue;
      h = fmin(h, TURN / fmax(v3_norm(a.w), v3_norm(b.w)));
    }
  return h;
}

/* By how much, over their size, bodies that may meet go astray from the parabolas and turns that stand for their motion
   during the step: estimates, for an acceleration and an angular velocity that change evenly. */
static double astray(const skf_swarm *s, const double *to, double h) {
  size_t n = s->n * SKF_MOVER_STATE;
  double *before = s->slope, *after = s->ideal, worst = 0;
  if (!skf_swarm_slope(s, s->y, before) || !skf_swarm_slope(s, to, after)) return 0;
  for (size_t k = 0; k < n; k++) after[k] -= before[k];
  for (size_t i = 0; i < s->n; i++)
    for (size_t j = i + 1; j < s->n; j++) {
      if (!body(s, i)->free && !body(s, j)->free) continue;
      skf_attitude a = skf_mover_at(s, s->y, i), b = skf_mover_at(s, s->y, j);
      double way = 2 * h * v3_dist(a.v, b.v) + 2 * h * h * v3_norm(s->options.gravity), off = 0, size = INFINITY;
      if (!skf_swarm_close(s, i, j, way)) continue;
      for (int k = 0; k < 2; k++) {
        const skf_mover *m = body(s, k ? j : i);
        const double *d = after + (k ? j : i) * SKF_MOVER_STATE + 3;
        if (!m->free) continue;
        skf_attitude next = skf_mover_at(s, to, k ? j : i);
        off += v3_norm(v3(d[0], d[1], d[2])) * h * h * (2.0 / 81); /* (u^3 - u^2) / 6 is at most that */
        off += v3_dist(next.w, k ? b.w : a.w) * h * skf_mover_reach(m) / 8;
        size = fmin(size, m->hull->radius);
      }
      worst = fmax(worst, off / size);
    }
  return worst;
}

/* How much time passes while the two come together by CLOSE of their size, at the speeds of either end of the step; no
   less than the clock can tell. */
static double moment(const skf_swarm *s, const double *to, size_t i, size_t j) {
  double size = INFINITY, V = 0, turn = 0;
  for (int end = 0; end < 2; end++) {
    const double *y = end ? to : s->y;
    skf_attitude a = skf_mover_at(s, y, i), b = skf_mover_at(s, y, j);
    V = fmax(V, v3_dist(a.v, b.v));
    for (int k = 0; k < 2; k++) {
      const skf_mover *m = body(s, k ? j : i);
      if (m->free) size = fmin(size, m->hull->radius), turn = fmax(turn, m->hull->radius * v3_norm(k ? b.w : a.w));
    }
  }
  return fmax(CLOSE * size / (V + turn), 64 * DBL_EPSILON * fabs(s->t));
}

static skf_vec3 speed(const skf_rigid_motion *m, double t, skf_vec3 x) {
  skf_vec3 arm = v3_sub(x, skf_rigid_at(m, t).position);
  return v3_add(v3_mad(m->velocity, t, m->acceleration), v3_cross(m->angular_velocity, arm));
}

/* Where two first meet in [0, h], but for a touch at the start that they leave: then where they come back. */
static skf_status meet(const skf_swarm *s, const double *to, size_t i, size_t j, double h, double until, skf_meet *m) {
  skf_rigid_motion a = motion_of(s, s->y, to, i, h), b = motion_of(s, s->y, to, j, h);
  double way = v3_dist(a.velocity, b.velocity) * h + 0.5 * v3_dist(a.acceleration, b.acceleration) * h * h;
  *m = (skf_meet){.meeting = SKF_MEETING_APART};
  if (!skf_swarm_close(s, i, j, way)) return SKF_OK;
  for (double from = 0; from < until; from = fmax(2 * from, 2 * moment(s, to, i, j))) {
    skf_status bad = skf_collide_first(body(s, i)->hull, &a, body(s, j)->hull, &b, from, until, m);
    if (bad || m->meeting == SKF_MEETING_APART || m->t > from) return bad;
    if (v3_dot(v3_sub(speed(&b, from, m->at), speed(&a, from, m->at)), m->normal) < 0) return SKF_OK;
  }
  *m = (skf_meet){.meeting = SKF_MEETING_APART};
  return SKF_OK;
}

/* The first hit during the step from s->y to `to`; *hit->t is from its start. False when there is none. */
static skf_status look(const skf_swarm *s, const double *to, double h, skf_rigid_hit *hit, bool *found) {
  *found = false;
  for (size_t i = 0; i < s->n; i++)
    for (size_t j = i + 1; j < s->n; j++) {
      if (!body(s, i)->free && !body(s, j)->free) continue;
      skf_meet m;
      skf_status bad = meet(s, to, i, j, h, *found ? hit->t : h, &m);
      if (bad) return bad;
      if (m.meeting == SKF_MEETING_APART || (*found && m.t >= hit->t)) continue;
      *hit = (skf_rigid_hit){.t = m.t, .a = i, .b = j, .at = m.at, .normal = m.normal};
      *found = true;
    }
  return SKF_OK;
}

skf_status skf_swarm_run(skf_swarm *s, double t, skf_status (*told)(void *, const skf_rigid_hit *), void *user) {
  size_t n = s->n * SKF_MOVER_STATE;
  double *to = s->y + n;
  double ahead = INFINITY; /* time left to a hit that is known */
  if (!isfinite(t) || t < s->t) return SKF_ERR_ARG;
  if (t - s->t < 64 * DBL_EPSILON * fabs(t)) s->t = t; /* no step is that short */
  skf_bonds_clear(&s->here);                           /* so that a run goes on from the state alone */
  while (s->t < t) {
    double h, tick = 64 * DBL_EPSILON * fabs(t);
    if (s->leaning) {
      skf_status stuck = skf_swarm_is_still(s) ? SKF_OK : skf_rest_step(s, t - s->t, told, user);
      if (stuck) return stuck;
      if (t - s->t <= tick || skf_swarm_is_still(s)) s->t = t;
      continue;
    }
    double most = longest(s, fmin(fmin(s->h, t - s->t), fmax(2 * ahead, tick)));
    skf_rigid_hit hit = {.t = 0};
    bool found;
    skf_status bad = skf_swarm_extrapolate(s, most, to, &h);
    for (double off; !bad && h > 2 * tick && (off = astray(s, to, h)) > ASTRAY;)
      bad = skf_swarm_extrapolate(s, h * fmax(0.2, 0.9 * cbrt(ASTRAY / off)), to, &h);
    if (!bad) bad = look(s, to, h, &hit, &found);
    if (bad) return bad;
    if (found && hit.t > moment(s, to, hit.a, hit.b)) { /* up to shortly before it */
      double next = (ahead < INFINITY ? NEARER : TOWARDS) * hit.t;
      bad = skf_swarm_extrapolate(s, next, to, &h);
      if (bad) return bad;
      found = false, ahead = hit.t - h;
    } else {
      ahead = INFINITY;
    }
    hit.t = s->t;
    double hop = found && skf_swarm_slope(s, s->y, s->slope) ? skf_swarm_hop(s, s->slope, hit.a, hit.b) : 0;
    if (!found || !skf_swarm_strike(s, &hit, hop)) { /* nothing, or they leave each other */
      memcpy(s->y, to, n * sizeof *to);
      s->t = t - s->t - h > tick ? s->t + h : t;
      continue;
    }
    s->leaning = true; /* until they are apart again */
    if (told && (bad = told(user, &hit))) return bad;
  }
  return SKF_OK;
}

/* What a saved state begins with; the state vector follows. */
typedef struct record {
  double n, t, h, leaning, still, options[8];
} record;

static record record_of(const skf_swarm *s) {
  const skf_rigid_options *o = &s->options;
  return (record){
      (double)s->n,
      s->t,
      s->h,
      s->leaning,
      s->still,
      {o->G, o->gravity.x, o->gravity.y, o->gravity.z, o->tolerance, o->restitution, o->friction, o->rolling}};
}

skf_status skf_swarm_save(const skf_swarm *s, skf_status (*write)(void *, const void *, size_t), void *user) {
  record r = record_of(s);
  skf_status bad = write(user, &r, sizeof r);
  return bad ? bad : write(user, s->y, s->n * SKF_MOVER_STATE * sizeof *s->y);
}

skf_status skf_swarm_load(skf_swarm *s, skf_status (*read)(void *, void *, size_t), void *user) {
  record r, own = record_of(s);
  skf_status bad = read(user, &r, sizeof r);
  if (bad) return bad;
  if (r.n != own.n || memcmp(r.options, own.options, sizeof r.options) != 0) return SKF_ERR_PARSE;
  s->t = r.t, s->h = r.h, s->leaning = r.leaning != 0, s->still = (int)r.still;
  return read(user, s->y, s->n * SKF_MOVER_STATE * sizeof *s->y);
}

bool skf_swarm_is_still(const skf_swarm *s) { return s->still >= SKF_STILL; }

double skf_swarm_time(const skf_swarm *s) { return s->t; }

skf_rigid_state skf_swarm_state(const skf_swarm *s, size_t i) {
  skf_attitude a = skf_mover_at(s, s->y, i);
  return (skf_rigid_state){a.x, a.v, a.w, {a.q[0], a.q[1], a.q[2], a.q[3]}};
}

skf_rigid_sums skf_swarm_sums(const skf_swarm *s) {
  skf_rigid_sums r = {.potential = skf_swarm_potential(s, s->y)};
  for (size_t i = 0; i < s->n; i++) {
    if (!body(s, i)->free) continue;
    skf_attitude a = skf_mover_at(s, s->y, i);
    double m = body(s, i)->is.mass;
    r.momentum = v3_mad(r.momentum, m, a.v);
    r.angular_momentum = v3_add(r.angular_momentum, v3_mad(a.L, m, v3_cross(a.x, a.v)));
    r.kinetic += 0.5 * (m * v3_norm2(a.v) + v3_dot(a.L, a.w));
  }
  return r;
}
