/* SPDX-License-Identifier: MIT */
/* Shaded pictures of surfaces, as linear light in the caller's buffers. */
#ifndef SKELFIELD_RENDER_H
#define SKELFIELD_RENDER_H

#include "skelfield/ray.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct skf_camera {
  bool given;
  skf_vec3 from, to, up;
  double fov; /* vertical, radians, in (0, pi) */
} skf_camera;

typedef struct skf_light {
  bool directional;
  skf_vec3 at;     /* position, or direction towards the light */
  double color[3]; /* linear RGB times intensity: what a white matt surface sends back that faces the light */
} skf_light;

/* A body to be seen. Borrows the tracer. */
typedef struct skf_render_body {
  const skf_tracer *tracer;
  double color[3]; /* share of the light that is sent back, linear RGB in [0, 1] */
} skf_render_body;

typedef struct skf_render_scene {
  const skf_render_body *bodies;
  size_t body_count;
  const skf_light *lights;
  size_t light_count;      /* up to 8; 0: a key light from the upper left of the camera, a fill light, a rim light */
  double background[2][3]; /* at the bottom and at the top of the picture, linear RGB */
  bool ground;             /* a floor that shows nothing but shadows */
  skf_vec3 ground_at, ground_normal;
  skf_camera camera;
  int width, height;
  int samples; /* rays for a pixel where surfaces end or light changes quickly; smooth places need one */
} skf_render_scene;

/* rgb: width * height * 3 linear values, rows from the top. depth: NULL, or width * height distances [L] from the
   camera to the surface that is seen at the pixel's centre, INFINITY where there is none. Runs on OpenMP's current
   number of threads; the result does not depend on it. SKF_ERR_CANCELLED when progress asks to stop: then the buffers
   hold what is known by then, without the shadows that are not. SKF_ERR_ARG for a camera that looks nowhere, a size or
   a count out of range. */
SKF_API skf_status skf_render(const skf_render_scene *scene, float *rgb, float *depth, skf_progress progress);

/* From linear light to 8-bit sRGB: values above 0.7 are pressed together below 1; half a step of fixed noise keeps
   gradients from showing steps. n pixels in rows of `width`. */
SKF_API void skf_render_srgb(const float *rgb, int width, size_t n, unsigned char *out);

/* A camera that shows all surfaces and `points` (n of them) with a small margin, looking from `azimuth` (from the x
   axis towards the y axis) and `elevation` (up to the z axis) [rad]. Surfaces without end count as far as their
   skeleton does. fov: vertical [rad]; aspect: width / height. */
SKF_API skf_status skf_camera_frame(const skf_field *const *fields, const double *isos, size_t count,
                                    const skf_vec3 *points, size_t n, double azimuth, double elevation, double fov,
                                    double aspect, skf_camera *out);

/* Where a point is seen: px[0], px[1] in pixels from the upper left corner, px[2] the distance from the camera [L];
   false behind the camera. */
SKF_API bool skf_camera_project(const skf_camera *camera, int width, int height, skf_vec3 p, double px[3]);

#ifdef __cplusplus
}
#endif
#endif
