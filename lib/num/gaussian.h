/* SPDX-License-Identifier: MIT */
/* Integrals of Gaussians over a segment and a circle, relative accuracy in the tails too. */
#ifndef SKF_NUM_GAUSSIAN_H
#define SKF_NUM_GAUSSIAN_H

/* int exp(-u^2) du from u0 to u1; width = u1 - u0 >= 0, known without cancellation. */
double skf_gaussian_span(double u0, double u1, double width);

/* e^-b I0(b), e^-b (I0(b) - I1(b)) and e^-b I1(b) / (b / 2), none of them by subtraction where it would cancel; b >= 0.
 */
void skf_bessel_scaled(double b, double *i0, double *gap, double *ratio);

#endif
