/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scenes whose bodies move: skelfield simulate without particles. */
#ifndef SKELFIELD_TOOLS_RUN_BODIES_H
#define SKELFIELD_TOOLS_RUN_BODIES_H

#include "cli.h"

/* Whether a body of the scene has `motion`. */
bool bodies_move(const skf_scene *scene);
int run_bodies(const cli *c, const skf_scene *scene);

#endif
