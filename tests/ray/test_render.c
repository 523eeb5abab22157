/* SPDX-License-Identifier: MIT */
/* The renderer: silhouettes, shadows, cameras; the same picture for any number of threads. */
#include "check.h"
#include "random.h"
#include "ray/render.h"
#include <omp.h>
#include <string.h>

enum { W = 120, H = 90 };

typedef struct ball {
  skf_field *field;
  skf_tracer *tracer;
} ball;

/* A sphere: 1 / r = iso. */
static ball make(skf_vec3 at, double radius) {
  skf_element e = {.primitive = {.shape = SKF_POINT, .point = {at}}, .kernel = {SKF_INVERSE, 0}, .strength = 1};
  ball b;
  assert_int_equal(skf_field_new(&e, 1, &b.field), SKF_OK);
  assert_int_equal(skf_tracer_new(b.field, 1 / radius, &b.tracer), SKF_OK);
  return b;
}

static void drop(ball b) {
  skf_tracer_free(b.tracer);
  skf_field_free(b.field);
}

static skf_render_scene look_at(const skf_render_body *bodies, size_t n, double distance) {
  skf_render_scene s = {.bodies = bodies, .body_count = n, .width = W, .height = H, .samples = 4};
  s.camera = (skf_camera){true, {0, -distance, 0}, {0, 0, 0}, {0, 0, 1}, 0.5};
  for (int k = 0; k < 3; k++) s.background[0][k] = 0.1, s.background[1][k] = 0.2;
  return s;
}

static const skf_progress silent = {NULL, NULL};

static void sphere(double scale) {
  static float rgb[W * H * 3], depth[W * H];
  ball b = make(v3(0, 0, 0), scale);
  skf_render_body body = {b.tracer, {0.8, 0.4, 0.2}};
  skf_render_scene s = look_at(&body, 1, 6 * scale);
  assert_int_equal(skf_render(&s, rgb, depth, silent), SKF_OK);
  double radius = H / 2.0 * (1 / sqrt(35.0)) / tan(0.25), nearest = INFINITY;
  int seen = 0;
  for (int y = 0; y < H; y++)
    for (int x = 0; x < W; x++) {
      int k = y * W + x, mirrored = y * W + W - 1 - x;
      double out = hypot(x + 0.5 - W / 2.0, y + 0.5 - H / 2.0);
      seen += isfinite(depth[k]);
      if (isfinite(depth[k]) != (out < radius) && fabs(out - radius) > 1e-6)
        fail_msg("(%d, %d) is on the wrong side of the silhouette", x, y);
      if (isfinite(depth[k])) check_close(depth[k], depth[mirrored], 1e-6);
      nearest = fmin(nearest, depth[k]);
      double up = 1 - (y + 0.5) / H;
      for (int c = 0; c < 3 && out > radius + 2; c++) check_close(rgb[3 * k + c], 0.1 + 0.1 * up, 1e-6);
      for (int c = 0; c < 3; c++) assert_true(rgb[3 * k + c] >= 0 && rgb[3 * k + c] < 10);
    }
  check_close((double)seen, SKF_PI * radius * radius, 0.01);
  check_close(nearest, 5 * scale, 1e-3);
  drop(b);
}

static void silhouette(void **state) {
  (void)state;
  sphere(1);
  sphere(1e-7);
  sphere(1e7);
}

static void edges_are_smoothed(void **state) {
  (void)state;
  static float rgb[W * H * 3];
  ball b = make(v3(0, 0, 0), 1);
  skf_render_body body = {b.tracer, {0, 0, 0}};
  const skf_light far_away = {true, {0, 1, 0}, {1e-9, 1e-9, 1e-9}};
  skf_render_scene s = look_at(&body, 1, 6);
  s.lights = &far_away, s.light_count = 1, s.samples = 64; /* a black ball: only its area is seen */
  for (int k = 0; k < 3; k++) s.background[0][k] = s.background[1][k] = 1;
  assert_int_equal(skf_render(&s, rgb, NULL, silent), SKF_OK);
  double dark = 0, radius = H / 2.0 * (1 / sqrt(35.0)) / tan(0.25);
  for (int k = 0; k < W * H; k++) dark += 1 - rgb[3 * k];
  check_close(dark, SKF_PI * radius * radius, 1e-3);
  drop(b);
}

static double brightness(const float *rgb, int x, int y) { return rgb[3 * (y * W + x) + 1]; }

static void shadows_fall(void **state) {
  (void)state;
  static float alone[W * H * 3], shaded[W * H * 3];
  ball b = make(v3(0, 0, 0), 1), a = make(v3(0, 0, 4), 1);
  const skf_render_body bodies[2] = {{b.tracer, {1, 1, 1}}, {a.tracer, {1, 1, 1}}};
  const skf_light above = {true, {0, 0, 1}, {1, 1, 1}};
  skf_render_scene s = look_at(bodies, 1, 6);
  s.lights = &above, s.light_count = 1;
  assert_int_equal(skf_render(&s, alone, NULL, silent), SKF_OK);
  s.body_count = 2;
  assert_int_equal(skf_render(&s, shaded, NULL, silent), SKF_OK);
  int top = H / 2 - 20; /* on the upper half, where the light comes nearly from the front */
  assert_true(brightness(shaded, W / 2, top) < 0.4 * brightness(alone, W / 2, top));
  check_close(brightness(shaded, W / 2, H / 2 + 20), brightness(alone, W / 2, H / 2 + 20), 0.15);
  drop(a), drop(b);
}

static void threads_change_nothing(void **state) {
  (void)state;
  static float one[W * H * 3], three[W * H * 3], d1[W * H], d3[W * H];
  ball b = make(v3(0, 0, 0), 1), a = make(v3(1, -0.5, 1), 0.5);
  const skf_render_body bodies[2] = {{b.tracer, {0.2, 0.5, 0.8}}, {a.tracer, {0.8, 0.5, 0.2}}};
  skf_render_scene s = look_at(bodies, 2, 6);
  s.ground = true, s.ground_at = v3(0, 0, -1), s.ground_normal = v3(0, 0, 2);
  int before = omp_get_max_threads();
  omp_set_num_threads(1);
  assert_int_equal(skf_render(&s, one, d1, silent), SKF_OK);
  omp_set_num_threads(3);
  assert_int_equal(skf_render(&s, three, d3, silent), SKF_OK);
  omp_set_num_threads(before);
  assert_memory_equal(one, three, sizeof one);
  assert_memory_equal(d1, d3, sizeof d1);
  /* The floor darkens below the balls only. */
  assert_true(brightness(one, W / 2, H - 1) < 0.1 * (1 + 0.5 / H) && brightness(one, W / 2, H - 1) > 0);
  drop(a), drop(b);
}

static int stop_soon(void *user, double done) {
  *(double *)user = done;
  return done > 0.1;
}

static void can_be_stopped(void **state) {
  (void)state;
  static float rgb[W * H * 3];
  ball b = make(v3(0, 0, 0), 1);
  skf_render_body body = {b.tracer, {0.8, 0.4, 0.2}};
  skf_render_scene s = look_at(&body, 1, 6);
  double done = 0;
  int before = omp_get_max_threads();
  omp_set_num_threads(1); /* progress is told by one thread: how far the others come meanwhile is not known */
  assert_int_equal(skf_render(&s, rgb, NULL, (skf_progress){stop_soon, &done}), SKF_ERR_CANCELLED);
  omp_set_num_threads(before);
  assert_true(done > 0.1 && done < 0.5);
  for (int k = 0; k < 3 * W * H; k++) assert_true(rgb[k] > 0 && rgb[k] < 10);
  drop(b);
}

static void wrong_arguments(void **state) {
  (void)state;
  static float rgb[W * H * 3];
  ball b = make(v3(0, 0, 0), 1);
  skf_render_body body = {b.tracer, {1, 1, 1}};
  skf_render_scene s = look_at(&body, 1, 0);
  assert_int_equal(skf_render(&s, rgb, NULL, silent), SKF_ERR_ARG);
  s = look_at(&body, 1, 6);
  s.camera.fov = SKF_PI;
  assert_int_equal(skf_render(&s, rgb, NULL, silent), SKF_ERR_ARG);
  s = look_at(&body, 1, NAN);
  assert_int_equal(skf_render(&s, rgb, NULL, silent), SKF_ERR_ARG);
  s = look_at(&body, 1, 6);
  s.light_count = 9;
  assert_int_equal(skf_render(&s, rgb, NULL, silent), SKF_ERR_ARG);
  drop(b);
}

static void cameras_frame_what_there_is(void **state) {
  (void)state;
  for (double scale = 1e-7; scale < 1e8; scale *= 1e7)
    for (int wide = 0; wide < 2; wide++) {
      double aspect = wide ? 1.6 : 0.6, fov = 0.5;
      ball b = make(v3(3 * scale, -2 * scale, scale), scale);
      const skf_field *fields[] = {b.field};
      const double iso = 1 / scale;
      skf_camera c;
      assert_int_equal(skf_camera_frame(fields, &iso, 1, NULL, 0, -1, 0.5, fov, aspect, &c), SKF_OK);
      double px[3];
      assert_true(skf_camera_project(&c, 1000, 1000, v3(3 * scale, -2 * scale, scale), px));
      check_close(px[0], 500.0, 0.02);
      check_close(px[1], 500.0, 0.02);
      double half = asin(scale / px[2]), narrow = atan(fmin(1, aspect) * tan(fov / 2));
      check_close(tan(half), 0.9 * tan(narrow), 0.05); /* the margin is a tenth; few rays look for the edge */
      const skf_tracer *tracers[] = {b.tracer};
      skf_camera same; /* but for the rounding of hits, which polish normals more or less */
      assert_int_equal(skf_camera_frame_with(tracers, 1, NULL, 0, -1, 0.5, fov, aspect, &same), SKF_OK);
      assert_true(v3_dist(same.from, c.from) <= 1e-12 * scale && v3_dist(same.to, c.to) <= 1e-12 * scale);
      drop(b);
    }
  ball b = make(v3(0, 0, 0), 1);
  const skf_field *fields[] = {b.field};
  const double iso = 1;
  const skf_vec3 points[] = {{9, 1, 2}, {-4, 7, 0}, {0, -3, 8}};
  skf_camera c;
  assert_int_equal(skf_camera_frame(fields, &iso, 1, points, 3, 2, -0.3, 0.7, 1.3, &c), SKF_OK);
  for (int i = 0; i < 3; i++) {
    double px[3];
    assert_true(skf_camera_project(&c, 1300, 1000, points[i], px));
    assert_true(px[0] >= 0 && px[0] <= 1300 && px[1] >= 0 && px[1] <= 1000);
  }
  drop(b);
}

static void endless_surfaces_are_seen(void **state) {
  (void)state;
  static float rgb[W * H * 3], depth[W * H];
  skf_element e = {
      .primitive = {.shape = SKF_PLANE, .plane = {{0, 0, 0}, {0, 0, 1}}}, .kernel = {SKF_GAUSSIAN, 1}, .strength = 1};
  skf_field *field;
  skf_tracer *tracer;
  assert_int_equal(skf_field_new(&e, 1, &field), SKF_OK);
  assert_int_equal(skf_tracer_new(field, 1, &tracer), SKF_OK);
  skf_render_body body = {tracer, {0.5, 0.5, 0.5}};
  skf_render_scene s = look_at(&body, 1, 1);
  const skf_field *fields[] = {field};
  const double iso = 1;
  assert_int_equal(skf_camera_frame(fields, &iso, 1, NULL, 0, -1, 0.6, 0.5, 4 / 3.0, &s.camera), SKF_OK);
  assert_int_equal(skf_render(&s, rgb, depth, silent), SKF_OK);
  /* pi exp(-z^2) = 1: every ray downwards ends on the upper sheet, all of them here. */
  double z = sqrt(log(SKF_PI));
  skf_view v;
  assert_int_equal(skf_view_make(&s.camera, 4 / 3.0, &v), SKF_OK);
  for (int y = 0; y < H; y += 11)
    for (int x = 0; x < W; x += 13) {
      skf_vec3 d = skf_view_ray(&v, W, H, x + 0.5, y + 0.5);
      assert_true(d.z < 0);
      check_close(depth[y * W + x], (z - v.from.z) / d.z, 1e-6);
    }
  skf_tracer_free(tracer);
  skf_field_free(field);
}

static void light_becomes_bytes(void **state) {
  (void)state;
  float ramp[3 * 256];
  unsigned char out[3 * 256];
  for (int k = 0; k < 3 * 256; k++) ramp[k] = (float)(k / 3) / 64;
  skf_render_srgb(ramp, 16, 256, out);
  for (int k = 0; k < 256; k++) {
    double x = k / 64.0, want = 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055);
    if (x <= 0.7) assert_true(fabs(out[3 * k] - want) <= 1);
    if (k > 3) assert_true(out[3 * k] + 1 >= out[3 * (k - 4)]); /* the noise is half a step */
  }
  assert_true(out[3 * 255] >= 254);
}

/* Large pictures go by a table: with the bytes that the formula gives. */
static void tables_change_no_byte(void **state) {
  (void)state;
  enum { WIDTH = 700, HEIGHT = 300 };
  float *rgb = malloc(3 * sizeof *rgb * WIDTH * HEIGHT);
  unsigned char *out = malloc(3 * WIDTH * HEIGHT);
  uint64_t seed = 5;
  for (int k = 0; k < 3 * WIDTH * HEIGHT; k++)
    rgb[k] = (float)(k < 3 * WIDTH * HEIGHT / 4 ? 2.0 * k / (3 * WIDTH * HEIGHT) : exp(rnd(&seed, log(1e-6), log(30))));
  rgb[5] = 0, rgb[6] = -1, rgb[7] = 0.7f, rgb[8] = 0.0031308f, rgb[9] = 0x1p-12f, rgb[10] = 8, rgb[11] = 1e9f;
  skf_render_srgb(rgb, WIDTH, WIDTH * HEIGHT, out);
  for (int k = 0; k < 3 * WIDTH * HEIGHT; k++) {
    unsigned h = (unsigned)(k / 3 % WIDTH) * 73856093u ^ (unsigned)(k / 3 / WIDTH) * 19349663u;
    h = (h ^ h >> 15) * 0x2c1b3c6du, h = (h ^ h >> 12) * 0x297a2d39u, h ^= h >> 15;
    double x = rgb[k], p = x <= 0.7 ? fmax(x, 0) : 1 - 0.3 * exp((0.7 - x) / 0.3);
    double v = 255 * (p <= 0.0031308 ? 12.92 * p : 1.055 * pow(p, 1 / 2.4) - 0.055) + h / 4294967296.0;
    assert_int_equal(out[k], (int)fmin(v, 255));
  }
  free(rgb), free(out);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(silhouette),
      cmocka_unit_test(edges_are_smoothed),
      cmocka_unit_test(shadows_fall),
      cmocka_unit_test(threads_change_nothing),
      cmocka_unit_test(can_be_stopped),
      cmocka_unit_test(wrong_arguments),
      cmocka_unit_test(cameras_frame_what_there_is),
      cmocka_unit_test(endless_surfaces_are_seen),
      cmocka_unit_test(light_becomes_bytes),
      cmocka_unit_test(tables_change_no_byte),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
