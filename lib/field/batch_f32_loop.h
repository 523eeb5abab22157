/* SPDX-License-Identifier: MIT */
/* The loops of the forms for floats: lanes are points. Included by batch_loop.h. */
#ifndef SKF_FIELD_BATCH_F32_LOOP_H
#define SKF_FIELD_BATCH_F32_LOOP_H

#include "field/batch_f32.h"

/* The lanes of v that are not good, by the closed form in doubles. Lane i sees element i * step. */
static inline void lanes_closed(const skf_prepared *const *e, size_t step, bool inner, const skf_v3d *x,
                                skf_vvalue *v) {
  if (vi_all(v->good)) return;
  for (size_t i = 0; i < SKF_LANES; i++) {
    if (v->good[i]) continue;
    skf_value c = {.F = 0}; /* not before: it takes longer than a vector */
    skf_element_value(e[i * step], v3(x->x[i], x->y[i], x->z[i]), 1, &c);
    double s = inner ? e[i * step]->strength : 1;
    c.g = c.F - c.F == 0 ? v3_scale(s, c.g) : v3(0, 0, 0);
    v->F[i] = (float)(s * c.F);
    v->g.x[i] = (float)c.g.x, v->g.y[i] = (float)c.g.y, v->g.z[i] = (float)c.g.z;
  }
}

/* The strength, by scale[0] and scale[1], if there is a scale */
SKF_INLINE loop_factor loop_factor_of(const skf_tile *tile, size_t j, const double *scale) {
  const double strength = tile->column[j];
  return (loop_factor){vd_set(scale ? strength * scale[0] : strength), vd_set(scale ? strength * scale[1] : strength)};
}

static void batch_keep(size_t n, const double by[2], const float *F, const float *v, float *out) {
  const skf_vd by_F = vd_set(by[0]), by_v = vd_set(by[v != F]), zero = vd_set(0);
  for (size_t i = 0; i < n; i += SKF_LANES) {
    skf_vd f = by_F * vd_load(F + i), r = by_v * vd_load(v + i);
    if (v != F) r = vd_select(f - f == zero, r, zero);
    if (n - i >= SKF_LANES)
      vd_store(out + i, r);
    else
      memcpy(out + i, &r, (n - i) * sizeof(float));
  }
}

static void batch_gather(size_t n, double by, const float *restrict part, double *restrict sum) {
  for (size_t i = 0; i < n; i++) sum[i] += by * (double)part[i];
}

/* What a tile comes to: where sums go on, by itself, so that they don't lose something with each of its elements */
typedef struct tile_sum {
  float *to[4], room[4][SKF_F32_BATCH];
} tile_sum;
static inline void tile_begin(tile_sum *t, float *const sum[4], bool more) {
  for (int k = 0; k < 4; k++) t->to[k] = more ? t->room[k] : sum[k];
}
static inline void tile_end(const tile_sum *t, size_t n, float *const sum[4], bool more) {
  for (int k = 0; k < 4 && more; k++)
    for (size_t i = 0; i < n; i += SKF_LANES) vd_store(sum[k] + i, vd_load(sum[k] + i) + vd_load(t->room[k] + i));
}

#define SKF_BATCH_COMMON(name, row_name, again, inner)                                                                 \
  typedef row_name##_row name##_row;                                                                                   \
  _Static_assert(sizeof(name##_row) / sizeof(skf_vd) < SKF_ROW_MAX, "with the strength");                              \
  enum { name##_inner = (inner) };                                                                                     \
  SKF_INLINE skf_vvalue name##_again(const name##_row *row, skf_v3d x) {                                               \
    (void)row, (void)x;                                                                                                \
    return again(row, x);                                                                                              \
  }                                                                                                                    \
  static double *name##_pack(const skf_prepared *e, double *k) { return row_name##_pack(e, k); }

/* From NAME_all, which sets values or adds to them: the sum of a tile's */
#define SKF_BATCH_WHOLE(name)                                                                                          \
  static __attribute__((noinline)) void name##_bare(const skf_tile *tile, size_t n, const float *const p[3],           \
                                                    float *const sum[4]) {                                             \
    name##_all(tile, 0, NULL, n, p, sum, false);                                                                       \
  }                                                                                                                    \
  static __attribute__((noinline)) void name##_one(const skf_tile *tile, const double scale[2], size_t n,              \
                                                   const float *const p[3], float *const sum[4]) {                     \
    name##_all(tile, 0, scale, n, p, sum, false);                                                                      \
  }                                                                                                                    \
  static __attribute__((noinline)) void name##_more(const skf_tile *tile, size_t j, size_t n, const float *const p[3], \
                                                    float *const sum[4]) {                                             \
    name##_all(tile, j, NULL, n, p, sum, true);                                                                        \
  }                                                                                                                    \
  static void name##_add(const skf_tile *tile, size_t n, const float *const p[3], const double scale[2],               \
                         float *const sum[4], bool more) {                                                             \
    tile_sum t;                                                                                                        \
    tile_begin(&t, sum, more);                                                                                         \
    if (name##_inner && !scale)                                                                                        \
      name##_bare(tile, n, p, t.to);                                                                                   \
    else                                                                                                               \
      name##_one(tile, scale, n, p, t.to);                                                                             \
    for (size_t j = 1; j < tile->count; j++) name##_more(tile, j, n, p, t.to);                                         \
    tile_end(&t, n, sum, more);                                                                                        \
  }

/* Two vectors at once */
#define SKF_BATCH_PAIRS(name, inner)                                                                                   \
  static __attribute__((noinline)) void name##_redo(const skf_tile *tile, size_t j, const float *const p[3], size_t i, \
                                                    skf_vvalue *v) {                                                   \
    const skf_v3d x = points_load(p, i);                                                                               \
    name##_row row;                                                                                                    \
    row_spread((skf_vd *)&row, sizeof row / sizeof(skf_vd), tile->column + SKF_TILE, j);                               \
    vv_take(v, name##_again(&row, x));                                                                                 \
    lanes_closed(tile->element + j, 0, name##_inner, &x, v);                                                           \
  }                                                                                                                    \
  SKF_INLINE void name##_keep(const skf_tile *tile, size_t j, const float *const p[3], size_t at, loop_factor by,      \
                              skf_vvalue v, float *const sum[4]) {                                                     \
    if (__builtin_expect(!vi_all(v.good), 0)) {                                                                        \
      skf_vvalue w = v;                                                                                                \
      name##_redo(tile, j, p, at, &w);                                                                                 \
      v = w;                                                                                                           \
    }                                                                                                                  \
    if (j > 0)                                                                                                         \
      vv_add(by, &v, sum, at);                                                                                         \
    else                                                                                                               \
      vv_store(by, &v, sum, at);                                                                                       \
  }                                                                                                                    \
  SKF_INLINE void name##_all(const skf_tile *tile, size_t j, const name##_row *row, loop_factor by, size_t n,          \
                             const float *const p[3], float *const sum[4]) {                                           \
    size_t i = 0;                                                                                                      \
    for (; i + 2 * SKF_LANES <= n; i += 2 * SKF_LANES) {                                                               \
      skf_vvalue v = name##_value(row, points_load(p, i)), w = name##_value(row, points_load(p, i + SKF_LANES));       \
      name##_keep(tile, j, p, i, by, v, sum);                                                                          \
      name##_keep(tile, j, p, i + SKF_LANES, by, w, sum);                                                              \
    }                                                                                                                  \
    for (; i < n; i += SKF_LANES) name##_keep(tile, j, p, i, by, name##_value(row, points_load(p, i)), sum);           \
  }                                                                                                                    \
  static void name##_add(const skf_tile *tile, size_t n, const float *const p[3], const double scale[2],               \
                         float *const sum[4], bool more) {                                                             \
    const float *const in[3] = {p[0], p[1], p[2]};                                                                     \
    tile_sum t;                                                                                                        \
    tile_begin(&t, sum, more);                                                                                         \
    float *const out[4] = {t.to[0], t.to[1], t.to[2], t.to[3]};                                                        \
    for (size_t j = 0; j < tile->count; j++) {                                                                         \
      name##_row row;                                                                                                  \
      row_spread((skf_vd *)&row, sizeof row / sizeof(skf_vd), tile->column + SKF_TILE, j);                             \
      name##_all(tile, j, &row, loop_factor_of(tile, j, scale), n, in, out);                                           \
    }                                                                                                                  \
    tile_end(&t, n, sum, more);                                                                                        \
  }

/* Forms of one measure. The lanes of v, F and the gradient by the strength and a scale, that are not good */
#define SKF_F32_REDO(name)                                                                                             \
  static __attribute__((noinline)) void name##_redo(const skf_tile *tile, size_t j, const name##_row *row,             \
                                                    const skf_v3d *x, loop_factor by, skf_vvalue *v) {                 \
    skf_vvalue w = {.good = v->good};                                                                                  \
    vv_take(&w, name##_again(row, *x));                                                                                \
    lanes_closed(tile->element + j, 0, true, x, &w);                                                                   \
    vv_take(v, (skf_vvalue){by.F * w.F, vd3_scale(by.g, w.g), w.good});                                                \
  }

/* One element, four vectors at once; the next are measured while these wait for their own results. */
#define SKF_F32_SINGLE(name, way)                                                                                      \
  /* n vectors from i on, each by itself, with care where it needs it */                                               \
  static __attribute__((noinline)) void name##_apart(const skf_tile *tile, size_t n, const double scale[2],            \
                                                     const float *const p[3], size_t i, float *const out[4]) {         \
    const loop_factor by = loop_factor_of(tile, 0, scale);                                                             \
    name##_row row;                                                                                                    \
    row_spread((skf_vd *)&row, sizeof row / sizeof(skf_vd), tile->column + SKF_TILE, 0);                               \
    for (size_t end = i + n * SKF_LANES; i < end; i += SKF_LANES) {                                                    \
      const skf_v3d x = points_load(p, i);                                                                             \
      const skf_vd w = way##_measure(&row, x);                                                                         \
      skf_vd F, slope;                                                                                                 \
      const skf_vi good = name##_of(&row, 1, &w, &F, &slope);                                                          \
      slope *= by.g;                                                                                                   \
      skf_vvalue v = {by.F * F,                                                                                        \
                      {slope * way##_along(&row, x, &x.x), slope * way##_along(&row, y, &x.y),                         \
                       slope * way##_along(&row, z, &x.z)},                                                            \
                      good};                                                                                           \
      if (!vi_all(good)) name##_redo(tile, 0, &row, &x, by, &v);                                                       \
      vv_put(&v, out, i);                                                                                              \
    }                                                                                                                  \
  }                                                                                                                    \
  SKF_INLINE void name##_gauge(const name##_row *row, int mode, size_t n, const float *const p[3], size_t i,           \
                               skf_vd *w) {                                                                            \
    skf_v3d x[4];                                                                                                      \
    SKF_EACH(u, n) x[u] = points_load(p, i + u * SKF_LANES);                                                           \
    way##_gauge(row, mode, n, x, w);                                                                                   \
  }                                                                                                                    \
  SKF_INLINE void name##_fast(const skf_tile *tile, const name##_row *row, int mode, const double scale[2], size_t n,  \
                              const float *const p[3], float *const out[4]) {                                          \
    const size_t step = 4 * SKF_LANES;                                                                                 \
    const float *const from[3] = {mode == SKF_PLAIN ? way##_first(row, p) : p[0], p[1], p[2]};                         \
    const loop_factor by = loop_factor_of(tile, 0, scale);                                                             \
    size_t i = 0;                                                                                                      \
    skf_vd w[4], ahead[4], F[4], slope[4];                                                                             \
    if (n >= step) name##_gauge(row, mode, 4, from, 0, w);                                                             \
    for (; i + step <= n; i += step) {                                                                                 \
      name##_gauge(row, mode, 4, from, index_hide(i + 2 * step <= n ? i + step : i), ahead);                           \
      i = index_hide(i);                                                                                               \
      if (__builtin_expect(vi_all(name##_of(row, 4, w, F, slope)), 1)) {                                               \
        if (scale) {                                                                                                   \
          SKF_EACH(u, 4) F[u] *= by.F;                                                                                 \
          SKF_EACH(u, 4) slope[u] *= by.g;                                                                             \
        }                                                                                                              \
        SKF_EACH(u, 4) vd_store(out[0] + i + u * SKF_LANES, F[u]);                                                     \
        SKF_EACH(u, 4)                                                                                                 \
        vd_store(out[1] + i + u * SKF_LANES, slope[u] * way##_along(row, x, p[0] + i + u * SKF_LANES));                \
        SKF_EACH(u, 4)                                                                                                 \
        vd_store(out[2] + i + u * SKF_LANES, slope[u] * way##_along(row, y, p[1] + i + u * SKF_LANES));                \
        SKF_EACH(u, 4)                                                                                                 \
        vd_store(out[3] + i + u * SKF_LANES, slope[u] * way##_along(row, z, p[2] + i + u * SKF_LANES));                \
      } else                                                                                                           \
        name##_apart(tile, 4, scale, p, i, out);                                                                       \
      SKF_EACH(u, 4) w[u] = ahead[u];                                                                                  \
    }                                                                                                                  \
    if (i < n) name##_apart(tile, (n - i) / SKF_LANES, scale, p, i, out);                                              \
  }                                                                                                                    \
  static __attribute__((noinline)) void name##_one(const skf_tile *tile, const double scale[2], size_t n,              \
                                                   const float *const p[3], float *const sum[4]) {                     \
    const float *const in[3] = {p[0], p[1], p[2]};                                                                     \
    float *const out[4] = {sum[0], sum[1], sum[2], sum[3]};                                                            \
    name##_row row;                                                                                                    \
    row_spread((skf_vd *)&row, sizeof row / sizeof(skf_vd), tile->column + SKF_TILE, 0);                               \
    if (scale)                                                                                                         \
      name##_fast(tile, &row, SKF_MIXED, scale, n, in, out);                                                           \
    else if (way##_mode(&row) == SKF_PLAIN)                                                                            \
      name##_fast(tile, &row, SKF_PLAIN, NULL, n, in, out);                                                            \
    else                                                                                                               \
      name##_fast(tile, &row, SKF_MIXED, NULL, n, in, out);                                                            \
  }

/* Several elements: their constants wait in memory, their sums in registers. */
#define SKF_F32_SEVERAL(name, way)                                                                                     \
  SKF_INLINE void name##_onto(const name##_row *row, const skf_v3d *x, skf_vvalue *sum) {                              \
    skf_vd w, F, slope;                                                                                                \
    way##_gauge(row, SKF_MIXED, 1, x, &w);                                                                             \
    sum->good &= name##_of(row, 1, &w, &F, &slope);                                                                    \
    sum->F += F;                                                                                                       \
    sum->g.x = vd_fma(slope, way##_along(row, x, &x->x), sum->g.x);                                                    \
    sum->g.y = vd_fma(slope, way##_along(row, y, &x->y), sum->g.y);                                                    \
    sum->g.z = vd_fma(slope, way##_along(row, z, &x->z), sum->g.z);                                                    \
  }                                                                                                                    \
  static __attribute__((noinline)) void name##_careful(const skf_tile *tile, const name##_row *row, const skf_v3d *x,  \
                                                       skf_vvalue *sum) {                                              \
    for (size_t j = 0; j < tile->count; j++) {                                                                         \
      skf_vvalue v = *sum;                                                                                             \
      v.good = vi_set(-1);                                                                                             \
      name##_onto(row + j, x, &v);                                                                                     \
      if (!vi_all(v.good)) {                                                                                           \
        skf_vvalue w = {.good = v.good};                                                                               \
        name##_redo(tile, j, row + j, x, (loop_factor){vd_set(1), vd_set(1)}, &w);                                     \
        vv_take(&v, (skf_vvalue){sum->F + w.F, vd3_add(sum->g, w.g), w.good});                                         \
      }                                                                                                                \
      *sum = v;                                                                                                        \
    }                                                                                                                  \
  }                                                                                                                    \
  static __attribute__((noinline)) void name##_several(const skf_tile *tile, size_t n, const float *const p[3],        \
                                                       float *const sum[4], bool more) {                               \
    const float *const in[3] = {p[0], p[1], p[2]};                                                                     \
    float *const out[4] = {sum[0], sum[1], sum[2], sum[3]};                                                            \
    const size_t count = tile->count;                                                                                  \
    name##_row row[SKF_TILE];                                                                                          \
    for (size_t j = 0; j < count; j++)                                                                                 \
      row_spread((skf_vd *)(row + j), sizeof *row / sizeof(skf_vd), tile->column + SKF_TILE, j);                       \
    for (size_t i = 0; i < n; i += SKF_LANES) {                                                                        \
      const skf_v3d x = points_load(in, i);                                                                            \
      const skf_vd zero = vd_set(0);                                                                                   \
      const skf_vvalue none = {zero, {zero, zero, zero}, vi_set(-1)};                                                  \
      skf_vvalue all = none;                                                                                           \
      SKF_ROLLED for (size_t j = 0; j < count; j++) name##_onto(row + j, &x, &all);                                    \
      if (__builtin_expect(!vi_all(all.good), 0)) {                                                                    \
        const skf_v3d there = x;                                                                                       \
        skf_vvalue w = none;                                                                                           \
        name##_careful(tile, row, &there, &w);                                                                         \
        all = w;                                                                                                       \
      }                                                                                                                \
      if (more)                                                                                                        \
        vv_add((loop_factor){vd_set(1), vd_set(1)}, &all, out, i);                                                     \
      else                                                                                                             \
        vv_put(&all, out, i);                                                                                          \
    }                                                                                                                  \
  }

#define SKF_BATCH_FOURS(name, way)                                                                                     \
  SKF_F32_REDO(name)                                                                                                   \
  SKF_F32_SINGLE(name, way)                                                                                            \
  SKF_F32_SEVERAL(name, way)                                                                                           \
  static void name##_add(const skf_tile *tile, size_t n, const float *const p[3], const double scale[2],               \
                         float *const sum[4], bool more) {                                                             \
    if (tile->count == 1 && !more)                                                                                     \
      name##_one(tile, scale, n, p, sum);                                                                              \
    else                                                                                                               \
      name##_several(tile, n, p, sum, more);                                                                           \
  }
#define SKF_BATCH_ONE_BY_ONE(name, way) SKF_BATCH_FOURS(name, way)

#define SKF_F32_ENTRY(name)                                                                                            \
  .pack.form[SKF_FORM_##name] = {.columns = sizeof(name##_row) / sizeof(skf_vd) + 1,                                   \
                                 .pack = name##_pack,                                                                  \
                                 .inner = name##_inner},                                                               \
  .add[SKF_FORM_##name] = name##_add,

#endif
