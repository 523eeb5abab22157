/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Paths of particles in a rendered picture, hidden where a surface is in front. */
#include "render_paths.h"
#include "core/vec3.h"
#include <math.h>
#include <stdlib.h>

typedef struct spot {
  double xy[2], distance;
  bool seen;
} spot;

static const double halo[4] = {0, 0, 0, 0.55};

static spot project(const path_view *v, skf_vec3 p) {
  double px[3];
  spot s = {{0, 0}, 0, false};
  if (!skf_camera_project(&v->camera, v->width, v->height, p, px)) return s;
  s.xy[0] = px[0], s.xy[1] = px[1], s.distance = px[2];
  bool inside = px[0] >= 0 && px[1] >= 0 && px[0] < v->width && px[1] < v->height;
  /* What lies on a surface, to a thousandth, is seen. */
  s.seen = inside && px[2] <= 1.001 * v->depth[(size_t)px[1] * v->width + (size_t)px[0]];
  return s;
}

/* Straight pieces of two pixels at most, so that each is seen or hidden as a whole. */
static size_t pieces(const path_view *v, skf_vec3 a, skf_vec3 b) {
  spot p = project(v, a), q = project(v, b);
  if (!(p.distance > 0) || !(q.distance > 0)) return 1;
  double n = ceil(hypot(q.xy[0] - p.xy[0], q.xy[1] - p.xy[1]) / 2);
  return n < 1 ? 1 : n > 2000 ? 2000 : (size_t)n;
}

/* A run of spots that are seen; nearer is wider. */
static void stroke(const path_view *v, const spot *s, size_t n, const double rgba[4]) {
  enum { PART = 24 };
  for (int layer = 0; layer < 2; layer++)
    for (size_t i = 0; i + 1 < n; i += PART) {
      double xy[PART + 1][2];
      size_t count = n - i < PART + 1 ? n - i : PART + 1;
      for (size_t k = 0; k < count; k++) xy[k][0] = s[i + k].xy[0], xy[k][1] = s[i + k].xy[1];
      double near = fmin(fmax(v->middle / s[i + count / 2].distance, 0.5), 2), width = v->line * near;
      v->plot->stroke(v->canvas, (const double(*)[2])xy, count, false, layer ? width : 1.9 * width,
                      layer ? rgba : halo);
    }
}

static bool draw(const path_view *v, const skf_vec3 *path, size_t n, const double rgba[4]) {
  size_t total = 1, k = 0;
  for (size_t i = 1; i < n; i++) total += pieces(v, path[i - 1], path[i]);
  spot *s = malloc((total + 1) * sizeof *s);
  if (!s) return false;
  s[k++] = project(v, path[0]);
  for (size_t i = 1; i < n; i++) {
    size_t m = pieces(v, path[i - 1], path[i]);
    skf_vec3 way = v3_sub(path[i], path[i - 1]);
    for (size_t j = 1; j <= m; j++) s[k++] = project(v, v3_mad(path[i - 1], (double)j / (double)m, way));
  }
  for (size_t i = 0; i < k;) {
    size_t end = i;
    while (end < k && s[end].seen) end++;
    if (end > i) stroke(v, s + i, end - i, rgba);
    i = end > i ? end : i + 1;
  }
  free(s);
  return true;
}

/* A point on ground that slopes steeply away lies within a pixel of the ground that the picture shows. */
static bool lies_near(const path_view *v, const spot *s) {
  for (int dy = -1; dy <= 1; dy++)
    for (int dx = -1; dx <= 1; dx++) {
      double x = s->xy[0] + dx, y = s->xy[1] + dy;
      if (!(x >= 0 && y >= 0 && x < v->width && y < v->height)) continue;
      float depth = v->depth[(size_t)y * v->width + (size_t)x];
      if (isfinite(depth) && s->distance <= 1.001 * depth) return true;
    }
  return false;
}

static void dot(const path_view *v, skf_vec3 p, double radius, const double rgba[4]) {
  spot s = project(v, p);
  double disc[24][2];
  if (!s.seen && !(s.distance > 0 && lies_near(v, &s))) return;
  for (int layer = 0; layer < 2; layer++) {
    double r = radius * (layer ? 1 : 1.35);
    for (int k = 0; k < 24; k++) {
      disc[k][0] = s.xy[0] + r * cos(k * 0.26179938779914946), disc[k][1] = s.xy[1] + r * sin(k * 0.26179938779914946);
    }
    v->plot->fill(v->canvas, (const double(*)[2])disc, 24, layer ? rgba : halo);
  }
}

bool render_paths(const path_view *v, const run_data *run) {
  for (size_t i = 0; i < run->particle_count; i++) {
    size_t n;
    double rgba[4];
    skf_vec3 *path = run_path(run, i, &n);
    picture_color(i, rgba);
    bool drawn = path && (n == 0 || draw(v, path, n, rgba));
    if (drawn && n) dot(v, path[v->heads ? n - 1 : 0], 2 * v->line, rgba);
    free(path);
    if (!drawn) return false;
  }
  static const double red[4] = {0.95, 0.1, 0.1, 1};
  for (size_t i = 0; i < run->contact_count; i++) dot(v, run->contacts[i].state.x, 2.4 * v->line, red);
  return true;
}
