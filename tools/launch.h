/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a scene to a world and its particles' starts. */
#ifndef SKF_TOOLS_LAUNCH_H
#define SKF_TOOLS_LAUNCH_H

#include "adapt/geo.h"
#include "cli.h"

/* The scene's bodies as particles see them. */
int launch_world(const skf_scene *scene, skf_world **out);

/* The coordinates of a body's ellipsoid; CLI_BAD without an ellipsoid, CLI_FAILED in a build without GeographicLib. */
int launch_geo(const skf_body *body, skf_geo **out);

/* Starts of all particles at t = 0; those given on an ellipsoid get the ground's velocity added to their own. CLI_BAD
   for a start in a singularity. The array is the caller's. */
int launch_starts(const skf_scene *scene, const char *scene_path, const skf_world *world, skf_state **out);

#endif
