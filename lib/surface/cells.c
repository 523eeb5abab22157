/* SPDX-License-Identifier: MIT */
/* Which cubes of the lattice may hold the surface: an octree, cut by enclosures of the field. */
#include "surface/mesher.h"

/* What one level of the octree needs for each of its cells. */
typedef struct level {
  size_t count;
  skf_key *cell; /* integer coordinates of the cell, in units of its size */
  signed char *keep;
  double *bound; /* of the gradient over the cell's ball */
  skf_vec3 *center;
  double *F;
} level;

static void level_free(level *v) {
  skf_free(v->cell), skf_free(v->keep), skf_free(v->bound), skf_free(v->center), skf_free(v->F);
  *v = (level){0};
}

static bool level_new(level *v, size_t capacity) {
  *v = (level){0};
  v->cell = skf_alloc(capacity, sizeof *v->cell);
  v->keep = skf_alloc(capacity, 1);
  v->bound = skf_alloc(capacity, sizeof *v->bound);
  v->center = skf_alloc(capacity, sizeof *v->center);
  v->F = skf_alloc(capacity, sizeof *v->F);
  return v->cell && v->keep && v->bound && v->center && v->F;
}

static bool outside(const skf_box *b, skf_vec3 c, double r) {
  return c.x + r < b->lo.x || c.x - r > b->hi.x || c.y + r < b->lo.y || c.y - r > b->hi.y || c.z + r < b->lo.z ||
         c.z - r > b->hi.z;
}

/* Whether F keeps away from iso in a ball: |F(c) - iso| against a bound of the gradient, which is first order tight. */
static bool steep_enough(const skf_mesher *m, double F, double gradient, double r) {
  return fabs(F - m->iso) > gradient * r * (1 + 1e-12);
}

/* Sets keep for the cells whose enclosure holds iso. The parent's bound of the gradient holds in the cell, too, and
   decides most of them for the price of one value. */
static skf_status decide(const skf_mesher *m, level *v, double size) {
  double r = 0.5 * sqrt(3) * size * (1 + 1e-12);
  size_t n = 0;
  for (size_t i = 0; i < v->count; i++) {
    int x[3];
    skf_key_get(v->cell[i], x);
    skf_vec3 c = v3(m->lattice.origin.x + size * (x[0] + 0.5), m->lattice.origin.y + size * (x[1] + 0.5),
                    m->lattice.origin.z + size * (x[2] + 0.5));
    if (outside(&m->region, c, 0.5 * size)) continue;
    v->cell[n] = v->cell[i], v->bound[n] = v->bound[i], v->center[n++] = c;
  }
  v->count = n;
  skf_status s = skf_sample(m->field, n, v->center, v->F, NULL);
  if (s) return s;
#pragma omp parallel for schedule(dynamic, 64)
  for (size_t i = 0; i < n; i++) {
    v->keep[i] = 0;
    if (steep_enough(m, v->F[i], v->bound[i], r)) continue;
    skf_bound b = skf_field_bound(m->field, v->center[i], r);
    v->bound[i] = fmin(b.gradient, v->bound[i]);
    v->keep[i] = !(b.hi < m->iso || b.lo > m->iso) && !steep_enough(m, v->F[i], v->bound[i], r);
  }
  return SKF_OK;
}

static skf_status refine(const skf_mesher *m, level *v) {
  size_t n = 0;
  for (size_t i = 0; i < v->count; i++) n += v->keep[i];
  /* A triangle takes about half of a cell that may hold the surface. */
  if (n > m->limit) return SKF_ERR_CAPACITY;
  level w;
  if (!level_new(&w, 8 * n)) return level_free(&w), SKF_ERR_NOMEM;
  for (size_t i = 0; i < v->count; i++) {
    if (!v->keep[i]) continue;
    int x[3];
    skf_key_get(v->cell[i], x);
    for (int k = 0; k < 8; k++)
      w.bound[w.count] = v->bound[i],
      w.cell[w.count++] = skf_key_of((int[3]){2 * x[0] + (k & 1), 2 * x[1] + (k >> 1 & 1), 2 * x[2] + (k >> 2)});
  }
  level_free(v);
  *v = w;
  return SKF_OK;
}

skf_status skf_mesher_cells(skf_mesher *m) {
  level v;
  if (!level_new(&v, 1)) return level_free(&v), SKF_ERR_NOMEM;
  v.count = 1, v.bound[0] = INFINITY;
  skf_status s = SKF_OK;
  for (int d = 0; d <= m->lattice.depth && !s; d++) {
    if (skf_cancelled(m->progress, 0.3 * d / m->lattice.depth)) s = SKF_ERR_CANCELLED;
    if (!s && d > 0) s = refine(m, &v);
    if (!s) s = decide(m, &v, ldexp(2 * m->lattice.half, m->lattice.depth - d));
  }
  size_t n = 0;
  for (size_t i = 0; i < v.count && !s; i++)
    if (v.keep[i]) {
      int x[3];
      skf_key_get(v.cell[i], x);
      v.cell[n++] = skf_key_of((int[3]){2 * x[0] + 1, 2 * x[1] + 1, 2 * x[2] + 1});
    }
  m->cubes = v.cell, m->cube_count = s ? 0 : n;
  v.cell = NULL;
  level_free(&v);
  return s;
}
