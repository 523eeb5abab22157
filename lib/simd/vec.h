/* SPDX-License-Identifier: MIT */
/* Numbers side by side. The translation unit says how many bytes a vector has, SKF_VEC_BYTES (32 unless told, 64), and
   with SKF_VEC_FLOAT that they are floats: what is written with these names is then compiled for 4 or 8 doubles, for 8
   or 16 floats. Every operation is one correctly rounded IEEE operation per lane, so that each instruction set and each
   number of lanes gives the same bits; products are fused with sums only where vd_fma says so. */
#ifndef SKF_SIMD_VEC_H
#define SKF_SIMD_VEC_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#ifndef SKF_VEC_BYTES
#define SKF_VEC_BYTES 32
#endif

#ifdef SKF_VEC_FLOAT
typedef float skf_real;
typedef int skf_whole;
typedef unsigned skf_bits;
#define SKF_PICK(for_double, for_float)  ((skf_real)(for_float))
#define SKF_COUNT(for_double, for_float) (for_float)
enum { SKF_MANTISSA = 23, SKF_BIAS = 127 };
#else
typedef double skf_real;
typedef long long skf_whole;
typedef unsigned long long skf_bits;
/* A constant that depends on the type; a whole one */
#define SKF_PICK(for_double, for_float)  ((skf_real)(for_double))
#define SKF_COUNT(for_double, for_float) (for_double)
enum { SKF_MANTISSA = 52, SKF_BIAS = 1023 };
#endif

enum { SKF_LANES = SKF_VEC_BYTES / sizeof(skf_real) };

typedef skf_real skf_vd __attribute__((vector_size(SKF_VEC_BYTES)));
typedef skf_whole skf_vi __attribute__((vector_size(SKF_VEC_BYTES))); /* also a mask: 0 or -1 in each lane */
typedef skf_bits skf_vu __attribute__((vector_size(SKF_VEC_BYTES)));

#if SKF_VEC_BYTES == 64 && defined(__AVX512F__) && defined(__AVX512DQ__)
#include <immintrin.h>
#ifdef SKF_VEC_FLOAT
#define SKF_MM(name) _mm512_##name##_ps
typedef __m512 skf_mm;
#else
#define SKF_MM(name) _mm512_##name##_pd
typedef __m512d skf_mm;
#endif
#elif SKF_VEC_BYTES == 32 && defined(__AVX2__) && defined(__FMA__)
#include <immintrin.h>
#ifdef SKF_VEC_FLOAT
#define SKF_MM(name) _mm256_##name##_ps
typedef __m256 skf_mm;
#else
#define SKF_MM(name) _mm256_##name##_pd
typedef __m256d skf_mm;
#endif
#else
#pragma GCC diagnostic ignored "-Wpsabi" /* all is inline: no ABI */
#endif

#define SKF_INLINE static inline __attribute__((always_inline))

/* For each of n <= 4 vectors, unrolled */
#define SKF_EACH(u, n) _Pragma("GCC unroll 4") for (size_t u = 0; u < (n); u++)

/* (a - 0 is a, the sign of 0 with it.) */
SKF_INLINE skf_vd vd_set(double a) { return (skf_real)a - (skf_vd){0}; }
/* v, but compilers don't see what it is: a constant that is added and subtracted then stands there once. */
SKF_INLINE skf_vd vd_held(skf_vd v) {
#if defined __AVX__ && SKF_VEC_BYTES == 32
  __asm__("" : "+x"(v));
#endif
  return v;
}
SKF_INLINE skf_vi vi_set(long long a) { return (skf_whole)a - (skf_vi){0}; }

SKF_INLINE skf_vd vd_load(const skf_real *p) {
  skf_vd v;
  memcpy(&v, p, sizeof v);
  return v;
}

SKF_INLINE void vd_store(skf_real *p, skf_vd v) { memcpy(p, &v, sizeof v); }

/* The sign bit stays out of |a|; vd_sign(a) keeps nothing else. */
SKF_INLINE skf_vi vi_sign_bit(void) { return vi_set((long long)((skf_bits)1 << (8 * sizeof(skf_real) - 1))); }
SKF_INLINE skf_vi vd_sign(skf_vd a) { return (skf_vi)a & vi_sign_bit(); }
SKF_INLINE skf_vd vd_abs(skf_vd a) { return (skf_vd)((skf_vi)a & ~vi_sign_bit()); }

#ifdef SKF_MM
/* a b + c, rounded once */
SKF_INLINE skf_vd vd_fma(skf_vd a, skf_vd b, skf_vd c) {
  return (skf_vd)SKF_MM(fmadd)((skf_mm)a, (skf_mm)b, (skf_mm)c);
}
/* a b - c and c - a b, rounded once */
SKF_INLINE skf_vd vd_fms(skf_vd a, skf_vd b, skf_vd c) {
  return (skf_vd)SKF_MM(fmsub)((skf_mm)a, (skf_mm)b, (skf_mm)c);
}
SKF_INLINE skf_vd vd_fnma(skf_vd a, skf_vd b, skf_vd c) {
  return (skf_vd)SKF_MM(fnmadd)((skf_mm)a, (skf_mm)b, (skf_mm)c);
}
SKF_INLINE skf_vd vd_sqrt(skf_vd a) { return (skf_vd)SKF_MM(sqrt)((skf_mm)a); }
#if SKF_VEC_BYTES == 64
#ifdef SKF_VEC_FLOAT
#define SKF_MASK(m) _mm512_movepi32_mask((__m512i)(m))
#else
#define SKF_MASK(m) _mm512_movepi64_mask((__m512i)(m))
#endif
/* One bit for each lane whose mask is set */
SKF_INLINE int vi_bits(skf_vi m) { return SKF_MASK(m); }
/* a where the mask is set, else b */
SKF_INLINE skf_vd vd_select(skf_vi m, skf_vd a, skf_vd b) {
  return (skf_vd)SKF_MM(mask_blend)(SKF_MASK(m), (skf_mm)b, (skf_mm)a);
}
#else
SKF_INLINE int vi_bits(skf_vi m) { return SKF_MM(movemask)((skf_mm)m); }
SKF_INLINE skf_vd vd_select(skf_vi m, skf_vd a, skf_vd b) {
  return (skf_vd)SKF_MM(blendv)((skf_mm)b, (skf_mm)a, (skf_mm)m);
}
#endif
#else
SKF_INLINE skf_vd vd_fma(skf_vd a, skf_vd b, skf_vd c) {
  for (int i = 0; i < SKF_LANES; i++)
    a[i] = SKF_PICK(fma(a[i], b[i], c[i]), fmaf((float)a[i], (float)b[i], (float)c[i]));
  return a;
}
SKF_INLINE skf_vd vd_fms(skf_vd a, skf_vd b, skf_vd c) { return vd_fma(a, b, -c); }
SKF_INLINE skf_vd vd_fnma(skf_vd a, skf_vd b, skf_vd c) { return vd_fma(-a, b, c); }
SKF_INLINE skf_vd vd_sqrt(skf_vd a) {
  for (int i = 0; i < SKF_LANES; i++) a[i] = SKF_PICK(sqrt(a[i]), sqrtf((float)a[i]));
  return a;
}
SKF_INLINE skf_vd vd_select(skf_vi m, skf_vd a, skf_vd b) { return (skf_vd)((m & (skf_vi)a) | (~m & (skf_vi)b)); }
SKF_INLINE int vi_bits(skf_vi m) {
  int bits = 0;
  for (int i = 0; i < SKF_LANES; i++) bits |= (int)(m[i] & 1) << i;
  return bits;
}
#endif

/* b where they are equal or one is NaN */
#ifdef SKF_MM
SKF_INLINE skf_vd vd_min(skf_vd a, skf_vd b) { return (skf_vd)SKF_MM(min)((skf_mm)a, (skf_mm)b); }
SKF_INLINE skf_vd vd_max(skf_vd a, skf_vd b) { return (skf_vd)SKF_MM(max)((skf_mm)a, (skf_mm)b); }
#else
SKF_INLINE skf_vd vd_min(skf_vd a, skf_vd b) { return vd_select(a < b, a, b); }
SKF_INLINE skf_vd vd_max(skf_vd a, skf_vd b) { return vd_select(a > b, a, b); }
#endif
SKF_INLINE bool vi_any(skf_vi m) { return vi_bits(m) != 0; }
SKF_INLINE bool vi_all(skf_vi m) { return vi_bits(m) == (1 << SKF_LANES) - 1; }

/* Neither tiny nor huge nor NaN: products and quotients of such numbers keep their accuracy. */
SKF_INLINE skf_vi vd_sane(skf_vd a) {
  skf_vd size = vd_abs(a);
  return (size > vd_set(SKF_PICK(1e-140, 1e-18))) & (size < vd_set(SKF_PICK(1e140, 1e18)));
}

#endif
