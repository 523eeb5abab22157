/* SPDX-License-Identifier: MIT */
/* Light on materials against what optics says: Lambert, Snell, Fresnel, mixing, textures, fog. */
#include "check.h"
#include "ray/render.h"
#include <string.h>

static const skf_progress silent = {NULL, NULL};

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

enum { W = 60, H = 60 };

/* Parallel rays along y; the picture shows 3 units, x to the right, z upwards. */
static skf_render_scene straight(const skf_render_body *bodies, size_t n, const skf_light *light) {
  skf_render_scene s = {.bodies = bodies, .body_count = n, .lights = light, .light_count = 1};
  s.width = W, s.height = H, s.samples = 1;
  s.camera = (skf_camera){.given = true, .from = {0, -10, 0}, .up = {0, 0, 1}, .height = 3};
  return s;
}

static double place(int pixel) { return (pixel + 0.5 - W / 2) * 3.0 / W; }

static const float *pixel(const float *rgb, int x, int y) { return rgb + 3 * (y * W + x); }

/* A matt sphere sends colour times light times the cosine; the silhouette of parallel rays is exact. */
static void lambert(void **state) {
  (void)state;
  static float rgb[W * H * 3], depth[W * H];
  ball b = make(v3(0, 0, 0), 1);
  skf_look look = skf_look_default();
  memset(look.specular, 0, sizeof look.specular);
  look.ambient = 0, look.diffuse = 0.5, look.color[1] = 0.25;
  skf_render_body body = {.tracer = b.tracer, .looks = &look, .look_count = 1};
  const skf_light lamp = {.directional = true, .at = {1, -2, 2}, .color = {1, 2, 3}, .radius = -1};
  skf_render_scene s = straight(&body, 1, &lamp);
  assert_int_equal(skf_render(&s, rgb, depth, silent), SKF_OK);
  int seen = 0;
  for (int y = 0; y < H; y++)
    for (int x = 0; x < W; x++) {
      double px = place(x), pz = -place(y), r2 = px * px + pz * pz;
      seen += isfinite(depth[y * W + x]);
      assert_true(isfinite(depth[y * W + x]) == (r2 < 1));
      if (r2 >= 1) continue;
      double py = -sqrt(1 - r2), cosine = fmax((px - 2 * py + 2 * pz) / 3, 0);
      check_close(depth[y * W + x], 10 + py, 1e-6);
      for (int c = 0; c < 3; c++)
        check_close(pixel(rgb, x, y)[c] + 1, 1 + 0.5 * (c == 1 ? 0.25 : 0.8) * (c + 1) * cosine, 1e-5);
    }
  check_close((double)seen, SKF_PI * 20 * 20, 0.01); /* 20 pixels are one unit */
  drop(b);
}

static double schlick_free(double cosine, double n) { /* Fresnel by the tangents' formula, another way to write it */
  double i = acos(cosine), t = asin(sin(i) / n);
  if (i < 1e-9) return pow((n - 1) / (n + 1), 2);
  double p = tan(i - t) / tan(i + t), q = sin(i - t) / sin(i + t);
  return (p * p + q * q) / 2;
}

static void fresnel(void **state) {
  (void)state;
  double bent = 0;
  for (double n = 1.1; n < 2.5; n += 0.2)
    for (double c = 1; c > 0.01; c -= 0.07) {
      check_close(skf_fresnel(c, 1 / n, &bent), schlick_free(c, n), 1e-9);
      check_close(sqrt(1 - bent * bent) * n + 1, sqrt(1 - c * c) + 1, 1e-12); /* Snell */
      double out;                                                             /* backwards the same share */
      check_close(skf_fresnel(bent, n, &out), schlick_free(c, n), 1e-9);
      check_close(out, c, 1e-9);
    }
  check_close(skf_fresnel(1, 1 / 1.5, &bent), 0.04, 1e-12);
  assert_true(skf_fresnel(cos(0.74), 1.5, &bent) == 1 && skf_fresnel(cos(0.72), 1.5, &bent) < 1); /* 41.8 degrees */
}

/* A ray through a ball of glass leaves it where Snell's law says: what is seen of a gradient of fog-free background. */
static void glass(void **state) {
  (void)state;
  static float rgb[W * H * 3];
  const double n = 1.3;
  ball b = make(v3(0, 0, 0), 1);
  skf_look look = skf_look_default();
  memset(look.specular, 0, sizeof look.specular);
  look.ambient = look.diffuse = 0, look.ior = n;
  look.transparency[0] = 1, look.transparency[1] = 0.5; /* and no blue */
  skf_render_body body = {.tracer = b.tracer, .looks = &look, .look_count = 1};
  const skf_light dark = {.directional = true, .at = {0, 0, 1}};
  skf_render_scene s = straight(&body, 1, &dark);
  for (int c = 0; c < 3; c++) s.background[1][c] = 1;
  s.bounces = 2; /* in and out; what is mirrored inside sees the background at once: its share is small */
  assert_int_equal(skf_render(&s, rgb, NULL, silent), SKF_OK);
  for (int y = 12; y < H - 12; y += 3) {
    double z = -place(y), i = asin(fabs(z)), t = asin(fabs(z) / n), turned = 2 * (i - t); /* towards the axis */
    double share = 1 - skf_fresnel(cos(i), 1 / n, &(double){0});
    double want = 0.5 - 0.5 * copysign(tan(turned), z) / 0.36; /* as the view's background has it */
    want = fmin(fmax(want, 0), 1) * share * share;
    const float *got = pixel(rgb, W / 2, y);
    double off = 0.5 * (1.0 / 40); /* the pixel is half a pixel beside the middle plane */
    assert_true(fabs(got[0] - want) < 0.06 + off);
    assert_true(fabs(got[1] - 0.25 * want) < 0.04 + off); /* filtered on both surfaces */
    assert_true(got[2] == 0);
  }
  /* Without refraction only the filter is left. */
  look.ior = 1;
  assert_int_equal(skf_render(&s, rgb, NULL, silent), SKF_OK);
  check_close(pixel(rgb, W / 2, 20)[1] + 1.0, 0.5 * 0.25 + 1, 1e-6);
  drop(b);
}

/* A mirror shows the other ball where the mirrored ray hits it. */
static void mirror(void **state) {
  (void)state;
  static float rgb[W * H * 3];
  ball b = make(v3(0, 0, 0), 1), a = make(v3(-6, 0, 0), 1);
  skf_look looks[2] = {skf_look_default(), skf_look_default()};
  memset(looks[0].specular, 0, sizeof looks[0].specular);
  looks[0].ambient = looks[0].diffuse = looks[1].diffuse = 0;
  for (int c = 0; c < 3; c++) looks[0].reflection[c] = 0.5, looks[1].color[c] = c == 0;
  looks[1].ambient = 1;
  const skf_render_body bodies[2] = {{.tracer = b.tracer, .looks = looks, .look_count = 1},
                                     {.tracer = a.tracer, .looks = looks + 1, .look_count = 1}};
  const skf_light dark = {.directional = true, .at = {0, 0, 1}};
  skf_render_scene s = straight(bodies, 2, &dark);
  assert_int_equal(skf_render(&s, rgb, NULL, silent), SKF_OK);
  int red = 0, most = 0, least = 0; /* what may be red, and what must */
  for (int x = 12; x < 48; x++) {
    double px = place(x), py = -sqrt(1 - px * px), dx = -2 * py * px, dy = 1 - 2 * py * py; /* d - 2 (d n) n */
    double cx = -6 - px, cy = -py, along = cx * dx + cy * dy, miss2 = cx * cx + cy * cy - along * along;
    bool hit = along > 0 && miss2 < 1, is_red = pixel(rgb, x, H / 2)[1] < 0.01 && pixel(rgb, x, H / 2)[0] > 0.01;
    if (fabs(miss2 - 1) > 0.05) assert_true(hit == is_red);
    red += is_red, most += along > 0 && miss2<1.05, least += along> 0 && miss2 < 0.95;
  }
  assert_true(least >= 1 && red >= least && red <= most);
  drop(a), drop(b);
}

/* Two overlapping points of different colours: each place has the shares of their fields. */
static void shares(void **state) {
  (void)state;
  skf_element e[3] = {
      {.primitive = {.shape = SKF_POINT, .point = {{-0.5, 0, 0}}}, .kernel = {SKF_GAUSSIAN, 1}, .strength = 1},
      {.primitive = {.shape = SKF_POINT, .point = {{0.5, 0, 0}}}, .kernel = {SKF_GAUSSIAN, 1}, .strength = 2},
      {.primitive = {.shape = SKF_POINT, .point = {{0, 0, 0.2}}}, .kernel = {SKF_GAUSSIAN, 1}, .strength = -0.1}};
  skf_look looks[2] = {skf_look_default(), skf_look_default()};
  for (int c = 0; c < 3; c++) looks[0].color[c] = c == 0, looks[1].color[c] = c == 2;
  looks[1].shine = 100, looks[1].transparency[2] = 0.5;
  const unsigned char look_of[] = {0, 1, 0};
  skf_render_body body = {.looks = looks, .look_count = 2, .elements = e, .element_count = 3, .look_of = look_of};
  skf_palette *p;
  assert_int_equal(skf_palette_new(&body, &p), SKF_OK);
  for (double x = -1; x <= 1; x += 0.1) {
    skf_sight at = {.own = {x, 0.3, 0.1}, .normal = {0, 0, 1}};
    skf_look look;
    skf_vec3 normal;
    skf_palette_at(p, &body, &at, &look, &normal);
    double a = exp(-(x + 0.5) * (x + 0.5)), b = 2 * exp(-(x - 0.5) * (x - 0.5)), t = b / (a + b);
    check_close(look.color[0], 1 - t, 1e-12);
    check_close(look.color[2], t, 1e-12);
    check_close(look.shine, 10.5 + t * 89.5, 1e-12);
    check_close(look.transparency[2], 0.5 * t, 1e-12);
    check_close(look.ior, 1, 1e-14);
  }
  skf_palette_free(p);
}

static void textures(void **state) {
  (void)state;
  const double uv[2] = {0.3, 0.6};
  double rgb[3];
  skf_texture t = {.size = 0.5, .axis = {0, 0, 2}, .colors = {{1, 1, 1}, {0, 0.5, 0}}};
  for (int i = -3; i < 4; i++) { /* checker: neighbours differ in every direction */
    double at = 0.5 * i + 0.2, black = abs(i) % 2;
    skf_texture_color(&t, v3(at, 0.1, 0.1), uv, rgb);
    check_close(rgb[0] + 1, 2 - black, 1e-15);
    skf_texture_color(&t, v3(0.1, 0.6, at), uv, rgb);
    check_close(rgb[0] + 1, 1 + black, 1e-15);
  }
  t.type = SKF_TEXTURE_MARBLE; /* without turbulence a wave along the axis */
  skf_texture_color(&t, v3(7, 8, 0.125), uv, rgb);
  check_close(rgb[0], 0.5, 1e-12);
  check_close(rgb[1], 0.75, 1e-12);
  t.type = SKF_TEXTURE_ONION, t.at = v3(1, 0, 0);
  skf_texture_color(&t, v3(1, 0.15, 0.2), uv, rgb); /* a radius of 0.25: half a period */
  check_close(rgb[0] + 1, 1, 1e-12);
  t.type = SKF_TEXTURE_WOOD;
  skf_texture_color(&t, v3(1.2, 0, 77), uv, rgb); /* 0.4 periods from the axis: half way to the dark edge */
  check_close(rgb[0], 0.5, 1e-12);
  t.type = SKF_TEXTURE_GRANITE;
  double least = 1, most = 0;
  for (int i = 0; i < 500; i++) {
    skf_texture_color(&t, v3(0.37 * i, 0.11 * i, -0.23 * i), uv, rgb);
    least = fmin(least, rgb[0]), most = fmax(most, rgb[0]);
  }
  assert_true(least >= 0 && most <= 1 && most - least > 0.5);
  t.type = SKF_TEXTURE_RIPPLES, t.height = 0.5;
  skf_vec3 g = skf_texture_relief(&t, v3(1, 0, 0.5)); /* a whole period: the steepest place, outwards */
  check_close(g.z, 0.5, 1e-12);
  assert_true(g.x == 0 && g.y == 0);
}

static void noise_is_smooth(void **state) {
  (void)state;
  skf_vec3 g;
  for (int i = 0; i < 200; i++) {
    skf_vec3 p = v3(0.37 * i - 30, 0.511 * i, 20 - 0.29 * i);
    double h = 1e-6, n = skf_noise(p, &g);
    assert_true(fabs(n) <= 1);
    check_close(2 + (skf_noise(v3(p.x + h, p.y, p.z), NULL) - skf_noise(v3(p.x - h, p.y, p.z), NULL)) / (2 * h),
                2 + g.x, 1e-7);
    check_close(2 + (skf_noise(v3(p.x, p.y, p.z + h), NULL) - skf_noise(v3(p.x, p.y, p.z - h), NULL)) / (2 * h),
                2 + g.z, 1e-7);
    assert_true(skf_noise(v3(i, -i, 2 * i), NULL) == 0);
  }
}

static void images_by_uv(void **state) {
  (void)state;
  float pixels[2 * 2 * 3] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}; /* red, green; blue, white */
  const skf_image image = {2, 2, pixels};
  skf_texture t = {.type = SKF_TEXTURE_IMAGE, .size = 1, .image = &image};
  const double corner[4][2] = {{0.25, 0.75}, {0.75, 0.75}, {0.25, 0.25}, {0.75, 0.25}};
  double rgb[3], uv[2];
  for (int i = 0; i < 4; i++) {
    skf_texture_color(&t, v3(0, 0, 0), corner[i], rgb);
    for (int c = 0; c < 3; c++) check_close(rgb[c] + 1.0, pixels[3 * i + c] + 1.0, 1e-12);
  }
  skf_texture_color(&t, v3(0, 0, 0), (const double[]){0.5, 0.75}, rgb);
  check_close(rgb[0], 0.5, 1e-12);
  for (int i = 0; i < 4; i++) { /* at the ends of a segment the other one is not seen */
    double end[2] = {corner[i][0], corner[i][1] > 0.5};
    skf_texture_inset(&t, SKF_SEGMENT, end);
    skf_texture_color(&t, v3(0, 0, 0), end, rgb);
    for (int c = 0; c < 3; c++) check_close(rgb[c] + 1.0, pixels[3 * i + c] + 1.0, 1e-12);
  }
  skf_primitive p = {.shape = SKF_SEGMENT, .segment = {{0, 0, 0}, {0, 0, 4}}};
  skf_primitive_uv(&p, v3(1, 0, 1), uv);
  double first = uv[0];
  check_close(uv[1], 0.25, 1e-14);
  skf_primitive_uv(&p, v3(-1, 0, 1), uv);
  check_close(fabs(uv[0] - first), 0.5, 1e-12);
  static const double z[4] = {-1, 5, 4, -4}, mirrored[4] = {0.25, 0.75, 1, 1}; /* beyond the ends */
  for (int i = 0; i < 4; i++) {
    skf_primitive_uv(&p, v3(0.5, 0.1, z[i]), uv);
    check_close(uv[1], mirrored[i], 1e-12);
  }
  p = (skf_primitive){.shape = SKF_TRIANGLE, .triangle = {{{0, 0, 0}, {2, 0, 0}, {1, 3, 0}}}};
  skf_primitive_uv(&p, v3(0.25 * 2 + 0.5 * 1, 0.5 * 3, 0.7), uv);
  check_close(uv[0], 0.25, 1e-12);
  check_close(uv[1], 0.5, 1e-12);
  p = (skf_primitive){.shape = SKF_ARC, .arc = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 2, SKF_PI}};
  skf_primitive_uv(&p, v3(0, 2.5, 0), uv);
  check_close(uv[1], 0.5, 1e-12);
  for (int end = -1; end <= 1; end += 2) { /* straight on beyond the ends: 0.5 of the arc's length 2 pi */
    skf_primitive_uv(&p, v3(1.9 * end, -0.5, 0.1), uv);
    check_close(uv[1], end > 0 ? 0.25 / SKF_PI : 1 - 0.25 / SKF_PI, 1e-12);
  }
  p = (skf_primitive){.shape = SKF_POINT, .point = {{0, 0, 0}}};
  skf_primitive_uv(&p, v3(0, 1, 1), uv);
  check_close(uv[0], 0.25, 1e-12);
  check_close(uv[1], 0.75, 1e-12);
}

static void fog_swallows(void **state) {
  (void)state;
  static float rgb[W * H * 3];
  ball b = make(v3(0, 0, 0), 1);
  skf_render_body body = {.tracer = b.tracer, .color = {0, 0, 0}};
  const skf_light dark = {.directional = true, .at = {0, 0, 1}};
  skf_render_scene s = straight(&body, 1, &dark);
  s.fog = (skf_fog){5, {1, 0.5, 0}};
  assert_int_equal(skf_render(&s, rgb, NULL, silent), SKF_OK);
  double t = 10 - sqrt(1 - 2 * place(30) * place(30));
  check_close(pixel(rgb, 30, 30)[0], 1 - exp(-t / 5), 1e-6);
  check_close(pixel(rgb, 30, 30)[1], 0.5 * (1 - exp(-t / 5)), 1e-6);
  check_close(pixel(rgb, 1, 1)[0], 1, 1e-6);
  drop(b);
}

/* Rays that end after so many bounces see the background through all of the fog, as others do. */
static void fog_behind_bounces(void **state) {
  (void)state;
  static float rgb[W * H * 3];
  ball b = make(v3(0, 0, 0), 1), a = make(v3(-3, 0, 0), 1);
  skf_look look = skf_look_default();
  memset(look.specular, 0, sizeof look.specular);
  look.ambient = look.diffuse = 0;
  for (int c = 0; c < 3; c++) look.reflection[c] = 0.9;
  const skf_render_body bodies[2] = {{.tracer = b.tracer, .looks = &look, .look_count = 1},
                                     {.tracer = a.tracer, .looks = &look, .look_count = 1}};
  const skf_light dark = {.directional = true, .at = {0, 0, 1}};
  skf_render_scene s = straight(bodies, 2, &dark);
  for (int c = 0; c < 3; c++) s.background[0][c] = s.background[1][c] = 1;
  s.bounces = 1;
  assert_int_equal(skf_render(&s, rgb, NULL, silent), SKF_OK);
  assert_true(pixel(rgb, W / 2, H / 2)[0] > 0.8);
  s.fog = (skf_fog){1e9, {0, 0, 0}};
  assert_int_equal(skf_render(&s, rgb, NULL, silent), SKF_OK);
  for (int i = 0; i < W * H * 3; i++) assert_true(fabsf(rgb[i]) < 1e-6f);
  drop(a), drop(b);
}

/* However steep a relief is, a convex mirror shows what is around it, not its inside. */
static void relief_on_a_mirror(void **state) {
  (void)state;
  static float rgb[W * H * 3];
  ball b = make(v3(0, 0, 0), 1);
  skf_look look = skf_look_default();
  memset(look.specular, 0, sizeof look.specular);
  look.ambient = look.diffuse = 0, look.texture_count = 1;
  look.textures[0] = (skf_texture){.type = SKF_TEXTURE_BUMPS, .size = 0.1, .height = 3};
  for (int c = 0; c < 3; c++) look.reflection[c] = 1;
  skf_render_body body = {.tracer = b.tracer, .looks = &look, .look_count = 1};
  const skf_light dark = {.directional = true, .at = {0, 0, 1}};
  skf_render_scene s = straight(&body, 1, &dark);
  for (int c = 0; c < 3; c++) s.background[0][c] = s.background[1][c] = 1;
  assert_int_equal(skf_render(&s, rgb, NULL, silent), SKF_OK);
  for (int i = 0; i < W * H * 3; i++) check_close(rgb[i], 1, 1e-6);
  drop(b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(lambert),
      cmocka_unit_test(fresnel),
      cmocka_unit_test(glass),
      cmocka_unit_test(mirror),
      cmocka_unit_test(shares),
      cmocka_unit_test(textures),
      cmocka_unit_test(noise_is_smooth),
      cmocka_unit_test(images_by_uv),
      cmocka_unit_test(fog_swallows),
      cmocka_unit_test(fog_behind_bounces),
      cmocka_unit_test(relief_on_a_mirror),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
