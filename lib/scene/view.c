/* SPDX-License-Identifier: MIT */
/* Who looks at the scene, in what light: camera, lights, background, fog. */
#include "scene/reader.h"
#include "core/alloc.h"
#include "core/vec3.h"
#include <string.h>

static const skf_range half_turn = {0, 179, true}, wide = {0, 85, false};

/* A camera while it is read; the thesis's words stand beside ours. */
typedef struct sight {
  skf_camera camera;
  double shutter;
  int projection;
} sight;

static skf_status read_projection(skf_reader *r, const skf_node *node, void *into) {
  static const char *const words[] = {"perspective", "orthographic"};
  return skf_read_choice(r, node, "projection", words, 2, &((sight *)into)->projection);
}

enum { FROM, TO, UP, FOV, PROJECTION, HEIGHT, APERTURE, FOCUS, SHUTTER, EYE, VRP, VUP, CAMERA_KEYS };

static const skf_key camera_keys[CAMERA_KEYS] = {
    [FROM] = {"from", "L", "where the eye is", SKF_KEY_VECTOR, false, .offset = offsetof(sight, camera.from)},
    [TO] = {"to", "L", "what it looks at", SKF_KEY_VECTOR, false, .offset = offsetof(sight, camera.to)},
    [UP] = {"up", "1", "upwards in the picture (default: z)", SKF_KEY_VECTOR, .offset = offsetof(sight, camera.up)},
    [FOV] = {"fov", "deg", "vertical field of view (default: 40)", SKF_KEY_ANGLE, .offset = offsetof(sight, camera.fov),
             .range = &half_turn},
    [PROJECTION] = {"projection", NULL, "(default: perspective)", SKF_KEY_OTHER, .read = read_projection,
                    .form = "perspective or orthographic"},
    [HEIGHT] = {"height", "L", "orthographic: what the picture shows, bottom to top", SKF_KEY_NUMBER,
                .offset = offsetof(sight, camera.height), .range = &skf_positive},
    [APERTURE] = {"aperture", "L", "radius of the lens (default: 0, all is sharp)", SKF_KEY_NUMBER,
                  .offset = offsetof(sight, camera.aperture), .range = &skf_not_negative},
    [FOCUS] = {"focus", "L", "distance that is sharp (default: that of `to`)", SKF_KEY_NUMBER,
               .offset = offsetof(sight, camera.focus), .range = &skf_positive},
    [SHUTTER] = {"shutter", "T", "open so long while bodies spin (default: 0)", SKF_KEY_NUMBER,
                 .offset = offsetof(sight, shutter), .range = &skf_not_negative},
    [EYE] = {"eye", "L", "another word for from", SKF_KEY_VECTOR, .offset = offsetof(sight, camera.from)},
    [VRP] = {"vrp", "L", "another word for to: the view reference point", SKF_KEY_VECTOR,
             .offset = offsetof(sight, camera.to)},
    [VUP] = {"vup", "1", "another word for up", SKF_KEY_VECTOR, .offset = offsetof(sight, camera.up)},
};
const skf_section skf_section_camera = {
    "camera", "for render; without one the bodies are framed; from and to are needed", camera_keys, CAMERA_KEYS};

/* One of two words, not both. */
static skf_status one_word(skf_reader *r, const skf_node *map, unsigned given, int a, int b, bool needed) {
  if (given >> a & given >> b & 1)
    return skf_error_set(r->error, SKF_ERR_PARSE, skf_map_line(r, map, camera_keys[b].name),
                         "both %s and %s in camera, expected one of them", camera_keys[a].name, camera_keys[b].name);
  if (!needed || ((given >> a | given >> b) & 1)) return SKF_OK;
  return skf_error_set(r->error, SKF_ERR_PARSE, map->line, "missing '%s' in camera, expected [x, y, z]",
                       camera_keys[a].name);
}

static skf_status check_height(skf_reader *r, const skf_node *map, const sight *c, unsigned given) {
  bool height = given >> HEIGHT & 1;
  if (c->projection && !height)
    return skf_error_set(r->error, SKF_ERR_PARSE, skf_map_line(r, map, "projection"),
                         "missing 'height' in camera, expected it with projection: orthographic");
  if (c->projection && given >> FOV & 1)
    return skf_error_set(r->error, SKF_ERR_PARSE, skf_map_line(r, map, "fov"),
                         "fov in camera, expected it with projection: perspective alone");
  if (!c->projection && height)
    return skf_error_set(r->error, SKF_ERR_PARSE, skf_map_line(r, map, "height"),
                         "height in camera, expected it with projection: orthographic alone");
  return SKF_OK;
}

skf_status skf_read_camera(skf_reader *r, const skf_node *map, void *into) {
  skf_scene *scene = into;
  sight d = {.camera = scene->camera};
  unsigned given;
  skf_status s = skf_read_map(r, map, &skf_section_camera, &d, &given);
  if (!s) s = one_word(r, map, given, FROM, EYE, true);
  if (!s) s = one_word(r, map, given, TO, VRP, true);
  if (!s) s = one_word(r, map, given, UP, VUP, false);
  if (!s) s = check_height(r, map, &d, given);
  if (s) return s;
  skf_camera *c = &scene->camera;
  *c = d.camera, c->given = true, scene->shutter = d.shutter;
  const char *from = camera_keys[given >> EYE & 1 ? EYE : FROM].name;
  const char *to = camera_keys[given >> VRP & 1 ? VRP : TO].name, *up = camera_keys[given >> VUP & 1 ? VUP : UP].name;
  skf_vec3 view = v3_unit(v3_sub(c->to, c->from));
  if (!(v3_norm(view) > 0))
    return skf_error_set(r->error, SKF_ERR_DEGENERATE, skf_map_line(r, map, to),
                         "%s and %s are the same point, expected two points", from, to);
  if (v3_norm(v3_cross(view, v3_unit(c->up))) > 1e-9) return SKF_OK; /* below, rounding would turn the picture */
  return skf_error_set(r->error, SKF_ERR_DEGENERATE, skf_map_line(r, map, up),
                       "%s is zero or along the view, expected another direction", up);
}

/* A light while it is read. */
typedef struct lamp {
  skf_vec3 point, direction, u, v;
  double color[3], intensity, radius, angle;
} lamp;

static const skf_key area_keys[] = {
    {"u", "L", "one edge", SKF_KEY_VECTOR, true, .offset = offsetof(lamp, u)},
    {"v", "L", "the other one", SKF_KEY_VECTOR, true, .offset = offsetof(lamp, v)},
};
const skf_section skf_section_area = {"area", "a parallelogram of light around the light's point", area_keys, 2};

static skf_status read_area(skf_reader *r, const skf_node *map, void *into) {
  lamp *l = into;
  skf_status s = skf_read_map(r, map, &skf_section_area, l, NULL);
  if (s || v3_norm(v3_cross(v3_unit(l->u), v3_unit(l->v))) > 1e-9) return s;
  return skf_error_set(r->error, SKF_ERR_DEGENERATE, map->line, "u and v span no area, expected two directions");
}

enum { LIGHT_POINT, LIGHT_DIRECTION, LIGHT_COLOR, LIGHT_INTENSITY, LIGHT_RADIUS, LIGHT_AREA, LIGHT_ANGLE, LIGHT_KEYS };

static const skf_key light_keys[LIGHT_KEYS] = {
    {"point", "L", "where it is", SKF_KEY_VECTOR, false, .offset = offsetof(lamp, point)},
    {"direction", "1", "towards a light at infinity", SKF_KEY_VECTOR, false, .offset = offsetof(lamp, direction)},
    {"color", "1", "linear light (default: white)", SKF_KEY_COLOR, false, .offset = offsetof(lamp, color)},
    {"intensity", "1", "factor of the colour (default: 1)", SKF_KEY_NUMBER, false, .offset = offsetof(lamp, intensity),
     .range = &skf_not_negative},
    {"radius", "L", "with point: of a ball of light (default: 0, hard shadows)", SKF_KEY_NUMBER,
     .offset = offsetof(lamp, radius), .range = &skf_not_negative},
    {"area", NULL, "with point: instead of a ball", SKF_KEY_OTHER, .read = read_area, .form = "{u, v}"},
    {"angle", "deg", "with direction: half the angle that it spans (default: 2)", SKF_KEY_ANGLE,
     .offset = offsetof(lamp, angle), .range = &wide},
};
const skf_section skf_section_light = {"light", "a point or a direction, not both", light_keys, LIGHT_KEYS};

/* A key that goes with `other` alone. */
static skf_status lonely(skf_reader *r, const skf_node *map, int key, const char *other) {
  return skf_error_set(r->error, SKF_ERR_PARSE, skf_map_line(r, map, light_keys[key].name),
                       "%s in a light, expected it with %s alone", light_keys[key].name, other);
}

static skf_status read_light(skf_reader *r, const skf_node *map, skf_light *out) {
  lamp l = {.color = {1, 1, 1}, .intensity = 1};
  unsigned given;
  skf_status s = skf_read_map(r, map, &skf_section_light, &l, &given);
  if (s) return s;
  bool point = given >> LIGHT_POINT & 1;
  out->directional = given >> LIGHT_DIRECTION & 1;
  if (point == out->directional)
    return skf_error_set(r->error, SKF_ERR_PARSE, map->line, "a light with %s, expected point or direction",
                         point ? "both point and direction" : "neither point nor direction");
  if (out->directional && !(v3_norm(v3_unit(l.direction)) > 0))
    return skf_error_set(r->error, SKF_ERR_DEGENERATE, skf_map_line(r, map, "direction"),
                         "direction is the zero vector, expected a direction");
  if (given >> LIGHT_RADIUS & 1 && !point) return lonely(r, map, LIGHT_RADIUS, "point");
  if (given >> LIGHT_AREA & 1 && !point) return lonely(r, map, LIGHT_AREA, "point");
  if (given >> LIGHT_ANGLE & 1 && point) return lonely(r, map, LIGHT_ANGLE, "direction");
  if (given >> LIGHT_RADIUS & given >> LIGHT_AREA & 1)
    return skf_error_set(r->error, SKF_ERR_PARSE, skf_map_line(r, map, "area"),
                         "both radius and area in a light, expected one of them");
  out->at = point ? l.point : l.direction, out->u = l.u, out->v = l.v;
  out->radius = point ? l.radius : !(given >> LIGHT_ANGLE & 1) ? 0 : l.angle > 0 ? l.angle : -1;
  for (int i = 0; i < 3; i++) out->color[i] = l.color[i] * l.intensity;
  return SKF_OK;
}

skf_status skf_read_lights(skf_reader *r, const skf_node *list, void *into) {
  skf_scene *scene = into;
  skf_status s = skf_expect(r, list, SKF_NODE_LIST, "lights", "a list of lights");
  if (s) return s;
  if (!list->count)
    return skf_error_set(r->error, SKF_ERR_PARSE, list->line, "lights is empty, expected a list of lights");
  enum { MOST = 8 }; /* that skf_render takes */
  if (list->count > MOST)
    return skf_error_set(r->error, SKF_ERR_RANGE, list->line, "lights has %d entries, expected at most %d", list->count,
                         MOST);
  scene->lights = skf_alloc((size_t)list->count, sizeof *scene->lights);
  if (!scene->lights) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  for (const skf_node *n = skf_node_first(&r->yaml, list); n && !s; n = skf_node_next(&r->yaml, n))
    s = read_light(r, n, scene->lights + scene->light_count++);
  return s;
}

static const skf_key background_keys[] = {
    {"bottom", "1", "linear light", SKF_KEY_COLOR, true, .offset = offsetof(skf_scene, background)},
    {"top", "1", "linear light", SKF_KEY_COLOR, true, .offset = offsetof(skf_scene, background_top)},
};
const skf_section skf_section_background = {"background", "runs from bottom to top of the picture; or one color",
                                            background_keys, 2};

skf_status skf_read_background(skf_reader *r, const skf_node *value, void *into) {
  skf_scene *scene = into;
  if (value->type == SKF_NODE_MAP) return skf_read_map(r, value, &skf_section_background, scene, NULL);
  skf_status s = skf_read_color(r, value, "background", scene->background);
  memcpy(scene->background_top, scene->background, sizeof scene->background);
  return s;
}

static const skf_key fog_keys[] = {
    {"distance", "L", "over which 1 / e of the light is left", SKF_KEY_NUMBER, true,
     .offset = offsetof(skf_fog, distance), .range = &skf_positive},
    {"color", "1", "linear light (default: 0.5)", SKF_KEY_COLOR, .offset = offsetof(skf_fog, color)},
};
const skf_section skf_section_fog = {"fog", "between the eye and everything, the background, too", fog_keys, 2};

skf_status skf_read_fog(skf_reader *r, const skf_node *map, void *into) {
  skf_fog *fog = &((skf_scene *)into)->fog;
  fog->color[0] = fog->color[1] = fog->color[2] = 0.5;
  return skf_read_map(r, map, &skf_section_fog, fog, NULL);
}
