/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Meshing a body, for the commands that need it. */
#ifndef SKF_TOOLS_MESH_BODY_H
#define SKF_TOOLS_MESH_BODY_H

#include "cli.h"

/* Meshes one body, with a progress bar. */
skf_status mesh_body(const skf_body *body, double edge, skf_mesh *mesh, skf_mesh_report *report);

/* Why mesh_body failed with status s, for an edge that was given (or 0); false where it is not the surface's fault. */
bool mesh_why(const skf_body *body, skf_status s, double edge, const skf_mesh_report *report, char why[160]);

/* Says what the mesher had to leave undone. */
void mesh_warn(const skf_body *body, const skf_mesh_report *report);

#endif
