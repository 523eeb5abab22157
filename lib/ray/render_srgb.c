/* SPDX-License-Identifier: MIT */
/* From linear light to sRGB [IEC 61966-2-1]. */
#include "ray/render_srgb.h"
#include "simd/isa.h"

static double press(double x) { return x <= 0.7 ? fmax(x, 0) : 1 - 0.3 * exp((0.7 - x) / 0.3); }

static double encode(double x) {
  x = press(x);
  return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;
}

static float edge(int i) {
  return ldexpf(1 + (float)(i % SKF_SRGB_PER) / SKF_SRGB_PER, SKF_SRGB_FIRST + i / SKF_SRGB_PER);
}

/* With noise of half a step. */
static unsigned char exact(float x, size_t column, size_t row) {
  double noise = skf_hashed((unsigned)column, (unsigned)row, 0) - 0.5;
  return (unsigned char)fmin(fmax(floor(255 * encode(x) + 0.5 + noise), 0), 255);
}

void skf_srgb_scalar(const float *line, const float *rgb, size_t n, size_t x, size_t y, unsigned char *out,
                     unsigned char *unsure) {
  srgb_piece(line, rgb, n, x, y, out, unsure);
}

static skf_srgb_fn *pieces(void) {
#ifdef SKF_HAVE_AVX2
  if (skf_isa_pick() != SKF_ISA_SCALAR) return skf_srgb_avx2;
#endif
  return skf_srgb_scalar;
}

static void quick_row(skf_srgb_fn *piece, const float *line, const float *rgb, size_t n, size_t y, unsigned char *out) {
  for (size_t x = 0; x < n; x += SKF_SRGB_PIECE, rgb += 3 * SKF_SRGB_PIECE, out += 3 * SKF_SRGB_PIECE) {
    size_t m = n - x < SKF_SRGB_PIECE ? n - x : SKF_SRGB_PIECE;
    unsigned char unsure[3 * SKF_SRGB_PIECE] = {0};
    piece(line, rgb, m, x, y, out, unsure);
    for (size_t i = 0; i < 3 * m; i += 8) {
      uint64_t any;
      memcpy(&any, unsure + i, sizeof any);
      for (size_t k = i; any && k < i + 8; k++)
        if (unsure[k]) out[k] = exact(rgb[k], x + k / 3, y);
    }
  }
}

void skf_render_srgb(const float *rgb, int width, size_t n, unsigned char *out) {
  size_t w = (size_t)width;
  if (n < 2 * SKF_SRGB_LINES) { /* not worth the lines */
    for (size_t i = 0; i < 3 * n; i++) out[i] = exact(rgb[i], i / 3 % w, i / 3 / w);
    return;
  }
  float line[SKF_SRGB_LINES + 1];
  skf_srgb_fn *piece = pieces();
  for (int i = 0; i <= SKF_SRGB_LINES; i++) line[i] = (float)(255 * encode(edge(i)));
  for (size_t from = 0; from < n; from += w)
    quick_row(piece, line, rgb + 3 * from, n - from < w ? n - from : w, from / w, out + 3 * from);
}

void skf_render_srgb16(const float *rgb, size_t n, unsigned short *out) {
  for (size_t i = 0; i < 3 * n; i++) out[i] = (unsigned short)fmin(fmax(floor(65535 * encode(rgb[i]) + 0.5), 0), 65535);
}
