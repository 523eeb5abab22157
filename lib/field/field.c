/* SPDX-License-Identifier: MIT */
/* Fields: sums of elements, evaluated at points. */
#include "core/alloc.h"
#include "field/batch.h"
#include "field/quadrature.h"
#include "field/solid.h"
#include "field/some.h"
#include <omp.h>
#include <string.h>

struct skf_field {
  size_t n, plain; /* the first `plain` are no solids */
  skf_element *elements;
  skf_prepared *prepared;
  skf_batch batch; /* of these */
  bool crowd;      /* no solids, and enough elements of one form to make them the lanes */
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

skf_status skf_field_new(const skf_element *elements, size_t n, skf_field **out) {
  *out = NULL;
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
  if (!s) s = skf_batch_new(skf_batch_get(skf_isa_pick()), f->prepared, f->plain, &f->batch);
  if (s) return skf_field_free(f), s;
  for (size_t i = 0; i < f->batch.tiles && f->plain == f->n; i++) f->crowd |= skf_batch_full(f->batch.tile + i);
  return *out = f, SKF_OK;
}

void skf_field_free(skf_field *f) {
  for (size_t i = 0; f && i < f->n; i++) skf_weight_free(f->prepared[i].weight);
  for (size_t i = f ? f->plain : 0; f && i < f->n; i++) skf_solid_free(f->prepared[i].primitive.solid);
  if (f) skf_free(f->elements), skf_free(f->prepared), skf_batch_free(&f->batch);
  skf_free(f);
}

const skf_prepared *skf_field_prepared(const skf_field *f) { return f->prepared; }

size_t skf_field_size(const skf_field *f) { return f->n; }
const skf_element *skf_field_element(const skf_field *f, size_t i) { return i < f->n ? f->elements + i : NULL; }

/* A sum with the rounding errors kept apart [Neumaier 1974]. */
typedef struct sum {
  double s, low;
} sum;

static void add(sum *a, double b) {
  double t = a->s + b;
  a->low += fabs(a->s) >= fabs(b) ? (a->s - t) + b : (b - t) + a->s;
  a->s = t;
}

static double total(sum a) { return isfinite(a.s) ? a.s + a.low : a.s; }

/* Of the first n elements. */
static double evaluate(const skf_field *f, size_t n, skf_vec3 x, int order, skf_vec3 *g, double h[6]) {
  sum F = {0, 0}, G[3] = {{0, 0}}, H[6] = {{0, 0}};
  for (size_t i = 0; i < n; i++) {
    const skf_prepared *e = f->prepared + i;
    skf_value v = {.F = 0};
    skf_element_value(e, x, order, &v);
    add(&F, e->strength * v.F);
    add(G + 0, e->strength * v.g.x);
    add(G + 1, e->strength * v.g.y);
    add(G + 2, e->strength * v.g.z);
    for (int k = 0; order > 1 && k < 6; k++) add(H + k, e->strength * v.h[k]);
  }
  bool finite = isfinite(F.s);
  *g = finite ? v3(total(G[0]), total(G[1]), total(G[2])) : v3(0, 0, 0);
  for (int k = 0; order > 1 && k < 6; k++) h[k] = finite ? total(H[k]) : 0;
  return total(F);
}

double skf_field_at(const skf_field *f, skf_vec3 p, skf_vec3 *g) {
  double v[4];
  skf_vec3 ignored;
  if (!f->crowd) return evaluate(f, f->n, p, 1, g ? g : &ignored, NULL);
  skf_batch_at(&f->batch, p, true, v);
  if (g) *g = v3(v[1], v[2], v[3]);
  return v[0];
}

double skf_field_tensor_at(const skf_field *f, skf_vec3 p, skf_vec3 *g, double h[6]) {
  skf_vec3 ignored;
  return evaluate(f, f->n, p, 2, g ? g : &ignored, h);
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
  skf_batch_eval(&f->batch, n, at, all[0], g);
  for (size_t i = 0; i < n && hessian; i++) {
    skf_vec3 ignored;
    double H[6];
    evaluate(f, f->plain, v3(at[0][i], at[1][i], at[2][i]), 2, &ignored, H);
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

skf_status skf_field_eval(const skf_field *f, size_t n, const double *const p[3], double *F, double *const g[3],
                          double *const h[6]) {
  if (f->plain < f->n) {
    outputs out = {{F}};
    for (int k = 0; k < 3 && g; k++) out.column[1 + k] = g[k];
    for (int k = 0; k < 6 && h; k++) out.column[4 + k] = h[k];
    return eval_solids(f, n, p, &out), SKF_OK;
  }
  skf_batch_eval(&f->batch, n, p, F, g);
  if (!h) return SKF_OK;
#pragma omp parallel for schedule(static) if (n * f->n >= 2048)
  for (size_t i = 0; i < n; i++) {
    skf_vec3 ignored;
    double H[6];
    evaluate(f, f->n, v3(p[0][i], p[1][i], p[2][i]), 2, &ignored, H);
    for (int k = 0; k < 6; k++)
      if (h[k]) h[k][i] = H[k];
  }
  return SKF_OK;
}
