/* SPDX-License-Identifier: MIT */
/* What the vector forms share: their interface, their loops, vectors of three coordinates. Included by the translation
   unit of each instruction set and of each type of number: nothing here or in a form may assume four lanes or doubles.

   A form NAME has
     ROW_row                                            a struct of skf_vd (or skf_v3d) only: the element's constants
     double *ROW_pack(const skf_prepared *, double *)   writes the same constants in the same order, returns the end
     skf_vvalue NAME(const ROW_row *, skf_v3d x)        F and the gradient; straight code. The strength is not in them
                                                        unless the loops are for rows that have it
     SKF_BATCH_FORM(NAME, ROW, AGAIN)                   its loops
   and a line in batch_forms.h; forms of one shape may share a ROW. Each lane sees one element at one point: whether a
   row was broadcast (lanes are points) or loaded (lanes are elements) a form cannot know, so that all that depends on
   the element comes from the row.

   `good` tells the lanes whose value is as accurate as field.h promises. The others (next to the body, on singular
   sets, out of range, NaN) are evaluated again, the whole vector by AGAIN, of the same type as NAME, which takes more
   care, and what is still not good by the closed form. AGAIN may be skf_again_none. Neither may depend on other lanes:
   `if (vi_any(m))` may save work but must not change what a lane gets.

   A chain of a root, a division and a polynomial is longer than what the processor looks ahead. So two vectors are
   evaluated at once, which branches within NAME would hinder; and a long form may be cut where its roots, its quotients
   and its series are in flight, in
     void NAME_begin(const ROW_row *, skf_v3d x, NAME_state *)
     void ONE(const ROW_row *, NAME_state *)               and TWO, THREE, or skf_stage_none
     skf_vvalue NAME_end(const ROW_row *, const NAME_state *)
     SKF_BATCH_STAGED(NAME, ROW, AGAIN, ONE, TWO, THREE)
   AGAIN then sees the points whose lanes were not good, gathered in vectors of their own. */
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
/* a - s b */
SKF_INLINE skf_v3d vd3_less(skf_v3d a, skf_vd s, skf_v3d b) {
  return (skf_v3d){vd_fnma(s, b.x, a.x), vd_fnma(s, b.y, a.y), vd_fnma(s, b.z, a.z)};
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

/* R^2 - |d|^2 to an ulp or two of itself, d = x - at rounded. */
SKF_INLINE skf_vd power_exact(skf_vd R, skf_v3d x, skf_v3d at, skf_v3d d) {
  skf_v3d lo = vd3_lost(x, at, d);
  skf_vd R2 = R * R, pz = d.z * d.z, py = d.y * d.y, px = d.x * d.x, s = R2 - px, t = s - py, last = t - pz;
  skf_vd low = vd_fms(R, R, R2) + (vd_lost(R2, px, s) + vd_lost(s, py, t) + vd_lost(t, pz, last));
  low -= vd_fms(d.x, d.x, px) + vd_fms(d.y, d.y, py) + vd_fms(d.z, d.z, pz);
  return last + vd_fnma(vd_set(2), vd3_dot(d, lo), low);
}

/* (d + lo) b, |lo| < |d| ulp, to an ulp or two of itself */
SKF_INLINE skf_vd vd3_dot_exact(skf_v3d d, skf_v3d lo, skf_v3d b) {
  skf_vd px = d.x * b.x, py = d.y * b.y, pz = d.z * b.z, s = px + py, sum = s + pz;
  skf_vd low = vd_fms(d.x, b.x, px) + vd_fms(d.y, b.y, py) + vd_fms(d.z, b.z, pz);
  low += vd_lost(px, -py, s) + vd_lost(s, -pz, sum);
  return sum + (low + vd3_dot(lo, b));
}

SKF_INLINE skf_vvalue vv_scale(skf_vd s, skf_vvalue v) { return (skf_vvalue){s * v.F, vd3_scale(s, v.g), v.good}; }

/* For NAME_pack */
static inline double *pack1(double *k, double a) {
  *k = a;
  return k + 1;
}
/* The exponent of vd_exp2_product for exp(-a^2 w), rounded once */
static inline double *pack_exponent(double *k, double a) { return pack1(k, (double)(-1.4426950408889634074L * a * a)); }
static inline double *pack3(double *k, skf_vec3 a) { return pack1(pack1(pack1(k, a.x), a.y), a.z); }
/* The kernel's parameter, its square, 1 / both */
static inline double *pack_parameter(double *k, const skf_prepared *e) {
  double param = e->kernel.param, param2 = param * param;
  return pack1(pack1(pack1(pack1(k, param), param2), 1 / param), 1 / param2);
}

/* Gaussians h of squared distances w of which some are from `most` on, where vd_exp2_products is not accurate, but 0
   from `zero` on: the lanes that are good in all */
SKF_INLINE skf_vi vd_gaussian_far(skf_vd most, skf_vd zero, size_t n, const skf_vd *w, skf_vd *h) {
  skf_vi good = vi_set(-1);
  SKF_EACH(u, n) {
    const skf_vi inside = w[u] < most;
    h[u] = (skf_vd)((skf_vi)h[u] & inside);
    good &= inside | ((w[u] > zero) & (w[u] < vd_set(INFINITY)));
  }
  return good;
}

enum { SKF_FLIGHT = 16 };
#define SKF_ROLLED _Pragma("GCC unroll 1")

/* Element j's constants in all lanes */
SKF_INLINE void row_spread(skf_vd *row, size_t n, const double *column, size_t j) {
#pragma GCC unroll 128
  for (size_t k = 0; k < n; k++) row[k] = vd_set(column[k * SKF_TILE + j]);
}

#define skf_again_none(row, x) ((skf_vvalue){.good = vi_set(0)})

/* A form that is one function. */
#define SKF_BATCH_FORM(name, row_name, again)                                                                          \
  SKF_INLINE skf_vvalue name##_value(const row_name##_row *row, skf_v3d x) { return name(row, x); }                    \
  SKF_BATCH_COMMON(name, row_name, again, false)                                                                       \
  SKF_BATCH_PAIRS(name, false)

/* A form that depends on one measure of x alone, the strength in the row. WAY says which: `point`, the squared distance
   w from row->at, whence the gradient is along at - x; another has
     int WAY_mode(const ROW_row *)                      for a row in all lanes: SKF_PLAIN, or SKF_CAREFUL
     void WAY_measure(const ROW_row *, int mode, size_t n, const skf_v3d *x, skf_vd *w)     SKF_MIXED: lane by lane
     WAY_along(row, k, q)                               component k of the gradient's direction, q pointing at x.k
   and the form, of up to four vectors, stage after stage,
     skf_vi NAME_of(const ROW_row *, size_t n, const skf_vd *w, skf_vd *F, skf_vd *slope)
   which sets F and the factor of that direction and returns the lanes good in all. */
#define SKF_BATCH_MEASURED(name, row_name, way, again)                                                                 \
  SKF_INLINE skf_vvalue name##_value(const row_name##_row *row, skf_v3d x) {                                           \
    skf_vd w, F, slope;                                                                                                \
    way##_measure(row, SKF_MIXED, 1, &x, &w);                                                                          \
    const skf_vi good = name##_of(row, 1, &w, &F, &slope);                                                             \
    const skf_v3d along = {way##_along(row, x, &x.x), way##_along(row, y, &x.y), way##_along(row, z, &x.z)};           \
    return (skf_vvalue){F, vd3_scale(slope, along), good};                                                             \
  }                                                                                                                    \
  SKF_BATCH_COMMON(name, row_name, again, true)                                                                        \
  SKF_BATCH_FOURS(name, way)

SKF_INLINE skf_vd vd_there(const void *p) {
  skf_vd v;
  memcpy(&v, p, sizeof v);
  return v;
}
enum { SKF_MIXED, SKF_PLAIN, SKF_CAREFUL };
#define point_mode(row)                   SKF_PLAIN
#define point_measure(row, mode, n, x, w) ((void)(mode), squares_from((row)->at, n, x, w))
#define point_along(row, k, q)            ((row)->at.k - vd_there(q))
SKF_INLINE void squares_from(skf_v3d at, size_t n, const skf_v3d *x, skf_vd *w) {
  skf_vd d[4];
  SKF_EACH(u, n) d[u] = at.x - x[u].x, w[u] = d[u] * d[u];
  SKF_EACH(u, n) d[u] = at.y - x[u].y, w[u] = vd_fma(d[u], d[u], w[u]);
  SKF_EACH(u, n) d[u] = at.z - x[u].z, w[u] = vd_fma(d[u], d[u], w[u]);
}

/* A form in stages, SKF_FLIGHT vectors in each before the next: NAME_begin, three, NAME_end. */
#define SKF_BATCH_STAGED(name, row_name, again, one, two, three)                                                       \
  SKF_BATCH_STAGES_OF(name, row_name, again, false, SKF_APART, skf_stage_none, one, two, three, skf_stage_none)
/* The same, the strength in the row */
#define SKF_BATCH_SCALED(name, row_name, again, one, two, three)                                                       \
  SKF_BATCH_STAGES_OF(name, row_name, again, true, SKF_APART, skf_stage_none, one, two, three, skf_stage_none)
/* The strength in the row, where the last stage, all products, of some vectors shares a loop with one of the
   next that is all roots and quotients, so that the one multiplies while the other divides: NAME_begin, or ONE. */
#define SKF_BATCH_WOVEN(name, row_name, again, one, two, three)                                                        \
  SKF_BATCH_STAGES_OF(name, row_name, again, true, SKF_WITH_BEGIN, skf_stage_none, one, two, three, skf_stage_none)
#define SKF_BATCH_CROSSED(name, row_name, again, one, two, three)                                                      \
  SKF_BATCH_STAGES_OF(name, row_name, again, true, SKF_WITH_ONE, skf_stage_none, one, two, three, skf_stage_none)
/* The same with two stages more: LOOK before ONE, and GATHER, which is what shares its loop, before the last */
#define SKF_BATCH_LONG(name, row_name, again, look, one, two, three, gather)                                           \
  SKF_BATCH_STAGES_OF(name, row_name, again, true, SKF_GATHER_WITH_ONE, look, one, two, three, gather)
/* THREE and ONE together */
#define SKF_BATCH_LACED(name, row_name, again, one, two, three)                                                        \
  SKF_BATCH_STAGES_OF(name, row_name, again, true, SKF_THREE_WITH_ONE, skf_stage_none, one, two, three, skf_stage_none)
enum { SKF_APART, SKF_WITH_BEGIN, SKF_WITH_ONE, SKF_THREE_WITH_ONE, SKF_GATHER_WITH_ONE };
#define skf_stage_none(row, s) ((void)(row), (void)(s))

#define SKF_BATCH_STAGES_OF(name, row_name, again, inner, woven, look, one, two, three, gather)                        \
  SKF_INLINE skf_vvalue name##_value(const row_name##_row *row, skf_v3d x) {                                           \
    name##_state s;                                                                                                    \
    name##_begin(row, x, &s);                                                                                          \
    look(row, &s);                                                                                                     \
    one(row, &s);                                                                                                      \
    two(row, &s);                                                                                                      \
    three(row, &s);                                                                                                    \
    gather(row, &s);                                                                                                   \
    return name##_end(row, &s);                                                                                        \
  }                                                                                                                    \
  SKF_BATCH_COMMON(name, row_name, again, inner)                                                                       \
  SKF_BATCH_STAGES(name, woven, look, one, two, three, gather)

/* Of a long form there is one copy, that its loops call. */
#define SKF_OUTLINE static __attribute__((noinline))

#ifdef SKF_VEC_FLOAT
#include "field/batch_f32_loop.h"
#else

/* The constants of the elements from j on, one in each lane */
SKF_INLINE void row_load(skf_vd *row, size_t n, const double *column, size_t j) {
#pragma GCC unroll 128
  for (size_t k = 0; k < n; k++) row[k] = vd_load(column + k * SKF_TILE + j);
}

SKF_INLINE skf_v3d points_load(const double *const p[3], size_t i) {
  return (skf_v3d){vd_load(p[0] + i), vd_load(p[1] + i), vd_load(p[2] + i)};
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

SKF_INLINE void vv_put(const skf_vvalue *v, double *const out[4], size_t i) {
  vd_store(out[0] + i, v->F);
  vd_store(out[1] + i, v->g.x);
  vd_store(out[2] + i, v->g.y);
  vd_store(out[3] + i, v->g.z);
}
SKF_INLINE void vv_store(skf_vd strength, const skf_vvalue *v, double *const out[4], size_t i) {
  vd_store(out[0] + i, strength * v->F);
  vd_store(out[1] + i, strength * v->g.x);
  vd_store(out[2] + i, strength * v->g.y);
  vd_store(out[3] + i, strength * v->g.z);
}

/* For vectors some of whose lanes are not good: those are noted, the others kept. */
static inline size_t lanes_note(skf_vi good, size_t i, size_t *bad, size_t bads) {
  for (size_t k = 0; k < SKF_LANES; k++)
    if (!good[k]) bad[bads++] = i + k;
  return bads;
}
SKF_INLINE skf_vvalue vv_kept(const skf_vvalue *v) {
  const skf_vd zero = vd_set(0);
  return (skf_vvalue){vd_select(v->good, v->F, zero), vd3_select(v->good, v->g, (skf_v3d){zero, zero, zero}), v->good};
}

/* The points at[0], at[1], ..., the last one again in lanes from n on; values to where they belong */
static inline skf_v3d points_gather(const double *const p[3], const size_t *at, size_t n) {
  skf_v3d x;
  for (size_t k = 0; k < SKF_LANES; k++) {
    size_t i = at[k < n ? k : n - 1];
    x.x[k] = p[0][i], x.y[k] = p[1][i], x.z[k] = p[2][i];
  }
  return x;
}
static inline void vv_scatter(double strength, const skf_vvalue *v, double *const out[4], const size_t *at, size_t n,
                              bool more) {
  const skf_vd part[4] = {v->F, v->g.x, v->g.y, v->g.z};
  for (size_t k = 0; k < SKF_LANES && k < n; k++)
    for (int c = 0; c < 4; c++) out[c][at[k]] = more ? fma(strength, part[c][k], out[c][at[k]]) : strength * part[c][k];
}

SKF_INLINE void vd_more(double *to, skf_vd strength, skf_vd v) { vd_store(to, vd_fma(strength, v, vd_load(to))); }
SKF_INLINE void vv_add(skf_vd strength, const skf_vvalue *v, double *const out[4], size_t i) {
  vd_more(out[0] + i, strength, v->F);
  vd_more(out[1] + i, strength, v->g.x);
  vd_more(out[2] + i, strength, v->g.y);
  vd_more(out[3] + i, strength, v->g.z);
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
    skf_vvalue w = name##_again(&row, *x);                                                                             \
    v->F = vd_select(v->good, v->F, w.F);                                                                              \
    v->g = vd3_select(v->good, v->g, w.g);                                                                             \
    v->good |= w.good;                                                                                                 \
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
    skf_vvalue w = name##_again(&row, x);                                                                              \
    v->F = vd_select(v->good, v->F, w.F);                                                                              \
    v->g = vd3_select(v->good, v->g, w.g);                                                                             \
    v->good |= w.good;                                                                                                 \
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
    const skf_vd strength = vd_set(tile->column[0]);                                                                   \
    skf_vvalue v[2];                                                                                                   \
    name##_pair(tile, 0, row, p, i, n, v);                                                                             \
    for (size_t k = 0; k < n; k++) {                                                                                   \
      if (inner)                                                                                                       \
        vv_put(v + k, out, i + k * SKF_LANES);                                                                         \
      else                                                                                                             \
        vv_store(strength, v + k, out, i + k * SKF_LANES);                                                             \
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

SKF_INLINE void vd_keep(skf_vd v, double *to, bool more) { vd_store(to, more ? vd_load(to) + v : v); }

/* Four vectors at once */
#define SKF_BATCH_FOURS(name, way)                                                                                     \
  /* n vectors from i on, each by itself, with care where it needs it */                                               \
  static __attribute__((noinline)) void name##_apart(                                                                  \
      const skf_tile *tile, size_t j, size_t n, const double *const p[3], size_t i, double *const out[4], bool more) { \
    name##_row row;                                                                                                    \
    row_spread((skf_vd *)&row, sizeof row / sizeof(skf_vd), tile->column + SKF_TILE, j);                               \
    for (size_t end = i + n * SKF_LANES; i < end; i += SKF_LANES) {                                                    \
      const skf_v3d x = points_load(p, i);                                                                             \
      skf_vvalue v = name##_value(&row, x);                                                                            \
      if (!vi_all(v.good)) {                                                                                           \
        const skf_vvalue w = name##_again(&row, x);                                                                    \
        v.F = vd_select(v.good, v.F, w.F);                                                                             \
        v.g = vd3_select(v.good, v.g, w.g);                                                                            \
        v.good |= w.good;                                                                                              \
        lanes_closed(tile->element + j, 0, true, &x, &v);                                                              \
      }                                                                                                                \
      if (more)                                                                                                        \
        vv_add(vd_set(1), &v, out, i);                                                                                 \
      else                                                                                                             \
        vv_put(&v, out, i);                                                                                            \
    }                                                                                                                  \
  }                                                                                                                    \
  SKF_INLINE void name##_some(const skf_tile *tile, size_t j, const name##_row *row, int mode, size_t n,               \
                              const double *const p[3], size_t i, double *const out[4], bool more) {                   \
    skf_v3d x[4];                                                                                                      \
    skf_vd w[4], F[4], slope[4];                                                                                       \
    SKF_EACH(u, n) x[u] = points_load(p, i + u * SKF_LANES);                                                           \
    way##_measure(row, mode, n, x, w);                                                                                 \
    if (__builtin_expect(!vi_all(name##_of(row, n, w, F, slope)), 0)) {                                                \
      name##_apart(tile, j, n, p, i, out, more);                                                                       \
      return;                                                                                                          \
    }                                                                                                                  \
    SKF_EACH(u, n) vd_keep(F[u], out[0] + i + u * SKF_LANES, more);                                                    \
    SKF_EACH(u, n)                                                                                                     \
    vd_keep(slope[u] * way##_along(row, x, p[0] + i + u * SKF_LANES), out[1] + i + u * SKF_LANES, more);               \
    SKF_EACH(u, n)                                                                                                     \
    vd_keep(slope[u] * way##_along(row, y, p[1] + i + u * SKF_LANES), out[2] + i + u * SKF_LANES, more);               \
    SKF_EACH(u, n)                                                                                                     \
    vd_keep(slope[u] * way##_along(row, z, p[2] + i + u * SKF_LANES), out[3] + i + u * SKF_LANES, more);               \
  }                                                                                                                    \
  /* element j at all points; out is set, or added to */                                                               \
  SKF_INLINE void name##_all(const skf_tile *tile, size_t j, size_t n, const double *const p[3], double *const out[4], \
                             bool more) {                                                                              \
    double *const to[4] = {out[0], out[1], out[2], out[3]};                                                            \
    const double *const in[3] = {p[0], p[1], p[2]};                                                                    \
    size_t i = 0;                                                                                                      \
    name##_row row;                                                                                                    \
    row_spread((skf_vd *)&row, sizeof row / sizeof(skf_vd), tile->column + SKF_TILE, j);                               \
    const int mode = way##_mode(&row);                                                                                 \
    if (mode == SKF_PLAIN)                                                                                             \
      for (; i + 4 * SKF_LANES <= n; i += 4 * SKF_LANES) name##_some(tile, j, &row, SKF_PLAIN, 4, in, i, to, more);    \
    else                                                                                                               \
      for (; i + 4 * SKF_LANES <= n; i += 4 * SKF_LANES) name##_some(tile, j, &row, SKF_CAREFUL, 4, in, i, to, more);  \
    for (; i < n; i += SKF_LANES) name##_some(tile, j, &row, SKF_MIXED, 1, in, i, to, more);                           \
  }                                                                                                                    \
  static __attribute__((noinline)) void name##_one(const skf_tile *tile, size_t n, const double *const p[3],           \
                                                   double *const out[4]) {                                             \
    name##_all(tile, 0, n, p, out, false);                                                                             \
  }                                                                                                                    \
  static __attribute__((noinline)) void name##_more(const skf_tile *tile, size_t j, size_t n,                          \
                                                    const double *const p[3], double *const out[4]) {                  \
    name##_all(tile, j, n, p, out, true);                                                                              \
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

/* Stage after stage, for many vectors each: their chains of operations are short enough to overlap, and what is between
   waits in memory, so that few registers are needed. A stage best ends with its roots and quotients: what waits for
   them fills the scheduler. Nor is there a call in these loops, which would spill the constants. */
#define SKF_BATCH_STAGES(name, woven, look, one, two, three, gather)                                                   \
  /* some of the points by themselves, whatever lanes they came from */                                                \
  static                                                                                                               \
      __attribute__((noinline)) void name##_apart(const skf_tile *tile, size_t j, const double *const p[3],            \
                                                  const size_t *at, size_t count, double *const out[4], bool more) {   \
    name##_row row;                                                                                                    \
    row_spread((skf_vd *)&row, sizeof row / sizeof(skf_vd), tile->column + SKF_TILE, j);                               \
    for (size_t k = 0; k < count; k += SKF_LANES) {                                                                    \
      const skf_v3d x = points_gather(p, at + k, count - k);                                                           \
      skf_vvalue v = name##_again(&row, x);                                                                            \
      lanes_closed(tile->element + j, 0, name##_inner, &x, &v);                                                        \
      vv_scatter(tile->column[j], &v, out, at + k, count - k, more);                                                   \
    }                                                                                                                  \
  }                                                                                                                    \
  /* element j at all points; out is set, or added to */                                                               \
  SKF_INLINE void name##_stages(const skf_tile *tile, size_t j, size_t n, const double *const p[3],                    \
                                double *const out[4], const bool more) {                                               \
    double *const to[4] = {out[0], out[1], out[2], out[3]};                                                            \
    const double *const in[3] = {p[0], p[1], p[2]};                                                                    \
    const bool laced = (woven) == SKF_THREE_WITH_ONE, gathered = (woven) == SKF_GATHER_WITH_ONE;                       \
    const bool twofold = laced || gathered || (woven) == SKF_WITH_ONE;                                                 \
    const skf_vd strength = vd_set(tile->column[j]);                                                                   \
    name##_row row;                                                                                                    \
    name##_state room[(woven) >= SKF_WITH_ONE ? 2 : 1][SKF_FLIGHT], *old = room[0];                                    \
    row_spread((skf_vd *)&row, sizeof row / sizeof(skf_vd), tile->column + SKF_TILE, j);                               \
    size_t last = 0, next = 0, bad[(SKF_FLIGHT + 1) * SKF_LANES], bads = 0;                                            \
    do {                                                                                                               \
      const size_t flying = (next - last) / SKF_LANES, left = (n - next) / SKF_LANES;                                  \
      const size_t m = left < SKF_FLIGHT ? left : SKF_FLIGHT, both = flying < m ? flying : m;                          \
      double *const there[4] = {to[0] + last, to[1] + last, to[2] + last, to[3] + last};                               \
      const double *const here[3] = {in[0] + next, in[1] + next, in[2] + next};                                        \
      name##_state *const s = twofold && old == room[0] ? room[1] : room[0];                                           \
      if (twofold) {                                                                                                   \
        SKF_ROLLED for (size_t u = 0; u < m; u++) name##_begin(&row, points_load(here, u *SKF_LANES), s + u);          \
      }                                                                                                                \
      if (gathered) {                                                                                                  \
        SKF_ROLLED for (size_t u = 0; u < m; u++) look(&row, s + u);                                                   \
        SKF_ROLLED for (size_t u = 0; u < both; u++) {                                                                 \
          gather(&row, old + u);                                                                                       \
          one(&row, s + u);                                                                                            \
        }                                                                                                              \
        SKF_ROLLED for (size_t u = both; u < flying; u++) gather(&row, old + u);                                       \
      }                                                                                                                \
      if (laced) {                                                                                                     \
        SKF_ROLLED for (size_t u = 0; u < both; u++) {                                                                 \
          one(&row, s + u);                                                                                            \
          three(&row, old + u);                                                                                        \
        }                                                                                                              \
        SKF_ROLLED for (size_t u = both; u < flying; u++) three(&row, old + u);                                        \
      }                                                                                                                \
      SKF_ROLLED for (size_t u = 0; u < flying; u++) {                                                                 \
        skf_vvalue v = name##_end(&row, old + u);                                                                      \
        if (__builtin_expect(!vi_all(v.good), 0)) {                                                                    \
          bads = lanes_note(v.good, last + u * SKF_LANES, bad, bads);                                                  \
          if (more) v = vv_kept(&v);                                                                                   \
        }                                                                                                              \
        if (more)                                                                                                      \
          vv_add(strength, &v, there, u *SKF_LANES);                                                                   \
        else if (name##_inner)                                                                                         \
          vv_put(&v, there, u *SKF_LANES);                                                                             \
        else                                                                                                           \
          vv_store(strength, &v, there, u *SKF_LANES);                                                                 \
        if ((woven) == SKF_WITH_BEGIN && u < m) name##_begin(&row, points_load(here, u *SKF_LANES), s + u);            \
        if ((woven) == SKF_WITH_ONE && u < m) one(&row, s + u);                                                        \
      }                                                                                                                \
      if (!twofold) {                                                                                                  \
        SKF_ROLLED for (size_t u = (woven) == SKF_WITH_BEGIN ? flying : 0; u < m; u++)                                 \
            name##_begin(&row, points_load(here, u *SKF_LANES), s + u);                                                \
      }                                                                                                                \
      SKF_ROLLED for (size_t u = twofold ? both : 0; u < m; u++) one(&row, s + u);                                     \
      SKF_ROLLED for (size_t u = 0; u < m; u++) two(&row, s + u);                                                      \
      if (!laced) { SKF_ROLLED for (size_t u = 0; u < m; u++) three(&row, s + u); }                                    \
      if (bads >= SKF_LANES || (bads > 0 && m == 0)) {                                                                 \
        const size_t most = m == 0 ? bads : bads / SKF_LANES * SKF_LANES;                                              \
        name##_apart(tile, j, in, bad, most, to, more);                                                                \
        bads -= most;                                                                                                  \
        for (size_t k = 0; k < bads; k++) bad[k] = bad[most + k];                                                      \
      }                                                                                                                \
      last = next, next += m * SKF_LANES, old = s;                                                                     \
    } while (last < next);                                                                                             \
  }                                                                                                                    \
  static __attribute__((noinline)) void name##_one(const skf_tile *tile, size_t n, const double *const p[3],           \
                                                   double *const out[4]) {                                             \
    name##_stages(tile, 0, n, p, out, false);                                                                          \
  }                                                                                                                    \
  static __attribute__((noinline)) void name##_more(const skf_tile *tile, size_t j, size_t n,                          \
                                                    const double *const p[3], double *const out[4]) {                  \
    name##_stages(tile, j, n, p, out, true);                                                                           \
  }                                                                                                                    \
  static void name##_add(const skf_tile *tile, size_t n, const double *const p[3], skf_batch_sum *sum, bool first) {   \
    double all[4][SKF_BATCH], *const out[4] = {all[0], all[1], all[2], all[3]};                                        \
    for (int k = 0; k < 4; k++) memset(all[k], 0, n * sizeof(double));                                                 \
    for (size_t j = 0; j < tile->count; j++) name##_more(tile, j, n, p, out);                                          \
    for (size_t i = 0; i < n; i += SKF_LANES) {                                                                        \
      const skf_vvalue v = {vd_load(all[0] + i), {vd_load(all[1] + i), vd_load(all[2] + i), vd_load(all[3] + i)}};     \
      sum_add(sum, i, &v, first);                                                                                      \
    }                                                                                                                  \
  }

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
#endif
