/* SPDX-License-Identifier: MIT */
/* Which instructions are taken: what is asked for, never more than there is. */
#include "check.h"
#include "simd/isa.h"
#include <stdlib.h>

static skf_isa ask(const char *name) {
  setenv("SKELFIELD_ISA", name, 1);
  skf_isa isa = skf_isa_pick();
  unsetenv("SKELFIELD_ISA");
  return isa;
}

static void test_pick(void **state) {
  (void)state;
  unsetenv("SKELFIELD_ISA");
  skf_isa best = skf_isa_pick();
  static const char *const names[] = {"scalar", "avx2", "avx512"};
  print_message("best here: %s\n", names[best]);
  for (int i = 0; i < 3; i++) assert_int_equal(ask(names[i]), i < (int)best ? i : (int)best);
  assert_int_equal(ask("no such set"), best);
  assert_int_equal(ask(""), best);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_pick)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
