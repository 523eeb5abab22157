/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The picture itself, and the files that it goes into. */
#include "render_job.h"
#include "render_paths.h"
#include "chart.h"
#include "adapt/png_file.h"
#include "core/alloc.h"
#include "core/vec3.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool run_is_shown(const render_job *j) { return j->run.particle_count || j->run.contact_count; }

/* Traces the picture into rgb and, for paths, depth. */
static int trace(render_job *j) {
  size_t n = (size_t)j->what.width * j->what.height;
  if (!j->rgb) j->rgb = skf_alloc(3 * n, sizeof *j->rgb);
  bool deep = run_is_shown(j); /* paths go behind bodies */
  if (deep && !j->depth) j->depth = malloc(n * sizeof *j->depth);
  if (!j->rgb || (deep && !j->depth)) return cli_fail(CLI_FAILED, "out of memory");
  skf_status s = skf_render(&j->what, j->rgb, j->depth, cli_progress(j->label));
  cli_progress_end();
  j->cut = s == SKF_ERR_CANCELLED;
  return s && !j->cut ? cli_fail_status(s, "render") : CLI_DONE;
}

/* Its values of 8 or 16 bits, to be freed; NULL when memory is out. */
static void *values(const render_job *j) {
  size_t n = (size_t)j->what.width * j->what.height;
  void *image = malloc(3 * n * (size_t)(j->bits / 8));
  if (image && j->bits == 16) skf_render_srgb16(j->rgb, n, image);
  if (image && j->bits == 8) skf_render_srgb(j->rgb, j->what.width, n, image);
  return image;
}

/* The 8-bit picture with the paths. */
static skf_status draw(render_job *j, unsigned char **bytes, size_t *n, char error[256]) {
  int w = j->what.width, h = j->what.height;
  unsigned char *image = values(j);
  skf_canvas *canvas = j->plot->create(w, h, NULL, error);
  skf_status s = image && canvas ? SKF_OK : SKF_ERR_NOMEM;
  if (!s) {
    j->plot->image(canvas, 0, 0, w, h, image);
    path_view view = {j->plot,
                      canvas,
                      j->what.camera,
                      w,
                      h,
                      j->depth,
                      0.0028 * sqrt((double)w * h),
                      v3_dist(j->what.camera.from, j->what.camera.to),
                      j->frames > 0};
    run_data shown = j->run;
    bool good = j->frames == 0 || run_until(&j->run, j->time, &shown);
    if (!good || !render_paths(&view, &shown)) s = SKF_ERR_NOMEM;
    if (j->frames) run_free(&shown);
  }
  if (s) snprintf(error, 256, "%s", skf_status_text(s));
  if (!s) s = j->plot->encode(canvas, j->format->ending, bytes, n, error);
  if (canvas) j->plot->destroy(canvas);
  free(image);
  return s;
}

static bool is(const render_job *j, const char *ending) { return !strcmp(j->format->ending, ending); }

bool render_is_plain(const render_job *j) {
  bool own = is(j, "ppm") || (skf_png_there() && is(j, "png"));
  return own && j->mode != RENDER_COST && !run_is_shown(j);
}

void render_give_back(const render_job *j, unsigned char *bytes) {
  if (render_is_plain(j))
    free(bytes);
  else
    j->plot->release(bytes);
}

/* A PPM of 8 bits. */
static skf_status encode_ppm(int w, int h, const unsigned char *rgb, unsigned char **bytes, size_t *n) {
  char head[40];
  int m = snprintf(head, sizeof head, "P6\n%d %d\n255\n", w, h);
  size_t size = 3 * (size_t)w * h;
  *bytes = malloc((size_t)m + size), *n = (size_t)m + size;
  if (!*bytes) return SKF_ERR_NOMEM;
  memcpy(*bytes, head, (size_t)m), memcpy(*bytes + m, rgb, size);
  return SKF_OK;
}

/* Nothing is drawn over these. */
static skf_status bare(const render_job *j, unsigned char **bytes, size_t *n, char error[256]) {
  int w = j->what.width, h = j->what.height;
  void *image = values(j);
  skf_status s = SKF_ERR_NOMEM;
  snprintf(error, 256, "%s", skf_status_text(s));
  if (image && !render_is_plain(j))
    s = j->plot->encode_deep(w, h, image, j->format->ending, bytes, n, error);
  else if (image)
    s = is(j, "ppm") ? encode_ppm(w, h, image, bytes, n) : skf_png_encode(w, h, j->bits, image, bytes, n);
  free(image);
  return s;
}

static int done(const render_job *j, skf_status s, const char *error) {
  const char *path = cli_value(j->c, "output");
  return s ? cli_fail(CLI_FAILED, "%s: %s", path ? path : "stdout", error) : CLI_DONE;
}

/* With the paths up to the job's time. */
static int encode(render_job *j, unsigned char **bytes, size_t *n) {
  char error[256];
  skf_status s;
  if (j->format->linear)
    s = j->plot->encode_linear(j->what.width, j->what.height, j->rgb, j->format->ending, bytes, n, error);
  else
    s = j->bits == 16 || render_is_plain(j) ? bare(j, bytes, n, error) : draw(j, bytes, n, error);
  return done(j, s, error);
}

/* Evaluations of each pixel in colours, from none to the dearest. */
static int paint_cost(chart *h, const float *cost, int w, int t, color_scale *scale) {
  int bw = (int)(h->right - h->left), bt = (int)(h->bottom - h->top);
  unsigned char *rgb = malloc(3 * (size_t)bw * bt);
  if (!rgb) return cli_fail(CLI_FAILED, "out of memory");
  scale->lo = 0, scale->hi = 1;
  for (int k = 0; k < w * t; k++) scale->hi = fmax(scale->hi, cost[k]);
  for (int y = 0; y < bt; y++)
    for (int x = 0; x < bw; x++)
      scale_color(scale, cost[(size_t)(y * t / bt) * w + x * w / bw], rgb + 3 * ((size_t)y * bw + x));
  h->plot->image(h->canvas, (int)h->left, (int)h->top, bw, bt, rgb);
  free(rgb);
  return CLI_DONE;
}

static int chart_cost(render_job *j, chart *h, const float *cost) {
  color_scale scale = {0};
  int w = j->what.width, t = j->what.height;
  double sum = 0;
  for (int k = 0; k < w * t; k++) sum += cost[k];
  if (!j->plot->colormap("inferno", scale.rgb)) return cli_fail(CLI_FAILED, "no colour map");
  h->plot = j->plot, h->width = w, h->height = t, h->em = fmax(9, sqrt((double)w * t) / 55);
  h->x0 = 0, h->x1 = w, h->y0 = 0, h->y1 = t;
  chart_layout(h, false);
  int status = paint_cost(h, cost, w, t, &scale);
  char title[128], mean[TICK_TEXT];
  tick_number(sum / w / t, 3, mean);
  snprintf(title, sizeof title, "cost of a ray: %s evaluations on average", mean);
  if (status) return status;
  chart_axes(h, "pixels", "pixels", title, "evaluations of the field along the ray through each pixel's centre");
  chart_bar(h, &scale, "evaluations", NULL, 0);
  return CLI_DONE;
}

/* The cost map as a chart. */
static int draw_cost(render_job *j, unsigned char **bytes, size_t *n) {
  char error[256];
  float *cost = malloc((size_t)j->what.width * j->what.height * sizeof *cost);
  if (!cost) return cli_fail(CLI_FAILED, "out of memory");
  skf_status s = skf_render_cost(&j->what, cost, NULL, cli_progress(j->label));
  cli_progress_end();
  j->cut = s == SKF_ERR_CANCELLED;
  if (s && !j->cut) return free(cost), cli_fail_status(s, "render");
  chart *h = calloc(1, sizeof *h);
  int status = h ? CLI_DONE : cli_fail(CLI_FAILED, "out of memory");
  if (h && !(h->canvas = j->plot->create(j->what.width, j->what.height, NULL, error)))
    status = done(j, SKF_ERR_IO, error);
  if (!status) status = chart_cost(j, h, cost);
  if (!status) status = done(j, j->plot->encode(h->canvas, j->format->ending, bytes, n, error), error);
  if (h && h->canvas) j->plot->destroy(h->canvas);
  free(h), free(cost);
  return status;
}

int render_picture(render_job *j, unsigned char **bytes, size_t *n) {
  if (j->mode == RENDER_COST) return draw_cost(j, bytes, n);
  int status = trace(j);
  return status ? status : encode(j, bytes, n);
}
