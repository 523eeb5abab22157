/* SPDX-License-Identifier: MIT */
/* The compensated sum, compiled for each instruction set to the same bits. */
#ifndef SKF_FIELD_BATCH_ADD_H
#define SKF_FIELD_BATCH_ADD_H

#include "field/batch.h"

/* The first element's share. */
static void batch_set(size_t n, double strength, const double v[4][SKF_BATCH], skf_batch_sum *sum) {
  for (int k = 0; k < 4; k++)
    for (size_t i = 0; i < n; i++) {
      sum->s[k][i] = strength * v[k][i];
      sum->low[k][i] = 0;
    }
}

/* Adds strength times v; each rounding error is found exactly [Knuth] and summed apart [Neumaier 1974]. */
static void batch_add(size_t n, double strength, const double v[4][SKF_BATCH], skf_batch_sum *sum) {
  for (int k = 0; k < 4; k++)
    for (size_t i = 0; i < n; i++) {
      double a = sum->s[k][i], b = strength * v[k][i], s = a + b, t = s - a;
      sum->s[k][i] = s;
      sum->low[k][i] += (a - (s - t)) + (b - t);
    }
}

#endif
