/* SPDX-License-Identifier: MIT */
/* Kernels between distant cells as sums of Gaussians. A Gaussian is a product over the coordinates, so that what a cell
   of sources does to a cell of targets is a small matrix along each axis, whatever the kernel.

   1/r, 1/r^2 and Cauchy are y^-alpha with y = r^2 + c^2, alpha = 1/2, 1, 2, and
   Gamma(alpha) y^-alpha = int t^(alpha-1) exp(-t y) dt, by the trapezoidal rule after a substitution that makes both
   tails vanish quickly. */
#ifndef SKF_FIELD_FAR_MIXTURE_H
#define SKF_FIELD_FAR_MIXTURE_H

#include "field/kernel.h"

/* FAR_ORDER: polynomials are kept up to that total degree. FAR_REACH: cells of an interaction list are at most that
 * many cells apart along each axis. */
enum { FAR_ORDER = 48, FAR_TERMS = 64, FAR_REACH = 3, FAR_SHIFTS = 2 * FAR_REACH + 1 };
/* Nodes of the interpolation that gives a Gaussian's coefficients along an axis */
enum { FAR_NODES = 56 };
/* Half-width of the cube on which polynomials are expanded over that of the cell, for sources and for targets, whose
   gradients would lose more at the cube's faces. */
#define FAR_WIDE (1 + 1.0 / 16)

typedef struct far_matrix {
  double m[FAR_ORDER][FAR_ORDER]; /* [in][out] */
} far_matrix;

/* One Gaussian, w exp(-t r^2) with r in sides of a cell: for sources `shift` - FAR_REACH cells away along an axis
   exp = sum along[shift].m[i][j] T_j(target) T_i(source); `last` is that with w in it. */
typedef struct far_term {
  double t, w;
  int order;                /* only polynomials of a smaller total degree matter */
  bool matters[FAR_SHIFTS]; /* whether sources at that shift do */
  far_matrix along[FAR_SHIFTS], last[FAR_SHIFTS];
} far_term;

typedef struct far_mixture {
  int count, order; /* order: the largest of the terms' */
  far_term term[FAR_TERMS];
} far_mixture;

/* Whether skf_far_mixture_make knows this kernel. */
bool skf_far_kernel(skf_kernel_type type);

/* For cells of the given side [L]: the kernel to a relative error `accuracy` (gradient: of F / r) between any source
   and target of an interaction list. False when the orders do not suffice. */
bool skf_far_mixture_make(skf_kernel kernel, double side, double accuracy, far_mixture *out);

/* Coefficients [j][i] of exp(-t (FAR_WIDE (x - y) / 2 - shift)^2) in T_j(x) T_i(y). */
void skf_far_gaussian(double t, double shift, double c[FAR_NODES][FAR_NODES]);

/* T_0 .. T_(n-1) at x */
static inline void far_chebyshev(double x, int n, double *T) {
  T[0] = 1, T[1] = x;
  for (int i = 2; i < n; i++) T[i] = 2 * x * T[i - 1] - T[i - 2];
}

/* T_j(slope x + offset) = sum_i m[j][i] T_i(x), i <= j < n */
void skf_far_shift_matrix(double slope, double offset, int n, far_matrix *out);

#endif
