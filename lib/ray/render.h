/* SPDX-License-Identifier: MIT */
/* Between the files of the renderer. */
#ifndef SKF_RAY_RENDER_H
#define SKF_RAY_RENDER_H

#include "skelfield/render.h"
#include "core/vec3.h"

/* The camera's frame: p = from + z (forward + x right + y up) is seen at (x, y) on the picture plane at distance 1. */
typedef struct skf_view {
  skf_vec3 from, forward, right, up;
  double tan_x, tan_y; /* of half the angles of view */
} skf_view;

skf_status skf_view_make(const skf_camera *camera, double aspect, skf_view *out);
/* Unit direction of the ray through (px, py) in pixels. */
skf_vec3 skf_view_ray(const skf_view *view, int width, int height, double px, double py);

enum { SKF_NOTHING = -1, SKF_GROUND = -2, SKF_RENDER_LIGHTS = 8 };

/* What a ray of the camera meets. */
typedef struct skf_sight {
  int body; /* or SKF_NOTHING, SKF_GROUND */
  double t;
  skf_vec3 at, normal; /* the normal faces the camera */
} skf_sight;

/* How much of the sky and of each light reaches a place, in [0, 1]. */
typedef struct skf_lit {
  float sky, light[SKF_RENDER_LIGHTS];
} skf_lit;

/* Direction to light k and whether it is at a finite distance, which then is in *distance (else INFINITY). */
skf_vec3 skf_light_direction(const skf_light *light, skf_vec3 at, double *distance);
/* The three lights that follow the camera. */
void skf_lights_default(const skf_view *view, skf_light out[3]);
void skf_background(const skf_render_scene *s, double share_up, double rgb[3]);
void skf_shade(const skf_render_scene *s, const skf_light *lights, size_t light_count, const skf_view *view,
               const skf_sight *sight, const skf_lit *lit, double share_up, double rgb[3]);

#endif
