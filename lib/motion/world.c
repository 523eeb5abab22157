/* SPDX-License-Identifier: MIT */
/* Bodies that attract: frames, forces, potentials. */
#include "core/alloc.h"
#include "field/some.h"
#include "motion/world.h"
#include "motion/scout.h"
#include <float.h>
#include <string.h>

/* The Gaussian is exactly 0 in doubles where a^2 r^2 > 745.2: a r > 27.3. */
#define GAUSSIAN_REACH 27.3

static double support(const skf_kernel *k) {
  if (k->type == SKF_USER_KERNEL) return k->user->radius > 0 ? k->user->radius : INFINITY;
  if (skf_kernel_get(k->type)->compact) return k->param;
  return k->type == SKF_GAUSSIAN ? GAUSSIAN_REACH / k->param : INFINITY;
}

/* What of a body is of the size of its kernels and of its skeleton. */
static void measure(skf_world_body *b) {
  const skf_field *f = b->is.field;
  size_t n = skf_field_size(f);
  skf_box box = box_empty();
  bool bounded = true;
  double widest = 0;
  b->grain = INFINITY;
  for (size_t i = 0; i < n; i++) {
    const skf_element *e = skf_field_element(f, i);
    double r = support(&e->kernel);
    widest = fmax(widest, r);
    b->grain = fmin(b->grain, e->kernel.type == SKF_GAUSSIAN ? 4 / e->kernel.param : r);
    if (e->primitive.shape == SKF_PLANE)
      bounded = false;
    else
      box = box_join(box, skf_primitive_bounds(&e->primitive));
  }
  b->reach = INFINITY;
  if (!(box.lo.x <= box.hi.x)) return;
  b->center = box_center(box);
  b->radius = 0.5 * box_diagonal(box);
  if (bounded) b->reach = b->radius + widest;
}

static void find_wall(skf_world_body *b) {
  skf_box box;
  skf_status s = skf_field_region(b->is.field, b->is.iso, &box);
  b->surface = s != SKF_ERR_EMPTY;
  b->bounds = skf_field_has_bound(b->is.field, NULL);
  b->walled = s == SKF_OK;
  if (!b->walled) return;
  b->wall_center = box_center(box);
  b->wall_radius = 0.5 * box_diagonal(box) * (1 + 1e-12); /* rounding of the box itself */
}

static skf_status set(skf_world_body *b, const skf_attractor *from) {
  const skf_spin *spin = &from->spin;
  if (!from->field) return SKF_ERR_ARG;
  if (!isfinite(from->iso) || !isfinite(from->gain) || !isfinite(spin->rate)) return SKF_ERR_RANGE;
  b->is = *from;
  if (spin->rate != 0) {
    if (!v3_finite(spin->axis) || !v3_finite(spin->about)) return SKF_ERR_RANGE;
    b->axis = v3_unit(spin->axis);
    if (!(v3_norm(b->axis) > 0)) return SKF_ERR_DEGENERATE;
    b->rate = spin->rate;
  }
  measure(b);
  find_wall(b);
  return SKF_OK;
}

skf_status skf_world_new(const skf_attractor *bodies, size_t n, skf_world **out) {
  return skf_world_new_with(bodies, n, NULL, 0, out);
}

skf_status skf_world_new_with(const skf_attractor *bodies, size_t n, const skf_force *forces, size_t force_count,
                              skf_world **out) {
  *out = NULL;
  skf_world *w = skf_alloc(1, sizeof *w);
  if (w) w->bodies = skf_alloc(n, sizeof *w->bodies), w->scout = skf_scout_new(n);
  if (!w || !w->bodies || !w->scout) return skf_world_free(w), SKF_ERR_NOMEM;
  w->n = n;
  for (size_t i = 0; i < n; i++) {
    skf_status s = set(w->bodies + i, bodies + i);
    if (s) return skf_world_free(w), s;
    w->grainy = w->grainy || isfinite(w->bodies[i].grain);
  }
  skf_world_find_symmetry(w);
  skf_status s = skf_world_take_forces(w, forces, force_count);
  if (s) return skf_world_free(w), s;
  return *out = w, SKF_OK;
}

void skf_world_free(skf_world *w) {
  if (w) skf_free(w->forces), skf_free(w->bodies), skf_scout_free(w->scout);
  skf_free(w);
}

size_t skf_world_size(const skf_world *w) { return w->n; }

bool skf_world_has_bound(const skf_world *w) {
  size_t i = 0;
  while (i < w->n && w->bodies[i].bounds) i++;
  return i == w->n;
}

skf_turn skf_turn_at(const skf_world_body *b, skf_clock t) {
  if (b->rate == 0) return (skf_turn){.c = 1};
  double angle = clock_angle(t, b->rate);
  return (skf_turn){b->axis, b->is.spin.about, cos(angle), sin(angle), true};
}

skf_turn skf_field_turn_at(const skf_world_body *b, skf_clock t) {
  return b->turns ? skf_turn_at(b, t) : (skf_turn){.c = 1};
}

skf_vec3 skf_turn_vector(const skf_turn *r, double sign, skf_vec3 v) {
  if (!r->on) return v;
  skf_vec3 along = v3_scale(v3_dot(r->axis, v), r->axis), across = v3_sub(v, along);
  return v3_add(along, v3_mad(v3_scale(r->c, across), sign * r->s, v3_cross(r->axis, v)));
}

skf_vec3 skf_turn_point(const skf_turn *r, double sign, skf_vec3 p) {
  return r->on ? v3_add(r->about, skf_turn_vector(r, sign, v3_sub(p, r->about))) : p;
}

const skf_world_body *skf_world_lone(const skf_world *w) {
  const skf_world_body *only = NULL;
  for (size_t i = 0; i < w->n; i++) {
    if (w->bodies[i].is.gain == 0) continue;
    if (only || w->bodies[i].turns) return NULL;
    only = w->bodies + i;
  }
  return only && only->is.gain > 0 && !w->force_count ? only : NULL;
}

double skf_body_noise(const skf_world_body *b, skf_vec3 p, double F, skf_vec3 g) {
  double size = b->radius + v3_dist(p, b->center);
  return DBL_EPSILON * (fabs(b->is.gain) * (v3_norm(g) + (b->radius > 0 ? fabs(F) / size : 0)));
}

bool skf_world_force(const void *world, skf_clock t, const skf_vec3 *p, skf_vec3 *a, double *noise) {
  const skf_world *w = world;
  skf_vec3 sum = {0, 0, 0};
  double rough = 0, v[4];
  for (size_t i = 0; i < w->n; i++) {
    const skf_world_body *b = w->bodies + i;
    const skf_vec3 *at = p;
    skf_turn r = {.on = false};
    skf_vec3 q;
    if (b->is.gain == 0) continue;
    if (b->turns) r = skf_turn_at(b, t), q = skf_turn_point(&r, -1, *p), at = &q;
    skf_field_point(b->is.field, at, v);
    if (!isfinite(v[0])) return false;
    skf_vec3 g = v3(v[1], v[2], v[3]);
    sum = v3_mad(sum, b->is.gain, b->turns ? skf_turn_vector(&r, 1, g) : g);
    if (noise) rough += skf_body_noise(b, *at, v[0], g);
  }
  *a = sum;
  if (noise) *noise = rough;
  return w->force_count ? skf_world_push(w, t, *p, a) : v3_finite(sum);
}

enum { FEW = 64 };

typedef struct crowd {
  size_t n; /* <= FEW */
  const double *t_hi, *t_lo, *p[3];
  double *a[3], *noise;
} crowd;

static void roughen(const skf_world_body *b, const crowd *c, const double *const at[3], const double *F,
                    double g[3][FEW], bool first) {
  double gain = fabs(b->is.gain), x = b->center.x, y = b->center.y, z = b->center.z;
  for (size_t i = 0; i < c->n; i++) {
    double dx = at[0][i] - x, dy = at[1][i] - y, dz = at[2][i] - z;
    double size = b->radius + sqrt(dx * dx + dy * dy + dz * dz);
    double slope = sqrt(g[0][i] * g[0][i] + g[1][i] * g[1][i] + g[2][i] * g[2][i]);
    c->noise[i] = (first ? 0 : c->noise[i]) + gain * (slope + (b->radius > 0 ? fabs(F[i]) / size : 0));
  }
}

/* A block of particles in the field of one body, added to a; the first body sets it (to clear it would take longer). */
static void add_body(const skf_world_body *b, const crowd *c, bool first) {
  double q[3][FEW], F[FEW], g[3][FEW], gain = b->is.gain;
  const double *at[3] = {c->p[0], c->p[1], c->p[2]};
  double *const to[3] = {g[0], g[1], g[2]};
  skf_turn r[FEW];
  for (size_t i = 0; i < c->n && b->turns; i++) {
    r[i] = skf_turn_at(b, (skf_clock){c->t_hi[i], c->t_lo[i]});
    skf_vec3 x = skf_turn_point(r + i, -1, v3(at[0][i], at[1][i], at[2][i]));
    q[0][i] = x.x, q[1][i] = x.y, q[2][i] = x.z;
  }
  for (int k = 0; k < 3 && b->turns; k++) at[k] = q[k];
  skf_field_eval(b->is.field, c->n, at, F, to, NULL);
  if (c->noise) roughen(b, c, at, F, g, first);
  for (size_t i = 0; i < c->n && b->turns; i++) {
    skf_vec3 v = skf_turn_vector(r + i, 1, v3(g[0][i], g[1][i], g[2][i]));
    g[0][i] = v.x, g[1][i] = v.y, g[2][i] = v.z;
  }
  double *a0 = c->a[0], *a1 = c->a[1], *a2 = c->a[2];
  for (size_t i = 0; i < c->n; i++) {
    double none = F[i] - F[i]; /* 0, or NAN where F is not finite */
    a0[i] = (first ? 0 : a0[i]) + gain * (g[0][i] + none);
    a1[i] = (first ? 0 : a1[i]) + gain * (g[1][i] + none);
    a2[i] = (first ? 0 : a2[i]) + gain * (g[2][i] + none);
  }
}

void skf_world_force_many(const void *world, size_t n, const double *t_hi, const double *t_lo, const double *const p[3],
                          double *const a[3], double *noise) {
  const skf_world *w = world;
  for (size_t from = 0; from < n; from += FEW) {
    crowd c = {n - from < FEW ? n - from : FEW,
               t_hi + from,
               t_lo + from,
               {p[0] + from, p[1] + from, p[2] + from},
               {a[0] + from, a[1] + from, a[2] + from},
               noise ? noise + from : NULL};
    bool first = true;
    for (size_t i = 0; i < w->n; i++)
      if (w->bodies[i].is.gain != 0) add_body(w->bodies + i, &c, first), first = false;
    for (size_t i = 0; i < c.n && first; i++) c.a[0][i] = c.a[1][i] = c.a[2][i] = 0;
    for (size_t i = 0; i < c.n && first && noise; i++) c.noise[i] = 0;
    for (size_t i = 0; i < c.n && noise; i++) c.noise[i] *= DBL_EPSILON;
    for (size_t i = 0; i < c.n && w->force_count; i++) {
      skf_vec3 sum = v3(c.a[0][i], c.a[1][i], c.a[2][i]);
      skf_world_push(w, w->still ? (skf_clock){0, 0} : (skf_clock){c.t_hi[i], c.t_lo[i]},
                     v3(c.p[0][i], c.p[1][i], c.p[2][i]), &sum);
      c.a[0][i] = sum.x, c.a[1][i] = sum.y, c.a[2][i] = sum.z;
    }
  }
}

bool skf_world_jerk(const void *world, skf_clock t, skf_vec3 p, skf_vec3 v, skf_vec3 *a, skf_vec3 *jerk) {
  const skf_world *w = world;
  *a = *jerk = v3(0, 0, 0);
  for (size_t i = 0; i < w->n; i++) {
    const skf_world_body *b = w->bodies + i;
    double h[6], gain = b->is.gain;
    skf_vec3 g, omega = v3_scale(b->rate, b->axis);
    if (gain == 0) continue;
    skf_turn r = skf_turn_at(b, t);
    skf_vec3 d = skf_turn_vector(&r, -1, v3_sub(v, skf_body_velocity(b, p))); /* as the body sees it */
    if (!isfinite(skf_field_tensor_at(b->is.field, skf_turn_point(&r, -1, p), &g, h))) return false;
    skf_vec3 change = v3(h[0] * d.x + h[1] * d.y + h[2] * d.z, h[1] * d.x + h[3] * d.y + h[4] * d.z,
                         h[2] * d.x + h[4] * d.y + h[5] * d.z);
    g = skf_turn_vector(&r, 1, g);
    *a = v3_mad(*a, gain, g);
    *jerk = v3_mad(*jerk, gain, v3_add(skf_turn_vector(&r, 1, change), v3_cross(omega, g)));
  }
  return v3_finite(*a) && v3_finite(*jerk);
}

double skf_world_potential(const skf_world *w, skf_clock t, skf_vec3 p, double *magnitude) {
  double u = 0, m = 0;
  for (size_t i = 0; i < w->n; i++) {
    if (w->bodies[i].is.gain == 0) continue; /* even where its field is infinite */
    skf_turn r = skf_field_turn_at(w->bodies + i, t);
    double part = -w->bodies[i].is.gain * skf_field_at(w->bodies[i].is.field, skf_turn_point(&r, -1, p), NULL);
    u += part;
    m += fabs(part);
  }
  if (magnitude) *magnitude = m;
  return u;
}

skf_vec3 skf_body_velocity(const skf_world_body *b, skf_vec3 p) {
  if (b->rate == 0) return v3(0, 0, 0);
  return v3_scale(b->rate, v3_cross(b->axis, v3_sub(p, b->is.spin.about)));
}

double skf_world_leap(const skf_world *w, skf_vec3 p) {
  double leap = INFINITY;
  for (size_t i = 0; i < w->n; i++) {
    const skf_world_body *b = w->bodies + i;
    if (!isfinite(b->grain)) continue;
    double far = 0; /* from the ball that the body's reach sweeps */
    if (isfinite(b->reach) && b->rate == 0) far = v3_dist(p, b->center) - b->reach;
    if (isfinite(b->reach) && b->rate != 0)
      far = v3_dist(p, b->is.spin.about) - v3_dist(b->center, b->is.spin.about) - b->reach;
    leap = fmin(leap, fmax(far, 0.5 * b->grain));
  }
  return leap;
}

static skf_clock clock_of(double t) { return (skf_clock){t, 0}; }

double skf_world_at(const skf_world *w, double t, skf_vec3 p, skf_vec3 *a) {
  if (a && !skf_world_force(w, clock_of(t), &p, a, NULL)) *a = v3(NAN, NAN, NAN);
  return skf_world_potential(w, clock_of(t), p, NULL);
}

skf_vec3 skf_world_to_body(const skf_world *w, size_t body, double t, skf_vec3 p) {
  skf_turn r = skf_turn_at(w->bodies + body, clock_of(t));
  return skf_turn_point(&r, -1, p);
}

skf_vec3 skf_world_from_body(const skf_world *w, size_t body, double t, skf_vec3 p) {
  skf_turn r = skf_turn_at(w->bodies + body, clock_of(t));
  return skf_turn_point(&r, 1, p);
}

skf_state skf_world_state_to_body(const skf_world *w, size_t body, const skf_state *s) {
  const skf_world_body *b = w->bodies + body;
  skf_turn r = skf_turn_at(b, clock_of(s->t));
  skf_vec3 relative = v3_sub(s->velocity, skf_body_velocity(b, s->position));
  return (skf_state){s->t, skf_turn_point(&r, -1, s->position), skf_turn_vector(&r, -1, relative)};
}

skf_state skf_world_state_from_body(const skf_world *w, size_t body, const skf_state *s) {
  const skf_world_body *b = w->bodies + body;
  skf_turn r = skf_turn_at(b, clock_of(s->t));
  skf_vec3 absolute = v3_add(s->velocity, skf_body_velocity(b, s->position)); /* the axis is the same in both frames */
  return (skf_state){s->t, skf_turn_point(&r, 1, s->position), skf_turn_vector(&r, 1, absolute)};
}

skf_vec3 skf_world_direction_to_body(const skf_world *w, size_t body, double t, skf_vec3 v) {
  skf_turn r = skf_turn_at(w->bodies + body, clock_of(t));
  return skf_turn_vector(&r, -1, v);
}

skf_vec3 skf_world_surface_velocity(const skf_world *w, size_t body, skf_vec3 p) {
  return skf_body_velocity(w->bodies + body, p);
}

double skf_world_level(const skf_world *w, size_t body, double t, skf_vec3 p) {
  const skf_world_body *b = w->bodies + body;
  return skf_field_at(b->is.field, skf_world_to_body(w, body, t, p), NULL) - b->is.iso;
}
