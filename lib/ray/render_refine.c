/* SPDX-License-Identifier: MIT */
/* More rays where the picture needs them. */
#include "ray/render_rows.h"
#include <string.h>

/* Whether the pixel's neighbours show something else or another brightness. */
static bool uneven(const skf_picture *r, int x, int y) {
  int w = r->s->width, h = r->s->height;
  size_t here = (size_t)y * w + x;
  for (int j = y - 1; j <= y + 1; j++)
    for (int i = x - 1; i <= x + 1; i++) {
      if (i < 0 || j < 0 || i >= w || j >= h) continue;
      size_t k = (size_t)j * w + i;
      if (!skf_alike(r->sights + here, r->sights + k)) return true;
      double a = 0, b = 0;
      for (int c = 0; c < 3; c++) a += r->rgb[3 * here + c], b += r->rgb[3 * k + c];
      if (fabs(a - b) > 0.05 * (a + b)) return true;
    }
  return false;
}

void skf_row_mark(skf_picture *r, int y) {
  for (int x = 0; x < r->s->width; x++) r->marks[(size_t)y * r->s->width + x] = uneven(r, x, y);
}

/* Rays beside pixels' centres, that are traced together. */
typedef struct sheaf {
  int n, y;
  int x[SKF_MANY]; /* of their pixels */
  skf_beam beams[SKF_MANY];
  double sum[3]; /* of the pixel that is not finished */
  int summed;
} sheaf;

/* Of the pixels around, the nearest on the same piece of surface lends its light; false: there is none. */
static bool borrow_light(const skf_picture *r, const skf_sight *at, int x, int y, float *lit) {
  int w = r->s->width, h = r->s->height;
  double nearest = INFINITY;
  size_t from = 0;
  for (int j = y - 1; j <= y + 1; j++)
    for (int i = x - 1; i <= x + 1; i++) {
      size_t k = (size_t)j * w + i;
      if (i < 0 || j < 0 || i >= w || j >= h || !skf_alike(at, r->sights + k)) continue;
      double d = v3_dist(at->at, r->sights[k].at);
      if (d < nearest) nearest = d, from = k;
    }
  if (!isfinite(nearest)) return false;
  memcpy(lit, r->raw + from * r->stride, (size_t)r->stride * sizeof *lit);
  return true;
}

/* The light on what the sheaf meets: borrowed but for hard light, or its own. */
static void light_sheaf(const skf_picture *r, const sheaf *s, const skf_sight *sights, float (*lit)[SKF_LIT]) {
  const skf_sight *at[2][SKF_MANY];
  skf_beam beams[2][SKF_MANY];
  float *out[2][SKF_MANY];
  size_t n[2] = {0, 0};
  for (int k = 0; k < s->n; k++) {
    if (sights[k].body == SKF_NOTHING) continue;
    int own = !borrow_light(r, sights + k, s->x[k], s->y, lit[k]);
    size_t i = n[own]++;
    at[own][i] = sights + k, beams[own][i] = s->beams[k], out[own][i] = lit[k];
  }
  skf_light_places(r, n[1], at[1], beams[1], out[1]);
  if (r->s->quality != SKF_RENDER_DRAFT) skf_light_many(&r->stage, n[0], at[0], beams[0], 0, 0, true, out[0]);
}

static void finish_sheaf(skf_picture *r, sheaf *s) {
  int w = r->s->width, n = r->s->samples;
  skf_sight sights[SKF_MANY];
  float lit[SKF_MANY][SKF_LIT];
  double rgb[SKF_MANY][3];
  skf_look_many(&r->stage, (size_t)s->n, s->beams, sights);
  light_sheaf(r, s, sights, lit);
  skf_radiance_many(&r->stage, (size_t)s->n, s->beams, sights, lit[0], SKF_LIT, rgb);
  for (int k = 0; k < s->n; k++) {
    for (int c = 0; c < 3; c++) s->sum[c] += rgb[k][c] / n;
    if (++s->summed < n) continue;
    skf_put(r, (size_t)s->y * w + s->x[k], s->sum);
    s->sum[0] = s->sum[1] = s->sum[2] = 0, s->summed = 0;
  }
  s->n = 0;
}

/* Samples lie on a lattice of rank one, which has one of them in each row and column of a finer grid. */
void skf_row_refine(skf_picture *r, int y) {
  int w = r->s->width, n = r->s->samples;
  sheaf s;
  s.n = s.summed = 0, s.y = y, s.sum[0] = s.sum[1] = s.sum[2] = 0;
  for (int x = 0; x < w; x++)
    for (int i = 0; i < n && r->marks[(size_t)y * w + x]; i++) {
      s.x[s.n] = x;
      s.beams[s.n++] = skf_camera_beam(r, x + (i + 0.5) / n, y + fmod(0.5 + i * 0.6180339887498949, 1));
      if (s.n == SKF_MANY) finish_sheaf(r, &s);
    }
  finish_sheaf(r, &s);
}

/* Place in the pixel, on the lens, in time, on the lights: a lattice of rank one in all of them [Roberts 2018], shifted
   by the pixel. */
static skf_beam scattered_beam(const skf_picture *r, int x, int y, int i) {
  static const double step[7] = {0.8812714616335696, 0.7766393890897682,  0.6844301295853426, 0.6031687406857282,
                                 0.5315553977157913, 0.46844460228420865, 0.4128267389};
  double u[7];
  for (unsigned k = 0; k < 7; k++) u[k] = fmod(skf_hashed(x, y, k) + i * step[k], 1);
  skf_beam beam = skf_camera_beam(r, x + u[0], y + u[1]);
  double out = sqrt(u[2]), turn = 2 * SKF_PI * u[3];
  if (r->stage.view.aperture > 0)
    skf_view_lens(&r->stage.view, out * cos(turn), out * sin(turn), &beam.from, &beam.direction);
  beam.scattered = true;
  beam.time = u[4], beam.jitter[0] = u[5], beam.jitter[1] = u[6], beam.share = (skf_share_of(x, y) + i) % SKF_SHARES;
  return beam;
}

/* More rays until the mean's standard error is below a step that is seen. */
void skf_row_scatter(skf_picture *r, int y) {
  enum { BATCH = 16 };
  for (int x = 0; x < r->s->width; x++) {
    double sum[3] = {0, 0, 0}, squares = 0, rgb[3];
    int n = 0;
    for (bool enough = false; !enough && n < r->s->samples;) {
      skf_beam beams[BATCH];
      skf_sight sights[BATCH];
      const skf_sight *at[BATCH];
      skf_beam from[BATCH];
      float lit[BATCH][SKF_LIT], *out[BATCH];
      double light[BATCH][3];
      int m = r->s->samples - n < BATCH ? r->s->samples - n : BATCH;
      size_t hits = 0;
      for (int i = 0; i < m; i++) beams[i] = scattered_beam(r, x, y, n + i);
      skf_look_many(&r->stage, (size_t)m, beams, sights);
      for (int i = 0; i < m; i++)
        if (sights[i].body != SKF_NOTHING) at[hits] = sights + i, from[hits] = beams[i], out[hits++] = lit[i];
      skf_light_places(r, hits, at, from, out);
      skf_radiance_many(&r->stage, (size_t)m, beams, sights, lit[0], SKF_LIT, light);
      for (int i = 0; i < m; i++) {
        double bright = light[i][0] + light[i][1] + light[i][2];
        for (int c = 0; c < 3; c++) sum[c] += light[i][c];
        squares += bright * bright;
      }
      n += m;
      double mean = (sum[0] + sum[1] + sum[2]) / n, error2 = fmax(squares / n - mean * mean, 0) / n;
      enough = error2 < 1e-4 * (mean + 0.05) * (mean + 0.05);
    }
    for (int c = 0; c < 3; c++) rgb[c] = sum[c] / n;
    skf_put(r, (size_t)y * r->s->width + x, rgb);
  }
}
