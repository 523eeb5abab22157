/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Iso-lines with their labels, curves, arrows, marks and the legend. */
#include "chart.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double quarter = 1.5707963267948966;

static void clip_to_box(chart *c) { c->plot->clip(c->canvas, c->left, c->top, c->right, c->bottom); }

/* The cell of the busy map at a place in pixels; places outside go to the nearest cell. */
static unsigned char *cell_at(const chart *c, double x, double y) {
  double i = (x - c->left) / (c->right - c->left) * CHART_CELLS, k = (y - c->top) / (c->bottom - c->top) * CHART_CELLS;
  return (unsigned char *)&c->busy[(int)fmin(fmax(k, 0), CHART_CELLS - 1)][(int)fmin(fmax(i, 0), CHART_CELLS - 1)];
}

static void keep(chart *c, double x, double y, int what) {
  if (x < c->left || x > c->right || y < c->top || y > c->bottom) return;
  unsigned char *cell = cell_at(c, x, y);
  *cell = (unsigned char)(*cell == CHART_FREE || *cell == what ? what : CHART_BUSY);
}

bool chart_busy(const chart *c, double x, double y) {
  double p[2];
  chart_at(c, x, y, p);
  return *cell_at(c, p[0], p[1]) == CHART_BUSY;
}

/* A straight piece, at steps finer than a cell. */
static void keep_piece(chart *c, const double a[2], const double b[2], int what) {
  double step = (c->right - c->left + c->bottom - c->top) / (4 * CHART_CELLS);
  double pieces = fmin(ceil(hypot(b[0] - a[0], b[1] - a[1]) / step) + 1, 4096); /* longer ones reach far outside */
  for (double k = 0; k <= pieces; k++)
    keep(c, a[0] + (b[0] - a[0]) * k / pieces, a[1] + (b[1] - a[1]) * k / pieces, what);
}

/* The line in pixels, its first point repeated at the end when closed, with the length up to each point. */
typedef struct path {
  double (*xy)[2], *length;
  size_t n;
} path;

static bool path_make(const chart *c, const contour *line, int nx, int ny, path *out) {
  size_t n = line->n + line->closed;
  *out = (path){malloc((n + 1) * sizeof *out->xy), malloc((n + 1) * sizeof *out->length), n};
  if (!out->xy || !out->length) return free(out->xy), free(out->length), false;
  for (size_t i = 0; i < n; i++) {
    const double *p = line->xy[i % line->n];
    out->xy[i][0] = c->left + (p[0] + 0.5) / nx * (c->right - c->left);
    out->xy[i][1] = c->top + (p[1] + 0.5) / ny * (c->bottom - c->top);
    out->length[i] =
        i ? out->length[i - 1] + hypot(out->xy[i][0] - out->xy[i - 1][0], out->xy[i][1] - out->xy[i - 1][1]) : 0;
  }
  return true;
}

/* The point at this length along the path. */
static void path_at(const path *p, double s, double xy[2]) {
  size_t lo = 0, hi = p->n - 1;
  while (hi - lo > 1) {
    size_t m = (lo + hi) / 2;
    if (p->length[m] <= s)
      lo = m;
    else
      hi = m;
  }
  double d = p->length[hi] - p->length[lo], t = d > 0 ? (s - p->length[lo]) / d : 0;
  for (int k = 0; k < 2; k++) xy[k] = p->xy[lo][k] + t * (p->xy[hi][k] - p->xy[lo][k]);
}

/* How far the path strays from its chord over [s, s + w]; infinite where a label must not be. */
static double bend(const chart *c, const path *p, double s, double w, int number) {
  double a[2], b[2], worst = 0, em = c->em;
  path_at(p, s, a);
  path_at(p, s + w, b);
  double dx = b[0] - a[0], dy = b[1] - a[1], chord = hypot(dx, dy);
  if (chord < 0.8 * w) return INFINITY;
  for (int i = 1; i < 8; i++) {
    double q[2];
    path_at(p, s + w * i / 8, q);
    worst = fmax(worst, fabs((q[0] - a[0]) * dy - (q[1] - a[1]) * dx) / chord);
  }
  double x = (a[0] + b[0]) / 2, y = (a[1] + b[1]) / 2, edge = w / 2 + 0.4 * em;
  if (x < c->left + edge || x > c->right - edge || y < c->top + edge || y > c->bottom - edge) return INFINITY;
  for (int i = -1; i <= 9; i++)
    for (int side = -1; side <= 1; side++) {
      double off = 0.45 * em * side / chord, t = i / 8.0;
      int there = *cell_at(c, a[0] + t * dx - off * dy, a[1] + t * dy + off * dx);
      if (there != CHART_FREE && there != number) return INFINITY;
    }
  return worst;
}

/* The straightest place for a label of width w; negative when there is none. */
static double label_place(const chart *c, const path *p, double w, int number) {
  double total = p->length[p->n - 1], best = 0.22 * c->em, place = -1;
  if (total < 3 * w) return -1;
  int tries = (int)(total / (0.5 * c->em));
  if (tries > 400) tries = 400;
  for (int i = 0; i <= tries; i++) {
    double s = (total - w) * i / tries, b = bend(c, p, s, w, number);
    if (b < best * 0.98) best = b, place = s;
  }
  return place;
}

static void label(chart *c, const path *p, double s, double w, const char *text, const double rgba[4]) {
  double a[2], b[2], opaque[4] = {rgba[0], rgba[1], rgba[2], 0.95};
  path_at(p, s, a);
  path_at(p, s + w, b);
  double angle = atan2(a[1] - b[1], b[0] - a[0]);
  if (angle > quarter || angle <= -quarter) angle += angle > 0 ? -2 * quarter : 2 * quarter;
  skf_text_place at = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, 0.5, 0.5, angle, 0.72 * c->em};
  c->plot->text(c->canvas, at, text, opaque);
  for (int i = -2; i <= 10; i++) keep(c, a[0] + (b[0] - a[0]) * i / 8, a[1] + (b[1] - a[1]) * i / 8, CHART_BUSY);
}

/* The part of the path from s0 to s1. */
static void stroke_part(chart *c, const path *p, double s0, double s1, double width, const double rgba[4]) {
  double(*part)[2] = malloc((p->n + 2) * sizeof *part);
  size_t n = 0;
  if (!part) return;
  path_at(p, s0, part[n++]);
  for (size_t i = 0; i < p->n; i++)
    if (p->length[i] > s0 && p->length[i] < s1) memcpy(part[n++], p->xy[i], sizeof *part);
  path_at(p, s1, part[n++]);
  c->plot->stroke(c->canvas, (const double(*)[2])part, n, false, width, rgba);
  free(part);
}

void chart_contours(chart *c, const contours *lines, int nx, int ny, double width, const double rgba[4],
                    const char *text, int number) {
  clip_to_box(c);
  double w = text ? c->plot->extent(c->canvas, text).width * 0.72 * c->em + 0.6 * c->em : 0;
  for (size_t i = 0; i < lines->count; i++) {
    path p;
    if (lines->lines[i].n < 2 || !path_make(c, lines->lines + i, nx, ny, &p)) continue;
    double s = text ? label_place(c, &p, w, number) : -1, end = p.length[p.n - 1];
    if (s < 0) {
      c->plot->stroke(c->canvas, (const double(*)[2])p.xy, p.n, false, width, rgba);
    } else {
      stroke_part(c, &p, 0, s, width, rgba);
      stroke_part(c, &p, s + w, end, width, rgba);
      label(c, &p, s, w, text, rgba);
    }
    free(p.xy), free(p.length);
  }
}

void chart_keep_contours(chart *c, const contours *lines, int nx, int ny, int number) {
  for (size_t i = 0; i < lines->count; i++) {
    path p;
    if (!path_make(c, lines->lines + i, nx, ny, &p)) return;
    for (size_t k = 1; k < p.n; k++) keep_piece(c, p.xy[k - 1], p.xy[k], number);
    free(p.xy), free(p.length);
  }
}

void chart_keep_curve(chart *c, const double (*xy)[2], size_t n) {
  for (size_t k = 1; k < n; k++) {
    double a[2], b[2];
    chart_at(c, xy[k - 1][0], xy[k - 1][1], a);
    chart_at(c, xy[k][0], xy[k][1], b);
    keep_piece(c, a, b, CHART_BUSY);
  }
}

void chart_curve(chart *c, const double (*xy)[2], size_t n, const double rgba[4], const double halo[4], double width) {
  double(*px)[2] = malloc((n + 1) * sizeof *px);
  if (!px) return;
  for (size_t i = 0; i < n; i++) chart_at(c, xy[i][0], xy[i][1], px[i]);
  clip_to_box(c);
  if (halo[3] > 0) c->plot->stroke(c->canvas, (const double(*)[2])px, n, false, width + c->em / 9, halo);
  c->plot->stroke(c->canvas, (const double(*)[2])px, n, false, width, rgba);
  free(px);
}

void chart_arrow(chart *c, double x, double y, double dx, double dy, double length, const double rgba[4]) {
  double p[2], n = hypot(dx, dy), head = fmin(0.42 * length, 0.5 * c->em);
  if (!(n > 0) || !isfinite(n)) return;
  chart_at(c, x, y, p);
  double ux = dx / n, uy = -dy / n, tx = p[0] + ux * length / 2, ty = p[1] + uy * length / 2;
  double bx = tx - head * ux, by = ty - head * uy, side = 0.36 * head;
  const double shaft[2][2] = {{p[0] - ux * length / 2, p[1] - uy * length / 2}, {bx, by}};
  const double tip[3][2] = {{tx, ty}, {bx - side * uy, by + side * ux}, {bx + side * uy, by - side * ux}};
  clip_to_box(c);
  c->plot->stroke(c->canvas, shaft, 2, false, c->em / 14, rgba);
  c->plot->fill(c->canvas, tip, 3, rgba);
}

static void mark_at(chart *c, double x, double y, int corners, double radius, const double rgba[4],
                    const double edge[4]) {
  double shape[32][2], w = c->em / 12;
  if (corners == 0) {
    for (int k = 0; k < 2; k++) {
      const double bar[2][2] = {{x - radius, y - (k ? radius : -radius)}, {x + radius, y + (k ? radius : -radius)}};
      c->plot->stroke(c->canvas, bar, 2, false, 2.6 * w, edge);
    }
    for (int k = 0; k < 2; k++) {
      const double bar[2][2] = {{x - radius, y - (k ? radius : -radius)}, {x + radius, y + (k ? radius : -radius)}};
      c->plot->stroke(c->canvas, bar, 2, false, 1.3 * w, rgba);
    }
    return;
  }
  corners = corners > 32 ? 32 : corners;
  for (int k = 0; k < corners; k++) {
    double a = 4 * quarter * (k + 0.5) / corners;
    shape[k][0] = x + radius * sin(a), shape[k][1] = y + radius * cos(a);
  }
  c->plot->fill(c->canvas, (const double(*)[2])shape, (size_t)corners, rgba);
  c->plot->stroke(c->canvas, (const double(*)[2])shape, (size_t)corners, true, w, edge);
}

void chart_mark(chart *c, double x, double y, int corners, double radius, const double rgba[4], const double edge[4]) {
  double p[2];
  chart_at(c, x, y, p);
  clip_to_box(c);
  mark_at(c, p[0], p[1], corners, radius, rgba, edge);
}

/* How many busy cells a rectangle of pixels has. */
static int crowd(chart *c, double x0, double y0, double x1, double y1) {
  int in = 0;
  for (int k = 0; k < CHART_CELLS; k++)
    for (int i = 0; i < CHART_CELLS; i++) {
      double x = c->left + (i + 0.5) / CHART_CELLS * (c->right - c->left);
      double y = c->top + (k + 0.5) / CHART_CELLS * (c->bottom - c->top);
      in += c->busy[k][i] == CHART_BUSY && x > x0 && x < x1 && y > y0 && y < y1;
    }
  return in;
}

void chart_legend_place(chart *c, legend *l) {
  double em = c->em, size = 0.86 * em, w = 0, gap = 0.7 * em;
  int least = CHART_CELLS * CHART_CELLS + 1;
  for (int i = 0; i < l->count; i++) w = fmax(w, c->plot->extent(c->canvas, l->rows[i].text).width * size);
  l->width = w += 3.4 * size;
  l->height = l->count * 1.45 * size + 0.5 * size;
  for (int k = 0; k < 4; k++) { /* upper right first */
    double x = k & 1 ? c->left + gap : c->right - gap - w, y = k & 2 ? c->bottom - gap - l->height : c->top + gap;
    int in = crowd(c, x - gap, y - gap, x + w + gap, y + l->height + gap);
    if (in < least) least = in, l->left = x, l->top = y;
  }
  for (double y = l->top; l->count && y <= l->top + l->height; y += 2)
    for (double x = l->left; x <= l->left + w; x += 2) keep(c, x, y, CHART_BUSY);
}

void chart_legend_draw(chart *c, const legend *l) {
  double em = c->em, size = 0.86 * em, row = 1.45 * size, r = l->left + l->width, b = l->top + l->height;
  const double box[4][2] = {{l->left, l->top}, {r, l->top}, {r, b}, {l->left, b}};
  const double paper[4] = {1, 1, 1, 0.88}, line[4] = {0.1, 0.1, 0.1, 0.5};
  if (!l->count) return;
  clip_to_box(c);
  c->plot->fill(c->canvas, box, 4, paper);
  c->plot->stroke(c->canvas, box, 4, true, em / 25, line);
  for (int i = 0; i < l->count; i++) {
    const legend_row *at = l->rows + i;
    double x = l->left + 0.6 * size, y = l->top + 0.25 * size + (i + 0.5) * row;
    const double key[2][2] = {{x, y}, {x + 1.6 * size, y}};
    if (at->corners < 0) {
      c->plot->stroke(c->canvas, key, 2, false, em / 4.2, at->edge);
      c->plot->stroke(c->canvas, key, 2, false, em / 8.5, at->rgba);
    } else {
      mark_at(c, x + 0.8 * size, y, at->corners, 0.28 * size, at->rgba, at->edge);
    }
    c->plot->text(c->canvas, (skf_text_place){x + 2.1 * size, y, 0, 0.5, 0, size}, at->text, chart_ink);
  }
}
