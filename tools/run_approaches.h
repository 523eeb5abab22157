/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of closest approaches, one row for each particle and body. */
#ifndef SKF_TOOLS_RUN_APPROACHES_H
#define SKF_TOOLS_RUN_APPROACHES_H

#include "cli.h"
#include "skelfield/motion.h"

typedef struct run_approaches {
  const char *path; /* NULL: nobody asks */
  const skf_scene *scene;
  const skf_world *world;
  skf_approach *of; /* as of skf_runner_approaches */
  cli_out out;
  bool open;
} run_approaches;

/* From --approach. CLI_DONE, or another status after the message, as all of these. */
int run_approaches_new(run_approaches *a, const cli *c, const skf_scene *scene, const skf_world *world);
int run_approaches_open(run_approaches *a);
/* Writes them, in the frame of a body unless it is SIZE_MAX; or leaves nothing of it. */
int run_approaches_close(run_approaches *a, size_t frame, bool keep);
void run_approaches_free(run_approaches *a);

#endif
