/* SPDX-License-Identifier: MIT */
/* Pictures for the notebooks: a canvas of the drawing module, and a box with axes on it. */
#ifndef NOTEBOOKS_FIGURE_H
#define NOTEBOOKS_FIGURE_H

#include "adapt/plot.h"
#include "nb.h"

const skf_plot *plot;
const double ink[4] = {0.1, 0.1, 0.12, 1}, paper[4] = {1, 1, 1, 1}, faint[4] = {0.85, 0.85, 0.87, 1};
/* of what is told apart */
const double colors[12][4] = {{0.05, 0.32, 0.70, 1}, {0.85, 0.33, 0.05, 1}, {0.70, 0.05, 0.20, 1},
                              {0.42, 0.42, 0.45, 1}, {0.12, 0.60, 0.65, 1}, {0.25, 0.70, 0.35, 1},
                              {0.60, 0.45, 0.80, 1}, {0.60, 0.50, 0.10, 1}, {0.10, 0.45, 0.15, 1},
                              {0.80, 0.40, 0.65, 1}, {0.35, 0.15, 0.55, 1}, {0.1, 0.1, 0.1, 1}};

skf_canvas *canvas(int width, int height) {
  char problem[256];
  if (!plot) plot = skf_plot_load(problem);
  skf_canvas *c = plot ? plot->create(width, height, NULL, problem) : NULL;
  if (!c) nb_fail("%s", problem);
  return c;
}

/* Writes the canvas to a file, shows it, and frees it. */
void show(skf_canvas *c, const char *path) {
  unsigned char *bytes;
  size_t n;
  char problem[256];
  if (plot->encode(c, "png", &bytes, &n, problem)) nb_fail("%s", problem);
  FILE *f = fopen(path, "wb");
  nb_require(f && fwrite(bytes, 1, n, f) == n && fclose(f) == 0);
  plot->release(bytes);
  plot->destroy(c);
  nb_show(path);
}

void box(skf_canvas *c, double x0, double y0, double x1, double y1, const double rgba[4]) {
  plot->fill(c, (const double[][2]){{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, 4, rgba);
}

/* A line of text whose middle is at y; `ax` of its width is left of x. */
void label(skf_canvas *c, double x, double y, double ax, double size, const double rgba[4], const char *text) {
  plot->text(c, (skf_text_place){x, y, ax, 0.5, 0, size}, text, rgba);
}

/* ---- Axes ---- */

/* What an axis shows, and where; logarithmic ones in powers of ten, from and to included. */
typedef struct axis {
  double from, to;
  bool log;
  double p0, p1; /* pixels */
} axis;
typedef struct axes {
  skf_canvas *canvas;
  axis x, y;
} axes;

double pixel(const axis *a, double value) {
  double share = a->log ? log10(value / a->from) / log10(a->to / a->from) : (value - a->from) / (a->to - a->from);
  return a->p0 + (a->p1 - a->p0) * share;
}

/* The distance of ticks: of five or so, 1, 2 or 5 times a power of ten; of a logarithmic axis, as a factor. */
double tick_step(const axis *a) {
  double rough = a->log ? log10(a->to / a->from) / 7 : (a->to - a->from) / 5, power = pow(10, floor(log10(rough)));
  if (a->log) return pow(10, fmax(1, ceil(rough)));
  return power * (rough < 2 * power ? rough > power ? 2 : 1 : rough < 5 * power ? 5 : 10);
}

void ticks(const axes *g, bool upright) {
  const axis *a = upright ? &g->y : &g->x, *other = upright ? &g->x : &g->y;
  double step = tick_step(a), k = ceil(a->log ? log(a->from) / log(step) - 1e-9 : a->from / step - 1e-9);
  for (;; k++) {
    double value = a->log ? pow(step, k) : k * step, p;
    if (value > a->to * (1 + 1e-9 * (a->to > 0 ? 1 : -1))) break;
    p = pixel(a, value);
    double line[2][2] = {{p, other->p0}, {p, other->p1}};
    if (upright) line[0][0] = other->p0, line[1][0] = other->p1, line[0][1] = line[1][1] = p;
    plot->stroke(g->canvas, line, 2, false, 1, faint);
    char text[32];
    if (a->log && (value < 1e-2 || value > 1e5))
      snprintf(text, sizeof text, "1e%.0f", log10(value));
    else
      snprintf(text, sizeof text, "%g", !a->log && fabs(value) < 1e-9 * step ? 0 : value);
    if (upright)
      label(g->canvas, other->p0 - 8, p, 1, 15, ink, text);
    else
      label(g->canvas, p, other->p0 + 16, 0.5, 15, ink, text);
  }
}

/* A box from (left, top) to (right, bottom), with lines at its ticks, names of its axes, and a title above. */
axes axes_new(skf_canvas *c, axis x, axis y, const double pixels[4], const char *title, const char *x_name,
              const char *y_name) {
  x.p0 = pixels[0], y.p1 = pixels[1], x.p1 = pixels[2], y.p0 = pixels[3];
  axes g = {c, x, y};
  ticks(&g, false), ticks(&g, true);
  const double frame[4][2] = {{x.p0, y.p0}, {x.p1, y.p0}, {x.p1, y.p1}, {x.p0, y.p1}};
  plot->stroke(c, frame, 4, true, 1.2, ink);
  label(c, 0.5 * (x.p0 + x.p1), y.p1 - 20, 0.5, 18, ink, title);
  label(c, 0.5 * (x.p0 + x.p1), y.p0 + 42, 0.5, 16, ink, x_name);
  plot->text(c, (skf_text_place){x.p0 - 66, 0.5 * (y.p0 + y.p1), 0.5, 0.5, M_PI / 2, 16}, y_name, ink);
  return g;
}

/* How a curve and its marks look: corners of the marks (0: none, above 4: round), width of the line (0: none). */
typedef struct look {
  double rgba[4], width;
  int corners;
  double turn, radius;
  bool dashed;
} look;

void mark(skf_canvas *c, double x, double y, const look *l) {
  double at[24][2];
  int n = l->corners > 4 ? 24 : l->corners;
  for (int i = 0; i < n; i++) {
    double phi = 2 * M_PI * i / n + l->turn;
    at[i][0] = x + l->radius * sin(phi), at[i][1] = y - l->radius * cos(phi);
  }
  if (n) plot->fill(c, at, (size_t)n, l->rgba), plot->stroke(c, at, (size_t)n, true, 0.8, paper);
}

/* A line through pixels; a dash and a gap are 7 and 5 of them. */
void line(skf_canvas *c, const double (*xy)[2], size_t n, const look *l) {
  if (!(l->width > 0) || n < 2) return;
  if (!l->dashed) {
    plot->stroke(c, xy, n, false, l->width, l->rgba);
    return;
  }
  double at = 0;
  for (size_t i = 0; i + 1 < n; i++) {
    double dx = xy[i + 1][0] - xy[i][0], dy = xy[i + 1][1] - xy[i][1], length = hypot(dx, dy), s = 0;
    while (s < length) {
      double phase = fmod(at, 12), left = phase < 7 ? 7 - phase : 12 - phase, to = fmin(s + left, length);
      const double piece[2][2] = {{xy[i][0] + dx * s / length, xy[i][1] + dy * s / length},
                                  {xy[i][0] + dx * to / length, xy[i][1] + dy * to / length}};
      if (phase < 7) plot->stroke(c, piece, 2, false, l->width, l->rgba);
      at += to - s + 1e-9, s = to + 1e-9;
    }
  }
}

/* A curve of n places; what is outside of the box is cut off. */
void curve(const axes *g, const double *x, const double *y, size_t n, const look *l) {
  double(*xy)[2] = malloc((n + 1) * sizeof *xy);
  nb_require(xy);
  for (size_t i = 0; i < n; i++) xy[i][0] = pixel(&g->x, x[i]), xy[i][1] = pixel(&g->y, y[i]);
  plot->clip(g->canvas, g->x.p0 - 8, g->y.p1 - 8, g->x.p1 + 8, g->y.p0 + 8);
  line(g->canvas, (const double(*)[2])xy, n, l);
  for (size_t i = 0; i < n; i++) mark(g->canvas, xy[i][0], xy[i][1], l);
  plot->clip(g->canvas, 0, 0, 1e9, 1e9);
  free(xy);
}

/* A row of a legend: the look, and its name right of it. */
void legend(skf_canvas *c, double x, double y, const look *l, const char *name) {
  line(c, (const double[][2]){{x, y}, {x + 36, y}}, 2, l);
  mark(c, x + 18, y, l);
  label(c, x + 46, y, 0, 15, ink, name);
}

#endif
