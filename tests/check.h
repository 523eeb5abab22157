/* SPDX-License-Identifier: MIT */
/* cmocka, and comparisons that are relative. */
#ifndef SKF_TESTS_CHECK_H
#define SKF_TESTS_CHECK_H

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Fails unless |got - want| <= tol * scale; NaN always fails. */
#define check_scaled(got, want, scale, tol)                                                                            \
  do {                                                                                                                 \
    double got_ = (got), want_ = (want), bound_ = (tol) * (scale);                                                     \
    if (!(fabs(got_ - want_) <= bound_))                                                                               \
      fail_msg("%s = %.17g, expected %.17g: off by %.3g, allowed %.3g", #got, got_, want_, fabs(got_ - want_),         \
               bound_);                                                                                                \
  } while (0)

#define check_close(got, want, tol) check_scaled(got, want, fabs((double)(want)), tol)

#endif
