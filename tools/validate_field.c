/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks of a body's mesh against its field: distance from the isosurface, rays through both, volume. */
#include "adapt/check.h"
#include "core/vec3.h"
#include "validate.h"
#include <stdint.h>
#include <stdlib.h>

enum {
  RAYS = 1000,   /* through the mesh and the field */
  GRID = 89,     /* rays along each side of the box for the volume; other axes have a few more, so that errors differ */
  CROSSINGS = 64 /* kept of one ray */
};

/* How far the mesh is from the surface, to first order: |F - iso| / |grad F| at vertices, and inside the triangles. */
typedef struct distance {
  double vertex, inside;
  double volume, unsure; /* between the mesh and the surface, outwards positive; the same without signs [L^3] */
} distance;

static double off(const skf_body *b, skf_vec3 p) {
  skf_vec3 g;
  double f = skf_field_at(b->field, p, &g) - b->iso;
  return f == 0 ? 0 : f / v3_norm(g);
}

/* A surface that bends quadratically over a triangle is on average 3/4 as far from it as at its centre. */
static double over_face(const skf_body *b, const skf_vec3 p[3], double *farthest) {
  double center = off(b, v3_scale(1 / 3.0, v3_add(p[0], v3_add(p[1], p[2])))), most = fabs(center);
  for (int k = 0; k < 3; k++) most = fmax(most, fabs(off(b, v3_scale(0.5, v3_add(p[k], p[(k + 1) % 3])))));
  *farthest = most;
  return 0.75 * center * 0.5 * v3_norm(v3_cross(v3_sub(p[1], p[0]), v3_sub(p[2], p[0])));
}

static skf_status measure(const skf_body *b, const skf_mesh *m, distance *d) {
  double vertex = 0, inside = 0, *part = malloc((m->triangle_count + 1) * sizeof *part);
  if (!part) return SKF_ERR_NOMEM;
#pragma omp parallel for schedule(static) reduction(max : vertex)
  for (size_t i = 0; i < m->vertex_count; i++) vertex = fmax(vertex, fabs(off(b, m->vertices[i])));
#pragma omp parallel for schedule(static) reduction(max : inside)
  for (size_t t = 0; t < m->triangle_count; t++) {
    const unsigned *v = m->triangles[t];
    double farthest;
    part[t] = over_face(b, (skf_vec3[3]){m->vertices[v[0]], m->vertices[v[1]], m->vertices[v[2]]}, &farthest);
    inside = fmax(inside, farthest);
  }
  *d = (distance){vertex, inside, 0, 0};
  for (size_t t = 0; t < m->triangle_count; t++) d->volume += part[t], d->unsure += fabs(part[t]);
  free(part);
  return SKF_OK;
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

/* Volume inside F = iso by rays along one axis: midpoint rule over an n by n grid; the sum does not depend on threads.
 */
static skf_status volume_along(const skf_tracer *tracer, skf_box box, int axis, int n, double *out) {
  double *part = malloc((size_t)(n * n) * sizeof *part);
  skf_status status = part ? SKF_OK : SKF_ERR_NOMEM;
  if (!part) return status;
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  skf_vec3 d = v3_sub(box.hi, box.lo);
#pragma omp parallel for schedule(dynamic, 16)
  for (int k = 0; k < n * n; k++) {
    skf_ray ray = {box.lo, {0, 0, 0}, 0, INFINITY};
    *v3_at(&ray.direction, axis) = 1;
    *v3_at(&ray.origin, u) += (k % n + 0.5) / n * v3_get(d, u);
    *v3_at(&ray.origin, v) += (k / n + 0.5) / n * v3_get(d, v);
    part[k] = inside(tracer, &ray, &status);
  }
  double sum = 0;
  for (int k = 0; k < n * n; k++) sum += part[k];
  *out = sum * v3_get(d, u) * v3_get(d, v) / (n * n);
  free(part);
  return status;
}

/* The mesh's volume with what lies between it and the surface, against the quadrature. The first is good to a fifth of
   what was added where the mesh resolves the surface. */
static skf_status check_volume(const skf_tracer *tracer, skf_box box, const skf_mesh_measure *q, const distance *d,
                               section *s) {
  double v[3], mean = 0, spread = 0;
  for (int k = 0; k < 3; k++) {
    skf_status e = volume_along(tracer, box, k, GRID + 7 * k, v + k);
    if (e) return e;
    mean += v[k] / 3;
  }
  for (int k = 0; k < 3; k++) spread = fmax(spread, fabs(v[k] - mean));
  double corrected = q->volume + d->volume;
  section_check(s, "volume", fabs(corrected - mean) <= 2 * spread + 0.2 * d->unsure,
                "mesh %+.2e of the quadrature's (+-%.0e); with what lies between faces and surface %+.2e",
                (q->volume - mean) / mean, spread / mean, (corrected - mean) / mean);
  section_number(s, "volume by quadrature", "L^3", mean);
  section_number(s, "error of that", "L^3", spread);
  section_number(s, "volume corrected", "L^3", corrected);
  return SKF_OK;
}

skf_status validate_against_field(const skf_body *b, const skf_mesh *mesh, const skf_mesh_report *made, section *s) {
  skf_mesh_measure q;
  skf_tracer *tracer;
  skf_status e = skf_mesh_measure_of(mesh, &q);
  distance d;
  if (!e) e = measure(b, mesh, &d);
  if (!e) e = skf_tracer_new(b->field, b->iso, &tracer);
  if (e) return e;
  double size = box_diagonal(q.box);
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
  if (!e) e = check_volume(tracer, box, &q, &d, s);
  section_number(s, "vertices off by", "L", d.vertex);
  section_number(s, "vertices off of size", "", d.vertex / size);
  section_number(s, "faces off by", "L", d.inside);
  skf_tracer_free(tracer);
  return e;
}
