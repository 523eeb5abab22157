/* SPDX-License-Identifier: MIT */
/* Scenes that must be refused, with the line and the words of the message. */
#include "scene/scene_text.h"

static void check_refused(const char *name, const char *text, size_t length, long line, const char *part) {
  skf_scene *scene = (skf_scene *)&line;
  skf_error e;
  skf_status s = skf_scene_parse(text, length, ".", &scene, &e);
  if (s == SKF_OK) fail_msg("%s: accepted", name);
  assert_null(scene);
  assert_int_equal(s, e.status);
  if (e.line != line) fail_msg("%s: line %ld, expected %ld: %s", name, e.line, line, e.text);
  if (!strstr(e.text, part)) fail_msg("%s: '%s', expected to find '%s'", name, e.text, part);
  if (!strstr(e.text, "expected")) fail_msg("%s: '%s' does not tell what was expected", name, e.text);
  if (strlen(e.text) + 1 >= sizeof e.text) fail_msg("%s: '%s' is cut off", name, e.text);
  for (const char *p = e.text; *p; p++) assert_true((unsigned char)*p >= 32);
  assert_int_equal(skf_scene_parse(text, length, ".", &scene, NULL), s);
}

static void every_malformed_scene_is_refused(void **state) {
  (void)state;
  char *all = read_malformed();
  malformed m;
  int n = 0;
  for (const char *p = all; (p = next_malformed(p, &m)); n++) check_refused(m.name, m.text, m.length, m.line, m.part);
  free(all);
  assert_true(n > 100);
}

static void bytes_that_are_no_text(void **state) {
  (void)state;
  static const struct {
    const char *name, *text;
    size_t length;
    long line;
    const char *part;
  } cases[] = {
      {"an empty file", "", 0, 1, "nothing in the file"},
      {"spaces", "  \n \n", 5, 1, "nothing in the file"},
      {"a NUL", "skelfield: 1\nbodies: \0\n", 23, 2, "expected UTF-8 text"},
      {"only NULs", "\0\0\0\0", 4, 1, "expected UTF-8 text"},
      {"a bell", "skelfield: 1\n\a\n", 15, 2, "expected UTF-8 text"},
      {"invalid UTF-8", "skelfield: 1\n# \xff\xfe\n", 17, 2, "expected UTF-8 text"},
      {"a cut UTF-8 character", "skelfield: 1\n# \xe2\x82", 17, 2, "expected UTF-8 text"},
      {"UTF-16", "\xff\xfes\0k\0", 6, 1, "expected UTF-8 text"},
      {"a PNG", "\x89PNG\r\n\x1a\n", 8, 1, "expected UTF-8 text"},
      {"an ELF",
       "\x7f"
       "ELF\x02\x01\x01",
       7, 1, "expected"},
      {"a NUL as an escape", "skelfield: 1\nbodies: \"a\\0\"\n", 27, 2, "NUL character"},
      {"a NUL hides in a key", "\"skelfield\\0\": 1\n", 17, 1, "NUL character"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    check_refused(cases[i].name, cases[i].text, cases[i].length, cases[i].line, cases[i].part);
}

/* Every prefix is refused, or is a scene: the list of bodies is complete from some length on. */
static void every_truncation_is_refused_or_whole(void **state) {
  (void)state;
  size_t whole = 0;
  for (size_t n = 0; n < sizeof full_scene - 1; n++) {
    skf_scene *scene;
    skf_error e;
    skf_status s = skf_scene_parse(full_scene, n, ".", &scene, &e);
    if (s) assert_true(e.line >= 1);
    whole += s == SKF_OK;
    skf_scene_free(scene);
  }
  assert_true(whole > 0 && whole < 100);
}

static void huge_files_are_refused(void **state) {
  (void)state;
  size_t n = ((size_t)64 << 20) + 1;
  char *text = malloc(n);
  memset(text, ' ', n);
  skf_scene *scene;
  skf_error e;
  assert_int_equal(skf_scene_parse(text, n, ".", &scene, &e), SKF_ERR_RANGE);
  assert_non_null(strstr(e.text, "larger than 64 MB"));
  memset(text, '[', 1 << 20); /* deep nesting ends at once, whatever follows */
  assert_int_equal(skf_scene_parse(text, 1 << 20, ".", &scene, &e), SKF_ERR_PARSE);
  assert_int_equal(e.line, 1);
  free(text);
}

static void unreadable_files_are_refused(void **state) {
  (void)state;
  skf_scene *scene;
  skf_error e;
  assert_int_equal(skf_scene_read("/nonexistent/scene.yaml", &scene, &e), SKF_ERR_IO);
  assert_int_equal(e.line, 0);
  assert_null(scene);
  assert_int_equal(skf_scene_read("/", &scene, &e), SKF_ERR_IO);
  assert_non_null(strstr(e.text, "directory"));
  assert_int_equal(skf_scene_read("/dev/zero", &scene, &e), SKF_ERR_RANGE);
  assert_int_equal(skf_scene_read("/dev/null", &scene, &e), SKF_ERR_PARSE);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_malformed_scene_is_refused),     cmocka_unit_test(bytes_that_are_no_text),
      cmocka_unit_test(every_truncation_is_refused_or_whole), cmocka_unit_test(huge_files_are_refused),
      cmocka_unit_test(unreadable_files_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
