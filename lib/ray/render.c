/* SPDX-License-Identifier: MIT */
/* The renderer: one ray through each pixel's centre, light on what they meet, more rays where the picture needs them.
   With a lens or an open shutter: many rays for every pixel. */
#include "ray/render_rows.h"
#include "core/alloc.h"
#include <omp.h>

static void pass(skf_picture *r, skf_row *row, double share) {
  r->share = share, r->rows = 0;
#pragma omp parallel for schedule(dynamic, 2)
  for (int y = 0; y < r->s->height; y++) {
    bool stop;
#pragma omp atomic read
    stop = r->stop;
    if (stop) continue;
    row(r, y);
    int rows;
#pragma omp atomic capture
    rows = ++r->rows;
    if (omp_get_thread_num() == 0 && r->progress.report && share > 0 &&
        r->progress.report(r->progress.user, r->done + share * rows / r->s->height)) {
#pragma omp atomic write
      r->stop = true;
    }
  }
  r->done += share;
}

static bool scattered(const skf_picture *r) {
  bool moves = false;
  for (size_t i = 0; i < r->s->body_count; i++) moves = moves || r->s->bodies[i].sweep != 0;
  return (moves || r->stage.view.aperture > 0) && r->s->samples > 1;
}

/* Whether each row can be finished by itself. */
static bool sketched(const skf_picture *r) {
  return r->s->quality == SKF_RENDER_DRAFT && !scattered(r) && r->s->samples < 2;
}

/* One pass, and after a stop what it has left. */
static void sketch(skf_picture *r) {
  pass(r, skf_row_draft, 1);
  bool stopped = r->stop;
  r->stop = false;
  if (stopped) pass(r, skf_row_fill, 0);
  r->stop = stopped;
}

static void all_passes(skf_picture *r) {
  size_t n = (size_t)r->s->width * r->s->height;
  bool draft = r->s->quality == SKF_RENDER_DRAFT, many = scattered(r);
  for (size_t k = 0; k < n; k++) r->sights[k].body = SKF_NOTHING, r->sights[k].t = INFINITY, r->sights[k].time = 0.5;
  for (size_t k = 0; k < n * r->stride; k++) r->raw[k] = 1;
  pass(r, skf_row_sight, many ? 0.02 : draft ? 0.6 : 0.3);
  if (!draft && !many) pass(r, skf_row_light, 0.4);
  bool stopped = r->stop;
  int bounces = r->stage.bounces;
  r->stop = false; /* what follows is cheap, and done also after a stop: the picture is made of what is known */
  if (!draft && !many) pass(r, skf_row_smooth, 0), pass(r, skf_row_smooth_again, 0);
  if (stopped || many) r->stage.bounces = 0; /* many: it is painted over */
  pass(r, skf_row_shade, r->stage.bounces ? 0.1 : 0);
  if (r->stop) stopped = true, r->stop = false, r->stage.bounces = 0, pass(r, skf_row_fill, 0);
  r->stage.bounces = bounces;
  r->stop = stopped;
  if (r->stop || r->s->samples < 2) return;
  if (many) {
    pass(r, skf_row_scatter, 0.98);
    return;
  }
  pass(r, skf_row_mark, 0);
  pass(r, skf_row_refine, 1 - r->done);
}

static skf_status open_stage(skf_picture *r) {
  const skf_render_scene *s = r->s;
  skf_stage *g = &r->stage;
  skf_status status = skf_view_make(&s->camera, (double)s->width / s->height, &g->view);
  if (status) return status;
  g->s = s, g->light_count = s->light_count;
  for (size_t l = 0; l < g->light_count; l++) g->lights[l] = s->lights[l];
  g->bounces = s->quality == SKF_RENDER_DRAFT || s->bounces < 0 ? 0 : s->bounces ? s->bounces : SKF_RENDER_BOUNCES;
  if (!g->light_count) skf_lights_default(&g->view, g->lights), g->light_count = 3;
  for (size_t l = 0; l < g->light_count; l++) g->hard[l] = skf_light_is_hard(g->lights + l);
  for (size_t l = 0; l < g->light_count; l++)
    if (g->lights[l].directional) g->lights[l].at = v3_unit(g->lights[l].at);
  skf_light_directions(g->directions);
  g->shade = skf_shade_pick();
  r->stride = 1 + 3 * (int)g->light_count;
  g->palettes = skf_alloc(s->body_count, sizeof *g->palettes);
  g->clear = skf_alloc(s->body_count, sizeof *g->clear);
  g->bodies = skf_alloc(s->body_count, sizeof *g->bodies);
  g->looks = skf_alloc(s->body_count, sizeof *g->looks);
  if (!g->palettes || !g->clear || !g->bodies || !g->looks) return SKF_ERR_NOMEM;
  for (size_t i = 0; i < s->body_count && !status; i++) {
    skf_render_body *b = g->bodies + i;
    *b = s->bodies[i];
    if (!b->look_count) {
      g->looks[i] = skf_look_default();
      for (int k = 0; k < 3; k++) g->looks[i].color[k] = b->color[k];
      b->looks = g->looks + i, b->look_count = 1;
    }
    g->clear[i] = skf_look_is_clear(b);
    status = skf_palette_new(b, g->palettes + i);
  }
  return status;
}

static void close_stage(skf_picture *r) {
  for (size_t i = 0; r->stage.palettes && i < r->s->body_count; i++) skf_palette_free(r->stage.palettes[i]);
  skf_free(r->stage.palettes), skf_free(r->stage.clear), skf_free(r->stage.bodies), skf_free(r->stage.looks);
  skf_free(r->sights), skf_free(r->raw), skf_free(r->lit), skf_free(r->marks);
}

static bool acceptable(const skf_render_scene *s) {
  if (s->width < 1 || s->height < 1 || s->samples < 1 || s->light_count > SKF_RENDER_LIGHTS) return false;
  for (size_t i = 0; i < s->body_count; i++)
    if ((!s->bodies[i].tracer && !s->bodies[i].offsets) || s->bodies[i].look_count > SKF_LOOKS) return false;
  return true;
}

skf_status skf_render(const skf_render_scene *s, float *rgb, float *depth, skf_progress progress) {
  if (!acceptable(s)) return SKF_ERR_ARG;
  skf_picture r = {.s = s, .rgb = rgb, .depth = depth, .progress = progress};
  size_t n = (size_t)s->width * s->height;
  skf_status status = open_stage(&r);
  bool alone = !status && sketched(&r);
  for (int y = 0; y < s->height; y++) rgb[3 * (size_t)y * s->width] = NAN; /* not painted yet */
  for (size_t k = 0; depth && k < n; k++) depth[k] = INFINITY;
  if (!status && !alone) {
    r.sights = skf_alloc(n, sizeof *r.sights);
    r.raw = skf_alloc(n * r.stride, sizeof *r.raw);
    r.lit = skf_alloc(n * r.stride, sizeof *r.lit);
    r.marks = skf_alloc(n, 1);
    if (!r.sights || !r.raw || !r.lit || !r.marks) status = SKF_ERR_NOMEM;
  }
  if (alone) sketch(&r);
  if (!status && !alone) all_passes(&r);
  for (size_t k = 0; r.sights && depth && !status && k < n; k++)
    if (r.sights[k].body >= 0) depth[k] = (float)r.sights[k].t;
  close_stage(&r);
  return status ? status : r.stop ? SKF_ERR_CANCELLED : SKF_OK;
}

skf_status skf_render_cost(const skf_render_scene *s, float *evaluations, float *cells, skf_progress progress) {
  if (!acceptable(s)) return SKF_ERR_ARG;
  skf_picture r = {.s = s, .evaluations = evaluations, .cells = cells, .progress = progress};
  skf_status status = open_stage(&r);
  for (size_t k = 0; k < (size_t)s->width * s->height; k++) {
    if (evaluations) evaluations[k] = 0;
    if (cells) cells[k] = 0;
  }
  if (!status) pass(&r, skf_row_cost, 1);
  close_stage(&r);
  return status ? status : r.stop ? SKF_ERR_CANCELLED : SKF_OK;
}
