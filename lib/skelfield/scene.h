/* SPDX-License-Identifier: MIT */
/* Scene files (YAML) and what they hold. */
#ifndef SKELFIELD_SCENE_H
#define SKELFIELD_SCENE_H

#include "skelfield/motion.h"
#include "skelfield/polygon.h"
#include "skelfield/render.h"
#include "skelfield/surface.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Ellipsoid of revolution for surface coordinates: polar > equatorial is prolate. Body frame. */
typedef struct skf_ellipsoid {
  bool given;
  double equatorial, polar;        /* semi-axes [L] */
  skf_vec3 center, axis, meridian; /* axis to the north pole, meridian to latitude 0, longitude 0 */
} skf_ellipsoid;

/* Elements first .. first + count - 1, the pieces of one entry, whose kernel parameter and strength handles gave. */
typedef struct skf_handled {
  size_t first, count;
  const char *kind; /* of the entry */
} skf_handled;

typedef struct skf_body {
  char *name; /* unique; no control characters, commas or double quotes */
  double iso;
  bool has_mass;
  double mass, density; /* mass [M] if has_mass; density as given or 1 */
  double rho;           /* density in force: mass / sum of w mu (0 when a plane makes that infinite), or density */
  skf_spin spin;
  bool moves; /* as a rigid body, from these velocities on: of its center of mass, and angular; at t = 0, inertial */
  skf_vec3 velocity, angular_velocity;
  skf_ellipsoid ellipsoid;
  double color[3]; /* linear RGB in [0, 1]; of looks[0], too */
  size_t look_count;
  skf_look *looks;        /* looks[0] is the body's own, the others are those of its entries */
  unsigned char *look_of; /* of each element: its look */
  size_t element_count;
  skf_element *elements;
  skf_field *field; /* of the elements, body frame */
  long line;        /* in the file */
  long *element_lines;
  size_t profile_count;
  skf_profile **profiles; /* what the elements' profiles point to, a block for each entry that has one */
  size_t handled_count;
  skf_handled *handled; /* in order */
} skf_body;

/* A start given on a body's ellipsoid; angles in radians. Azimuth clockwise from north, elevation up from the horizon.
 */
typedef struct skf_launch {
  bool given;
  size_t body;
  double latitude, longitude, height, azimuth, elevation, speed;
} skf_launch;

typedef struct skf_particle {
  char *name;
  bool sourced;                /* one of many from a file, a grid, ...; its name is one of scene->name_pools */
  skf_vec3 position, velocity; /* inertial; unset while launch.given, until somebody resolves it */
  double mass;                 /* 0: it attracts nothing */
  skf_launch launch;
  long line;
} skf_particle;

typedef struct skf_simulation {
  bool given;
  double t_end, output_every, tolerance, step; /* step: 0 where the integrator chooses */
  skf_contact_mode contact;
  double restitution, friction;
  double rolling;   /* friction of bodies that move, see skf_rigid_options */
  double softening; /* of the pull of particles with a mass */
  skf_search search;
  char integrator[32]; /* name in the integrators' registry; empty: default */
  bool turning;        /* rows and contacts in the frame of the body that spins, see skf_scene_turning_body */
} skf_simulation;

/* A picture that textures refer to. The scene knows its name alone; who reads it puts the pixels here, and frees them.
 */
typedef struct skf_scene_image {
  const char *path; /* one of scene->files */
  long line;
  skf_image pixels; /* rgb is NULL until then */
} skf_scene_image;

/* Particles first .. first + count - 1, which a source has drawn at random. */
typedef struct skf_drawn {
  size_t first, count;
  long long seed;
} skf_drawn;

typedef struct skf_scene {
  double G;
  size_t body_count, particle_count, light_count;
  skf_body *bodies;
  skf_particle *particles;
  size_t name_pool_count, drawn_count;
  char **name_pools;
  skf_drawn *drawn;
  skf_light *lights;
  size_t force_count;
  skf_force *forces; /* besides gravity */
  skf_simulation simulation;
  skf_camera camera;
  double shutter; /* how long it is open [T] */
  double background[3], background_top[3];
  bool has_background;
  skf_fog fog;
  size_t image_count;
  skf_scene_image **images;
  size_t file_count;
  char **files;          /* that it names: meshes and starts, which were read, and pictures */
  double animated_until; /* time of the last key of `animate` [T]; -INFINITY: nothing is animated */
} skf_scene;

/* What a scene may borrow of libraries that this one does not know. */
typedef struct skf_scene_hooks {
  skf_ring_cutter *cut_rings; /* cuts polygons; NULL: those without holes by skf_polygon_triangulate, others are refused
                               */
  double time;                /* at which the numbers of `animate` are taken */
} skf_scene_hooks;

/* Reads a scene file. On failure *out is NULL and *error, if given, tells what is wrong, where, and what was expected.
 */
SKF_API skf_status skf_scene_read(const char *path, skf_scene **out, skf_error *error);
/* The same from memory; file names in it are relative to `folder`. */
SKF_API skf_status skf_scene_parse(const char *text, size_t length, const char *folder, skf_scene **out,
                                   skf_error *error);
/* The same with hooks, which may be NULL. */
SKF_API skf_status skf_scene_read_with(const char *path, const skf_scene_hooks *hooks, skf_scene **out,
                                       skf_error *error);
SKF_API skf_status skf_scene_parse_with(const char *text, size_t length, const char *folder,
                                        const skf_scene_hooks *hooks, skf_scene **out, skf_error *error);
SKF_API void skf_scene_free(skf_scene *scene);

/* Index of the first body that spins, SIZE_MAX when none does; false when several spin differently: then there is no
   turning frame that one could mean. */
SKF_API bool skf_scene_turning_body(const skf_scene *scene, size_t *body);

#ifdef __cplusplus
}
#endif
#endif
