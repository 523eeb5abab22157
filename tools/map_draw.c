/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From the samples of a map to its picture. */
#include "map_draw.h"
#include "core/vec3.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double dark[4] = {0.05, 0.05, 0.05, 1}, white[4] = {1, 1, 1, 1}, red[4] = {0.9, 0.05, 0.1, 1};

/* From a to b by the share t; the nearer one where one of them is infinite or missing. */
static double blend(double a, double b, double t) {
  double m = a + t * (b - a);
  return isfinite(m) ? m : t < 0.5 ? a : b;
}

/* Value at a place in grid units, between the samples; beyond the outermost ones as at them. */
static double value_at(const map_grid *g, double x, double y) {
  x = fmin(fmax(x, 0), g->nx - 1), y = fmin(fmax(y, 0), g->ny - 1);
  int i = x < g->nx - 1 ? (int)x : g->nx - 2, k = y < g->ny - 1 ? (int)y : g->ny - 2;
  const double *v = g->value + (size_t)k * g->nx + i, *below = v + g->nx;
  return blend(blend(v[0], v[1], x - i), blend(below[0], below[1], x - i), y - k);
}

static int paint(map_job *j) {
  chart *h = &j->chart;
  const map_grid *g = &j->grid;
  int w = (int)(h->right - h->left), t = (int)(h->bottom - h->top);
  unsigned char *rgb = malloc(3 * (size_t)w * t);
  if (!rgb) return cli_fail(CLI_FAILED, "out of memory");
  for (int y = 0; y < t; y++)
    for (int x = 0; x < w; x++)
      scale_color(&j->scale, value_at(g, (x + 0.5) * g->nx / w - 0.5, (y + 0.5) * g->ny / t - 0.5),
                  rgb + 3 * ((size_t)y * w + x));
  j->plot->image(h->canvas, (int)h->left, (int)h->top, w, t, rgb);
  free(rgb);
  return CLI_DONE;
}

/* Finds all iso-lines first, so that each label keeps off the others' lines. */
static void levels_on(map_job *j, const ticks *levels, const double *shown, contours *lines) {
  const map_grid *g = &j->grid;
  for (int i = 0; i < levels->count; i++)
    if (contour_find(shown, g->nx, g->ny, levels->at[i], lines + i))
      chart_keep_contours(&j->chart, lines + i, g->nx, g->ny, i + 1);
  for (int i = 0; i < levels->count; i++) {
    char text[TICK_TEXT];
    double shade = scale_lightness(&j->scale, levels->at[i]) < 0.55; /* white on dark */
    const double rgba[4] = {shade, shade, shade, shade > 0 ? 0.75 : 0.6};
    tick_label(levels, levels->at[i], text);
    chart_contours(&j->chart, lines + i, g->nx, g->ny, j->chart.em / 18, rgba, text, i + 1);
    contour_free(lines + i);
  }
}

static int draw_levels(map_job *j, ticks *levels) {
  *levels = (ticks){0};
  if (cli_given(j->c, "no-contours") || j->levels == 0) return CLI_DONE;
  size_t n = (size_t)j->grid.nx * j->grid.ny;
  double *shown = malloc(n * sizeof *shown);
  contours *lines = calloc(TICKS_MAX, sizeof *lines);
  if (!shown || !lines) return free(shown), free(lines), cli_fail(CLI_FAILED, "out of memory");
  for (size_t k = 0; k < n; k++) shown[k] = j->log ? fabs(j->grid.value[k]) : j->grid.value[k];
  *levels = j->log ? ticks_log(j->scale.lo, j->scale.hi, j->levels) : ticks_linear(j->scale.lo, j->scale.hi, j->levels);
  levels_on(j, levels, shown, lines);
  free(shown), free(lines);
  return CLI_DONE;
}

static void draw_arrows(map_job *j) {
  const map_grid *g = &j->grid;
  static const double pale[4] = {1, 1, 1, 0.85};
  chart *h = &j->chart;
  double apart = 2.4 * h->em;
  int across = (int)((h->right - h->left) / apart), up = (int)((h->bottom - h->top) / apart);
  for (int b = 0; b < up; b++)
    for (int a = 0; a < across; a++) {
      double i = (a + 0.5) * g->nx / across - 0.5, k = (b + 0.5) * g->ny / up - 0.5;
      size_t at = (size_t)lround(k) * g->nx + (size_t)lround(i);
      skf_vec3 p = map_point(g, i, k);
      double x = v3_get(p, g->plane.u), y = v3_get(p, g->plane.v);
      if (!chart_busy(h, x, y)) chart_arrow(h, x, y, g->slope[0][at], g->slope[1][at], 0.6 * apart, pale);
    }
}

/* The path of a particle on the plane; NULL when memory is out. */
static double (*flat_path(const map_job *j, size_t i, size_t *n))[2] {
  skf_vec3 *path = run_path(&j->run, i, n);
  double(*xy)[2] = path ? malloc((*n + 1) * sizeof *xy) : NULL;
  for (size_t k = 0; xy && k < *n; k++) xy[k][0] = v3_get(path[k], j->plane.u), xy[k][1] = v3_get(path[k], j->plane.v);
  free(path);
  return xy;
}

/* What labels must not cover. */
static void keep_free(map_job *j) {
  for (size_t i = 0; i < j->scene->body_count; i++)
    chart_keep_contours(&j->chart, j->outlines + i, j->grid.nx, j->grid.ny, CHART_BUSY);
  for (size_t i = 0; i < j->run.particle_count; i++) {
    size_t n;
    double(*xy)[2] = flat_path(j, i, &n);
    if (xy) chart_keep_curve(&j->chart, (const double(*)[2])xy, n);
    free(xy);
  }
}

static void draw_outlines(map_job *j) {
  for (size_t i = 0; i < j->scene->body_count; i++) {
    chart_contours(&j->chart, j->outlines + i, j->grid.nx, j->grid.ny, j->chart.em / 4.4, dark, NULL, 0);
    chart_contours(&j->chart, j->outlines + i, j->grid.nx, j->grid.ny, j->chart.em / 11, white, NULL, 0);
  }
}

/* Paths and contacts, projected on the plane. */
static void draw_run(map_job *j) {
  const run_data *run = &j->run;
  chart *h = &j->chart;
  for (size_t i = 0; i < run->particle_count; i++) {
    size_t n;
    double rgba[4], (*xy)[2] = flat_path(j, i, &n);
    picture_color(i, rgba);
    if (xy && n) {
      chart_curve(h, (const double(*)[2])xy, n, rgba, dark, h->em / 10);
      chart_mark(h, xy[0][0], xy[0][1], 20, 0.26 * h->em, rgba, dark);
    }
    free(xy);
  }
  for (size_t i = 0; i < run->contact_count; i++) {
    skf_vec3 p = run->contacts[i].state.x;
    chart_mark(h, v3_get(p, j->plane.u), v3_get(p, j->plane.v), 0, 0.3 * h->em, red, white);
  }
}

static void add_row(legend *l, const char *text, int corners, const double rgba[4], const double edge[4]) {
  legend_row *row = l->rows + l->count++;
  *row = (legend_row){.corners = corners};
  snprintf(row->text, sizeof row->text, "%s", text);
  memcpy(row->rgba, rgba, sizeof row->rgba);
  memcpy(row->edge, edge, sizeof row->edge);
}

static void legend_rows(const map_job *j, legend *l) {
  enum { PARTICLES = 12 };
  const run_data *run = &j->run;
  size_t lines = 0;
  char text[96], iso[TICK_TEXT];
  for (size_t i = 0; i < j->scene->body_count; i++) lines += j->outlines[i].count;
  if (lines) {
    tick_number(j->scene->bodies[0].iso, 4, iso);
    snprintf(text, sizeof text, "surface F = %.31s", iso);
    add_row(l, j->scene->body_count == 1 ? text : "surfaces", -1, white, dark);
  }
  for (size_t i = 0; i < run->particle_count && i < PARTICLES; i++) {
    double rgba[4];
    picture_color(i, rgba);
    snprintf(text, sizeof text, "%.60s", run->particles[i].name);
    if (i == PARTICLES - 1 && i + 1 < run->particle_count)
      snprintf(text, sizeof text, "and %zu more", run->particle_count - i);
    add_row(l, text, -1, rgba, dark);
  }
  if (run->contact_count) add_row(l, "contact", 0, red, white);
}

static void titles(map_job *j, char title[256], char subtitle[256]) {
  const skf_scene *s = j->scene;
  char at[TICK_TEXT], names[160] = "";
  for (size_t i = 0; i < s->body_count && i < 3; i++)
    snprintf(names + strlen(names), sizeof names - strlen(names), "%s%.48s", i ? ", " : "", s->bodies[i].name);
  if (s->body_count > 3)
    snprintf(names + strlen(names), sizeof names - strlen(names), " and %zu more", s->body_count - 3);
  tick_number(j->plane.at, 6, at);
  const char *given = cli_value(j->c, "title");
  if (given)
    snprintf(title, 256, "%.250s", given);
  else
    snprintf(title, 256, "%s", names);
  snprintf(subtitle, 256, "%s in the plane %c = %.31s%s", map_quantities[j->kind].title, "xyz"[j->plane.normal], at,
           j -> run.particle_count ? ", paths projected on it" : "");
}

int map_draw(map_job *j) {
  ticks levels;
  legend l = {.count = 0};
  char title[256], subtitle[256];
  legend_rows(j, &l);
  keep_free(j);
  chart_legend_place(&j->chart, &l);
  int status = paint(j);
  if (!status) status = draw_levels(j, &levels);
  if (status) return status;
  if (j->grid.slope[0]) draw_arrows(j);
  draw_outlines(j);
  draw_run(j);
  chart_legend_draw(&j->chart, &l);
  titles(j, title, subtitle);
  static const char *const axis[3] = {"x", "y", "z"};
  const map_quantity *q = map_quantities + j->kind;
  chart_axes(&j->chart, axis[j->plane.u], axis[j->plane.v], title, subtitle);
  chart_bar(&j->chart, &j->scale, j->log ? q->absolute : q->label, levels.at, levels.count);
  unsigned char *bytes;
  size_t n;
  char error[256];
  if (j->plot->encode(j->chart.canvas, j->format->ending, &bytes, &n, error))
    return cli_fail(CLI_FAILED, "%s: %s", cli_value(j->c, "output") ? cli_value(j->c, "output") : "stdout", error);
  status = picture_write(j->c, bytes, n);
  j->plot->release(bytes);
  return status;
}
