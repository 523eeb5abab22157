/* SPDX-License-Identifier: MIT */
/* Fields in floats: the elements that have a form for floats, in the frame of the points; the others in doubles. */
#include "core/alloc.h"
#include "field/batch_f32.h"
#include <omp.h>
#include <string.h>

struct skf_field_f32 {
  skf_vec3 origin;
  double unit, top; /* largest strength, or 1 where it is near enough to that */
  const skf_f32_ops *ops;
  skf_prepared *prepared;
  skf_batch batch;
  skf_field *rest; /* NULL: none */
};

static const skf_f32_ops none = {.pack = {.total = NULL}};

static const skf_f32_ops *get(skf_isa isa) {
#ifdef SKF_HAVE_AVX512
  if (isa == SKF_ISA_AVX512) return &skf_f32_avx512;
#endif
#ifdef SKF_HAVE_AVX2
  if (isa == SKF_ISA_AVX2) return &skf_f32_avx2;
#endif
  (void)isa;
  return &none;
}

/* e as seen in lengths of `unit` from the origin. Lengths l = unit l': h(l) = unit^k h'(l') and dmu = unit^dim dmu'. */
static skf_element localise(const skf_element *e, skf_vec3 origin, double unit) {
  static const int dim[SKF_SHAPE_COUNT] = {[SKF_SEGMENT] = 1, [SKF_ARC] = 1, [SKF_TRIANGLE] = 2, [SKF_PLANE] = 2};
  skf_element l = *e;
  skf_primitive *p = &l.primitive;
  skf_vec3 *at[3] = {NULL, NULL, NULL};
  switch (p->shape) {
  case SKF_POINT: at[0] = &p->point.at; break;
  case SKF_SEGMENT: at[0] = &p->segment.from, at[1] = &p->segment.to; break;
  case SKF_ARC: at[0] = &p->arc.center, p->arc.radius /= unit; break;
  case SKF_TRIANGLE:
    for (int i = 0; i < 3; i++) at[i] = p->triangle.vertices + i;
    break;
  default: at[0] = &p->plane.through;
  }
  for (int i = 0; i < 3 && at[i]; i++) *at[i] = v3_scale(1 / unit, v3_sub(*at[i], origin));
  skf_kernel_type type = e->kernel.type;
  int power = dim[p->shape] - (type == SKF_INVERSE ? 1 : type == SKF_INVERSE_SQUARED ? 2 : 0);
  l.strength *= pow(unit, power);
  l.kernel.param *= skf_kernel_get(type)->compact ? 1 / unit : unit;
  return l;
}

void skf_field_f32_free(skf_field_f32 *f) {
  if (f) skf_free(f->prepared), skf_batch_free(&f->batch), skf_field_free(f->rest);
  skf_free(f);
}

static skf_status split(const skf_field *field, skf_field_f32 *f, skf_element *rest) {
  size_t n = skf_field_size(field), here = 0, others = 0;
  for (size_t i = 0; i < n; i++) {
    const skf_element *e = skf_field_element(field, i);
    skf_prepared *p = f->prepared + here;
    bool fits = false;
    if (e->kernel.type < SKF_KERNEL_COUNT && e->primitive.shape != SKF_SOLID && !e->profile) {
      skf_element l = localise(e, f->origin, f->unit);
      if (!skf_primitive_check(&l.primitive, NULL) && isfinite(l.strength))
        skf_prepare(&l, p), fits = skf_batch_form_of(&f->ops->pack, p) < SKF_FORM_COUNT;
    }
    if (fits)
      here++, f->top = fmax(f->top, fabs(p->strength));
    else
      rest[others++] = *e;
  }
  if (f->top > 1. / 64 && f->top < 64) f->top = 1; /* so that values are right as they come */
  for (size_t i = 0; i < here && f->top > 0; i++) f->prepared[i].strength /= f->top;
  skf_status s = skf_batch_new(&f->ops->pack, f->prepared, here, &f->batch);
  return s || !others ? s : skf_field_new(rest, others, &f->rest);
}

skf_status skf_field_f32_new(const skf_field *field, skf_vec3 origin, double unit, skf_field_f32 **out) {
  *out = NULL;
  if (!(unit > 0 && isfinite(unit)) || !v3_finite(origin)) return SKF_ERR_RANGE;
  size_t n = skf_field_size(field);
  skf_field_f32 *f = skf_alloc(1, sizeof *f);
  skf_element *rest = skf_alloc(n, sizeof *rest);
  if (f) f->prepared = skf_alloc(n, sizeof *f->prepared);
  if (!f || !rest || !f->prepared) return skf_field_f32_free(f), skf_free(rest), SKF_ERR_NOMEM;
  f->origin = origin, f->unit = unit, f->ops = get(skf_isa_pick());
  skf_status s = split(field, f, rest);
  skf_free(rest);
  if (s) return skf_field_f32_free(f), s;
  return *out = f, SKF_OK;
}

typedef struct job {
  const skf_field_f32 *f;
  const float *const *p;
  float *out[4]; /* any may be NULL */
} job;

/* In doubles, at points of the field's own frame; added to sum. */
static void add_rest(const skf_field_f32 *f, size_t n, const float *const p[3], double sum[4][SKF_F32_BATCH]) {
  double x[3][SKF_F32_BATCH], v[4][SKF_F32_BATCH], *const g[3] = {v[1], v[2], v[3]};
  const double *const in[3] = {x[0], x[1], x[2]};
  for (int k = 0; k < 3; k++) {
    double origin = v3_get(f->origin, k), unit = f->unit;
    const float *from = p[k];
    for (size_t i = 0; i < n; i++) x[k][i] = origin + unit * (double)from[i];
  }
  skf_field_eval(f->rest, n, in, v[0], g, NULL);
  for (int k = 0; k < 4; k++)
    for (size_t i = 0; i < n; i++) sum[k][i] += v[k][i];
}

/* The points from `from` on, the last one again as padding; returns their number with the padding. */
static size_t pad(const job *j, size_t from, size_t n, float room[3][SKF_F32_BATCH], const float *p[3]) {
  size_t padded = (n + SKF_F32_PAD - 1) / SKF_F32_PAD * SKF_F32_PAD;
  for (int k = 0; k < 3; k++) {
    p[k] = j->p[k] + from;
    if (n == padded) continue;
    memcpy(room[k], p[k], n * sizeof(float));
    for (size_t i = n; i < padded; i++) room[k][i] = p[k][n - 1];
    p[k] = room[k];
  }
  return padded;
}

/* Whether sums need no doubles. */
static bool plain(const skf_field_f32 *f) {
  double scale = f->top / f->unit;
  return f->batch.tiles > 0 && f->batch.tiles <= SKF_F32_TILES && !f->rest && f->top > 1e-20 && f->top < 1e20 &&
         scale > 1e-20 && scale < 1e20;
}

static const double *needed(const double scale[2]) { return scale[0] == 1 && scale[1] == 1 ? NULL : scale; }

static void finish(size_t n, double sum[4][SKF_F32_BATCH], int k, float *restrict out) {
  const double *F = sum[0], *v = sum[k];
  if (k == 0)
    for (size_t i = 0; i < n; i++) out[i] = (float)v[i];
  else
    for (size_t i = 0; i < n; i++) out[i] = F[i] - F[i] == 0 ? (float)v[i] : 0;
}

/* n points from `from` on, up to SKF_F32_BATCH. Floats within some tiles, doubles over all. */
static void block(const job *j, size_t from, size_t n) {
  const skf_field_f32 *f = j->f;
  float room[3][SKF_F32_BATCH], part[4][SKF_F32_BATCH], *const to[4] = {part[0], part[1], part[2], part[3]};
  double sum[4][SKF_F32_BATCH];
  const double scale[2] = {f->top, f->top / f->unit}, unscaled[2] = {1, 1};
  const float *p[3];
  const size_t padded = pad(j, from, n, room, p);
  const bool floats = plain(f), lone = floats && f->batch.elements == 1;
  if (!floats)
    for (int k = 0; k < 4; k++) memset(sum[k], 0, n * sizeof(double));
  for (size_t t = 0; t < f->batch.tiles; t++) {
    const skf_tile *tile = f->batch.tile + t;
    f->ops->add[tile->form](tile, padded, p, lone ? needed(scale) : NULL, to, t % SKF_F32_TILES > 0);
    if (!floats && (t + 1 == f->batch.tiles || (t + 1) % SKF_F32_TILES == 0))
      for (int k = 0; k < 4; k++) f->ops->gather(n, scale[k > 0], part[k], sum[k]);
  }
  if (f->rest) add_rest(f, n, p, sum);
  for (int k = 0; k < 4; k++) {
    if (!j->out[k]) continue;
    if (floats) /* an element alone has no infinities that cancel */
      f->ops->keep(n, lone ? unscaled : scale, lone ? part[k] : part[0], part[k], j->out[k] + from);
    else
      finish(n, sum, k, j->out[k] + from);
  }
}

static void blocks(const job *j, size_t from, size_t n) {
  for (size_t end = from + n; from < end; from += SKF_F32_BATCH)
    block(j, from, end - from < SKF_F32_BATCH ? end - from : SKF_F32_BATCH);
}

/* One element, all outputs: straight into them but for the last few points. */
static void direct(const job *j, size_t from, size_t n) {
  const skf_field_f32 *f = j->f;
  const double scale[2] = {f->top, f->top / f->unit};
  const float *const p[3] = {j->p[0] + from, j->p[1] + from, j->p[2] + from};
  float *const out[4] = {j->out[0] + from, j->out[1] + from, j->out[2] + from, j->out[3] + from};
  size_t whole = n / SKF_F32_PAD * SKF_F32_PAD;
  if (whole > 0) f->ops->add[f->batch.tile->form](f->batch.tile, whole, p, needed(scale), out, false);
  if (whole < n) block(j, from + whole, n - whole);
}

skf_status skf_field_f32_eval(const skf_field_f32 *f, size_t n, const float *const p[3], float *F, float *const g[3]) {
  job j = {f, p, {F, g ? g[0] : NULL, g ? g[1] : NULL, g ? g[2] : NULL}};
  size_t elements = f->batch.elements + (f->rest ? 4 * skf_field_size(f->rest) : 0);
  bool straight = plain(f) && f->batch.elements == 1 && j.out[0] && j.out[1] && j.out[2] && j.out[3];
  void (*range)(const job *, size_t, size_t) = straight ? direct : blocks;
  if (n * elements < 8192) { /* as in skf_batch_eval */
    range(&j, 0, n);
    return SKF_OK;
  }
  size_t share = n / (4 * (size_t)omp_get_max_threads()), step = share / SKF_F32_BATCH * SKF_F32_BATCH;
  if (step < SKF_F32_BATCH) step = SKF_F32_BATCH;
#pragma omp parallel for schedule(dynamic)
  for (size_t from = 0; from < n; from += step) range(&j, from, n - from < step ? n - from : step);
  return SKF_OK;
}
