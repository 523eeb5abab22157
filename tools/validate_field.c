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

/* How far the mesh is from the surface: |F - iso| / |grad F| at vertices and inside the triangles; where that is much
   for the triangle, so that it tells little, along the triangle's normal. */
typedef struct distance {
  double vertex, inside;
  double followed;       /* as inside, without the triangles that are astray */
  size_t astray;         /* triangles with a place that has no surface within a quarter of their longest edge */
  double volume, unsure; /* between the mesh and the surface, outwards positive; the same without signs [L^3] */
} distance;

static double off(const skf_body *b, skf_vec3 p) {
  skf_vec3 g;
  double f = skf_field_at(b->field, p, &g) - b->iso;
  return f == 0 ? 0 : f / v3_norm(g);
}

static bool is_inside(const skf_body *b, skf_vec3 p) { return skf_field_at(b->field, p, NULL) > b->iso; }

/* Distance from p to the surface along the outward unit normal n, within `reach` on either side; *astray is set where
   there is none, inwards of which is the inside. */
static double along_normal(const skf_body *b, skf_vec3 p, skf_vec3 n, double reach, bool *astray) {
  double sign = is_inside(b, p) ? 1 : -1, near = 0, far = 0;
  for (int k = 1; k <= 8 && !(far > 0); k++)
    if (is_inside(b, v3_mad(p, sign * reach * k / 8, n)) != (sign > 0))
      far = reach * k / 8;
    else
      near = reach * k / 8;
  if (!(far > 0)) return *astray = true, sign * reach;
  for (int k = 0; k < 30; k++) {
    double mid = 0.5 * (near + far);
    *(is_inside(b, v3_mad(p, sign * mid, n)) == (sign > 0) ? &near : &far) = mid;
  }
  return sign * 0.5 * (near + far);
}

/* A surface that bends quadratically over a triangle is on average 3/4 as far from it as at its centre. */
static double over_face(const skf_body *b, const skf_vec3 p[3], double *farthest, bool *astray) {
  skf_vec3 n = v3_unit(v3_cross(v3_sub(p[1], p[0]), v3_sub(p[2], p[0])));
  double center = 0, most = 0, longest = 0;
  for (int k = 0; k < 3; k++) longest = fmax(longest, v3_dist(p[k], p[(k + 1) % 3]));
  *astray = false;
  for (int k = 0; k < 4; k++) {
    skf_vec3 q =
        k == 3 ? v3_scale(1 / 3.0, v3_add(p[0], v3_add(p[1], p[2]))) : v3_scale(0.5, v3_add(p[k], p[(k + 1) % 3]));
    double d = off(b, q);
    if (!(fabs(d) <= 0.12 * longest)) d = along_normal(b, q, n, 0.25 * longest, astray);
    most = fmax(most, fabs(d));
    if (k == 3) center = d;
  }
  *farthest = most;
  return 0.75 * center * 0.5 * v3_norm(v3_cross(v3_sub(p[1], p[0]), v3_sub(p[2], p[0])));
}

static skf_status measure(const skf_body *b, const skf_mesh *m, distance *d) {
  size_t astray = 0;
  double vertex = 0, inside = 0, followed = 0, *part = malloc((m->triangle_count + 1) * sizeof *part);
  if (!part) return SKF_ERR_NOMEM;
#pragma omp parallel for schedule(static) reduction(max : vertex)
  for (size_t i = 0; i < m->vertex_count; i++) vertex = fmax(vertex, fabs(off(b, m->vertices[i])));
#pragma omp parallel for schedule(static) reduction(max : inside, followed) reduction(+ : astray)
  for (size_t t = 0; t < m->triangle_count; t++) {
    const unsigned *v = m->triangles[t];
    double farthest;
    bool lost;
    part[t] = over_face(b, (skf_vec3[3]){m->vertices[v[0]], m->vertices[v[1]], m->vertices[v[2]]}, &farthest, &lost);
    inside = fmax(inside, farthest), astray += lost;
    if (!lost) followed = fmax(followed, farthest);
  }
  *d = (distance){vertex, inside, followed, astray, 0, 0};
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

static comparison cast(const skf_body *b, const skf_mesh *mesh, size_t count, const skf_box *boxes,
                       const skf_tracer *tracer, double tolerance) {
  comparison c = {0, 0, 0, 0, SKF_OK};
  check_tree *tree;
  c.status = check_tree_new(mesh, &tree);
  uint64_t state = 1999;
  for (int k = 0; k < RAYS && !c.status; k++) {
    skf_ray ray = random_ray(boxes[(size_t)k % count], &state);
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

/* Volume enclosed by F = iso in the box, which the surface does not cross, by rays along one axis: midpoint rule over
   an n by n grid; the sum does not depend on threads. */
static skf_status volume_along(const skf_tracer *tracer, skf_box box, int axis, int n, double *out) {
  double *part = malloc((size_t)(n * n) * sizeof *part);
  skf_status status = part ? SKF_OK : SKF_ERR_NOMEM;
  if (!part) return status;
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  skf_vec3 d = v3_sub(box.hi, box.lo);
#pragma omp parallel for schedule(dynamic, 16)
  for (int k = 0; k < n * n; k++) {
    skf_ray ray = {box.lo, {0, 0, 0}, 0, v3_get(d, axis)};
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
static skf_status check_volume(const skf_tracer *tracer, size_t count, const skf_box *boxes, double around,
                               const skf_mesh_measure *q, const distance *d, section *s) {
  double mean = 0, spread = 0;
  int grid = (int)fmax(GRID / sqrt((double)count), 12);
  for (size_t i = 0; i < count; i++) {
    double v[3], own = 0, most = 0;
    for (int k = 0; k < 3; k++) {
      skf_status e = volume_along(tracer, boxes[i], k, grid + 7 * k, v + k);
      if (e) return e;
      own += v[k] / 3;
    }
    for (int k = 0; k < 3; k++) most = fmax(most, fabs(v[k] - own));
    mean += own, spread += most;
  }
  double volume = around * q->volume, corrected = volume + around * d->volume, allowed = 2 * spread + 0.2 * d->unsure;
  bool vague = !(allowed <= 0.25 * fabs(mean)), coarse = fabs(volume - mean) > 0.25 * fabs(mean);
  section_check(s, "volume", !vague && !coarse && fabs(corrected - mean) <= allowed,
                "mesh %+.2e of the quadrature's (+-%.0e); with what lies between faces and surface %+.2e%s",
                (volume - mean) / mean, spread / mean, (corrected - mean) / mean,
                vague    ? ": too uncertain to tell"
                : coarse ? ": give a smaller --edge"
                         : "");
  section_number(s, "volume by quadrature", "L^3", mean);
  section_number(s, "error of that", "L^3", spread);
  section_number(s, "volume corrected", "L^3", corrected);
  return SKF_OK;
}

/* Triangles across a crease that is narrower than they are, or a bridge where the surface has a gap: a few are noted.
 */
static void check_faces(const skf_mesh *mesh, const distance *d, section *s) {
  static const char text[] = "%zu of %zu triangles have no surface within a quarter of their edge%s";
  static const char hint[] = ": the mesh may join or part there what is not so, a smaller --edge tells";
  if (d->astray && d->astray <= mesh->triangle_count / 200)
    section_note(s, "faces follow it", text, d->astray, mesh->triangle_count, hint);
  else
    section_check(s, "faces follow it", d->astray == 0, text, d->astray, mesh->triangle_count, d->astray ? hint : "");
  section_count(s, "triangles astray", (double)d->astray);
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
  check_faces(mesh, &d, s);
  /* First order distances are too small where the surface is curved: half again covers the meshes that resolve it. */
  double gap = 1.5 * d.inside, follow = 1.5 * d.followed;
  skf_box box = box_grow(q.box, gap + 1e-6 * size);
  skf_box *parts = NULL;
  size_t count = 0;
  if (!e) e = skf_surface_parts(b->field, b->iso, &parts, &count);
  for (size_t i = 0; i < count && !e; i++)
    parts[i] = count == 1 ? box : box_grow(parts[i], 1e-6 * box_diagonal(parts[i]));
  if (!e && check_available()) {
    comparison c = cast(b, mesh, count, parts, tracer, 2 * follow);
    e = c.status;
    section_check(s, "rays", c.differ == 0,
                  "%d cast through CGAL's tree and the field: %zu crossings agree within %.1e L, %zu rays graze, %zu "
                  "disagree",
                  RAYS, c.agree, c.worst, c.grazing, c.differ);
    section_count(s, "rays that disagree", (double)c.differ);
    section_count(s, "rays that graze", (double)c.grazing);
  }
  if (!e) e = check_volume(tracer, count, parts, made->around ? -1 : 1, &q, &d, s);
  skf_surface_parts_free(parts);
  section_number(s, "vertices off by", "L", d.vertex);
  section_number(s, "vertices off of size", "", d.vertex / size);
  section_number(s, "faces off by", "L", d.inside);
  skf_tracer_free(tracer);
  return e;
}
