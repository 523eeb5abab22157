/* SPDX-License-Identifier: MIT */
/* The field of a solid far away: int dV / |x - y| = sum_n sum_m Re[w_m conj(M_nm) I_nm(x)], M_nm = int R_nm(y) dV, with
   the solid harmonics (no Condon-Shortley phase) R_nm = r^n P_n^m e^(i m phi) / (n + m)! and
   I_nm = (n - m)! P_n^m e^(i m phi) / r^(n+1), w_0 = 1, else 2 [Epton, Dembart 1995]. Derivatives only shift indices:
   d/dz I_n,m = -I_n+1,m and (d/dx +- i d/dy) I_n,m = -+ I_n+1,m+-1, so that the gradient and the Hessian are sums over
   the same I_nm with coefficients of their own. */
#include "core/alloc.h"
#include "num/gauss.h"
#include "simd/isa.h"
#include "skeleton/solid.h"
#include "skeleton/solid_far.h"
#include <complex.h>

typedef void take_fn(skf_harmonics *s);

void skf_harmonics_take(skf_harmonics *s) { harmonics_take(s); }

static take_fn *pick(void) {
#ifdef SKF_HAVE_AVX2
  if (skf_isa_pick() != SKF_ISA_SCALAR) return skf_harmonics_take_avx2;
#endif
  return skf_harmonics_take;
}

/* The cone from the centre over a face: a homogeneous polynomial of degree n has the integral 1 / (n + 3) times the
   height times that over the face, there by a k x k conical rule. */
static void add_face(skf_harmonics *s, take_fn *take, const skf_vec3 a[3], int k) {
  const skf_gauss_node *g = skf_gauss_rule(k);
  double half = 0.5 * v3_dot(a[0], v3_cross(a[1], a[2]));
  for (int i = 0; i < k; i++)
    for (int j = 0; j < k; j++) {
      double xi = 0.5 * (1 + g[i].x), eta = 0.5 * xi * (1 + g[j].x);
      skf_vec3 y = v3_mad(v3_mad(a[0], xi, v3_sub(a[1], a[0])), eta, v3_sub(a[2], a[1]));
      skf_nodes_at *q = &s->waiting;
      q->x[q->count] = y.x, q->y[q->count] = y.y, q->z[q->count] = y.z;
      q->w[q->count] = half * 0.5 * g[i].w * xi * g[j].w;
      if (++q->count == SKF_HARMONIC_LANES) take(s);
    }
}

/* So many nodes that the error of degree n stays below 1e-17 of the field where degree n counts: a face of length l
   costs (n l / 4)^(2 k) / (2 k)!, and n is worth kappa^-n; their product is largest at n = 2 k / ln kappa. */
static int order(const skf_vec3 a[3], double kappa, int degree) {
  double l = fmax(v3_dist(a[0], a[1]), fmax(v3_dist(a[1], a[2]), v3_dist(a[2], a[0]))), x = l / (4 * log(kappa));
  int exact = degree / 2 + 2, k = x < 0.5 ? (int)ceil(19.5 / -log(x)) : exact;
  return k < 2 ? 2 : k < exact ? k : exact;
}

static size_t row_of(int degree, int n, int m) { return (size_t)(m * (degree + 1) - m * (m - 1) / 2 + n - m); }

/* out: the coefficients of the derivative along an axis; Re[C I_nm] turns into terms of degree n + 1. */
static void derive(int degree, const double complex *in, int axis, double complex *out) {
  size_t rows = row_of(degree, degree, degree) + 1;
  for (size_t i = 0; i < rows; i++) out[i] = 0;
  for (int m = 0; m < degree; m++)
    for (int n = m; n < degree; n++) {
      double complex c = in[row_of(degree, n, m)], up = axis == 0 ? -0.5 * c : 0.5 * I * c;
      if (axis == 2) {
        out[row_of(degree, n + 1, m)] -= c;
        continue;
      }
      out[row_of(degree, n + 1, m + 1)] += up;
      if (m > 0)
        out[row_of(degree, n + 1, m - 1)] += axis == 0 ? 0.5 * c : 0.5 * I * c;
      else
        out[row_of(degree, n + 1, 1)] += axis == 0 ? -0.5 * conj(c) : 0.5 * I * conj(c);
    }
}

/* Columns of F, x, y, z, xx, xy, xz, yy, yz. */
static skf_status tabulate(skf_solid *s, double complex *F) {
  int N = s->degree;
  size_t rows = row_of(N, N, N) + 1;
  double complex *d = skf_alloc(9 * rows, sizeof *d);
  s->moments = skf_alloc(rows * SKF_SOLID_FAR_COLUMNS, sizeof *s->moments);
  if (!d || !s->moments) return skf_free(d), SKF_ERR_NOMEM;
  for (size_t i = 0; i < rows; i++) d[i] = F[i];
  for (int k = 0; k < 3; k++) derive(N, d, k, d + (size_t)(1 + k) * rows);
  for (int k = 0; k < 3; k++) derive(N, d + rows, k, d + (size_t)(4 + k) * rows);
  for (int k = 1; k < 3; k++) derive(N, d + 2 * rows, k, d + (size_t)(6 + k) * rows);
  for (size_t i = 0; i < rows; i++)
    for (size_t k = 0; k < 9; k++) {
      s->moments[i * SKF_SOLID_FAR_COLUMNS + 2 * k] = creal(d[k * rows + i]);
      s->moments[i * SKF_SOLID_FAR_COLUMNS + 2 * k + 1] = -cimag(d[k * rows + i]);
    }
  skf_free(d);
  return SKF_OK;
}

static int degree_at(double ratio) { /* ratio^-(n - 1) n^2 < 1e-17 */
  int n = 3;
  while (n < SKF_SOLID_FAR_MAX && (n - 1) * log(ratio) < 39.2 + 2 * log(n)) n++;
  return n;
}

skf_status skf_solid_expand(skf_solid *s) {
  /* Nearer, a sum over the faces; it loses the square of the distance over the size, less for many faces, whose errors
     are independent of each other. */
  size_t faces = s->face_count;
  double kappa = faces < 100 ? 4 : faces < 20000 ? 6 : 32, per = 1 / s->radius;
  s->far = kappa * s->radius;
  static const double bands[SKF_SOLID_BANDS] = {1, 2, 4, 16, 256};
  for (int i = 0; i < SKF_SOLID_BANDS; i++) s->band[i] = bands[i] * s->far, s->degrees[i] = degree_at(bands[i] * kappa);
  s->degree = s->degrees[0];
  size_t rows = row_of(s->degree, s->degree, s->degree) + 1;
  take_fn *take = pick();
  skf_harmonics sum = {
      .degree = s->degree, .at = skf_alloc(rows, sizeof *sum.at), .step = skf_alloc(rows, sizeof *sum.step)};
  double complex *F = skf_alloc(rows, sizeof *F);
  if (!sum.at || !sum.step || !F) return skf_free(sum.at), skf_free(sum.step), skf_free(F), SKF_ERR_NOMEM;
  for (int m = 0; m <= s->degree; m++)
    for (int n = m; n <= s->degree; n++) {
      double *step = sum.step[row_of(s->degree, n, m)];
      step[1] = 1.0 / ((n + 1 - m) * (n + 1 + m)), step[0] = (2 * n + 1) * step[1];
    }
  for (size_t i = 0; i < s->face_count; i++) {
    skf_vec3 a[3];
    for (int k = 0; k < 3; k++) a[k] = v3_scale(per, v3_sub(s->vertices[s->faces[i][k]], s->info.center));
    add_face(&sum, take, a, order(a, kappa, s->degree));
  }
  if (sum.waiting.count) take(&sum);
  for (int m = 0; m <= s->degree; m++)
    for (int n = m; n <= s->degree; n++) {
      size_t row = row_of(s->degree, n, m);
      double re = 0, im = 0, weight = (m ? 2.0 : 1.0) / (n + 3);
      for (int i = 0; i < SKF_HARMONIC_LANES; i++) re += sum.at[row][0][i], im += sum.at[row][1][i];
      F[row] = weight * (re - I * im);
    }
  skf_status status = tabulate(s, F);
  skf_free(sum.at), skf_free(sum.step), skf_free(F);
  return status;
}
