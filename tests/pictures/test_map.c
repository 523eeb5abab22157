/* SPDX-License-Identifier: MIT */
/* The samples of a map against the field, its outline, its frame and its range. */
#include "check.h"
#include "map_grid.h"
#include <string.h>

static const char scene_text[] = "skelfield: 1\n"
                                 "gravity: {G: 3}\n"
                                 "bodies:\n"
                                 "  - {name: ball, iso: 2, kernel: {type: inverse}, density: 0.5, skeleton: [{point: "
                                 "{at: [1, 2, 3], strength: 1.5}}]}\n"
                                 "  - {name: rod, iso: 0.4, kernel: {type: gaussian, a: 1}, skeleton: [{segment: "
                                 "{from: [-4, 0, 3], to: [-3, 1, 3]}}]}\n";

static skf_scene *scene(const char *text) {
  skf_scene *s;
  skf_error error;
  if (skf_scene_parse(text, strlen(text), ".", &s, &error)) fail_msg("%s", error.text);
  return s;
}

static map_grid grid(const char *plane) {
  map_grid g = {.x0 = -5, .x1 = 3, .y0 = -1, .y1 = 5, .nx = 161, .ny = 121};
  assert_true(map_plane_parse(plane, &g.plane));
  return g;
}

static const skf_progress silent = {NULL, NULL};

static void planes(void **state) {
  (void)state;
  map_plane p;
  assert_true(map_plane_parse("y=-2.5e1", &p));
  assert_int_equal(p.normal, 1);
  assert_int_equal(p.u, 0);
  assert_int_equal(p.v, 2);
  assert_true(p.at == -25);
  const char *const bad[] = {"", "z", "z=", "w=0", "zz=0", "z=0 ", "z=nan", "z=inf", "z=1e999", "z==0", "z=0x1"};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    if (map_plane_parse(bad[i], &p)) fail_msg("'%s' is taken for a plane", bad[i]);
}

static void values_are_the_field(void **state) {
  (void)state;
  skf_scene *s = scene(scene_text);
  for (int kind = 0; kind < MAP_KIND_COUNT; kind++) {
    contours outlines[2];
    map_grid g = grid("z=3.1");
    assert_int_equal(map_sample(s, (map_kind)kind, true, &g, outlines, silent), SKF_OK);
    for (int j = 0; j < g.ny; j += 7)
      for (int i = 0; i < g.nx; i += 5) {
        skf_vec3 p = map_point(&g, i, j), ga, gb;
        check_close(p.x, -5 + (i + 0.5) * 8 / 161, 1e-14);
        check_scaled(p.y, 5 - (j + 0.5) * 6 / 121, 5, 1e-15);
        double a = skf_field_at(s->bodies[0].field, p, &ga), b = skf_field_at(s->bodies[1].field, p, &gb);
        double gx = 3 * (0.5 * ga.x + gb.x), gy = 3 * (0.5 * ga.y + gb.y), gz = 3 * (0.5 * ga.z + gb.z);
        double want = kind == MAP_F           ? a + b
                      : kind == MAP_POTENTIAL ? -3 * (0.5 * a + b)
                                              : sqrt(gx * gx + gy * gy + gz * gz);
        size_t k = (size_t)(j * g.nx + i);
        check_close(g.value[k], want, 1e-13);
        if (kind == MAP_F) gx = ga.x + gb.x, gy = ga.y + gb.y;
        check_scaled(g.slope[0][k], gx, hypot(gx, gy), 1e-12);
        check_scaled(g.slope[1][k], gy, hypot(gx, gy), 1e-12);
      }
    for (int i = 0; i < 2; i++) contour_free(outlines + i);
    map_grid_free(&g);
  }
  skf_scene_free(s);
}

static void outlines_are_the_surfaces(void **state) {
  (void)state;
  skf_scene *s = scene(scene_text);
  contours outlines[2];
  map_grid g = grid("z=3");
  assert_int_equal(map_sample(s, MAP_F, false, &g, outlines, silent), SKF_OK);
  assert_int_equal(outlines[0].count, 1);
  assert_true(outlines[0].lines[0].closed);
  for (size_t k = 0; k < outlines[0].lines[0].n; k++) { /* 1.5 / r = 2; the grid's cells are 0.05 wide */
    skf_vec3 p = map_point(&g, outlines[0].lines[0].xy[k][0], outlines[0].lines[0].xy[k][1]);
    check_close(hypot(p.x - 1, p.y - 2), 0.75, 3e-3);
  }
  for (int i = 0; i < 2; i++) contour_free(outlines + i);
  map_grid_free(&g);
  skf_scene_free(s);
}

static void frames_hold_the_surfaces(void **state) {
  (void)state;
  skf_scene *s = scene(scene_text);
  map_plane p;
  double x[2] = {1, -1}, y[2] = {1, -1};
  assert_true(map_plane_parse("z=3", &p));
  s->body_count = 1;
  map_frame(s, p, x, y);
  assert_true(x[0] <= 0.25 && x[0] > 0.15 && x[1] >= 1.75 && x[1] < 1.85);
  assert_true(y[0] <= 1.25 && y[0] > 1.15 && y[1] >= 2.75 && y[1] < 2.85);
  s->body_count = 2;
  map_frame(s, p, x, y);
  assert_true(x[0] < -4 && x[1] >= 1.75);
  skf_scene_free(s);
  /* A plane has no end: its point is framed. */
  s = scene("skelfield: 1\nbodies:\n  - {name: floor, iso: 0.5, kernel: {type: gaussian, a: 1}, skeleton: [{plane: "
            "{through: [7, 0, 0], normal: [0, 0, 1]}}]}\n");
  x[0] = 1, x[1] = -1, y[0] = 1, y[1] = -1;
  map_frame(s, p, x, y);
  assert_true(x[0] < 7 && x[1] > 7 && x[1] < 100);
  skf_scene_free(s);
}

static void ranges(void **state) {
  (void)state;
  double v[1000];
  color_scale c;
  for (int i = 0; i < 1000; i++) v[i] = i;
  map_range(v, 1000, false, NAN, NAN, &c);
  assert_true(c.lo == 0 && c.hi == 999 && !c.above && !c.below);
  v[17] = INFINITY, v[18] = 1e9, v[19] = NAN;
  map_range(v, 1000, false, NAN, NAN, &c);
  assert_true(c.hi > 950 && c.hi < 1000 && c.above && !c.below);
  map_range(v, 1000, false, 10, 20, &c);
  assert_true(c.lo == 10 && c.hi == 20 && c.above && c.below);
  for (int i = 0; i < 1000; i++) v[i] = -3;
  map_range(v, 1000, false, NAN, NAN, &c);
  assert_true(c.lo < -3 && c.hi > -3 && !c.above && !c.below);
  for (int i = 0; i < 1000; i++) v[i] = -pow(10, i / 250.0);
  v[3] = 0;
  map_range(v, 1000, true, NAN, NAN, &c);
  assert_true(c.lo >= 1 && c.lo < 1.2 && c.hi > 8000 && c.below && !c.above);
  for (int i = 0; i < 1000; i++) v[i] = NAN;
  map_range(v, 1000, true, NAN, NAN, &c);
  assert_true(c.lo > 0 && c.lo < c.hi);
}

static int stop(void *user, double done) {
  *(double *)user = done;
  return 1;
}

static void can_be_stopped(void **state) {
  (void)state;
  skf_scene *s = scene(scene_text);
  contours outlines[2] = {{NULL, 0}, {NULL, 0}};
  map_grid g = grid("z=3");
  double done = -1;
  assert_int_equal(map_sample(s, MAP_F, false, &g, outlines, (skf_progress){stop, &done}), SKF_ERR_CANCELLED);
  assert_true(done > 0 && done < 1);
  map_grid_free(&g);
  skf_scene_free(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(planes),
      cmocka_unit_test(values_are_the_field),
      cmocka_unit_test(outlines_are_the_surfaces),
      cmocka_unit_test(frames_hold_the_surfaces),
      cmocka_unit_test(ranges),
      cmocka_unit_test(can_be_stopped),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
