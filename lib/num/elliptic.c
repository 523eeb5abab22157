/* SPDX-License-Identifier: MIT */
#include "num/elliptic.h"
#include "core/vec3.h"

static double spread(double A, double x, double y, double z) {
  return fmax(fabs(A - x), fmax(fabs(A - y), fabs(A - z)));
}

/* Tails of the series in the deviations from the mean, up to the seventh order [DLMF 19.36.1, 19.36.2]. */
static double rf_tail(double X, double Y) {
  double Z = -X - Y, E2 = X * Y - Z * Z, E3 = X * Y * Z;
  return 1 - E2 / 10 + E3 / 14 + E2 * E2 / 24 - 3 * E2 * E3 / 44 - 5 * E2 * E2 * E2 / 208 + 3 * E3 * E3 / 104 +
         E2 * E2 * E3 / 16;
}

static double rd_tail(double X, double Y) {
  double Z = -(X + Y) / 3, XY = X * Y, Z2 = Z * Z;
  double E2 = XY - 6 * Z2, E3 = (3 * XY - 8 * Z2) * Z, E4 = 3 * (XY - Z2) * Z2, E5 = XY * Z2 * Z;
  return 1 - 3 * E2 / 14 + E3 / 6 + 9 * E2 * E2 / 88 - 3 * E4 / 22 - 9 * E2 * E3 / 52 + 3 * E5 / 26 -
         E2 * E2 * E2 / 16 + 3 * E3 * E3 / 40 + 3 * E2 * E4 / 20 + 45 * E2 * E2 * E3 / 272 -
         9 * (E3 * E4 + E2 * E5) / 68;
}

double skf_carlson(double x, double y, double z, double *rd) {
  double A = (x + y + z) / 3, C = (x + y + 3 * z) / 5;
  /* (3 eps)^(-1/8) = 90 and (eps / 4)^(-1/8) = 120 leave a truncation below one ulp */
  double qf = 90 * spread(A, x, y, z), qd = 120 * spread(C, x, y, z), f = 1, S = 0;
  while (f * qf > A || f * qd > C) {
    double sx = sqrt(x), sy = sqrt(y), sz = sqrt(z), l = sx * (sy + sz) + sy * sz;
    S += f / (sz * (z + l));
    x = 0.25 * (x + l), y = 0.25 * (y + l), z = 0.25 * (z + l);
    A = 0.25 * (A + l), C = 0.25 * (C + l);
    f *= 0.25;
  }
  *rd = f * rd_tail((C - x) / C, (C - y) / C) / (C * sqrt(C)) + 3 * S;
  return rf_tail((A - x) / A, (A - y) / A) / sqrt(A);
}

/* S = 1/2 + sum 2^(n-1) c_n^2 / k^2 gives D = K S; each term is kept as e_n = c_n^2 / k^2 so that k = 0 is no
   exception. */
void skf_elliptic_complete(double kp, double one_minus_kp, double *K, double *B, double *D) {
  double a = 0.5 * (1 + kp), g = sqrt(kp), c = 0.5 * one_minus_kp, e = 0.25 * one_minus_kp / (1 + kp), t = 1;
  double S = 0.5 + e;
  while (c > 1e-9 * a) { /* the next c is c^2 / 4a */
    double next = 0.5 * (a + g);
    g = sqrt(a * g);
    e *= c * c / (16 * next * next);
    c = c * c / (4 * next);
    a = next;
    t *= 2;
    S += t * e;
  }
  *K = SKF_PI / (2 * a);
  *D = *K * S;
  *B = *K - *D;
}
