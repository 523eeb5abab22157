/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "launch.h"
#include <math.h>
#include <stdlib.h>

int launch_world(const skf_scene *scene, skf_world **out) {
  *out = NULL;
  skf_attractor *bodies = calloc(scene->body_count + 1, sizeof *bodies);
  if (!bodies) return cli_fail(CLI_FAILED, "out of memory");
  for (size_t i = 0; i < scene->body_count; i++) {
    const skf_body *b = scene->bodies + i;
    bodies[i] = (skf_attractor){b->field, b->iso, scene->G * b->rho, b->spin};
  }
  skf_status s = skf_world_new_with(bodies, scene->body_count, scene->forces, scene->force_count, out);
  free(bodies);
  return s ? cli_fail_status(s, "bodies") : CLI_DONE;
}

int launch_geo(const skf_body *body, skf_geo **out) {
  *out = NULL;
  if (!body->ellipsoid.given)
    return cli_fail(CLI_BAD, "body '%s' has no ellipsoid, expected one for surface coordinates", body->name);
  skf_status s = skf_geo_new(&body->ellipsoid, out);
  if (s == SKF_ERR_UNSUPPORTED)
    return cli_fail(CLI_FAILED, "this build has no GeographicLib: surface coordinates are not available");
  return s ? cli_fail_status(s, "ellipsoid") : CLI_DONE;
}

/* The body's frame is the inertial frame at t = 0. */
static int launch(const skf_scene *scene, const skf_world *world, const skf_launch *l, skf_state *out) {
  skf_geo *geo;
  skf_horizon at;
  int status = launch_geo(scene->bodies + l->body, &geo);
  if (status != CLI_DONE) return status;
  skf_status s = skf_geo_point(geo, (skf_place){l->latitude, l->longitude, l->height}, &out->position, &at);
  skf_geo_free(geo);
  if (s) return cli_fail_status(s, "launch");
  double flat = l->speed * cos(l->elevation), east = flat * sin(l->azimuth), north = flat * cos(l->azimuth);
  double up = l->speed * sin(l->elevation);
  skf_vec3 ground = skf_world_surface_velocity(world, l->body, out->position);
  out->velocity = (skf_vec3){ground.x + east * at.east.x + north * at.north.x + up * at.up.x,
                             ground.y + east * at.east.y + north * at.north.y + up * at.up.y,
                             ground.z + east * at.east.z + north * at.north.z + up * at.up.z};
  return CLI_DONE;
}

/* A particle cannot start in a singularity. */
static int check_force(const skf_scene *scene, const char *scene_path, const skf_world *world, size_t i,
                       const skf_state *s) {
  skf_vec3 a;
  skf_world_at(world, 0, s->position, &a);
  if (isfinite(a.x) && isfinite(a.y) && isfinite(a.z)) return CLI_DONE;
  return cli_fail(CLI_BAD, "%s:%ld: particle '%s' starts where the force is not finite, expected another place",
                  scene_path, scene->particles[i].line, scene->particles[i].name);
}

int launch_starts(const skf_scene *scene, const char *scene_path, const skf_world *world, skf_state **out) {
  skf_state *starts = *out = calloc(scene->particle_count + 1, sizeof *starts);
  if (!starts) return cli_fail(CLI_FAILED, "out of memory");
  for (size_t i = 0; i < scene->particle_count; i++) {
    const skf_particle *p = scene->particles + i;
    starts[i] = (skf_state){0, p->position, p->velocity};
    int status = p->launch.given ? launch(scene, world, &p->launch, starts + i) : CLI_DONE;
    if (status == CLI_DONE) status = check_force(scene, scene_path, world, i, starts + i);
    if (status != CLI_DONE) return free(starts), *out = NULL, status;
  }
  return CLI_DONE;
}
