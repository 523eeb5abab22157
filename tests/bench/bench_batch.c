/* SPDX-License-Identifier: MIT */
/* Batches: time of one value with its gradient for each pair that has a vector form, beside the closed form, and beside
   the textbook formula of segments written with the vector functions of glibc and of SLEEF. Smallest of several
   interleaved runs, one thread; it only reports. */
#include "core/vec3.h"
#include "field/batch.h"
#include "simd/vec.h"
#include "skelfield/field.h"
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#ifdef SKF_HAVE_SLEEF
#include <sleef.h>
#endif

enum { POINTS = 2040, RUNS = 25 }; /* no power of two: the arrays share the cache */

static double p[3][POINTS], F[POINTS], g[3][POINTS];

typedef skf_vd (*vector_function)(skf_vd);
typedef void (*textbook)(vector_function f, double s);

/* The segment from (-1, 0, 0) to (1, 0, 0) */
static void inverse_segment(vector_function log, double s) {
  (void)s;
  for (int i = 0; i < POINTS; i += SKF_LANES) {
    skf_vd x = vd_load(p[0] + i), y = vd_load(p[1] + i), z = vd_load(p[2] + i), u = x + vd_set(1), v = x - vd_set(1);
    skf_vd h2 = y * y + z * z, r0 = vd_sqrt(u * u + h2), r1 = vd_sqrt(v * v + h2), j = (u / r0 - v / r1) / h2;
    vd_store(F + i, log((u + r0) / (v + r1)));
    vd_store(g[0] + i, vd_set(1) / r0 - vd_set(1) / r1);
    vd_store(g[1] + i, -j * y);
    vd_store(g[2] + i, -j * z);
  }
}

static void cauchy_segment(vector_function atan, double s) {
  skf_vd S = vd_set(s), s2 = S * S, one = vd_set(1), half = vd_set(0.5);
  for (int i = 0; i < POINTS; i += SKF_LANES) {
    skf_vd x = vd_load(p[0] + i), y = vd_load(p[1] + i), z = vd_load(p[2] + i), u = x + one, v = x - one;
    skf_vd P2 = one + s2 * (y * y + z * z), P = vd_sqrt(P2), W0 = P2 + s2 * u * u, W1 = P2 + s2 * v * v;
    skf_vd a = (atan(S * u / P) - atan(S * v / P)) / S, value = half * (u / W0 - v / W1) / P2 + half * a / (P2 * P);
    skf_vd j = s2 * ((u / (W0 * W0) - v / (W1 * W1)) / P2 + vd_set(3) * value / P2);
    vd_store(F + i, value);
    vd_store(g[0] + i, one / (W0 * W0) - one / (W1 * W1));
    vd_store(g[1] + i, -j * y);
    vd_store(g[2] + i, -j * z);
  }
}

#ifdef SKF_HAVE_LIBMVEC
__m256d _ZGVdN4v_log(__m256d), _ZGVdN4v_atan(__m256d);
static skf_vd glibc_log(skf_vd x) { return (skf_vd)_ZGVdN4v_log((__m256d)x); }
static skf_vd glibc_atan(skf_vd x) { return (skf_vd)_ZGVdN4v_atan((__m256d)x); }
#else
static const vector_function glibc_log = NULL, glibc_atan = NULL;
#endif
#ifdef SKF_HAVE_SLEEF
static skf_vd sleef_log(skf_vd x) { return (skf_vd)Sleef_logd4_u10avx2((__m256d)x); }
static skf_vd sleef_atan(skf_vd x) { return (skf_vd)Sleef_atand4_u10avx2((__m256d)x); }
#else
static const vector_function sleef_log = NULL, sleef_atan = NULL;
#endif

static skf_primitive unit(skf_shape shape, bool circle) {
  skf_primitive s = {.shape = shape};
  switch (shape) {
  case SKF_POINT: s.point.at = v3(0, 0, 0); break;
  case SKF_SEGMENT: s.segment = (skf_segment){{-1, 0, 0}, {1, 0, 0}}; break;
  case SKF_ARC: s.arc = (skf_arc){{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 1, circle ? 2 * SKF_PI : 2}; break;
  case SKF_TRIANGLE: s.triangle = (skf_triangle){{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0.2}}}; break;
  default: s.plane = (skf_plane){{0, 0, 0}, {0, 0, 1}};
  }
  return s;
}

/* Whether some elements of this pair have a vector form */
static bool has_form(skf_kernel_type type, skf_shape at) {
  const skf_batch_ops *ops = skf_batch_get(skf_isa_pick());
#define X(name, kernel, shape, fits)                                                                                   \
  if (type == (kernel) && at == (shape) && ops->form[SKF_FORM_##name].add) return true;
  SKF_BATCH_FORMS(X)
#undef X
  return false;
}

static skf_field *make(const char *isa, const skf_element *e, size_t n) {
  skf_field *f = NULL;
  setenv("SKELFIELD_ISA", isa, 1);
  if (skf_field_new(e, n, &f)) exit(1);
  return f;
}

static void keep(double *best, double started) { *best = fmin(*best, (omp_get_wtime() - started) / POINTS * 1e9); }

static void field(const skf_field *f, double *best) {
  const double *const in[3] = {p[0], p[1], p[2]};
  double *const out[3] = {g[0], g[1], g[2]}, t = omp_get_wtime();
  skf_field_eval(f, POINTS, in, F, out, NULL);
  keep(best, t);
}

static void formula(textbook line, vector_function f, double s, double *best) {
  if (!f) return;
  double t = omp_get_wtime();
  line(f, s);
  keep(best, t);
}

static void row(const char *name, skf_kernel kernel, const skf_element *e, size_t n) {
  skf_shape shape = e->primitive.shape;
  textbook line = shape != SKF_SEGMENT ? NULL : kernel.type == SKF_INVERSE ? inverse_segment : cauchy_segment;
  bool log = kernel.type == SKF_INVERSE;
  double scalar = INFINITY, vector = INFINITY, glibc = INFINITY, sleef = INFINITY;
  skf_field *a = make("scalar", e, n), *b = make("avx2", e, n);
  for (int r = 0; r < RUNS; r++) {
    field(a, &scalar);
    field(b, &vector);
    if (line) formula(line, log ? glibc_log : glibc_atan, kernel.param, &glibc);
    if (line) formula(line, log ? sleef_log : sleef_atan, kernel.param, &sleef);
  }
  double per = (double)n;
  printf("%-16s %-12s %8.1f %8.2f %7.1fx", skf_kernel_get(kernel.type)->name, name, scalar / per, vector / per,
         scalar / vector);
  if (isfinite(glibc)) printf("   glibc %.2f (%.2fx)", glibc, glibc / vector);
  if (isfinite(sleef)) printf("   SLEEF u10 %.2f (%.2fx)", sleef, sleef / vector);
  printf("\n");
  skf_field_free(a);
  skf_field_free(b);
}

int main(void) {
  const skf_batch_ops *ops = skf_batch_get(skf_isa_pick());
  if (ops == &skf_batch_scalar) return puts("no vector forms on this machine") < 0;
  omp_set_num_threads(1);
  unsigned long long seed = 1;
  for (int k = 0; k < 3; k++)
    for (int i = 0; i < POINTS; i++) {
      seed = seed * 6364136223846793005u + 1442695040888963407u;
      p[k][i] = 3 * ((double)(seed >> 11) * 0x1p-53) - 1.5;
    }
  printf("ns per value and gradient%14s %8s %8s   textbook formula\n", "closed", "AVX2", "ratio");
  for (int k = 0; k < SKF_KERNEL_COUNT; k++)
    for (int s = 0; s < SKF_SHAPE_COUNT; s++) {
      skf_kernel kernel = {(skf_kernel_type)k, 1.5};
      if (!has_form(kernel.type, (skf_shape)s)) continue;
      skf_element one = {unit((skf_shape)s, kernel.type == SKF_INVERSE), kernel, 1}, many[64];
      row(s == SKF_ARC && kernel.type == SKF_INVERSE ? "circle" : skf_shape_get((skf_shape)s)->name, kernel, &one, 1);
      if (s != SKF_POINT) continue;
      for (int i = 0; i < 64; i++) many[i] = one, many[i].primitive.point.at = v3(0.01 * i, 0, 0);
      row("64 points", kernel, many, 64);
    }
  return 0;
}
