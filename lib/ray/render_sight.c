/* SPDX-License-Identifier: MIT */
/* What rays meet. */
#include "ray/render.h"

static bool moves(const skf_render_body *b) { return b->angle != 0 || b->sweep != 0 || v3_norm2(b->shift) > 0; }

static skf_ray plain_ray(const skf_beam *beam, double t_max) {
  return (skf_ray){beam->from, beam->direction, 0, t_max};
}

skf_ray skf_body_ray(const skf_render_body *b, const skf_beam *beam, double t_max) {
  skf_ray ray = plain_ray(beam, t_max);
  if (!moves(b)) return ray;
  skf_body_own(b, beam->time, &ray.origin, &ray.direction);
  /* Moved there and back, a start on the surface is off it by more than rounding. */
  if (beam->depth) ray.t_min = 1e-10 * fmax(v3_norm(ray.origin), fmax(v3_norm(b->about), v3_norm(b->shift)));
  return ray;
}

/* A hit in the body's own frame, as the beam sees it. */
static void see(skf_sight *at, const skf_render_body *b, int body, bool moved, const skf_hit *hit,
                const skf_beam *beam) {
  at->body = body, at->t = hit->t, at->at = at->own = hit->at, at->normal = hit->normal;
  if (moved) {
    at->at = v3_mad(beam->from, hit->t, beam->direction);
    at->normal = skf_body_world(b, beam->time, hit->normal);
  }
  at->inside = v3_dot(at->normal, beam->direction) > 0;
  if (at->inside) at->normal = v3_scale(-1, at->normal);
  at->item = 0;
}

bool skf_meet(const skf_render_body *b, const skf_beam *beam, skf_sight *best, int index, skf_ray_report *report) {
  skf_ray ray = skf_body_ray(b, beam, best->t);
  skf_hit hit;
  size_t item = 0;
  bool found = false;
  if (b->offsets)
    found = skf_offsets_first(b->offsets, &ray, &hit, &item);
  else if (skf_tracer_first(b->tracer, &ray, &hit, &found, report))
    found = false;
  if (!found || !(hit.t < best->t)) return false;
  see(best, b, index, moves(b), &hit, beam), best->item = item;
  return true;
}

/* The floor, where nothing else is. */
static void add_ground(const skf_render_scene *s, const skf_beam *beam, skf_sight *best) {
  if (best->body != SKF_NOTHING) return;
  skf_vec3 n = v3_unit(s->ground_normal);
  double t = v3_dot(v3_sub(s->ground_at, beam->from), n) / v3_dot(beam->direction, n);
  if (!(t > 0) || !isfinite(t) || v3_dot(beam->direction, n) > 0) return;
  skf_vec3 at = v3_mad(beam->from, t, beam->direction);
  *best = (skf_sight){.body = SKF_GROUND, .t = t, .at = at, .own = at, .normal = n, .time = beam->time};
}

skf_sight skf_look_along(const skf_stage *g, const skf_beam *beam, skf_ray_report *report) {
  const skf_render_scene *s = g->s;
  skf_sight best = {.body = SKF_NOTHING, .t = INFINITY, .time = beam->time};
  for (size_t i = 0; i < s->body_count; i++) skf_meet(s->bodies + i, beam, &best, (int)i, report);
  if (s->ground) add_ground(s, beam, &best);
  return best;
}

static void meet_many(const skf_render_body *b, int index, size_t n, const skf_beam *beams, skf_sight *out) {
  skf_ray rays[SKF_MANY];
  skf_hit hits[SKF_MANY];
  bool found[SKF_MANY];
  if (n == 0) return;
  bool moved = moves(b);
  for (size_t k = 0; k < n; k++)
    rays[k] = moved ? skf_body_ray(b, beams + k, out[k].t) : plain_ray(beams + k, out[k].t);
  skf_tracer_first_many(b->tracer, n, rays, hits, found, NULL); /* what is wrong with a ray finds nothing */
  for (size_t k = 0; k < n; k++)
    if (found[k] && hits[k].t < out[k].t) see(out + k, b, index, moved, hits + k, beams + k);
}

void skf_look_many(const skf_stage *g, size_t n, const skf_beam *beams, skf_sight *out) {
  const skf_render_scene *s = g->s;
  for (size_t k = 0; k < n; k++) out[k].body = SKF_NOTHING, out[k].t = INFINITY, out[k].time = beams[k].time;
  for (size_t i = 0; i < s->body_count; i++) {
    const skf_render_body *b = s->bodies + i;
    if (!b->offsets) meet_many(b, (int)i, n, beams, out);
    for (size_t k = 0; k < n && b->offsets; k++) skf_meet(b, beams + k, out + k, (int)i, NULL);
  }
  for (size_t k = 0; k < n && s->ground; k++) add_ground(s, beams + k, out + k);
}
