/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scenes whose particles fly: skelfield simulate where no body moves. */
#ifndef SKF_TOOLS_RUN_PARTICLES_H
#define SKF_TOOLS_RUN_PARTICLES_H

#include "team.h"

/* All processes of the crew call it; the first one has the outputs. */
int run_particles(const cli *c, const skf_scene *scene, team *crew);

#endif
