/* SPDX-License-Identifier: MIT */
/* Cubics on [0, 1] in Bernstein form: b[0] at 0, b[3] at 1. */
#ifndef SKF_RAY_CUBIC_H
#define SKF_RAY_CUBIC_H

#include <stdbool.h>

/* From values and derivatives (by the unit parameter) at 0 and 1. */
void skf_cubic_hermite(double f0, double d0, double f1, double d1, double b[4]);

double skf_cubic_at(const double b[4], double x);

/* The exact range on [0, 1]. */
void skf_cubic_range(const double b[4], double *lo, double *hi);

/* Whether |derivative| > margin with one sign on all of [0, 1]. */
bool skf_cubic_steep(const double b[4], double margin);

/* A root in [0, 1] where b[0] and b[3] differ in sign: one of them, if there are three. */
double skf_cubic_root(const double b[4]);

/* All roots in [0, 1] where the sign changes, in order; returns their number. Double roots are none. */
int skf_cubic_roots(const double b[4], double roots[3]);

#endif
