/* SPDX-License-Identifier: MIT */
/* Rays of the renderer: what they meet, what light reaches it, and what comes back along them. */
#include "ray/render.h"

/* A body that many rays can be traced against at once. */
static bool plain(const skf_render_body *b) { return !b->offsets && b->angle == 0 && b->sweep == 0; }

static skf_sight seen(const skf_hit *hit, const skf_beam *beam, int body) {
  skf_sight at = {.body = body, .t = hit->t, .at = hit->at, .normal = hit->normal, .own = hit->at, .time = beam->time};
  at.inside = v3_dot(at.normal, beam->direction) > 0;
  if (at.inside) at.normal = v3_scale(-1, at.normal);
  return at;
}

/* The first surface of one body beyond the ray's start, before *t. */
static bool meet(const skf_render_body *b, const skf_beam *beam, skf_sight *best, int index, skf_ray_report *report) {
  bool turned = b->angle != 0 || b->sweep != 0, found = false;
  skf_ray ray = {beam->from, beam->direction, 0, best->t};
  if (turned) {
    ray.origin = skf_body_own(b, beam->time, beam->from, true);
    ray.direction = skf_body_own(b, beam->time, beam->direction, false);
    /* Turned there and back, a start on the surface is off it by more than rounding. */
    if (beam->depth) ray.t_min = 1e-10 * fmax(v3_norm(ray.origin), v3_norm(b->about));
  }
  skf_hit hit;
  size_t item = 0;
  if (b->offsets)
    found = skf_offsets_first(b->offsets, &ray, &hit, &item);
  else if (skf_tracer_first(b->tracer, &ray, &hit, &found, report))
    found = false;
  if (!found || !(hit.t < best->t)) return false;
  skf_vec3 own = hit.at;
  if (turned) {
    hit.at = v3_mad(beam->from, hit.t, beam->direction);
    hit.normal = skf_body_world(b, beam->time, hit.normal, false);
  }
  *best = seen(&hit, beam, index);
  best->own = own, best->item = item;
  return true;
}

/* The floor, where nothing else is. */
static skf_sight or_ground(const skf_render_scene *s, const skf_beam *beam, skf_sight best) {
  if (best.body != SKF_NOTHING || !s->ground) return best;
  skf_vec3 n = v3_unit(s->ground_normal);
  double t = v3_dot(v3_sub(s->ground_at, beam->from), n) / v3_dot(beam->direction, n);
  if (!(t > 0) || !isfinite(t) || v3_dot(beam->direction, n) > 0) return best;
  skf_vec3 at = v3_mad(beam->from, t, beam->direction);
  return (skf_sight){.body = SKF_GROUND, .t = t, .at = at, .own = at, .normal = n, .time = beam->time};
}

skf_sight skf_look_along(const skf_stage *g, const skf_beam *beam, skf_ray_report *report) {
  const skf_render_scene *s = g->s;
  skf_sight best = {.body = SKF_NOTHING, .t = INFINITY, .time = beam->time};
  for (size_t i = 0; i < s->body_count; i++) meet(s->bodies + i, beam, &best, (int)i, report);
  return or_ground(s, beam, best);
}

void skf_look_many(const skf_stage *g, size_t n, const skf_beam *beams, skf_sight *out) {
  const skf_render_scene *s = g->s;
  for (size_t k = 0; k < n; k++) out[k] = (skf_sight){.body = SKF_NOTHING, .t = INFINITY, .time = beams[k].time};
  for (size_t i = 0; i < s->body_count; i++)
    for (size_t from = 0; from < n; from += SKF_MANY) {
      skf_ray rays[SKF_MANY];
      skf_hit hits[SKF_MANY];
      bool found[SKF_MANY];
      size_t m = n - from < SKF_MANY ? n - from : SKF_MANY;
      if (!plain(s->bodies + i)) {
        for (size_t k = from; k < from + m; k++) meet(s->bodies + i, beams + k, out + k, (int)i, NULL);
        continue;
      }
      for (size_t k = 0; k < m; k++)
        rays[k] = (skf_ray){beams[from + k].from, beams[from + k].direction, 0, out[from + k].t};
      skf_tracer_first_many(s->bodies[i].tracer, m, rays, hits, found,
                            NULL); /* what is wrong with a ray finds nothing */
      for (size_t k = 0; k < m; k++)
        if (found[k] && hits[k].t < out[from + k].t) out[from + k] = seen(hits + k, beams + from + k, (int)i);
    }
  for (size_t k = 0; k < n; k++) out[k] = or_ground(s, beams + k, out[k]);
}

enum { CROSSINGS = 64 }; /* of a shadow ray with bodies that let light through; behind more of them it is dark */

/* How much of the light comes through a body that is clear somewhere. */
static bool filter(const skf_stage *g, size_t body, skf_beam beam, double distance, float rgb[3]) {
  const skf_render_body *b = g->s->bodies + body;
  for (int k = 0; k < CROSSINGS; k++) {
    skf_sight at = {.body = SKF_NOTHING, .t = distance};
    if (!meet(b, &beam, &at, (int)body, NULL)) return true;
    skf_look look;
    skf_palette_at(g->palettes[body], b, &at, &look, NULL);
    for (int c = 0; c < 3; c++) rgb[c] *= (float)look.transparency[c];
    if (!(rgb[0] + rgb[1] + rgb[2] > 1e-4f)) return false;
    beam.from = at.at, beam.depth = 1, distance -= at.t;
  }
  return false;
}

/* Whether any light comes along a ray, and its colour. */
static bool reaches(const skf_stage *g, const skf_sight *at, skf_vec3 direction, double distance, float rgb[3]) {
  const skf_beam beam = {.from = at->at, .direction = direction, .time = at->time, .depth = 1};
  rgb[0] = rgb[1] = rgb[2] = 1;
  for (size_t i = 0; i < g->s->body_count; i++) {
    const skf_render_body *b = g->s->bodies + i;
    bool hit = false;
    if (g->clear[i]) continue;
    if (!plain(b)) {
      skf_sight there = {.body = SKF_NOTHING, .t = distance};
      hit = meet(b, &beam, &there, (int)i, NULL);
    } else {
      skf_ray ray = {at->at, direction, 0, distance};
      if (skf_tracer_occluded(b->tracer, &ray, &hit, NULL)) hit = false;
    }
    if (hit) return rgb[0] = rgb[1] = rgb[2] = 0, false;
  }
  for (size_t i = 0; i < g->s->body_count; i++)
    if (g->clear[i] && !filter(g, i, beam, distance, rgb)) return rgb[0] = rgb[1] = rgb[2] = 0, false;
  return true;
}

/* 32 directions spread evenly over the sphere (a spiral of golden angles). */
static skf_vec3 spread(int k) {
  enum { DIRECTIONS = 2 * SKF_SHARES };
  double z = 1 - (2 * k + 1.0) / DIRECTIONS, s = sqrt(1 - z * z), a = k * 2.399963229728653;
  return v3(s * cos(a), s * sin(a), z);
}

/* The k-th of `rays` directions to the sky. */
static skf_vec3 to_sky(const skf_beam *beam, int k, int rays) {
  enum { ALL = 2 * SKF_SHARES };
  if (beam->share < 0) return spread(k * (ALL / rays) + 1); /* the same everywhere: no noise where nothing smooths it */
  skf_vec3 d = spread((beam->share + SKF_SHARES * (k & 1) + (k >> 1) * 5) % ALL);
  if (k < 2) return d; /* further ones lie between the first 32 */
  return v3_unit(v3_mad(d, 0.35 * (k >> 1), v3(0.3, -0.2 * (k & 2), 0.25 * (k & 1) - 0.1)));
}

static float sky_at(const skf_stage *g, const skf_sight *at, const skf_beam *beam, int rays) {
  double seen = 0, all = 0;
  for (int k = 0; k < rays; k++) {
    float rgb[3];
    skf_vec3 d = to_sky(beam, k, rays);
    double c = v3_dot(d, at->normal);
    if (c < 0) d = v3_scale(-1, d), c = -c;
    all += c;
    if (reaches(g, at, d, INFINITY, rgb)) seen += c * (rgb[0] + rgb[1] + rgb[2]) / 3;
  }
  return (float)(all > 0 ? seen / all : 1);
}

/* A place on a light, one of `rays`: parts of its disc of equal area, along a spiral; of its parallelogram a lattice.
 */
static skf_vec3 to_light(const skf_light *light, const skf_sight *at, const skf_beam *beam, int k, int rays,
                         double *distance) {
  bool sheet = v3_norm2(light->u) > 0 || v3_norm2(light->v) > 0, fixed = beam->share < 0;
  double n = fixed ? rays : SKF_SHARES * rays, part = fixed ? k : beam->share + SKF_SHARES * k;
  double a = (part + (fixed ? 0.5 : beam->jitter[0])) / n, turn = fixed ? 0.5 : beam->jitter[1] / (sheet ? 4 : 16);
  return skf_light_sample(light, at->at, a, fmod(part * 0.38196601125010515 + turn, 1), distance);
}

void skf_light_at(const skf_stage *g, const skf_sight *at, const skf_beam *beam, int sky, int soft, bool hard_only,
                  float *lit) {
  if (!hard_only) lit[0] = sky ? sky_at(g, at, beam, sky) : 1;
  for (size_t l = 0; l < g->light_count; l++) {
    const skf_light *light = g->lights + l;
    float *out = lit + 1 + 3 * l;
    bool hard = skf_light_is_hard(light);
    if (hard_only && !hard) continue;
    int rays = hard ? 1 : soft;
    out[0] = out[1] = out[2] = 0;
    for (int k = 0; k < rays; k++) {
      double distance;
      skf_vec3 to = to_light(light, at, beam, k, rays, &distance);
      float rgb[3];
      if (!(v3_dot(to, at->normal) > 0) || !reaches(g, at, to, distance, rgb)) continue;
      for (int c = 0; c < 3; c++) out[c] += rgb[c] / (float)rays;
    }
  }
}

static void background(const skf_stage *g, const skf_beam *beam, double rgb[3]) {
  double sky[3];
  skf_background(g->s, beam->height >= 0 ? beam->height : skf_view_height(&g->view, beam->direction), rgb);
  if (!beam->mirrored) return;
  skf_sky(&g->view, beam->direction, sky);
  for (int k = 0; k < 3; k++) rgb[k] = fmax(rgb[k], sky[k]);
}

static void light_bounced(const skf_stage *g, const skf_sight *at, const skf_beam *beam, float *lit) {
  bool fine = g->s->quality == SKF_RENDER_FINE, one = beam->scattered;
  bool strong = beam->weight > 0.5;
  skf_light_at(g, at, beam, one ? 1 : fine ? 16 : strong ? 4 : 2, one ? 1 : fine ? 8 : strong ? 3 : 1, false, lit);
}

static void fog(const skf_stage *g, double t, double rgb[3]) {
  const skf_fog *f = &g->s->fog;
  if (!(f->distance > 0)) return;
  double left = exp(-t / f->distance);
  for (int k = 0; k < 3; k++) rgb[k] = f->color[k] + left * (rgb[k] - f->color[k]);
}

/* Adds what comes from another direction, times a share. */
static void follow(const skf_stage *g, const skf_beam *beam, const skf_sight *at, skf_vec3 direction, bool mirror,
                   const double share[3], double rgb[3]) {
  double most = fmax(share[0], fmax(share[1], share[2])), light[3];
  skf_beam next = *beam;
  next.from = at->at, next.direction = direction, next.height = -1;
  if (!beam->scattered) next.share = -1;
  next.depth++, next.weight *= most, next.mirrored = beam->mirrored || mirror;
  if (!(next.weight > 1.0 / 512)) return; /* less than a step of the picture */
  if (next.depth > g->bounces) {
    background(g, &next, light);
    fog(g, INFINITY, light);
  } else {
    skf_sight there = skf_look_along(g, &next, NULL);
    float lit[SKF_LIT];
    if (there.body != SKF_NOTHING) light_bounced(g, &there, &next, lit);
    skf_radiance(g, &next, &there, lit, light);
  }
  for (int k = 0; k < 3; k++) rgb[k] += share[k] * light[k];
}

/* Mirrors and glass. */
static void beyond(const skf_stage *g, const skf_beam *beam, const skf_sight *at, const skf_look *look, skf_vec3 normal,
                   double rgb[3]) {
  double cosine = -v3_dot(beam->direction, normal), n = at->inside ? look->ior : 1 / look->ior, bent = cosine;
  double fresnel = look->ior == 1 ? 0 : skf_fresnel(cosine, n, &bent), mirror[3], through[3];
  for (int k = 0; k < 3; k++) {
    mirror[k] = (at->inside ? 0 : look->reflection[k]) + look->transparency[k] * fresnel;
    through[k] = look->transparency[k] * (1 - fresnel);
  }
  if (mirror[0] + mirror[1] + mirror[2] > 0) {
    skf_vec3 d = v3_mad(beam->direction, 2 * cosine, normal);
    if (!(v3_dot(d, at->normal) > 0)) /* a relief would send it into the surface */
      d = v3_mad(beam->direction, -2 * v3_dot(beam->direction, at->normal), at->normal);
    follow(g, beam, at, v3_unit(d), true, mirror, rgb);
  }
  if (through[0] + through[1] + through[2] > 0) {
    skf_vec3 d = beam->direction;
    if (look->ior != 1) d = v3_unit(v3_mad(v3_scale(n, d), n * cosine - bent, normal));
    follow(g, beam, at, d, false, through, rgb);
  }
}

void skf_radiance(const skf_stage *g, const skf_beam *beam, const skf_sight *at, const float *lit, double rgb[3]) {
  if (at->body < 0) {
    background(g, beam, rgb);
    if (at->body == SKF_GROUND) skf_shade_ground(g, at, lit, rgb);
  } else {
    skf_look look;
    skf_vec3 normal, eye = v3_scale(-1, beam->direction);
    skf_palette_at(g->palettes[at->body], g->s->bodies + at->body, at, &look, &normal);
    if (!(v3_dot(normal, eye) > 0)) normal = at->normal;
    if (!g->bounces) look.transparency[0] = look.transparency[1] = look.transparency[2] = 0;
    skf_shade(g, &look, at, normal, eye, lit, rgb);
    if (g->bounces > 0) beyond(g, beam, at, &look, normal, rgb);
  }
  fog(g, at->t, rgb);
}
