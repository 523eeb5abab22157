/* SPDX-License-Identifier: MIT */
/* The loops of the forms for doubles: lanes are points or elements. Included by batch_loop.h. */
#ifndef SKF_FIELD_BATCH_F64_LOOP_H
#define SKF_FIELD_BATCH_F64_LOOP_H

/* The constants of the elements from j on, one in each lane */
SKF_INLINE void row_load(skf_vd *row, size_t n, const double *column, size_t j) {
#pragma GCC unroll 128
  for (size_t k = 0; k < n; k++) row[k] = vd_load(column + k * SKF_TILE + j);
}

/* The strength */
SKF_INLINE loop_factor loop_factor_of(const skf_tile *tile, size_t j, const double *scale) {
  (void)scale;
  return (loop_factor){vd_set(tile->column[j]), vd_set(tile->column[j])};
}

/* The lanes of v that are not good, by the closed form. Lane i sees element i * step. */
static inline void lanes_closed(const skf_prepared *const *e, size_t step, bool inner, const skf_v3d *x,
                                skf_vvalue *v) {
  if (vi_all(v->good)) return;
  for (size_t i = 0; i < SKF_LANES; i++) {
    if (v->good[i]) continue;
    skf_value c = {.F = 0}; /* not before: it takes longer than a vector */
    skf_element_value(e[i * step], v3(x->x[i], x->y[i], x->z[i]), 1, &c);
    double s = inner ? e[i * step]->strength : 1;
    c.g = c.F - c.F == 0 ? v3_scale(s, c.g) : v3(0, 0, 0);
    v->F[i] = s * c.F, v->g.x[i] = c.g.x, v->g.y[i] = c.g.y, v->g.z[i] = c.g.z;
  }
}

/* *sum += v, the rounding error kept exactly [Knuth] */
SKF_INLINE void sum_column(skf_batch_sum *sum, int k, size_t i, skf_vd v, bool first) {
  skf_vd a = first ? vd_set(0) : vd_load(sum->s[k] + i), low = first ? vd_set(0) : vd_load(sum->low[k] + i);
  skf_vd s = a + v, t = s - a;
  vd_store(sum->s[k] + i, s);
  vd_store(sum->low[k] + i, low + ((a - (s - t)) + (v - t)));
}
SKF_INLINE void sum_add(skf_batch_sum *sum, size_t i, const skf_vvalue *v, bool first) {
  sum_column(sum, 0, i, v->F, first);
  sum_column(sum, 1, i, v->g.x, first);
  sum_column(sum, 2, i, v->g.y, first);
  sum_column(sum, 3, i, v->g.z, first);
}

/* sum_column for elements as lanes: the lanes from j on */
SKF_INLINE void sum_lanes(skf_point_sum *sum, int k, size_t j, skf_vd v) {
  skf_vd a = vd_load(sum->s[k] + j), s = a + v, t = s - a;
  vd_store(sum->s[k] + j, s);
  vd_store(sum->low[k] + j, vd_load(sum->low[k] + j) + ((a - (s - t)) + (v - t)));
}

/* A tile's values, all into lane 0 as name##_add does */
SKF_INLINE void sum_tile(const skf_tile *tile, double values[4][SKF_TILE], skf_point_sum *sum) {
  double all[4] = {0, 0, 0, 0};
  for (size_t j = 0; j < tile->count; j++)
    for (int k = 0; k < 4; k++) all[k] = fma(tile->column[j], values[k][j], all[k]);
  for (int k = 0; k < 4; k++) {
    double a = sum->s[k][0], s = a + all[k], t = s - a;
    sum->s[k][0] = s;
    sum->low[k][0] += (a - (s - t)) + (all[k] - t);
  }
}

SKF_INLINE void tile_keep(const skf_tile *tile, size_t j, const skf_vvalue *v, bool exact, double values[4][SKF_TILE],
                          skf_point_sum *sum) {
  const skf_vd part[4] = {v->F, v->g.x, v->g.y, v->g.z};
  for (int k = 0; k < 4; k++)
    if (exact)
      sum_lanes(sum, k, j, vd_load(tile->column + j) * part[k]);
    else
      vd_store(values[k] + j, part[k]);
}

/* The sum of a tile's values as name##_add and `total` make it. */
SKF_INLINE void tile_total(const skf_tile *tile, double values[4][SKF_TILE], double out[4]) {
  for (int k = 0; k < 4; k++) out[k] = 0;
  for (size_t j = 0; j < tile->count; j++)
    for (int k = 0; k < 4; k++) out[k] = fma(tile->column[j], values[k][j], out[k]);
  for (int k = 1; k < 4; k++) out[k] = out[0] - out[0] == 0 ? out[k] : 0;
}

/* The lanes from n on, which see no element of their own, must not be infinite. */
static inline void lanes_beyond(size_t n, skf_vvalue *v) {
  for (size_t i = n; i < SKF_LANES; i++)
    if (!v->good[i]) v->good[i] = -1, v->F[i] = v->g.x[i] = v->g.y[i] = v->g.z[i] = 0;
}

#define SKF_BATCH_COMMON(name, row_name, again, inner)                                                                 \
  typedef row_name##_row name##_row;                                                                                   \
  _Static_assert(sizeof(name##_row) / sizeof(skf_vd) < SKF_ROW_MAX, "with the strength");                              \
  enum { name##_inner = (inner) };                                                                                     \
  SKF_INLINE skf_vvalue name##_again(const name##_row *row, skf_v3d x) {                                               \
    (void)row, (void)x;                                                                                                \
    return again(row, x);                                                                                              \
  }                                                                                                                    \
  static double *name##_pack(const skf_prepared *e, double *k) { return row_name##_pack(e, k); }                       \
  static                                                                                                               \
      __attribute__((noinline)) void name##_redo_at(const skf_tile *tile, size_t j, const skf_v3d *x, skf_vvalue *v) { \
    name##_row row;                                                                                                    \
    row_load((skf_vd *)&row, sizeof row / sizeof(skf_vd), tile->column + SKF_TILE, j);                                 \
    lanes_beyond(tile->count - j, v);                                                                                  \
    if (vi_all(v->good)) return;                                                                                       \
    vv_take(v, name##_again(&row, *x));                                                                                \
    lanes_closed(tile->element + j, 1, name##_inner, x, v);                                                            \
  }                                                                                                                    \
  /* the tile's values at one point, to be kept in `values` or added to `sum` */                                       \
  SKF_INLINE void name##_across(const skf_tile *tile, const skf_vec3 *p, bool exact, double values[4][SKF_TILE],       \
                                skf_point_sum *sum) {                                                                  \
    const skf_v3d x = {vd_set(p->x), vd_set(p->y), vd_set(p->z)};                                                      \
    for (size_t j = 0; j < tile->count; j += SKF_LANES) {                                                              \
      name##_row row;                                                                                                  \
      row_load((skf_vd *)&row, sizeof row / sizeof(skf_vd), tile->column + SKF_TILE, j);                               \
      skf_vvalue v = name##_value(&row, x);                                                                            \
      if (!vi_all(v.good)) {                                                                                           \
        skf_v3d at = x;                                                                                                \
        skf_vvalue w = v;                                                                                              \
        name##_redo_at(tile, j, &at, &w);                                                                              \
        v = w;                                                                                                         \
      }                                                                                                                \
      tile_keep(tile, j, &v, exact, values, sum);                                                                      \
    }                                                                                                                  \
  }                                                                                                                    \
  static void name##_at(const skf_tile *tile, skf_vec3 p, bool exact, skf_point_sum *sum) {                            \
    double values[4][SKF_TILE];                                                                                        \
    name##_across(tile, &p, exact, values, sum);                                                                       \
    if (!exact) sum_tile(tile, values, sum);                                                                           \
  }                                                                                                                    \
  static __attribute__((noinline)) void name##_few(const skf_tile *tile, const skf_vec3 *p, double out[4]) {           \
    double values[4][SKF_TILE];                                                                                        \
    name##_across(tile, p, false, values, NULL);                                                                       \
    tile_total(tile, values, out);                                                                                     \
  }                                                                                                                    \
  SKF_INLINE skf_four name##_only(const skf_tile *tile, skf_vec3 p) {                                                  \
    const skf_v3d x = {vd_set(p.x), vd_set(p.y), vd_set(p.z)};                                                         \
    double out[4];                                                                                                     \
    name##_row row;                                                                                                    \
    if (tile->count == 1) {                                                                                            \
      row_load((skf_vd *)&row, sizeof row / sizeof(skf_vd), tile->column + SKF_TILE, 0);                               \
      skf_vvalue v = name##_value(&row, x);                                                                            \
      if (!vi_all(v.good)) {                                                                                           \
        skf_v3d at = x;                                                                                                \
        skf_vvalue w = v;                                                                                              \
        name##_redo_at(tile, 0, &at, &w);                                                                              \
        v = w;                                                                                                         \
      }                                                                                                                \
      return tile->column[0] * (skf_four){v.g.x[0], v.g.y[0], v.g.z[0], v.F[0]};                                       \
    }                                                                                                                  \
    name##_few(tile, &p, out);                                                                                         \
    return (skf_four){out[1], out[2], out[3], out[0]};                                                                 \
  }                                                                                                                    \
  static void name##_lone(const skf_tile *tile, const skf_vec3 *p, double out[4]) {                                    \
    const skf_four v = name##_only(tile, *p);                                                                          \
    out[0] = v[3], out[1] = v[0], out[2] = v[1], out[3] = v[2];                                                        \
  }                                                                                                                    \
  static skf_four name##_quick(const skf_tile *tile, skf_four p) {                                                     \
    return name##_only(tile, (skf_vec3){p[0], p[1], p[2]});                                                            \
  }

/* Two vectors at once */
#define SKF_BATCH_PAIRS(name, inner)                                                                                   \
  static __attribute__((noinline)) void name##_redo(const skf_tile *tile, size_t j, const double *const p[3],          \
                                                    size_t i, skf_vvalue *v) {                                         \
    const skf_v3d x = points_load(p, i);                                                                               \
    name##_row row;                                                                                                    \
    row_spread((skf_vd *)&row, sizeof row / sizeof(skf_vd), tile->column + SKF_TILE, j);                               \
    vv_take(v, name##_again(&row, x));                                                                                 \
    lanes_closed(tile->element + j, 0, name##_inner, &x, v);                                                           \
  }                                                                                                                    \
  /* The value of n = 1 or 2 vectors of points from i on */                                                            \
  SKF_INLINE void name##_pair(const skf_tile *tile, size_t j, const name##_row *row, const double *const p[3],         \
                              size_t i, size_t n, skf_vvalue *v) {                                                     \
    for (size_t u = 0; u < n; u++) v[u] = name##_value(row, points_load(p, i + u * SKF_LANES));                        \
    if (__builtin_expect(vi_all(n > 1 ? v[0].good & v[1].good : v[0].good), 1)) return;                                \
    for (size_t u = 0; u < n; u++) {                                                                                   \
      skf_vvalue w = v[u];                                                                                             \
      if (vi_all(w.good)) continue;                                                                                    \
      name##_redo(tile, j, p, i + u * SKF_LANES, &w);                                                                  \
      v[u] = w;                                                                                                        \
    }                                                                                                                  \
  }                                                                                                                    \
  SKF_INLINE void name##_one_step(const skf_tile *tile, const name##_row *row, const double *const p[3], size_t i,     \
                                  size_t n, double *const out[4]) {                                                    \
    const loop_factor by = loop_factor_of(tile, 0, NULL);                                                              \
    skf_vvalue v[2];                                                                                                   \
    name##_pair(tile, 0, row, p, i, n, v);                                                                             \
    for (size_t k = 0; k < n; k++) {                                                                                   \
      if (inner)                                                                                                       \
        vv_put(v + k, out, i + k * SKF_LANES);                                                                         \
      else                                                                                                             \
        vv_store(by, v + k, out, i + k * SKF_LANES);                                                                   \
    }                                                                                                                  \
  }                                                                                                                    \
  static void name##_one(const skf_tile *tile, size_t n, const double *const p[3], double *const out[4]) {             \
    double *const to[4] = {out[0], out[1], out[2], out[3]};                                                            \
    const double *const in[3] = {p[0], p[1], p[2]};                                                                    \
    size_t i = 0;                                                                                                      \
    name##_row row;                                                                                                    \
    row_spread((skf_vd *)&row, sizeof row / sizeof(skf_vd), tile->column + SKF_TILE, 0);                               \
    for (; i + 2 * SKF_LANES <= n; i += 2 * SKF_LANES) name##_one_step(tile, &row, in, i, 2, to);                      \
    for (; i < n; i += SKF_LANES) name##_one_step(tile, &row, in, i, 1, to);                                           \
  }                                                                                                                    \
  SKF_INLINE void name##_add_step(const skf_tile *tile, const double *const p[3], size_t i, size_t n,                  \
                                  skf_batch_sum *sum, bool first) {                                                    \
    const double *const column = tile->column;                                                                         \
    const size_t count = tile->count;                                                                                  \
    skf_vvalue all[2], v[2];                                                                                           \
    for (size_t u = 0; u < n; u++) all[u] = (skf_vvalue){.F = vd_set(0)};                                              \
    for (size_t j = 0; j < count; j++) {                                                                               \
      const skf_vd strength = vd_set(column[j]);                                                                       \
      name##_row row;                                                                                                  \
      row_spread((skf_vd *)&row, sizeof row / sizeof(skf_vd), column + SKF_TILE, j);                                   \
      name##_pair(tile, j, &row, p, i, n, v);                                                                          \
      for (size_t k = 0; k < n; k++) {                                                                                 \
        all[k].F = vd_fma(strength, v[k].F, all[k].F);                                                                 \
        all[k].g = vd3_mad(all[k].g, strength, v[k].g);                                                                \
      }                                                                                                                \
    }                                                                                                                  \
    for (size_t u = 0; u < n; u++) sum_add(sum, i + u * SKF_LANES, all + u, first);                                    \
  }                                                                                                                    \
  static void name##_add(const skf_tile *tile, size_t n, const double *const p[3], skf_batch_sum *sum, bool first) {   \
    const double *const in[3] = {p[0], p[1], p[2]};                                                                    \
    size_t i = 0;                                                                                                      \
    for (; i + 2 * SKF_LANES <= n; i += 2 * SKF_LANES) name##_add_step(tile, in, i, 2, sum, first);                    \
    for (; i < n; i += SKF_LANES) name##_add_step(tile, in, i, 1, sum, first);                                         \
  }

/* From NAME_all, which sets values or adds to them: those of one element, and the sum of a tile's. */
#define SKF_BATCH_WHOLE(name)                                                                                          \
  static __attribute__((noinline)) void name##_one(const skf_tile *tile, size_t n, const double *const p[3],           \
                                                   double *const out[4]) {                                             \
    name##_all(tile, 0, NULL, n, p, out, false);                                                                       \
  }                                                                                                                    \
  static __attribute__((noinline)) void name##_more(const skf_tile *tile, size_t j, size_t n,                          \
                                                    const double *const p[3], double *const out[4]) {                  \
    name##_all(tile, j, NULL, n, p, out, true);                                                                        \
  }                                                                                                                    \
  static void name##_add(const skf_tile *tile, size_t n, const double *const p[3], skf_batch_sum *sum, bool first) {   \
    double all[4][SKF_BATCH], *const out[4] = {all[0], all[1], all[2], all[3]};                                        \
    name##_one(tile, n, p, out);                                                                                       \
    for (size_t j = 1; j < tile->count; j++) name##_more(tile, j, n, p, out);                                          \
    for (size_t i = 0; i < n; i += SKF_LANES) {                                                                        \
      const skf_vvalue v = {vd_load(all[0] + i), {vd_load(all[1] + i), vd_load(all[2] + i), vd_load(all[3] + i)}};     \
      sum_add(sum, i, &v, first);                                                                                      \
    }                                                                                                                  \
  }

SKF_INLINE void vd_keep(skf_vd v, double *to, bool more) { vd_store(to, more ? vd_load(to) + v : v); }

/* n vectors from i on, each by itself, with care where it needs it */
#define SKF_BATCH_APART(name)                                                                                          \
  static __attribute__((noinline)) void name##_apart(                                                                  \
      const skf_tile *tile, size_t j, size_t n, const double *const p[3], size_t i, double *const out[4], bool more) { \
    name##_row row;                                                                                                    \
    row_spread((skf_vd *)&row, sizeof row / sizeof(skf_vd), tile->column + SKF_TILE, j);                               \
    for (size_t end = i + n * SKF_LANES; i < end; i += SKF_LANES) {                                                    \
      const skf_v3d x = points_load(p, i);                                                                             \
      skf_vvalue v = name##_value(&row, x);                                                                            \
      if (!vi_all(v.good)) {                                                                                           \
        vv_take(&v, name##_again(&row, x));                                                                            \
        lanes_closed(tile->element + j, 0, true, &x, &v);                                                              \
      }                                                                                                                \
      if (more)                                                                                                        \
        vv_add((loop_factor){vd_set(1), vd_set(1)}, &v, out, i);                                                       \
      else                                                                                                             \
        vv_put(&v, out, i);                                                                                            \
    }                                                                                                                  \
  }

/* What the loops over one measure have in common: NAME_fast does all points but the last few */
#define SKF_BATCH_MEASURES(name, way)                                                                                  \
  SKF_BATCH_APART(name)                                                                                                \
  SKF_INLINE skf_vi name##_gauge(const name##_row *row, int mode, size_t n, const double *const p[3], size_t i,        \
                                 skf_vd *w) {                                                                          \
    skf_v3d x[4];                                                                                                      \
    SKF_EACH(u, n) x[u] = points_load(p, i + u * SKF_LANES);                                                           \
    return way##_gauge(row, mode, n, x, w);                                                                            \
  }                                                                                                                    \
  SKF_INLINE void name##_keep(const name##_row *row, size_t n, const double *const p[3], size_t i, const skf_vd *F,    \
                              const skf_vd *slope, double *const out[4], bool more) {                                  \
    (void)p;                                                                                                           \
    SKF_EACH(u, n) vd_keep(F[u], out[0] + i + u * SKF_LANES, more);                                                    \
    SKF_EACH(u, n)                                                                                                     \
    vd_keep(slope[u] * way##_along(row, x, p[0] + i + u * SKF_LANES), out[1] + i + u * SKF_LANES, more);               \
    SKF_EACH(u, n)                                                                                                     \
    vd_keep(slope[u] * way##_along(row, y, p[1] + i + u * SKF_LANES), out[2] + i + u * SKF_LANES, more);               \
    SKF_EACH(u, n)                                                                                                     \
    vd_keep(slope[u] * way##_along(row, z, p[2] + i + u * SKF_LANES), out[3] + i + u * SKF_LANES, more);               \
  }

#define SKF_BATCH_ALL(name, way)                                                                                       \
  /* element j at all points; out is set, or added to */                                                               \
  SKF_INLINE void name##_all(const skf_tile *tile, size_t j, const double *scale, size_t n, const double *const p[3],  \
                             double *const out[4], bool more) {                                                        \
    (void)scale;                                                                                                       \
    double *const to[4] = {out[0], out[1], out[2], out[3]};                                                            \
    const double *const in[3] = {p[0], p[1], p[2]};                                                                    \
    size_t i;                                                                                                          \
    name##_row row;                                                                                                    \
    row_spread((skf_vd *)&row, sizeof row / sizeof(skf_vd), tile->column + SKF_TILE, j);                               \
    const double *const from[3] = {way##_first(&row, in), in[1], in[2]};                                               \
    if (way##_mode(&row) == SKF_PLAIN)                                                                                 \
      i = name##_fast(tile, j, &row, SKF_PLAIN, n, in, from, to, more);                                                \
    else                                                                                                               \
      i = name##_fast(tile, j, &row, SKF_MIXED, n, in, from, to, more);                                                \
    if (i < n) name##_apart(tile, j, (n - i) / SKF_LANES, in, i, to, more);                                            \
  }                                                                                                                    \
  SKF_BATCH_WHOLE(name)

/* Four vectors at once; the next are measured, if early, while these wait for their own results */
#define SKF_BATCH_FOURS(name, way)                                                                                     \
  SKF_BATCH_MEASURES(name, way)                                                                                        \
  SKF_BATCH_BY_FOURS(name)                                                                                             \
  SKF_INLINE size_t name##_fast(const skf_tile *tile, size_t j, const name##_row *row, int mode, size_t n,             \
                                const double *const p[3], const double *const from[3], double *const out[4],           \
                                bool more) {                                                                           \
    return name##_fours(tile, j, row, mode, n, p, from, out, more, true);                                              \
  }                                                                                                                    \
  SKF_BATCH_ALL(name, way)

#define SKF_BATCH_BY_FOURS(name)                                                                                       \
  SKF_INLINE size_t name##_fours(const skf_tile *tile, size_t j, const name##_row *row, int mode, size_t n,            \
                                 const double *const p[3], const double *const from[3], double *const out[4],          \
                                 bool more, bool early) {                                                              \
    const size_t step = 4 * SKF_LANES;                                                                                 \
    size_t i = 0;                                                                                                      \
    skf_vd w[4], ahead[4], F[4], slope[4];                                                                             \
    if (n < step) return 0;                                                                                            \
    bool sure = early && vi_all(name##_gauge(row, mode, 4, from, 0, w));                                               \
    for (; i + step <= n; i += step) {                                                                                 \
      const size_t to = index_hide(i + 2 * step <= n ? i + step : i);                                                  \
      const bool next = early && vi_all(name##_gauge(row, mode, 4, from, to, ahead));                                  \
      i = index_hide(i);                                                                                               \
      if (!early) sure = vi_all(name##_gauge(row, mode, 4, from, i, w));                                               \
      if (__builtin_expect(vi_all(name##_of(row, 4, w, F, slope)) & sure, 1))                                          \
        name##_keep(row, 4, p, i, F, slope, out, more);                                                                \
      else                                                                                                             \
        name##_apart(tile, j, 4, p, i, out, more);                                                                     \
      if (!early) continue;                                                                                            \
      SKF_EACH(u, 4) w[u] = ahead[u];                                                                                  \
      sure = next;                                                                                                     \
    }                                                                                                                  \
    return i;                                                                                                          \
  }

/* One vector ends while five others are late, in the middle, begun and measured, these by twos: no chain of operations
   is then longer than what the processor looks ahead. Where measuring takes more, four at once. */
#define SKF_BATCH_ONE_BY_ONE(name, way)                                                                                \
  SKF_BATCH_MEASURES(name, way)                                                                                        \
  SKF_BATCH_BY_FOURS(name)                                                                                             \
  SKF_INLINE size_t name##_fast(const skf_tile *tile, size_t j, const name##_row *row, int mode, size_t n,             \
                                const double *const p[3], const double *const from[3], double *const out[4],           \
                                bool more) {                                                                           \
    const size_t step = SKF_LANES;                                                                                     \
    size_t i = 0;                                                                                                      \
    skf_vd w[2], next[2], F, slope;                                                                                    \
    name##_state begun, there, late;                                                                                   \
    if (mode == SKF_MIXED) return name##_fours(tile, j, row, mode, n, p, from, out, more, way##_early);                \
    if (n < 6 * step) return 0;                                                                                        \
    name##_gauge(row, mode, 2, from, 0, w);                                                                            \
    name##_begin(row, w[0], &late);                                                                                    \
    name##_middle(row, &late);                                                                                         \
    name##_late(row, &late);                                                                                           \
    name##_begin(row, w[1], &there);                                                                                   \
    name##_middle(row, &there);                                                                                        \
    name##_gauge(row, mode, 2, from, 2 * step, w);                                                                     \
    name##_begin(row, w[0], &begun);                                                                                   \
    name##_gauge(row, mode, 2, from, 4 * step, next);                                                                  \
    SKF_ROLLED for (; i + 2 * step <= n; i += 2 * step) {                                                              \
      SKF_EACH(u, 2) {                                                                                                 \
        const skf_vi good = name##_end(row, &late, &F, &slope);                                                        \
        late = there;                                                                                                  \
        name##_late(row, &late);                                                                                       \
        there = begun;                                                                                                 \
        name##_middle(row, &there);                                                                                    \
        name##_begin(row, u ? next[0] : w[1], &begun);                                                                 \
        if (u) {                                                                                                       \
          w[1] = next[1];                                                                                              \
          name##_gauge(row, mode, 2, from, index_hide(i + 8 * step <= n ? i + 6 * step : i), next);                    \
        }                                                                                                              \
        i = index_hide(i);                                                                                             \
        if (__builtin_expect(vi_all(good), 1))                                                                         \
          name##_keep(row, 1, p, i + u * step, &F, &slope, out, more);                                                 \
        else                                                                                                           \
          name##_apart(tile, j, 1, p, i + u * step, out, more);                                                        \
      }                                                                                                                \
    }                                                                                                                  \
    return i;                                                                                                          \
  }                                                                                                                    \
  SKF_BATCH_ALL(name, way)

static inline void batch_total(size_t n, const skf_batch_sum *sum, int k, double *out) {
  for (size_t i = 0; i < n; i += SKF_LANES) {
    skf_vd F = vd_load(sum->s[0] + i), s = vd_load(sum->s[k] + i), low = vd_load(sum->low[k] + i), zero = vd_set(0);
    skf_vd v = vd_select(s - s == zero, s + low, s), kept = k == 0 ? v : vd_select(F - F == zero, v, zero);
    if (n - i >= SKF_LANES)
      vd_store(out + i, kept);
    else
      memcpy(out + i, &kept, (n - i) * sizeof(double));
  }
}

/* Its row in the table of an instruction set */
#define SKF_BATCH_ENTRY(name)                                                                                          \
  [SKF_FORM_##name] = {sizeof(name##_row) / sizeof(skf_vd) + 1,                                                        \
                       name##_pack,                                                                                    \
                       name##_one,                                                                                     \
                       name##_add,                                                                                     \
                       name##_at,                                                                                      \
                       name##_lone,                                                                                    \
                       name##_quick,                                                                                   \
                       name##_inner},

#endif
