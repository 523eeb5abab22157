/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "core/number.h"
#include <string.h>

static uint64_t state64 = 88172645463325252u;

static uint64_t next(void) {
  state64 ^= state64 << 13, state64 ^= state64 >> 7, state64 ^= state64 << 17;
  return state64;
}

static void check_number(double x) {
  char want[64], got[SKF_NUMBER_SIZE];
  snprintf(want, sizeof want, "%.17g", x);
  size_t n = skf_number_write(got, x), used;
  assert_string_equal(got, want);
  assert_int_equal(n, strlen(want));
  if (!isfinite(x)) return;
  double back;
  assert_int_equal(skf_number_read(got, &used, &back), SKF_OK);
  assert_int_equal(used, n);
  assert_memory_equal(&x, &back, sizeof x);
}

static void random_bits_round_trip(void **state) {
  (void)state;
  for (int i = 0; i < 200000; i++) {
    uint64_t bits = next();
    double x;
    memcpy(&x, &bits, sizeof x);
    check_number(x == x ? x : 1);
    check_number((double)(int64_t)bits * 0x1p-63);                    /* ordinary sizes */
    check_number((double)(int32_t)bits / 1024);                       /* ties between two decimals */
    check_number(ldexp((double)(bits >> 40), (int)(bits % 70) - 35)); /* short mantissas */
  }
  const double special[] = {0,
                            -0.0,
                            1,
                            0.1,
                            1e16,
                            1e17,
                            99999999999999999.0,
                            1e22,
                            1e23,
                            5e-324,
                            2.2250738585072014e-308,
                            2.225073858507201e-308,
                            1.7976931348623157e308,
                            1e-4,
                            9.9999999999999995e-5,
                            123456,
                            INFINITY,
                            -INFINITY};
  for (size_t i = 0; i < sizeof special / sizeof *special; i++) check_number(special[i]);
}

static void nan_has_no_sign(void **state) {
  (void)state;
  char text[SKF_NUMBER_SIZE];
  assert_int_equal(skf_number_write(text, copysign(NAN, -1)), 3);
  assert_string_equal(text, "nan");
}

static void decimals_read_as_strtod_reads_them(void **state) {
  (void)state;
  char text[64];
  for (int i = 0; i < 300000; i++) {
    uint64_t a = next(), b = next();
    int digits = 1 + (int)(b % 25), exponent = (int)(b >> 32) % 680 - 340;
    snprintf(text, sizeof text, "%.*s.%llue%d", digits > 19 ? 1 : 0, "7",
             (unsigned long long)(digits < 19 ? a % (1ull << (3 * digits)) : a), exponent);
    double want = strtod(text, NULL), got = -1;
    size_t used;
    skf_status s = skf_number_read(text, &used, &got);
    assert_int_equal(used, strlen(text));
    if (isinf(want)) {
      assert_int_equal(s, SKF_ERR_RANGE);
    } else {
      assert_int_equal(s, SKF_OK);
      if (memcmp(&got, &want, sizeof want) != 0) fail_msg("%s: %.17g, expected %.17g", text, got, want);
    }
  }
}

static void forms(void **state) {
  (void)state;
  const struct {
    const char *text;
    size_t used;
    double value;
  } good[] = {{"1", 1, 1},
              {"+.5", 3, .5},
              {"5.", 2, 5},
              {"-0", 2, -0.0},
              {"1e3", 3, 1000},
              {"1e", 1, 1},
              {"1e+", 1, 1},
              {"0x10", 1, 0},
              {"010", 3, 10},
              {"1_000", 1, 1},
              {"1.0e-12,", 7, 1e-12},
              {"0.5abc", 3, .5},
              {"1e-999999999999", 15, 0},
              {"0e999999999999", 14, 0},
              {"1.2.3", 3, 1.2},
              {"9007199254740993", 16, 9007199254740992.0}, /* a tie, to even */
              {"9007199254740993.00000000000000000000000000001", 46, 9007199254740994.0},
              {"1797693134862315700000000000000000000000000000000000000000000000000000000000000000000e224", 89,
               1.7976931348623157e308}};
  for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
    size_t used;
    double x;
    assert_int_equal(skf_number_read(good[i].text, &used, &x), SKF_OK);
    assert_int_equal(used, good[i].used);
    assert_memory_equal(&x, &good[i].value, sizeof x);
  }
  const char *bad[] = {"", "-", ".", "e5", "nan", "inf", ".inf", "-.nan", " 1", "+-1"};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    size_t used;
    double x;
    assert_int_equal(skf_number_read(bad[i], &used, &x), SKF_ERR_PARSE);
  }
  size_t used;
  double x;
  assert_int_equal(skf_number_read("1e999", &used, &x), SKF_ERR_RANGE);
  assert_int_equal(skf_number_read("1.8e308", &used, &x), SKF_ERR_RANGE);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(random_bits_round_trip),
      cmocka_unit_test(nan_has_no_sign),
      cmocka_unit_test(decimals_read_as_strtod_reads_them),
      cmocka_unit_test(forms),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
