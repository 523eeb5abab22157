/* SPDX-License-Identifier: MIT */
/* Homogeneous solids: how they are made, weighed, shared, and their row in the registry. */
#include "skeleton/solid.h"
#include "skeleton/shape.h"
#include "core/alloc.h"
#include "core/sum.h"

static const int axes[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};

/* Signed tetrahedra from the middle of the box: of one with corners 0, a, b, c and d = det(a, b, c), the volume is
   d / 6, int x dV = d (a + b + c) / 24, int x x' dV = d (s s' + a a' + b b' + c c') / 120, s = a + b + c. */
void skf_solid_weigh(const skf_solid_mesh *m, skf_solid_info *out) {
  skf_sum area = {0, 0}, volume = {0, 0}, first[3] = {{0, 0}}, second[6] = {{0, 0}};
  out->bounds = box_empty();
  for (size_t i = 0; i < m->nv; i++) out->bounds = box_add(out->bounds, m->v[i]);
  skf_vec3 o = box_center(out->bounds);
  for (size_t i = 0; i < m->nf; i++) {
    skf_vec3 a[4];
    for (int k = 0; k < 3; k++) a[k] = v3_sub(m->v[m->f[i][k]], o);
    a[3] = v3_add(a[0], v3_add(a[1], a[2]));
    double d = v3_dot(a[0], v3_cross(a[1], a[2]));
    sum_add(&area, 0.5 * v3_norm(v3_cross(v3_sub(a[1], a[0]), v3_sub(a[2], a[0]))));
    sum_add(&volume, d / 6);
    for (int k = 0; k < 3; k++) sum_add(first + k, d * v3_get(a[3], k) / 24);
    for (int k = 0; k < 6; k++) {
      double s = 0;
      for (int j = 0; j < 4; j++) s += v3_get(a[j], axes[k][0]) * v3_get(a[j], axes[k][1]);
      sum_add(second + k, d * s / 120);
    }
  }
  double V = sum_total(volume), moment[6];
  skf_vec3 c = v3(sum_total(first[0]) / V, sum_total(first[1]) / V, sum_total(first[2]) / V);
  for (int k = 0; k < 6; k++) moment[k] = sum_total(second[k]) - V * v3_get(c, axes[k][0]) * v3_get(c, axes[k][1]);
  double trace = moment[0] + moment[3] + moment[5];
  for (int k = 0; k < 6; k++) out->inertia[k] = (axes[k][0] == axes[k][1] ? trace : 0) - moment[k];
  out->area = sum_total(area), out->volume = V, out->center = v3_add(o, c);
}

/* Everything after the mesh is clean. */
static skf_status assemble(skf_solid *s, skf_solid_mesh *m, skf_error *e) {
  skf_solid_pair *pairs = NULL;
  size_t count = 0;
  skf_status status = skf_solid_tree(m, &s->nodes);
  if (!status) status = skf_solid_pairs(m, &pairs, &count, e);
  if (!status) status = skf_solid_components(m, pairs, count, &s->info.components, e);
  s->vertices = m->v, s->faces = m->f;
  s->vertex_count = m->nv, s->face_count = m->nf;
  if (!status) {
    s->info.vertices = m->nv, s->info.faces = m->nf, s->info.edges = count;
    s->info.joined = m->joined, s->info.unused = m->unused, s->info.dropped = m->dropped;
    skf_solid_weigh(m, &s->info);
    for (size_t i = 0; i < m->nv; i++) s->radius = fmax(s->radius, v3_dist(m->v[i], s->info.center));
    status = skf_solid_cut(s, pairs, count);
  }
  skf_free(pairs);
  if (!status) status = skf_solid_expand(s);
  return status;
}

skf_status skf_solid_new(const skf_vec3 *vertices, size_t vertex_count, const unsigned (*faces)[3], size_t face_count,
                         skf_solid **out, skf_error *error) {
  skf_solid_mesh m;
  *out = NULL;
  if (error) *error = (skf_error){0};
  skf_status status = skf_solid_clean(vertices, vertex_count, faces, face_count, &m, error);
  if (status) return status;
  skf_solid *s = skf_alloc(1, sizeof *s);
  if (!s) return skf_solid_mesh_free(&m), skf_solid_refuse(error, SKF_ERR_NOMEM, "out of memory");
  atomic_init(&s->shares, 1);
  status = assemble(s, &m, error);
  if (status == SKF_ERR_NOMEM) skf_solid_refuse(error, status, "out of memory");
  if (status) return skf_solid_free(s), status;
  return *out = s, SKF_OK;
}

const skf_solid *skf_solid_share(const skf_solid *s) {
  if (s) atomic_fetch_add(&((skf_solid *)(size_t)s)->shares, 1);
  return s;
}

void skf_solid_free(const skf_solid *shared) {
  skf_solid *s = (skf_solid *)(size_t)shared; /* the count is the only thing that ever changes */
  if (!s || atomic_fetch_sub(&s->shares, 1) > 1) return;
  skf_free(s->vertices), skf_free(s->faces), skf_free(s->sharp), skf_free(s->nodes), skf_free(s->blocks);
  skf_free(s->columns), skf_free(s->numbers), skf_free(s->moments);
  skf_free(s);
}

const skf_solid_info *skf_solid_get(const skf_solid *s) { return &s->info; }
const skf_vec3 *skf_solid_vertices(const skf_solid *s) { return s->vertices; }
const unsigned *skf_solid_faces(const skf_solid *s) { return s->faces[0]; }

static const char *degenerate(const skf_primitive *p) { return p->solid ? NULL : "solid without a mesh"; }
static double measure(const skf_primitive *p) { return p->solid->info.volume; }
static double distance(const skf_primitive *p, skf_vec3 x) {
  return skf_solid_contains(p->solid, x) ? 0 : skf_solid_to_surface(p->solid, x);
}
static double distance_max(const skf_primitive *p, skf_vec3 x) { return skf_solid_distance_max(p->solid, x); }
static skf_box bounds(const skf_primitive *p) { return p->solid->info.bounds; }

/* Somewhere on the face that s names, t along the line from a corner to the middle of the opposite side. */
static skf_vec3 at(const skf_primitive *p, double s, double t) {
  const skf_solid *o = p->solid;
  size_t i = (size_t)fmin(s * (double)o->face_count, (double)o->face_count - 1);
  const unsigned *f = o->faces[i];
  skf_vec3 a = o->vertices[f[0]], mid = v3_scale(0.5, v3_add(o->vertices[f[1]], o->vertices[f[2]]));
  return v3_mad(a, t, v3_sub(mid, a));
}

static const skf_param params[] = {
    {"file", NULL, "closed mesh, outward: PLY, OBJ, OFF or STL, relative to the scene's folder", SKF_PARAM_SOLID, 1,
     offsetof(skf_primitive, solid), 0, 0},
};

const skf_shape_ops skf_shape_solid = {
    {"solid", "homogeneous inside of a closed mesh, for the inverse kernel alone; its measure is volume", "L^3", params,
     1},
    degenerate,
    measure,
    distance,
    distance_max,
    bounds,
    at};
