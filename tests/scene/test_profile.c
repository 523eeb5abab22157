/* SPDX-License-Identifier: MIT */
/* Profiles in scene files: along one primitive, along whole chains, in masses, under handles. */
#include "scene/scene_text.h"
#include "core/vec3.h"
#include "skelfield/handles.h"

#define HEAD "skelfield: 1\nbodies:\n- name: a\n  iso: 1\n  kernel: {type: cauchy, s: 2}\n  skeleton:\n"

static skf_scene *good(const char *text) {
  skf_scene *scene;
  skf_error e;
  if (parse(text, &scene, &e)) fail_msg("line %ld: %s", e.line, e.text);
  return scene;
}

static void same_field(const char *one, const char *other, double tol) {
  skf_scene *a = good(one), *b = good(other);
  for (int i = 0; i < 40; i++) {
    skf_vec3 p = v3(-1 + 0.13 * i, 0.3 * sin(i), 0.7 * cos(i)), g, h;
    double F = skf_field_at(a->bodies[0].field, p, &g), want = skf_field_at(b->bodies[0].field, p, &h);
    check_close(F, want, tol);
    check_scaled(v3_dist(g, h), 0, v3_norm(h) + fabs(want), 10 * tol);
  }
  check_close(a->bodies[0].rho, b->bodies[0].rho, 1e-13);
  skf_scene_free(a), skf_scene_free(b);
}

/* A chain carries its profile as one straight segment does. */
static void along_a_chain(void **state) {
  (void)state;
  static const char *const forms[] = {"hat", "sin2", "{linear: [3, 1]}", "constant",
                                      "{cubic: [[0, 0, 1], [0.25, 1.25, -0.5], [1, 0.5, 0]]}"};
  for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
    char chain[512], whole[512], curve[512];
    snprintf(chain, sizeof chain,
             HEAD "  - polyline: {points: [[0, 0, 0], [0.7, 0, 0], [1, 0, 0], [3, 0, 0]], profile: %s}\n  mass: 3\n",
             forms[i]);
    snprintf(whole, sizeof whole, HEAD "  - segment: {from: [0, 0, 0], to: [3, 0, 0], profile: %s}\n  mass: 3\n",
             forms[i]);
    snprintf(curve, sizeof curve,
             HEAD "  - bezier: {points: [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]], profile: %s}\n  mass: 3\n",
             forms[i]);
    same_field(chain, whole, 1e-12);
    same_field(curve, whole, 1e-12);
  }
}

/* The mass is spread as the weight is. */
static void masses(void **state) {
  (void)state;
  skf_scene *s = good(HEAD "  - segment: {from: [0, 0, 0], to: [4, 0, 0], profile: {linear: [0, 3]}}\n"
                           "  - circle: {center: [0, 0, 0], normal: [0, 0, 1], radius: 2, profile: sin2}\n  mass: 6\n");
  check_close(s->bodies[0].rho, 6 / (6 + 2 * SKF_PI), 1e-14);
  skf_scene_free(s);
}

static void under_handles(void **state) {
  (void)state;
  skf_scene *s =
      good("skelfield: 1\nbodies:\n- name: a\n  iso: 0.7\n  skeleton:\n  - segment: {from: [0, 0, 0], to: "
           "[0, 0, 4], kernel: {type: gaussian}, radius: 0.3, blobbiness: -0.5, profile: {linear: [2, 0]}}\n");
  check_close(skf_field_at(s->bodies[0].field, v3(0, 0.3, 2), NULL), 0.7, 1e-13);
  assert_true(skf_field_at(s->bodies[0].field, v3(0, 0.3, 3), NULL) < 0.5);
  skf_scene_free(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(along_a_chain), cmocka_unit_test(masses),
                                     cmocka_unit_test(under_handles)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
