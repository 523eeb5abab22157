/* SPDX-License-Identifier: MIT */
/* Shaded pictures of surfaces, as linear light in the caller's buffers. */
#ifndef SKELFIELD_RENDER_H
#define SKELFIELD_RENDER_H

#include "skelfield/ray.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Looks from `from` at `to`; zeros behind fov stand for a pinhole in perspective. */
typedef struct skf_camera {
  bool given;
  skf_vec3 from, to, up;
  double fov;      /* vertical, radians, in (0, pi) */
  double height;   /* > 0: parallel rays, the picture shows so much from bottom to top [L], and fov does not count */
  double aperture; /* radius of a thin lens in `from` [L]; 0: everything is sharp */
  double focus;    /* what is so far along the view is sharp [L]; 0: what `to` is on */
} skf_camera;

/* A light throws hard shadows where it is a point, soft ones where it has an extent. */
typedef struct skf_light {
  bool directional;
  skf_vec3 at;     /* position, or direction towards the light */
  double color[3]; /* linear RGB times intensity: what a white matt surface sends back that faces the light */
  double radius;   /* of a ball [L]; of a directional light half the angle that it spans [rad], at most 1.5, where 0
                      stands for 2 degrees and what is negative for none */
  skf_vec3 u, v;   /* edges of a parallelogram around `at` instead of the ball [L]; zeros: none */
} skf_light;

/* What a texture changes, and how it runs in space; see skf_texture. */
typedef enum skf_texture_type {
  SKF_TEXTURE_CHECKER, /* cubes of edge `size` */
  SKF_TEXTURE_MARBLE,  /* sine waves across `axis` */
  SKF_TEXTURE_WOOD,    /* rings about `axis`, dark at their outer edges */
  SKF_TEXTURE_GRANITE, /* grains of all sizes from `size` down */
  SKF_TEXTURE_ONION,   /* shells about `at` */
  SKF_TEXTURE_RIPPLES, /* waves about `at` on the normal */
  SKF_TEXTURE_BUMPS,   /* rough all over, on the normal */
  SKF_TEXTURE_IMAGE,   /* a picture on every primitive by its own (u, v) */
  SKF_TEXTURE_COUNT
} skf_texture_type;

typedef struct skf_texture_info {
  const char *name, *doc;
  bool relief; /* turns the normal; the others give the colour */
} skf_texture_info;

SKF_API const skf_texture_info *skf_texture_get(skf_texture_type type);

/* Pixels for textures: linear RGB, rows from the top, width * height * 3. */
typedef struct skf_image {
  int width, height;
  float *rgb;
} skf_image;

/* In the frame of the body, so that it turns with it. */
typedef struct skf_texture {
  skf_texture_type type;
  skf_vec3 at, axis;   /* a place where it begins, a direction [L], [1]; axis 0 stands for z */
  double size;         /* period [L], > 0; of an image how often it is repeated is 1 / size each way [1] */
  double turbulence;   /* of marble, wood, onion: how far noise bends them, in periods [1] */
  double height;       /* of ripples and bumps: their slope [1] */
  double colors[2][3]; /* from and to, linear RGB */
  const skf_image *image;
} skf_texture;

enum { SKF_LOOK_TEXTURES = 4, SKF_LOOKS = 255 };

/* How a surface answers light. */
typedef struct skf_look {
  double color[3];        /* share of the light that the matt body sends back, linear RGB in [0, 1] */
  double ambient;         /* how much of the sky's light it takes [1] */
  double diffuse;         /* how much of the lamps' light it takes [1] */
  double specular[3];     /* share that its gloss reflects of the lamps, seen from the front [1]; 0: no gloss */
  double shine;           /* Phong's exponent of the gloss, > 0: GGX with alpha^2 = 2 / (shine + 2) */
  double reflection[3];   /* share that it mirrors [1] */
  double transparency[3]; /* share that it lets through, each time that light crosses the surface [1] */
  double ior;             /* refraction index inside against outside, > 0; other than 1: Fresnel's reflection, too */
  int texture_count;
  skf_texture textures[SKF_LOOK_TEXTURES]; /* colours multiply from the second one on */
} skf_look;

/* Matt under a satin gloss: colour 0.8, ambient and diffuse 1, specular 0.04, shine 10.5, ior 1. */
SKF_API skf_look skf_look_default(void);

/* Hard surfaces at fixed distances around primitives: spheres, capsules, pieces of tori with round ends, triangles with
   round edges, slabs, and the union of them all. Immutable, safe to share between threads. */
typedef struct skf_offsets skf_offsets;
typedef struct skf_offset {
  skf_primitive primitive;
  double radius; /* [L]; > 0 for points, segments and arcs, else >= 0; a solid's faces are flat where it is 0 */
} skf_offset;

SKF_API skf_status skf_offsets_new(const skf_offset *items, size_t n, skf_offsets **out);
SKF_API void skf_offsets_free(skf_offsets *offsets);
/* The first place along the ray where it meets the union, to rounding of the coordinates; *item, if given, is whose.
   Normals point away from the primitives. A start on the surface, to 1e-9 of the item's size, is no hit. */
SKF_API bool skf_offsets_first(const skf_offsets *offsets, const skf_ray *ray, skf_hit *hit, size_t *item);

/* A body to be seen. Borrows all it points to. */
typedef struct skf_render_body {
  const skf_tracer *tracer;
  double color[3]; /* of the default look, where there are no looks */
  /* NULL, or looks; where there are several, they are mixed by the shares that the elements have in the field, those of
     positive share alone. look_of: for each element its look. Elements: NULL where one look is all. */
  const skf_look *looks;
  size_t look_count;
  const skf_element *elements;
  size_t element_count;
  const unsigned char *look_of;
  const skf_offsets *offsets; /* instead of the tracer: the item is the element */
  /* Turned about an axis by `angle` when the shutter opens and by `sweep` more until it closes [rad]. */
  skf_vec3 axis, about;
  double angle, sweep;
  skf_vec3 shift; /* and then moved [L] */
} skf_render_body;

typedef enum skf_render_quality {
  SKF_RENDER_NORMAL,
  SKF_RENDER_DRAFT, /* the light of sky and lamps alone, without shadows, mirrors and glass */
  SKF_RENDER_FINE   /* four times the rays for the sky and for soft shadows */
} skf_render_quality;

typedef struct skf_fog {
  double distance; /* over which it takes away all but 1 / e of the light [L]; 0: no fog */
  double color[3];
} skf_fog;

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
  int samples; /* rays for a pixel where surfaces end or light changes quickly; smooth places need one. With a lens or a
                  shutter: rays for a pixel at most, fewer where they agree */
  skf_render_quality quality;
  int bounces; /* 0 stands for 6: how often light is mirrored and refracted on the way to the eye; rays that would have
                  to go on see the background. Negative: never */
  skf_fog fog;
} skf_render_scene;

/* rgb: width * height * 3 linear values, rows from the top. depth: NULL, or width * height distances [L] from the
   camera to the surface that is seen at the pixel's centre, INFINITY where there is none. Runs on OpenMP's current
   number of threads; the result does not depend on it. SKF_ERR_CANCELLED when progress asks to stop: then the buffers
   hold what is known by then, without the shadows that are not. SKF_ERR_ARG for a camera that looks nowhere, a size or
   a count out of range. */
SKF_API skf_status skf_render(const skf_render_scene *scene, float *rgb, float *depth, skf_progress progress);

/* What the ray through each pixel's centre costs [1]: evaluations of the field and cells of the ray, width * height
   each, either may be NULL. */
SKF_API skf_status skf_render_cost(const skf_render_scene *scene, float *evaluations, float *cells,
                                   skf_progress progress);

/* From linear light to 8-bit sRGB: values above 0.7 are pressed together below 1; half a step of fixed noise keeps
   gradients from showing steps. n pixels in rows of `width`. */
SKF_API void skf_render_srgb(const float *rgb, int width, size_t n, unsigned char *out);
/* The same in 16 bits, without the noise. */
SKF_API void skf_render_srgb16(const float *rgb, size_t n, unsigned short *out);

/* A camera that shows all surfaces and `points` (n of them) with a small margin, looking from `azimuth` (from the x
   axis towards the y axis) and `elevation` (up to the z axis) [rad]. Surfaces without end count as far as their
   skeleton does. fov: vertical [rad]; aspect: width / height. */
SKF_API skf_status skf_camera_frame(const skf_field *const *fields, const double *isos, size_t count,
                                    const skf_vec3 *points, size_t n, double azimuth, double elevation, double fov,
                                    double aspect, skf_camera *out);
/* The same camera for the surfaces of `count` tracers. What they find out about these serves the picture, too: of slow
   fields that saves up to two fifths of the work. */
SKF_API skf_status skf_camera_frame_with(const skf_tracer *const *tracers, size_t count, const skf_vec3 *points,
                                         size_t n, double azimuth, double elevation, double fov, double aspect,
                                         skf_camera *out);

/* Where a point is seen: px[0], px[1] in pixels from the upper left corner, px[2] the distance from the camera [L];
   false behind the camera. */
SKF_API bool skf_camera_project(const skf_camera *camera, int width, int height, skf_vec3 p, double px[3]);

#ifdef __cplusplus
}
#endif
#endif
