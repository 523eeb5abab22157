/* SPDX-License-Identifier: MIT */
/* The renderer: one ray through each pixel's centre, light on what they meet, more rays where the picture needs them.
   With a lens or an open shutter: many rays for every pixel. */
#include "ray/render.h"
#include "core/alloc.h"
#include <omp.h>

typedef struct render {
  skf_stage stage;
  const skf_render_scene *s;
  bool *clear;
  skf_sight *sights;
  int stride;       /* floats of a lit place */
  float *raw, *lit; /* from each pixel's own rays, smoothed twice in the end; smoothed once */
  unsigned char *marks;
  float *rgb;
  float *evaluations, *cells;
  skf_progress progress;
  double done, share; /* of the whole work: before this pass, in it */
  int rows;           /* finished in this pass */
  bool stop;
} render;

/* Pixels look for sky and lights in a part of the directions each; those of a block share them out, and smoothing over
   a block brings all of them together. */
enum { BLOCK = 4 };

/* Which share of the directions a pixel has: neighbours get distant ones. */
static int share_of(int x, int y) {
  static const unsigned char order[BLOCK][BLOCK] = {{0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}};
  return order[y % BLOCK][x % BLOCK];
}

static double hashed(int x, int y, unsigned k) {
  unsigned h = (unsigned)x * 73856093u ^ (unsigned)y * 19349663u ^ k * 83492791u;
  h = (h ^ h >> 15) * 0x2c1b3c6du, h = (h ^ h >> 12) * 0x297a2d39u;
  return (h ^ h >> 15) / 4294967296.0;
}

/* Through a place of the picture, in the middle of the lens and of the shutter's time. */
static skf_beam camera_beam(const render *r, double px, double py) {
  int w = r->s->width, h = r->s->height, x = (int)px, y = (int)py;
  return (skf_beam){.from = skf_view_origin(&r->stage.view, w, h, px, py),
                    .direction = skf_view_ray(&r->stage.view, w, h, px, py),
                    .time = 0.5,
                    .share = share_of(x, y),
                    .jitter = {hashed(x, y, 1), hashed(x, y, 2)},
                    .weight = 1,
                    .height = 1 - py / h};
}

static void light_at(const render *r, const skf_sight *at, const skf_beam *beam, float *lit) {
  if (r->s->quality == SKF_RENDER_DRAFT) {
    for (int k = 0; k < r->stride; k++) lit[k] = 1;
    return;
  }
  int times = r->s->quality == SKF_RENDER_FINE ? 4 : 1;
  skf_light_at(&r->stage, at, beam, 2 * times, times, false, lit);
}

/* Whether two pixels see one smooth piece of surface. */
static bool alike(const skf_sight *a, const skf_sight *b) {
  if (a->body != b->body || a->inside != b->inside) return false;
  if (a->body == SKF_NOTHING) return true;
  skf_vec3 way = v3_sub(b->at, a->at);
  return v3_dot(a->normal, b->normal) > 0.9 && fabs(v3_dot(way, a->normal)) <= 0.5 * v3_norm(way) + 1e-12 * a->t;
}

/* The mean over a block of pixels that starts at (x0, y0) and holds (x, y), of those like it; hard light stays. */
static void smooth_light(const render *r, const float *from, int x, int y, int x0, int y0, float *out) {
  int w = r->s->width, h = r->s->height, n = 0, stride = r->stride;
  size_t own = (size_t)y * w + x;
  float sum[SKF_LIT] = {0};
  for (int j = y0; j < y0 + BLOCK; j++)
    for (int i = x0; i < x0 + BLOCK; i++) {
      size_t k = (size_t)j * w + i;
      if (i < 0 || j < 0 || i >= w || j >= h || !alike(r->sights + own, r->sights + k)) continue;
      for (int c = 0; c < stride; c++) sum[c] += from[k * stride + c];
      n++;
    }
  for (int c = 0; c < stride; c++) {
    bool keep = n == 0 || (c && skf_light_is_hard(r->stage.lights + (c - 1) / 3)); /* n = 0: no normal */
    out[c] = keep ? from[own * stride + c] : sum[c] / (float)n;
  }
}

/* The light on what a ray beside a pixel's centre meets: that of the nearest pixel on the same piece, or its own. */
static void borrowed_light(const render *r, const skf_sight *at, const skf_beam *beam, int x, int y, float *lit) {
  int w = r->s->width, h = r->s->height;
  double nearest = INFINITY;
  size_t from = 0;
  for (int j = y - 1; j <= y + 1; j++)
    for (int i = x - 1; i <= x + 1; i++) {
      size_t k = (size_t)j * w + i;
      if (i < 0 || j < 0 || i >= w || j >= h || !alike(at, r->sights + k)) continue;
      double d = v3_dist(at->at, r->sights[k].at);
      if (d < nearest) nearest = d, from = k;
    }
  if (!isfinite(nearest)) {
    light_at(r, at, beam, lit);
    return;
  }
  for (int c = 0; c < r->stride; c++) lit[c] = r->raw[from * r->stride + c];
  if (r->s->quality != SKF_RENDER_DRAFT) skf_light_at(&r->stage, at, beam, 0, 0, true, lit);
}

/* Whether the pixel's neighbours show something else or another brightness. */
static bool uneven(const render *r, int x, int y) {
  int w = r->s->width, h = r->s->height;
  size_t here = (size_t)y * w + x;
  for (int j = y - 1; j <= y + 1; j++)
    for (int i = x - 1; i <= x + 1; i++) {
      if (i < 0 || j < 0 || i >= w || j >= h) continue;
      size_t k = (size_t)j * w + i;
      if (!alike(r->sights + here, r->sights + k)) return true;
      double a = 0, b = 0;
      for (int c = 0; c < 3; c++) a += r->rgb[3 * here + c], b += r->rgb[3 * k + c];
      if (fabs(a - b) > 0.05 * (a + b)) return true;
    }
  return false;
}

static void sight_row(render *r, int y) {
  int w = r->s->width;
  for (int from = 0; from < w; from += SKF_MANY) {
    skf_beam beams[SKF_MANY];
    int n = w - from < SKF_MANY ? w - from : SKF_MANY;
    for (int i = 0; i < n; i++) beams[i] = camera_beam(r, from + i + 0.5, y + 0.5);
    skf_look_many(&r->stage, (size_t)n, beams, r->sights + (size_t)y * w + from);
  }
}

static void cost_row(render *r, int y) {
  int w = r->s->width;
  for (int x = 0; x < w; x++) {
    skf_beam beam = camera_beam(r, x + 0.5, y + 0.5);
    skf_ray_report report = {0};
    size_t k = (size_t)y * w + x;
    skf_look_along(&r->stage, &beam, &report);
    if (r->evaluations) r->evaluations[k] = (float)report.evaluations;
    if (r->cells) r->cells[k] = (float)report.cells;
  }
}

static void light_row(render *r, int y) {
  int w = r->s->width;
  for (int x = 0; x < w; x++) {
    size_t k = (size_t)y * w + x;
    skf_beam beam = camera_beam(r, x + 0.5, y + 0.5);
    if (r->sights[k].body != SKF_NOTHING) light_at(r, r->sights + k, &beam, r->raw + k * r->stride);
  }
}

/* One block is not centred on its pixel; two, shifted either way, are. */
static void smooth_row(render *r, int y) {
  for (int x = 0; x < r->s->width; x++) {
    size_t k = (size_t)y * r->s->width + x;
    smooth_light(r, r->raw, x, y, x - 1, y - 1, r->lit + k * r->stride);
  }
}

static void smooth_again_row(render *r, int y) {
  for (int x = 0; x < r->s->width; x++) {
    size_t k = (size_t)y * r->s->width + x;
    smooth_light(r, r->lit, x, y, x - 2, y - 2, r->raw + k * r->stride);
  }
}

static void put(render *r, size_t k, const double rgb[3]) {
  for (int c = 0; c < 3; c++) r->rgb[3 * k + c] = (float)rgb[c];
}

static void shade_row(render *r, int y) {
  int w = r->s->width;
  for (int x = 0; x < w; x++) {
    size_t k = (size_t)y * w + x;
    double rgb[3];
    skf_beam beam = camera_beam(r, x + 0.5, y + 0.5);
    skf_radiance(&r->stage, &beam, r->sights + k, r->raw + k * r->stride, rgb);
    put(r, k, rgb);
  }
}

/* What a stop left unpainted, which is NAN. */
static void fill_row(render *r, int y) {
  if (isnan(r->rgb[3 * (size_t)y * r->s->width])) shade_row(r, y);
}

/* Samples lie on a lattice of rank one, which has one of them in each row and column of a finer grid. */
static void refine_row(render *r, int y) {
  int w = r->s->width, n = r->s->samples;
  for (int x = 0; x < w; x++) {
    if (!r->marks[(size_t)y * w + x]) continue;
    double sum[3] = {0, 0, 0}, rgb[3];
    for (int i = 0; i < n; i++) {
      skf_beam beam = camera_beam(r, x + (i + 0.5) / n, y + fmod(0.5 + i * 0.6180339887498949, 1));
      skf_sight at = skf_look_along(&r->stage, &beam, NULL);
      float lit[SKF_LIT];
      if (at.body != SKF_NOTHING) borrowed_light(r, &at, &beam, x, y, lit);
      skf_radiance(&r->stage, &beam, &at, lit, rgb);
      for (int c = 0; c < 3; c++) sum[c] += rgb[c] / n;
    }
    put(r, (size_t)y * w + x, sum);
  }
}

/* Before any pixel changes: which ones refine_row takes. */
static void mark_row(render *r, int y) {
  for (int x = 0; x < r->s->width; x++) r->marks[(size_t)y * r->s->width + x] = uneven(r, x, y);
}

/* Place in the pixel, on the lens, in time, on the lights: a lattice of rank one in all of them [Roberts 2018], shifted
   by the pixel. */
static skf_beam scattered_beam(const render *r, int x, int y, int i) {
  static const double step[7] = {0.8812714616335696, 0.7766393890897682,  0.6844301295853426, 0.6031687406857282,
                                 0.5315553977157913, 0.46844460228420865, 0.4128267389};
  double u[7];
  for (unsigned k = 0; k < 7; k++) u[k] = fmod(hashed(x, y, k) + i * step[k], 1);
  skf_beam beam = camera_beam(r, x + u[0], y + u[1]);
  double out = sqrt(u[2]), turn = 2 * SKF_PI * u[3];
  if (r->stage.view.aperture > 0)
    skf_view_lens(&r->stage.view, out * cos(turn), out * sin(turn), &beam.from, &beam.direction);
  beam.scattered = true;
  beam.time = u[4], beam.jitter[0] = u[5], beam.jitter[1] = u[6], beam.share = (share_of(x, y) + i) % SKF_SHARES;
  return beam;
}

/* More rays until the mean's standard error is below a step that is seen. */
static void scatter_row(render *r, int y) {
  enum { BATCH = 16 };
  for (int x = 0; x < r->s->width; x++) {
    double sum[3] = {0, 0, 0}, squares = 0, rgb[3];
    int n = 0;
    for (bool enough = false; !enough && n < r->s->samples;) {
      for (int i = 0; i < BATCH && n < r->s->samples; i++, n++) {
        skf_beam beam = scattered_beam(r, x, y, n);
        skf_sight at = skf_look_along(&r->stage, &beam, NULL);
        float lit[SKF_LIT];
        if (at.body != SKF_NOTHING) light_at(r, &at, &beam, lit);
        skf_radiance(&r->stage, &beam, &at, lit, rgb);
        for (int c = 0; c < 3; c++) sum[c] += rgb[c];
        squares += (rgb[0] + rgb[1] + rgb[2]) * (rgb[0] + rgb[1] + rgb[2]);
      }
      double mean = (sum[0] + sum[1] + sum[2]) / n, error2 = fmax(squares / n - mean * mean, 0) / n;
      enough = error2 < 1e-4 * (mean + 0.05) * (mean + 0.05);
    }
    for (int c = 0; c < 3; c++) rgb[c] = sum[c] / n;
    put(r, (size_t)y * r->s->width + x, rgb);
  }
}

static void pass(render *r, void (*row)(render *, int), double share) {
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

static bool scattered(const render *r) {
  bool moves = false;
  for (size_t i = 0; i < r->s->body_count; i++) moves = moves || r->s->bodies[i].sweep != 0;
  return (moves || r->stage.view.aperture > 0) && r->s->samples > 1;
}

static void all_passes(render *r) {
  size_t n = (size_t)r->s->width * r->s->height;
  bool draft = r->s->quality == SKF_RENDER_DRAFT, many = scattered(r);
  for (size_t k = 0; k < n; k++) r->sights[k] = (skf_sight){.body = SKF_NOTHING, .t = INFINITY, .time = 0.5};
  for (size_t k = 0; k < n * r->stride; k++) r->raw[k] = 1;
  for (size_t k = 0; k < 3 * n; k++) r->rgb[k] = NAN;
  pass(r, sight_row, many ? 0.02 : draft ? 0.6 : 0.3);
  if (!draft && !many) pass(r, light_row, 0.4);
  bool stopped = r->stop;
  int bounces = r->stage.bounces;
  r->stop = false; /* what follows is cheap, and done also after a stop: the picture is made of what is known */
  if (!draft && !many) pass(r, smooth_row, 0), pass(r, smooth_again_row, 0);
  if (stopped || many) r->stage.bounces = 0; /* many: it is painted over */
  pass(r, shade_row, r->stage.bounces ? 0.1 : 0);
  if (r->stop) stopped = true, r->stop = false, r->stage.bounces = 0, pass(r, fill_row, 0);
  r->stage.bounces = bounces;
  r->stop = stopped;
  if (r->stop || r->s->samples < 2) return;
  if (many) {
    pass(r, scatter_row, 0.98);
    return;
  }
  pass(r, mark_row, 0);
  pass(r, refine_row, 1 - r->done);
}

static skf_status open_stage(render *r) {
  const skf_render_scene *s = r->s;
  skf_stage *g = &r->stage;
  skf_status status = skf_view_make(&s->camera, (double)s->width / s->height, &g->view);
  if (status) return status;
  g->s = s, g->lights = s->lights, g->light_count = s->light_count;
  g->bounces = s->quality == SKF_RENDER_DRAFT || s->bounces < 0 ? 0 : s->bounces ? s->bounces : SKF_RENDER_BOUNCES;
  if (!g->light_count) {
    skf_lights_default(&g->view, g->own_lights);
    g->lights = g->own_lights, g->light_count = 3;
  }
  r->stride = 1 + 3 * (int)g->light_count;
  g->palettes = skf_alloc(s->body_count, sizeof *g->palettes);
  g->clear = r->clear = skf_alloc(s->body_count, sizeof *r->clear);
  if (!g->palettes || !r->clear) return SKF_ERR_NOMEM;
  for (size_t i = 0; i < s->body_count && !status; i++) {
    r->clear[i] = skf_look_is_clear(s->bodies + i);
    status = skf_palette_new(s->bodies + i, g->palettes + i);
  }
  return status;
}

static void close_stage(render *r) {
  for (size_t i = 0; r->stage.palettes && i < r->s->body_count; i++) skf_palette_free(r->stage.palettes[i]);
  skf_free(r->stage.palettes), skf_free(r->clear);
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
  render r = {.s = s, .rgb = rgb, .progress = progress};
  size_t n = (size_t)s->width * s->height;
  skf_status status = open_stage(&r);
  if (!status) {
    r.sights = skf_alloc(n, sizeof *r.sights);
    r.raw = skf_alloc(n * r.stride, sizeof *r.raw);
    r.lit = skf_alloc(n * r.stride, sizeof *r.lit);
    r.marks = skf_alloc(n, 1);
    if (!r.sights || !r.raw || !r.lit || !r.marks) status = SKF_ERR_NOMEM;
  }
  if (!status) all_passes(&r);
  for (size_t k = 0; !status && depth && k < n; k++) depth[k] = r.sights[k].body >= 0 ? (float)r.sights[k].t : INFINITY;
  close_stage(&r);
  return status ? status : r.stop ? SKF_ERR_CANCELLED : SKF_OK;
}

skf_status skf_render_cost(const skf_render_scene *s, float *evaluations, float *cells, skf_progress progress) {
  if (!acceptable(s)) return SKF_ERR_ARG;
  render r = {.s = s, .evaluations = evaluations, .cells = cells, .progress = progress};
  skf_status status = open_stage(&r);
  for (size_t k = 0; k < (size_t)s->width * s->height; k++) {
    if (evaluations) evaluations[k] = 0;
    if (cells) cells[k] = 0;
  }
  if (!status) pass(&r, cost_row, 1);
  close_stage(&r);
  return status ? status : r.stop ? SKF_ERR_CANCELLED : SKF_OK;
}
