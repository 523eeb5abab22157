/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The picture of a contact map: longitude across, latitude up, at equal scales. */
#include "chart.h"
#include "contact_map.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 1600, HEIGHT = 900 };

/* What a bin shows: contacts per area in units of an even spread, or their mean speed; NAN where there is none. */
static double shown(const contact_map *m, int band, int i) {
  size_t bin = m->bands[band].first + (size_t)i;
  double n = (double)m->count[bin];
  if (m->by_speed) return n > 0 ? m->speed[bin] / n : NAN;
  return m->contacts ? n / ((double)m->contacts * contact_map_bin(m, band, i).share) : 0;
}

static void choose_range(const contact_map *m, color_scale *s) {
  s->lo = INFINITY, s->hi = -INFINITY;
  for (int k = 0; k < m->band_count; k++)
    for (int i = 0; i < m->bands[k].count; i++) {
      double v = shown(m, k, i);
      s->lo = fmin(s->lo, v), s->hi = fmax(s->hi, v);
    }
  if (!m->by_speed) s->lo = 0;
  if (!(s->lo <= s->hi)) s->lo = 0, s->hi = 1;
  if (!(s->hi > s->lo)) s->hi = s->lo > 0 ? 2 * s->lo : 1; /* all alike */
}

static int paint(const contact_map *m, chart *h, const color_scale *scale) {
  int w = (int)(h->right - h->left), t = (int)(h->bottom - h->top);
  unsigned char *rgb = malloc(3 * (size_t)w * (size_t)t);
  if (!rgb) return cli_fail(CLI_FAILED, "out of memory");
  for (int y = 0; y < t; y++) {
    int band = (int)((1 - (y + 0.5) / t) * m->band_count);
    for (int x = 0; x < w; x++) {
      int i = (int)((x + 0.5) / w * m->bands[band].count);
      scale_color(scale, shown(m, band, i), rgb + 3 * ((size_t)y * (size_t)w + (size_t)x));
    }
  }
  m->plot->image(h->canvas, (int)h->left, (int)h->top, w, t, rgb);
  free(rgb);
  return CLI_DONE;
}

static void titles(const contact_map *m, char title[128], char subtitle[256]) {
  const skf_body *b = m->scene->bodies + m->body;
  snprintf(title, 128, "%zu contact%s with %.60s", m->contacts, m->contacts == 1 ? "" : "s", b->name);
  snprintf(subtitle, 256, "%s, in bins of about %g°; %s latitude and longitude in the body's frame",
           m->by_speed ? "mean speed relative to the ground (grey: no contact)"
                       : "contacts per area (1: spread evenly)",
           m->step, b->ellipsoid.given ? "geodetic" : "planetocentric");
}

static int draw(const contact_map *m, chart *h, unsigned char **bytes, size_t *n) {
  color_scale scale = {.log = false};
  char title[128], subtitle[256], error[256];
  m->plot->colormap("viridis", scale.rgb);
  chart_layout(h, false);
  choose_range(m, &scale);
  int status = paint(m, h, &scale);
  if (status) return status;
  titles(m, title, subtitle);
  chart_axes(h, "longitude [°]", "latitude [°]", title, subtitle);
  chart_bar(h, &scale, m->by_speed ? "speed" : "density", NULL, 0);
  if (m->plot->encode(h->canvas, m->format->ending, bytes, n, error))
    return cli_fail(CLI_FAILED, "%s: %s", m->picture_path, error);
  return CLI_DONE;
}

int contact_map_draw(const contact_map *m, unsigned char **bytes, size_t *n) {
  char error[256];
  chart *h = calloc(1, sizeof *h);
  if (!h) return cli_fail(CLI_FAILED, "out of memory");
  *h = (chart){.plot = m->plot, .width = WIDTH, .height = HEIGHT, .degrees = true};
  h->x0 = -180, h->x1 = 180, h->y0 = -90, h->y1 = 90;
  h->canvas = m->plot->create(WIDTH, HEIGHT, NULL, error);
  int status = h->canvas ? draw(m, h, bytes, n) : cli_fail(CLI_FAILED, "%s", error);
  if (h->canvas) m->plot->destroy(h->canvas);
  free(h);
  return status;
}
