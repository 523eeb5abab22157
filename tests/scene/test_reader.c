/* SPDX-License-Identifier: MIT */
/* Scenes that are good: every value lands where it belongs. */
#include "scene/scene_text.h"
#include "core/vec3.h"
#include "scene/reader.h"

static skf_scene *good(const char *text) {
  skf_scene *scene;
  skf_error e;
  if (parse(text, &scene, &e)) fail_msg("line %ld: %s", e.line, e.text);
  return scene;
}

static void check_vector(skf_vec3 got, double x, double y, double z) {
  assert_true(got.x == x && got.y == y && got.z == z);
}

static void every_key_is_read(void **state) {
  (void)state;
  skf_scene *s = good(full_scene);
  assert_true(s->G == 1);
  assert_int_equal(s->body_count, 2);
  const skf_body *b = s->bodies, *ground = s->bodies + 1;
  assert_string_equal(b->name, "cross");
  assert_true(b->iso == 0.35 && b->has_mass && b->mass == 6);
  check_vector(b->spin.axis, 0, 0, 2);
  check_vector(b->spin.about, 1, 2, 3);
  assert_true(b->spin.rate == 0.6);
  assert_true(b->ellipsoid.given && b->ellipsoid.equatorial == 1 && b->ellipsoid.polar == 2);
  check_vector(b->ellipsoid.center, 0, 0, 1);
  check_vector(b->ellipsoid.axis, 0, 1, 0);
  check_vector(b->ellipsoid.meridian, 0, 0, 1);
  assert_true(b->color[0] == 0.1 && b->color[1] == 0.2 && b->color[2] == 0.3);
  assert_int_equal(b->element_count, 4);
  assert_int_equal(b->line, 5);
  assert_int_equal(b->element_lines[3], 16);
  const skf_element *e = b->elements;
  assert_true(e[0].primitive.shape == SKF_POINT && e[0].strength == 1.5 && e[0].kernel.param == 2.5);
  assert_true(e[1].primitive.shape == SKF_SEGMENT && e[1].strength == 1 && e[1].kernel.type == SKF_CAUCHY);
  check_vector(e[1].primitive.segment.from, -2, 0, 0);
  check_vector(e[1].primitive.segment.to, 2, 0, 0);
  assert_true(e[2].primitive.arc.radius == 1.5 && e[2].primitive.arc.sweep == 2 * SKF_PI);
  check_vector(e[3].primitive.triangle.vertices[2], 0, 1.5, 0);
  assert_true(e[3].kernel.type == SKF_GAUSSIAN && e[3].kernel.param == 2 && e[3].strength == -1);
  check_close(b->rho, 6 / (1.5 + 4 + 2 * SKF_PI * 1.5 - 1.5), 1e-15);
  assert_int_equal(skf_field_size(b->field), 4);
  assert_string_equal(ground->name, "ground plane");
  assert_true(ground->rho == -3 && !ground->has_mass && ground->iso == -1 && !ground->ellipsoid.given);
  assert_true(ground->elements[0].kernel.type == SKF_INVERSE_SQUARED);
  skf_scene_free(s);
}

static void the_rest_is_read(void **state) {
  (void)state;
  skf_scene *s = good(full_scene);
  assert_int_equal(s->particle_count, 2);
  assert_string_equal(s->particles[0].name, "probe");
  check_vector(s->particles[0].velocity, 0.05, 0.95, 0.35);
  assert_false(s->particles[0].launch.given);
  const skf_launch *l = &s->particles[1].launch;
  assert_true(l->given && l->body == 0 && l->height == 0.5 && l->speed == 2);
  check_close(l->latitude, SKF_PI / 6, 1e-15);
  check_close(l->longitude, -SKF_PI / 3, 1e-15);
  check_close(l->azimuth, SKF_PI / 2, 1e-15);
  check_close(l->elevation, SKF_PI / 4, 1e-15);
  const skf_simulation *m = &s->simulation;
  assert_true(m->given && m->t_end == 40 && m->output_every == 2 && m->tolerance == 1e-10);
  assert_true(m->contact == SKF_CONTACT_BOUNCE && m->restitution == 0.5 && m->friction == 0.1);
  assert_true(s->camera.given);
  check_vector(s->camera.up, 0, 1, 0);
  check_close(s->camera.fov, SKF_PI / 6, 1e-15);
  assert_int_equal(s->light_count, 2);
  assert_true(!s->lights[0].directional && s->lights[1].directional);
  assert_true(s->lights[0].color[0] == 4 && s->lights[0].color[1] == 2 && s->lights[1].color[2] == 1);
  assert_true(s->has_background && s->background[2] == 0.5);
  skf_scene_free(s);
}

static void defaults(void **state) {
  (void)state;
  skf_scene *s = good(small_scene);
  assert_true(s->G == 6.67430e-11);
  assert_true(s->bodies[0].rho == 1 && s->bodies[0].density == 1 && s->bodies[0].spin.rate == 0);
  assert_true(s->bodies[0].elements[0].strength == 1);
  assert_false(s->simulation.given || s->camera.given || s->has_background);
  assert_int_equal(s->simulation.contact, SKF_CONTACT_STOP);
  assert_true(s->simulation.tolerance == 1e-12);
  assert_int_equal(s->particle_count + s->light_count, 0);
  skf_scene_free(s);
}

/* Numbers as YAML 1.2 writes them, line ends, a byte order mark, keys in any order. */
static void forms(void **state) {
  (void)state;
  static const struct {
    const char *text;
    double value;
  } numbers[] = {{"1e3", 1e3}, {".5", .5}, {"+1", 1}, {"-2.", -2}, {"010", 10}, {"1.0e-12", 1e-12}, {"1E+2", 100}};
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
    char text[512];
    snprintf(text, sizeof text,
             "\xef\xbb\xbf%%YAML 1.2\r\n---\r\nbodies:\r\n- skeleton:\r\n  - point: {at: [0, 0, 0]}\r\n  kernel: {s: "
             "1, type: "
             "\"cauchy\"}\r\n  iso: %s # x\r\n  'name': a\r\nskelfield: 1.0\r\n...\r\n",
             numbers[i].text);
    skf_scene *s = good(text);
    assert_true(s->bodies[0].iso == numbers[i].value);
    assert_true(s->bodies[0].elements[0].kernel.type == SKF_CAUCHY);
    assert_int_equal(s->bodies[0].line, 4);
    skf_scene_free(s);
  }
}

static void mass_on_a_plane_does_not_attract(void **state) {
  (void)state;
  skf_scene *s = good("skelfield: 1\nbodies:\n  - {name: a, iso: 1, mass: 6, kernel: {type: cauchy, s: 1}, "
                      "skeleton: [{plane: {through: [0, 0, 0], normal: [0, 0, 1]}}]}\n");
  assert_true(s->bodies[0].rho == 0);
  skf_scene_free(s);
}

/* A long skeleton in one body, and many names. */
/* What is written once and used again. */
static void aliases(void **state) {
  (void)state;
  skf_scene *s = good("skelfield: 1\n"
                      "bodies:\n"
                      "  - &first\n"
                      "    name: a\n"
                      "    iso: &i 0.5\n"
                      "    kernel: &k {type: cauchy, s: *i}\n"
                      "    skeleton: &bones\n"
                      "      - point: {at: &o [1, 2, 3]}\n"
                      "      - segment: {from: *o, to: [4, 5, 6], kernel: {<<: *k, s: 7}}\n"
                      "  - {name: b, <<: *first, iso: 0.25}\n"
                      "  - name: c\n"
                      "    <<: [{iso: 8, density: 2}, *first]\n"
                      "  - {name: &i d, iso: 1, kernel: *k, skeleton: *bones}\n"
                      "particles:\n"
                      "  - {name: *i, position: *o, velocity: *o}\n");
  const double iso[] = {0.5, 0.25, 8, 1};
  assert_int_equal(s->body_count, 4);
  for (size_t i = 0; i < 4; i++) {
    const skf_body *b = s->bodies + i;
    assert_true(b->name[0] == 'a' + (char)i && b->name[1] == 0);
    assert_true(b->iso == iso[i]);
    assert_true(b->density == (i == 2 ? 2 : 1));
    assert_int_equal(b->element_count, 2);
    assert_int_equal(b->element_lines[1], 9);
    check_vector(b->elements[0].primitive.point.at, 1, 2, 3);
    check_vector(b->elements[1].primitive.segment.from, 1, 2, 3);
    assert_true(b->elements[0].kernel.type == SKF_CAUCHY && b->elements[0].kernel.param == 0.5);
    assert_true(b->elements[1].kernel.type == SKF_CAUCHY && b->elements[1].kernel.param == 7);
  }
  assert_int_equal(s->particle_count, 1);
  assert_string_equal(s->particles[0].name, "d"); /* an anchor may be set again */
  check_vector(s->particles[0].position, 1, 2, 3);
  skf_scene_free(s);
}

static void large_scenes(void **state) {
  (void)state;
  enum { N = 20000 };
  size_t size = 160 * (size_t)N, n = 0;
  char *text = malloc(size);
  n += (size_t)snprintf(text, size,
                        "skelfield: 1\nbodies:\n- name: a\n  iso: 1\n  kernel: {type: inverse}\n  skeleton:\n");
  for (int i = 0; i < N; i++)
    n += (size_t)snprintf(text + n, size - n, "  - segment: {from: [%d, 0, 0], to: [%d, 1, 0.1]}\n", i, i);
  n += (size_t)snprintf(text + n, size - n, "particles:\n");
  for (int i = 0; i < N; i++)
    n += (size_t)snprintf(text + n, size - n, "- {name: p%d, position: [%d, 0, 0], velocity: [0, 0, 1]}\n",
                          i * 7919 % N, i);
  skf_scene *s = good(text);
  assert_int_equal(s->bodies[0].element_count, N);
  assert_int_equal(s->bodies[0].element_lines[N - 1], N + 6);
  assert_true(s->particles[N - 1].position.x == N - 1);
  skf_scene_free(s);
  free(text);
}

/* The tables: what the help prints and the messages promise. */
static void tables_are_whole(void **state) {
  (void)state;
  for (const skf_section *const *p = skf_sections; *p; p++) {
    assert_true((*p)->count <= 32 && (*p)->doc);
    for (int i = 0; i < (*p)->count; i++) {
      const skf_key *k = (*p)->keys + i;
      char form[64];
      assert_non_null(k->name);
      assert_non_null(k->doc);
      assert_non_null(skf_key_form(k, form, sizeof form));
      assert_true((k->type == SKF_KEY_OTHER) == (k->read != NULL));
      for (int j = 0; j < i; j++) assert_string_not_equal(k->name, (*p)->keys[j].name);
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_key_is_read), cmocka_unit_test(the_rest_is_read),
      cmocka_unit_test(defaults),          cmocka_unit_test(forms),
      cmocka_unit_test(large_scenes),      cmocka_unit_test(mass_on_a_plane_does_not_attract),
      cmocka_unit_test(tables_are_whole),  cmocka_unit_test(aliases),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
