/* SPDX-License-Identifier: MIT */
/* Materials and handles in scene files: who overrides whom, and where the surfaces come to lie. */
#include "scene/scene_text.h"
#include "core/vec3.h"
#include "skelfield/handles.h"

static skf_scene *good(const char *text) {
  skf_scene *scene;
  skf_error e;
  if (parse(text, &scene, &e)) fail_msg("line %ld: %s", e.line, e.text);
  return scene;
}

static const char styles[] =
    "skelfield: 1\n"
    "bodies:\n"
    "- name: icicle\n"
    "  iso: 0.7\n"
    "  material: ice\n"
    "  influence: 2\n"
    "  kernel: {type: cauchy}\n"
    "  skeleton:\n"
    "  - point: {at: [0, 0, 0]}\n"
    "  - segment: {from: [0, 0, 0], to: [0, 0, 3], kernel: {type: gaussian}, influence: 3}\n"
    "  - point: {at: [9, 0, 0]}\n"
    "  - polyline: {points: [[0, 5, 0], [1, 5, 0], [4, 5, 0]]}\n"
    "- name: bar\n"
    "  iso: 2\n"
    "  material: iron\n"
    "  color: [1, 1, 1]\n"
    "  skeleton:\n"
    "  - arc: {center: [0, 0, 0], normal: [0, 0, 1], start: [1, 0, 0], radius: 2, sweep: 90}\n"
    "  - circle: {center: [0, 0, 9], normal: [0, 0, 1], radius: 2, thickness: 0.25}\n"
    "  - plane: {through: [0, 0, 0], normal: [0, 0, 1], kernel: {type: quartic, R: 1}, strength: 5}\n"
    "materials:\n"
    "- {name: ice, kernel: {type: gaussian}, blobbiness: -0.3, color: [0.1, 0.2, 0.3]}\n"
    "- {name: iron, kernel: {type: quartic}, radius: 0.5, strength: 3}\n";

static skf_handles found(const skf_body *b, size_t i) {
  skf_handles h;
  assert_true(i < b->handled_count);
  assert_int_equal(skf_handles_find(b->elements + b->handled[i].first, b->handled[i].count, b->iso, &h), SKF_OK);
  return h;
}

/* The entry's own words, then its material's, then the body's, then the body's material's. */
static void near_words_count(void **state) {
  (void)state;
  skf_scene *s;
  skf_error e;
  /* the plane has a parameter and a strength of its own beside iron's radius: one too many */
  assert_int_equal(parse(styles, &s, &e), SKF_ERR_ARG);
  assert_int_equal(e.line, 20);
  char text[sizeof styles];
  strcpy(text, styles);
  memcpy(strstr(text, ", strength: 5"), "             ", 13); /* iron's strength is too many all the same */
  assert_int_equal(parse(text, &s, &e), SKF_ERR_ARG);
  memcpy(strstr(text, "quartic, R: 1"), "quartic      ", 13);
  s = good(text);
  const skf_body *b = s->bodies, *bar = s->bodies + 1;
  assert_int_equal(b->handled_count, 4);
  skf_handles h = found(b, 0);
  assert_true(b->elements[0].kernel.type == SKF_CAUCHY);
  check_close(h.influence, 2, 1e-15);
  check_close(h.blobbiness, -0.3, 1e-12);
  h = found(b, 1);
  assert_true(b->elements[1].kernel.type == SKF_GAUSSIAN);
  check_close(h.influence, 3, 1e-15);
  check_close(h.blobbiness, -0.3, 1e-12);
  assert_true(b->handled[3].count == 2 && b->elements[3].strength == b->elements[4].strength);
  assert_true(b->color[1] == 0.2 && bar->color[1] == 1);
  assert_int_equal(bar->handled_count, 3);
  for (size_t i = 0; i < 3; i++) {
    assert_true(bar->elements[i].strength == 3 && bar->elements[i].kernel.type == SKF_QUARTIC);
    check_close(found(bar, i).radius, i == 1 ? 0.25 : 0.5, 1e-12);
  }
  skf_scene_free(s);
}

/* The thesis's ice [Sherstyuk 1999, 3.3.3.1]. */
static void the_surface_is_there(void **state) {
  (void)state;
  skf_scene *s =
      good("skelfield: 1\nmaterials: [{name: ice, kernel: {type: gaussian}, radius: 0.25, blobbiness: -0.30}]\n"
           "bodies:\n- name: icicle\n  iso: 1\n  skeleton:\n"
           "  - segment: {from: [0, 0, 0], to: [0, 0, 4.5], material: ice}\n"
           "- {name: drop, iso: 1, material: ice, skeleton: [{point: {at: [0, 0, -0.85]}}]}\n");
  check_close(skf_field_at(s->bodies[0].field, v3(0.25, 0, 2.25), NULL), 1, 1e-13);
  check_close(skf_field_at(s->bodies[1].field, v3(0, 0.25, -0.85), NULL), 1, 1e-13);
  check_close(s->bodies[1].elements[0].strength, exp(0.3), 1e-14);
  skf_scene_free(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(near_words_count), cmocka_unit_test(the_surface_is_there)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
