/* SPDX-License-Identifier: MIT */
/* Fields: sums of elements, evaluated at points. */
#include "core/alloc.h"
#include "core/sum.h"
#include "field/batch.h"
#include "field/far.h"
#include "field/far_mixture.h"
#include "field/quadrature.h"
#include "field/solid.h"
#include "field/some.h"
#include <omp.h>
#include <string.h>

/* Fewer elements of one kernel are summed directly: a polynomial costs as much. */
enum { FAR_LEAST = 4000 };

struct skf_field {
  size_t n, plain; /* the first `plain` are no solids */
  skf_element *elements;
  skf_prepared *prepared;
  bool crowd;          /* neither solids nor far sums, and enough elements of one form to make them the lanes */
  size_t direct_count; /* plain elements that are summed one by one: all, or those that no far sum has */
  skf_prepared *direct, *own;
  skf_batch batch;                                             /* of these */
  void (*lone)(const skf_tile *, const skf_vec3 *, double[4]); /* of the only tile, where that is all; else NULL */
  skf_far **far;
  size_t far_count;
};

static skf_status check(const skf_element *e) {
  skf_status s = skf_kernel_check(e->kernel, e->primitive.shape);
  if (s) return s;
  if (!isfinite(e->strength)) return SKF_ERR_RANGE;
  if (e->profile) {
    if (e->primitive.shape != SKF_SEGMENT && e->primitive.shape != SKF_ARC) return SKF_ERR_ARG;
    if ((s = skf_profile_check(e->profile, NULL))) return s;
  }
  if (e->primitive.shape == SKF_SOLID && e->kernel.type != SKF_INVERSE) return SKF_ERR_UNSUPPORTED;
  return skf_primitive_check(&e->primitive, NULL);
}

/* The elements' profiles, copied and made ready. */
static skf_status weigh(skf_field *f) {
  for (size_t i = 0; i < f->n; i++) {
    skf_weight *w;
    if (!f->elements[i].profile) continue;
    skf_status s = skf_weight_new(f->elements[i].profile, &w);
    if (s) return s;
    f->elements[i].profile = &w->profile;
    f->prepared[i].weight = w;
  }
  return SKF_OK;
}

static bool may_be_far(const skf_prepared *e) {
  return (skf_far_kernel(e->kernel.type) || e->kernel.type == SKF_GAUSSIAN) && e->primitive.shape != SKF_PLANE &&
         e->strength != 0 && !e->weight && e->moderate;
}

static bool same_kernel(skf_kernel a, skf_kernel b) {
  return a.type == b.type && (a.param == b.param || !skf_kernel_get(a.type)->param);
}

/* Elements of the kernel that the first element of `from` has: moved to the front of `to`; the others stay in `from`.
 */
static size_t pick(skf_prepared *from, size_t n, skf_prepared *to) {
  skf_kernel kernel = from->kernel;
  size_t picked = 0, left = 0;
  for (size_t i = 0; i < n; i++) {
    if (may_be_far(from + i) && same_kernel(kernel, from[i].kernel))
      to[picked++] = from[i];
    else
      from[left++] = from[i];
  }
  return picked;
}

/* Groups of one kernel become far sums; what is left is direct. */
static skf_status make_far(skf_field *f, double accuracy) {
  skf_isa isa = skf_isa_pick();
  skf_prepared *left = skf_alloc(f->plain, sizeof *left), *group = skf_alloc(f->plain, sizeof *group);
  size_t n = f->plain, direct = 0;
  f->own = skf_alloc(f->plain, sizeof *f->own);
  f->far = skf_alloc(f->plain / FAR_LEAST, sizeof(skf_far *));
  skf_status s = left && group && f->own && f->far ? SKF_OK : SKF_ERR_NOMEM;
  if (!s) memcpy(left, f->prepared, n * sizeof *left);
  while (!s && n) {
    size_t picked = 1;
    if (!may_be_far(left)) {
      *group = *left, n--;
      memmove(left, left + 1, n * sizeof *left);
    } else {
      picked = pick(left, n, group), n -= picked;
      if (picked >= FAR_LEAST) {
        s = skf_far_new(skf_batch_get(isa), isa != SKF_ISA_SCALAR, group, picked, accuracy, f->far + f->far_count);
        if (!s) f->far_count++, picked = 0;
        if (s == SKF_ERR_UNSUPPORTED) s = SKF_OK;
      }
    }
    memcpy(f->own + direct, group, picked * sizeof *group), direct += picked;
  }
  skf_free(left), skf_free(group);
  f->direct = f->own, f->direct_count = direct;
  return s;
}

skf_status skf_field_new_with(const skf_element *elements, size_t n, const skf_field_options *options,
                              skf_field **out) {
  double accuracy = options ? options->accuracy : 0;
  *out = NULL;
  if (accuracy != 0 && !(accuracy >= 1e-12 && accuracy <= 0.01)) return SKF_ERR_RANGE;
  for (size_t i = 0; i < n; i++) {
    skf_status s = check(elements + i);
    if (s) return s;
  }
  skf_field *f = skf_alloc(1, sizeof *f);
  if (f) f->elements = skf_alloc(n, sizeof *elements);
  if (f) f->prepared = skf_alloc(n, sizeof *f->prepared);
  if (!f || !f->elements || !f->prepared) return skf_field_free(f), SKF_ERR_NOMEM;
  for (int solids = 0; solids < 2; solids++)
    for (size_t i = 0; i < n; i++) {
      if ((elements[i].primitive.shape == SKF_SOLID) != solids) continue;
      f->elements[f->n] = elements[i];
      skf_prepare(elements + i, f->prepared + f->n++);
      if (solids)
        skf_solid_share(elements[i].primitive.solid);
      else
        f->plain++;
    }
  skf_status s = weigh(f);
  f->direct = f->prepared, f->direct_count = f->plain;
  if (!s && accuracy > 0 && f->plain >= FAR_LEAST) s = make_far(f, accuracy);
  if (!s) s = skf_batch_new(skf_batch_get(skf_isa_pick()), f->direct, f->direct_count, &f->batch);
  if (s) return skf_field_free(f), s;
  bool alone = skf_field_is_direct(f);
  for (size_t i = 0; i < f->batch.tiles && alone; i++) f->crowd |= skf_batch_full(f->batch.tile + i);
  if (alone && f->batch.tiles == 1 && f->batch.tile->column) f->lone = f->batch.ops->form[f->batch.tile->form].lone;
  return *out = f, SKF_OK;
}

skf_status skf_field_new(const skf_element *elements, size_t n, skf_field **out) {
  return skf_field_new_with(elements, n, NULL, out);
}

void skf_field_free(skf_field *f) {
  if (!f) return;
  for (size_t i = 0; i < f->n; i++) skf_weight_free(f->prepared[i].weight);
  for (size_t i = f->plain; i < f->n; i++) skf_solid_free(f->prepared[i].primitive.solid);
  for (size_t i = 0; i < f->far_count; i++) skf_far_free(f->far[i]);
  skf_free(f->elements), skf_free(f->prepared), skf_free(f->own), skf_free(f->far), skf_batch_free(&f->batch);
  skf_free(f);
}

const skf_prepared *skf_field_prepared(const skf_field *f) { return f->prepared; }

size_t skf_field_size(const skf_field *f) { return f->n; }
const skf_element *skf_field_element(const skf_field *f, size_t i) { return i < f->n ? f->elements + i : NULL; }

static double evaluate(const skf_field *f, bool solids, skf_vec3 x, int order, skf_vec3 *g, double h[6]) {
  skf_sum F = {0, 0}, G[3] = {{0, 0}}, H[6] = {{0, 0}};
  size_t plain = f->direct_count + f->far_count, all = plain + (solids ? f->n - f->plain : 0);
  for (size_t i = 0; i < all; i++) {
    bool far = i >= f->direct_count && i < plain;
    const skf_prepared *e = i < plain ? f->direct + i : f->prepared + f->plain + (i - plain);
    skf_value v = {.F = 0};
    if (far)
      skf_far_value(f->far[i - f->direct_count], x, order, &v);
    else
      skf_element_value(e, x, order, &v);
    double w = far ? 1 : e->strength;
    sum_add(&F, w * v.F);
    sum_add(G + 0, w * v.g.x);
    sum_add(G + 1, w * v.g.y);
    sum_add(G + 2, w * v.g.z);
    for (int k = 0; order > 1 && k < 6; k++) sum_add(H + k, w * v.h[k]);
  }
  bool finite = isfinite(F.high);
  *g = finite ? v3(sum_total(G[0]), sum_total(G[1]), sum_total(G[2])) : v3(0, 0, 0);
  for (int k = 0; order > 1 && k < 6; k++) h[k] = finite ? sum_total(H[k]) : 0;
  return sum_total(F);
}

double skf_field_at(const skf_field *f, skf_vec3 p, skf_vec3 *g) {
  double v[4];
  skf_vec3 ignored;
  if (!f->crowd) return evaluate(f, true, p, 1, g ? g : &ignored, NULL);
  skf_batch_at(&f->batch, p, true, v);
  if (g) *g = v3(v[1], v[2], v[3]);
  return v[0];
}

double skf_field_tensor_at(const skf_field *f, skf_vec3 p, skf_vec3 *g, double h[6]) {
  skf_vec3 ignored;
  return evaluate(f, true, p, 2, g ? g : &ignored, h);
}

/* All but the solids. Where F is infinite the gradient is 0, whether somebody asked for F or not. */
static skf_status eval_plain(const skf_field *f, size_t n, const double *const p[3], double *F, double *const g[3]) {
  if (f->far_count == 0) return skf_batch_eval(&f->batch, n, p, F, g), SKF_OK;
  double *own = F ? NULL : skf_alloc(n, sizeof *own), *value = F ? F : own;
  if (!value) return SKF_ERR_NOMEM;
  skf_batch_eval(&f->batch, n, p, value, g);
  for (size_t k = 0; k < f->far_count; k++) skf_far_add(f->far[k], n, p, value, g);
  for (int k = 0; g && k < 3; k++)
    for (size_t i = 0; g[k] && i < n; i++)
      if (!isfinite(value[i])) g[k][i] = 0;
  return skf_free(own), SKF_OK;
}

/* Outputs of a batch: F, the gradient, the Hessian; any may be NULL. */
typedef struct outputs {
  double *column[SKF_SOLID_OUT];
} outputs;

/* n <= SKF_SOLID_POINTS points from `from` on: the solids are added to what the others give. */
static void add_solids(const skf_field *f, size_t from, size_t n, const double *const p[3], const outputs *out) {
  double all[SKF_SOLID_OUT][SKF_SOLID_POINTS], part[SKF_SOLID_OUT][SKF_SOLID_POINTS];
  double *const g[3] = {all[1], all[2], all[3]};
  const double *const at[3] = {p[0] + from, p[1] + from, p[2] + from};
  bool hessian = false;
  for (int k = 4; k < SKF_SOLID_OUT; k++) hessian = hessian || out->column[k];
  eval_plain(f, n, at, all[0], g); /* with F it allocates nothing */
  for (size_t i = 0; i < n && hessian; i++) {
    skf_vec3 ignored;
    double H[6];
    evaluate(f, false, v3(at[0][i], at[1][i], at[2][i]), 2, &ignored, H);
    for (int k = 0; k < 6; k++) all[4 + k][i] = H[k];
  }
  for (size_t j = f->plain; j < f->n; j++) {
    const skf_prepared *e = f->prepared + j;
    e->plan.solid->points(e->primitive.solid, n, at, hessian, part);
    for (int k = 0; k < (hessian ? SKF_SOLID_OUT : 4); k++)
      for (size_t i = 0; i < n; i++)
        if (isfinite(all[0][i])) all[k][i] += e->strength * part[k][i];
  }
  for (int k = 0; k < SKF_SOLID_OUT; k++)
    if (out->column[k]) memcpy(out->column[k] + from, all[k], n * sizeof(double));
}

/* Blocks for every thread; their size changes no result. */
static void eval_solids(const skf_field *f, size_t n, const double *const p[3], const outputs *out) {
  size_t faces = 0, share = (n + (size_t)omp_get_max_threads() - 1) / (size_t)omp_get_max_threads();
  for (size_t j = f->plain; j < f->n; j++) faces += skf_solid_get(f->prepared[j].primitive.solid)->faces;
  size_t step = share < SKF_SOLID_POINTS ? (share + 7) / 8 * 8 : SKF_SOLID_POINTS;
#pragma omp parallel for schedule(dynamic) if (n > 1 && n * faces >= 2048)
  for (size_t from = 0; from < n; from += step) add_solids(f, from, n - from < step ? n - from : step, p, out);
}

bool skf_field_is_direct(const skf_field *f) { return f->plain == f->n && f->far_count == 0; }

void skf_field_serial(const skf_field *f, size_t n, const double *const p[3], double *const out[4]) {
  skf_batch_serial(&f->batch, n, p, out);
}

skf_status skf_field_some_many(const skf_field *f, const uint32_t *which, size_t n, size_t points,
                               const double *const p[3], double *F) {
  skf_prepared *e = skf_alloc(n, sizeof *e);
  skf_batch b;
  if (!e) return SKF_ERR_NOMEM;
  for (size_t i = 0; i < n; i++) e[i] = f->prepared[which[i]];
  skf_status s = skf_batch_new(f->batch.ops, e, n, &b);
  if (!s) {
    skf_batch_serial(&b, points, p, (double *const[4]){F, NULL, NULL, NULL});
    skf_batch_free(&b);
  }
  skf_free(e);
  return s;
}

void skf_field_places(const skf_field *f, uint32_t *place) {
  for (size_t i = 0; i < f->n; i++) place[i] = SKF_NOWHERE;
  if (f->direct != f->prepared || f->batch.tiles >= SKF_NOWHERE / SKF_TILE) return;
  for (size_t i = 0; i < f->batch.tiles; i++) {
    const skf_tile *t = f->batch.tile + i;
    for (size_t j = 0; t->column && j < t->count; j++)
      place[t->element[j] - f->prepared] = (uint32_t)(i * SKF_TILE + j);
  }
}

void skf_field_some_eight(const skf_field *f, const uint32_t *place, const uint32_t *which, size_t n,
                          const skf_vec3 p[8], skf_made out[8]) {
  enum { N = 8 };
  double x[3][N], part[4][N], sum[5][N] = {{0}};
  const double *const at[3] = {x[0], x[1], x[2]};
  double *const to[4] = {part[0], part[1], part[2], part[3]};
  for (int i = 0; i < N; i++) x[0][i] = p[i].x, x[1][i] = p[i].y, x[2][i] = p[i].z;
  for (size_t k = 0; k < n; k++) {
    const skf_tile *t = f->batch.tile + place[which[k]] / SKF_TILE;
    size_t j = place[which[k]] % SKF_TILE;
    const skf_tile one = {.form = t->form, .count = 1, .column = t->column + j, .element = {t->element[j]}};
    f->batch.ops->form[t->form].one(&one, N, at, to);
    for (int i = 0; i < N; i++) sum[4][i] += fabs(part[0][i]);
    for (int c = 0; c < 4; c++)
      for (int i = 0; i < N; i++) sum[c][i] += part[c][i];
  }
  for (int i = 0; i < N; i++) out[i] = (skf_made){sum[0][i], sum[4][i], v3(sum[1][i], sum[2][i], sum[3][i])};
}

void skf_field_point(const skf_field *f, const skf_vec3 *p, double out[4]) {
  if (f->lone) return f->lone(f->batch.tile, p, out);
  if (skf_field_is_direct(f)) return skf_batch_at(&f->batch, *p, false, out);
  const double *const at[3] = {&p->x, &p->y, &p->z};
  double *const g[3] = {out + 1, out + 2, out + 3};
  skf_field_eval(f, 1, at, out, g, NULL);
}

skf_quick *skf_field_quick(const skf_field *f, skf_isa isa, const skf_tile **tile) {
  *tile = f->batch.tile;
  if (!f->lone || (isa == SKF_ISA_SCALAR) != (f->batch.ops == &skf_batch_scalar)) return NULL;
  return f->batch.ops->form[f->batch.tile->form].quick;
}

skf_status skf_field_eval(const skf_field *f, size_t n, const double *const p[3], double *F, double *const g[3],
                          double *const h[6]) {
  if (f->plain < f->n) {
    outputs out = {{F}};
    for (int k = 0; k < 3 && g; k++) out.column[1 + k] = g[k];
    for (int k = 0; k < 6 && h; k++) out.column[4 + k] = h[k];
    return eval_solids(f, n, p, &out), SKF_OK;
  }
  skf_status s = F || g ? eval_plain(f, n, p, F, g) : SKF_OK;
  if (s || !h) return s;
#pragma omp parallel for schedule(static) if (n * f->n >= 2048)
  for (size_t i = 0; i < n; i++) {
    skf_vec3 ignored;
    double H[6];
    evaluate(f, true, v3(p[0][i], p[1][i], p[2][i]), 2, &ignored, H);
    for (int k = 0; k < 6; k++)
      if (h[k]) h[k][i] = H[k];
  }
  return SKF_OK;
}
