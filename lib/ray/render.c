/* SPDX-License-Identifier: MIT */
/* The renderer: one ray through each pixel's centre, light on what they meet, more rays where the picture needs them.
 */
#include "ray/render.h"
#include "core/alloc.h"
#include <omp.h>

typedef struct render {
  const skf_render_scene *s;
  skf_view view;
  const skf_light *lights;
  size_t light_count;
  skf_light own_lights[3];
  skf_sight *sights;
  skf_lit *raw, *lit; /* from each pixel's own rays, smoothed twice in the end; smoothed once, later marks */
  float *rgb;
  skf_progress progress;
  double done, share; /* of the whole work: before this pass, in it */
  int rows;           /* finished in this pass */
  bool stop;
} render;

/* First surface along a ray of the camera. */
static skf_sight look(render *r, skf_vec3 direction) {
  skf_sight best = {SKF_NOTHING, INFINITY, {0, 0, 0}, {0, 0, 0}};
  for (size_t i = 0; i < r->s->body_count; i++) {
    skf_ray ray = {r->view.from, direction, 0, best.t};
    skf_hit hit;
    bool found = false;
    if (skf_tracer_first(r->s->bodies[i].tracer, &ray, &hit, &found, NULL)) found = false;
    if (found && hit.t < best.t) best = (skf_sight){(int)i, hit.t, hit.at, hit.normal};
  }
  if (best.body >= 0 && v3_dot(best.normal, direction) > 0) best.normal = v3_scale(-1, best.normal);
  if (best.body == SKF_NOTHING && r->s->ground) {
    skf_vec3 n = v3_unit(r->s->ground_normal);
    double t = v3_dot(v3_sub(r->s->ground_at, r->view.from), n) / v3_dot(direction, n);
    if (t > 0 && isfinite(t)) best = (skf_sight){SKF_GROUND, t, v3_mad(r->view.from, t, direction), n};
  }
  return best;
}

static bool blocked(const render *r, skf_vec3 at, skf_vec3 direction, double distance) {
  for (size_t i = 0; i < r->s->body_count; i++) {
    skf_ray ray = {at, direction, 0, distance};
    bool hit = false;
    if (!skf_tracer_occluded(r->s->bodies[i].tracer, &ray, &hit, NULL) && hit) return true;
  }
  return false;
}

/* A pixel looks for the sky in SKY_RAYS directions of BLOCK * BLOCK * SKY_RAYS; the pixels of a block share theirs
   out, and smoothing over a block brings all of them together. */
enum { BLOCK = 4, SKY_RAYS = 2, DIRECTIONS = BLOCK * BLOCK * SKY_RAYS };

/* Directions spread evenly over the sphere (a spiral of golden angles). */
static skf_vec3 spread(int k) {
  double z = 1 - (2 * k + 1.0) / DIRECTIONS, s = sqrt(1 - z * z), a = k * 2.399963229728653;
  return v3(s * cos(a), s * sin(a), z);
}

/* Which share of the directions a pixel has: neighbours get distant ones. */
static int share_of(int x, int y) {
  static const unsigned char order[BLOCK][BLOCK] = {{0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}};
  return order[y % BLOCK][x % BLOCK];
}

/* Half the angle that directional lights span: 2 degrees, for shadows with soft edges. */
static const double light_radius = 0.035;

static skf_lit light_at(const render *r, const skf_sight *at, int share) {
  skf_lit lit = {0, {0}};
  double seen = 0, all = 0;
  for (int k = 0; k < SKY_RAYS; k++) {
    skf_vec3 d = spread(share + BLOCK * BLOCK * k);
    double c = v3_dot(d, at->normal);
    if (c < 0) d = v3_scale(-1, d), c = -c;
    all += c;
    if (!blocked(r, at->at, d, INFINITY)) seen += c;
  }
  lit.sky = (float)(all > 0 ? seen / all : 1);
  for (size_t l = 0; l < r->light_count; l++) {
    double distance;
    skf_vec3 to = skf_light_direction(r->lights + l, at->at, &distance);
    if (!(v3_dot(to, at->normal) > 0)) continue;
    if (r->lights[l].directional) {
      skf_vec3 a = v3_perp(to), b = v3_cross(to, a);
      double turn = share * 2.399963229728653, out = light_radius * sqrt((share + 0.5) / (BLOCK * BLOCK));
      to = v3_unit(v3_mad(v3_mad(to, out * cos(turn), a), out * sin(turn), b));
    }
    lit.light[l] = blocked(r, at->at, to, distance) ? 0 : 1;
  }
  return lit;
}

/* Whether two pixels see one smooth piece of surface. */
static bool alike(const skf_sight *a, const skf_sight *b) {
  if (a->body != b->body) return false;
  if (a->body == SKF_NOTHING) return true;
  skf_vec3 way = v3_sub(b->at, a->at);
  return v3_dot(a->normal, b->normal) > 0.9 && fabs(v3_dot(way, a->normal)) <= 0.5 * v3_norm(way) + 1e-12 * a->t;
}

/* The mean over a block of pixels that starts at (x0, y0) and holds (x, y), of those like it. */
static skf_lit smooth_light(const render *r, const skf_lit *from, int x, int y, int x0, int y0) {
  int w = r->s->width, h = r->s->height, n = 0;
  const skf_sight *here = r->sights + (size_t)y * w + x;
  skf_lit sum = {0, {0}};
  for (int j = y0; j < y0 + BLOCK; j++)
    for (int i = x0; i < x0 + BLOCK; i++) {
      size_t k = (size_t)j * w + i;
      if (i < 0 || j < 0 || i >= w || j >= h || !alike(here, r->sights + k)) continue;
      sum.sky += from[k].sky;
      for (size_t l = 0; l < r->light_count; l++) sum.light[l] += from[k].light[l];
      n++;
    }
  if (n == 0) return from[(size_t)y * w + x]; /* a surface without a normal */
  sum.sky /= (float)n;
  for (size_t l = 0; l < r->light_count; l++) sum.light[l] /= (float)n;
  return sum;
}

static void shade(const render *r, const skf_sight *at, const skf_lit *lit, double py, double rgb[3]) {
  skf_shade(r->s, r->lights, r->light_count, &r->view, at, lit, 1 - py / r->s->height, rgb);
}

/* The light on what a ray beside a pixel's centre meets: that of the nearest pixel on the same piece, or its own. */
static skf_lit borrowed_light(const render *r, const skf_sight *at, int x, int y) {
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
  return isfinite(nearest) ? r->raw[from] : light_at(r, at, share_of(x, y));
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
  int w = r->s->width, h = r->s->height;
  for (int x = 0; x < w; x++) r->sights[(size_t)y * w + x] = look(r, skf_view_ray(&r->view, w, h, x + 0.5, y + 0.5));
}

static void light_row(render *r, int y) {
  int w = r->s->width;
  for (int x = 0; x < w; x++) {
    size_t k = (size_t)y * w + x;
    if (r->sights[k].body != SKF_NOTHING) r->raw[k] = light_at(r, r->sights + k, share_of(x, y));
  }
}

/* One block is not centred on its pixel; two, shifted either way, are. */
static void smooth_row(render *r, int y) {
  for (int x = 0; x < r->s->width; x++)
    r->lit[(size_t)y * r->s->width + x] = smooth_light(r, r->raw, x, y, x - 1, y - 1);
}

static void shade_row(render *r, int y) {
  int w = r->s->width;
  for (int x = 0; x < w; x++) {
    size_t k = (size_t)y * w + x;
    double rgb[3];
    r->raw[k] = smooth_light(r, r->lit, x, y, x - 2, y - 2);
    shade(r, r->sights + k, r->raw + k, y + 0.5, rgb);
    for (int c = 0; c < 3; c++) r->rgb[3 * k + c] = (float)rgb[c];
  }
}

/* Samples lie on a lattice of rank one, which has one of them in each row and column of a finer grid. */
static void refine_row(render *r, int y) {
  int w = r->s->width, h = r->s->height, n = r->s->samples;
  for (int x = 0; x < w; x++) {
    if (r->lit[(size_t)y * w + x].sky < 1) continue; /* marked by mark_row */
    double sum[3] = {0, 0, 0}, rgb[3];
    for (int i = 0; i < n; i++) {
      double px = x + (i + 0.5) / n, py = y + fmod(0.5 + i * 0.6180339887498949, 1);
      skf_sight at = look(r, skf_view_ray(&r->view, w, h, px, py));
      skf_lit lit = {1, {0}};
      if (at.body != SKF_NOTHING) lit = borrowed_light(r, &at, x, y);
      shade(r, &at, &lit, py, rgb);
      for (int c = 0; c < 3; c++) sum[c] += rgb[c];
    }
    for (int c = 0; c < 3; c++) r->rgb[3 * ((size_t)y * w + x) + c] = (float)(sum[c] / n);
  }
}

/* Before any pixel changes: which ones refine_row takes. */
static void mark_row(render *r, int y) {
  for (int x = 0; x < r->s->width; x++) r->lit[(size_t)y * r->s->width + x].sky = uneven(r, x, y) ? 1 : 0;
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

static void all_passes(render *r) {
  bool stopped;
  size_t n = (size_t)r->s->width * r->s->height;
  for (size_t k = 0; k < n; k++) r->sights[k] = (skf_sight){SKF_NOTHING, INFINITY, {0, 0, 0}, {0, 0, 0}};
  for (size_t k = 0; k < n; k++) {
    r->raw[k].sky = 1;
    for (size_t l = 0; l < r->light_count; l++) r->raw[k].light[l] = 1;
  }
  pass(r, sight_row, 0.3);
  pass(r, light_row, 0.4);
  stopped = r->stop, r->stop = false;
  pass(r, smooth_row, 0); /* cheap, and done also after a stop: the picture is made of what is known */
  pass(r, shade_row, 0);
  r->stop = stopped;
  if (stopped || r->s->samples < 2) return;
  pass(r, mark_row, 0);
  pass(r, refine_row, 0.3);
}

skf_status skf_render(const skf_render_scene *s, float *rgb, float *depth, skf_progress progress) {
  if (s->width < 1 || s->height < 1 || s->samples < 1 || s->light_count > SKF_RENDER_LIGHTS) return SKF_ERR_ARG;
  render r = {.s = s, .rgb = rgb, .progress = progress, .lights = s->lights, .light_count = s->light_count};
  skf_status status = skf_view_make(&s->camera, (double)s->width / s->height, &r.view);
  if (status) return status;
  if (!r.light_count) {
    skf_lights_default(&r.view, r.own_lights);
    r.lights = r.own_lights, r.light_count = 3;
  }
  size_t n = (size_t)s->width * s->height;
  r.sights = skf_alloc(n, sizeof *r.sights);
  r.raw = skf_alloc(n, sizeof *r.raw);
  r.lit = skf_alloc(n, sizeof *r.lit);
  if (!r.sights || !r.raw || !r.lit)
    status = SKF_ERR_NOMEM;
  else
    all_passes(&r);
  for (size_t k = 0; !status && depth && k < n; k++) depth[k] = r.sights[k].body >= 0 ? (float)r.sights[k].t : INFINITY;
  skf_free(r.sights), skf_free(r.raw), skf_free(r.lit);
  return status ? status : r.stop ? SKF_ERR_CANCELLED : SKF_OK;
}
