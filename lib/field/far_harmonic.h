/* SPDX-License-Identifier: MIT */
/* Newtonian sums in solid harmonics: order^2 coefficients instead of order^3 / 6. What the sources of one cell do to
   another, or to their parent, is carried over by turning the axes so that z leads from one to the other, moving along
   z, and turning them back [White & Head-Gordon 1996; Cheng, Greengard & Rokhlin 1999].

   Coefficients are real: that of cos(m phi) in degree l stands at l^2 + m, that of sin(m phi) at l^2 + l + m. They are
   moved in Racah's normalisation, 1/|x - y| = sum R(y) I(x), in which turning is an orthogonal matrix; evaluated in
   that of R = r^l P_l^m / (l + m)!, whose derivatives are its neighbours. Lengths are in sides of the cell. */
#ifndef SKF_FIELD_FAR_HARMONIC_H
#define SKF_FIELD_FAR_HARMONIC_H

#include "field/far_mixture.h"

enum { FAR_DEGREES = 64, FAR_GROUP = 8 };

/* Cells of an interaction list are at most FAR_LONG cells apart along one axis: children of cells two apart are. */
enum { FAR_LONG = 5, FAR_WAYS = 2 * FAR_LONG + 1, FAR_SQUARES = FAR_LONG * FAR_LONG + 3 };

/* The way from one cell to another for degrees < order: turn, for each degree the (l + 1)^2 numbers for cosines and the
   l^2 for sines; along, for each m the (order - m)^2 from degree [in] to degree [out], rows are those that come out. */
typedef struct far_move {
  int order;
  const double *turn, *along;
  double cosine, sine; /* of the azimuth */
} far_move;

/* FAR_UP: moments, to the parent; FAR_DOWN: polynomials, to the child; FAR_OVER: moments, to polynomials there */
typedef enum far_kind { FAR_UP, FAR_DOWN, FAR_OVER } far_kind;

typedef struct far_harmonic {
  int order;
  size_t size;
  double *step[2];                             /* R_lm = step[0] z R_(l-1)m - step[1] r^2 R_(l-2)m, by m, then l */
  double *norm;                                /* Racah's R over the other */
  far_move over[FAR_WAYS][FAR_WAYS][FAR_WAYS]; /* [x][y][z] of target - source; order 0: none is needed */
  far_move child[8];                           /* from the parent's middle to the child's */
  double *turns[FAR_WAYS][FAR_SQUARES], *alongs[FAR_SQUARES], *child_turn[2], *child_along;
} far_harmonic;

/* Coefficients R_lm in which 1/r between any source and target of an interaction list comes out to a relative error
   `accuracy`, of the gradient relative to 1/r^2. NULL when memory is out. */
far_harmonic *skf_far_harmonic_new(double accuracy);
/* Frees the ways between cells alone, a few MB: evaluating does without them. */
void skf_far_harmonic_free_ways(far_harmonic *h);
void skf_far_harmonic_free(far_harmonic *h);

/* Whether cells at a shift are near: neighbours, or two apart along one axis. */
static inline bool far_is_near(const int at[3]) {
  int most = 0, sum = 0;
  for (int k = 0; k < 3; k++) {
    int away = at[k] < 0 ? -at[k] : at[k];
    most = away > most ? away : most, sum += away;
  }
  return most < 2 || (most == 2 && sum == 2);
}

static inline size_t far_cosine(int l, int m) { return (size_t)(l * l + m); }
static inline size_t far_sine(int l, int m) { return (size_t)(l * l + l + m); }
/* Where (l, m) is among the pairs of m, then l */
static inline size_t far_by_m(int order, int m, int l) { return (size_t)(m * order - m * (m - 1) / 2 + l - m); }

/* All R_lm at x, l < order. */
void skf_far_regular(int order, const double x[3], double *R);
/* The coefficients of a sum's derivative along an axis: of sums of R, one order less; of sums of R(x / r^2) factorials
   / r, the fields outside, one order more. */
void skf_far_derive(int order, bool outside, int axis, const double *in, double *out);

#endif
