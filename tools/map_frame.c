/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which part of a plane a map shows. */
#include "map_grid.h"
#include "core/vec3.h"
#include <math.h>
#include <stdlib.h>

static void include(double range[2], double v) {
  if (!isfinite(v)) return;
  if (!(range[0] <= range[1])) range[0] = range[1] = v;
  range[0] = fmin(range[0], v), range[1] = fmax(range[1], v);
}

skf_box map_skeleton_box(const skf_body *body) {
  skf_box all = box_empty();
  for (size_t i = 0; i < body->element_count; i++) {
    const skf_primitive *p = &body->elements[i].primitive;
    skf_box b = skf_primitive_bounds(p);
    if (p->shape == SKF_PLANE) b = (skf_box){p->plane.through, p->plane.through};
    all = box_join(all, b);
  }
  double size = fmax(box_diagonal(all), 0);
  for (size_t i = 0; i < body->element_count && !(size > 0); i++) /* a point: the kernel gives the length */
    if (body->elements[i].kernel.param > 0) {
      const skf_kernel *k = &body->elements[i].kernel;
      size = skf_kernel_get(k->type)->compact ? k->param : 1 / k->param;
    }
  return box_grow(all, size > 0 ? size / 2 : 1);
}

enum { COARSE = 96 };

/* Shrinks the rectangle to the cells of a coarse grid that reach F >= iso, with one cell around; false when none
   does. */
static bool shrink(const skf_body *body, map_grid *g) {
  double *all = malloc(4 * COARSE * COARSE * sizeof *all), *p[3], *F = all + 3 * COARSE * COARSE;
  if (!all) return false;
  for (int k = 0; k < 3; k++) p[k] = all + k * COARSE * COARSE;
  for (int k = 0; k < COARSE * COARSE; k++) {
    skf_vec3 q = map_point(g, k % COARSE, k / COARSE);
    p[0][k] = q.x, p[1][k] = q.y, p[2][k] = q.z;
  }
  int lo[2] = {COARSE, COARSE}, hi[2] = {-1, -1};
  skf_status status = skf_field_eval(body->field, COARSE * COARSE, (const double *const *)p, F, NULL, NULL);
  for (int k = 0; k < COARSE * COARSE && !status; k++) {
    if (!(F[k] >= body->iso)) continue;
    int at[2] = {k % COARSE, k / COARSE};
    for (int i = 0; i < 2; i++) lo[i] = at[i] < lo[i] ? at[i] : lo[i], hi[i] = at[i] > hi[i] ? at[i] : hi[i];
  }
  free(all);
  if (hi[0] < 0) return false;
  double w = (g->x1 - g->x0) / COARSE, h = (g->y1 - g->y0) / COARSE, x0 = g->x0, y1 = g->y1;
  g->x0 = x0 + (lo[0] - 1) * w, g->x1 = x0 + (hi[0] + 2) * w;
  g->y1 = y1 - (lo[1] - 1) * h, g->y0 = y1 - (hi[1] + 2) * h;
  return true;
}

void map_frame(const skf_scene *scene, map_plane plane, double x[2], double y[2]) {
  for (size_t i = 0; i < scene->body_count; i++) {
    const skf_body *body = scene->bodies + i;
    skf_box box;
    bool bounded = skf_field_region(body->field, body->iso, &box) == SKF_OK;
    if (!bounded) box = map_skeleton_box(body);
    map_grid g = {.plane = plane, .nx = COARSE, .ny = COARSE};
    g.x0 = v3_get(box.lo, plane.u), g.x1 = v3_get(box.hi, plane.u);
    g.y0 = v3_get(box.lo, plane.v), g.y1 = v3_get(box.hi, plane.v);
    if (bounded && plane.at >= v3_get(box.lo, plane.normal) && plane.at <= v3_get(box.hi, plane.normal))
      for (int pass = 0; pass < 3 && shrink(body, &g); pass++) continue;
    include(x, g.x0), include(x, g.x1);
    include(y, g.y0), include(y, g.y1);
  }
}
