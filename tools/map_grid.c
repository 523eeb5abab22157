/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A quantity of a scene, sampled on an axis-aligned plane. */
#include "map_grid.h"
#include "core/number.h"
#include "core/vec3.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

const map_quantity map_quantities[MAP_KIND_COUNT] = {
    [MAP_F] = {"F", "field F", "field F", "|F|"},
    [MAP_POTENTIAL] = {"potential", "potential U = −G ρ F", "potential U", "|U|"},
    [MAP_ACCELERATION] = {"acceleration", "acceleration |G ρ ∇F|", "acceleration |a|", "acceleration |a|"},
};

bool map_plane_parse(const char *text, map_plane *out) {
  static const map_plane planes[3] = {{0, 1, 2, 0}, {1, 0, 2, 0}, {2, 0, 1, 0}};
  size_t used;
  if (text[0] < 'x' || text[0] > 'z' || text[1] != '=') return false;
  *out = planes[text[0] - 'x'];
  return skf_number_read(text + 2, &used, &out->at) == SKF_OK && text[2 + used] == 0;
}

skf_vec3 map_point(const map_grid *g, double i, double j) {
  skf_vec3 p;
  *v3_at(&p, g->plane.normal) = g->plane.at;
  *v3_at(&p, g->plane.u) = g->x0 + (i + 0.5) / g->nx * (g->x1 - g->x0);
  *v3_at(&p, g->plane.v) = g->y1 - (j + 0.5) / g->ny * (g->y1 - g->y0);
  return p;
}

enum { BLOCK = 8192 }; /* points evaluated at once: enough for every thread, little enough for a smooth progress bar */

/* Room for one block: points, values, gradients. */
typedef struct block {
  double p[3][BLOCK], F[BLOCK], g[3][BLOCK];
} block;

typedef struct sums {
  double *F, *g[3]; /* of the current body; of all bodies times G rho */
} sums;

static skf_status sample_body(const skf_scene *scene, const skf_body *body, map_kind kind, map_grid *m, sums *s,
                              block *b, size_t first, size_t n) {
  for (size_t k = 0; k < n; k++) {
    skf_vec3 p = map_point(m, (double)((first + k) % (size_t)m->nx), (double)((first + k) / (size_t)m->nx));
    b->p[0][k] = p.x, b->p[1][k] = p.y, b->p[2][k] = p.z;
  }
  const double *const p[3] = {b->p[0], b->p[1], b->p[2]};
  double *const g[3] = {b->g[0], b->g[1], b->g[2]};
  skf_status status = skf_field_eval(body->field, n, p, b->F, s->g[0] ? g : NULL, NULL);
  double factor = kind == MAP_F ? 1 : scene->G * body->rho;
  for (size_t k = 0; k < n; k++) {
    s->F[first + k] = b->F[k];
    if (kind != MAP_ACCELERATION) m->value[first + k] += kind == MAP_F ? b->F[k] : -factor * b->F[k];
    for (int i = 0; i < 3 && s->g[0]; i++) s->g[i][first + k] += factor * b->g[i][k];
  }
  return status;
}

static skf_status sample_all(const skf_scene *scene, map_kind kind, map_grid *m, sums *s, block *b, contours *outlines,
                             skf_progress progress) {
  size_t n = (size_t)m->nx * m->ny;
  for (size_t i = 0; i < scene->body_count; i++) {
    for (size_t first = 0; first < n; first += BLOCK) {
      size_t count = n - first < BLOCK ? n - first : BLOCK;
      skf_status status = sample_body(scene, scene->bodies + i, kind, m, s, b, first, count);
      if (status) return status;
      double done = ((double)i + (double)(first + count) / (double)n) / (double)scene->body_count;
      if (progress.report && progress.report(progress.user, done)) return SKF_ERR_CANCELLED;
    }
    if (!contour_find(s->F, m->nx, m->ny, scene->bodies[i].iso, outlines + i)) return SKF_ERR_NOMEM;
  }
  return SKF_OK;
}

/* From sums to what the map shows. */
static void finish(map_kind kind, bool arrows, map_grid *m, sums *s) {
  size_t n = (size_t)m->nx * m->ny;
  for (size_t k = 0; kind == MAP_ACCELERATION && k < n; k++) {
    m->value[k] = v3_norm(v3(s->g[0][k], s->g[1][k], s->g[2][k]));
    if (isinf(s->F[k])) m->value[k] = INFINITY; /* the gradient is set to 0 on a singular set */
  }
  for (int i = 0; i < 2 && arrows; i++) {
    int axis = i ? m->plane.v : m->plane.u;
    m->slope[i] = s->g[axis];
    s->g[axis] = NULL;
  }
}

skf_status map_sample(const skf_scene *scene, map_kind kind, bool arrows, map_grid *m, contours *outlines,
                      skf_progress progress) {
  size_t n = (size_t)m->nx * m->ny;
  sums s = {malloc(n * sizeof(double)), {NULL, NULL, NULL}};
  block *b = malloc(sizeof *b);
  m->value = calloc(n, sizeof(double));
  bool room = s.F && b && m->value;
  for (int i = 0; i < 3 && (arrows || kind == MAP_ACCELERATION); i++)
    room = (s.g[i] = calloc(n, sizeof(double))) && room;
  skf_status status = room ? sample_all(scene, kind, m, &s, b, outlines, progress) : SKF_ERR_NOMEM;
  if (!status) finish(kind, arrows, m, &s);
  free(s.F), free(b);
  for (int i = 0; i < 3; i++) free(s.g[i]);
  return status;
}

void map_grid_free(map_grid *m) {
  free(m->value), free(m->slope[0]), free(m->slope[1]);
  m->value = m->slope[0] = m->slope[1] = NULL;
}

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Some of the finite values (with log: their absolute values, not 0), sorted. */
static double *some_sorted(const double *value, size_t n, bool log, size_t *count) {
  size_t stride = n / 200000 + 1, k = 0; /* 200 000 samples fix the hundredths well */
  double *v = malloc((n / stride + 1) * sizeof *v);
  for (size_t i = 0; v && i < n; i += stride) {
    double x = log ? fabs(value[i]) : value[i];
    if (isfinite(x) && (!log || x > 0)) v[k++] = x;
  }
  if (v) qsort(v, k, sizeof *v, ascending);
  *count = k;
  return v;
}

/* Where few values lie far beyond the others, the range ends with the others. */
static void choose_range(const double *v, size_t n, bool log, double *lo, double *hi) {
  double q0 = v[n / 100], q1 = v[n - 1 - n / 50], ends[2] = {v[0], v[n - 1]};
  double slack = log ? fmin(q1 / q0, 1e300) : q1 - q0;
  if (log ? ends[0] < q0 / slack : ends[0] < q0 - slack) ends[0] = q0;
  if (log ? ends[1] > q1 * slack : ends[1] > q1 + slack) ends[1] = q1;
  if (isnan(*lo)) *lo = ends[0];
  if (isnan(*hi)) *hi = ends[1];
}

void map_range(const double *value, size_t n, bool log, double lo, double hi, color_scale *out) {
  size_t count;
  double *v = some_sorted(value, n, log, &count);
  if (v && count) choose_range(v, count, log, &lo, &hi);
  free(v);
  if (isnan(lo)) lo = isnan(hi) ? (log ? 1 : 0) : log ? hi / 10 : hi - 1;
  if (isnan(hi)) hi = log ? 10 * lo : lo + 1;
  if (!(lo < hi)) { /* one value everywhere */
    double m = lo != 0 ? fabs(lo) : 1;
    hi = log ? lo * 2 : lo + 0.5 * m, lo = log ? lo / 2 : lo - 0.5 * m;
  }
  out->lo = lo, out->hi = hi, out->log = log, out->below = out->above = false;
  for (size_t i = 0; i < n; i++) {
    double x = log ? fabs(value[i]) : value[i];
    out->below |= x<lo, out->above |= x> hi;
  }
}
