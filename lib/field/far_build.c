/* SPDX-License-Identifier: MIT */
/* Makes the hierarchy of a large sum: the tree, its expansions, and which batches of sources each leaf sums. */
#include "core/alloc.h"
#include "field/far_parts.h"
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* How many pieces a leaf may have around it: about what its expansion costs to make; for Gaussians, leaves a good deal
   smaller than what reaches them. */
static size_t around(skf_kernel_type type, double accuracy) {
  double digits = -log10(accuracy);
  return type == SKF_GAUSSIAN ? 600 : (size_t)fmax(600, (type == SKF_INVERSE ? 37 : 55) * digits * digits);
}

static size_t most_bytes(size_t n) { return (size_t)(0x1p28 + 0x1p10 * (double)n); }

/* Cells of targets: at most 256 MiB and 1 KiB for each element; of Gaussians, that have no tensors, as many as there
   are. */
static size_t most_targets(skf_kernel_type type, size_t n, double accuracy) {
  double digits = -log10(accuracy), order = 4 + 3 * digits;
  double tensor =
      type == SKF_INVERSE ? 8 * pow(4.5 * digits + 2, 2) : 8 * (order * order * order / 6 + 2 * order * order);
  return type == SKF_GAUSSIAN ? n + 4096 : (size_t)((0x1p28 + 0x1p10 * (double)n) / tensor);
}

/* Without harmonics: Chebyshev points in the cube of the whole, with weights that have its moments: as many along each
   axis as give the total degree's accuracy. */
static int outer_points(const far_layout *l) { return (4 * l->order + 4) / 5; }

static void outer(skf_far *f, const skf_prepared *like, const double *whole, skf_prepared *out) {
  int n = outer_points(&f->layout);
  double T[FAR_ORDER][FAR_ORDER], h = 0.5 * FAR_WIDE * f->tree.side;
  const int middle[3] = {1, 1, 1};
  skf_vec3 c = far_center(&f->tree, 0, middle);
  double x[FAR_ORDER];
  for (int k = 0; k < n; k++) {
    x[k] = cos(SKF_PI * (k + 0.5) / n);
    far_chebyshev(x[k], n, T[k]);
    for (int i = 0; i < n; i++) T[k][i] *= (i ? 2.0 : 1.0) / n;
  }
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++)
      for (int k = 0; k < n; k++) {
        skf_element e = {.primitive = {.shape = SKF_POINT}, .kernel = like->kernel};
        e.primitive.point.at = v3(c.x + h * x[i], c.y + h * x[j], c.z + h * x[k]);
        for (int p = 0; p < n; p++)
          for (int q = 0; q < n && p + q < f->layout.order; q++) {
            const double *row = whole + f->layout.row[p][q];
            int end = f->layout.order - p - q < n ? f->layout.order - p - q : n;
            double s = 0;
            for (int r = 0; r < end; r++) s += row[r] * T[k][r];
            e.strength += s * T[i][p] * T[j][q];
          }
        skf_prepare(&e, out++);
      }
}

/* The fields outside, per side of the cube. */
static skf_status outer_harmonics(skf_far *f, const double *whole) {
  const far_harmonic *h = f->harmonic;
  if (!(f->whole = skf_alloc(h->size, sizeof(double)))) return SKF_ERR_NOMEM;
  for (size_t k = 0; k < h->size; k++) f->whole[k] = whole[k] * h->norm[k] / f->tree.side;
  for (size_t i = 0; i < f->tree.target_count; i++)
    for (size_t k = 0; k < h->size; k++) f->tensors[i * h->size + k] *= h->norm[k];
  return SKF_OK;
}

static skf_status make_batches(skf_far *f, const skf_prepared *elements, const double *whole) {
  far_tree *t = &f->tree;
  size_t points = f->harmonic || f->narrow ? 0 : (size_t)outer_points(&f->layout), leaves = 0;
  points = points * points * points;
  for (size_t k = 0; k < t->source_count; k++) leaves += !t->source[k].split;
  f->prepared_count = t->pieces.count + points;
  f->prepared = skf_alloc(f->prepared_count, sizeof *f->prepared);
  f->batch = skf_alloc(leaves + 1, sizeof *f->batch);
  if (!f->prepared || !f->batch) return SKF_ERR_NOMEM;
  for (size_t i = 0; i < t->pieces.count; i++) {
    const far_piece *p = t->pieces.at + i;
    const skf_prepared *e = elements + p->element;
    skf_prepare(&(skf_element){p->primitive, e->kernel, e->strength}, f->prepared + i);
  }
  if (points) outer(f, elements, whole, f->prepared + t->pieces.count);
  for (size_t k = 0; k < t->source_count; k++) { /* from here on `first` is the batch */
    far_source *s = t->source + k;
    if (s->split) continue;
    skf_status status = skf_batch_new(f->batch_ops, f->prepared + s->first, s->count, f->batch + f->batches);
    if (status) return status;
    s->first = f->batches++;
  }
  if (f->harmonic) return outer_harmonics(f, whole);
  if (f->narrow) return SKF_OK;
  return skf_batch_new(f->batch_ops, f->prepared + t->pieces.count, points, f->batch + f->batches++);
}

static bool list_add(skf_far *f, size_t *capacity, size_t batch) {
  if (f->list_count == *capacity) {
    size_t more = *capacity ? 2 * *capacity : 4096;
    unsigned *list = skf_realloc(f->list, more, sizeof *list);
    if (!list) return false;
    f->list = list, *capacity = more;
  }
  return f->list[f->list_count++] = (unsigned)batch, true;
}

static bool list_below(skf_far *f, size_t *capacity, int source) {
  const far_source *s = f->tree.source + source;
  if (!s->split) return list_add(f, capacity, s->first);
  for (int i = 0; i < 8; i++)
    if (s->child[i] >= 0 && !list_below(f, capacity, s->child[i])) return false;
  return true;
}

static int by_number(const void *a, const void *b) {
  unsigned x = *(const unsigned *)a, y = *(const unsigned *)b;
  return x < y ? -1 : x > y;
}

static bool list_around(skf_far *f, size_t *capacity, const far_target *p) {
  for (int i = 0; i < f->tree.around; i++) {
    const signed char *d = skf_far_around[i];
    int s = skf_far_tree_find(&f->tree, p->level, p->at[0] + d[0], p->at[1] + d[1], p->at[2] + d[2]);
    if (s >= 0 && !list_below(f, capacity, s)) return false;
  }
  return true;
}

/* The cells of the grid that have tensors, in their order, then all that is outside. */
static bool make_wide_leaves(skf_far *f) {
  const far_grid *g = &f->wide;
  const int w = g->width;
  if (!(f->leaf = skf_alloc(g->count + 1, sizeof *f->leaf))) return false;
  f->leaves = g->count + 1;
  for (int i = 0; i < w * w * w; i++) {
    if (!g->leaf[i]) continue;
    skf_vec3 at = {i % w + 0.5, i / w % w + 0.5, i / w / w + 0.5};
    f->leaf[g->leaf[i] - 1] = (far_leaf){v3_mad(g->lo, g->side, at), 2 / (FAR_WIDE * g->side),
                                         f->tensors + (g->leaf[i] - 1) * f->layout.size, 0, 0};
  }
  return true;
}

static bool make_leaves(skf_far *f) {
  if (f->wide.width) return make_wide_leaves(f);
  const far_tree *t = &f->tree;
  size_t capacity = 0;
  f->leaf_of = skf_alloc(t->target_count, sizeof *f->leaf_of);
  f->leaf = skf_alloc(t->target_count + 1, sizeof *f->leaf);
  if (!f->leaf_of || !f->leaf) return false;
  for (size_t k = 0; k < t->target_count; k++) {
    const far_target *p = t->target + k;
    if (p->child >= 0) continue;
    far_leaf *leaf = f->leaf + f->leaves;
    double side = far_side(t, p->level), per = f->harmonic ? 1 / side : 2 / (FAR_WIDE * side);
    *leaf = (far_leaf){far_center(t, p->level, p->at), per, f->narrow ? NULL : f->tensors + k * f->layout.size,
                       f->list_count, 0};
    if (!f->narrow && !list_around(f, &capacity, p)) return false;
    leaf->count = f->list_count - leaf->first;
    if (leaf->count) qsort(f->list + leaf->first, leaf->count, sizeof *f->list, by_number);
    f->leaf_of[k] = (unsigned)f->leaves++;
  }
  const int middle[3] = {1, 1, 1};
  far_leaf *out = f->leaf + f->leaves++;
  *out = (far_leaf){far_center(t, 0, middle), 1 / t->side, f->whole, f->list_count, f->harmonic || f->narrow ? 0 : 1};
  if (out->count == 0) return true;
  return list_add(f, &capacity, f->batches - 1);
}

static skf_status narrow_or_wide(skf_far *f, const skf_prepared *elements, double accuracy, size_t most, bool wide) {
  skf_status s = wide ? skf_far_wide(f, elements, accuracy, most) : SKF_ERR_UNSUPPORTED;
  if (s != SKF_ERR_UNSUPPORTED) return s;
  return skf_far_narrow_pays(f) ? SKF_OK : SKF_ERR_UNSUPPORTED;
}

skf_status skf_far_new(const skf_batch_ops *batch_ops, bool vectors, const skf_prepared *elements, size_t n,
                       double accuracy, skf_far **out) {
  *out = NULL;
  const skf_kernel_type type = n ? elements->kernel.type : SKF_KERNEL_COUNT;
  const bool narrow = type == SKF_GAUSSIAN;
  if (!narrow && !skf_far_kernel(type)) return SKF_ERR_UNSUPPORTED;
  skf_far *f = skf_alloc(1, sizeof *f);
  double *whole = skf_alloc(far_layout_new(FAR_ORDER).size, sizeof *whole);
  skf_status s = SKF_ERR_NOMEM;
  if (f && whole) {
    f->ops = &skf_far_scalar, f->batch_ops = batch_ops;
#ifdef SKF_HAVE_AVX2
    if (vectors) f->ops = &skf_far_avx2;
#endif
    (void)vectors;
    s = SKF_ERR_UNSUPPORTED;
    double fine = narrow ? skf_far_wide_side(elements, n, accuracy) : INFINITY;
    if (skf_far_tree_build(elements, n, type == SKF_INVERSE ? FAR_NEAR : FAR_NEIGHBOURS, around(type, accuracy),
                           most_targets(type, n, accuracy), fine, &f->tree))
      s = narrow ? skf_far_narrow(f, elements, accuracy) : skf_far_expand(f, elements, accuracy, whole);
    if (!s && narrow) s = narrow_or_wide(f, elements, accuracy, most_bytes(n), isfinite(fine));
    if (!s) s = make_batches(f, elements, whole);
    if (!s && !make_leaves(f)) s = SKF_ERR_NOMEM;
    skf_free(f->tree.pieces.at), f->tree.pieces = (far_pieces){.count = 0};
  }
  skf_free(whole);
  if (s) return skf_far_free(f), s;
  return *out = f, SKF_OK;
}

void skf_far_free(skf_far *f) {
  if (!f) return;
  for (size_t i = 0; i < f->batches && f->batch; i++) skf_batch_free(f->batch + i);
  skf_far_tree_free(&f->tree);
  skf_far_harmonic_free(f->harmonic), skf_free(f->whole), skf_free(f->narrow), skf_free(f->ball);
  skf_free(f->tensors), skf_free(f->prepared), skf_free(f->batch), skf_free(f->list), skf_free(f->leaf_of);
  skf_free(f->leaf), skf_free(f->wide.leaf), skf_free(f);
}
