/* SPDX-License-Identifier: GPL-3.0-or-later */
/* skelfield mesh: a closed triangle mesh of the isosurface. */
#include "mesh_body.h"
#include <math.h>
#include <string.h>

/* Standard output, devices and pipes get the first format, PLY. */
static const skf_mesh_format *format_of(const char *path) {
  const skf_mesh_format *f = path ? skf_mesh_format_find(path) : NULL;
  if (!f && cli_streams(path)) f = skf_mesh_format_get(0);
  if (!f) cli_fail(CLI_BAD, "%s: the ending names no mesh format, expected .ply, .obj, .off or .stl", path);
  return f;
}

static void say(const skf_body *body, const skf_mesh *mesh, const skf_mesh_report *r) {
  skf_mesh_measure q;
  if (skf_mesh_measure_of(mesh, &q)) return;
  double size =
      sqrt(pow(q.box.hi.x - q.box.lo.x, 2) + pow(q.box.hi.y - q.box.lo.y, 2) + pow(q.box.hi.z - q.box.lo.z, 2));
  cli_say("%s: %zu triangles, %zu vertices, edge %.4g; %zu component%s, genus %ld", body->name, mesh->triangle_count,
          mesh->vertex_count, r->edge, q.components, q.components == 1 ? "" : "s", q.genus);
  cli_say("  area %.7g, volume %.7g; vertices off the surface by at most %.2g (%.1g of the size)", q.area, q.volume,
          r->residual, r->residual / size);
  cli_say("  edges %.3g to %.3g, smallest angle %.1f degrees (mean %.1f)", q.edge_min, q.edge_max,
          q.angle_min * 180 / 3.14159265358979, q.angle_mean * 180 / 3.14159265358979);
  mesh_warn(body, r);
}

static int add_body(const skf_scene *scene, size_t i, double edge, bool alone, skf_mesh *all) {
  skf_mesh mesh;
  skf_mesh_report report;
  const skf_body *body = scene->bodies + i;
  skf_status s = mesh_body(body, edge, &mesh, &report);
  if (s == SKF_ERR_CANCELLED) return cli_fail(CLI_FAILED, "interrupted, nothing written");
  char why[160];
  if (s && mesh_why(body, s, edge, &report, why)) return cli_fail(CLI_FAILED, "body '%s': %s", body->name, why);
  if (s) return cli_fail_status(s, body->name);
  say(body, &mesh, &report);
  if (alone) return *all = mesh, CLI_DONE;
  s = skf_mesh_append(all, &mesh, (unsigned)i);
  skf_mesh_free(&mesh);
  return s ? cli_fail_status(s, body->name) : CLI_DONE;
}

static int write_mesh(const skf_mesh *mesh, const skf_mesh_format *format, const char *path) {
  cli_out out;
  int status = cli_out_open(&out, path);
  if (status != CLI_DONE) return status;
  skf_status s = skf_mesh_write(mesh, format, out.file);
  if (s && s != SKF_ERR_IO) {
    cli_out_abort(&out);
    return cli_fail(CLI_FAILED, "%s: %s", path ? path : "stdout",
                    s == SKF_ERR_RANGE ? "coordinates too large for this format" : skf_status_text(s));
  }
  return cli_out_commit(&out);
}

static int run_with(const cli *c, const skf_scene *scene) {
  const char *path = cli_value(c, "output"), *name = cli_value(c, "body");
  const skf_mesh_format *format = format_of(path);
  double edge = 0;
  int only = name ? cli_body(scene, name) : -1, status = cli_number(c, "edge", 0, &edge);
  if (!format || (name && only < 0) || status != CLI_DONE) return CLI_BAD;
  skf_mesh all = {0};
  bool alone = scene->body_count == 1 || only >= 0;
  for (size_t i = 0; i < scene->body_count && status == CLI_DONE; i++)
    if (only < 0 || (size_t)only == i) status = add_body(scene, i, edge, alone, &all);
  if (status == CLI_DONE && !all.triangle_count) status = cli_fail(CLI_FAILED, "the scene has no body to mesh");
  if (status == CLI_DONE) status = write_mesh(&all, format, path);
  skf_mesh_free(&all);
  return status;
}

static int run(cli *c) {
  skf_scene *scene;
  int status = cli_scene(c, cli_operand(c, 0), &scene);
  if (status == CLI_DONE) status = run_with(c, scene);
  skf_scene_free(scene);
  return status;
}

static const cli_option options[] = {
    {'o', "output", "FILE",
     "the mesh: .ply, .obj (with normals), .off or .stl (single precision) (default: PLY on stdout)"},
    {'e', "edge", "H", "target length of the triangles' edges (default: from size and curvature)"},
    {'b', "body", "NAME", "this body alone (default: all bodies, one after the other)"},
};

static const char notes[] =
    "Each body is meshed in its own frame, which is the inertial frame at t = 0. The mesh is a closed\n"
    "2-manifold, oriented outwards and free of self-intersections; its vertices lie on F = iso to\n"
    "rounding. Parts that are far apart each have a default edge of their own. Outside is where F < iso:\n"
    "where iso is negative and the field fades to 0, it is the outside that the surface encloses, normals\n"
    "point into it, and the mesh's volume is negative. Files with several bodies carry the body's index:\n"
    "PLY as the faces' property body, OBJ as groups, STL as the attribute. The figures of the mesh go to\n"
    "stderr.\n"
    "example: skelfield mesh data/donut.yaml -o donut.ply --edge 5e5";

static const char *const writes[] = {"output", NULL};

const cli_command cmd_mesh = {
    .name = "mesh",
    .operands = "SCENE",
    .summary = "a closed triangle mesh of the isosurface",
    .operand_count = 1,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .notes = notes,
    .run = run,
    .writes = writes,
};
