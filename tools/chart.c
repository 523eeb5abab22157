/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Axes, title and colour bar. */
#include "chart.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

const double chart_ink[4] = {0.1, 0.1, 0.1, 1};
static const double soft_ink[4] = {0.38, 0.38, 0.38, 1};

double scale_share(const color_scale *s, double v) {
  if (s->log) return (log(fabs(v)) - log(s->lo)) / (log(s->hi) - log(s->lo));
  if (isinf(v)) return v;
  return (v - s->lo) / (s->hi - s->lo);
}

void scale_color(const color_scale *s, double v, unsigned char rgb[3]) {
  double t = scale_share(s, v) * 255;
  if (isnan(t)) {
    rgb[0] = rgb[1] = rgb[2] = 128;
    return;
  }
  t = fmin(fmax(t, 0), 255);
  int k = t < 254 ? (int)t : 254;
  for (int j = 0; j < 3; j++)
    rgb[j] = (unsigned char)lround(s->rgb[k][j] + (t - k) * (s->rgb[k + 1][j] - s->rgb[k][j]));
}

double scale_lightness(const color_scale *s, double v) {
  unsigned char rgb[3];
  scale_color(s, v, rgb);
  return (0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2]) / 255;
}

static void put(chart *c, double x, double y, double ax, double ay, double angle, double size, const char *text,
                const double rgba[4]) {
  c->plot->text(c->canvas, (skf_text_place){x, y, ax, ay, angle, size}, text, rgba);
}

static void segment(chart *c, double x0, double y0, double x1, double y1, double width) {
  const double line[2][2] = {{x0, y0}, {x1, y1}};
  c->plot->stroke(c->canvas, line, 2, false, width, chart_ink);
}

void chart_at(const chart *c, double x, double y, double xy[2]) {
  xy[0] = c->left + (x - c->x0) / (c->x1 - c->x0) * (c->right - c->left);
  xy[1] = c->bottom - (y - c->y0) / (c->y1 - c->y0) * (c->bottom - c->top);
}

/* About how many ticks fit a side of this length. */
static int tick_count(const chart *c, double length, double apart) {
  int n = (int)(length / (apart * c->em));
  return n < 2 ? 2 : n > 9 ? 9 : n;
}

static ticks degree_ticks(double lo, double hi, double length, const chart *c) {
  return ticks_degrees(lo, hi, (int)(length / (4 * c->em)));
}

static ticks x_ticks(const chart *c) {
  if (c->degrees) return degree_ticks(c->x0, c->x1, c->right - c->left, c);
  return ticks_axis(c->x0, c->x1, tick_count(c, c->right - c->left, 5));
}
static ticks y_ticks(const chart *c) {
  if (c->degrees) return degree_ticks(c->y0, c->y1, c->bottom - c->top, c);
  return ticks_axis(c->y0, c->y1, tick_count(c, c->bottom - c->top, 3.2));
}

static double widest(const chart *c, const ticks *t) {
  double w = 0;
  for (int i = 0; i < t->count; i++) {
    char text[TICK_TEXT];
    tick_label(t, t->at[i], text);
    w = fmax(w, c->plot->extent(c->canvas, text).width);
  }
  return w * c->em;
}

/* Widens [lo, hi] about its middle to the length. */
static void widen(double *lo, double *hi, double length) {
  double middle = *lo + (*hi - *lo) / 2;
  *lo = middle - length / 2, *hi = middle + length / 2;
}

static void fit_box(chart *c, double l, double t, double r, double b, bool fill) {
  double w = r - l, h = b - t, unit = fmax((c->x1 - c->x0) / w, (c->y1 - c->y0) / h);
  if (!fill) {
    double bw = round((c->x1 - c->x0) / unit), bh = round((c->y1 - c->y0) / unit);
    l = floor(l + (w - bw) / 2), t = floor(t + (h - bh) / 2);
    r = l + fmax(bw, 2), b = t + fmax(bh, 2);
  } else {
    widen(&c->x0, &c->x1, unit * w);
    widen(&c->y0, &c->y1, unit * h);
  }
  c->left = l, c->top = t, c->right = r, c->bottom = b;
}

void chart_layout(chart *c, bool fill) {
  c->em = fmax(9, 0.0178 * sqrt((double)c->width * c->height));
  double em = c->em, right = floor(c->width - 8.6 * em), top = floor(3.9 * em), bottom = floor(c->height - 4.2 * em);
  double x0 = c->x0, x1 = c->x1, y0 = c->y0, y1 = c->y1;
  /* The labels' width follows from the range, which follows from the box. */
  double labels = 2.5 * em;
  for (int pass = 0; pass < 3; pass++) {
    c->x0 = x0, c->x1 = x1, c->y0 = y0, c->y1 = y1;
    fit_box(c, ceil(labels + 3.4 * em), top, right, bottom, fill);
    ticks t = y_ticks(c);
    labels = widest(c, &t);
  }
}

static void axis_name(const ticks *t, const char *name, char *out, size_t size) {
  char power[TICK_TEXT], base[TICK_TEXT + 8] = "";
  tick_power(t->exponent, power);
  if (t->base != 0) snprintf(base, sizeof base, " %s %.15g", t->base < 0 ? "+" : "−", fabs(t->base));
  if (t->exponent)
    snprintf(out, size, "%s%s  [%s]", name, base, power);
  else
    snprintf(out, size, "%s%s", name, base);
}

static void x_axis(chart *c, const char *name) {
  ticks t = x_ticks(c);
  double em = c->em, thin = em / 16, p[2];
  char text[TICK_TEXT], label[128];
  for (int i = 0; i < t.minor_count; i++) {
    chart_at(c, t.minor[i], c->y0, p);
    segment(c, p[0], p[1], p[0], p[1] + 0.2 * em, thin * 0.7);
  }
  for (int i = 0; i < t.count; i++) {
    chart_at(c, t.at[i], c->y0, p);
    segment(c, p[0], p[1], p[0], p[1] + 0.38 * em, thin);
    tick_label(&t, t.at[i], text);
    put(c, p[0], p[1] + 0.62 * em, 0.5, 1, 0, em, text, chart_ink);
  }
  axis_name(&t, name, label, sizeof label);
  put(c, (c->left + c->right) / 2, c->bottom + 2.2 * em, 0.5, 1, 0, 1.15 * em, label, chart_ink);
}

static void y_axis(chart *c, const char *name) {
  ticks t = y_ticks(c);
  double em = c->em, thin = em / 16, p[2];
  char text[TICK_TEXT], label[128];
  for (int i = 0; i < t.minor_count; i++) {
    chart_at(c, c->x0, t.minor[i], p);
    segment(c, p[0] - 0.2 * em, p[1], p[0], p[1], thin * 0.7);
  }
  for (int i = 0; i < t.count; i++) {
    chart_at(c, c->x0, t.at[i], p);
    segment(c, p[0] - 0.38 * em, p[1], p[0], p[1], thin);
    tick_label(&t, t.at[i], text);
    put(c, p[0] - 0.6 * em, p[1], 1, 0.5, 0, em, text, chart_ink);
  }
  axis_name(&t, name, label, sizeof label);
  put(c, c->left - 1.35 * em - widest(c, &t), (c->top + c->bottom) / 2, 0.5, 0, 1.5707963267948966, 1.15 * em, label,
      chart_ink);
}

static void frame(chart *c, double l, double t, double r, double b) {
  const double box[4][2] = {{l, t}, {r, t}, {r, b}, {l, b}};
  c->plot->stroke(c->canvas, box, 4, true, c->em / 16, chart_ink);
}

/* Text that is cut down to what fits between the edges of the picture. */
static void centred(chart *c, double y, double size, const char *text, const double rgba[4]) {
  double w = c->plot->extent(c->canvas, text).width, room = c->width - 2 * c->em, middle = (c->left + c->right) / 2;
  if (w * size > room) size = room / w;
  middle = fmin(fmax(middle, c->em + w * size / 2), c->width - c->em - w * size / 2);
  put(c, middle, y, 0.5, 0, 0, size, text, rgba);
}

void chart_axes(chart *c, const char *x_name, const char *y_name, const char *title, const char *subtitle) {
  c->plot->clip(c->canvas, 0, 0, c->width, c->height);
  x_axis(c, x_name);
  y_axis(c, y_name);
  frame(c, c->left, c->top, c->right, c->bottom);
  bool two = subtitle && *subtitle;
  centred(c, c->top - (two ? 2.1 : 1.1) * c->em, 1.3 * c->em, title, chart_ink);
  if (two) centred(c, c->top - 0.7 * c->em, 0.92 * c->em, subtitle, soft_ink);
}

/* The end of the bar is a point where values go on beyond it. */
static void bar_point(chart *c, const color_scale *s, double l, double r, double y, double tip, double value) {
  unsigned char rgb[3];
  scale_color(s, value, rgb);
  const double color[4] = {rgb[0] / 255.0, rgb[1] / 255.0, rgb[2] / 255.0, 1};
  const double corners[3][2] = {{l, y}, {r, y}, {(l + r) / 2, tip}};
  c->plot->fill(c->canvas, corners, 3, color);
}

static void bar_body(chart *c, const color_scale *s, double l, double t, double r, double b) {
  int w = (int)(r - l), h = (int)(b - t);
  for (int j = 0; j < h; j++) {
    double share = 1 - (j + 0.5) / h;
    double value = s->log ? exp(log(s->lo) + share * (log(s->hi) - log(s->lo))) : s->lo + share * (s->hi - s->lo);
    unsigned char row[3 * 256], rgb[3];
    scale_color(s, value, rgb);
    for (int i = 0; i < w && i < 256; i++) memcpy(row + 3 * i, rgb, 3);
    c->plot->image(c->canvas, (int)l, (int)t + j, w < 256 ? w : 256, 1, row);
  }
}

static void bar_outline(chart *c, const color_scale *s, double l, double t, double r, double b, double tip) {
  double line[6][2], m = (l + r) / 2;
  int n = 0;
  line[n][0] = l, line[n++][1] = t;
  if (s->above) line[n][0] = m, line[n++][1] = t - tip;
  line[n][0] = r, line[n++][1] = t;
  line[n][0] = r, line[n++][1] = b;
  if (s->below) line[n][0] = m, line[n++][1] = b + tip;
  line[n][0] = l, line[n++][1] = b;
  c->plot->stroke(c->canvas, (const double(*)[2])line, (size_t)n, true, c->em / 16, chart_ink);
}

void chart_bar(chart *c, const color_scale *s, const char *name, const double *levels, int level_count) {
  double em = c->em, l = ceil(c->right + 1.1 * em), r = l + ceil(1.15 * em), tip = 1.1 * em;
  double t = ceil(c->top + (s->above ? tip : 0)), b = floor(c->bottom - (s->below ? tip : 0));
  int about = tick_count(c, b - t, 3.2);
  ticks k = s->log ? ticks_log(s->lo, s->hi, about) : ticks_linear(s->lo, s->hi, about);
  bar_body(c, s, l, t, r, b);
  if (s->above) bar_point(c, s, l, r, t, t - tip, s->hi);
  if (s->below) bar_point(c, s, l, r, b, b + tip, s->lo);
  for (int i = 0; i < level_count; i++) {
    double y = b - scale_share(s, levels[i]) * (b - t), shade = scale_lightness(s, levels[i]) < 0.55;
    const double line[2][2] = {{l, y}, {r, y}}, rgba[4] = {shade, shade, shade, 0.6};
    c->plot->stroke(c->canvas, line, 2, false, em / 18, rgba);
  }
  bar_outline(c, s, l, t, r, b, tip);
  for (int i = 0; i < k.minor_count; i++) {
    double y = b - scale_share(s, k.minor[i]) * (b - t);
    segment(c, r, y, r + 0.18 * em, y, em / 23);
  }
  for (int i = 0; i < k.count; i++) {
    char text[TICK_TEXT];
    double y = b - scale_share(s, k.at[i]) * (b - t);
    segment(c, r, y, r + 0.34 * em, y, em / 16);
    tick_label(&k, k.at[i], text);
    put(c, r + 0.58 * em, y, 0, 0.5, 0, em, text, chart_ink);
  }
  char label[128];
  axis_name(&k, name, label, sizeof label);
  double x = fmin(r + 1.35 * em + widest(c, &k), c->width - 1.5 * em);
  put(c, x + 0.85 * em, (c->top + c->bottom) / 2, 0.5, 0, 1.5707963267948966, 1.1 * em, label, chart_ink);
}
