/* SPDX-License-Identifier: MIT */
#include "num/span.h"
#include "core/vec3.h"

static double horner(const double *c, int n, double y) {
  double s = 0;
  while (n--) s = s * y + c[n];
  return s;
}

/* Taylor coefficients of the three gaps; the series carry one ulp up to the switch. */
static double series3(double y) {
  static const double c[] = {1 / 6.,        -1 / 120.,        1 / 5040.,          -1 / 362880.,
                             1 / 39916800., -1 / 6227020800., 1 / 1307674368000., -1 / 355687428096000.};
  return horner(c, 8, y);
}

double skf_sine_gap3(double x) { return x > 1 ? x - sin(x) : x * x * x * series3(x * x); }

static double series5(double y) {
  static const double c[] = {0.1,
                             -60 / 5040.,
                             252 / 362880.,
                             -1020 / 39916800.,
                             4092 / 6227020800.,
                             -16380 / 1307674368000.,
                             65532 / 355687428096000.,
                             -262140 / 121645100408832000.,
                             1048572 / 51090942171709440000.,
                             -4194300 / 2.585201673888498e22,
                             16777212 / 1.5511210043330986e25,
                             -67108860 / 1.0888869450418352e28,
                             268435452 / 8.841761993739702e30};
  return horner(c, 13, y);
}

double skf_sine_gap5(double x) {
  double y = x * x;
  return x > 1.5 ? 3 * x - 4 * sin(x) + 0.5 * sin(2 * x) : x * y * y * series5(y);
}

double skf_sine_gap7(double x) {
  static const double c[] = {0.07142857142857142,     -0.013888888888888888,  0.0013257575757575758,
                             -8.14000814000814e-05,   3.5824514991181657e-06, -1.1991854822737176e-07,
                             3.1719127092108154e-09,  -6.81234835776282e-11,  1.212899330706236e-12,
                             -1.820160209366688e-14,  2.334000960092654e-16,  -2.587174576564771e-18,
                             2.5038152674820214e-20,  -2.133970563317503e-22, 1.613939786278317e-24,
                             -1.0905036001831197e-26, 6.622501605942462e-29,  -3.634302126884203e-31};
  if (x > 2) return 10 * x - 15 * sin(x) + 3 * sin(2 * x) - sin(3 * x) / 3;
  double y = x * x;
  return x * y * y * y * horner(c, 18, y);
}

skf_span skf_span_new(double cross, double dot, double N, double cos_sigma, double sin_sigma) {
  skf_span a = {.delta = atan2(cross, dot),
                .sin_delta = cross / N,
                .cos_delta = dot / N,
                .sin_sigma = sin_sigma,
                .cos_sigma = cos_sigma};
  double near = 0.5 * (1 + fabs(cos_sigma)), far = 0.5 * sin_sigma * sin_sigma / (1 + fabs(cos_sigma));
  a.c = cos_sigma >= 0 ? near : far;
  a.s = cos_sigma >= 0 ? far : near;
  return a;
}

skf_span skf_span_half_turn(void) {
  return (skf_span){.delta = SKF_PI, .cos_delta = -1, .cos_sigma = 0, .sin_sigma = 0, .c = 0.5, .s = 0.5};
}

double skf_span_versine(const skf_span *a) {
  return a->cos_delta > 0 ? a->sin_delta * a->sin_delta / (1 + a->cos_delta) : 1 - a->cos_delta;
}

/* The integrals are polynomials in c (or s) whose coefficients depend on delta only. */
static double second(const skf_span *a, double c) { return 0.5 * (skf_sine_gap3(a->delta) + 2 * c * a->sin_delta); }

static double fourth(const skf_span *a, double c) {
  return skf_sine_gap5(a->delta) / 8 + c * a->sin_delta * (skf_span_versine(a) + c * a->cos_delta);
}

static double sixth(const skf_span *a, double c) {
  double C = a->cos_delta, v = skf_span_versine(a);
  double p = 3 * v * v + 2 * c * v * (1 + 4 * C) + 4. / 3 * c * c * (4 * C * C - 1);
  return (skf_sine_gap7(a->delta) + 8 * c * a->sin_delta * p) / 32;
}

double skf_span_c2(const skf_span *a) { return second(a, a->c); }
double skf_span_s2(const skf_span *a) { return second(a, a->s); }
double skf_span_c4(const skf_span *a) { return fourth(a, a->c); }
double skf_span_s4(const skf_span *a) { return fourth(a, a->s); }
double skf_span_c6(const skf_span *a) { return sixth(a, a->c); }
double skf_span_s6(const skf_span *a) { return sixth(a, a->s); }

double skf_span_c2s2(const skf_span *a) {
  return (skf_sine_gap3(2 * a->delta) + 4 * a->sin_delta * a->cos_delta * a->sin_sigma * a->sin_sigma) / 16;
}

/* c4s2 - c2s4 = [sin^3 2t] / 24 */
void skf_span_mixed6(const skf_span *a, double *c4s2, double *c2s4) {
  double sum = skf_span_c2s2(a), p = a->sin_sigma * a->cos_delta, q = a->cos_sigma * a->sin_delta;
  double difference = q * (3 * p * p + q * q) / 12;
  *c4s2 = 0.5 * (sum + difference);
  *c2s4 = 0.5 * (sum - difference);
  if (*c4s2 < sum / 8) *c4s2 = skf_span_c4(a) - skf_span_c6(a);
  if (*c2s4 < sum / 8) *c2s4 = skf_span_s4(a) - skf_span_s6(a);
}

static double unsine(const skf_span *a) { return a->delta > 0 ? a->delta / a->sin_delta : 1; }

double skf_span_gap3(const skf_span *a) {
  double q = unsine(a);
  return q * q * q * series3(a->delta * a->delta);
}

double skf_span_double_gap3(const skf_span *a) {
  double q = unsine(a);
  return 8 * q * q * q * series3(4 * a->delta * a->delta);
}

double skf_span_gap5(const skf_span *a) {
  double q = unsine(a);
  return q * q * q * q * q * series5(a->delta * a->delta);
}
