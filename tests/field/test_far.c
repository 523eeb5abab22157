/* SPDX-License-Identifier: MIT */
/* Expansions in Chebyshev polynomials and in solid harmonics between two cells, one source and one target at a time:
   faces, facing corners. */
#include "check.h"
#include "field/far_tensor.h"
#include "random.h"
#include <stdlib.h>
#include <string.h>

enum { SOURCES = 6, TARGETS = SKF_BATCH };

static const double side = 0.25;
static far_mixture mixture;
static far_layout layout;
static double *in, *out, *room[2];

/* At corners, on faces, anywhere in the unit cell */
static double coordinate(uint64_t *seed, size_t i) {
  double x = rnd(seed, -0.5, 0.5);
  return i % 3 == 0 ? copysign(0.5, x) : i % 3 == 1 ? 0.5 * cos(SKF_PI * (x + 0.5)) : x;
}

/* The polynomials of what a unit source at y does to the cell from which its own is `shift` away. */
static void carry(const double y[3], const int shift[3]) {
  static double T[3][FAR_GATHER][FAR_ORDER + FAR_PAD];
  const far_ops *ops = &skf_far_scalar;
  size_t bytes = layout.size * sizeof(double);
  memset(T, 0, sizeof T), memset(in, 0, bytes), memset(out, 0, bytes);
  for (int k = 0; k < 3; k++) far_chebyshev(2 * y[k] / FAR_WIDE, layout.order, T[k][0]);
  ops->points(&layout, T, in);
  for (int i = 0; i < mixture.count; i++) {
    const far_term *g = mixture.term + i;
    const far_matrix *m[3] = {g->along + FAR_REACH + shift[0], g->along + FAR_REACH + shift[1],
                              g->last + FAR_REACH + shift[2]};
    bool matters = true;
    for (int k = 0; k < 3; k++) matters = matters && g->matters[FAR_REACH + shift[k]];
    if (!matters) continue;
    memset(room[0], 0, bytes), memset(room[1], 0, bytes);
    ops->along[0][FAR_ONE](&layout, g->order, m[0], in, NULL, room[0]);
    ops->along[1][FAR_ONE](&layout, g->order, m[1], room[0], NULL, room[1]);
    ops->along[2][FAR_ONE](&layout, g->order, m[2], room[1], NULL, out);
  }
}

/* The worst errors of F, relative, and of the gradient, relative to max(|grad F|, F / r). */
static void compare(uint64_t *seed, skf_kernel kernel, const double y[3], const int shift[3], double worst[2]) {
  static double u[3][TARGETS], x[3][TARGETS], got[4][TARGETS];
  for (size_t i = 0; i < TARGETS; i++)
    for (int k = 0; k < 3; k++) {
      u[k][i] = i < 8 ? ((i >> k & 1) ? 0.5 : -0.5) : coordinate(seed, i);
      x[k][i] = 2 * u[k][i] / FAR_WIDE;
    }
  skf_far_scalar.local(&layout, out, TARGETS, 2 / (FAR_WIDE * side), (const double(*)[TARGETS])x, got);
  for (size_t i = 0; i < TARGETS; i++) {
    skf_vec3 d = {u[0][i] - y[0] - shift[0], u[1][i] - y[1] - shift[1], u[2][i] - y[2] - shift[2]};
    double r = side * v3_norm(d), s = kernel.param * r, base = kernel.type == SKF_CAUCHY ? 1 + s * s : r * r;
    double F = kernel.type == SKF_CAUCHY ? 1 / (base * base) : 1 / base;
    double slope = kernel.type == SKF_CAUCHY ? -4 * kernel.param * s / (base * base * base) : -2 * F / r;
    skf_vec3 g = v3_scale(slope / v3_norm(d), d), off = v3_sub(v3(got[1][i], got[2][i], got[3][i]), g);
    worst[0] = fmax(worst[0], fabs(got[0][i] - F) / F);
    worst[1] = fmax(worst[1], v3_norm(off) / fmax(fabs(slope), F / r));
  }
}

static void check_kernel(skf_kernel kernel, double accuracy) {
  static const int shifts[][3] = {{2, 0, 0}, {0, -2, 1}, {1, 1, 2}, {-2, 2, 0}, {2, 2, -2}, {0, 0, 3}, {3, -3, 3}};
  uint64_t seed = 31;
  double worst[2] = {0, 0};
  assert_true(skf_far_mixture_make(kernel, side, accuracy, &mixture));
  layout = far_layout_new(mixture.order);
  in = calloc(4 * layout.size + 8, sizeof *in);
  assert_non_null(in);
  out = in + layout.size, room[0] = out + layout.size, room[1] = room[0] + layout.size;
  for (size_t k = 0; k < sizeof shifts / sizeof *shifts; k++)
    for (size_t i = 0; i < SOURCES; i++) {
      double y[3];
      for (int c = 0; c < 3; c++) /* a corner that faces the target, its opposite, others */
        y[c] = i == 0   ? (shifts[k][c] > 0 ? -0.5 : 0.5)
               : i == 1 ? (shifts[k][c] > 0 ? 0.5 : -0.5)
                        : coordinate(&seed, i);
      carry(y, shifts[k]);
      compare(&seed, kernel, y, shifts[k], worst);
    }
  print_message("kernel %d, s = %g, %.0e: order %d, F %.1e, gradient %.1e\n", (int)kernel.type, kernel.param, accuracy,
                mixture.order, worst[0], worst[1]);
  free(in);
  if (!(worst[0] <= accuracy && worst[1] <= accuracy)) fail_msg("not within %g", accuracy);
}

static void test_cells(void **state) {
  (void)state;
  static const double accuracies[] = {1e-3, 1e-5, 1e-6, 1e-8, 1e-10, 1e-12};
  static const skf_kernel kernels[] = {
      {.type = SKF_INVERSE_SQUARED}, {.type = SKF_CAUCHY, .param = 3}, {.type = SKF_CAUCHY, .param = 1e4}};
  for (size_t k = 0; k < sizeof kernels / sizeof *kernels; k++)
    for (size_t i = 0; i < sizeof accuracies / sizeof *accuracies; i++) check_kernel(kernels[k], accuracies[i]);
}

static bool has_way(const far_harmonic *h, const int s[3]) {
  return h->over[FAR_LONG + s[0]][FAR_LONG + s[1]][FAR_LONG + s[2]].order > 0;
}

/* What a unit source at y does to the cell `shift` away: coefficients in `out`. */
static void carry_harmonics(const far_harmonic *h, const double y[3], const int shift[3]) {
  double x[4][FAR_GATHER] = {{y[0]}, {y[1]}, {y[2]}, {1}};
  const double *from[FAR_GROUP] = {in};
  double *to[FAR_GROUP] = {out};
  memset(in, 0, h->size * sizeof *in), memset(out, 0, h->size * sizeof *out);
  skf_far_scalar.gather(h, (const double(*)[FAR_GATHER])x, in);
  for (size_t k = 0; k < h->size; k++) in[k] *= h->norm[k];
  skf_far_scalar.transfer(&h->over[FAR_LONG + shift[0]][FAR_LONG + shift[1]][FAR_LONG + shift[2]], FAR_OVER, 1, 1, from,
                          to, room[0]);
  for (size_t k = 0; k < h->size; k++) out[k] *= h->norm[k];
}

/* The worst errors of F, of 1/r, and of the gradient, of 1/r^2. */
static void compare_harmonics(uint64_t *seed, const far_harmonic *h, const double y[3], const int shift[3],
                              double worst[2]) {
  static double x[3][TARGETS], got[4][TARGETS];
  for (size_t i = 0; i < TARGETS; i++)
    for (int k = 0; k < 3; k++) x[k][i] = i < 8 ? ((i >> k & 1) ? 0.5 : -0.5) : coordinate(seed, i);
  skf_far_scalar.evaluate(h, out, TARGETS, 1, (const double(*)[TARGETS])x, got);
  for (size_t i = 0; i < TARGETS; i++) {
    skf_vec3 d = v3(x[0][i] + shift[0] - y[0], x[1][i] + shift[1] - y[1], x[2][i] + shift[2] - y[2]);
    double r = v3_norm(d);
    skf_vec3 off = v3_mad(v3(got[1][i], got[2][i], got[3][i]), 1 / (r * r * r), d);
    worst[0] = fmax(worst[0], fabs(got[0][i] * r - 1));
    worst[1] = fmax(worst[1], v3_norm(off) * r * r);
  }
}

/* Sources on both sides of targets at once, against each side by itself; one lane is left over. */
static void test_both_sides(void **state) {
  (void)state;
  uint64_t seed = 71;
  far_harmonic *h = skf_far_harmonic_new(1e-8);
  assert_non_null(h);
  const size_t size = h->size;
  const int n = FAR_GROUP - 1;
  double *all = aligned_alloc(64, (24 + 4 * FAR_GROUP) * size * sizeof *all + 64), *next = all + 24 * size;
  double *to[2][FAR_GROUP];
  const double *from[2][FAR_GROUP];
  assert_non_null(all);
  for (int i = 0; i < n; i++)
    for (int way = 0; way < 2; way++, next += 2 * size) {
      double x[4][FAR_GATHER] = {{0}};
      for (int k = 0; k < 4; k++)
        for (int g = 0; g < FAR_GATHER; g++) x[k][g] = rnd(&seed, -0.5, 0.5);
      memset(next, 0, 2 * size * sizeof *next);
      skf_far_scalar.gather(h, (const double(*)[FAR_GATHER])x, next);
      for (size_t k = 0; k < size; k++) next[k] *= h->norm[k];
      from[way][i] = next, to[way][i] = next + size;
    }
  for (int i = 0; i < FAR_WAYS * FAR_WAYS * FAR_WAYS; i++) {
    const int s[3] = {i % FAR_WAYS - FAR_LONG, i / FAR_WAYS % FAR_WAYS - FAR_LONG, i / FAR_WAYS / FAR_WAYS - FAR_LONG};
    const int opposite[3] = {-s[0], -s[1], -s[2]};
    if (!has_way(h, s)) continue;
    assert_true(has_way(h, opposite));
    const far_move *move[2] = {&h->over[s[0] + FAR_LONG][s[1] + FAR_LONG][s[2] + FAR_LONG],
                               &h->over[FAR_LONG - s[0]][FAR_LONG - s[1]][FAR_LONG - s[2]]};
    for (int k = 0; k < n; k++)
      for (int way = 0; way < 2; way++) memset(to[way][k], 0, size * sizeof(double));
    skf_far_scalar.transfer_both(move[0], 0.5, n, (const double *const(*)[FAR_GROUP])from, to[0], all);
    for (int way = 0; way < 2; way++) skf_far_scalar.transfer(move[way], FAR_OVER, 0.5, n, from[way], to[1], all);
    for (int k = 0; k < n; k++) {
      double off = 0, most = 0;
      for (size_t c = 0; c < size; c++) {
        off = fmax(off, fabs(to[0][k][c] - to[1][k][c])), most = fmax(most, fabs(to[1][k][c]));
      }
      if (!(off <= 1e-14 * most && most > 0)) fail_msg("%d %d %d: off by %g of %g", s[0], s[1], s[2], off, most);
    }
  }
  free(all), skf_far_harmonic_free(h);
}

/* All ways there are, each turned or mirrored in one of several manners. */
static void check_harmonics(double accuracy) {
  uint64_t seed = 32;
  double worst[2] = {0, 0};
  far_harmonic *h = skf_far_harmonic_new(accuracy);
  assert_non_null(h);
  in = aligned_alloc(64, (18 * h->size + 64) / 8 * 8 * sizeof *in);
  assert_non_null(in);
  out = in + h->size, room[0] = in + (2 * h->size + 7) / 8 * 8;
  int ways = 0;
  for (int i = 0; i < 6 * 6 * 6; i++) {
    const int sorted[3] = {i % 6, i / 6 % 6, i / 36};
    if (sorted[0] < sorted[1] || sorted[1] < sorted[2] || !has_way(h, sorted)) continue;
    int shift[3];
    for (int k = 0; k < 3; k++) shift[k] = sorted[(k + i) % 3] * (rnd(&seed, -1, 1) < 0 ? -1 : 1);
    assert_true(has_way(h, shift));
    ways++;
    for (size_t m = 0; m < SOURCES; m++) {
      double y[3];
      for (int c = 0; c < 3; c++) /* a corner that faces the target, others */
        y[c] = m == 0 ? copysign(0.5, shift[c]) : m < 3 ? copysign(0.5, rnd(&seed, -1, 1)) : coordinate(&seed, m);
      carry_harmonics(h, y, shift);
      compare_harmonics(&seed, h, y, shift, worst);
    }
  }
  print_message("harmonics, %.0e: order %d, %d ways, F %.1e, gradient %.1e\n", accuracy, h->order, ways, worst[0],
                worst[1]);
  free(in), skf_far_harmonic_free(h);
  assert_int_equal(ways, 21);
  if (!(worst[0] <= accuracy && worst[1] <= accuracy)) fail_msg("not within %g", accuracy);
}

static void test_harmonics(void **state) {
  (void)state;
  for (double digits = 2; digits <= 12; digits += 0.5) check_harmonics(pow(10, -digits));
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_cells), cmocka_unit_test(test_both_sides),
                                     cmocka_unit_test(test_harmonics)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
