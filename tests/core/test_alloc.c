/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "core/alloc.h"
#include <string.h>

static void overflow_is_refused(void **state) {
  (void)state;
  assert_null(skf_alloc(SIZE_MAX / 2, 3));
  assert_null(skf_realloc(NULL, SIZE_MAX / 2, 3));
}

static void empty_arrays_are_valid(void **state) {
  (void)state;
  void *p = skf_alloc(0, 8);
  assert_non_null(p);
  skf_free(p);
}

static void failure_can_be_injected(void **state) {
  (void)state;
  skf_alloc_fail_after(2);
  void *p = skf_alloc(1, 1), *q = skf_alloc(1, 1), *r = skf_alloc(1, 1);
  assert_non_null(p);
  assert_null(q);
  assert_non_null(r);
  skf_free(p);
  skf_free(r);
}

static void every_status_has_a_text(void **state) {
  (void)state;
  for (int i = 0; i < SKF_STATUS_COUNT; i++) {
    assert_true(strlen(skf_status_text((skf_status)i)) > 3);
    for (int j = 0; j < i; j++) assert_string_not_equal(skf_status_text((skf_status)i), skf_status_text((skf_status)j));
  }
  assert_string_equal(skf_status_text((skf_status)-1), "unknown status");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(overflow_is_refused),
      cmocka_unit_test(empty_arrays_are_valid),
      cmocka_unit_test(failure_can_be_injected),
      cmocka_unit_test(every_status_has_a_text),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
