/* SPDX-License-Identifier: MIT */
#include "motion/collider.h"
#include "core/alloc.h"
#include "ray/ball.h"
#include <float.h>

/* So many elements are bounded as quickly as smaller balls are looked up. */
#define FEW 8

skf_status skf_collider_new(const skf_field *field, double iso, skf_collider **out) {
  *out = NULL;
  skf_collider *c = skf_alloc(1, sizeof *c);
  if (!c) return SKF_ERR_NOMEM;
  c->field = field, c->iso = iso;
  skf_status s = skf_tracer_new(field, iso, &c->tracer);
  if (!s && c->tracer->reach == SKF_ERR_EMPTY) s = SKF_ERR_EMPTY;
  if (s) return skf_collider_free(c), s;
  c->bounded = c->tracer->reach == SKF_OK && iso > 0;
  c->box = c->tracer->region;
  if (c->bounded) {
    c->center = box_center(c->box);
    c->radius = 0.5 * box_diagonal(c->box) * (1 + 1e-12);
  }
  if (!c->tracer->tree) skf_tracer_free(c->tracer), c->tracer = NULL;
  return *out = c, SKF_OK;
}

void skf_collider_free(skf_collider *c) {
  if (c) skf_tracer_free(c->tracer);
  skf_free(c);
}

static skf_outlook enclose(const skf_collider *c, skf_vec3 q, double radius, skf_guess *out) {
  if (!c->tracer) {
    skf_bound b = skf_field_bound(c->field, q, radius);
    return (skf_outlook){b.lo, b.hi, b.gradient, b.hessian, b.fourth};
  }
  skf_ball ball = skf_octree_ball(c->tracer->tree, q, radius);
  out->side = ball.side;
  out->vague = !ball.side && !ball.exhausted && ball.count > FEW;
  if (out->side || out->vague) return (skf_outlook){-INFINITY, INFINITY, 0, 0, 0};
  if (ball.leaf && ball.count > FEW && ball.leaf->bend < INFINITY)
    return (skf_outlook){-INFINITY, INFINITY, ball.leaf->slope, ball.leaf->bend, 0};
  return skf_octree_enclose(c->tracer->tree, &ball, q, radius);
}

skf_guess skf_collider_guess(const skf_collider *c, skf_vec3 q, double radius, double far) {
  skf_guess s = {.side = 0};
  radius += 8 * DBL_EPSILON * far;
  q = v3_add(q, c->origin);
  if (c->bounded && v3_dist(q, c->center) > c->radius + radius) return s.side = -1, s;
  skf_outlook o = enclose(c, q, radius, &s);
  if (s.side || s.vague) return s;
  if (o.hi < c->iso || o.lo > c->iso) return s.side = o.hi < c->iso ? -1 : 1, s;
  double F = skf_field_at(c->field, q, &s.g), g = v3_norm(s.g);
  s.f = F - c->iso, s.slope = o.slope, s.bend = o.bend;
  s.rough = isfinite(F) ? 16 * DBL_EPSILON * (fabs(F) + fabs(c->iso)) + 8 * DBL_EPSILON * g * far : 0;
  double change = fmin(g * radius + 0.5 * o.bend * radius * radius, o.slope * radius) + s.rough;
  if (fabs(s.f) > change) s.side = s.f < 0 ? -1 : 1;
  return s;
}

skf_vec3 skf_pose_point(const skf_pose *p, skf_vec3 x) { return v3_add(p->position, quat_turn(p->q, 1, x)); }
skf_vec3 skf_pose_inverse(const skf_pose *p, skf_vec3 x) { return quat_turn(p->q, -1, v3_sub(x, p->position)); }
skf_vec3 skf_pose_turn(const skf_pose *p, skf_vec3 v) { return quat_turn(p->q, 1, v); }

skf_pose skf_rigid_at(const skf_rigid_motion *m, double t) {
  double u = t - m->t;
  skf_pose p = m->pose;
  p.position = v3_mad(v3_mad(p.position, u, m->velocity), 0.5 * u * u, m->acceleration);
  if (v3_norm2(m->angular_velocity) > 0) quat_rotate(p.q, v3_scale(u, m->angular_velocity));
  return p;
}
