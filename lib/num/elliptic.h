/* SPDX-License-Identifier: MIT */
/* Elliptic integrals, to a few ulps. */
#ifndef SKF_NUM_ELLIPTIC_H
#define SKF_NUM_ELLIPTIC_H

/* Carlson's symmetric forms R_F(x, y, z) and R_D(x, y, z) [Carlson 1995; DLMF 19.16.1, 19.16.5], both from one
   duplication. x, y, z >= 0, at most one of x, y is zero, z > 0. rd may not be NULL. */
double skf_carlson(double x, double y, double z, double *rd);

/* Complete integrals of modulus k by the arithmetic-geometric mean: K = int dt/w, B = int cos^2 dt/w,
   D = int sin^2 dt/w over [0, pi/2], w^2 = 1 - k^2 sin^2 t. Takes k' in (0, 1] and 1 - k' (known without
   cancellation by the caller). */
void skf_elliptic_complete(double kp, double one_minus_kp, double *K, double *B, double *D);

#endif
