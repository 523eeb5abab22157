/* SPDX-License-Identifier: MIT */
/* From linear light to sRGB [IEC 61966-2-1]. */
#include "ray/render.h"
#include <stdint.h>
#include <string.h>

static double press(double x) { return x <= 0.7 ? fmax(x, 0) : 1 - 0.3 * exp((0.7 - x) / 0.3); }

static double encode(double x) {
  x = press(x);
  return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;
}

/* 255 encode(x) between 2^FIRST and 2^LAST by straight lines, PER of them from each power of two to the next: within
   0.002, as its curvature is at most that of x^(1 / 2.4), or of exp(-x / 0.3) above 0.7. */
enum { FIRST = -12, LAST = 3, PER = 128, LINES = (LAST - FIRST) * PER };

/* What rounds to another byte within so much is computed. */
static const float doubt = 0.01f;

static const float edge_low = 0x1p-12f, edge_high = 0x1p3f;

static float edge(int i) { return ldexpf(1 + (float)(i % PER) / PER, FIRST + i / PER); }

static float look_up(const float *line, float x) {
  uint32_t bits;
  memcpy(&bits, &x, sizeof bits);
  uint32_t i = (bits >> 16) - (127 + FIRST) * PER; /* 7 bits of the fraction behind the exponent */
  float part = (float)(bits & 0xffff) * 0x1p-16f;
  return line[i] + part * (line[i + 1] - line[i]);
}

/* Noise of half a step. */
static double noise_at(size_t x, size_t y) { return skf_hashed((unsigned)x, (unsigned)y, 0) - 0.5; }

static unsigned char exact(float x, double noise) {
  return (unsigned char)fmin(fmax(floor(255 * encode(x) + 0.5 + noise), 0), 255);
}

static unsigned char byte_of(float x, float level, double noise) {
  float v = level + 0.5f + (float)noise;
  int whole = (int)v;
  float part = v - (float)whole;
  return part > doubt && part < 1 - doubt && v < 255 ? (unsigned char)whole : exact(x, noise);
}

static void quick_row(const float *line, const float *rgb, size_t n, size_t y, unsigned char *out) {
  float level[3] = {0, 0, 0}, last[3] = {-1, -1, -1}; /* many pixels are like the one before */
  for (size_t i = 0; i < n; i++, rgb += 3, out += 3) {
    double noise = noise_at(i, y);
    for (int k = 0; k < 3; k++) {
      if (rgb[k] != last[k])
        last[k] = rgb[k], level[k] = rgb[k] >= edge_low && rgb[k] < edge_high ? look_up(line, rgb[k]) : -1;
      out[k] = byte_of(rgb[k], level[k], noise);
    }
  }
}

void skf_render_srgb(const float *rgb, int width, size_t n, unsigned char *out) {
  size_t w = (size_t)width;
  if (n < 2 * LINES) { /* not worth the lines */
    for (size_t i = 0; i < 3 * n; i++) out[i] = exact(rgb[i], noise_at(i / 3 % w, i / 3 / w));
    return;
  }
  float line[LINES + 1];
  for (int i = 0; i <= LINES; i++) line[i] = (float)(255 * encode(edge(i)));
  for (size_t from = 0; from < n; from += w)
    quick_row(line, rgb + 3 * from, n - from < w ? n - from : w, from / w, out + 3 * from);
}

void skf_render_srgb16(const float *rgb, size_t n, unsigned short *out) {
  for (size_t i = 0; i < 3 * n; i++) out[i] = (unsigned short)fmin(fmax(floor(65535 * encode(rgb[i]) + 0.5), 0), 65535);
}
