/* SPDX-License-Identifier: MIT */
/* Four doubles side by side. Every operation is one correctly rounded IEEE operation per lane, so that the AVX2 form
   and the plain form give the same bits; products are fused with sums only where vd_fma says so. */
#ifndef SKF_SIMD_VEC_H
#define SKF_SIMD_VEC_H

#include <math.h>
#include <stdbool.h>
#include <string.h>
#if defined(__AVX2__) && defined(__FMA__)
#include <immintrin.h>
#else
#pragma GCC diagnostic ignored "-Wpsabi" /* all is inline: no ABI */
#endif

enum { SKF_LANES = 4 };

typedef double skf_vd __attribute__((vector_size(32)));
typedef long long skf_vi __attribute__((vector_size(32))); /* also a mask: 0 or -1 in each lane */

#define SKF_INLINE static inline __attribute__((always_inline))

SKF_INLINE skf_vd vd_set(double a) { return (skf_vd){a, a, a, a}; }
SKF_INLINE skf_vi vi_set(long long a) { return (skf_vi){a, a, a, a}; }

SKF_INLINE skf_vd vd_load(const double *p) {
  skf_vd v;
  memcpy(&v, p, sizeof v);
  return v;
}

SKF_INLINE void vd_store(double *p, skf_vd v) { memcpy(p, &v, sizeof v); }

/* The sign bit stays out of |a|; vd_sign(a) keeps nothing else. */
SKF_INLINE skf_vi vd_sign(skf_vd a) { return (skf_vi)a & vi_set((long long)0x8000000000000000u); }
SKF_INLINE skf_vd vd_abs(skf_vd a) { return (skf_vd)((skf_vi)a & vi_set(0x7fffffffffffffff)); }

#if defined(__AVX2__) && defined(__FMA__)
/* a b + c, rounded once */
SKF_INLINE skf_vd vd_fma(skf_vd a, skf_vd b, skf_vd c) {
  return (skf_vd)_mm256_fmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
}
/* a b - c and c - a b, rounded once */
SKF_INLINE skf_vd vd_fms(skf_vd a, skf_vd b, skf_vd c) {
  return (skf_vd)_mm256_fmsub_pd((__m256d)a, (__m256d)b, (__m256d)c);
}
SKF_INLINE skf_vd vd_fnma(skf_vd a, skf_vd b, skf_vd c) {
  return (skf_vd)_mm256_fnmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
}
SKF_INLINE skf_vd vd_sqrt(skf_vd a) { return (skf_vd)_mm256_sqrt_pd((__m256d)a); }
/* a where the mask is set, else b */
SKF_INLINE skf_vd vd_select(skf_vi m, skf_vd a, skf_vd b) {
  return (skf_vd)_mm256_blendv_pd((__m256d)b, (__m256d)a, (__m256d)m);
}
/* One bit for each lane whose mask is set */
SKF_INLINE int vi_bits(skf_vi m) { return _mm256_movemask_pd((__m256d)m); }
#else
SKF_INLINE skf_vd vd_fma(skf_vd a, skf_vd b, skf_vd c) {
  for (int i = 0; i < SKF_LANES; i++) a[i] = fma(a[i], b[i], c[i]);
  return a;
}
SKF_INLINE skf_vd vd_fms(skf_vd a, skf_vd b, skf_vd c) { return vd_fma(a, b, -c); }
SKF_INLINE skf_vd vd_fnma(skf_vd a, skf_vd b, skf_vd c) { return vd_fma(-a, b, c); }
SKF_INLINE skf_vd vd_sqrt(skf_vd a) {
  for (int i = 0; i < SKF_LANES; i++) a[i] = sqrt(a[i]);
  return a;
}
SKF_INLINE skf_vd vd_select(skf_vi m, skf_vd a, skf_vd b) { return (skf_vd)((m & (skf_vi)a) | (~m & (skf_vi)b)); }
SKF_INLINE int vi_bits(skf_vi m) { return (int)((m[0] & 1) | (m[1] & 2) | (m[2] & 4) | (m[3] & 8)); }
#endif

SKF_INLINE bool vi_any(skf_vi m) { return vi_bits(m) != 0; }
SKF_INLINE skf_vd vd_min(skf_vd a, skf_vd b) { return vd_select(a < b, a, b); }
SKF_INLINE skf_vd vd_max(skf_vd a, skf_vd b) { return vd_select(a > b, a, b); }

/* Neither tiny nor huge nor NaN: products and quotients of such numbers keep their accuracy. */
SKF_INLINE skf_vi vd_sane(skf_vd a) {
  skf_vd size = vd_abs(a);
  return (size > vd_set(1e-140)) & (size < vd_set(1e140));
}

#endif
