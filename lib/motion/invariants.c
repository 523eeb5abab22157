/* SPDX-License-Identifier: MIT */
/* Which constants of the motion a world has, and their values. */
#include "motion/world.h"

/* Two directions count as parallel, and a point as lying on an axis, within this many times the rounding of their own
   numbers: scene files give 16 digits. */
#define SAME 1e-14

static bool parallel(skf_vec3 a, skf_vec3 b, double same) { return v3_norm(v3_cross(v3_unit(a), v3_unit(b))) <= same; }

static bool on_axis(skf_vec3 p, skf_vec3 axis, skf_vec3 about, double same) {
  skf_vec3 d = v3_sub(p, about);
  return v3_norm(v3_cross(d, axis)) <= same * (v3_norm(p) + v3_norm(about));
}

/* The axis of a primitive's own symmetry; false when it has none. A point has every axis through it (zero vector). */
static bool axis_of(const skf_primitive *p, skf_vec3 *axis, skf_vec3 *about) {
  switch (p->shape) {
  case SKF_POINT: return *axis = v3(0, 0, 0), *about = p->point.at, true;
  case SKF_SEGMENT: *axis = v3_sub(p->segment.to, p->segment.from); return *about = p->segment.from, true;
  case SKF_ARC: return *axis = p->arc.normal, *about = p->arc.center, p->arc.sweep >= 2 * SKF_PI;
  default: return false;
  }
}

typedef struct symmetry {
  bool any, axial, point;
  skf_vec3 axis, about; /* axis is zero while only one point is known */
  double same;          /* SAME, or 0: exactly */
} symmetry;

static void join_axis(symmetry *s, skf_vec3 axis, skf_vec3 about) {
  bool point = v3_norm(axis) == 0;
  if (!s->any) {
    *s = (symmetry){true, true, point, v3_unit(axis), about, s->same};
  } else if (s->point) {
    skf_vec3 d = point ? v3_sub(about, s->about) : axis;
    if (point && v3_norm(d) == 0) return;
    skf_vec3 first = s->about;
    *s = (symmetry){true, true, false, v3_unit(d), about, s->same};
    s->axial = on_axis(first, s->axis, about, s->same);
  } else {
    s->axial = s->axial && (point || parallel(axis, s->axis, s->same)) && on_axis(about, s->axis, s->about, s->same);
  }
}

static void join_body(symmetry *s, const skf_world_body *b) {
  size_t n = skf_field_size(b->is.field);
  for (size_t i = 0; i < n; i++) {
    const skf_element *e = skf_field_element(b->is.field, i);
    const skf_primitive *p = &e->primitive;
    skf_vec3 axis, about;
    if (p->shape == SKF_PLANE) continue;
    if (axis_of(p, &axis, &about) && !(e->profile && p->shape == SKF_ARC))
      join_axis(s, axis, about);
    else
      s->any = true, s->axial = s->point = false;
  }
  if (b->rate != 0) join_axis(s, b->axis, b->is.spin.about);
}

/* A plane is symmetric about every axis along its normal: it only gives a direction. */
static void join_planes(symmetry *s, const skf_world_body *b) {
  size_t n = skf_field_size(b->is.field);
  for (size_t i = 0; i < n; i++) {
    const skf_primitive *p = &skf_field_element(b->is.field, i)->primitive;
    if (p->shape != SKF_PLANE) continue;
    if (s->point) *s = (symmetry){true, s->axial, false, v3_unit(p->plane.normal), s->about, s->same};
    s->axial = s->axial && parallel(p->plane.normal, s->axis, s->same);
  }
}

/* Exactly: what is symmetric but for rounding turns. */
static bool turns(const skf_world_body *b) {
  symmetry s = {0};
  if (b->rate == 0) return false;
  join_body(&s, b);
  join_planes(&s, b);
  return !s.axial;
}

void skf_world_find_symmetry(skf_world *w) {
  symmetry s = {.same = SAME};
  const skf_world_body *first = w->bodies;
  w->still = w->alike = true;
  for (size_t i = 0; i < w->n; i++) {
    const skf_world_body *b = w->bodies + i;
    w->bodies[i].turns = turns(b);
    if (b->rate != 0) w->still = false;
    skf_vec3 omega = v3_scale(b->rate, b->axis), omega0 = v3_scale(first->rate, first->axis);
    if (v3_dist(omega, omega0) > SAME * v3_norm(omega0)) w->alike = false;
    if (first->rate != 0 && !on_axis(b->is.spin.about, first->axis, first->is.spin.about, SAME)) w->alike = false;
    join_body(&s, b);
  }
  for (size_t i = 0; i < w->n; i++) join_planes(&s, w->bodies + i);
  w->axial = s.any && s.axial && !s.point;
  if (w->still && s.any && s.axial && s.point) w->axial = true, s.axis = v3(0, 0, 1);
  if (w->axial) w->axis = s.axis, w->about = s.about;
}

static skf_vec3 origin_of(const skf_world *w) {
  if (w->axial) return w->about;
  for (size_t i = 0; i < w->n; i++)
    if (w->bodies[i].rate != 0) return w->bodies[i].is.spin.about;
  return v3(0, 0, 0);
}

/* *scale: kinetic + |potential|. */
static skf_quantities quantities(const skf_world *w, skf_clock t, skf_vec3 p, skf_vec3 v, double *scale) {
  double magnitude, u = skf_world_potential(w, t, p, &magnitude), kinetic = 0.5 * v3_norm2(v);
  skf_quantities q = {kinetic + u, NAN, v3_cross(v3_sub(p, origin_of(w)), v), NAN};
  for (size_t i = 0; i < w->force_count; i++)
    if (w->forces[i].type == SKF_FORCE_PUSH) q.energy -= v3_dot(w->forces[i].push, p);
  if (w->alike) {
    const skf_world_body *b = w->bodies;
    double turning = w->n > 0 && b->rate != 0 ? b->rate * v3_dot(b->axis, v3_cross(v3_sub(p, b->is.spin.about), v)) : 0;
    q.jacobi = q.energy - turning;
  }
  if (w->axial) q.axial_momentum = v3_dot(w->axis, q.angular_momentum);
  return *scale = kinetic + magnitude, q;
}

skf_invariants skf_world_invariants_at(const skf_world *w, skf_clock t, skf_vec3 p, skf_vec3 v) {
  double scale;
  skf_quantities q = quantities(w, t, p, v, &scale);
  skf_invariants k = {NAN, NAN, NAN, scale};
  if (w->force_count) return k;
  if (w->still || w->axial) k.energy = q.energy; /* a body that spins about its own symmetry axis does not move */
  if (!w->still) k.jacobi = q.jacobi;
  k.axial_momentum = q.axial_momentum;
  return k;
}

skf_quantities skf_world_quantities(const skf_world *w, const skf_state *s) {
  double scale;
  return quantities(w, (skf_clock){s->t, 0}, s->position, s->velocity, &scale);
}

skf_invariants skf_world_invariants(const skf_world *w, const skf_state *s) {
  return skf_world_invariants_at(w, (skf_clock){s->t, 0}, s->position, s->velocity);
}
