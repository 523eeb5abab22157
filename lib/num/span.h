/* SPDX-License-Identifier: MIT */
/* Integrals of powers of cos t and sin t between two angles, to a few ulps for any span, however short and wherever it
   lies: every term of the formulas is positive. */
#ifndef SKF_NUM_SPAN_H
#define SKF_NUM_SPAN_H

/* From angle t0 to t1: delta = t1 - t0 in [0, pi], sigma = t0 + t1. */
typedef struct skf_span {
  double delta, sin_delta, cos_delta;
  double sin_sigma, cos_sigma;
  double c, s; /* cos^2(sigma / 2), sin^2(sigma / 2) */
} skf_span;

/* Between two plane vectors of lengths with product N: cross = N sin delta, dot = N cos delta. */
skf_span skf_span_new(double cross, double dot, double N, double cos_sigma, double sin_sigma);
/* delta = pi, whatever sigma */
skf_span skf_span_half_turn(void);

double skf_span_c2(const skf_span *a);   /* int cos^2 */
double skf_span_s2(const skf_span *a);   /* int sin^2 */
double skf_span_c4(const skf_span *a);   /* int cos^4 */
double skf_span_s4(const skf_span *a);   /* int sin^4 */
double skf_span_c2s2(const skf_span *a); /* int cos^2 sin^2 */
double skf_span_c6(const skf_span *a);   /* int cos^6 */
double skf_span_s6(const skf_span *a);   /* int sin^6 */
/* int cos^4 sin^2 and int cos^2 sin^4 */
void skf_span_mixed6(const skf_span *a, double *c4s2, double *c2s4);

/* 1 - cos delta */
double skf_span_versine(const skf_span *a);

/* x - sin x, 3 x - 4 sin x + sin(2x) / 2 and 10 x - 15 sin x + 3 sin 2x - sin(3x) / 3 for x >= 0: 2, 8 and 32 times the
   integral of sin^2, sin^4 and sin^6 over [-x/2, x/2]; they start with x^3, x^5, x^7 */
double skf_sine_gap3(double x);
double skf_sine_gap5(double x);
double skf_sine_gap7(double x);

/* gap3(delta) / sin^3 delta, gap3(2 delta) / sin^3 delta and gap5(delta) / sin^5 delta for delta <= 1/2, 0 too */
double skf_span_gap3(const skf_span *a);
double skf_span_double_gap3(const skf_span *a);
double skf_span_gap5(const skf_span *a);

#endif
