/* SPDX-License-Identifier: MIT */
/* What bodies, materials and entries say of primitives: kernel, strength, Blinn's handles. */
#ifndef SKF_SCENE_STYLE_H
#define SKF_SCENE_STYLE_H

#include "scene/reader.h"
#include "skelfield/handles.h"

typedef struct skf_style {
  bool has_kernel, has_param; /* without its parameter a kernel needs handles */
  skf_kernel kernel;
  long kernel_line;
  double strength;              /* NAN: not given */
  skf_handles handles;          /* 0: not given */
  const skf_material *material; /* whose words count where these are silent; NULL: none */
} skf_style;

/* A named style, and how it looks. */
struct skf_material {
  char *name;
  skf_style style;
  unsigned given; /* which of its keys */
  skf_look look;
};

extern const skf_style skf_no_style;

/* Keys of the style `s` in a struct: the three handles, and the rest for the tables that have it. */
#define SKF_RADIUS_KEY(type, s)                                                                                        \
  {                                                                                                                    \
    "radius", "L", "of the primitive's surface in isolation, see below", SKF_KEY_NUMBER,                               \
        .offset = offsetof(type, s.handles.radius), .range = &skf_positive                                             \
  }
#define SKF_BLOBBINESS_KEY(type, s)                                                                                    \
  {                                                                                                                    \
    "blobbiness", "1", "< 0: d ln h / d ln r^2 at the radius; near 0 blends softly", SKF_KEY_NUMBER,                   \
        .offset = offsetof(type, s.handles.blobbiness), .range = &skf_negative                                         \
  }
#define SKF_INFLUENCE_KEY(type, s)                                                                                     \
  {                                                                                                                    \
    "influence", "L", "distance where the kernel ends, or is 1/100 of its peak", SKF_KEY_NUMBER,                       \
        .offset = offsetof(type, s.handles.influence), .range = &skf_positive                                          \
  }

skf_status skf_read_kernel(skf_reader *r, const skf_node *map, skf_style *out);
skf_status skf_read_material(skf_reader *r, const skf_node *name, skf_style *out);

/* Takes from a farther style, and its material, what is not given. */
void skf_style_inherit(skf_style *to, const skf_style *from);

/* Puts into a look what the material says of it; NULL says nothing. */
void skf_material_paint(const skf_material *material, skf_look *look);

extern const skf_section skf_section_material, skf_section_texture;
/* One texture, or a list of them. */
skf_status skf_read_textures(skf_reader *r, const skf_node *value, skf_look *look);
skf_status skf_read_materials(skf_reader *r, const skf_node *list, void *scene);
void skf_materials_free(skf_reader *r);

/* Sets parameter and strength of an entry's pieces; `name` and `line` are the entry's. */
skf_status skf_style_apply(skf_reader *r, const skf_style *style, double iso, const char *name, long line,
                           skf_element *elements, size_t n);

#endif
