/* SPDX-License-Identifier: MIT */
/* What the vector forms share: their interface, their loops, vectors of three coordinates. Included by the translation
   unit of each instruction set and of each type of number: nothing here or in a form may assume four lanes or doubles.

   A form NAME has
     ROW_row                                            a struct of skf_vd (or skf_v3d) only: the element's constants
     double *ROW_pack(const skf_prepared *, double *)   writes the same constants in the same order, returns the end
     skf_vvalue NAME(const ROW_row *, skf_v3d x)        F and the gradient, strength not in them; straight code
     SKF_BATCH_FORM(NAME, ROW, AGAIN)                   its loops
   and a line in batch_forms.h; forms of one shape may share a ROW. Each lane sees one element at one point: whether a
   row was broadcast (lanes are points) or loaded (lanes are elements) a form cannot know, so that all that depends on
   the element comes from the row. `good` tells the lanes whose value is as accurate as field.h promises. The others
   (next to the body, on singular sets, out of range, NaN) are evaluated again, the whole vector by AGAIN, of the same
   type as NAME, which takes more care, and what is still not good by the closed form. AGAIN may be skf_again_none.
   Neither may depend on other lanes: `if (vi_any(m))` may save work but must not change what a lane gets. Two vectors
   are evaluated at once, so that their chains fill each other's gaps: branches within NAME would keep them apart. */
#ifndef SKF_FIELD_BATCH_LOOP_H
#define SKF_FIELD_BATCH_LOOP_H

#include "field/batch.h"
#include "simd/vecmath.h"

typedef struct skf_v3d {
  skf_vd x, y, z;
} skf_v3d;

/* good: the lanes whose value may be kept */
typedef struct skf_vvalue {
  skf_vd F;
  skf_v3d g;
  skf_vi good;
} skf_vvalue;

SKF_INLINE skf_vd vd3_dot(skf_v3d a, skf_v3d b) { return vd_fma(a.z, b.z, vd_fma(a.y, b.y, a.x * b.x)); }
SKF_INLINE skf_v3d vd3_sub(skf_v3d a, skf_v3d b) { return (skf_v3d){a.x - b.x, a.y - b.y, a.z - b.z}; }
SKF_INLINE skf_v3d vd3_add(skf_v3d a, skf_v3d b) { return (skf_v3d){a.x + b.x, a.y + b.y, a.z + b.z}; }
SKF_INLINE skf_v3d vd3_scale(skf_vd s, skf_v3d a) { return (skf_v3d){s * a.x, s * a.y, s * a.z}; }
/* a + s b */
SKF_INLINE skf_v3d vd3_mad(skf_v3d a, skf_vd s, skf_v3d b) {
  return (skf_v3d){vd_fma(s, b.x, a.x), vd_fma(s, b.y, a.y), vd_fma(s, b.z, a.z)};
}
SKF_INLINE skf_v3d vd3_select(skf_vi m, skf_v3d a, skf_v3d b) {
  return (skf_v3d){vd_select(m, a.x, b.x), vd_select(m, a.y, b.y), vd_select(m, a.z, b.z)};
}

/* a b - c d to an ulp or two [Kahan] */
SKF_INLINE skf_vd vd_det2(skf_vd a, skf_vd b, skf_vd c, skf_vd d) {
  skf_vd q = c * d;
  return vd_fms(a, b, q) + vd_fnma(c, d, q);
}
SKF_INLINE skf_v3d vd3_cross(skf_v3d a, skf_v3d b) {
  return (skf_v3d){vd_det2(a.y, b.z, a.z, b.y), vd_det2(a.z, b.x, a.x, b.z), vd_det2(a.x, b.y, a.y, b.x)};
}

/* The rounding error of s = a - b [Knuth] */
SKF_INLINE skf_vd vd_lost(skf_vd a, skf_vd b, skf_vd s) {
  skf_vd t = s - a;
  return (a - (s - t)) - (b + t);
}
SKF_INLINE skf_v3d vd3_lost(skf_v3d a, skf_v3d b, skf_v3d s) {
  return (skf_v3d){vd_lost(a.x, b.x, s.x), vd_lost(a.y, b.y, s.y), vd_lost(a.z, b.z, s.z)};
}

/* For NAME_pack */
static inline double *pack1(double *k, double a) {
  *k = a;
  return k + 1;
}
static inline double *pack3(double *k, skf_vec3 a) { return pack1(pack1(pack1(k, a.x), a.y), a.z); }

/* Element j's constants in all lanes */
SKF_INLINE void row_spread(skf_vd *row, size_t n, const double *column, size_t j) {
#pragma GCC unroll 128
  for (size_t k = 0; k < n; k++) row[k] = vd_set(column[k * SKF_TILE + j]);
}

SKF_INLINE skf_v3d points_load(const double *const p[3], size_t i) {
  return (skf_v3d){vd_load(p[0] + i), vd_load(p[1] + i), vd_load(p[2] + i)};
}

/* The lanes of v that are not good, by the closed form; v has no strength in it. */
static inline void lanes_closed(const skf_prepared *e, const skf_v3d *x, skf_vvalue *v) {
  for (int i = 0; i < SKF_LANES; i++) {
    skf_value c = {.F = 0};
    if (v->good[i]) continue;
    skf_element_value(e, v3(x->x[i], x->y[i], x->z[i]), 1, &c);
    bool finite = c.F - c.F == 0;
    v->F[i] = c.F, v->g.x[i] = finite ? c.g.x : 0, v->g.y[i] = finite ? c.g.y : 0, v->g.z[i] = finite ? c.g.z : 0;
  }
}

/* *sum += v, the rounding error kept exactly [Knuth] */
SKF_INLINE void sum_column(skf_batch_sum *sum, int k, size_t i, skf_vd v, bool first) {
  skf_vd a = first ? vd_set(0) : vd_load(sum->s[k] + i), low = first ? vd_set(0) : vd_load(sum->low[k] + i);
  skf_vd s = a + v, t = s - a;
  vd_store(sum->s[k] + i, s);
  vd_store(sum->low[k] + i, low + ((a - (s - t)) + (v - t)));
}

/* Vectors at once. */
enum { SKF_FLIGHT = 2 };

#define skf_again_none(row, x) ((skf_vvalue){.good = vi_set(0)})

#define SKF_BATCH_FORM(name, row_name, again)                                                                          \
  typedef row_name##_row name##_row;                                                                                   \
  static double *name##_pack(const skf_prepared *e, double *k) { return row_name##_pack(e, k); }                       \
  static __attribute__((noinline, cold)) void name##_redo(const skf_tile *tile, size_t j, const skf_v3d *x,            \
                                                          skf_vvalue *v) {                                             \
    name##_row row;                                                                                                    \
    row_spread((skf_vd *)&row, sizeof row / sizeof(skf_vd), tile->column + SKF_TILE, j);                               \
    skf_vvalue w = again(&row, *x);                                                                                    \
    v->F = vd_select(v->good, v->F, w.F);                                                                              \
    v->g = vd3_select(v->good, v->g, w.g);                                                                             \
    v->good |= w.good;                                                                                                 \
    lanes_closed(tile->element[j], x, v);                                                                              \
  }                                                                                                                    \
  /* SKF_FLIGHT vectors of points from i on */                                                                         \
  SKF_INLINE void name##_step(const skf_tile *tile, size_t j, const name##_row *row, const skf_v3d *x,                 \
                              skf_vvalue *v) {                                                                         \
    skf_vi good = vi_set(-1);                                                                                          \
    for (int u = 0; u < SKF_FLIGHT; u++) v[u] = name(row, x[u]), good &= v[u].good;                                    \
    if (__builtin_expect(vi_bits(~good) == 0, 1)) return;                                                              \
    for (int u = 0; u < SKF_FLIGHT; u++) {                                                                             \
      skf_v3d at = x[u];                                                                                               \
      skf_vvalue w = v[u];                                                                                             \
      name##_redo(tile, j, &at, &w);                                                                                   \
      v[u] = w;                                                                                                        \
    }                                                                                                                  \
  }                                                                                                                    \
  static void name##_one(const skf_tile *tile, size_t n, const double *const p[3], double *const out[4]) {             \
    double *const F = out[0], *const gx = out[1], *const gy = out[2], *const gz = out[3];                              \
    const double *const in[3] = {p[0], p[1], p[2]};                                                                    \
    name##_row row;                                                                                                    \
    row_spread((skf_vd *)&row, sizeof row / sizeof(skf_vd), tile->column + SKF_TILE, 0);                               \
    const skf_vd strength = vd_set(tile->column[0]);                                                                   \
    for (size_t i = 0; i < n; i += SKF_FLIGHT * SKF_LANES) {                                                           \
      skf_v3d x[SKF_FLIGHT];                                                                                           \
      skf_vvalue v[SKF_FLIGHT];                                                                                        \
      for (size_t u = 0; u < SKF_FLIGHT; u++) x[u] = points_load(in, i + u * SKF_LANES);                               \
      name##_step(tile, 0, &row, x, v);                                                                                \
      for (size_t u = 0; u < SKF_FLIGHT; u++) {                                                                        \
        size_t at = i + u * SKF_LANES;                                                                                 \
        vd_store(F + at, strength * v[u].F);                                                                           \
        vd_store(gx + at, strength * v[u].g.x);                                                                        \
        vd_store(gy + at, strength * v[u].g.y);                                                                        \
        vd_store(gz + at, strength * v[u].g.z);                                                                        \
      }                                                                                                                \
    }                                                                                                                  \
  }                                                                                                                    \
  static void name##_add(const skf_tile *tile, size_t n, const double *const p[3], skf_batch_sum *sum, bool first) {   \
    const double *const in[3] = {p[0], p[1], p[2]}, *const column = tile->column;                                      \
    const size_t count = tile->count;                                                                                  \
    for (size_t i = 0; i < n; i += SKF_FLIGHT * SKF_LANES) {                                                           \
      skf_v3d x[SKF_FLIGHT];                                                                                           \
      skf_vvalue v[SKF_FLIGHT], all[SKF_FLIGHT];                                                                       \
      for (size_t u = 0; u < SKF_FLIGHT; u++) {                                                                        \
        x[u] = points_load(in, i + u * SKF_LANES);                                                                     \
        all[u] = (skf_vvalue){.F = vd_set(0), .g = {vd_set(0), vd_set(0), vd_set(0)}};                                 \
      }                                                                                                                \
      for (size_t j = 0; j < count; j++) {                                                                             \
        name##_row row;                                                                                                \
        row_spread((skf_vd *)&row, sizeof row / sizeof(skf_vd), column + SKF_TILE, j);                                 \
        const skf_vd strength = vd_set(column[j]);                                                                     \
        name##_step(tile, j, &row, x, v);                                                                              \
        for (size_t u = 0; u < SKF_FLIGHT; u++) {                                                                      \
          all[u].F = vd_fma(strength, v[u].F, all[u].F);                                                               \
          all[u].g = vd3_mad(all[u].g, strength, v[u].g);                                                              \
        }                                                                                                              \
      }                                                                                                                \
      for (size_t u = 0; u < SKF_FLIGHT; u++) {                                                                        \
        size_t at = i + u * SKF_LANES;                                                                                 \
        sum_column(sum, 0, at, all[u].F, first);                                                                       \
        sum_column(sum, 1, at, all[u].g.x, first);                                                                     \
        sum_column(sum, 2, at, all[u].g.y, first);                                                                     \
        sum_column(sum, 3, at, all[u].g.z, first);                                                                     \
      }                                                                                                                \
    }                                                                                                                  \
  }

static void batch_total(size_t n, const skf_batch_sum *sum, int k, double *out) {
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
  [SKF_FORM_##name] = {sizeof(name##_row) / sizeof(skf_vd) + 1, name##_pack, name##_one, name##_add},

#endif
