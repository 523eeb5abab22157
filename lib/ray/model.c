/* SPDX-License-Identifier: MIT */
/* Interpolation at Chebyshev's nodes. Along one axis the k-th derivative of f - If is at most
   max |w^(k)| max |f^(n)| / n!, w = the product of the distances from the n nodes [Shadrin 1995]. With E = 1 - I along
   each axis, what three axes are off by is Ex + Ey + Ez - Ex Ey - Ey Ez - Ez Ex + Ex Ey Ez. Derivatives along several
   axes are at most those of the same order along some line [Banach 1938], and f^(n) / n! along a line is a Taylor
   coefficient: 1 / (1 - 2 x t + t^2)^l has those of Gegenbauer, |C_n| <= binomial(n + 2 l - 1, n). */
#include "ray/model.h"
#include "core/vec3.h"
#include <float.h>
#include <string.h>

enum { N = SKF_NODES, M = SKF_ROUGH };

static void polynomials(double x, double T[N]) {
  T[0] = 1, T[1] = x;
  for (int i = 2; i < N; i++) T[i] = 2 * x * T[i - 1] - T[i - 2];
}

static void transform(const skf_chebyshev *t, const double values[N], double c[N]) {
  for (int i = 0; i < N; i++) {
    c[i] = 0;
    for (int p = 0; p < N; p++) c[i] += t->forward[i][p] * values[p];
  }
}

/* binomial(n + k, k) */
static double choose(int n, int k) {
  double b = 1;
  for (int i = 1; i <= k; i++) b = b * (n + i) / i;
  return b;
}

static double power(double x, int n) {
  double y = 1;
  for (int i = 0; i < n; i++) y *= x;
  return y;
}

/* The inverse of Bernstein's polynomials at the places, by elimination: a well-conditioned matrix. */
static void along_rays(int n, skf_restriction *out) {
  double a[SKF_DEGREE + 1][2 * SKF_DEGREE + 2] = {{0}};
  for (int i = 0; i <= n; i++) {
    double u = out->place[i] = 0.5 - 0.5 * cos(i * SKF_PI / n);
    for (int k = 0; k <= n; k++) a[i][k] = choose(n - k, k) * power(u, k) * power(1 - u, n - k);
    a[i][n + 1 + i] = 1;
  }
  for (int i = 0; i <= n; i++) {
    int best = i;
    for (int r = i; r <= n; r++)
      if (fabs(a[r][i]) > fabs(a[best][i])) best = r;
    for (int k = 0; k < 2 * n + 2; k++) {
      double x = a[best][k];
      a[best][k] = a[i][k], a[i][k] = x;
    }
    for (int r = 0; r <= n; r++) {
      double f = r == i ? 0 : a[r][i] / a[i][i];
      for (int k = 0; k < 2 * n + 2 && f != 0; k++) a[r][k] -= f * a[i][k];
    }
  }
  for (int i = 0; i <= n; i++)
    for (int k = 0; k <= n; k++) out->bernstein[i][k] = a[i][n + 1 + k] / a[i][i];
}

/* |T_n'| <= n^2, |T_n''| <= n^2 (n^2 - 1) / 3; a Hessian's norm is at most its largest row. */
static void sizes(skf_chebyshev *t) {
  for (int i = 0; i < SKF_ALL_NODES; i++) {
    int x = i / (N * N), y = i / N % N, z = i % N, x2 = x * x, y2 = y * y, z2 = z * z;
    double xx = x2 * (x2 - 1) / 3. + x2 * (y2 + z2), yy = y2 * (y2 - 1) / 3. + y2 * (x2 + z2),
           zz = z2 * (z2 - 1) / 3. + z2 * (x2 + y2);
    t->total[i] = x + y + z, t->slope[i] = sqrt(x2 * x2 + y2 * y2 + z2 * z2), t->bend[i] = fmax(xx, fmax(yy, zz));
  }
}

void skf_chebyshev_init(skf_chebyshev *t, skf_isa isa, double slack) {
  double T[N], values[N], c[N];
  memset(t, 0, sizeof *t);
  for (int p = 0; p < N; p++) {
    t->node[p] = cos((2 * p + 1) * SKF_PI / (2 * N));
    polynomials(t->node[p], T);
    for (int i = 0; i < N; i++) t->forward[i][p] = (i ? 2. : 1.) / N * T[i];
  }
  for (int p = 0; p < M; p++) {
    t->rough[p] = cos((2 * p + 1) * SKF_PI / (2 * M));
    polynomials(t->rough[p], T);
    for (int i = 0; i < M; i++) t->rough_forward[i][p] = (i ? 2. : 1.) / M * T[i];
  }
  for (int upper = 0; upper < 2; upper++)
    for (int i = 0; i < N; i++) {
      for (int p = 0; p < N; p++) {
        polynomials(0.5 * t->node[p] + (upper ? 0.5 : -0.5) / (1 + slack), T);
        values[p] = T[i];
      }
      transform(t, values, c);
      for (int k = 0; k <= i; k++) t->half[upper][k][i] = c[k];
    }
  t->power[0][0] = 1, t->power[1][1] = 1;
  for (int i = 2; i < N; i++)
    for (int k = 0; k <= i; k++) t->power[k][i] = (k ? 2 * t->power[k - 1][i - 1] : 0) - t->power[k][i - 2];
  sizes(t);
  t->apply = skf_model_apply_scalar;
#ifdef SKF_HAVE_AVX2
  if (isa != SKF_ISA_SCALAR) t->apply = skf_model_apply_avx2;
#else
  (void)isa;
#endif
  along_rays(SKF_LOW_DEGREE, &t->low), along_rays(SKF_DEGREE, &t->full);
  t->lebesgue = 2 / SKF_PI * log(N) + 1; /* an upper bound [Rivlin 1974] */
}

bool skf_source_is_smooth(const skf_source *s) {
  skf_kernel_type k = s->element.kernel.type;
  skf_shape shape = s->element.primitive.shape;
  return (k == SKF_CAUCHY || k == SKF_INVERSE || k == SKF_INVERSE_SQUARED || k == SKF_GAUSSIAN) &&
         (shape == SKF_POINT || shape == SKF_SEGMENT || shape == SKF_ARC || shape == SKF_TRIANGLE);
}

/* Of the n-th Taylor coefficient of the element's field along any line, times reach^n. For the Gaussian by Cramer's
   bound of Hermite's polynomials. */
static double taylor(const skf_source *s, double near, double most, double reach, int n) {
  double p = s->element.kernel.param;
  if (s->element.kernel.type == SKF_GAUSSIAN) {
    double factorial = 1;
    for (int i = 2; i <= n; i++) factorial *= i;
    return 1.0866 * s->measure * exp(-0.5 * p * near * p * near) * power(1.4142135623730952 * p * reach, n) /
           sqrt(factorial);
  }
  bool cauchy = s->element.kernel.type == SKF_CAUCHY;
  int order = cauchy ? 3 : s->element.kernel.type == SKF_INVERSE_SQUARED ? 1 : 0;
  double distance = cauchy ? sqrt(near * near + 1 / (p * p)) : near;
  return distance > 0 ? most * choose(n, order) * power(reach / distance, n) : INFINITY;
}

/* The factor from one term of the series at half the cube to the next, roughly. Where it is below 1/4, derivatives of
   products of E are at most what n^2 and n^4 / 3 say, whatever the axis. */
static double converges(const skf_source *s, double near, double half) {
  double p = s->element.kernel.param;
  if (s->element.kernel.type == SKF_GAUSSIAN) return p * half / 4;
  return 0.7 * half / (s->element.kernel.type == SKF_CAUCHY ? sqrt(near * near + 1 / (p * p)) : near);
}

/* Of a weight 1 what one of the axes leaves, and what two and three of them leave at once, with n nodes along each. */
static double by_one(const skf_source *s, double near, double most, double half, int n) {
  return 2 * taylor(s, near, most, 0.5 * half, n) * (1 + 1e-9);
}
static double by_more(const skf_source *s, double near, double most, double half, int n) {
  double two = 4 * taylor(s, near, most, 0.5 * half, 2 * n) * choose(n, n);
  double three = 8 * taylor(s, near, most, 0.5 * half, 3 * n) * choose(n, n) * choose(2 * n, n);
  return (3 * two + three) * (1 + 1e-9);
}

skf_margin skf_margin_of(const skf_source *s, double near, double most, double half) {
  double w = fmax(fabs(s->least), fabs(s->most)), per = 1 / half, n2 = N * N, curl = n2 * (n2 - 1) / 3;
  near *= 1 - 1e-12;
  double e = w * by_one(s, near, most, half, N), all = w * by_more(s, near, most, half, N);
  /* what one leaves derived along another, once and twice */
  double once = 4 * w * taylor(s, near, most, 0.5 * half, N + 1) * (N + 1) * (1 + 1e-9),
         twice = 8 * w * taylor(s, near, most, 0.5 * half, N + 2) * (N + 1) * (N + 2) * (1 + 1e-9);
  if (!(converges(s, near, half) < 0.25)) return (skf_margin){INFINITY, INFINITY, INFINITY, INFINITY, w * most};
  return (skf_margin){3 * e + all, 1.7320508075688773 * (n2 * (e + all) + 2 * once) * per,
                      (curl * (e + all) + 2 * twice + 2 * (2 * n2 * once + twice + n2 * n2 * all)) * per * per,
                      24 * w * taylor(s, near, most, 1, 4), w * most};
}

double skf_margin_rough(const skf_source *s, double near, double most, double half) {
  near *= 1 - 1e-12;
  return fmax(fabs(s->least), fabs(s->most)) * (3 * by_one(s, near, most, half, M) + by_more(s, near, most, half, M));
}

void skf_margin_add(skf_margin *sum, const skf_margin *m) {
  sum->value += m->value, sum->slope += m->slope, sum->bend += m->bend;
  sum->fourth += m->fourth, sum->size += m->size;
}

static void spread(const double a[N][N], double all[3][N][N]) {
  for (int axis = 0; axis < 3; axis++) memcpy(all[axis], a, sizeof all[axis]);
}

void skf_model_halve(const skf_chebyshev *t, const skf_model *m, int child, skf_model *out) {
  double a[3][N][N];
  for (int axis = 0; axis < 3; axis++) memcpy(a[axis], t->half[child >> axis & 1], sizeof a[axis]);
  *out = *m;
  t->apply((const double(*)[N][N])a, out->c);
}

void skf_model_add(const skf_chebyshev *t, const double *values, const skf_margin *off, skf_model *m) {
  double a[3][N][N], c[SKF_ALL_NODES];
  spread(t->forward, a);
  memcpy(c, values, sizeof c);
  t->apply((const double(*)[N][N])a, c);
  for (int i = 0; i < SKF_ALL_NODES; i++) m->c[i] += c[i];
  skf_margin_add(&m->off, off);
}

/* Along the last axis, which then is the first. */
static void turn_rough(const double a[M][M], const double in[M * M][M], double out[M][M * M]) {
  for (int k = 0; k < M; k++)
    for (int i = 0; i < M * M; i++) {
      out[k][i] = 0;
      for (int p = 0; p < M; p++) out[k][i] += a[k][p] * in[i][p];
    }
}

void skf_model_add_rough(const skf_chebyshev *t, const double values[SKF_ALL_ROUGH], skf_model *m) {
  double c[M * M][M], turned[M][M * M];
  memcpy(c, values, sizeof c);
  for (int axis = 0; axis < 3; axis++) {
    turn_rough(t->rough_forward, (const double(*)[M])c, turned);
    memcpy(c, turned, sizeof c);
  }
  for (int i = 0; i < SKF_ALL_ROUGH; i++)
    m->c[(i / M / M * N + i / M % M) * N + i % M] += turned[i / M / M][i % (M * M)];
}

double skf_model_swing(const skf_chebyshev *t, const skf_model *m, int degree) {
  double sum[4] = {0};
  for (int i = 0; i < SKF_ALL_NODES; i += 4)
    for (int k = 0; k < 4; k++) sum[k] += t->total[i + k] > degree ? fabs(m->c[i + k]) : 0;
  return sum[0] + sum[1] + sum[2] + sum[3];
}

void skf_model_powers(const skf_chebyshev *t, const skf_model *m, double half, int degree, double out[SKF_TERMS],
                      skf_margin *off) {
  double a[3][N][N], c[SKF_ALL_NODES], per = 1 / half, all = 0, value = 0, slope = 0, bend = 0;
  for (int i = 0; i < SKF_ALL_NODES; i++) {
    double size = fabs(m->c[i]);
    bool keep = t->total[i] <= degree;
    c[i] = keep ? m->c[i] : 0, all += size;
    size = keep ? 0 : size;
    value += size, slope += size * t->slope[i], bend += size * t->bend[i];
  }
  off->value += value, off->slope += slope * per, off->bend += bend * per * per;
  spread(t->power, a);
  t->apply((const double(*)[N][N])a, c);
  for (int i = 0, n = 0; i <= degree; i++)
    for (int j = 0; i + j <= degree; j++)
      for (int k = 0; i + j + k <= degree; k++) out[n++] = c[(i * N + j) * N + k];
  off->value += 4096 * DBL_EPSILON * all; /* powers are up to (1 + sqrt 2)^5 = 82 times larger than Chebyshev's */
}
