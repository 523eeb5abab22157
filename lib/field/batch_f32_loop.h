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

/* What becomes of a sum: begun by an element, which needs no factor when BARE, or increased by one */
enum { SUM_BARE, SUM_FIRST, SUM_MORE };
SKF_INLINE void sum_float(float *sum, skf_vd strength, skf_vd v, int how) {
  vd_store(sum, how == SUM_BARE ? v : how == SUM_FIRST ? strength * v : vd_fma(strength, v, vd_load(sum)));
}

/* The strength, by scale[0] and scale[1], if there is a scale */
SKF_INLINE loop_factor loop_factor_of(const skf_tile *tile, size_t j, const double *scale) {
  const double strength = tile->column[j];
  return (loop_factor){vd_set(scale ? strength * scale[0] : strength), vd_set(scale ? strength * scale[1] : strength)};
}

static void batch_keep(size_t n, const float *F, const float *v, float *out) {
  for (size_t i = 0; i < n; i += SKF_LANES) {
    skf_vd f = vd_load(F + i), zero = vd_set(0), r = vd_load(v + i);
    if (v != F) r = vd_select(f - f == zero, r, zero);
    if (n - i >= SKF_LANES)
      vd_store(out + i, r);
    else
      memcpy(out + i, &r, (n - i) * sizeof(float));
  }
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
  static __attribute__((noinline)) void name##_more(const skf_tile *tile, size_t j, const double scale[2], size_t n,   \
                                                    const float *const p[3], float *const sum[4]) {                    \
    name##_all(tile, j, scale, n, p, sum, true);                                                                       \
  }                                                                                                                    \
  static void name##_add(const skf_tile *tile, size_t n, const float *const p[3], const double scale[2],               \
                         float *const sum[4]) {                                                                        \
    if (name##_inner && !scale)                                                                                        \
      name##_bare(tile, n, p, sum);                                                                                    \
    else                                                                                                               \
      name##_one(tile, scale, n, p, sum);                                                                              \
    for (size_t j = 1; j < tile->count; j++) name##_more(tile, j, scale, n, p, sum);                                   \
  }

/* A vector's value, corrected, into the sum */
#define SKF_F32_KEEP(name)                                                                                             \
  static __attribute__((noinline, cold)) void name##_redo(const skf_tile *tile, size_t j, const float *const p[3],     \
                                                          size_t i, skf_vvalue *v) {                                   \
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
    sum_float(sum[0] + at, by.F, v.F, j > 0 ? SUM_MORE : SUM_FIRST);                                                   \
    sum_float(sum[1] + at, by.g, v.g.x, j > 0 ? SUM_MORE : SUM_FIRST);                                                 \
    sum_float(sum[2] + at, by.g, v.g.y, j > 0 ? SUM_MORE : SUM_FIRST);                                                 \
    sum_float(sum[3] + at, by.g, v.g.z, j > 0 ? SUM_MORE : SUM_FIRST);                                                 \
  }

#define SKF_F32_ADD(name)                                                                                              \
  static void name##_add(const skf_tile *tile, size_t n, const float *const p[3], const double scale[2],               \
                         float *const sum[4]) {                                                                        \
    const float *const in[3] = {p[0], p[1], p[2]};                                                                     \
    float *const out[4] = {sum[0], sum[1], sum[2], sum[3]};                                                            \
    for (size_t j = 0; j < tile->count; j++) {                                                                         \
      name##_row row;                                                                                                  \
      row_spread((skf_vd *)&row, sizeof row / sizeof(skf_vd), tile->column + SKF_TILE, j);                             \
      name##_all(tile, j, &row, scale, n, in, out);                                                                    \
    }                                                                                                                  \
  }

#define SKF_BATCH_PAIRS(name, inner)                                                                                   \
  SKF_F32_KEEP(name)                                                                                                   \
  SKF_INLINE void name##_all(const skf_tile *tile, size_t j, const name##_row *row, const double *scale, size_t n,     \
                             const float *const p[3], float *const sum[4]) {                                           \
    const loop_factor by = loop_factor_of(tile, j, scale);                                                             \
    size_t i = 0;                                                                                                      \
    for (; i + 2 * SKF_LANES <= n; i += 2 * SKF_LANES) {                                                               \
      skf_vvalue v = name##_value(row, points_load(p, i)), w = name##_value(row, points_load(p, i + SKF_LANES));       \
      name##_keep(tile, j, p, i, by, v, sum);                                                                          \
      name##_keep(tile, j, p, i + SKF_LANES, by, w, sum);                                                              \
    }                                                                                                                  \
    for (; i < n; i += SKF_LANES) name##_keep(tile, j, p, i, by, name##_value(row, points_load(p, i)), sum);           \
  }                                                                                                                    \
  SKF_F32_ADD(name)

/* Four vectors at once */
#define SKF_BATCH_FOURS(name, way)                                                                                     \
  SKF_F32_KEEP(name)                                                                                                   \
  SKF_INLINE void name##_some(const skf_tile *tile, size_t j, const name##_row *row, loop_factor by, int mode,         \
                              size_t n, const int how, const float *const p[3], const float *const from[3], size_t i,  \
                              float *const sum[4]) {                                                                   \
    skf_v3d x[4];                                                                                                      \
    skf_vd w[4], F[4], slope[4];                                                                                       \
    SKF_EACH(u, n) x[u] = points_load(from, i + u * SKF_LANES);                                                        \
    const skf_vi sure = way##_gauge(row, mode, n, x, w);                                                               \
    if (__builtin_expect(!vi_all(name##_of(row, n, w, F, slope) & sure), 0)) {                                         \
      for (size_t u = 0; u < n; u++)                                                                                   \
        name##_keep(tile, j, p, i + u * SKF_LANES, by, name##_value(row, points_load(p, i + u * SKF_LANES)), sum);     \
      return;                                                                                                          \
    }                                                                                                                  \
    SKF_EACH(u, n) sum_float(sum[0] + i + u * SKF_LANES, by.F, F[u], how);                                             \
    SKF_EACH(u, n)                                                                                                     \
    sum_float(sum[1] + i + u * SKF_LANES, by.g, slope[u] * way##_along(row, x, p[0] + i + u * SKF_LANES), how);        \
    SKF_EACH(u, n)                                                                                                     \
    sum_float(sum[2] + i + u * SKF_LANES, by.g, slope[u] * way##_along(row, y, p[1] + i + u * SKF_LANES), how);        \
    SKF_EACH(u, n)                                                                                                     \
    sum_float(sum[3] + i + u * SKF_LANES, by.g, slope[u] * way##_along(row, z, p[2] + i + u * SKF_LANES), how);        \
  }                                                                                                                    \
  SKF_INLINE void name##_either(const skf_tile *tile, size_t j, const name##_row *row, loop_factor by, int mode,       \
                                size_t n, const int how, const float *const p[3], float *const sum[4]) {               \
    const float *const from[3] = {mode == SKF_PLAIN ? way##_first(row, p) : p[0], p[1], p[2]};                         \
    size_t i = 0;                                                                                                      \
    for (; i + 4 * SKF_LANES <= n; i += 4 * SKF_LANES) name##_some(tile, j, row, by, mode, 4, how, p, from, i, sum);   \
    for (; i < n; i += SKF_LANES) name##_some(tile, j, row, by, mode, 1, how, p, from, i, sum);                        \
  }                                                                                                                    \
  SKF_INLINE void name##_any(const skf_tile *tile, size_t j, const name##_row *row, const double *scale, int mode,     \
                             size_t n, const float *const p[3], float *const sum[4]) {                                 \
    const loop_factor by = loop_factor_of(tile, j, scale);                                                             \
    if (j > 0)                                                                                                         \
      name##_either(tile, j, row, by, mode, n, SUM_MORE, p, sum);                                                      \
    else if (scale)                                                                                                    \
      name##_either(tile, j, row, by, mode, n, SUM_FIRST, p, sum);                                                     \
    else                                                                                                               \
      name##_either(tile, j, row, by, mode, n, SUM_BARE, p, sum);                                                      \
  }                                                                                                                    \
  SKF_INLINE void name##_all(const skf_tile *tile, size_t j, const name##_row *row, const double *scale, size_t n,     \
                             const float *const p[3], float *const sum[4]) {                                           \
    if (way##_mode(row) == SKF_PLAIN)                                                                                  \
      name##_any(tile, j, row, scale, SKF_PLAIN, n, p, sum);                                                           \
    else                                                                                                               \
      name##_any(tile, j, row, scale, SKF_MIXED, n, p, sum);                                                           \
  }                                                                                                                    \
  SKF_F32_ADD(name)

#define SKF_BATCH_ONE_BY_ONE(name, way) SKF_BATCH_FOURS(name, way)

#define SKF_F32_ENTRY(name)                                                                                            \
  .pack.form[SKF_FORM_##name] = {.columns = sizeof(name##_row) / sizeof(skf_vd) + 1,                                   \
                                 .pack = name##_pack,                                                                  \
                                 .inner = name##_inner},                                                               \
  .add[SKF_FORM_##name] = name##_add,

#endif
