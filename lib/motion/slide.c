/* SPDX-License-Identifier: MIT */
/* Impacts, and motion along surfaces: x'' = a + sum_i N_i (n_i - friction d_i), where n_i are the grounds' normals, d_i
   the directions of the slip on them, and the reactions N_i are such that F_i stays what it is: the second derivative
   of F_i along the motion is zero. Gauss-Radau's steps are projected onto the surfaces; a ground is left where its
   reaction would pull. */
#include "motion/slide.h"
#include "motion/flight_inside.h"
#include "motion/gauss_radau.h"
#include <float.h>

/* A rebound of less than this many times the height that rounding of F makes of the ground is none. */
#define HOP 16
/* Units of rounding up to which a speed or a pull along the ground is none. */
#define NONE 64
/* Shorter slides, as a share of the body's size, end at once. */
#define STOP 1e-14
/* The reactions are looked at in this many places of a step. */
enum { LOOKS = 16 };

bool skf_rail_has(const skf_rail *rail, size_t body) {
  for (size_t i = 0; i < rail->n; i++)
    if (rail->body[i] == body) return true;
  return false;
}

/* A body's surface at a place, seen from the body's frame: its normal, the velocity w along it (inertial axes), its own
   speed u, and what must make up for a: the frame's accelerations and the curvature. */
typedef struct ground {
  skf_vec3 n, u, w;
  skf_vec3 frame;     /* acceleration in the body's frame less that in the inertial one */
  double curve;       /* how fast the surface falls away under w [L/T^2] */
  double depth, fuzz; /* below the surface, to first order; rounding of it */
  double size;        /* of the body, seen from there */
} ground;

static ground ground_at(const skf_world_body *b, skf_clock t, skf_vec3 p, skf_vec3 velocity) {
  skf_turn r = skf_turn_at(b, t);
  ground s = {.u = skf_body_velocity(b, p)};
  s.w = v3_sub(velocity, s.u);
  skf_vec3 g, q = skf_turn_point(&r, -1, p), v = skf_turn_vector(&r, -1, s.w), omega = v3_scale(b->rate, b->axis);
  double h[6], F = skf_field_tensor_at(b->is.field, q, &g, h), steep = v3_norm(g);
  s.n = v3_unit(v3_scale(-1, skf_turn_vector(&r, 1, g)));
  s.frame = v3_scale(-1, v3_cross(omega, v3_mad(s.u, 2, s.w)));
  s.curve = (h[0] * v.x * v.x + h[3] * v.y * v.y + h[5] * v.z * v.z +
             2 * (h[1] * v.x * v.y + h[2] * v.x * v.z + h[4] * v.y * v.z)) /
            steep;
  s.depth = (F - b->is.iso) / steep;
  s.fuzz = skf_view_noise(b, F, g, q, p) / steep;
  s.size = b->radius == 0 ? fabs(F) / steep : v3_dist(q, b->center) + b->radius;
  return s;
}

/* How fast a particle with acceleration a (inertial) sinks into it, if nothing holds it [L/T^2]. */
static double sinks(const ground *g, skf_vec3 a) { return g->curve - v3_dot(v3_add(a, g->frame), g->n); }

static double hop_of(const ground *g, double pull) { return pull > 0 ? sqrt(2 * pull * HOP * g->fuzz) : 0; }

/* M x = b with n <= SKF_GROUNDS by elimination with pivots; an unknown that others stand for is 0. */
static void solve(double M[SKF_GROUNDS][SKF_GROUNDS], double *b, size_t n, double *x) {
  bool used[SKF_GROUNDS] = {false};
  size_t row_of[SKF_GROUNDS];
  for (size_t k = 0; k < n; k++) {
    size_t best = n;
    for (size_t i = 0; i < n; i++)
      if (!used[i] && (best == n || fabs(M[i][k]) > fabs(M[best][k]))) best = i;
    row_of[k] = n;
    if (!(fabs(M[best][k]) > 1e-9)) continue; /* parallel normals */
    used[best] = true, row_of[k] = best;
    for (size_t i = 0; i < n; i++) {
      double f = i == best ? 0 : M[i][k] / M[best][k];
      for (size_t j = k; j < n && f != 0; j++) M[i][j] -= f * M[best][j];
      b[i] -= f * b[best];
    }
  }
  for (size_t k = 0; k < n; k++) x[k] = row_of[k] < n ? b[row_of[k]] / M[row_of[k]][k] : 0;
}

/* sum_i x_i n_i whose part along n_j is want[j]. */
static skf_vec3 along_normals(const ground *g, size_t n, const double *want) {
  double M[SKF_GROUNDS][SKF_GROUNDS], b[SKF_GROUNDS], x[SKF_GROUNDS];
  for (size_t j = 0; j < n; j++) {
    for (size_t i = 0; i < n; i++) M[j][i] = v3_dot(g[j].n, g[i].n);
    b[j] = want[j];
  }
  solve(M, b, n, x);
  skf_vec3 sum = {0, 0, 0};
  for (size_t i = 0; i < n; i++) sum = v3_mad(sum, x[i], g[i].n);
  return sum;
}

static void look(const skf_world *w, const skf_rail *rail, skf_clock t, skf_vec3 p, skf_vec3 v, ground *g) {
  for (size_t i = 0; i < rail->n; i++) g[i] = ground_at(w->bodies + rail->body[i], t, p, v);
}

void skf_rail_project(const skf_world *world, const skf_rail *rail, skf_clock t, skf_vec3 *x, skf_vec3 *v) {
  ground g[SKF_GROUNDS];
  double want[SKF_GROUNDS];
  for (int k = 0; k < 4; k++) {
    double off = 0;
    look(world, rail, t, *x, *v, g);
    for (size_t i = 0; i < rail->n; i++) want[i] = g[i].depth, off = fmax(off, fabs(g[i].depth) / g[i].fuzz);
    skf_vec3 d = along_normals(g, rail->n, want);
    if (!(off > 1.0 / NONE) || !(v3_norm(d) <= g[0].size)) break;
    *x = v3_add(*x, d);
  }
  look(world, rail, t, *x, *v, g);
  for (size_t i = 0; i < rail->n; i++) want[i] = -v3_dot(g[i].w, g[i].n);
  skf_vec3 d = along_normals(g, rail->n, want);
  if (v3_finite(d)) *v = v3_add(*v, d);
}

/* ---- Reactions ---- */

/* The reactions N_i that leave an acceleration a along no normal, as pushes: what they make of a. */
static skf_vec3 press(const ground *g, size_t n, const skf_vec3 *push, skf_vec3 a, double *N) {
  double M[SKF_GROUNDS][SKF_GROUNDS], b[SKF_GROUNDS];
  for (size_t j = 0; j < n; j++) {
    for (size_t i = 0; i < n; i++) M[j][i] = v3_dot(g[j].n, push[i]);
    b[j] = sinks(g + j, a);
  }
  solve(M, b, n, N);
  for (size_t i = 0; i < n; i++) a = v3_mad(a, N[i], push[i]);
  return a;
}

/* The grounds' reactions to an acceleration a, and what they make of it. Friction is against the slip, or against what
   is about to set it off. */
static skf_vec3 react(const ground *g, size_t n, double friction, skf_vec3 a, double *N) {
  skf_vec3 push[SKF_GROUNDS] = {{0, 0, 0}};
  for (size_t i = 0; i < n; i++) push[i] = g[i].n;
  skf_vec3 free = press(g, n, push, a, N);
  if (!(friction > 0)) return free;
  for (size_t i = 0; i < n; i++) {
    skf_vec3 way = v3_mad(g[i].w, -v3_dot(g[i].w, g[i].n), g[i].n);
    if (!(v3_norm2(way) > 0)) way = v3_add(free, g[i].frame);
    push[i] = v3_mad(g[i].n, -friction, v3_unit(way));
  }
  return press(g, n, push, a, N);
}

/* What a particle that does not move on its grounds would do: whether friction holds it. */
static bool holds(const ground *g, size_t n, double friction, skf_vec3 a) {
  double N[SKF_GROUNDS], weight = 0;
  skf_vec3 left = v3_add(react(g, n, 0, a, N), g[0].frame);
  for (size_t i = 0; i < n; i++) {
    if (!(N[i] >= 0)) return false;
    weight += N[i];
  }
  return v3_norm(left) <= friction * weight * (1 + NONE * DBL_EPSILON) + NONE * DBL_EPSILON * v3_norm(a);
}

static bool stands(const ground *g, size_t n, double fast) {
  for (size_t i = 0; i < n; i++)
    if (!(v3_norm(g[i].w) <= NONE * DBL_EPSILON * fast)) return false;
  return true;
}

/* ---- Impacts ---- */

/* What friction leaves of a velocity along the surface, after a normal impulse. */
static skf_vec3 rub(skf_vec3 along, double loss) {
  double slip = v3_norm(along);
  return loss < slip ? v3_scale(1 - loss / slip, along) : v3(0, 0, 0);
}

/* An impact without rebound on the last ground of the rail, while the particle slides on the others, ends on those that
   it does not leave for good. Returns the sum of their impulses. */
static double settle(const skf_world *w, const skf_flight_options *o, skf_clock t, skf_vec3 p, skf_vec3 a, skf_vec3 v,
                     skf_rail *rail) {
  skf_rail stay = {1, {rail->body[rail->n - 1]}};
  ground g[SKF_GROUNDS];
  double impulse = 0, N[SKF_GROUNDS];
  for (size_t i = 0; i + 1 < rail->n; i++) {
    look(w, &stay, t, p, v, g);
    skf_vec3 pulled = react(g, stay.n, o->friction, a, N);
    ground one = ground_at(w->bodies + rail->body[i], t, p, v);
    double out = v3_dot(one.w, one.n);
    if (!(out < hop_of(&one, sinks(&one, pulled)))) continue;
    impulse += fmax(0, -out);
    stay.body[stay.n++] = rail->body[i];
  }
  *rail = stay;
  return impulse;
}

static bool move_alike(const skf_world_body *a, const skf_world_body *b, skf_vec3 p) {
  const skf_vec3 u = skf_body_velocity(a, p), w = skf_body_velocity(b, p);
  return v3_dist(v3_scale(a->rate, a->axis), v3_scale(b->rate, b->axis)) == 0 &&
         v3_dist(u, w) <= NONE * DBL_EPSILON * (v3_norm(u) + v3_norm(w));
}

skf_outcome skf_slide_strike(const skf_world *world, const skf_flight_options *o, size_t body, skf_clock t, skf_vec3 p,
                             skf_vec3 before, skf_rail *rail, skf_vec3 *after) {
  const skf_world_body *b = world->bodies + body;
  ground s = ground_at(b, t, p, before), g[SKF_GROUNDS];
  double in = fmax(-v3_dot(s.w, s.n), 0), up = o->restitution * in, mu = o->friction;
  skf_vec3 slip = v3_mad(s.w, -v3_dot(s.w, s.n), s.n), along = rub(slip, mu * (in + up)), a;
  if (!skf_world_force(world, t, &p, &a, NULL)) a = v3(0, 0, 0);
  ground moved = ground_at(b, t, p, v3_add(s.u, along));
  if (!(up < hop_of(&moved, sinks(&moved, a)))) {
    rail->n = 0;
    return *after = v3_add(s.u, v3_mad(along, up, s.n)), SKF_OUTCOME_BOUNCE;
  }
  skf_vec3 v = v3_add(s.u, rub(slip, mu * in));
  if (rail->n == SKF_GROUNDS) rail->n--; /* it has come from a corner: the last ground is the least */
  rail->body[rail->n++] = body;
  double more = settle(world, o, t, p, a, v, rail);
  if (rail->n > 1) {
    skf_vec3 at = p;
    skf_rail_project(world, rail, t, &at, &v);
    v = v3_add(s.u, rub(v3_sub(v, s.u), mu * more));
  }
  for (size_t i = 1; i < rail->n && mu > 0; i++) /* between grounds that move differently friction stops it */
    if (!move_alike(b, world->bodies + rail->body[i], p)) return rail->n = 0, *after = s.u, SKF_OUTCOME_REST;
  look(world, rail, t, p, v, g);
  bool still = stands(g, rail->n, v3_norm(before) + v3_norm(s.u) + sqrt(v3_norm(a) * s.size));
  if (still && holds(g, rail->n, mu, a)) return rail->n = 0, *after = s.u, SKF_OUTCOME_REST;
  return *after = v, SKF_OUTCOME_SLIDE;
}

/* ---- Steps ---- */

static bool eval(const void *user, skf_clock t, const skf_vec3 *x, skf_vec3 *a, double *noise) {
  bool fine = skf_world_force(((const skf_flight *)user)->world, t, x, a, noise);
  if (noise) *noise = 4 * (*noise + DBL_EPSILON * v3_norm(*a)); /* with that of the reaction to pushes, too */
  return fine;
}

/* Whatever acts on the particle but the grounds. */
static bool applied(const skf_flight *f, skf_clock t, skf_vec3 x, skf_vec3 v, skf_vec3 *a) {
  return skf_world_force(f->world, t, &x, a, NULL) && (!f->world->dragged || skf_world_drag(f->world, t, x, v, a));
}

static bool constrain(const void *user, skf_clock t, skf_vec3 x, skf_vec3 v, skf_vec3 *a) {
  const skf_flight *f = user;
  ground g[SKF_GROUNDS];
  double N[SKF_GROUNDS];
  if (f->world->dragged && !skf_world_drag(f->world, t, x, v, a)) return false;
  look(f->world, &f->rail, t, x, v, g);
  *a = react(g, f->rail.n, f->options.friction, *a, N);
  return v3_finite(*a);
}

static skf_ode ode_of(const skf_flight *f) {
  return (skf_ode){.eval = eval, .drag = constrain, .user = f, .timed = true, .isa = f->ode.isa};
}

skf_status skf_slide_begin(skf_flight *f, double h) {
  skf_ode ode = ode_of(f);
  skf_status s = skf_integrator_gauss_radau.begin(f->work, &ode, &f->orbit, h);
  f->ode.evaluations += ode.evaluations;
  return s;
}

/* The ground whose reaction is the least at s on the last step's path, in units of what acts, and that reaction. */
static double least(skf_flight *f, double s, size_t *which) {
  skf_clock t = clock_add(f->path.t0, s * f->path.h);
  skf_vec3 x = skf_path_position(&f->path, s), v = skf_path_velocity(&f->path, s), a;
  ground g[SKF_GROUNDS];
  double N[SKF_GROUNDS], lowest = INFINITY;
  f->ode.evaluations++;
  if (!applied(f, t, x, v, &a)) return INFINITY;
  look(f->world, &f->rail, t, x, v, g);
  react(g, f->rail.n, f->options.friction, a, N);
  for (size_t i = 0; i < f->rail.n; i++)
    if (N[i] < lowest) lowest = N[i], *which = i;
  return lowest;
}

/* Where up to `end` the first ground is left; INFINITY when none is. */
static double takes_off(skf_flight *f, double end, size_t *which) {
  double a = 0;
  if (least(f, 0, which) < 0) return 0;
  for (int i = 1; i <= LOOKS; i++) {
    double b = end * i / LOOKS;
    if (!(least(f, b, which) < 0)) {
      a = b;
      continue;
    }
    for (int k = 0; k < 52 && b - a > DBL_EPSILON * end; k++) {
      double m = 0.5 * (a + b);
      *(least(f, m, which) < 0 ? &b : &a) = m;
    }
    least(f, b, which);
    return b;
  }
  return INFINITY;
}

static void put(skf_flight *f, skf_clock t, skf_vec3 x, skf_vec3 v) {
  skf_rail_project(f->world, &f->rail, t, &x, &v);
  f->orbit = (skf_orbit){.t = t, .x = x, .v = v};
}

/* Friction stops it: within *longest, half of the time that this takes, the slip keeps its direction. True when it has
   so little way left that it stops now, after *longest. */
static bool stops(skf_flight *f, double *longest) {
  ground g[SKF_GROUNDS] = {{.size = 0}};
  double N[SKF_GROUNDS];
  skf_vec3 x = f->orbit.x, v = f->orbit.v, a;
  *longest = INFINITY;
  if (!(f->options.friction > 0) || !applied(f, f->orbit.t, x, v, &a)) return false;
  look(f->world, &f->rail, f->orbit.t, x, v, g);
  a = react(g, f->rail.n, f->options.friction, a, N);
  for (size_t i = 0; i < f->rail.n; i++) {
    const skf_world_body *b = f->world->bodies + f->rail.body[i];
    skf_vec3 dw = v3_sub(a, v3_scale(b->rate, v3_cross(b->axis, v)));
    double slip = v3_norm(g[i].w), left = slip * slip / -v3_dot(dw, g[i].w);
    if (!(slip > 0) || !(left > 0)) continue;
    bool last = 0.5 * slip * left <= STOP * g[i].size || left <= 4 * skf_step_floor(f->orbit.t);
    /* what is left of the way is nothing; its time may be long: not beyond what the last path is good for */
    if (last && i == 0) return *longest = left <= f->path.h ? left : 0, true;
    *longest = fmin(*longest, 0.5 * left);
  }
  return false;
}

/* The slip on the first ground ends after a time `left`. */
static skf_status halt(skf_flight *f, double left, skf_contact *contact, bool *touched) {
  skf_clock t = clock_add(f->orbit.t, left);
  const skf_world_body *b = f->world->bodies + f->rail.body[0];
  skf_vec3 before = f->orbit.v, x = f->orbit.x, a;
  ground g[SKF_GROUNDS];
  skf_vec3 ride = v3_scale(0.5, v3_add(before, skf_body_velocity(b, x)));
  put(f, t, v3_mad(x, left, ride), before);
  f->orbit.v = skf_body_velocity(b, f->orbit.x);
  look(f->world, &f->rail, t, f->orbit.x, f->orbit.v, g);
  double fast = v3_norm(before) + v3_norm(f->orbit.v);
  if (!skf_world_force(f->world, t, &f->orbit.x, &a, NULL)) a = v3(0, 0, 0);
  if (!stands(g, f->rail.n, fast) || !holds(g, f->rail.n, f->options.friction, a)) return skf_flight_restart(f);
  skf_contact c = {.t = t.hi,
                   .body = f->rail.body[0],
                   .position = f->orbit.x,
                   .before = before,
                   .normal = g[0].n,
                   .after = f->orbit.v,
                   .outcome = SKF_OUTCOME_REST};
  if (contact) *contact = c;
  if (touched) *touched = true;
  f->report.contacts++;
  f->rail.n = 0;
  skf_flight_ride(f, c.body);
  return SKF_OK;
}

/* It leaves one of its grounds at s. */
static skf_status leave(skf_flight *f, double s, size_t which) {
  put(f, clock_add(f->path.t0, s * f->path.h), skf_path_position(&f->path, s), skf_path_velocity(&f->path, s));
  f->body = f->rail.body[which], f->within = false;
  for (f->rail.n--; which < f->rail.n; which++) f->rail.body[which] = f->rail.body[which + 1];
  return skf_flight_restart(f);
}

skf_status skf_slide_step(skf_flight *f, skf_contact *contact, bool *touched) {
  double longest;
  if (stops(f, &longest)) return halt(f, longest, contact, touched);
  longest = fmin(longest, skf_flight_longest(f, &f->orbit));
  const skf_integrator_ops *ops = &skf_integrator_gauss_radau;
  skf_step_control control = {f->options.tolerance, longest, 0};
  skf_ode ode = ode_of(f);
  skf_orbit before = f->orbit;
  skf_status s = ops->step(f->work, &ode, &control, &f->orbit, &f->report.rejected);
  f->ode.evaluations += ode.evaluations;
  if (s) return f->rail.n = 0, skf_flight_restart(f); /* it falls down again, until it is wedged */
  skf_flight_moved(f, &before);
  f->last = f->rail, f->dense = true;
  s = ops->dense(f->work, &ode, &f->path);
  if (s) return s;
  skf_touch at = skf_flight_look(f);
  size_t which = 0;
  double off = takes_off(f, at.found ? at.s : 1, &which);
  if (off < INFINITY) return leave(f, off, which);
  if (at.found) return skf_flight_tell(f, &at, contact, touched);
  double h = ((const skf_gauss_radau *)f->work)->h;
  put(f, f->orbit.t, v3_add(f->orbit.x, f->orbit.x_low), v3_add(f->orbit.v, f->orbit.v_low));
  return skf_slide_begin(f, h);
}
