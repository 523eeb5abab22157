/* SPDX-License-Identifier: MIT */
/* Sources of many particles: where they start, how fast, and that the same seed gives the same ones. */
#include "check.h"
#include "core/random.h"
#include "skelfield/scene.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char head[] = "skelfield: 1\ngravity: {G: 1}\nbodies:\n"
                           "- {name: sun, iso: 9, kernel: {type: inverse}, skeleton: [{point: {at: [1, 2, 3]}}]}\n"
                           "particles:\n";

static skf_scene *scene_of(const char *particles) {
  char text[2048];
  snprintf(text, sizeof text, "%s%s", head, particles);
  skf_scene *s;
  skf_error e;
  if (skf_scene_parse(text, strlen(text), ".", &s, &e)) fail_msg("line %ld: %s", e.line, e.text);
  return s;
}

/* The known answers of Random123's test, and functions against the library's. */
static void numbers(void **state) {
  (void)state;
  const struct {
    uint32_t counter[4], key[2], out[4];
  } known[] = {
      {{0, 0, 0, 0}, {0, 0}, {0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}},
      {{~0u, ~0u, ~0u, ~0u}, {~0u, ~0u}, {0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}},
      {{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344},
       {0xa4093822, 0x299f31d0},
       {0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}},
  };
  for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
    uint32_t out[4];
    philox(known[i].counter, known[i].key, out);
    assert_memory_equal(out, known[i].out, sizeof out);
  }
  skf_random r = random_of(5, 6, 7);
  for (int i = 0; i < 20000; i++) {
    double u = random_next(&r), x = pow(u, 1 + i % 40);
    assert_true(u > 0 && u < 1);
    check_scaled(random_log(x), log(x), fmax(1, -log(x)), 4e-16);
    check_close(random_cbrt(x), cbrt(x), 1e-15);
  }
  assert_true(random_cbrt(1) == 1 && random_cbrt(0) == 0);
}

static void grids(void **state) {
  (void)state;
  skf_scene *s =
      scene_of("- {name: g, grid: {from: [-1, 2, 3], to: [1, 4, 9], counts: [3, 2, 1], velocity: [1, 2, 3]}}\n"
               "- {name: one, position: [0, 0, 0], velocity: [0, 0, 0]}\n");
  assert_int_equal(s->particle_count, 7);
  for (int i = 0; i < 6; i++) {
    char name[16];
    snprintf(name, sizeof name, "g-%06d", i);
    assert_string_equal(s->particles[i].name, name);
    skf_vec3 p = s->particles[i].position, v = s->particles[i].velocity;
    assert_true(p.x == i % 3 - 1 && p.y == 2 + 2 * (i / 3) && p.z == 6);
    assert_true(v.x == 1 && v.y == 2 && v.z == 3);
    assert_int_equal(s->particles[i].line, 6);
  }
  assert_string_equal(s->particles[6].name, "one");
  skf_scene_free(s);
}

enum { MANY = 20000 };

/* Share of samples below x in [0, 1] for which F(x) = x must hold: Kolmogorov's distance, below 1.95 / sqrt n in 999 of
   1000 draws. */
static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static void check_uniform(double *x, size_t n) {
  qsort(x, n, sizeof *x, ascending);
  double worst = 0;
  for (size_t i = 0; i < n; i++) worst = fmax(worst, fabs(x[i] - ((double)i + 0.5) / (double)n));
  if (!(worst < 1.95 / sqrt((double)n))) fail_msg("distance %g", worst);
}

static void discs(void **state) {
  (void)state;
  static double area[MANY], turn[MANY];
  skf_scene *s = scene_of("- {name: d, disc: {center: [1, 2, 3], normal: [0, 3, 4], inner: 1, outer: 2, count: 20000, "
                          "velocity: [0, 0, 7], circular: -0.5}}\n");
  skf_vec3 n = v3(0, 0.6, 0.8), e = v3_perp(n);
  for (size_t i = 0; i < MANY; i++) {
    const skf_particle *p = s->particles + i;
    skf_vec3 d = v3_sub(p->position, v3(1, 2, 3)), v = v3_sub(p->velocity, v3(0, 0, 7));
    double r = v3_norm(d);
    check_scaled(v3_dot(d, n), 0, 1, 1e-15);
    area[i] = (r * r - 1) / 3;
    turn[i] = atan2(v3_dot(d, v3_cross(n, e)), v3_dot(d, e)) / (2 * SKF_PI) + 0.5;
    skf_vec3 want = v3_scale(-0.5 / (r * sqrt(r)), v3_cross(n, d)); /* half of sqrt(G M / r), backwards */
    check_scaled(v3_dist(v, want), 0, 1, 1e-14);
  }
  check_uniform(area, MANY);
  check_uniform(turn, MANY);
  skf_scene_free(s);
}

static void shells(void **state) {
  (void)state;
  static double volume[MANY], height[MANY], turn[MANY];
  skf_scene *s = scene_of("- {name: s, shell: {center: [1, 0, 0], inner: 1, outer: 3, count: 20000, radial: -2, "
                          "tangential: 1.5}}\n"
                          "- {name: thin, shell: {outer: 2, count: 5}}\n");
  for (size_t i = 0; i < MANY; i++) {
    skf_vec3 d = v3_sub(s->particles[i].position, v3(1, 0, 0)), v = s->particles[i].velocity, n = v3_unit(d);
    double r = v3_norm(d);
    volume[i] = (r * r * r - 1) / 26, height[i] = 0.5 + 0.5 * n.z;
    check_scaled(v3_dot(v, n), -2, 2, 1e-14);
    skf_vec3 across = v3_mad(v, 2, n), e = v3_perp(n);
    check_close(v3_norm(across), 1.5, 1e-13);
    turn[i] = atan2(v3_dot(across, v3_cross(n, e)), v3_dot(across, e)) / (2 * SKF_PI) + 0.5;
  }
  check_uniform(volume, MANY), check_uniform(height, MANY), check_uniform(turn, MANY);
  for (size_t i = MANY; i < MANY + 5; i++) check_close(v3_norm(s->particles[i].position), 2.0, 1e-15);
  skf_scene_free(s);
}

static void clouds(void **state) {
  (void)state;
  static double share[3][MANY];
  skf_scene *s =
      scene_of("- {name: m, maxwellian: {center: [5, 5, 5], count: 20000, velocity: [1, 2, 3], spread: 0.5}}\n"
               "- {name: m2, maxwellian: {center: [5, 5, 5], count: 5, temperature: 0.25, radius: 2}}\n");
  for (size_t i = 0; i < MANY; i++) {
    skf_vec3 v = s->particles[i].velocity;
    for (int k = 0; k < 3; k++) share[k][i] = 0.5 * erfc(-(v3_get(v, k) - (k + 1)) / 0.5 / sqrt(2));
    assert_true(s->particles[i].position.x == 5);
  }
  for (int k = 0; k < 3; k++) check_uniform(share[k], MANY);
  for (size_t i = MANY; i < MANY + 5; i++) assert_true(v3_dist(s->particles[i].position, v3(5, 5, 5)) < 2);
  skf_scene_free(s);
}

/* The same whatever else the scene holds; others by another seed or name. */
static void seeds(void **state) {
  (void)state;
  skf_scene *s = scene_of("- {name: first, disc: {outer: 1, count: 3, seed: 1}}\n"
                          "- {name: b, maxwellian: {radius: 1, spread: 1, count: 9}}\n"
                          "- {name: c, maxwellian: {radius: 1, spread: 1, count: 9}}\n");
  skf_scene *t = scene_of("- {name: b, maxwellian: {radius: 1, spread: 1, count: 12, seed: 1}}\n");
  skf_scene *u = scene_of("- {name: b, maxwellian: {radius: 1, spread: 1, count: 9, seed: 2}}\n");
  for (int i = 0; i < 9; i++) {
    const skf_particle *b = s->particles + 3 + i, *c = b + 9;
    assert_string_equal(b->name, t->particles[i].name);
    assert_memory_equal(&b->position, &t->particles[i].position, sizeof b->position);
    assert_memory_equal(&b->velocity, &t->particles[i].velocity, sizeof b->velocity);
    assert_true(v3_dist(b->position, c->position) > 0 && v3_dist(b->position, u->particles[i].position) > 0);
  }
  assert_int_equal(s->drawn_count, 3);
  assert_true(s->drawn[1].first == 3 && s->drawn[1].count == 9 && s->drawn[1].seed == 1);
  assert_true(u->drawn_count == 1 && u->drawn[0].seed == 2);
  skf_scene_free(s), skf_scene_free(t), skf_scene_free(u);
}

/* Reads a scene whose particles come from a file with that text. */
static skf_status from_file(const char *text, skf_scene **out, skf_error *e) {
  char folder[] = "/tmp/skelfield-sources-XXXXXX", path[64], scene[1024];
  assert_non_null(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/p.csv", folder);
  FILE *f = fopen(path, "wb");
  assert_non_null(f);
  fputs(text, f);
  fclose(f);
  snprintf(scene, sizeof scene, "%s- {name: many, file: p.csv}\n", head);
  skf_status s = skf_scene_parse(scene, strlen(scene), folder, out, e);
  remove(path), rmdir(folder);
  return s;
}

static void files(void **state) {
  (void)state;
  skf_scene *s;
  skf_error e;
  assert_int_equal(from_file("x,y,z,vx,vy,vz\n1,2,3,4,5,6\r\n\n -1e-3 ,.5,+7,0,0,0", &s, &e), SKF_OK);
  assert_int_equal(s->particle_count, 2);
  assert_string_equal(s->particles[1].name, "many-000001");
  assert_true(s->particles[1].position.x == -1e-3 && s->particles[0].velocity.z == 6);
  skf_scene_free(s);
  assert_int_equal(from_file("name,vx,vy,vz,x,y,z\nadam,4,5,6,1,2,3\neve,0,0,0,7,8,9\n", &s, &e), SKF_OK);
  assert_string_equal(s->particles[1].name, "eve");
  assert_true(s->particles[1].position.z == 9 && s->particles[0].velocity.x == 4);
  skf_scene_free(s);
  const struct {
    const char *text, *part;
    long line;
  } bad[] = {
      {"", "nothing in the file, expected the columns x,y,z", 1},
      {"x,y,z\n1,2,3\n", "no column vx, expected", 1},
      {"x,y,z,vx,vy,vz,mass\n", "the column is 'mass', expected", 1},
      {"x,y,z,vx,vy,vz\n", "no particles, expected at least one row", 1},
      {"x,y,z,vx,vy,vz\n1,2,3,4,5,6\n1,2,3,4,5\n", "too few columns, expected", 3},
      {"x,y,z,vx,vy,vz\n1,2,3,4,5,6,7\n", "too many columns, expected", 2},
      {"x,y,z,vx,vy,vz\n1,2,3,4,5,nan\n", "vz is 'nan', expected a finite number", 2},
      {"x,y,z,vx,vy,vz\n1,2,3,4,,6\n", "vy is empty, expected a finite number", 2},
      {"x,y,z,vx,vy,vz\n1,2,3,1e999,5,6\n", "vx is '1e999', expected a finite number", 2},
      {"x,y,z,vx,vy,vz,name\n1,2,3,4,5,6,\n", "name is empty, expected a name", 2},
  };
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    skf_status status = from_file(bad[i].text, &s, &e);
    assert_true(status == SKF_ERR_PARSE || status == SKF_ERR_RANGE);
    if (e.line != bad[i].line || !strstr(e.text, bad[i].part)) fail_msg("%zu: line %ld: %s", i, e.line, e.text);
    assert_non_null(strstr(e.file, "/p.csv"));
  }
  assert_int_equal(from_file("x,y,z,vx,vy,vz,name\n1,2,3,4,5,6,a\n1,2,3,4,5,6,a\n", &s, &e), SKF_ERR_PARSE);
  assert_non_null(strstr(e.text, "a second particle is called 'a'"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(numbers), cmocka_unit_test(grids), cmocka_unit_test(discs), cmocka_unit_test(shells),
      cmocka_unit_test(clouds),  cmocka_unit_test(seeds), cmocka_unit_test(files),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
