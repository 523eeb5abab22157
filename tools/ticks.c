/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Round numbers for axes, and how they are written. */
#include "ticks.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* m 10^e, correctly rounded. */
static double decimal(double m, int e) { return e >= 0 ? m * pow(10, e) : m / pow(10, -e); }

/* The step's digit (1, 2, 5) and its power of ten. */
static int round_step(double rough, int *power) {
  *power = (int)floor(log10(rough));
  double f = rough / decimal(1, *power);
  int digit = f < 1.5 ? 1 : f < 3.5 ? 2 : f < 7.5 ? 5 : 10;
  if (digit == 10) ++*power, digit = 1;
  return digit;
}

/* Multiples of digit 10^power in [lo, hi]; ends that differ from a multiple by rounding count. */
static int multiples(double lo, double hi, int digit, int power, double *out, int capacity) {
  double step = decimal(digit, power), slack = 1e-9 * (hi - lo) / step;
  double first = ceil(lo / step - slack), last = floor(hi / step + slack);
  int n = 0;
  for (double k = first; k <= last && n < capacity; k++) out[n++] = decimal(k * digit, power);
  return n;
}

ticks ticks_linear(double lo, double hi, int about) {
  ticks t = {0};
  int power, digit = round_step((hi - lo) / about, &power);
  t.count = multiples(lo, hi, digit, power, t.at, TICKS_MAX);
  if (t.count < 2) {
    digit = digit == 5 ? 2 : digit == 2 ? 1 : 5;
    power -= digit == 5;
    t.count = multiples(lo, hi, digit, power, t.at, TICKS_MAX);
  }
  t.step = decimal(digit, power);
  bool halves = digit == 2; /* steps of 2 are cut into 4, others into 5 */
  t.minor_count = multiples(lo, hi,
                            halves       ? 5
                            : digit == 5 ? 1
                                         : 2,
                            digit == 5 ? power : power - 1, t.minor, sizeof t.minor / sizeof *t.minor);
  double largest = fmax(fabs(lo), fabs(hi));
  int top = (int)floor(log10(largest));
  if (top >= 5 || top < -3) t.exponent = top;
  t.decimals = power < t.exponent ? t.exponent - power : 0;
  return t;
}

ticks ticks_axis(double lo, double hi, int about) {
  ticks t = ticks_linear(lo, hi, about);
  double largest = fmax(fabs(lo), fabs(hi));
  if (!(t.step < 1e-5 * largest)) return t;
  int power = (int)ceil(log10(hi - lo)), step = (int)floor(log10(t.step) + 1e-9);
  double base = decimal(round((lo + (hi - lo) / 2) / decimal(1, power)), power);
  int top = (int)floor(log10(fmax(fabs(lo - base), fabs(hi - base))));
  t.base = base;
  t.exponent = top >= 5 || top < -3 ? top : 0;
  t.decimals = step < t.exponent ? t.exponent - step : 0;
  return t;
}

ticks ticks_degrees(double lo, double hi, int about) {
  static const int steps[] = {1, 2, 5, 10, 15, 30, 45, 90}, minor[] = {1, 1, 1, 5, 5, 10, 15, 30};
  enum { STEPS = sizeof steps / sizeof *steps };
  int i = 0;
  while (i < STEPS && (hi - lo) / steps[i] > about + 1) i++;
  if (i == 0 || i == STEPS) return ticks_linear(lo, hi, about);
  ticks t = {.step = steps[i]};
  t.count = multiples(lo, hi, steps[i], 0, t.at, TICKS_MAX);
  t.minor_count = multiples(lo, hi, minor[i], 0, t.minor, sizeof t.minor / sizeof *t.minor);
  return t;
}

ticks ticks_log(double lo, double hi, int about) {
  ticks t = {0};
  int first = (int)floor(log10(lo)), last = (int)ceil(log10(hi));
  double decades = log10(hi) - log10(lo); /* the quotient may overflow */
  int stride = (int)ceil(decades / about);
  if (stride < 1) stride = 1;
  for (int e = first; e <= last; e++)
    for (int d = 1; d < 10; d++) {
      double v = decimal(d, e);
      if (v < lo * (1 - 1e-9) || v > hi * (1 + 1e-9)) continue;
      bool wanted = d == 1 ? e % stride == 0 : decades < 2.5 && (d == 2 || d == 5);
      if (wanted && t.count < TICKS_MAX)
        t.at[t.count++] = v;
      else if (!wanted && stride == 1 && t.minor_count < 8 * TICKS_MAX)
        t.minor[t.minor_count++] = v;
    }
  return t.count >= 2 ? t : ticks_linear(lo, hi, about);
}

static void raise_number(int n, char *text) {
  static const char *const digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  char plain[16];
  snprintf(plain, sizeof plain, "%d", n);
  *text = 0;
  for (const char *p = plain; *p; p++) strcat(text, *p == '-' ? "⁻" : digits[*p - '0']);
}

void tick_power(int exponent, char text[TICK_TEXT]) {
  char raised[24];
  raise_number(exponent, raised);
  snprintf(text, TICK_TEXT, "10%s", raised);
}

void tick_number(double value, int digits, char text[TICK_TEXT]) {
  char plain[TICK_TEXT];
  const char *sign = value < 0 ? "−" : "";
  snprintf(plain, sizeof plain, "%.*e", digits - 1, fabs(value));
  int power = atoi(strchr(plain, 'e') + 1);
  if (value == 0 || (power >= -3 && power < 5)) {
    snprintf(plain, sizeof plain, "%.*g", digits > power + 1 ? digits : power + 1, fabs(value));
    snprintf(text, TICK_TEXT, "%s%.24s", sign, plain);
    return;
  }
  char *end = strchr(plain, 'e'), raised[24];
  *end = 0;
  while (strchr(plain, '.') && (end[-1] == '0' || end[-1] == '.')) *--end = 0;
  raise_number(power, raised);
  if (!strcmp(plain, "1"))
    snprintf(text, TICK_TEXT, "%s10%s", sign, raised);
  else
    snprintf(text, TICK_TEXT, "%s%.8s×10%.12s", sign, plain, raised);
}

void tick_label(const ticks *t, double value, char text[TICK_TEXT]) {
  if (t->step > 0) {
    double from = value - t->base, shown = from / decimal(1, t->exponent);
    if (fabs(from) < 1e-6 * t->step) shown = 0;
    snprintf(text, TICK_TEXT, "%s%.*f", shown < 0 ? "−" : "", t->decimals, fabs(shown));
  } else {
    tick_number(value, 3, text);
  }
}
