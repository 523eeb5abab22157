/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Round numbers for axes, and how they are written. */
#ifndef SKF_TOOLS_TICKS_H
#define SKF_TOOLS_TICKS_H

#include <stdbool.h>
#include <stddef.h>

enum { TICKS_MAX = 64, TICK_TEXT = 32 };

/* Ticks in [lo, hi], in growing order; `exponent` is the power of ten that the labels leave out. */
typedef struct ticks {
  int count, minor_count;
  double at[TICKS_MAX], minor[8 * TICKS_MAX];
  double step;            /* 0 when logarithmic */
  int decimals, exponent; /* of the labels; unused when logarithmic */
  double base;            /* the labels count from here */
} ticks;

/* At least two ticks, about `about`, with a step of 1, 2 or 5 times a power of ten. lo < hi, both finite. */
ticks ticks_linear(double lo, double hi, int about);
/* The same for an axis: a short range far from 0 is counted from a round number. */
ticks ticks_axis(double lo, double hi, int about);
/* Angles: steps that divide 90, or 1, 2, 5 times a power of ten below 1 degree. */
ticks ticks_degrees(double lo, double hi, int about);
/* Powers of ten, or 1, 2, 5 times powers of ten where the range is short. 0 < lo < hi. */
ticks ticks_log(double lo, double hi, int about);

/* The label of a tick in UTF-8, with a true minus sign. */
void tick_label(const ticks *t, double value, char text[TICK_TEXT]);
/* A number in plain words of `digits` digits: 0.35, −12, 6.7×10⁻¹¹. */
void tick_number(double value, int digits, char text[TICK_TEXT]);
/* "10" with its exponent raised. */
void tick_power(int exponent, char text[TICK_TEXT]);

#endif
