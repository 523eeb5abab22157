/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mesh_body.h"

static int failed(const skf_body *b, skf_status s, double edge) {
  switch (s) {
  case SKF_ERR_UNBOUNDED:
    return cli_fail(CLI_FAILED, "body '%s': the surface F = %g reaches to infinity and has no closed mesh", b->name,
                    b->iso);
  case SKF_ERR_EMPTY:
    if (edge > 0) /* else it is known without a sample */
      return cli_fail(CLI_FAILED, "body '%s': an edge of %g finds no surface F = %g, a smaller --edge may", b->name,
                      edge, b->iso);
    return cli_fail(CLI_FAILED, "body '%s': there is no surface, F is below iso = %g everywhere", b->name, b->iso);
  case SKF_ERR_CAPACITY:
    return cli_fail(CLI_FAILED,
                    "body '%s': an edge of %g makes more triangles than the mesher takes, give a larger --edge",
                    b->name, edge);
  case SKF_ERR_CANCELLED: return cli_fail(CLI_FAILED, "interrupted, nothing written");
  default: return cli_fail_status(s, b->name);
  }
}

int mesh_body(const skf_body *body, double edge, skf_mesh *mesh, skf_mesh_report *report) {
  skf_mesh_options options = {.edge = edge, .progress = cli_progress("mesh")};
  skf_status s = skf_mesh_field(body->field, body->iso, &options, mesh, report);
  cli_progress_end();
  return s ? failed(body, s, report->edge > 0 ? report->edge : edge) : CLI_DONE;
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
