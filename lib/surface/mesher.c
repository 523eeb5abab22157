/* SPDX-License-Identifier: MIT */
/* The mesher: from a field to an improved mesh on its isosurface. */
#include "surface/mesher.h"
#include <stdlib.h>
#include <string.h>

void skf_mesher_free(skf_mesher *m) {
  skf_free(m->cubes), skf_free(m->tets), skf_free(m->cuts), skf_free(m->cut_at), skf_free(m->cut_of);
  skf_nodes_free(&m->nodes);
}

/* Whether a place that the surface encloses is near a lattice node that it encloses, too. */
static bool is_seen(const skf_mesher *m, skf_vec3 p) {
  const skf_lattice *l = &m->lattice;
  int inside = m->around ? -1 : 1;
  int c[3], d[14][3];
  for (int i = 0; i < 3; i++) c[i] = 2 * (int)floor((v3_get(p, i) - v3_get(l->origin, i)) / (2 * l->half)) + 1;
  unsigned center = skf_nodes_find(&m->nodes, skf_key_of(c));
  if (center >= m->cube_count) return true; /* proved to be so as a whole */
  if (m->nodes.sign[center] == inside) return true;
  for (int k = 0; k < 14; k++) {
    for (int i = 0; i < 3; i++) d[k][i] = c[i] + skf_star[k][i];
    unsigned w = skf_nodes_find(&m->nodes, skf_key_of(d[k]));
    if (w == SKF_NONE || m->nodes.sign[w] == inside) return true;
  }
  return false;
}

static bool holds(const skf_box *b, skf_vec3 p) {
  return p.x >= b->lo.x && p.x <= b->hi.x && p.y >= b->lo.y && p.y <= b->hi.y && p.z >= b->lo.z && p.z <= b->hi.z;
}

enum { SEEDS = 4096 }; /* per primitive: along a segment of this many cells every cell is tried */

/* Counts the places of the skeleton in the region that the surface encloses without a lattice node near by that it
   does. */
static skf_status count_missed(const skf_mesher *m, size_t *missed) {
  skf_vec3 *p = skf_alloc(SEEDS, sizeof *p);
  double *F = skf_alloc(SEEDS, sizeof *F);
  skf_status s = p && F ? SKF_OK : SKF_ERR_NOMEM;
  *missed = 0;
  for (size_t i = 0; i < skf_field_size(m->field) && !s; i++) {
    const skf_primitive *e = &skf_field_element(m->field, i)->primitive;
    double side = 2 * m->lattice.half, span = skf_primitive_measure(e) / side;
    int nt = e->shape == SKF_TRIANGLE ? (int)fmin(64, 2 + box_diagonal(skf_primitive_bounds(e)) / side) : 1;
    int ns = e->shape == SKF_POINT ? 1 : nt > 1 ? nt : (int)fmin(SEEDS, 2 + span);
    for (int a = 0; a < ns; a++)
      for (int b = 0; b < nt; b++) p[a * nt + b] = skf_primitive_point(e, (a + 0.5) / ns, (b + 0.5) / nt);
    s = skf_sample(m->field, (size_t)ns * nt, p, F, NULL);
    for (int a = 0; a < ns * nt && !s; a++)
      *missed += (m->around ? F[a] < m->iso : F[a] > m->iso) && holds(&m->region, p[a]) && !is_seen(m, p[a]);
  }
  skf_free(p), skf_free(F);
  return s;
}

/* One mesh at one edge length, not yet improved. */
static skf_status at_edge(skf_mesher *m, double edge, skf_mesh *out, skf_mesh_report *r) {
  m->cube_count = m->tet_count = m->cut_count = m->clamped = 0;
  skf_status s = skf_lattice_set(&m->lattice, m->region, edge);
  if (!s) s = skf_mesher_cells(m);
  if (!s) s = skf_mesher_cuts(m);
  if (!s) s = skf_mesher_warp(m);
  if (!s) s = skf_mesher_extract(m, out);
  if (!s) s = count_missed(m, &r->missed);
  r->edge = edge, r->cells = m->cube_count, r->samples = m->nodes.count, r->clamped = m->clamped;
  skf_mesher_free(m);
  m->cubes = NULL, m->tets = NULL, m->cuts = NULL, m->cut_at = NULL, m->cut_of = NULL;
  if (s) skf_mesh_free(out);
  return s;
}

/* Normals, and the worst distance from the surface to first order. */
static skf_status finish(const skf_field *field, double iso, skf_mesh *mesh, double *residual) {
  size_t n = mesh->vertex_count;
  double *F = skf_alloc(n, sizeof *F);
  mesh->normals = skf_alloc(n, sizeof *mesh->normals);
  skf_status s = F && mesh->normals ? skf_sample(field, n, mesh->vertices, F, mesh->normals) : SKF_ERR_NOMEM;
  *residual = 0;
  for (size_t i = 0; i < n && !s; i++) {
    skf_vec3 g = mesh->normals[i];
    double slope = v3_norm(g), f = fabs(F[i] - iso);
    if (f > 0) *residual = fmax(*residual, f / slope);
    mesh->normals[i] = v3_unit(v3_scale(-1, g));
  }
  skf_free(F);
  return s;
}

static int up(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* The curvature that nineteen of twenty edges do not exceed, from the turn of the normals along them [1/L]. */
static skf_status curvature(const skf_mesh *m, double *out) {
  size_t n = 3 * m->triangle_count;
  double *k = skf_alloc(n, sizeof *k);
  if (!k) return SKF_ERR_NOMEM;
  for (size_t s = 0; s < n; s++) {
    unsigned a = m->triangles[s / 3][s % 3], b = m->triangles[s / 3][(s + 1) % 3];
    double length = v3_dist(m->vertices[a], m->vertices[b]);
    k[s] = length > 0 ? v3_dist(m->normals[a], m->normals[b]) / length : 0;
  }
  qsort(k, n, sizeof *k, up);
  *out = n ? k[n - 1 - n / 20] : 0;
  skf_free(k);
  return SKF_OK;
}

/* The default edge: a hundredth of the part's diagonal times `share`, the root of the number of parts, so that many
   take together what one does; less where it is curved more, so that an edge turns by at most 0.35 rad; not below a six
   hundredth. Found by meshing coarsely. */
static skf_status choose_edge(skf_mesher *m, double share, double *edge) {
  double d = box_diagonal(m->region), e = d / 48 * fmin(share, 2);
  for (int k = 0; k < 7; k++) {
    skf_mesh coarse;
    skf_mesh_report r;
    skf_status s = at_edge(m, e, &coarse, &r);
    if (s) return s;
    double turn = 0, residual, size = 0;
    if (coarse.triangle_count) {
      skf_box b = box_empty();
      for (size_t i = 0; i < coarse.vertex_count; i++) b = box_add(b, coarse.vertices[i]);
      size = box_diagonal(b);
      s = finish(m->field, m->iso, &coarse, &residual);
      if (!s) s = curvature(&coarse, &turn);
    }
    bool any = coarse.triangle_count > 0;
    skf_mesh_free(&coarse);
    if (s) return s;
    if (any && !r.missed) {
      double best = fmax(fmin(share * size / 100, 0.35 / turn), size / 600);
      *edge = best;
      if (best > 0.3 * e) return SKF_OK;
      e = fmax(best, 0.3 * e);
    } else
      *edge = e = 0.5 * e;
    if (e < d / 3000) break;
  }
  return SKF_OK;
}

static skf_status copy_mesh(const skf_mesh *from, skf_mesh *to) {
  *to = (skf_mesh){from->vertex_count,
                   from->triangle_count,
                   skf_alloc(from->vertex_count, sizeof *to->vertices),
                   NULL,
                   skf_alloc(from->triangle_count, sizeof *to->triangles),
                   NULL};
  if (!to->vertices || !to->triangles) return skf_mesh_free(to), SKF_ERR_NOMEM;
  memcpy(to->vertices, from->vertices, from->vertex_count * sizeof *to->vertices);
  memcpy(to->triangles, from->triangles, from->triangle_count * sizeof *to->triangles);
  return SKF_OK;
}

/* Locks the vertices of bad triangles and everything within two triangles of them; false when all were locked. */
static bool lock_around(const skf_mesh *mesh, const signed char *bad, signed char *locked) {
  bool more = false;
  for (size_t t = 0; t < mesh->triangle_count; t++)
    for (int k = 0; k < 3 && bad[t]; k++) {
      signed char *l = locked + mesh->triangles[t][k];
      more |= !*l, *l = 3;
    }
  for (signed char ring = 3; ring > 1 && more; ring--)
    for (size_t t = 0; t < mesh->triangle_count; t++) {
      const unsigned *v = mesh->triangles[t];
      if (locked[v[0]] >= ring || locked[v[1]] >= ring || locked[v[2]] >= ring)
        for (int k = 0; k < 3; k++)
          if (locked[v[k]] < ring - 1) locked[v[k]] = (signed char)(ring - 1);
    }
  return more;
}

/* Improves the mesh, and takes back what made it cross itself: the mesh before is free of that by construction. */
static skf_status improve(const skf_mesher *m, double edge, int rounds, skf_mesh *mesh) {
  signed char *locked = skf_alloc(mesh->vertex_count, 1), *bad = skf_alloc(mesh->triangle_count, 1);
  skf_status s = locked && bad ? SKF_OK : SKF_ERR_NOMEM;
  bool done = false;
  for (int attempt = 0; attempt < 6 && !s && !done; attempt++) {
    skf_mesh trial;
    size_t crossings = 0;
    if (skf_cancelled(m->progress, 0.5 + 0.08 * attempt)) s = SKF_ERR_CANCELLED;
    if (!s) s = copy_mesh(mesh, &trial);
    if (s) break;
    s = skf_mesh_improve(&trial, m->field, m->iso, edge, rounds, locked);
    if (!s) s = skf_mesh_crossings(&trial, bad, &crossings);
    done = !s && (!crossings || !lock_around(&trial, bad, locked));
    if (done) {
      skf_mesh_free(mesh);
      *mesh = trial;
    } else
      skf_mesh_free(&trial);
  }
  skf_free(locked), skf_free(bad);
  return s;
}

/* One part: the surface in m->region. `share`: see choose_edge. */
static skf_status one_part(skf_mesher *m, const skf_mesh_options *o, double share, skf_mesh *out, skf_mesh_report *r) {
  skf_status s = SKF_OK;
  double edge = o->edge;
  *out = (skf_mesh){0}, *r = (skf_mesh_report){0};
  if (edge == 0) s = choose_edge(m, share, &edge);
  for (int k = 0; !s; k++) {
    s = at_edge(m, edge, out, r);
    /* The edge is ours to choose: halve it until nothing is missed. */
    if (s || o->edge != 0 || (out->triangle_count && !r->missed) || k == 3) break;
    skf_mesh_free(out);
    edge *= 0.5;
  }
  if (!s && out->triangle_count > m->limit) s = SKF_ERR_CAPACITY;
  if (!s && out->triangle_count && o->rounds >= 0) s = improve(m, edge, o->rounds ? o->rounds : 3, out);
  if (s) skf_mesh_free(out);
  return s;
}

static skf_status all_parts(skf_mesher *m, const skf_mesh_options *o, const skf_box *boxes, size_t count, skf_mesh *out,
                            skf_mesh_report *r) {
  skf_status s = SKF_OK;
  r->edge = INFINITY, r->parts = count, r->around = m->around;
  size_t limit = m->limit;
  for (size_t i = 0; i < count && !s; i++) {
    skf_mesh part;
    skf_mesh_report q;
    m->region = boxes[i], m->limit = limit - out->triangle_count;
    s = one_part(m, o, fmin(sqrt((double)count), 8), &part, &q);
    r->edge = fmin(r->edge, q.edge), r->cells += q.cells, r->samples += q.samples;
    r->missed += q.missed, r->clamped += q.clamped;
    if (s) break;
    if (count == 1) return *out = part, SKF_OK;
    s = skf_mesh_append(out, &part, 0);
    skf_mesh_free(&part);
  }
  if (!(r->edge < INFINITY)) r->edge = 0;
  skf_free(out->bodies); /* there is but one */
  out->bodies = NULL;
  return s;
}

/* The whole region where the edge is given and one lattice reaches; else its parts. */
static skf_status list_parts(const skf_mesher *m, double edge, skf_box **boxes, size_t *count) {
  skf_lattice all;
  if (edge == 0 || skf_lattice_set(&all, m->region, edge)) return skf_mesher_parts(m, edge, boxes, count);
  *count = 1, *boxes = skf_alloc(1, sizeof **boxes);
  if (*boxes) **boxes = m->region;
  return *boxes ? SKF_OK : SKF_ERR_NOMEM;
}

skf_status skf_mesh_field(const skf_field *field, double iso, const skf_mesh_options *options, skf_mesh *out,
                          skf_mesh_report *report) {
  static const skf_mesh_options defaults = {0};
  const skf_mesh_options *o = options ? options : &defaults;
  skf_mesh_report scratch, *r = report ? report : &scratch;
  skf_mesher m = {.field = field, .iso = iso, .progress = &o->progress};
  skf_box *boxes = NULL;
  size_t count = 0;
  *out = (skf_mesh){0}, *r = (skf_mesh_report){0};
  m.limit = o->max_triangles ? o->max_triangles : 20000000;
  if (o->edge != 0 && !(o->edge > 0 && isfinite(o->edge))) return SKF_ERR_RANGE;
  skf_status s = skf_surface_region(field, iso, &m.region, &m.around);
  if (!s) s = list_parts(&m, o->edge, &boxes, &count);
  if (!s) s = all_parts(&m, o, boxes, count, out, r);
  skf_free(boxes);
  if (!s && out->triangle_count == 0) s = SKF_ERR_EMPTY;
  if (!s) s = finish(field, iso, out, &r->residual);
  if (!s && skf_cancelled(&o->progress, 1)) s = SKF_ERR_CANCELLED;
  if (s) skf_mesh_free(out);
  return s;
}
