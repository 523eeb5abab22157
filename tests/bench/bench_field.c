/* SPDX-License-Identifier: MIT */
/* Time of one value with its gradient for each kernel on each shape, beside the textbook formula in libm where there is
   one. Smallest of several runs, one thread; it only reports. */
#include "core/vec3.h"
#include "skelfield/field.h"
#include <omp.h>
#include <stdio.h>

enum { POINTS = 2048, RUNS = 7 };

static double px[3][POINTS], F[POINTS], g[3][POINTS];

typedef double (*textbook)(double s, skf_vec3 x, skf_vec3 *g);

/* The segment from (-1, 0, 0) to (1, 0, 0) */
static double inverse_segment(double s, skf_vec3 x, skf_vec3 *out) {
  (void)s;
  double u = x.x + 1, v = x.x - 1, h2 = x.y * x.y + x.z * x.z, r0 = sqrt(u * u + h2), r1 = sqrt(v * v + h2);
  double j = (u / r0 - v / r1) / h2;
  *out = v3(1 / r0 - 1 / r1, -j * x.y, -j * x.z);
  return log((u + r0) / (v + r1));
}

static double cauchy_segment(double s, skf_vec3 x, skf_vec3 *out) {
  double u = x.x + 1, v = x.x - 1, h2 = x.y * x.y + x.z * x.z, s2 = s * s, P2 = 1 + s2 * h2, P = sqrt(P2);
  double W0 = P2 + s2 * u * u, W1 = P2 + s2 * v * v, a = (atan(s * u / P) - atan(s * v / P)) / s;
  double value = 0.5 * (u / W0 - v / W1) / P2 + 0.5 * a / (P2 * P);
  double j = s2 * ((u / (W0 * W0) - v / (W1 * W1)) / P2 + 3 * value / P2);
  *out = v3(1 / (W0 * W0) - 1 / (W1 * W1), -j * x.y, -j * x.z);
  return value;
}

static double gaussian_segment(double a, skf_vec3 x, skf_vec3 *out) {
  double u = x.x + 1, v = x.x - 1, h2 = x.y * x.y + x.z * x.z, e = exp(-a * a * h2);
  double value = sqrt(SKF_PI) / (2 * a) * e * (erf(a * u) - erf(a * v));
  *out = v3(e * (exp(-a * a * u * u) - exp(-a * a * v * v)), -2 * a * a * value * x.y, -2 * a * a * value * x.z);
  return value;
}

static double inverse_squared_segment(double s, skf_vec3 x, skf_vec3 *out) {
  (void)s;
  double u = x.x + 1, v = x.x - 1, h2 = x.y * x.y + x.z * x.z, h = sqrt(h2), w0 = u * u + h2, w1 = v * v + h2;
  double value = (atan(u / h) - atan(v / h)) / h, j = (u / w0 - v / w1 + value) / h2;
  *out = v3(1 / w0 - 1 / w1, -j * x.y, -j * x.z);
  return value;
}

/* The point at the origin, from the kernel's derivatives */
static double any_point(skf_kernel k, skf_vec3 x, skf_vec3 *out) {
  double d[4];
  skf_kernel_eval(k, v3_norm2(x), d);
  *out = v3_scale(2 * d[1], x);
  return d[0];
}

static const textbook segments[SKF_KERNEL_COUNT] = {[SKF_INVERSE] = inverse_segment,
                                                    [SKF_CAUCHY] = cauchy_segment,
                                                    [SKF_GAUSSIAN] = gaussian_segment,
                                                    [SKF_INVERSE_SQUARED] = inverse_squared_segment};

static skf_primitive shape_of(int column) {
  skf_primitive p = {.shape = column < 3 ? (skf_shape)column : column == 3 ? SKF_ARC : (skf_shape)(column - 1)};
  switch (p.shape) {
  case SKF_POINT: p.point.at = v3(0, 0, 0); break;
  case SKF_SEGMENT: p.segment = (skf_segment){{-1, 0, 0}, {1, 0, 0}}; break;
  case SKF_ARC: p.arc = (skf_arc){{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 1, column == 3 ? 2 * SKF_PI : 2}; break;
  case SKF_TRIANGLE: p.triangle = (skf_triangle){{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0.2}}}; break;
  default: p.plane = (skf_plane){{0, 0, 0}, {0, 0, 1}};
  }
  return p;
}

static double run_field(const skf_field *f) {
  const double *const in[3] = {px[0], px[1], px[2]};
  double *const out[3] = {g[0], g[1], g[2]}, best = INFINITY;
  for (int r = 0; r < RUNS; r++) {
    double t = omp_get_wtime();
    skf_field_eval(f, POINTS, in, F, out, NULL);
    best = fmin(best, omp_get_wtime() - t);
  }
  return best / POINTS * 1e9;
}

static double run_textbook(skf_kernel k, textbook line) {
  double best = INFINITY;
  for (int r = 0; r < RUNS; r++) {
    double t = omp_get_wtime();
    for (int i = 0; i < POINTS; i++) {
      skf_vec3 x = v3(px[0][i], px[1][i], px[2][i]), G;
      F[i] = line ? line(k.param, x, &G) : any_point(k, x, &G);
      g[0][i] = G.x, g[1][i] = G.y, g[2][i] = G.z;
    }
    best = fmin(best, omp_get_wtime() - t);
  }
  return best / POINTS * 1e9;
}

int main(void) {
  static const char *const columns[] = {"point", "segment", "arc", "circle", "triangle", "plane"};
  omp_set_num_threads(1);
  unsigned long long seed = 1;
  for (int k = 0; k < 3; k++)
    for (int i = 0; i < POINTS; i++) {
      seed = seed * 6364136223846793005u + 1442695040888963407u;
      px[k][i] = 3 * ((double)(seed >> 11) * 0x1p-53) - 1.5;
    }
  printf("ns per value and gradient; in brackets the textbook formula\n%-16s", "");
  for (int c = 0; c < 6; c++) printf(" %15s", columns[c]);
  for (int k = 0; k < SKF_KERNEL_COUNT; k++) {
    skf_kernel kernel = {(skf_kernel_type)k, 1.5};
    printf("\n%-16s", skf_kernel_get(kernel.type)->name);
    for (int c = 0; c < 6; c++) {
      skf_element e = {shape_of(c), kernel, 1};
      skf_field *f;
      if (skf_field_new(&e, 1, &f)) return 1;
      char text[64];
      double ours = run_field(f);
      if (c == 0 || (c == 1 && segments[k]))
        snprintf(text, sizeof text, "%.0f (%.0f)", ours, run_textbook(kernel, c ? segments[k] : NULL));
      else
        snprintf(text, sizeof text, "%.0f", ours);
      printf(" %15s", text);
      skf_field_free(f);
    }
  }
  printf("\n");
  return 0;
}
