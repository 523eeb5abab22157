/* SPDX-License-Identifier: MIT */
/* Random numbers that are a function of a seed, a stream and a place in it: Philox4x32-10 [Salmon et al. 2011]. Every
   machine draws the same ones, in any order. */
#ifndef SKF_CORE_RANDOM_H
#define SKF_CORE_RANDOM_H

#include "core/vec3.h"
#include <stdint.h>

/* One block of the cipher. */
static inline void philox(const uint32_t counter[4], const uint32_t key[2], uint32_t out[4]) {
  uint32_t c0 = counter[0], c1 = counter[1], c2 = counter[2], c3 = counter[3], k0 = key[0], k1 = key[1];
  for (int i = 0; i < 10; i++, k0 += 0x9e3779b9u, k1 += 0xbb67ae85u) {
    uint64_t a = (uint64_t)0xd2511f53u * c0, b = (uint64_t)0xcd9e8d57u * c2;
    c0 = (uint32_t)(b >> 32) ^ c1 ^ k0, c2 = (uint32_t)(a >> 32) ^ c3 ^ k1;
    c1 = (uint32_t)b, c3 = (uint32_t)a;
  }
  out[0] = c0, out[1] = c1, out[2] = c2, out[3] = c3;
}

/* The numbers of one item of a stream, drawn one after the other. */
typedef struct skf_random {
  uint32_t key[2], counter[4], block[4];
  int left; /* halves of the block: numbers of 64 bits */
} skf_random;

static inline skf_random random_of(uint64_t seed, uint32_t stream, uint64_t item) {
  return (skf_random){.key = {(uint32_t)seed, (uint32_t)(seed >> 32)},
                      .counter = {0, stream, (uint32_t)item, (uint32_t)(item >> 32)}};
}

/* Uniform in (0, 1): odd multiples of 2^-54. */
static inline double random_next(skf_random *r) {
  if (r->left == 0) {
    philox(r->counter, r->key, r->block);
    r->counter[0]++, r->left = 2;
  }
  const uint32_t *half = r->block + 2 * --r->left;
  uint64_t bits = (uint64_t)half[1] << 32 | half[0];
  return ((double)(bits >> 11) + 0.5) * 0x1p-53;
}

/* Uniform in the unit disc, without its middle; returns x^2 + y^2. */
static inline double random_disc(skf_random *r, double *x, double *y) {
  double s;
  do {
    *x = 2 * random_next(r) - 1, *y = 2 * random_next(r) - 1;
    s = *x * *x + *y * *y;
  } while (!(s > 0 && s < 1));
  return s;
}

/* Uniform on the unit sphere [Marsaglia 1972]. */
static inline skf_vec3 random_direction(skf_random *r) {
  double x, y, s = random_disc(r, &x, &y), w = 2 * sqrt(1 - s);
  return v3(x * w, y * w, 1 - 2 * s);
}

/* ln x for x > 0 by sums, products and quotients only, to about 1e-16 relative to max(1, |ln x|): a library's differs
   in the last bit from machine to machine. */
static inline double random_log(double x) {
  int e;
  double m = frexp(x, &e), sum = 0;
  if (m < 0.70710678118654752) m *= 2, e--;
  double z = (m - 1) / (m + 1), q = z * z;
  for (int k = 23; k > 0; k -= 2) sum = sum * q + 1.0 / k; /* |z| < 0.172: the first term left out is below 1e-19 */
  return e * 0.69314718055994531 + 2 * z * sum;
}

/* Cube root of x in [0, 1], the same way. */
static inline double random_cbrt(double x) {
  int e;
  double m = frexp(x, &e);
  if (!(x > 0)) return 0;
  int third = e >= 0 ? (e + 2) / 3 : e / 3; /* rounded up: m 2^(e - 3 third) in [1/8, 1) */
  double a = ldexp(m, e - 3 * third), y = 1;
  for (int i = 0; i < 8; i++) y -= (y - a / (y * y)) / 3; /* Newton, from above */
  return ldexp(y, third);
}

/* Two independent numbers of the standard normal distribution [Marsaglia & Bray 1964]. */
static inline void random_normal(skf_random *r, double *a, double *b) {
  double s = random_disc(r, a, b), w = sqrt(-2 * random_log(s) / s);
  *a *= w, *b *= w;
}

#endif
