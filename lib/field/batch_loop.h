/* SPDX-License-Identifier: MIT */
/* What the vector forms share: a result, and the loop over the points. Included by the translation unit of each
   instruction set. */
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
SKF_INLINE skf_v3d vd3_set(skf_vec3 a) { return (skf_v3d){vd_set(a.x), vd_set(a.y), vd_set(a.z)}; }
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

SKF_INLINE size_t vv_keep(const skf_vvalue *v, size_t i, double *const out[4], unsigned char *redo, size_t count) {
  vd_store(out[0] + i, v->F);
  vd_store(out[1] + i, v->g.x);
  vd_store(out[2] + i, v->g.y);
  vd_store(out[3] + i, v->g.z);
  int bad = ~vi_bits(v->good) & 15;
  for (; bad; bad &= bad - 1) redo[count++] = (unsigned char)(i + (size_t)__builtin_ctz((unsigned)bad));
  return count;
}

/* batch_total, which the compiler does not vectorise. */
static void batch_vector_total(size_t n, const skf_batch_sum *sum, int k, double *out) {
  for (size_t i = 0; i < n; i += SKF_LANES) {
    skf_vd F = vd_load(sum->s[0] + i), s = vd_load(sum->s[k] + i), low = vd_load(sum->low[k] + i), zero = vd_set(0);
    skf_vd v = vd_select(s - s == zero, s + low, s), kept = k == 0 ? v : vd_select(F - F == zero, v, zero);
    if (n - i >= SKF_LANES)
      vd_store(out + i, kept);
    else
      memcpy(out + i, &kept, (n - i) * sizeof(double));
  }
}

/* Defines batch_NAME from NAME(const skf_prepared *, skf_v3d) -> skf_vvalue. */
#define SKF_BATCH_LOOP(name)                                                                                           \
  static size_t batch_##name(const skf_prepared *e, size_t n, const double *const p[3], double *const out[4],          \
                             unsigned char *redo) {                                                                    \
    const skf_prepared here = *e; /* no store below can change it */                                                   \
    size_t count = 0;                                                                                                  \
    for (size_t i = 0; i < n; i += SKF_LANES) {                                                                        \
      skf_vvalue v = name(&here, (skf_v3d){vd_load(p[0] + i), vd_load(p[1] + i), vd_load(p[2] + i)});                  \
      count = vv_keep(&v, i, out, redo, count);                                                                        \
    }                                                                                                                  \
    return count;                                                                                                      \
  }

#endif
