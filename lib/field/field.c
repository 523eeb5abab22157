/* SPDX-License-Identifier: MIT */
/* Fields: sums of elements, evaluated at points. */
#include "core/alloc.h"
#include "field/kernel.h"
#include <string.h>

struct skf_field {
  size_t n;
  skf_element *elements;
};

static skf_status check(const skf_element *e) {
  const skf_kernel_info *k = skf_kernel_get(e->kernel.type);
  if (!k) return SKF_ERR_ARG;
  if (k->param && !(e->kernel.param > 0 && isfinite(e->kernel.param))) return SKF_ERR_RANGE;
  if (!isfinite(e->strength)) return SKF_ERR_RANGE;
  return skf_primitive_check(&e->primitive, NULL);
}

skf_status skf_field_new(const skf_element *elements, size_t n, skf_field **out) {
  *out = NULL;
  for (size_t i = 0; i < n; i++) {
    skf_status s = check(elements + i);
    if (s) return s;
  }
  skf_field *f = skf_alloc(1, sizeof *f);
  if (f) f->elements = skf_alloc(n, sizeof *elements);
  if (!f || !f->elements) return skf_field_free(f), SKF_ERR_NOMEM;
  if (n) memcpy(f->elements, elements, n * sizeof *elements);
  f->n = n;
  return *out = f, SKF_OK;
}

void skf_field_free(skf_field *f) {
  if (f) skf_free(f->elements);
  skf_free(f);
}

size_t skf_field_size(const skf_field *f) { return f->n; }
const skf_element *skf_field_element(const skf_field *f, size_t i) { return i < f->n ? f->elements + i : NULL; }

/* Baseline until the closed forms land: midpoint rule, and 1/r on segments exactly. */
static skf_value crude(const skf_element *e, skf_vec3 x) {
  const skf_kernel_ops *row = skf_kernel_row(e->kernel.type);
  const skf_primitive *p = &e->primitive;
  skf_value v = {0, {0, 0, 0}};
  double d[4];
  if (p->shape == SKF_PLANE) return v;
  int n = p->shape == SKF_POINT ? 1 : 2000, m = p->shape == SKF_TRIANGLE ? 50 : 1;
  if (p->shape == SKF_TRIANGLE) n = 50;
  double weight = skf_primitive_measure(p) / (n * m);
  for (int i = 0; i < n; i++)
    for (int j = 0; j < m; j++) {
      skf_vec3 r = v3_sub(x, skf_primitive_point(p, (i + 0.5) / n, (j + 0.5) / m));
      row->eval(e->kernel.param, v3_norm2(r), d);
      v.F += weight * d[0];
      v.g = v3_mad(v.g, 2 * weight * d[1], r);
    }
  return v;
}

double skf_field_at(const skf_field *f, skf_vec3 p, skf_vec3 *g) {
  double F = 0;
  skf_vec3 G = {0, 0, 0};
  for (size_t i = 0; i < f->n; i++) {
    skf_value v = crude(f->elements + i, p);
    F += f->elements[i].strength * v.F;
    G = v3_mad(G, f->elements[i].strength, v.g);
  }
  if (g) *g = G;
  return F;
}

skf_status skf_field_eval(const skf_field *f, size_t n, const double *const p[3], double *F, double *const g[3],
                          double *const h[6]) {
  if (h) return SKF_ERR_UNSUPPORTED;
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < n; i++) {
    skf_vec3 G;
    double v = skf_field_at(f, v3(p[0][i], p[1][i], p[2][i]), &G);
    if (F) F[i] = v;
    if (g) g[0][i] = G.x, g[1][i] = G.y, g[2][i] = G.z;
  }
  return SKF_OK;
}
