/* SPDX-License-Identifier: MIT */
/* What light reaches a place. */
#include "ray/render.h"

enum { CROSSINGS = 64 }; /* of a shadow ray with bodies that let light through; behind more of them it is dark */

/* How much of the light comes through a body that is clear somewhere. */
static bool filter(const skf_stage *g, size_t body, skf_beam beam, double distance, float rgb[3]) {
  const skf_render_body *b = g->bodies + body;
  for (int k = 0; k < CROSSINGS; k++) {
    skf_sight at = {.body = SKF_NOTHING, .t = distance};
    if (!skf_meet(b, &beam, &at, (int)body, NULL)) return true;
    skf_look room;
    const skf_look *look = skf_palette_at(g->palettes[body], b, &at, &room, NULL);
    for (int c = 0; c < 3; c++) rgb[c] *= (float)look->transparency[c];
    if (!(rgb[0] + rgb[1] + rgb[2] > 1e-4f)) return false;
    beam.from = at.at, beam.depth = 1, distance -= at.t;
  }
  return false;
}

/* Rays on their way to the light, from places that are seen. */
typedef struct asked {
  size_t n;
  skf_vec3 direction[SKF_MANY];
  double distance[SKF_MANY];
  const skf_sight *at[SKF_MANY];
  /* Where it goes: into the sky's mean with a weight, or into a light's colour in so many parts. */
  double *sky[SKF_MANY], weight[SKF_MANY];
  float *light[SKF_MANY], parts[SKF_MANY];
} asked;

static skf_beam beam_of(const asked *q, size_t k) {
  return (skf_beam){.from = q->at[k]->at, .direction = q->direction[k], .time = q->at[k]->time, .depth = 1};
}

/* Which of the rays an opaque body stops. */
static void stop_at(const skf_render_body *b, const asked *q, bool *dark) {
  skf_ray rays[SKF_MANY];
  bool hit[SKF_MANY];
  size_t which[SKF_MANY], n = 0;
  for (size_t k = 0; k < q->n; k++) {
    if (dark[k]) continue;
    skf_beam beam = beam_of(q, k);
    rays[n] = skf_body_ray(b, &beam, q->distance[k]), which[n++] = k;
  }
  if (n == 0) return;
  if (b->offsets) {
    skf_hit unused;
    for (size_t i = 0; i < n; i++) hit[i] = skf_offsets_first(b->offsets, rays + i, &unused, NULL);
  } else {
    skf_tracer_occluded_many(b->tracer, n, rays, hit, NULL); /* what is wrong with a ray stops nothing */
  }
  for (size_t i = 0; i < n; i++) dark[which[i]] = hit[i];
}

/* What comes along all of them; the list is empty then. */
static void answer(const skf_stage *g, asked *q) {
  bool dark[SKF_MANY] = {false};
  for (size_t i = 0; i < g->s->body_count; i++)
    if (!g->clear[i]) stop_at(g->bodies + i, q, dark);
  for (size_t k = 0; k < q->n; k++) {
    float rgb[3] = {1, 1, 1};
    for (size_t i = 0; i < g->s->body_count && !dark[k]; i++)
      dark[k] = g->clear[i] && !filter(g, i, beam_of(q, k), q->distance[k], rgb);
    if (dark[k]) continue;
    if (q->sky[k]) *q->sky[k] += q->weight[k] * (rgb[0] + rgb[1] + rgb[2]) / 3;
    for (int c = 0; c < 3 && !q->sky[k]; c++) q->light[k][c] += rgb[c] / q->parts[k];
  }
  q->n = 0;
}

static void ask(const skf_stage *g, asked *q, const skf_sight *at, skf_vec3 direction, double distance, double *sky,
                double weight, float *light, int parts) {
  if (q->n == SKF_MANY) answer(g, q);
  size_t k = q->n++;
  q->at[k] = at, q->direction[k] = direction, q->distance[k] = distance;
  q->sky[k] = sky, q->weight[k] = weight, q->light[k] = light, q->parts[k] = (float)parts;
}

void skf_light_directions(skf_vec3 *out) {
  for (int k = 0; k < SKF_DIRECTIONS; k++) { /* a spiral of golden angles */
    double z = 1 - (2 * k + 1.0) / SKF_DIRECTIONS, s = sqrt(1 - z * z), a = k * 2.399963229728653;
    out[k] = v3(s * cos(a), s * sin(a), z);
  }
}

/* The k-th of `rays` directions to the sky. */
static skf_vec3 to_sky(const skf_stage *g, const skf_beam *beam, int k, int rays) {
  enum { ALL = SKF_DIRECTIONS };
  /* the same everywhere: no noise where nothing smooths it */
  if (beam->share < 0) return g->directions[(k * (ALL / rays) + 1) % ALL];
  skf_vec3 d = g->directions[(beam->share + SKF_SHARES * (k & 1) + (k >> 1) * 5) % ALL];
  if (k < 2) return d; /* further ones lie between the first 32 */
  return v3_unit(v3_mad(d, 0.35 * (k >> 1), v3(0.3, -0.2 * (k & 2), 0.25 * (k & 1) - 0.1)));
}

/* Rays that go nearly the same way follow each other. */
static void ask_sky(const skf_stage *g, asked *q, size_t n, const skf_sight *const *at, const skf_beam *beams, int rays,
                    float *const *lit) {
  double seen[SKF_MANY] = {0}, all[SKF_MANY] = {0};
  for (int k = 0; k < rays; k++)
    for (size_t i = 0; i < n; i++) {
      skf_vec3 d = to_sky(g, beams + i, k, rays);
      double c = v3_dot(d, at[i]->normal);
      if (c < 0) d = v3_scale(-1, d), c = -c;
      all[i] += c;
      ask(g, q, at[i], d, INFINITY, seen + i, c, NULL, 0);
    }
  answer(g, q);
  for (size_t i = 0; i < n; i++) lit[i][0] = (float)(all[i] > 0 ? seen[i] / all[i] : 1);
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

void skf_light_many(const skf_stage *g, size_t n, const skf_sight *const *at, const skf_beam *beams, int sky, int soft,
                    bool hard_only, float *const *lit) {
  asked q;
  q.n = 0;
  if (!hard_only) ask_sky(g, &q, n, at, beams, sky, lit);
  for (size_t l = 0; l < g->light_count; l++) {
    const skf_light *light = g->lights + l;
    bool hard = g->hard[l];
    if (hard_only && !hard) continue;
    int rays = hard ? 1 : soft;
    for (int k = 0; k < rays; k++)
      for (size_t i = 0; i < n; i++) {
        double distance;
        float *out = lit[i] + 1 + 3 * l;
        if (k == 0) out[0] = out[1] = out[2] = 0;
        skf_vec3 to = to_light(light, at[i], beams + i, k, rays, &distance);
        if (v3_dot(to, at[i]->normal) > 0) ask(g, &q, at[i], to, distance, NULL, 0, out, rays);
      }
  }
  answer(g, &q);
}

void skf_light_at(const skf_stage *g, const skf_sight *at, const skf_beam *beam, int sky, int soft, float *lit) {
  skf_light_many(g, 1, &at, beam, sky, soft, false, &lit);
}
