/* SPDX-License-Identifier: MIT */
/* Polynomials in the place of a smooth field within a cube, with bounds of what they are off by. */
#ifndef SKF_RAY_MODEL_H
#define SKF_RAY_MODEL_H

#include "ray/source.h"
#include "simd/isa.h"

/* Nodes along each axis; the total degree of the polynomials that rays meet, and their terms. */
enum { SKF_NODES = 8, SKF_ALL_NODES = SKF_NODES * SKF_NODES * SKF_NODES };
enum { SKF_LOW_DEGREE = 5, SKF_DEGREE = 7, SKF_TERMS = (SKF_DEGREE + 1) * (SKF_DEGREE + 2) * (SKF_DEGREE + 3) / 6 };

/* Nodes along each axis where a guess will do. */
enum { SKF_ROUGH = 4, SKF_ALL_ROUGH = SKF_ROUGH * SKF_ROUGH * SKF_ROUGH };

/* Along a ray: places in [0, 1] for samples of a polynomial, and what makes Bernstein coefficients of them. */
typedef struct skf_restriction {
  double place[SKF_DEGREE + 1], bernstein[SKF_DEGREE + 1][SKF_DEGREE + 1];
} skf_restriction;

/* The matrix of each axis in turn, on what has SKF_ALL_NODES entries. */
typedef void skf_model_apply_fn(const double a[3][SKF_NODES][SKF_NODES], double *c);
skf_model_apply_fn skf_model_apply_scalar, skf_model_apply_avx2;

/* Chebyshev's nodes and what turns values there into coefficients, coefficients into those on a half of the interval
   (the cubes are larger than the cells by 1 + slack), or into powers. */
typedef struct skf_chebyshev {
  double node[SKF_NODES], forward[SKF_NODES][SKF_NODES], half[2][SKF_NODES][SKF_NODES], power[SKF_NODES][SKF_NODES];
  double rough[SKF_ROUGH], rough_forward[SKF_ROUGH][SKF_ROUGH];
  skf_restriction low, full;   /* for SKF_LOW_DEGREE, SKF_DEGREE */
  double total[SKF_ALL_NODES]; /* degree of a model's terms, what their slopes and Hessians are at most */
  double slope[SKF_ALL_NODES], bend[SKF_ALL_NODES];
  skf_model_apply_fn *apply;
  double lebesgue; /* how much larger an interpolant can be than what it interpolates, along one axis */
} skf_chebyshev;

void skf_chebyshev_init(skf_chebyshev *t, skf_isa isa, double slack);

/* Bounds for a part of the field: of the error of its polynomial, of that of the gradient and of the Hessian, of the
   fourth derivative along any line, and of the sum of the magnitudes that the field is made of. */
typedef struct skf_margin {
  double value, slope, bend, fourth, size;
} skf_margin;

void skf_margin_add(skf_margin *sum, const skf_margin *m);

/* c[(i SKF_NODES + j) SKF_NODES + k] T_i(x) T_j(y) T_k(z), with x, y, z in [-1, 1] on the cube. */
typedef struct skf_model {
  double c[SKF_ALL_NODES];
  skf_margin off;
} skf_model;

/* Whether the field of an element is analytic wherever it has no singularity, and its Taylor coefficients are known. */
bool skf_source_is_smooth(const skf_source *s);

/* What interpolation at the nodes of a cube does to the element's field, whose supremum over the cube is `most`, all of
   whose sources are at a distance >= near from it. Infinite where it may be singular. */
skf_margin skf_margin_of(const skf_source *s, double near, double most, double half);

/* What interpolation at the rough nodes makes of its value alone. */
double skf_margin_rough(const skf_source *s, double near, double most, double half);

/* The polynomial of a cube on one of its eighths, child: bits 1, 2, 4 for the upper halves in x, y, z. */
void skf_model_halve(const skf_chebyshev *t, const skf_model *m, int child, skf_model *out);

/* Adds the interpolant of values at the nodes, z fastest, and its margin. */
void skf_model_add(const skf_chebyshev *t, const double *values, const skf_margin *off, skf_model *m);

/* Adds the interpolant of values at the rough nodes, without a margin. */
void skf_model_add_rough(const skf_chebyshev *t, const double values[SKF_ALL_ROUGH], skf_model *m);

/* The sum of what the coefficients of a total degree above `degree` can amount to; above 0: how much it changes. */
double skf_model_swing(const skf_chebyshev *t, const skf_model *m, int degree);

/* Powers up to `degree` in all, SKF_DEGREE or SKF_LOW_DEGREE: out[] of x^i y^j z^k, i, then j, then k ascending; what
   is left out is added to *off. `half`: of the cube. */
void skf_model_powers(const skf_chebyshev *t, const skf_model *m, double half, int degree, double out[SKF_TERMS],
                      skf_margin *off);

#endif
