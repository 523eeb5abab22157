/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mesh_body.h"

bool mesh_why(const skf_body *b, skf_status s, double given, const skf_mesh_report *report, char why[160]) {
  double edge = report->edge > 0 ? report->edge : given;
  switch (s) {
  case SKF_ERR_UNBOUNDED:
    snprintf(why, 160, "the surface F = %g reaches to infinity and has no closed mesh", b->iso);
    break;
  case SKF_ERR_EMPTY:
    if (report->edge > 0) /* else it is known without a sample */
      snprintf(why, 160, "an edge of %g finds no surface F = %g, a smaller --edge may", edge, b->iso);
    else
      snprintf(why, 160, "there is no surface, F is %s iso = %g everywhere", b->iso < 0 ? "above" : "below", b->iso);
    break;
  case SKF_ERR_CAPACITY:
    snprintf(why, 160, "an edge of %g makes more triangles than the mesher takes, give a larger --edge", edge);
    break;
  default: snprintf(why, 160, "%s", skf_status_text(s)); return false;
  }
  return true;
}

skf_status mesh_body(const skf_body *body, double edge, skf_mesh *mesh, skf_mesh_report *report) {
  skf_mesh_options options = {.edge = edge, .progress = cli_progress("mesh")};
  skf_status s = skf_mesh_field(body->field, body->iso, &options, mesh, report);
  cli_progress_end();
  return s;
}

void mesh_warn(const skf_body *body, const skf_mesh_report *r) {
  if (r->missed)
    cli_say("skelfield: warning: body '%s' has parts that are thinner than the edge of %g resolves: %zu places of its "
            "skeleton are inside the surface but not inside the mesh; give a smaller --edge",
            body->name, r->edge, r->missed);
  if (r->clamped)
    cli_say("skelfield: warning: body '%s': %zu vertices lie beside the surface, where it touches itself", body->name,
            r->clamped);
}
