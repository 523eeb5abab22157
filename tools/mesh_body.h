/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Meshing a body, for the commands that need it. */
#ifndef SKF_TOOLS_MESH_BODY_H
#define SKF_TOOLS_MESH_BODY_H

#include "cli.h"

/* Meshes one body, with a progress bar; on failure the message is out and a status of the program is returned. */
int mesh_body(const skf_body *body, double edge, skf_mesh *mesh, skf_mesh_report *report);

/* Says what the mesher had to leave undone. */
void mesh_warn(const skf_body *body, const skf_mesh_report *report);

#endif
