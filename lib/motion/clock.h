/* SPDX-License-Identifier: MIT */
/* Time to twice the precision of a double, so that long runs do not see time's own rounding, and angles of it. */
#ifndef SKF_MOTION_CLOCK_H
#define SKF_MOTION_CLOCK_H

#include "core/vec3.h"

/* hi + lo with |lo| <= ulp(hi) / 2 */
typedef struct skf_clock {
  double hi, lo;
} skf_clock;

static inline skf_clock clock_add(skf_clock t, double h) {
  double s = t.hi + h, b = s - t.hi, e = (t.hi - (s - b)) + (h - b) + t.lo;
  double hi = s + e;
  return (skf_clock){hi, e - (hi - s)};
}

/* t - origin, rounded once or twice */
static inline double clock_since(double t, skf_clock origin) { return (t - origin.hi) - origin.lo; }

/* rate t, reduced to [-pi, pi] up to rounding; good to about 1e-16 for |rate t| up to 1e9. */
static inline double clock_angle(skf_clock t, double rate) {
  const double tau = 6.283185307179586, tau_low = 2.4492935982947064e-16; /* 2 pi = tau + tau_low */
  double p = rate * t.hi, e = fma(rate, t.hi, -p) + rate * t.lo;
  double k = rint(p / tau);
  return fma(-k, tau, p) + fma(-k, tau_low, e);
}

#endif
