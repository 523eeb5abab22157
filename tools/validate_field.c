/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks of a body's mesh against its field: distance from the isosurface, rays through both, volume. */
#include "adapt/check.h"
#include "core/vec3.h"
#include "validate.h"
#include <stdint.h>
#include <stdlib.h>

enum {
  RAYS = 1000,   /* through the mesh and the field */
  GRID = 96,     /* rays along each side of the box for the volume */
  CROSSINGS = 64 /* kept of one ray */
};

/* How far the mesh is from the surface, to first order: |F - iso| / |grad F| at vertices, and inside the triangles. */
typedef struct distance {
  double vertex, inside;
} distance;

static double off(const skf_body *b, skf_vec3 p) {
  skf_vec3 g;
  double f = skf_field_at(b->field, p, &g) - b->iso;
  return f == 0 ? 0 : f / v3_norm(g);
}

static distance measure(const skf_body *b, const skf_mesh *m) {
  double vertex = 0, inside = 0;
#pragma omp parallel for schedule(static) reduction(max : vertex)
  for (size_t i = 0; i < m->vertex_count; i++) vertex = fmax(vertex, fabs(off(b, m->vertices[i])));
#pragma omp parallel for schedule(static) reduction(max : inside)
  for (size_t t = 0; t < m->triangle_count; t++) {
    const unsigned *v = m->triangles[t];
    skf_vec3 p[3] = {m->vertices[v[0]], m->vertices[v[1]], m->vertices[v[2]]};
    inside = fmax(inside, fabs(off(b, v3_scale(1 / 3.0, v3_add(p[0], v3_add(p[1], p[2]))))));
    for (int k = 0; k < 3; k++) inside = fmax(inside, fabs(off(b, v3_scale(0.5, v3_add(p[k], p[(k + 1) % 3])))));
  }
  return (distance){vertex, inside};
}

/* Random numbers that are the same everywhere [Steele, Lea & Flood 2014, splitmix64]. */
static double uniform(uint64_t *state) {
  uint64_t z = *state += 0x9e3779b97f4a7c15u;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
  z = (z ^ z >> 27) * 0x94d049bb133111ebu;
  return ldexp((double)((z ^ z >> 31) >> 11), -53);
}

/* From a sphere around the box towards a point in the box. */
static skf_ray random_ray(skf_box box, uint64_t *state) {
  double z = 2 * uniform(state) - 1, phi = 2 * SKF_PI * uniform(state), s = sqrt(1 - z * z), x[3];
  for (int k = 0; k < 3; k++) x[k] = uniform(state);
  skf_vec3 d = v3_sub(box.hi, box.lo), to = v3(box.lo.x + x[0] * d.x, box.lo.y + x[1] * d.y, box.lo.z + x[2] * d.z);
  skf_vec3 from = v3_mad(box_center(box), box_diagonal(box), v3(s * cos(phi), s * sin(phi), z));
  return (skf_ray){from, v3_unit(v3_sub(to, from)), 0, INFINITY};
}

typedef struct comparison {
  size_t agree, grazing, differ; /* crossings that agree; rays */
  double worst;                  /* distance between crossings, along the normal [L] */
  skf_status status;
} comparison;

/* Crossings of one ray by both; pairs that only one of them has must come from a surface that the ray grazes closer
   than the mesh follows it. */
static void compare(const skf_body *b, const skf_ray *ray, size_t na, const skf_hit *a, size_t nm, const double *m,
                    double tolerance, comparison *c) {
  size_t i = 0, j = 0;
  bool grazing = false, differ = false;
  while (i < na || j < nm) {
    if (i < na && j < nm) {
      double along = fabs(v3_dot(a[i].normal, ray->direction)), gap = fabs(a[i].t - m[j]) * along;
      if (gap <= tolerance) {
        c->agree++, c->worst = fmax(c->worst, gap), i++, j++;
        continue;
      }
    }
    /* Two in a row that the other does not have. */
    bool field = j >= nm || (i < na && a[i].t < m[j]);
    double t0 = field ? a[i].t : m[j], t1 = field ? i + 1 < na ? a[i + 1].t : NAN : j + 1 < nm ? m[j + 1] : NAN;
    if (field)
      i += 2;
    else
      j += 2;
    if (fabs(off(b, v3_mad(ray->origin, 0.5 * (t0 + t1), ray->direction))) <= tolerance)
      grazing = true;
    else
      differ = true; /* NaN too: an odd one */
    if (differ) break;
  }
  c->grazing += grazing && !differ, c->differ += differ;
}

static comparison cast(const skf_body *b, const skf_mesh *mesh, skf_box box, const skf_tracer *tracer,
                       double tolerance) {
  comparison c = {0, 0, 0, 0, SKF_OK};
  check_tree *tree;
  c.status = check_tree_new(mesh, &tree);
  uint64_t state = 1999;
  for (int k = 0; k < RAYS && !c.status; k++) {
    skf_ray ray = random_ray(box, &state);
    skf_hit hits[CROSSINGS];
    double t[CROSSINGS];
    size_t n = 0, m = 0;
    c.status = skf_tracer_all(tracer, &ray, CROSSINGS, hits, &n, NULL);
    if (!c.status) c.status = check_tree_all(tree, ray.origin, ray.direction, CROSSINGS, t, &m);
    if (n > CROSSINGS || m > CROSSINGS)
      c.differ += n != m;
    else
      compare(b, &ray, n, hits, m, t, tolerance, &c);
  }
  check_tree_free(tree);
  return c;
}

/* Length of the ray inside the surface. */
static double inside(const skf_tracer *tracer, const skf_ray *ray, skf_status *status) {
  skf_hit hits[CROSSINGS];
  size_t n = 0;
  double sum = 0;
  skf_status e = skf_tracer_all(tracer, ray, CROSSINGS, hits, &n, NULL);
  if (!e && n > CROSSINGS) e = SKF_ERR_CAPACITY;
  for (size_t i = 0; i + 1 < n && !e; i += 2) sum += hits[i + 1].t - hits[i].t;
  if (e) {
#pragma omp atomic write
    *status = e;
  }
  return sum;
}

/* Volume inside F = iso by rays along one axis: midpoint rule over a grid; the sum does not depend on threads. */
static skf_status volume_along(const skf_tracer *tracer, skf_box box, int axis, double *out) {
  double *part = malloc(GRID * GRID * sizeof *part);
  skf_status status = part ? SKF_OK : SKF_ERR_NOMEM;
  if (!part) return status;
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  skf_vec3 d = v3_sub(box.hi, box.lo);
#pragma omp parallel for schedule(dynamic, 16)
  for (int k = 0; k < GRID * GRID; k++) {
    skf_ray ray = {box.lo, {0, 0, 0}, 0, INFINITY};
    *v3_at(&ray.direction, axis) = 1;
    *v3_at(&ray.origin, u) += (k % GRID + 0.5) / GRID * v3_get(d, u);
    *v3_at(&ray.origin, v) += (k / GRID + 0.5) / GRID * v3_get(d, v);
    part[k] = inside(tracer, &ray, &status);
  }
  double sum = 0;
  for (int k = 0; k < GRID * GRID; k++) sum += part[k];
  *out = sum * v3_get(d, u) * v3_get(d, v) / (GRID * GRID);
  free(part);
  return status;
}

static skf_status check_volume(const skf_tracer *tracer, skf_box box, const skf_mesh_measure *q, double gap,
                               section *s) {
  double v[3], mean = 0, spread = 0;
  for (int k = 0; k < 3; k++) {
    skf_status e = volume_along(tracer, box, k, v + k);
    if (e) return e;
    mean += v[k] / 3;
  }
  for (int k = 0; k < 3; k++) spread = fmax(spread, fabs(v[k] - mean));
  double allowed = q->area * gap + 2 * spread, difference = q->volume - mean;
  section_check(s, "volume", fabs(difference) <= allowed,
                "mesh %+.2e of the volume by %d rays (+-%.0e); the mesh's distance explains %.0e", difference / mean,
                3 * GRID * GRID, spread / mean, q->area * gap / mean);
  section_number(s, "volume by rays", "L^3", mean);
  section_number(s, "error of that", "L^3", spread);
  return SKF_OK;
}

skf_status validate_against_field(const skf_body *b, const skf_mesh *mesh, const skf_mesh_report *made, section *s) {
  skf_mesh_measure q;
  skf_tracer *tracer;
  skf_status e = skf_mesh_measure_of(mesh, &q);
  if (!e) e = skf_tracer_new(b->field, b->iso, &tracer);
  if (e) return e;
  double size = box_diagonal(q.box);
  distance d = measure(b, mesh);
  section_check(s, "on the surface", d.vertex <= 1e-12 * size, "vertices at most %.2e from F = iso, %.1e of the size",
                d.vertex, d.vertex / size);
  section_check(s, "nothing missed", made->missed == 0,
                "%zu places of the skeleton inside the surface but not the mesh", made->missed);
  /* First order distances are too small where the surface is curved: half again covers the meshes that resolve it. */
  double gap = 1.5 * d.inside;
  skf_box box = box_grow(q.box, gap + 1e-6 * size);
  if (check_available()) {
    comparison c = cast(b, mesh, box, tracer, 2 * gap);
    e = c.status;
    section_check(s, "rays", c.differ == 0,
                  "%d cast through CGAL's tree and the field: %zu crossings agree within %.1e L, %zu rays graze, %zu "
                  "disagree",
                  RAYS, c.agree, c.worst, c.grazing, c.differ);
    section_count(s, "rays that disagree", (double)c.differ);
    section_count(s, "rays that graze", (double)c.grazing);
  }
  if (!e) e = check_volume(tracer, box, &q, gap, s);
  section_number(s, "vertices off by", "L", d.vertex);
  section_number(s, "vertices off of size", "", d.vertex / size);
  section_number(s, "faces off by", "L", d.inside);
  skf_tracer_free(tracer);
  return e;
}
