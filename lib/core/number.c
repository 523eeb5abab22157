/* SPDX-License-Identifier: MIT */
/* A double times a power of ten is formed with 128 bits; the rare case in which the error of that product could change
   the rounding goes to the C library's exact functions, in the C locale. */
#include "core/number.h"
#include <inttypes.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef unsigned __int128 u128;

enum { FINE = 27, COARSE_FIRST = -13 }; /* 5^27 is the last power of five in 64 bits; 5^351 covers every double */

/* 5^(27 i) for i = -13 .. 12, cut to its leading 128 bits. */
static const uint64_t coarse[][2] = {
    {0x8049a4ac0c5811ae, 0x205b896d777d6278}, /* 5^-351 */
    {0xcf42894a5dce35ea, 0x52064cac828675b9}, /* 5^-324 */
    {0xa76c582338ed2621, 0xaf2af2b80af6f24e}, /* 5^-297 */
    {0x873e4f75e2224e68, 0x5a7744a6e804a291}, /* 5^-270 */
    {0xda7f5bf590966848, 0xaf39a475506a899e}, /* 5^-243 */
    {0xb080392cc4349dec, 0xbd8d794d96aacfb3}, /* 5^-216 */
    {0x8e938662882af53e, 0x547eb47b7282ee9c}, /* 5^-189 */
    {0xe65829b3046b0afa, 0x0cb4a5a3112a5112}, /* 5^-162 */
    {0xba121a4650e4ddeb, 0x92f34d62616ce413}, /* 5^-135 */
    {0x964e858c91ba2655, 0x3a6a07f8d510f86f}, /* 5^-108 */
    {0xf2d56790ab41c2a2, 0xfae27299423fb9c3}, /* 5^-81 */
    {0xc428d05aa4751e4c, 0xaa97e14c3c26b886}, /* 5^-54 */
    {0x9e74d1b791e07e48, 0x775ea264cf55347d}, /* 5^-27 */
    {0x8000000000000000, 0x0000000000000000}, /* 5^0 */
    {0xcecb8f27f4200f3a, 0x0000000000000000}, /* 5^27 */
    {0xa70c3c40a64e6c51, 0x999090b65f67d924}, /* 5^54 */
    {0x86f0ac99b4e8dafd, 0x69a028bb3ded71a3}, /* 5^81 */
    {0xda01ee641a708de9, 0xe80e6f4820cc9495}, /* 5^108 */
    {0xb01ae745b101e9e4, 0x5ec05dcff72e7f8f}, /* 5^135 */
    {0x8e41ade9fbebc27d, 0x14588f13be847307}, /* 5^162 */
    {0xe5d3ef282a242e81, 0x8f1668c8a86da5fa}, /* 5^189 */
    {0xb9a74a0637ce2ee1, 0x6d953e2bd7173692}, /* 5^216 */
    {0x95f83d0a1fb69cd9, 0x4abdaf101564f98e}, /* 5^243 */
    {0xf24a01a73cf2dccf, 0xbc633b39673c8cec}, /* 5^270 */
    {0xc3b8358109e84f07, 0x0a862f80ec4700c8}, /* 5^297 */
    {0x9e19db92b4e31ba9, 0x6c07a2c26a8346d1}, /* 5^324 */
};

static uint64_t five(int n) { /* 5^n, n <= 27 */
  static const uint64_t table[] = {1, 5, 25, 125, 625, 3125, 15625, 78125, 390625};
  return n < 9 ? table[n] : n < 18 ? UINT64_C(1953125) * table[n - 9] : UINT64_C(3814697265625) * table[n - 18];
}

/* m 10^q = (result + d) 2^*e with 0 <= d < 8 and 2^127 <= result < 2^128, for m > 0 and -351 <= q < 351. */
static u128 scaled(uint64_t m, int q, int *e) {
  int i = (q - COARSE_FIRST * FINE) / FINE;
  int j = q - (i + COARSE_FIRST) * FINE;
  u128 a = (u128)m * five(j);
  int shift = a >> 64 ? __builtin_clzll((uint64_t)(a >> 64)) : 64 + __builtin_clzll((uint64_t)a);
  a <<= shift;
  uint64_t a1 = (uint64_t)(a >> 64), a0 = (uint64_t)a, c1 = coarse[i][0], c0 = coarse[i][1];
  u128 x = (u128)a1 * c0, y = (u128)a0 * c1, z = (u128)a0 * c0;
  u128 carry = ((u128)(uint64_t)x + (uint64_t)y + (uint64_t)(z >> 64)) >> 64;
  u128 top = (u128)a1 * c1 + (uint64_t)(x >> 64) + (uint64_t)(y >> 64) + carry;
  int log2_coarse = ((i + COARSE_FIRST) * FINE * 1217359) >> 19; /* floor(n log2(5)), exact for |n| < 3000 */
  *e = q - shift + log2_coarse + 1;
  if (top >> 127) return top;
  *e -= 1;
  return top << 1;
}

static bool near(u128 rest, u128 half) { return rest + 16 > half && rest < half + 16; }

/* The digits of a number, at most 19 of them, times 10^exponent. */
typedef struct decimal {
  uint64_t digits;
  long exponent;
  bool exact, negative; /* not exact: a digit that is not 0 was dropped */
} decimal;

static size_t scan(const char *s, decimal *d) {
  const char *p = s;
  *d = (decimal){.exact = true};
  if (*p == '+' || *p == '-') d->negative = *p++ == '-';
  bool any = false, fraction = false;
  for (;; p++) {
    unsigned c = (unsigned)(*p - '0');
    if (c < 10) {
      any = true;
      if (d->digits < UINT64_C(1000000000000000000)) {
        d->digits = 10 * d->digits + c;
        d->exponent -= fraction;
      } else {
        if (c) d->exact = false;
        d->exponent += !fraction;
      }
    } else if (*p == '.' && !fraction) {
      fraction = true;
    } else {
      break;
    }
  }
  if (!any) return 0;
  const char *q = p;
  if (*q == 'e' || *q == 'E') {
    q++;
    bool minus = *q == '-';
    if (*q == '+' || *q == '-') q++;
    if ((unsigned)(*q - '0') < 10) {
      long e = 0;
      for (; (unsigned)(*q - '0') < 10; q++) e = e < 100000000 ? 10 * e + (*q - '0') : e;
      d->exponent += minus ? -e : e;
      p = q;
    }
  }
  return (size_t)(p - s);
}

/* The C locale for this thread, for as long as the library's functions are used. */
static locale_t enter_c(locale_t *old) {
  locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0); /* glibc hands out a constant: it cannot fail there */
  *old = c ? uselocale(c) : (locale_t)0;
  return c;
}

static void leave_c(locale_t c, locale_t old) {
  if (!c) return;
  uselocale(old);
  freelocale(c);
}

static double from_library(const char *text) {
  locale_t old, c = enter_c(&old);
  double x = strtod(text, NULL);
  leave_c(c, old);
  return x;
}

skf_status skf_number_read(const char *text, size_t *used, double *out) {
  decimal d;
  *used = scan(text, &d);
  if (!*used) return SKF_ERR_PARSE;
  double x = 0;
  if (d.digits) {
    int e = 0;
    u128 v = 0;
    bool sure = d.exact && d.exponent > -330 && d.exponent < 330;
    if (sure) {
      v = scaled(d.digits, (int)d.exponent, &e);
      sure = !near(v & (((u128)1 << 75) - 1), (u128)1 << 74) && e + 127 >= -1022 && e + 127 < 1023;
    }
    if (sure)
      x = ldexp((double)(uint64_t)((v >> 75) + (v >> 74 & 1)), e + 75);
    else
      x = fabs(from_library(text));
    if (isinf(x)) return SKF_ERR_RANGE;
  }
  *out = d.negative ? -x : x;
  return SKF_OK;
}

static size_t to_library(char *text, double x) { /* zero, ties between two decimals, and what is not finite */
  if (isnan(x)) x = (double)NAN;                 /* never "-nan" */
  locale_t old, c = enter_c(&old);
  int n = snprintf(text, SKF_NUMBER_SIZE, "%.17g", x);
  leave_c(c, old);
  return (size_t)n;
}

/* 17 digits of x > 0, with 10^power the place of the first; false when it cannot tell how to round. */
static bool digits17(double x, uint64_t *digits, int *power) {
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  int e = (int)(bits >> 52 & 0x7ff);
  uint64_t m = bits & ((UINT64_C(1) << 52) - 1);
  if (e) m |= UINT64_C(1) << 52;
  e = e ? e - 1075 : -1074;
  *power = ((e + 63 - __builtin_clzll(m)) * 78913) >> 18; /* floor(n log10(2)): right, or one too low */
  for (;; ++*power) {
    int shift;
    u128 v = scaled(m, 16 - *power, &shift);
    shift = -(shift + e);
    uint64_t d = (uint64_t)(v >> shift);
    u128 rest = v & (((u128)1 << shift) - 1), half = (u128)1 << (shift - 1);
    if (d >= UINT64_C(100000000000000000)) continue;
    if (near(rest, half)) return false;
    d += rest > half;
    if (d == UINT64_C(100000000000000000)) d /= 10, ++*power;
    *digits = d;
    return true;
  }
}

static char *put(char *p, const char *s, int n) { return memcpy(p, s, (size_t)n), p + n; }

size_t skf_number_write(char text[SKF_NUMBER_SIZE], double x) {
  uint64_t d;
  int power;
  char *p = text, digit[17];
  if (x == 0 || !isfinite(x) || !digits17(fabs(x), &d, &power)) return to_library(text, x);
  for (int i = 16; i >= 0; i--, d /= 10) digit[i] = (char)('0' + d % 10);
  int n = 17;
  while (n > 1 && digit[n - 1] == '0') n--;
  if (signbit(x)) *p++ = '-';
  if (power < -4 || power >= 17) {
    *p++ = digit[0];
    if (n > 1) *p++ = '.', p = put(p, digit + 1, n - 1);
    int a = abs(power);
    *p++ = 'e', *p++ = power < 0 ? '-' : '+';
    if (a >= 100) *p++ = (char)('0' + a / 100);
    *p++ = (char)('0' + a / 10 % 10), *p++ = (char)('0' + a % 10);
  } else if (power < 0) {
    p = put(p, "0.000", 1 - power);
    p = put(p, digit, n);
  } else {
    int whole = power + 1;
    p = put(p, digit, whole);
    if (n > whole) *p++ = '.', p = put(p, digit + whole, n - whole);
  }
  *p = 0;
  return (size_t)(p - text);
}
