/* SPDX-License-Identifier: MIT */
/* Round numbers of axes, and iso-lines. */
#include "check.h"
#include "contour.h"
#include "ticks.h"
#include <string.h>

static void check_ticks(const ticks *t, double lo, double hi) {
  assert_true(t->count >= 2 && t->count <= 30);
  double slack = 1e-8 * (hi - lo);
  for (int i = 0; i < t->count; i++) {
    assert_true(t->at[i] >= lo - slack && t->at[i] <= hi + slack);
    if (i) check_scaled(t->at[i] - t->at[i - 1], t->step, fmax(fabs(hi), fabs(lo)), 1e-14);
    double k = t->at[i] / t->step;
    check_scaled(k, round(k), fmax(1, fabs(k)), 1e-12);
  }
  assert_true(t->at[0] - t->step < lo + slack && t->at[t->count - 1] + t->step > hi - slack); /* none is left out */
  double digit = t->step / pow(10, floor(log10(t->step) + 1e-9));
  assert_true(fabs(digit - 1) < 1e-9 || fabs(digit - 2) < 1e-9 || fabs(digit - 5) < 1e-9);
}

static void steps_are_round(void **state) {
  (void)state;
  const double widths[] = {1, 1.4, 2.7, 3.3, 4.9, 6.1, 8.8, 9.99};
  for (int e = -12; e <= 12; e += 3)
    for (size_t i = 0; i < sizeof widths / sizeof *widths; i++)
      for (int about = 2; about <= 14; about += 3)
        for (int shift = -3; shift <= 3; shift++) {
          double w = widths[i] * pow(10, e), lo = shift * 0.37 * w;
          ticks t = ticks_linear(lo, lo + w, about);
          check_ticks(&t, lo, lo + w);
          /* Labels read back as the tick. */
          for (int k = 0; k < t.count; k++) {
            char text[TICK_TEXT], ascii[TICK_TEXT] = "", *out = ascii;
            tick_label(&t, t.at[k], text);
            for (const char *p = text; *p; p++) {
              if (!strncmp(p, "\xe2\x88\x92", 3))
                *out++ = '-', p += 2;
              else
                *out++ = *p;
            }
            *out = 0;
            check_scaled(atof(ascii) * pow(10, t.exponent), t.at[k], t.step, 1e-6);
          }
        }
}

/* Far from 0 the labels count from a round number, and stay short. */
static void short_ranges_far_away(void **state) {
  (void)state;
  for (int sign = -1; sign <= 1; sign += 2)
    for (int e = 6; e <= 14; e++) {
      double far = sign * 3 * pow(10, e);
      ticks t = ticks_axis(far - 2.3, far + 2.3, 8);
      check_ticks(&t, far - 2.3, far + 2.3);
      assert_true(t.base == far && t.exponent == 0);
      for (int i = 0; i < t.count; i++) {
        char text[TICK_TEXT];
        tick_label(&t, t.at[i], text);
        bool minus = !strncmp(text, "\xe2\x88\x92", 3);
        assert_true(strlen(text) <= 6 && (minus ? -1 : 1) * atof(text + (minus ? 3 : 0)) == t.at[i] - far);
      }
    }
  ticks t = ticks_axis(-1, 3, 8), same = ticks_linear(-1, 3, 8);
  assert_true(t.base == 0 && t.step == same.step && t.decimals == same.decimals);
}

static void angles_have_their_own_steps(void **state) {
  (void)state;
  const struct {
    double lo, hi, step;
    int about, count;
  } cases[] = {
      {-180, 180, 30, 12, 13}, {-90, 90, 45, 4, 5}, {-180, 180, 90, 4, 5}, {-90, 90, 15, 12, 13}, {0, 40, 5, 8, 9}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    ticks t = ticks_degrees(cases[i].lo, cases[i].hi, cases[i].about);
    assert_true(t.step == cases[i].step);
    assert_int_equal(t.count, cases[i].count);
    assert_true(t.at[0] == cases[i].lo && t.at[t.count - 1] == cases[i].hi);
    assert_true(t.minor_count > t.count);
  }
  assert_true(ticks_degrees(0, 0.4, 8).step == 0.05);
}

static void logarithmic_ticks(void **state) {
  (void)state;
  ticks t = ticks_log(0.5, 2e6, 8);
  assert_int_equal(t.count, 7);
  for (int i = 0; i < t.count; i++) check_close(t.at[i], pow(10, i), 1e-14);
  t = ticks_log(1, 50, 8);
  const double want[] = {1, 2, 5, 10, 20, 50};
  assert_int_equal(t.count, 6);
  for (int i = 0; i < 6; i++) check_close(t.at[i], want[i], 1e-14);
  t = ticks_log(1e-200, 1e200, 8);
  assert_true(t.count >= 4 && t.count <= 10);
}

static void numbers_in_words(void **state) {
  (void)state;
  static const struct {
    double value;
    const char *text;
  } table[] = {{0.35, "0.35"},
               {-12, "\xe2\x88\x92"
                     "12"},
               {0, "0"},
               {6.674e-11, "6.674\xc3\x97"
                           "10\xe2\x81\xbb\xc2\xb9\xc2\xb9"},
               {1e7, "10\xe2\x81\xb7"},
               {12345, "12345"}};
  for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
    char text[TICK_TEXT];
    tick_number(table[i].value, 4, text);
    assert_string_equal(text, table[i].text);
  }
}

enum { NX = 61, NY = 47 };

static double at(const double *v, const double xy[2]) {
  int i = xy[0] < NX - 1 ? (int)xy[0] : NX - 2, j = xy[1] < NY - 1 ? (int)xy[1] : NY - 2;
  double s = xy[0] - i, t = xy[1] - j;
  const double *p = v + j * NX + i;
  return (1 - t) * ((1 - s) * p[0] + s * p[1]) + t * ((1 - s) * p[NX] + s * p[NX + 1]);
}

static void lines_lie_on_their_level(void **state) {
  (void)state;
  double v[NX * NY];
  for (int k = 0; k < NX * NY; k++) {
    double x = (k % NX - 30) / 10.0, y = (k / NX - 23) / 10.0;
    v[k] = sin(2 * x) * cos(3 * y) + 0.1 * x;
  }
  for (double level = -0.95; level < 1; level += 0.13) {
    contours c;
    size_t crossings = 0, points = 0;
    assert_true(contour_find(v, NX, NY, level, &c));
    for (int k = 0; k < NX * NY; k++) {
      if (k % NX < NX - 1) crossings += (v[k] > level) != (v[k + 1] > level);
      if (k / NX < NY - 1) crossings += (v[k] > level) != (v[k + NX] > level);
    }
    for (size_t i = 0; i < c.count; i++) {
      const contour *l = c.lines + i;
      points += l->n;
      for (size_t k = 0; k < l->n; k++) {
        check_scaled(at(v, l->xy[k]), level, 1, 1e-12);
        if (k) assert_true(hypot(l->xy[k][0] - l->xy[k - 1][0], l->xy[k][1] - l->xy[k - 1][1]) < 1.5);
      }
      const double *a = l->xy[0], *b = l->xy[l->n - 1];
      if (l->closed) assert_true(hypot(a[0] - b[0], a[1] - b[1]) < 1.5);
      for (int end = 0; end < 2 && !l->closed; end++) { /* open lines end at the border */
        const double *p = end ? b : a;
        assert_true(p[0] == 0 || p[1] == 0 || p[0] == NX - 1 || p[1] == NY - 1);
      }
    }
    assert_int_equal(points, crossings); /* each crossing of the grid's edges once */
    contour_free(&c);
  }
}

static void holes_and_infinities(void **state) {
  (void)state;
  double v[NX * NY];
  for (int k = 0; k < NX * NY; k++) v[k] = 1 / hypot(k % NX - 30, k / NX - 23);
  contours c;
  assert_true(isinf(v[23 * NX + 30]));
  assert_true(contour_find(v, NX, NY, 0.1, &c));
  assert_int_equal(c.count, 1);
  assert_true(c.lines[0].closed);
  for (size_t k = 0; k < c.lines[0].n; k++)
    check_close(hypot(c.lines[0].xy[k][0] - 30, c.lines[0].xy[k][1] - 23), 10.0, 3e-3);
  contour_free(&c);
  assert_true(contour_find(v, NX, NY, 2, &c)); /* about the singular value alone */
  assert_int_equal(c.count, 1);
  contour_free(&c);
  v[23 * NX + 40] = NAN;
  assert_true(contour_find(v, NX, NY, 0.1, &c));
  assert_int_equal(c.count, 1);
  assert_false(c.lines[0].closed);
  contour_free(&c);
  for (int k = 0; k < NX * NY; k++) v[k] = 0.25;
  assert_true(contour_find(v, NX, NY, 0.25, &c)); /* nothing crosses */
  assert_int_equal(c.count, 0);
  contour_free(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(steps_are_round),          cmocka_unit_test(angles_have_their_own_steps),
      cmocka_unit_test(logarithmic_ticks),        cmocka_unit_test(numbers_in_words),
      cmocka_unit_test(lines_lie_on_their_level), cmocka_unit_test(holes_and_infinities),
      cmocka_unit_test(short_ranges_far_away),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
