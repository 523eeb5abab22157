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

/* Where v is not good, w. */
SKF_INLINE void vv_take(skf_vvalue *v, skf_vvalue w) {
  v->F = vd_select(v->good, v->F, w.F);
  v->g = vd3_select(v->good, v->g, w.g);
  v->good |= w.good;
}

SKF_INLINE skf_vvalue vv_scale(skf_vd s, skf_vvalue v) { return (skf_vvalue){s * v.F, vd3_scale(s, v.g), v.good}; }

/* For NAME_pack */
static inline double *pack1(double *k, double a) {
  *k = a;
  return k + 1;
}
/* The exponent c of 2^(c w) = exp(-a^2 w), rounded once; and what that loses behind it */
static inline long double exponent_of(double a) { return -1.4426950408889634074L * a * a; }
static inline double *pack_exponent(double *k, double a) { return pack1(k, (double)exponent_of(a)); }
static inline double *pack_exponent_low(double *k, double a) {
  const long double c = exponent_of(a);
  return pack1(pack_exponent(k, a), (double)(c - (double)c));
}
static inline double *pack3(double *k, skf_vec3 a) { return pack1(pack1(pack1(k, a.x), a.y), a.z); }
/* The kernel's parameter, its square, 1 / both */
static inline double *pack_parameter(double *k, const skf_prepared *e) {
  double param = e->kernel.param, param2 = param * param;
  return pack1(pack1(pack1(pack1(k, param), param2), 1 / param), 1 / param2);
}

/* Below a bound, all of these numbers, which are not negative, are, too: fewer steps than to compare each */
SKF_INLINE skf_vd vd_total(size_t n, const skf_vd *w) {
  skf_vd all = w[0];
  for (size_t u = 1; u < n; u++) all += w[u];
  return all;
}

/* Gaussians 2^(c x), c x <= 0: the lanes that are near enough, and those so far that nothing is left. */
SKF_INLINE skf_vi vd_gaussian_near(const skf_vpower *e) {
  return e->whole > vd_set(VD_EXP2_SHIFT) + vd_set(SKF_PICK(-1009, -123));
}
SKF_INLINE skf_vi vd_gaussian_gone(skf_vd c, skf_vd x) {
  const skf_vd y = c * x;
  return (y < vd_set(SKF_PICK(-1155, -160))) & (y > vd_set(-INFINITY));
}

#ifdef SKF_VEC_FLOAT
/* About points in floats 2^lift times that, and 0 beyond; shift: VD_EXP2_SHIFT + lift. Good unless infinite or NaN. */
SKF_INLINE skf_vpower vd_gaussian_begin(skf_vd c, skf_vd x, skf_vd shift) {
  const skf_vd whole = vd_fma(c, x, shift);
  return (skf_vpower){whole, vd_fms(c, x, whole - shift), vd_set(0)};
}
SKF_INLINE skf_vi vd_gaussian_end(const skf_vpower *e, skf_vd *h) {
  *h = (skf_vd)((skf_vi)vd_exp2_end(e) & (e->whole > vd_set(VD_EXP2_SHIFT - 125)));
  return e->whole > vd_set(-INFINITY);
}
#else
SKF_INLINE skf_vi vd_gaussian_end(const skf_vpower *e, skf_vd *h) {
  *h = vd_exp2_end(e);
  return vd_gaussian_near(e);
}
#endif

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
     int WAY_mode(const ROW_row *)                      for a row in all lanes: SKF_PLAIN, or SKF_MIXED
     skf_vd WAY_measure(const ROW_row *, skf_v3d x)     whatever the rows
     skf_vi WAY_gauge(const ROW_row *, int mode, size_t n, const skf_v3d *x, skf_vd *w)     the same; the lanes where no
                                                                                            vector takes more care
     WAY_first(row, p)                                  for SKF_PLAIN, which coordinates WAY_gauge sees as x; for all
                                                        others p[0]
     WAY_early                                          whether four vectors are measured before the last four end
     WAY_along(row, k, q)                               component k of the gradient's direction, q pointing at x.k
   and the form, of up to four vectors, stage after stage,
     skf_vi NAME_of(const ROW_row *, size_t n, const skf_vd *w, skf_vd *F, skf_vd *slope)
   which sets F and the factor of that direction and returns the lanes good in all; never of a NaN. */
#define SKF_BATCH_MEASURED(name, row_name, way, again)                                                                 \
  SKF_BATCH_ALONG(name, row_name, way, again)                                                                          \
  SKF_BATCH_FOURS(name, way)

#define SKF_BATCH_ALONG(name, row_name, way, again)                                                                    \
  SKF_INLINE skf_vvalue name##_value(const row_name##_row *row, skf_v3d x) {                                           \
    const skf_vd w = way##_measure(row, x);                                                                            \
    skf_vd F, slope;                                                                                                   \
    const skf_vi good = name##_of(row, 1, &w, &F, &slope);                                                             \
    const skf_v3d along = {way##_along(row, x, &x.x), way##_along(row, y, &x.y), way##_along(row, z, &x.z)};           \
    return (skf_vvalue){F, vd3_scale(slope, along), good};                                                             \
  }                                                                                                                    \
  SKF_BATCH_COMMON(name, row_name, again, true)

/* The same where its chain of operations is long, in four parts, so that a loop works on as many vectors at once:
     void NAME_begin(const ROW_row *, skf_vd w, NAME_state *)
     void NAME_middle(const ROW_row *, NAME_state *)                                        and NAME_late
     skf_vi NAME_end(const ROW_row *, const NAME_state *, skf_vd *F, skf_vd *slope)         the lanes that are good */
#define SKF_BATCH_PIPED(name, row_name, way, again)                                                                    \
  SKF_INLINE skf_vi name##_of(const row_name##_row *row, size_t n, const skf_vd *w, skf_vd *F, skf_vd *slope) {        \
    name##_state s[4];                                                                                                 \
    skf_vi good = vi_set(-1);                                                                                          \
    SKF_EACH(u, n) name##_begin(row, w[u], s + u);                                                                     \
    SKF_EACH(u, n) name##_middle(row, s + u);                                                                          \
    SKF_EACH(u, n) name##_late(row, s + u);                                                                            \
    SKF_EACH(u, n) good &= name##_end(row, s + u, F + u, slope + u);                                                   \
    return good;                                                                                                       \
  }                                                                                                                    \
  SKF_BATCH_ALONG(name, row_name, way, again)                                                                          \
  SKF_BATCH_ONE_BY_ONE(name, way)

SKF_INLINE skf_vd vd_there(const void *p) {
  skf_vd v;
  memcpy(&v, p, sizeof v);
  return v;
}
enum { SKF_MIXED, SKF_PLAIN };
#define point_early                     true
#define point_mode(row)                 SKF_PLAIN
#define point_gauge(row, mode, n, x, w) ((void)(mode), squares_from((row)->at, n, x, w), vi_set(-1))
#define point_first(row, p)             ((p)[0])
#define point_along(row, k, q)          ((row)->at.k - vd_there(q))
SKF_INLINE void squares_from(skf_v3d at, size_t n, const skf_v3d *x, skf_vd *w) {
  skf_vd d[4];
  SKF_EACH(u, n) d[u] = at.x - x[u].x, w[u] = d[u] * d[u];
  SKF_EACH(u, n) d[u] = at.y - x[u].y, w[u] = vd_fma(d[u], d[u], w[u]);
  SKF_EACH(u, n) d[u] = at.z - x[u].z, w[u] = vd_fma(d[u], d[u], w[u]);
}
SKF_INLINE skf_vd square_from(skf_v3d at, skf_v3d x) {
  skf_vd w;
  squares_from(at, 1, &x, &w);
  return w;
}
#define point_measure(row, x) square_from((row)->at, x)

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

/* What an element's F and gradient are multiplied with */
typedef struct loop_factor {
  skf_vd F, g;
} loop_factor;

/* The compiler does not see that this is i, and keeps one index for all rows instead of an address for each. */
SKF_INLINE size_t index_hide(size_t i) {
  __asm__("" : "+r"(i));
  return i;
}

SKF_INLINE skf_v3d points_load(const skf_real *const p[3], size_t i) {
  return (skf_v3d){vd_load(p[0] + i), vd_load(p[1] + i), vd_load(p[2] + i)};
}

SKF_INLINE void vv_put(const skf_vvalue *v, skf_real *const out[4], size_t i) {
  vd_store(out[0] + i, v->F);
  vd_store(out[1] + i, v->g.x);
  vd_store(out[2] + i, v->g.y);
  vd_store(out[3] + i, v->g.z);
}
SKF_INLINE void vv_store(loop_factor by, const skf_vvalue *v, skf_real *const out[4], size_t i) {
  vd_store(out[0] + i, by.F * v->F);
  vd_store(out[1] + i, by.g * v->g.x);
  vd_store(out[2] + i, by.g * v->g.y);
  vd_store(out[3] + i, by.g * v->g.z);
}

SKF_INLINE void vd_more(skf_real *to, skf_vd factor, skf_vd v) { vd_store(to, vd_fma(factor, v, vd_load(to))); }
SKF_INLINE void vv_add(loop_factor by, const skf_vvalue *v, skf_real *const out[4], size_t i) {
  vd_more(out[0] + i, by.F, v->F);
  vd_more(out[1] + i, by.g, v->g.x);
  vd_more(out[2] + i, by.g, v->g.y);
  vd_more(out[3] + i, by.g, v->g.z);
}

#ifdef SKF_VEC_FLOAT
#include "field/batch_f32_loop.h"
#else
#include "field/batch_f64_loop.h"
#endif
#include "field/batch_stage_loop.h"

#endif
