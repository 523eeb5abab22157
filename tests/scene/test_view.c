/* SPDX-License-Identifier: MIT */
/* What pictures need of a scene: materials, textures, cameras, lights, fog, animation. */
#include "scene/scene_text.h"
#include "core/vec3.h"

static skf_scene *good(const char *text) {
  skf_scene *scene;
  skf_error e;
  if (parse(text, &scene, &e)) fail_msg("line %ld: %s", e.line, e.text);
  return scene;
}

static const char looks[] =
    "skelfield: 1\n"
    "materials:\n"
    "  - {name: glass, ambient: 0.1, diffuse: 0.2, specular: 0.3, shine: 40, reflection: [0.1, 0.2, 0.3],\n"
    "     transparency: 0.5, ior: 1.5}\n"
    "  - {name: stone, color: [0.5, 0.4, 0.3], texture: [{type: marble, size: 2, at: [1, 2, 3], axis: [1, 0, 0],\n"
    "     colors: [[1, 0, 0], [0, 1, 0]], turbulence: 0.7}, {type: bumps, height: 0.1}]}\n"
    "  - {name: photo, texture: {type: image, file: a.png}}\n"
    "bodies:\n"
    "  - {name: a, iso: 1, kernel: {type: inverse}, material: glass, color: [0.9, 0.8, 0.7], skeleton: [\n"
    "     {point: {at: [0, 0, 0]}},\n"
    "     {point: {at: [1, 0, 0], material: stone}},\n"
    "     {polyline: {points: [[0, 0, 0], [1, 0, 0], [2, 1, 0]], color: [0.1, 0.2, 0.3]}},\n"
    "     {point: {at: [2, 0, 0], material: stone}},\n"
    "     {point: {at: [2, 0, 1], material: photo, color: [1, 1, 1]}}]}\n"
    "  - {name: b, iso: 1, kernel: {type: inverse}, skeleton: [{point: {at: [9, 0, 0]}}]}\n"
    "camera: {eye: [0, 0, 9], vrp: [0, 0, 1], vup: [0, 1, 0], projection: orthographic, height: 4, aperture: 0.1,\n"
    "  focus: 7, shutter: 0.5}\n"
    "lights:\n"
    "  - {point: [1, 2, 3], radius: 0.5}\n"
    "  - {point: [1, 2, 3], area: {u: [1, 0, 0], v: [0, 2, 0]}}\n"
    "  - {direction: [0, 0, 1], angle: 0}\n"
    "  - {direction: [0, 0, 1], angle: 45}\n"
    "background: {bottom: [0.1, 0.2, 0.3], top: [0.4, 0.5, 0.6]}\n"
    "fog: {distance: 30, color: [0.7, 0.8, 0.9]}\n";

static void every_key_is_read(void **state) {
  (void)state;
  skf_scene *s = good(looks);
  const skf_body *b = s->bodies;
  assert_int_equal(b->look_count, 4);
  const unsigned char want[] = {0, 1, 2, 2, 1, 3};
  assert_int_equal(b->element_count, 6);
  assert_memory_equal(b->look_of, want, 6);
  const skf_look *own = b->looks, *stone = b->looks + 1, *blue = b->looks + 2, *photo = b->looks + 3;
  assert_true(own->color[0] == 0.9 && own->ambient == 0.1 && own->diffuse == 0.2 && own->specular[2] == 0.3);
  assert_true(own->shine == 40 && own->reflection[1] == 0.2 && own->transparency[2] == 0.5 && own->ior == 1.5);
  assert_true(stone->color[1] == 0.4 && stone->shine == 40 && stone->texture_count == 2); /* silent: like the body */
  const skf_texture *t = stone->textures;
  assert_true(t->type == SKF_TEXTURE_MARBLE && t->size == 2 && t->at.z == 3 && t->axis.x == 1 && t->turbulence == 0.7);
  assert_true(t->colors[0][0] == 1 && t->colors[1][1] == 1 && t[1].type == SKF_TEXTURE_BUMPS && t[1].height == 0.1);
  assert_true(blue->color[2] == 0.3 && blue->texture_count == 0 && blue->ior == 1.5);
  assert_true(photo->color[0] == 1 && photo->textures[0].image == &s->images[0]->pixels);
  assert_int_equal(s->image_count, 1);
  assert_string_equal(s->images[0]->path, "./a.png");
  assert_int_equal(s->images[0]->line, 7);
  assert_true(s->bodies[1].look_count == 1 && s->bodies[1].looks[0].color[0] == 0.8);
  const skf_camera *c = &s->camera;
  assert_true(c->given && c->from.z == 9 && c->to.z == 1 && c->up.y == 1 && c->height == 4 && c->aperture == 0.1);
  assert_true(c->focus == 7 && s->shutter == 0.5);
  const skf_light *l = s->lights;
  assert_true(l[0].radius == 0.5 && l[1].u.x == 1 && l[1].v.y == 2 && l[2].radius < 0);
  check_close(l[3].radius, SKF_PI / 4, 1e-15);
  assert_true(s->background[1] == 0.2 && s->background_top[1] == 0.5 && s->fog.distance == 30 &&
              s->fog.color[2] == 0.9);
  skf_scene_free(s);
}

static skf_scene *at_time(const char *text, double t) {
  skf_scene *scene;
  skf_error e;
  const skf_scene_hooks hooks = {.time = t};
  if (skf_scene_parse_with(text, strlen(text), ".", &hooks, &scene, &e)) fail_msg("line %ld: %s", e.line, e.text);
  return scene;
}

static void numbers_change(void **state) {
  (void)state;
  static const char text[] =
      "skelfield: 1\nbodies:\n  - {name: a, iso: 1, kernel: {type: inverse}, skeleton: [{point: {at: [0, 5, 0]}}]}\n"
      "animate:\n  - {path: bodies.a.iso, keys: [[1, 2], [3, 6], [4, 0.5]]}\n"
      "  - {path: bodies.0.skeleton.0.point.at.1, keys: [[0, -1], [10, 1]]}\n";
  const double times[] = {-1, 1, 2, 3, 3.5, 4, 99}, isos[] = {2, 2, 4, 6, 3.25, 0.5, 0.5};
  for (int i = 0; i < 7; i++) {
    skf_scene *s = at_time(text, times[i]);
    check_close(s->bodies[0].iso, isos[i], 1e-15);
    check_close(s->bodies[0].elements[0].primitive.point.at.y + 2, fmin(fmax(times[i], 0), 10) / 5 + 1, 1e-14);
    assert_true(s->animated_until == 10);
    skf_scene_free(s);
  }
  skf_scene *s = good(text); /* no time is time 0 */
  assert_true(s->bodies[0].iso == 2);
  skf_scene_free(s);
}

/* Neither times nor values whose difference is beyond all numbers hinder. */
static void numbers_change_far(void **state) {
  (void)state;
  static const char text[] =
      "skelfield: 1\nbodies:\n  - {name: a, iso: 1, kernel: {type: inverse}, skeleton: [{point: {at: [0, 0, 0]}}]}\n"
      "animate:\n  - {path: bodies.a.iso, keys: [[-1.7e308, 1], [1.7e308, 3]]}\n"
      "  - {path: camera.from.0, keys: [[-1, -1.6e308], [1, 1.6e308]]}\n"
      "camera: {from: [0, 3, 0], to: [0, 0, 0]}\n";
  for (double t = -0.5; t < 0.6; t += 0.25) {
    skf_scene *s = at_time(text, t);
    check_close(s->bodies[0].iso, 2, 1e-15);
    check_close(s->camera.from.x, 1.6e308 * t, 1e-15);
    skf_scene_free(s);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(every_key_is_read), cmocka_unit_test(numbers_change),
                                     cmocka_unit_test(numbers_change_far)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
