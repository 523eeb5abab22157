/* SPDX-License-Identifier: MIT */
/* Fields: sums of elements, evaluated at points. */
#include "core/alloc.h"
#include "field/batch.h"
#include "field/quadrature.h"
#include "field/some.h"
#include <string.h>

struct skf_field {
  size_t n;
  skf_element *elements;
  skf_prepared *prepared;
  skf_batch batch;
  bool crowd; /* enough elements of one form to make them the lanes */
};

static skf_status check(const skf_element *e) {
  skf_status s = skf_kernel_check(e->kernel, e->primitive.shape);
  if (s) return s;
  if (!isfinite(e->strength)) return SKF_ERR_RANGE;
  if (e->profile) {
    if (e->primitive.shape != SKF_SEGMENT && e->primitive.shape != SKF_ARC) return SKF_ERR_ARG;
    if ((s = skf_profile_check(e->profile, NULL))) return s;
  }
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
  if (n) memcpy(f->elements, elements, n * sizeof *elements);
  for (size_t i = 0; i < n; i++) skf_prepare(elements + i, f->prepared + i);
  f->n = n;
  skf_status s = weigh(f);
  if (!s) s = skf_batch_new(skf_batch_get(skf_isa_pick()), f->prepared, n, &f->batch);
  if (s) return skf_field_free(f), s;
  for (size_t i = 0; i < f->batch.tiles; i++) f->crowd |= skf_batch_full(f->batch.tile + i);
  return *out = f, SKF_OK;
}

void skf_field_free(skf_field *f) {
  for (size_t i = 0; f && i < f->n; i++) skf_weight_free(f->prepared[i].weight);
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

static double evaluate(const skf_field *f, skf_vec3 x, int order, skf_vec3 *g, double h[6]) {
  sum F = {0, 0}, G[3] = {{0, 0}}, H[6] = {{0, 0}};
  for (size_t i = 0; i < f->n; i++) {
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
  if (!f->crowd) return evaluate(f, p, 1, g ? g : &ignored, NULL);
  skf_batch_at(&f->batch, p, true, v);
  if (g) *g = v3(v[1], v[2], v[3]);
  return v[0];
}

double skf_field_tensor_at(const skf_field *f, skf_vec3 p, skf_vec3 *g, double h[6]) {
  skf_vec3 ignored;
  return evaluate(f, p, 2, g ? g : &ignored, h);
}

skf_status skf_field_eval(const skf_field *f, size_t n, const double *const p[3], double *F, double *const g[3],
                          double *const h[6]) {
  skf_batch_eval(&f->batch, n, p, F, g);
  if (!h) return SKF_OK;
#pragma omp parallel for schedule(static) if (n * f->n >= 2048)
  for (size_t i = 0; i < n; i++) {
    skf_vec3 ignored;
    double H[6];
    evaluate(f, v3(p[0][i], p[1][i], p[2][i]), 2, &ignored, H);
    for (int k = 0; k < 6; k++)
      if (h[k]) h[k][i] = H[k];
  }
  return SKF_OK;
}
