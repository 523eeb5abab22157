/* SPDX-License-Identifier: MIT */
/* Textures of materials. */
#include "scene/style.h"
#include "core/alloc.h"
#include "core/vec3.h"
#include <stdio.h>
#include <string.h>

/* A texture while it is read. */
typedef struct draft {
  skf_texture texture;
  int type;
  const skf_node *file;
} draft;

static skf_status read_type(skf_reader *r, const skf_node *node, void *into) {
  const char *names[SKF_TEXTURE_COUNT];
  for (int i = 0; i < SKF_TEXTURE_COUNT; i++) names[i] = skf_texture_get((skf_texture_type)i)->name;
  return skf_read_choice(r, node, "type", names, SKF_TEXTURE_COUNT, &((draft *)into)->type);
}

static skf_status read_colors(skf_reader *r, const skf_node *list, void *into) {
  static const char form[] = "two colors [[r, g, b], [r, g, b]]";
  skf_status s = skf_expect(r, list, SKF_NODE_LIST, "colors", form);
  if (s) return s;
  if (list->count != 2)
    return skf_error_set(r->error, SKF_ERR_PARSE, list->line, "colors has %d entries, expected %s", list->count, form);
  const skf_node *a = skf_node_first(&r->yaml, list);
  s = skf_read_color(r, a, "colors", ((draft *)into)->texture.colors[0]);
  return s ? s : skf_read_color(r, skf_node_next(&r->yaml, a), "colors", ((draft *)into)->texture.colors[1]);
}

static skf_status keep_file(skf_reader *r, const skf_node *node, void *into) {
  static const char form[] = "the name of a picture file";
  ((draft *)into)->file = node;
  skf_status s = skf_expect(r, node, SKF_NODE_SCALAR, "file", form);
  if (s || *skf_node_text(&r->yaml, node)) return s;
  return skf_error_set(r->error, SKF_ERR_PARSE, node->line, "file is empty, expected %s", form);
}

enum { TYPE, SIZE, AT, AXIS, COLORS, TURBULENCE, HEIGHT, FILE_NAME, TEXTURE_KEYS };

static const skf_key texture_keys[TEXTURE_KEYS] = {
    [TYPE] = {"type", NULL, "what it is", SKF_KEY_OTHER, true, .read = read_type, .form = "checker, marble, wood, ..."},
    [SIZE] = {"size", "L", "its period; of an image the part of (u, v) that it fills", SKF_KEY_NUMBER,
              .offset = offsetof(draft, texture.size), .range = &skf_positive},
    [AT] = {"at", "L", "where it begins, body frame (default: the origin)", SKF_KEY_VECTOR,
            .offset = offsetof(draft, texture.at)},
    [AXIS] = {"axis", "1", "across marble's waves, along the wood (default: z)", SKF_KEY_VECTOR,
              .offset = offsetof(draft, texture.axis)},
    [COLORS] = {"colors", "1", "from and to (default: white, black)", SKF_KEY_OTHER, .read = read_colors,
                .form = "[[r, g, b], [r, g, b]]"},
    [TURBULENCE] = {"turbulence", "1", "periods by which noise bends it (default: 0)", SKF_KEY_NUMBER,
                    .offset = offsetof(draft, texture.turbulence), .range = &skf_not_negative},
    [HEIGHT] = {"height", "1", "slope of ripples and bumps (default: 0.3)", SKF_KEY_NUMBER,
                .offset = offsetof(draft, texture.height), .range = &skf_not_negative},
    [FILE_NAME] = {"file", NULL, "of an image", SKF_KEY_OTHER, .read = keep_file, .form = "a file name"},
};
const skf_section skf_section_texture = {
    "texture",
    "checker (cubes), marble, wood (rings), granite, onion (shells), ripples and\n"
    "bumps (which turn the normal), image (on each primitive by its own (u, v), mixed by weights)",
    texture_keys, TEXTURE_KEYS};

/* The scene keeps the picture's name. */
static skf_status keep_image(skf_reader *r, const skf_node *file, skf_texture *t) {
  skf_scene *scene = r->scene;
  const char *path;
  skf_status s = skf_file_path(r, file, &path);
  if (s) return s;
  skf_scene_image **more = skf_realloc(scene->images, scene->image_count + 1, sizeof *more);
  if (more) scene->images = more;
  skf_scene_image *image = more ? skf_alloc(1, sizeof *image) : NULL;
  if (!image) return skf_error_set(r->error, SKF_ERR_NOMEM, 0, "out of memory");
  *image = (skf_scene_image){.path = path, .line = file->line};
  scene->images[scene->image_count++] = image;
  t->image = &image->pixels;
  return SKF_OK;
}

static skf_status misplaced(skf_reader *r, const skf_node *map, int key, const char *with) {
  return skf_error_set(r->error, SKF_ERR_PARSE, skf_map_line(r, map, texture_keys[key].name),
                       "%s in a texture of type %s, expected it with %s", texture_keys[key].name,
                       skf_node_text(&r->yaml, skf_map_find(r, map, "type")), with);
}

static skf_status read_texture(skf_reader *r, const skf_node *map, skf_texture *out) {
  draft d = {.texture = {.size = 1, .height = 0.3, .axis = {0, 0, 1}, .colors = {{1, 1, 1}, {0, 0, 0}}}};
  unsigned given;
  skf_status s = skf_read_map(r, map, &skf_section_texture, &d, &given);
  if (s) return s;
  const skf_texture_info *info = skf_texture_get(d.texture.type = (skf_texture_type)d.type);
  bool image = d.texture.type == SKF_TEXTURE_IMAGE;
  if (given >> COLORS & 1 && (info->relief || image)) return misplaced(r, map, COLORS, "one that has two colors");
  bool waves = d.type == SKF_TEXTURE_MARBLE || d.type == SKF_TEXTURE_WOOD;
  if (given >> AXIS & 1 && !waves) return misplaced(r, map, AXIS, "marble or wood");
  if (given >> TURBULENCE & 1 && !waves && d.type != SKF_TEXTURE_ONION)
    return misplaced(r, map, TURBULENCE, "marble, wood or onion");
  if (given >> AT & 1 && image) return misplaced(r, map, AT, "one that is not an image");
  if (!(v3_norm(v3_unit(d.texture.axis)) > 0))
    return skf_error_set(r->error, SKF_ERR_DEGENERATE, skf_map_line(r, map, "axis"),
                         "axis is the zero vector, expected a direction");
  if (given >> HEIGHT & 1 && !info->relief) return misplaced(r, map, HEIGHT, "ripples or bumps");
  if (given >> FILE_NAME & 1 && !image) return misplaced(r, map, FILE_NAME, "image");
  if (image && !d.file)
    return skf_error_set(r->error, SKF_ERR_PARSE, map->line, "missing 'file' in texture, expected a picture's name");
  if (image) s = keep_image(r, d.file, &d.texture);
  *out = d.texture;
  return s;
}

skf_status skf_read_textures(skf_reader *r, const skf_node *value, skf_look *look) {
  look->texture_count = 0;
  if (value->type != SKF_NODE_LIST) return look->texture_count = 1, read_texture(r, value, look->textures);
  if (!value->count)
    return skf_error_set(r->error, SKF_ERR_PARSE, value->line,
                         "texture is empty, expected a texture or a list of them");
  if (value->count > SKF_LOOK_TEXTURES)
    return skf_error_set(r->error, SKF_ERR_PARSE, value->line, "texture has %d entries, expected at most %d",
                         value->count, SKF_LOOK_TEXTURES);
  skf_status s = SKF_OK;
  for (const skf_node *n = skf_node_first(&r->yaml, value); n && !s; n = skf_node_next(&r->yaml, n))
    s = read_texture(r, n, look->textures + look->texture_count++);
  return s;
}
