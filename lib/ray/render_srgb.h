/* SPDX-License-Identifier: MIT */
/* Rows of bytes from linear light, by loops that the compiler makes vectors of. */
#ifndef SKF_RAY_RENDER_SRGB_H
#define SKF_RAY_RENDER_SRGB_H

#include "ray/render.h"
#include <stdint.h>
#include <string.h>

/* 255 times the encoded value between 2^FIRST and 2^LAST by straight lines, PER of them from each power of two to the
   next: within 0.002, as its curvature is at most that of x^(1 / 2.4), or of exp(-x / 0.3) above 0.7. */
enum { SKF_SRGB_FIRST = -12, SKF_SRGB_LAST = 3, SKF_SRGB_PER = 128 };
enum { SKF_SRGB_LINES = (SKF_SRGB_LAST - SKF_SRGB_FIRST) * SKF_SRGB_PER };

/* n <= SKF_SRGB_PIECE pixels from (x, y) on. Where `unsure` is not 0 another byte could be the right one. */
enum { SKF_SRGB_PIECE = 64 };
typedef void skf_srgb_fn(const float line[SKF_SRGB_LINES + 1], const float *rgb, size_t n, size_t x, size_t y,
                         unsigned char *out, unsigned char *unsure);
skf_srgb_fn skf_srgb_scalar, skf_srgb_avx2;

static inline void srgb_piece(const float *line, const float *rgb, size_t n, size_t x, size_t y,
                              unsigned char *restrict out, unsigned char *restrict unsure) {
  /* What rounds to another byte within so much is not sure. */
  const float doubt = 0.01f;
  const int32_t low = (127 + SKF_SRGB_FIRST) << 23, high = (127 + SKF_SRGB_LAST) << 23; /* bits of the powers */
  float noise[SKF_SRGB_PIECE], level[3 * SKF_SRGB_PIECE];
  int32_t bits[3 * SKF_SRGB_PIECE];
  for (size_t i = 0; i < n; i++) noise[i] = (float)(int)(skf_hash((unsigned)(x + i), (unsigned)y, 0) >> 8) * 0x1p-24f;
  memcpy(bits, rgb, 3 * n * sizeof *bits);
  for (size_t i = 0; i < 3 * n; i++) { /* positive numbers go in the order of their bits */
    int32_t floor = bits[i] < low ? low : bits[i], in = floor < high ? floor : high - 1;
    int k = (in >> 16) - (low >> 16); /* 7 bits of the fraction behind the exponent */
    level[i] = line[k] + (float)(in & 0xffff) * 0x1p-16f * (line[k + 1] - line[k]);
  }
  for (size_t i = 0; i < n; i++)
    for (size_t k = 3 * i; k < 3 * i + 3; k++) level[k] += noise[i];
  for (size_t i = 0; i < 3 * n; i++) {
    int whole = (int)level[i];
    float part = level[i] - (float)whole;
    out[i] = (unsigned char)whole;
    unsure[i] = (part <= doubt) | (part >= 1 - doubt) | (level[i] >= 255) | (bits[i] < low) | (bits[i] >= high);
  }
}

#endif
