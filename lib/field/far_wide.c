/* SPDX-License-Identifier: MIT */
/* Sums of Gaussians that are not narrow next to the whole: smooth everywhere, so that polynomials serve all cells, also
   those with sources [Greengard & Strain 1991]. A Gaussian is a product over the coordinates: on a grid of cells of
   about its width, moments go to polynomials by a small matrix for each shift along each axis in turn.

   A cell has polynomials where they are sure to come within the accuracy: what is left out, and rounding, by bounds on
   each pair of cells, next to a lower bound of the sum of magnitudes in the cell. Elsewhere (far outside) points are
   left to far_narrow.c. */
#include "core/alloc.h"
#include "field/far_parts.h"
#include <omp.h>
#include <stdlib.h>
#include <string.h>

enum { WIDE_CELLS = 16, WIDE_MARGIN = 4, WIDE_SHIFTS = WIDE_CELLS + WIDE_MARGIN, WIDE_GRID = 24, WIDE_ORDER = 28 };
_Static_assert((int)WIDE_GRID == WIDE_CELLS + 2 * WIDE_MARGIN, "the grid has cells around the sources");

/* A cell of sources; along each axis, for each cell of the grid, the Gaussian at the smallest and the largest distance
 */
typedef struct wide_source {
  int at[3], index;
  double share;
  double nearest[3][WIDE_GRID], farthest[3][WIDE_GRID];
} wide_source;

typedef struct wide_cell {
  double least, most, far; /* sum of magnitudes, as shares of the whole's; the largest distance from a source */
} wide_cell;

typedef struct wide {
  skf_far *far;
  const skf_prepared *elements;
  double accuracy, s, side, per;
  int cells, level;
  wide_source *source;
  wide_cell *cell;
  size_t sources, all;
  double size[WIDE_SHIFTS][FAR_NODES]; /* of the coefficients whose larger degree is [m] */
  double F[WIDE_SHIFTS][WIDE_SHIFTS][WIDE_SHIFTS], g[WIDE_SHIFTS][WIDE_SHIFTS][WIDE_SHIFTS]; /* what is left out */
  far_matrix along[2 * WIDE_SHIFTS - 1]; /* of sources at shift - (WIDE_SHIFTS - 1) */
  double *moments;
  int slot[WIDE_CELLS][WIDE_CELLS][WIDE_CELLS]; /* of moments at [x][y][z], -1: no sources */
} wide;

/* Cells are at most that much of a Gaussian's width: the smaller, the less do values differ in one. */
static double finest(double s, double accuracy) { return (accuracy < 1e-9 ? 0.5 : 1) / s; }

double skf_far_wide_side(const skf_prepared *e, size_t n, double accuracy) {
  skf_box b = box_empty();
  for (size_t i = 0; i < n; i++) b = box_join(b, skf_primitive_bounds(&e[i].primitive));
  skf_vec3 d = v3_sub(b.hi, b.lo);
  double side = finest(e->kernel.param, accuracy);
  return fmax(d.x, fmax(d.y, d.z)) <= 0.999 * WIDE_CELLS * side ? side : INFINITY;
}

static int width_of(const wide *w) { return w->cells + 2 * WIDE_MARGIN; }

static double gaussian(const wide *w, double d) { return exp(-(w->s * d) * (w->s * d)); }

static void set_source(wide *w, size_t k, double whole) {
  const far_source *s = w->far->tree.source + k;
  const skf_box *b = &w->far->narrow[k].box;
  wide_source *out = w->source + w->sources;
  out->index = (int)k, out->share = exp(w->far->narrow[k].weight - whole);
  for (int axis = 0; axis < 3; axis++) {
    out->at[axis] = s->at[axis] - w->cells;
    double from = v3_get(b->lo, axis), to = v3_get(b->hi, axis);
    for (int x = 0; x < width_of(w); x++) {
      double lo = v3_get(w->far->tree.lo, axis) + (x - WIDE_MARGIN) * w->side, hi = lo + w->side;
      out->nearest[axis][x] = gaussian(w, fmax(0, fmax(from - hi, lo - to)));
      out->farthest[axis][x] = gaussian(w, fmax(to - lo, hi - from));
    }
  }
  w->slot[out->at[0]][out->at[1]][out->at[2]] = (int)w->sources++;
}

static void set_cell(wide *w, size_t i) {
  size_t n = (size_t)width_of(w), x = i % n, y = i / n % n, z = i / n / n, at[3] = {x, y, z};
  const skf_box *b = &w->far->narrow[0].box;
  wide_cell *c = w->cell + i;
  double far[3];
  *c = (wide_cell){0, 0, 0};
  for (size_t k = 0; k < w->sources; k++) {
    const wide_source *s = w->source + k;
    c->least += s->share * s->farthest[0][x] * s->farthest[1][y] * s->farthest[2][z];
    c->most += s->share * s->nearest[0][x] * s->nearest[1][y] * s->nearest[2][z];
  }
  for (int k = 0; k < 3; k++) {
    double lo = v3_get(w->far->tree.lo, k) + ((double)at[k] - WIDE_MARGIN) * w->side;
    far[k] = fmax(lo + w->side - v3_get(b->lo, k), v3_get(b->hi, k) - lo);
  }
  c->far = sqrt(far[0] * far[0] + far[1] * far[1] + far[2] * far[2]);
}

/* Coefficients for each shift, and their sizes; those of the noise of a cell's largest value are rounding. */
static void set_shifts(wide *w) {
  double t = w->s * w->side * (w->s * w->side), c[FAR_NODES][FAR_NODES];
  for (int a = 0; a < w->cells + WIDE_MARGIN; a++) {
    double gap = a > 1 ? a - 1 : 0, noise = 1e-15 * exp(-t * gap * gap);
    skf_far_gaussian(t, a, c);
    memset(w->size[a], 0, sizeof w->size[a]);
    for (int i = 0; i < FAR_NODES; i++)
      for (int j = 0; j < FAR_NODES; j++) {
        if (fabs(c[j][i]) > noise) w->size[a][i > j ? i : j] += fabs(c[j][i]);
        if (i >= FAR_ORDER || j >= FAR_ORDER) continue;
        w->along[WIDE_SHIFTS - 1 + a].m[i][j] = c[j][i];
        w->along[WIDE_SHIFTS - 1 - a].m[i][j] = (i + j) % 2 ? -c[j][i] : c[j][i];
      }
  }
}

/* What is lost with total degrees < n on the way from moments to polynomials, when after each axis all others are left
   out: in each product that is lost the larger degrees along the axes add up to n at least. Derivatives of T_m are at
   most m / sqrt(1 - x^2). */
static void set_losses(wide *w, int n) {
  const double slope = w->per / sqrt(1 - 1 / (FAR_WIDE * FAR_WIDE));
  int shifts = w->cells + WIDE_MARGIN;
  for (int a = 0; a < shifts; a++)
    for (int b = 0; b < shifts; b++) {
      double two[2 * FAR_NODES] = {0};
      for (int i = 0; i < FAR_NODES; i++)
        for (int j = 0; j < FAR_NODES; j++) two[i + j] += w->size[a][i] * w->size[b][j];
      for (int c = 0; c < shifts; c++) {
        double F = 0, g = 0, tail = 0, high = 0; /* tail: of c from `from` on */
        int from = FAR_NODES;
        for (int m = 0; m < 2 * FAR_NODES; m++) {
          for (; from > 0 && from > n - m; from--)
            if (from <= FAR_NODES) tail += w->size[c][from - 1], high += (from - 1) * w->size[c][from - 1];
          F += two[m] * tail, g += two[m] * (m * tail + high);
        }
        w->F[a][b][c] = F, w->g[a][b][c] = slope * g;
      }
    }
}

/* Whether the cell's polynomials are within the accuracy; `rounding`: of that alone. */
static bool is_good(const wide *w, size_t i, bool rounding) {
  const wide_cell *c = w->cell + i;
  const double most = 0.3 * w->accuracy * c->least, noise = 1e-15 * c->most;
  if (!(noise <= most && 2 * w->per * noise <= most / c->far)) return false;
  if (rounding) return true;
  int n = width_of(w), at[3] = {(int)i % n, (int)i / n % n, (int)i / n / n};
  double F = 0, g = 0;
  for (size_t k = 0; k < w->sources; k++) {
    const wide_source *s = w->source + k;
    int d[3];
    for (int axis = 0; axis < 3; axis++) d[axis] = abs(at[axis] - WIDE_MARGIN - s->at[axis]);
    F += s->share * w->F[d[0]][d[1]][d[2]], g += s->share * w->g[d[0]][d[1]][d[2]];
  }
  return F <= most && g <= most / c->far;
}

/* Marks the cells that are good with total degrees < n; how many of those that might be are not. */
static size_t mark(wide *w, int n, unsigned char *good) {
  size_t left = 0;
  set_losses(w, n);
#pragma omp parallel for schedule(dynamic, 16) reduction(+ : left)
  for (size_t i = 0; i < w->all; i++) {
    good[i] = is_good(w, i, false);
    left += !good[i] && is_good(w, i, true);
  }
  return left;
}

/* The smallest order that serves all cells it can serve. */
static int choose(wide *w, unsigned char *good) {
  int none = 1, n = WIDE_ORDER;
  while (n - none > 1) {
    int middle = (none + n) / 2;
    if (mark(w, middle, good))
      none = middle;
    else
      n = middle;
  }
  return mark(w, n, good), n;
}

/* How much of the whole is in good cells */
static double served(const wide *w, const unsigned char *good) {
  size_t n = (size_t)width_of(w);
  double sum = 0;
  for (size_t k = 0; k < w->sources; k++) {
    const int *at = w->source[k].at;
    size_t x = (size_t)(at[0] + WIDE_MARGIN), y = (size_t)(at[1] + WIDE_MARGIN), z = (size_t)(at[2] + WIDE_MARGIN);
    if (good[x + n * (y + n * z)]) sum += w->source[k].share;
  }
  return sum;
}

static skf_status collect(wide *w) {
  skf_far *f = w->far;
  double least = INFINITY, far = 0;
  for (size_t i = 0; i < w->all; i++)
    if (f->wide.leaf[i]) least = fmin(least, w->cell[i].least), far = fmax(far, w->cell[i].far);
  double accuracy = 1e-3 * w->accuracy * least / fmax(1, w->s * far);
  if (!(w->moments = skf_alloc(w->sources * f->layout.size, sizeof(double)))) return SKF_ERR_NOMEM;
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t k = 0; k < w->sources; k++) {
    const far_source *s = f->tree.source + w->source[k].index;
    /* an integrand is at most exp((s gap)^2) as far from the real axis */
    skf_far_moments(f->ops, &f->layout, NULL, f->tree.pieces.at + s->first, s->count, w->elements,
                    far_center(&f->tree, s->level, s->at), w->per, 1.5 / w->s, accuracy,
                    w->moments + k * f->layout.size);
  }
  return SKF_OK;
}

/* Tensors along a line go to one cell of it. */
static bool along(const wide *w, int axis, const double *const line[WIDE_CELLS], int target, double *out) {
  const far_layout *l = &w->far->layout;
  bool any = false;
  for (int k = 0; k < w->cells; k++) {
    if (!line[k]) continue;
    if (!any) memset(out, 0, l->size * sizeof *out);
    any = true;
    w->far->ops->along[axis][FAR_ONE](l, l->order, w->along + WIDE_SHIFTS - 1 + k - (target - WIDE_MARGIN), line[k],
                                      NULL, out);
  }
  return any;
}

/* All cells of the grid at one x; room: for (cells + width) * cells tensors. */
static void plane(const wide *w, int x, double *room) {
  const size_t size = w->far->layout.size, K = (size_t)w->cells, n = (size_t)width_of(w);
  const double *after_x[WIDE_CELLS][WIDE_CELLS], *after_y[WIDE_GRID][WIDE_CELLS]; /* [z][y], [y][z] */
  const double *line[WIDE_CELLS];
  for (size_t z = 0; z < K; z++)
    for (size_t y = 0; y < K; y++) {
      double *out = room + (z * K + y) * size;
      for (size_t k = 0; k < K; k++)
        line[k] = w->slot[k][y][z] < 0 ? NULL : w->moments + (size_t)w->slot[k][y][z] * size;
      after_x[z][y] = along(w, 0, line, x, out) ? out : NULL;
    }
  for (size_t y = 0; y < n; y++)
    for (size_t z = 0; z < K; z++) {
      double *out = room + (K * K + y * K + z) * size;
      after_y[y][z] = along(w, 1, after_x[z], (int)y, out) ? out : NULL;
    }
  for (size_t z = 0; z < n; z++)
    for (size_t y = 0; y < n; y++) {
      unsigned slot = w->far->wide.leaf[(size_t)x + n * (y + n * z)];
      if (slot) along(w, 2, after_y[y], (int)z, w->far->tensors + (slot - 1) * size);
    }
}

static skf_status spread(wide *w) {
  skf_far *f = w->far;
  size_t each = (size_t)(w->cells + width_of(w)) * (size_t)w->cells * f->layout.size;
  double *room = skf_alloc((size_t)omp_get_max_threads() * each, sizeof *room);
  if (!room) return SKF_ERR_NOMEM;
#pragma omp parallel for schedule(dynamic, 1)
  for (int x = 0; x < width_of(w); x++) plane(w, x, room + (size_t)omp_get_thread_num() * each);
  skf_free(room);
  return SKF_OK;
}

static skf_status prepare(wide *w) {
  const far_tree *t = &w->far->tree;
  size_t n = (size_t)width_of(w);
  w->side = far_side(t, w->level), w->per = 2 / (FAR_WIDE * w->side), w->all = n * n * n;
  memset(w->slot, -1, sizeof w->slot);
  size_t first = t->source_level[w->level], end = t->source_level[w->level + 1];
  w->source = skf_alloc(end - first, sizeof *w->source);
  w->cell = skf_alloc(w->all, sizeof *w->cell);
  w->far->wide.leaf = skf_alloc(w->all, sizeof(unsigned));
  if (!w->source || !w->cell || !w->far->wide.leaf) return SKF_ERR_NOMEM;
  for (size_t k = first; k < end; k++) set_source(w, k, w->far->narrow[0].weight);
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < w->all; i++) set_cell(w, i);
  set_shifts(w);
  return SKF_OK;
}

static skf_status make(wide *w, size_t most) {
  skf_far *f = w->far;
  skf_status s = prepare(w);
  if (s) return s;
  unsigned char *good = skf_alloc(w->all, 1);
  if (!good) return SKF_ERR_NOMEM;
  f->layout = far_layout_new(choose(w, good));
  bool pays = served(w, good) > 0.99;
  for (size_t i = 0; i < w->all; i++)
    if (good[i]) f->wide.leaf[i] = (unsigned)++f->wide.count;
  skf_free(good);
  if (!pays || f->wide.count * f->layout.size > most / sizeof(double)) return SKF_ERR_UNSUPPORTED;
  if (!(f->tensors = skf_alloc(f->wide.count * f->layout.size, sizeof(double)))) return SKF_ERR_NOMEM;
  f->wide.side = w->side, f->wide.width = width_of(w);
  f->wide.lo = v3_sub(f->tree.lo, v3_scale(WIDE_MARGIN * w->side, v3(1, 1, 1)));
  s = collect(w);
  return s ? s : spread(w);
}

skf_status skf_far_wide(skf_far *f, const skf_prepared *elements, double accuracy, size_t most) {
  double s = elements->kernel.param, side = finest(s, accuracy);
  int level = 0;
  while (far_side(&f->tree, level) > side && level < f->tree.levels) level++;
  if (level >= f->tree.levels || 1 << level > WIDE_CELLS) return SKF_ERR_UNSUPPORTED;
  wide *w = skf_alloc(1, sizeof *w);
  if (!w) return SKF_ERR_NOMEM;
  w->far = f, w->elements = elements, w->accuracy = accuracy, w->s = s, w->level = level, w->cells = 1 << level;
  skf_status status = make(w, most);
  skf_free(w->source), skf_free(w->cell), skf_free(w->moments), skf_free(w);
  if (status) skf_free(f->wide.leaf), skf_free(f->tensors), f->tensors = NULL, f->wide = (far_grid){.width = 0};
  return status;
}
