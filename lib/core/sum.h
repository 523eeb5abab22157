/* SPDX-License-Identifier: MIT */
/* Sums whose rounding errors are found exactly [Knuth] and kept apart [Neumaier 1974]. */
#ifndef SKF_CORE_SUM_H
#define SKF_CORE_SUM_H

#include <math.h>

typedef struct skf_sum {
  double high, low;
} skf_sum;

static inline void sum_add_to(double *high, double *low, double x) {
  double s = *high + x, b = s - *high;
  *low += (*high - (s - b)) + (x - b);
  *high = s;
}

static inline void sum_add(skf_sum *s, double x) { sum_add_to(&s->high, &s->low, x); }

static inline double sum_total(skf_sum s) { return isfinite(s.high) ? s.high + s.low : s.high; }

#endif
