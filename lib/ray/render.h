/* SPDX-License-Identifier: MIT */
/* Between the files of the renderer. */
#ifndef SKF_RAY_RENDER_H
#define SKF_RAY_RENDER_H

#include "skelfield/render.h"
#include "core/vec3.h"

/* The camera's frame: p = from + z (forward + x right + y up) is seen at (x, y) on the picture plane at distance 1;
   with parallel rays at from + z forward + x right + y up. */
typedef struct skf_view skf_view;
typedef struct skf_beam skf_beam;
/* Rays through n pixels from px on, `row` being on the picture plane in the middle of their row. */
typedef void skf_view_row_fn(const skf_view *v, skf_vec3 row, int width, double px, int n, skf_beam *out);
struct skf_view {
  skf_vec3 from, forward, right, up;
  double tan_x, tan_y; /* of half the angles of view; half the width and height where rays are parallel */
  bool parallel;
  double aperture, focus;
  skf_view_row_fn *row;
};

/* A ray on its way. */
struct skf_beam {
  skf_vec3 from, direction;
  double time; /* of the shutter */
  int share;   /* which part of the directions to sky and lights, 0 to SKF_SHARES - 1; negative: all of them, few */
  double jitter[2]; /* in [0, 1), within this part */
  int depth;        /* bounces so far */
  bool mirrored;    /* and once in a mirror: then it sees the sky that lights bodies, too */
  bool scattered;   /* one of many through its pixel, which is their mean */
  double weight;    /* of its light in the pixel */
  double height;    /* in the picture, 0 to 1, of what a ray of the camera sees of the background; else < 0 */
};

skf_status skf_view_make(const skf_camera *camera, double aspect, skf_view *out);
/* Unit direction of the ray through (px, py) in pixels; and that and where it starts for n pixels of a row from px on.
 */
skf_vec3 skf_view_ray(const skf_view *view, int width, int height, double px, double py);
skf_view_row_fn skf_view_row_scalar, skf_view_row_avx2;
void skf_view_row(const skf_view *view, int width, int height, double px, double py, int n, skf_beam *out);
/* One through a place of the lens, (0, 0) its middle, 1 its rim. */
void skf_view_lens(const skf_view *view, double x, double y, skf_vec3 *from, skf_vec3 *direction);
/* How far up in the picture a direction is seen, 0 to 1; those backwards count as if mirrored. */
double skf_view_height(const skf_view *view, skf_vec3 direction);

/* The k-th random number of a pixel, as 32 bits and in [0, 1). */
static inline unsigned skf_hash(unsigned x, unsigned y, unsigned k) {
  unsigned h = x * 73856093u ^ y * 19349663u ^ k * 83492791u;
  h = (h ^ h >> 15) * 0x2c1b3c6du, h = (h ^ h >> 12) * 0x297a2d39u;
  return h ^ h >> 15;
}
static inline double skf_hashed(unsigned x, unsigned y, unsigned k) { return skf_hash(x, y, k) / 4294967296.0; }

enum { SKF_NOTHING = -1, SKF_GROUND = -2, SKF_RENDER_LIGHTS = 8, SKF_RENDER_BOUNCES = 6 };

/* What a ray meets. */
typedef struct skf_sight {
  int body;    /* or SKF_NOTHING, SKF_GROUND */
  bool inside; /* seen from inside of the body */
  double t;
  skf_vec3 at, normal; /* the normal faces the eye */
  skf_vec3 own;        /* the place in the body's own frame */
  double time;         /* of the shutter, 0 to 1 */
  size_t item;         /* of offsets */
} skf_sight;

/* How much of the sky and of each light reaches a place, in [0, 1]: the sky's share, then three for each light. */
enum { SKF_LIT = 1 + 3 * SKF_RENDER_LIGHTS };

enum { SKF_SHARES = 16, SKF_DIRECTIONS = 2 * SKF_SHARES };

/* A place of a surface, the light on it, and where it is seen from. */
typedef struct skf_shaded {
  const skf_look *look;
  const skf_sight *at;
  skf_vec3 normal, eye; /* unit vectors */
  const float *lit;
} skf_shaded;
enum { SKF_SHADED = 4 };

/* What these surfaces themselves send to the eye. */
struct skf_stage;
typedef void skf_shade_fn(const struct skf_stage *g, const skf_shaded s[SKF_SHADED], double (*rgb)[3]);
skf_shade_fn skf_shade_scalar, skf_shade_avx2;
skf_shade_fn *skf_shade_pick(void);

/* What all rays of a picture share. */
typedef struct skf_stage {
  const skf_render_scene *s;
  skf_view view;
  skf_light lights[SKF_RENDER_LIGHTS]; /* directions of length 1 */
  size_t light_count;
  bool hard[SKF_RENDER_LIGHTS];
  skf_vec3 directions[SKF_DIRECTIONS]; /* evenly over the sphere */
  skf_render_body *bodies;             /* the scene's, each with a look */
  skf_look *looks;                     /* of those that have none of their own */
  struct skf_palette **palettes;       /* of each body, or NULL */
  bool *clear;                         /* whether a body lets light through anywhere */
  skf_shade_fn *shade;
  int bounces;
} skf_stage;

/* ---- render_sight.c ---- */
/* In the body's own frame. */
skf_ray skf_body_ray(const skf_render_body *b, const skf_beam *beam, double t_max);
/* The first surface of one body beyond the ray's start, before best->t. */
bool skf_meet(const skf_render_body *b, const skf_beam *beam, skf_sight *best, int index, skf_ray_report *report);
skf_sight skf_look_along(const skf_stage *g, const skf_beam *beam, skf_ray_report *report);
/* The same for n <= SKF_MANY beams, bit for bit: quicker for neighbours. */
enum { SKF_MANY = 64 };
void skf_look_many(const skf_stage *g, size_t n, const skf_beam *beams, skf_sight *out);

/* ---- render_light.c ---- */
void skf_light_directions(skf_vec3 *out);
/* Rays to the sky (`sky` of them) and to each light (`soft` to those with an extent) fill lit. */
void skf_light_at(const skf_stage *g, const skf_sight *at, const skf_beam *beam, int sky, int soft, float *lit);
/* The same for n <= SKF_MANY places, bit for bit: quicker for neighbours with the same share. hard_only leaves all but
   the hard lights. */
void skf_light_many(const skf_stage *g, size_t n, const skf_sight *const *at, const skf_beam *beams, int sky, int soft,
                    bool hard_only, float *const *lit);

/* ---- render_trace.c ---- */
/* Light back along the beam from what it meets. */
void skf_radiance(const skf_stage *g, const skf_beam *beam, const skf_sight *at, const float *lit, double rgb[3]);
/* Along n <= SKF_MANY beams, bit for bit; the light on place k is at lit[k * stride]. */
void skf_radiance_many(const skf_stage *g, size_t n, const skf_beam *beams, const skf_sight *at, const float *lit,
                       size_t stride, double (*rgb)[3]);

/* ---- render_shade.c ---- */
bool skf_light_is_hard(const skf_light *light);
/* Direction to a light of the stage and how far it is, INFINITY for directional ones. */
static inline skf_vec3 skf_light_direction(const skf_light *light, skf_vec3 at, double *distance) {
  if (light->directional) return *distance = INFINITY, light->at;
  skf_vec3 way = v3_sub(light->at, at);
  *distance = v3_norm(way);
  bool plain = *distance > 1e-100 && *distance < 1e100;
  return plain ? v3_scale(1 / *distance, way) : v3_unit(way);
}
/* The same to one place of its extent; a, b in [0, 1). */
skf_vec3 skf_light_sample(const skf_light *light, skf_vec3 at, double a, double b, double *distance);
/* The three lights that follow the camera. */
void skf_lights_default(const skf_view *view, skf_light out[3]);
void skf_background(const skf_render_scene *s, double share_up, double rgb[3]);
void skf_sky(const skf_view *view, skf_vec3 direction, double rgb[3]);
extern const double skf_sky_above[3], skf_sky_below[3];
void skf_shade_ground(const skf_stage *g, const skf_sight *at, const float *lit, double rgb[3]);
/* Share of the light that a smooth surface reflects [Fresnel]: n is the index before it over the index behind it.
 *bent, the cosine behind it, is set where the share is below 1. */
double skf_fresnel(double cosine, double n, double *bent);

/* ---- render_look.c: mixed materials ---- */
typedef struct skf_palette skf_palette;
skf_status skf_palette_new(const skf_render_body *body, skf_palette **out);
void skf_palette_free(skf_palette *p);
/* The look at a place of a body that has one, with its textures, and the normal that they turn; it may need room. p may
   be NULL. */
const skf_look *skf_palette_at(const skf_palette *p, const skf_render_body *body, const skf_sight *at, skf_look *room,
                               skf_vec3 *normal);
/* The weights of its parts in the mixture at places of the body's, n <= SKF_MANY of the sights; false: too many parts.
 */
enum { SKF_PARTS = 8 };
bool skf_palette_weigh(const skf_palette *p, size_t n, const size_t *which, const skf_sight *sights,
                       double (*weights)[SKF_PARTS]);
/* skf_palette_at where the weights are known; NULL: they are not. */
const skf_look *skf_palette_look(const skf_palette *p, const skf_render_body *body, const skf_sight *at,
                                 const double *weights, skf_look *room, skf_vec3 *normal);
bool skf_look_is_clear(const skf_render_body *body);
/* A place and a direction from the inertial frame into the body's own at a time of the shutter, and a direction back.
 */
void skf_body_own(const skf_render_body *b, double time, skf_vec3 *place, skf_vec3 *direction);
skf_vec3 skf_body_world(const skf_render_body *b, double time, skf_vec3 direction);

/* ---- render_texture.c ---- */
/* Smooth noise of period about 1, in [-1, 1], 0 on the lattice of integers [Perlin 1985]; g: its gradient, or NULL. */
double skf_noise(skf_vec3 p, skf_vec3 *g);
/* Colour of a texture that gives one; uv for images. */
void skf_texture_color(const skf_texture *t, skf_vec3 p, const double uv[2], double rgb[3]);
/* Gradient of the relief's height [1]. */
skf_vec3 skf_texture_relief(const skf_texture *t, skf_vec3 p);
/* Places of a primitive's surface by its own coordinates: around a point or an axis, along it; in a triangle along two
   edges, all in [0, 1], and mirrored at ends and edges; in a plane along two directions of its own [L], of any sign. */
void skf_primitive_uv(const skf_primitive *p, skf_vec3 x, double uv[2]);
/* Keeps such a place half a pixel away from where the picture ends, so that its opposite edge is not mixed in. */
void skf_texture_inset(const skf_texture *t, skf_shape shape, double uv[2]);

#endif
