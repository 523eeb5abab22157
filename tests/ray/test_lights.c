/* SPDX-License-Identifier: MIT */
/* Shadows and their edges, cameras, lenses, shutters: where geometry says. */
#include "check.h"
#include "ray/render.h"
#include <omp.h>
#include <string.h>

static const skf_progress silent = {NULL, NULL};

typedef struct stand {
  skf_offsets *floor, *ball;
  skf_render_body bodies[2];
  skf_look white, other;
} stand;

/* A floor z = 0, matt and white, and a ball above it. */
static void build(stand *s, skf_vec3 at, double radius) {
  skf_offset floor = {{.shape = SKF_PLANE, .plane = {{0, 0, -1}, {0, 0, 1}}}, 1};
  skf_offset ball = {{.shape = SKF_POINT, .point = {at}}, radius};
  assert_int_equal(skf_offsets_new(&floor, 1, &s->floor), SKF_OK);
  assert_int_equal(skf_offsets_new(&ball, 1, &s->ball), SKF_OK);
  s->white = skf_look_default();
  s->white.ambient = 0;
  memset(s->white.specular, 0, sizeof s->white.specular);
  for (int c = 0; c < 3; c++) s->white.color[c] = 1;
  s->other = s->white;
  s->bodies[0] = (skf_render_body){.offsets = s->floor, .looks = &s->white, .look_count = 1};
  s->bodies[1] = (skf_render_body){.offsets = s->ball, .looks = &s->other, .look_count = 1};
}

static void drop(stand *s) { skf_offsets_free(s->floor), skf_offsets_free(s->ball); }

enum { W = 200, H = 20 };

/* From below the ball straight down on the floor: x to the right over 10 units, 20 pixels each. */
static skf_render_scene down(const stand *s, const skf_light *light) {
  skf_render_scene r = {.bodies = s->bodies, .body_count = 2, .lights = light, .light_count = 1};
  r.width = W, r.height = H, r.samples = 1;
  r.camera = (skf_camera){.given = true, .from = {0, 0, 1}, .up = {0, 1, 0}, .height = 1};
  return r;
}

static double at(int x) { return (x + 0.5 - W / 2) / 20.0; }

/* A lamp at height 6 over a ball of radius 0.5 at height 3: the cone's edge is known. */
static void hard_shadow(void **state) {
  (void)state;
  static float rgb[W * H * 3];
  stand s;
  build(&s, v3(0, 0, 3), 0.5);
  const skf_light lamp = {.at = {0, 0, 6}, .color = {1, 1, 1}};
  skf_render_scene r = down(&s, &lamp);
  assert_int_equal(skf_render(&r, rgb, NULL, silent), SKF_OK);
  double edge = 6 * tan(asin(0.5 / 3));
  for (int x = 0; x < W; x++)
    for (int y = 0; y < H; y++) {
      double px = at(x), py = (y + 0.5 - H / 2) / 20.0, out = hypot(px, py);
      double lit = out > edge ? 6 / sqrt(36 + out * out) : 0; /* the cosine; no falling off with distance */
      if (fabs(out - edge) > 1e-9) check_close(rgb[3 * (y * W + x)] + 1.0, lit + 1, 1e-6);
    }
  drop(&s);
}

/* A square lamp, 1 wide, and the edge of a wide disc-like slab... here a ball so large that its edge is straight. */
static double penumbra(const skf_light *lamp, double *from, double *to) {
  static float rgb[W * H * 3];
  stand s;
  build(&s, v3(0, 0, 3), 1);
  s.bodies[1].offsets = NULL;
  skf_offsets *half; /* a half plane x < 0 at height 3, thin */
  skf_offset sheet = {{.shape = SKF_TRIANGLE, .triangle = {{{0, -4000, 3}, {0, 4000, 3}, {-4000, 0, 3}}}}, 0};
  assert_int_equal(skf_offsets_new(&sheet, 1, &half), SKF_OK);
  s.bodies[1].offsets = half;
  skf_render_scene r = down(&s, lamp);
  r.quality = SKF_RENDER_FINE;
  assert_int_equal(skf_render(&r, rgb, NULL, silent), SKF_OK);
  double area = 0;
  *from = 5, *to = -5;
  for (int x = 0; x < W; x++) {
    double sum = 0, cosine = 0;
    for (int y = 0; y < H; y++) sum += rgb[3 * (y * W + x)] / H;
    cosine = 6 / hypot(6, at(x));
    double seen = sum / cosine;
    area += seen / 20;
    if (seen > 0.03 && seen < 0.97) *from = fmin(*from, at(x)), *to = fmax(*to, at(x));
  }
  skf_offsets_free(half);
  drop(&s);
  return area; /* lit length of 10 */
}

static void soft_shadows(void **state) {
  (void)state;
  double from, to;
  /* The lamp's edges at x = -0.5 and 0.5, height 6, the sheet's edge half way down: dark to -0.5, lit from 0.5 on. */
  const skf_light square = {.at = {0, 0, 6}, .color = {1, 1, 1}, .u = {1, 0, 0}, .v = {0, 1, 0}};
  check_close(penumbra(&square, &from, &to), 5, 0.02);
  assert_true(fabs(from + 0.47) < 0.2 && fabs(to - 0.47) < 0.2);
  const skf_light ball = {.at = {0, 0, 6}, .color = {1, 1, 1}, .radius = 1};
  check_close(penumbra(&ball, &from, &to), 5, 0.02);
  assert_true(from < -0.7 && from > -1.2 && to > 0.7 && to < 1.2);
  const skf_light small = {.at = {0, 0, 6}, .color = {1, 1, 1}, .radius = 1e-3};
  check_close(penumbra(&small, &from, &to), 5, 0.02);
  assert_true(to - from < 0.5);
}

/* Light through a clear ball is filtered on both of its surfaces. */
static void coloured_shadow(void **state) {
  (void)state;
  static float rgb[W * H * 3];
  stand s;
  build(&s, v3(0, 0, 3), 0.5);
  s.other.transparency[0] = 1, s.other.transparency[1] = 0.5;
  const skf_light lamp = {.at = {0, 0, 6}, .color = {1, 1, 1}};
  skf_render_scene r = down(&s, &lamp);
  assert_int_equal(skf_render(&r, rgb, NULL, silent), SKF_OK);
  const float *middle = rgb + 3 * (10 * W + W / 2);
  check_close(middle[0], 1, 1e-3);
  check_close(middle[1], 0.25, 1e-3);
  assert_true(middle[2] == 0);
  drop(&s);
}

/* Parallel rays: sizes in pixels are exact wherever it is; with a lens what is in focus stays sharp. */
static void lens(void **state) {
  (void)state;
  enum { N = 41 };
  static float rgb[N * N * 3];
  stand s;
  build(&s, v3(0, 0, 0), 1);
  skf_light lamp = {.directional = true, .at = {0, 0, 1}, .color = {1, 1, 1}, .radius = -1};
  skf_render_scene r = {.bodies = s.bodies + 1, .body_count = 1, .lights = &lamp, .light_count = 1};
  r.width = r.height = N, r.samples = 256;
  r.camera = (skf_camera){.given = true, .from = {0, 0, 10}, .up = {0, 1, 0}, .fov = 0.4, .aperture = 0.5};
  for (int c = 0; c < 3; c++) s.other.color[c] = 0, r.background[0][c] = r.background[1][c] = 1; /* a black disc */
  double dark[2];
  for (int k = 0; k < 2; k++) {
    int grey = 0;
    r.camera.focus = k ? 4 : 10;
    assert_int_equal(skf_render(&r, rgb, NULL, silent), SKF_OK);
    dark[k] = 0;
    for (int i = 0; i < N * N; i++) dark[k] += 1 - rgb[3 * i], grey += rgb[3 * i] > 0.05 && rgb[3 * i] < 0.95;
    assert_true(k ? grey > 400 : grey < 120); /* blurred over the width of the lens as it is seen from there */
  }
  double radius = N / 2.0 * tan(asin(0.1)) / tan(0.2);
  check_close(dark[0], SKF_PI * radius * radius, 0.03);
  drop(&s);
}

/* A ball on a turning arm: the shutter smears it along its way, as long as it is open. */
static void shutter(void **state) {
  (void)state;
  static float rgb[W * W * 3];
  stand s;
  build(&s, v3(2, 0, 0), 0.2);
  skf_light lamp = {.directional = true, .at = {0, 0, 1}, .color = {1, 1, 1}};
  skf_render_scene r = {.bodies = s.bodies + 1, .body_count = 1, .lights = &lamp, .light_count = 1};
  r.width = r.height = 100, r.samples = 64;
  r.camera = (skf_camera){.given = true, .from = {0, 0, 10}, .up = {0, 1, 0}, .height = 5};
  for (int c = 0; c < 3; c++) s.other.color[c] = 0, r.background[0][c] = r.background[1][c] = 1;
  s.bodies[1].axis = v3(0, 0, 3), s.bodies[1].angle = 0.5, s.bodies[1].sweep = 1;
  assert_int_equal(skf_render(&r, rgb, NULL, silent), SKF_OK);
  double dark = 0, first = 9, last = -9;
  for (int y = 0; y < 100; y++)
    for (int x = 0; x < 100; x++) {
      double px = (x + 0.5 - 50) / 20, py = (50 - y - 0.5) / 20, d = 1 - rgb[3 * (y * 100 + x)];
      dark += d / 400;
      if (d < 0.05) continue;
      assert_true(fabs(hypot(px, py) - 2) < 0.26);
      first = fmin(first, atan2(py, px)), last = fmax(last, atan2(py, px));
    }
  check_close(dark, SKF_PI * 0.2 * 0.2, 0.05); /* as much as there is of the ball */
  assert_true(fabs(first - 0.42) < 0.06 && fabs(last - 1.58) < 0.06);
  /* At rest it is where the angle says, sharp. */
  s.bodies[1].sweep = 0;
  assert_int_equal(skf_render(&r, rgb, NULL, silent), SKF_OK);
  int x = (int)(50 + 40 * cos(0.5)), y = (int)(50 - 40 * sin(0.5));
  assert_true(rgb[3 * (y * 100 + x)] == 0);
  drop(&s);
}

static void threads_change_nothing(void **state) {
  (void)state;
  enum { N = 48 };
  static float one[N * N * 3], three[N * N * 3];
  stand s;
  build(&s, v3(0, 0, 1), 1);
  for (int c = 0; c < 3; c++) s.other.transparency[c] = 0.7, s.white.reflection[c] = 0.3;
  s.other.ior = 1.4, s.white.ambient = 1;
  const skf_light lamp = {.at = {3, 1, 6}, .color = {1, 1, 1}, .radius = 0.5};
  skf_render_scene r = {.bodies = s.bodies, .body_count = 2, .lights = &lamp, .light_count = 1};
  r.width = r.height = N, r.samples = 32;
  int before = omp_get_max_threads();
  for (int k = 0; k < 2; k++) {
    r.camera = (skf_camera){.given = true, .from = {4, -6, 4}, .up = {0, 0, 1}, .fov = 0.6, .aperture = k ? 0.2 : 0};
    omp_set_num_threads(1);
    assert_int_equal(skf_render(&r, one, NULL, silent), SKF_OK);
    omp_set_num_threads(3);
    assert_int_equal(skf_render(&r, three, NULL, silent), SKF_OK);
    assert_memory_equal(one, three, sizeof one);
  }
  omp_set_num_threads(before);
  drop(&s);
}

static void draft_is_local(void **state) {
  (void)state;
  static float rgb[W * H * 3];
  stand s;
  build(&s, v3(0, 0, 3), 0.5);
  const skf_light lamp = {.at = {0, 0, 6}, .color = {1, 1, 1}};
  skf_render_scene r = down(&s, &lamp);
  r.quality = SKF_RENDER_DRAFT;
  assert_int_equal(skf_render(&r, rgb, NULL, silent), SKF_OK);
  for (int x = 0; x < W; x++) check_close(rgb[3 * (10 * W + x)], 6 / sqrt(36 + at(x) * at(x) + 0.025 * 0.025), 1e-6);
  drop(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(hard_shadow),    cmocka_unit_test(soft_shadows), cmocka_unit_test(coloured_shadow),
      cmocka_unit_test(lens),           cmocka_unit_test(shutter),      cmocka_unit_test(threads_change_nothing),
      cmocka_unit_test(draft_is_local),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
