/* SPDX-License-Identifier: MIT */
/* Mutated scenes and failing allocations: always a scene or an error with a line, never a crash or a leak. */
#include "scene/scene_text.h"
#include "core/alloc.h"
#include "random.h"

static uint64_t seed = 2026;

static size_t below(size_t n) { return (size_t)rnd(&seed, 0, (double)n); }

static const char *const pieces[] = {
    "nan",       ".inf",         "1e999", "-",    "- ",   "{",  "}",    "[",    "]",      ":",       ": ",
    ",",         "\n",           "\n  ",  "#",    "&a ",  "*a", "!!f ", "'",    "\"",     "|\n",     ">",
    "? ",        "---\n",        "\t",    "\x00", "\xff", "\\", "1e3",  "-0",   "1e-320", "name: a", "iso:",
    "skeleton:", "kernel: ",     "%",     "[[[[", "}}}}", "~",  "@",    "\r\n", "...",    "360",     "1e308",
    "\u2028",    "strength: -1",
};

/* Deletes, repeats, replaces and inserts; keeps the length below the capacity. */
static size_t mutate(char *text, size_t n, size_t capacity) {
  for (size_t count = 1 + below(2); count; count--) {
    size_t at = below(n + 1), length = below(12);
    if (at + length > n) length = n - at;
    const char *piece = pieces[below(sizeof pieces / sizeof *pieces)];
    size_t m = *piece ? strlen(piece) : 1;
    switch (below(4)) {
    case 0: memmove(text + at, text + at + length, n - at - length), n -= length; break;
    case 1:
      if (n + length < capacity) memmove(text + at + length, text + at, n - at), n += length;
      break;
    case 2:
      if (n) text[below(n)] = (char)(below(4) ? 32 + below(95) : below(256));
      break;
    default:
      if (n + m < capacity) memmove(text + at + m, text + at, n - at), memcpy(text + at, piece, m), n += m;
    }
  }
  return n;
}

static long lines_of(const char *text, size_t n) {
  long lines = 1;
  for (size_t i = 0; i < n; i++) lines += text[i] == '\n' || text[i] == '\r' || (unsigned char)text[i] >= 0x80;
  return lines;
}

static void mutations_are_scenes_or_errors(void **state) {
  (void)state;
  enum { CAPACITY = 1 << 13, ROUNDS = 12000 };
  char *text = malloc(CAPACITY), *all = read_malformed();
  const char *place = all;
  size_t accepted = 0;
  for (int i = 0; i < ROUNDS; i++) {
    malformed m = {.text = i % 3 == 0 ? small_scene : i % 3 == 1 ? full_scene : handled_scene};
    m.length = strlen(m.text);
    if (i % 4 == 0 && !(place = next_malformed(place, &m))) place = all;
    memcpy(text, m.text, m.length);
    size_t n = mutate(text, m.length, CAPACITY);
    skf_scene *scene;
    skf_error e;
    skf_status s = skf_scene_parse(text, n, ".", &scene, &e);
    assert_true((s == SKF_OK) == (scene != NULL));
    if (s && !(e.line >= 1 && e.line <= lines_of(text, n)))
      fail_msg("round %d: line %ld of %ld: %s", i, e.line, lines_of(text, n), e.text);
    if (s) assert_true(e.text[0] && !strchr(e.text, '\n'));
    accepted += s == SKF_OK;
    skf_scene_free(scene);
  }
  assert_true(accepted > ROUNDS / 100 && accepted < ROUNDS / 2); /* the mutations are neither too weak nor too strong */
  free(all);
  free(text);
}

static void fail_each_allocation(const char *text) {
  skf_scene *scene = NULL;
  skf_status s = SKF_ERR_NOMEM;
  long k = 1;
  for (; s; k++) {
    skf_error e;
    skf_alloc_fail_after(k);
    s = parse(text, &scene, &e);
    skf_alloc_fail_after(0);
    if (!s) break;
    assert_int_equal(s, SKF_ERR_NOMEM);
    assert_int_equal(e.status, SKF_ERR_NOMEM);
    assert_null(scene);
    assert_true(k < 1000);
  }
  assert_true(k > 10);
  skf_scene_free(scene);
}

static void failing_allocations_are_errors(void **state) {
  (void)state;
  fail_each_allocation(full_scene);
  fail_each_allocation(handled_scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(mutations_are_scenes_or_errors),
      cmocka_unit_test(failing_allocations_are_errors),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
