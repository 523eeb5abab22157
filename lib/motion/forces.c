/* SPDX-License-Identifier: MIT */
/* Forces other than the bodies' gravity. */
#include "core/alloc.h"
#include "motion/world.h"
#include <string.h>

static bool drags(const skf_force *f) { return f->type == SKF_FORCE_DRAG || f->type == SKF_FORCE_DRAG_SQUARED; }
bool skf_force_drags(const skf_force *f) { return drags(f) || (f->type == SKF_FORCE_USER && f->velocity); }

static skf_status check(const skf_world *w, const skf_force *f) {
  switch (f->type) {
  case SKF_FORCE_PUSH: return v3_finite(f->push) ? SKF_OK : SKF_ERR_RANGE;
  case SKF_FORCE_DRAG:
  case SKF_FORCE_DRAG_SQUARED:
    if (f->body != SKF_FORCE_AT_REST && f->body >= w->n) return SKF_ERR_ARG;
    if (!(f->k >= 0 && isfinite(f->k) && f->scale_height >= 0 && isfinite(f->scale_height))) return SKF_ERR_RANGE;
    return v3_finite(f->center) && isfinite(f->radius) ? SKF_OK : SKF_ERR_RANGE;
  case SKF_FORCE_USER: return f->eval ? SKF_OK : SKF_ERR_ARG;
  default: return SKF_ERR_ARG;
  }
}

skf_status skf_world_take_forces(skf_world *w, const skf_force *forces, size_t count) {
  if (count == 0) return SKF_OK;
  w->forces = skf_alloc(count, sizeof *forces);
  if (!w->forces) return SKF_ERR_NOMEM;
  for (size_t i = 0; i < count; i++) {
    skf_status s = check(w, forces + i);
    if (s) return s;
    w->dragged = w->dragged || skf_force_drags(forces + i);
    w->still = w->still && forces[i].type != SKF_FORCE_USER; /* whose force may change with time */
    w->forces[w->force_count++] = forces[i];
  }
  return SKF_OK;
}

static skf_vec3 drag(const skf_world *w, const skf_force *f, skf_clock t, skf_vec3 p, skf_vec3 v) {
  skf_vec3 center = f->center;
  double k = f->k;
  if (f->body != SKF_FORCE_AT_REST) {
    const skf_world_body *b = w->bodies + f->body;
    skf_turn r = skf_turn_at(b, t);
    center = skf_turn_point(&r, 1, center);
    v = v3_sub(v, skf_body_velocity(b, p));
  }
  if (f->scale_height > 0) k *= exp((f->radius - v3_dist(p, center)) / f->scale_height);
  if (f->type == SKF_FORCE_DRAG_SQUARED) k *= v3_norm(v);
  return v3_scale(-k, v);
}

static bool add(const skf_world *w, bool velocity, skf_clock t, skf_vec3 p, skf_vec3 v, skf_vec3 *a) {
  for (size_t i = 0; i < w->force_count; i++) {
    const skf_force *f = w->forces + i;
    skf_vec3 more = f->push;
    if (skf_force_drags(f) != velocity) continue;
    if (drags(f)) more = drag(w, f, t, p, v);
    if (f->type == SKF_FORCE_USER) f->eval(f->user, t.hi, p, v, &more);
    *a = v3_add(*a, more);
  }
  return v3_finite(*a);
}

bool skf_world_push(const skf_world *w, skf_clock t, skf_vec3 p, skf_vec3 *a) {
  return add(w, false, t, p, v3(NAN, NAN, NAN), a);
}

bool skf_world_drag(const void *world, skf_clock t, skf_vec3 p, skf_vec3 v, skf_vec3 *a) {
  return add(world, true, t, p, v, a);
}
