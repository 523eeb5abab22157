/* SPDX-License-Identifier: GPL-3.0-or-later */
/* skelfield validate: the geometry report on a mesh, or on a scene's own isosurfaces and skeletons. */
#include "mesh_body.h"
#include "validate.h"
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Sections of the report, in order. */
typedef struct report {
  int count, capacity;
  section *sections;
} report;

static section *add_section(report *r) {
  if (r->count == r->capacity) {
    int more = 2 * r->capacity + 4;
    section *p = realloc(r->sections, (size_t)more * sizeof *p);
    if (!p) return NULL;
    r->sections = p, r->capacity = more;
  }
  return r->sections + r->count++;
}

static bool ends_with(const char *path, const char *ending) {
  size_t n = strlen(path), m = strlen(ending);
  return n >= m && !strcasecmp(path + n - m, ending);
}

/* By its ending, else by its first bytes. */
static bool is_mesh(const char *path) {
  char head[4097] = {0};
  if (ends_with(path, ".yaml") || ends_with(path, ".yml")) return false;
  if (skf_mesh_format_find(path)) return true;
  FILE *f = fopen(path, "rb");
  size_t n = f ? fread(head, 1, sizeof head - 1, f) : 0;
  if (f) fclose(f);
  for (int i = 0; skf_mesh_format_get(i); i++)
    if (n && skf_mesh_format_get(i)->recognise(head, n)) return true;
  return false;
}

static int mesh_file(const char *path, report *r) {
  skf_mesh mesh;
  skf_error error;
  section *s = add_section(r);
  if (!s) return cli_fail(CLI_FAILED, "out of memory");
  skf_status e = skf_mesh_read(path, &mesh, &error);
  if (e && error.line > 0) return cli_fail(CLI_BAD, "%s:%ld: %s", path, error.line, error.text);
  if (e) return cli_fail(e == SKF_ERR_NOMEM ? CLI_FAILED : CLI_BAD, "%s: %s", path, error.text);
  section_start(s, "mesh %s", path);
  e = validate_mesh(&mesh, false, s);
  skf_mesh_free(&mesh);
  return e ? cli_fail_status(e, path) : CLI_DONE;
}

/* The meshes of a body's solids. */
static int solids(const skf_body *b, report *r) {
  for (size_t i = 0; i < b->element_count; i++) {
    const skf_primitive *p = &b->elements[i].primitive;
    if (p->shape != SKF_SOLID) continue;
    const skf_solid_info *info = skf_solid_get(p->solid);
    /* borrowed: validate_mesh only looks */
    skf_mesh m = {.vertex_count = info->vertices,
                  .triangle_count = info->faces,
                  .vertices = (skf_vec3 *)(size_t)skf_solid_vertices(p->solid),
                  .triangles = (unsigned(*)[3])(size_t)skf_solid_faces(p->solid)};
    section *s = add_section(r);
    if (!s) return cli_fail(CLI_FAILED, "out of memory");
    section_start(s, "solid of %s, line %ld", b->name, b->element_lines[i]);
    skf_status e = validate_mesh(&m, false, s);
    if (e) return cli_fail_status(e, b->name);
  }
  return CLI_DONE;
}

/* A surface without a mesh fails its check; the report goes on. */
static int surface(const skf_body *b, double edge, section *s) {
  skf_mesh mesh;
  skf_mesh_report made;
  skf_status e = mesh_body(b, edge, &mesh, &made);
  if (e == SKF_ERR_CANCELLED) return cli_fail(CLI_FAILED, "interrupted");
  if (e) {
    char why[160];
    section_start(s, "surface of %s, F = %.9g", b->name, b->iso);
    mesh_why(b, e, edge, &made, why);
    section_check(s, "meshed", false, "%s", why);
    return e == SKF_ERR_NOMEM ? cli_fail_status(e, b->name) : CLI_DONE;
  }
  section_start(s, "surface of %s, F = %.9g, edge %.4g", b->name, b->iso, made.edge);
  e = validate_mesh(&mesh, made.around, s);
  if (!e) e = validate_against_field(b, &mesh, &made, s);
  if (e && e != SKF_ERR_NOMEM) section_check(s, "compared", false, "%s", skf_status_text(e));
  skf_mesh_free(&mesh);
  return e == SKF_ERR_NOMEM ? cli_fail_status(e, b->name) : CLI_DONE;
}

static int one_body(const skf_body *b, double edge, report *r) {
  section *s = add_section(r);
  if (!s) return cli_fail(CLI_FAILED, "out of memory");
  section_start(s, "skeleton of %s", b->name);
  skf_status e = validate_skeleton(b, s);
  if (e) return cli_fail_status(e, b->name);
  int status = solids(b, r);
  if (status != CLI_DONE) return status;
  s = add_section(r);
  if (!s) return cli_fail(CLI_FAILED, "out of memory");
  return surface(b, edge, s);
}

static int scene_file(const cli *c, const char *path, report *r) {
  skf_scene *scene;
  const char *name = cli_value(c, "body");
  double edge = 0;
  int status = cli_number(c, "edge", 0, &edge);
  if (status == CLI_DONE) status = cli_scene(c, path, &scene);
  if (status != CLI_DONE) return status;
  int only = name ? cli_body(scene, name) : -1;
  if (name && only < 0) status = CLI_BAD;
  for (size_t i = 0; i < scene->body_count && status == CLI_DONE; i++)
    if (only < 0 || (size_t)only == i) status = one_body(scene->bodies + i, edge, r);
  skf_scene_free(scene);
  return status;
}

static int print(const cli *c, const char *path, const report *r) {
  bool ok = true;
  for (int i = 0; i < r->count; i++) ok = ok && section_ok(r->sections + i);
  if (cli_given(c, "json")) {
    cli_json j = {stdout, 0, false};
    json_open(&j, NULL, '{');
    json_string(&j, "file", path);
    json_bool(&j, "ok", ok);
    json_open(&j, "sections", '[');
    for (int i = 0; i < r->count; i++) section_json(r->sections + i, &j);
    json_close(&j, ']');
    json_close(&j, '}');
  } else {
    for (int i = 0; i < r->count; i++) section_print(r->sections + i, stdout);
    printf("%s\n", ok ? "all checks hold" : "some checks FAIL");
  }
  return ok ? CLI_DONE : CLI_FAILED;
}

static int run(cli *c) {
  const char *path = cli_operand(c, 0);
  report r = {0};
  int status = is_mesh(path) ? mesh_file(path, &r) : scene_file(c, path, &r);
  if (status == CLI_DONE) status = print(c, path, &r);
  free(r.sections);
  return status;
}

static const cli_option options[] = {
    {'j', "json", NULL, "one JSON object instead of text"},
    {'e', "edge", "H", "scenes: target length of the mesh's edges (default: from size and curvature)"},
    {'b', "body", "NAME", "scenes: this body alone"},
};

static const char notes[] =
    "A mesh (PLY, OBJ, OFF, STL) is checked for being closed, manifold, oriented outwards and free of\n"
    "self-intersections, duplicate and degenerate faces; CGAL does the geometry with exact predicates.\n"
    "Of a scene, each body's skeleton is checked for degenerate, duplicate and overlapping primitives,\n"
    "the meshes of its solids as above,\n"
    "and its surface is meshed, checked likewise, and compared with its field: distance of the vertices,\n"
    "and of the faces' insides (up to one in 200 that bridges what is narrower than itself is only noted),\n"
    "rays through CGAL's AABB tree against the ray solver, volume against a quadrature. A surface that has\n"
    "no closed mesh fails its check. Of a body around its surface (see mesh) what is checked is the\n"
    "outside, which the surface encloses.\n"
    "Exit status 1 when a check fails.\n"
    "example: skelfield validate data/donut.yaml";

const cli_command cmd_validate = {
    .name = "validate",
    .operands = "MESH_or_SCENE",
    .summary = "checks of a mesh, or of a scene's surfaces and skeletons",
    .operand_count = 1,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .notes = notes,
    .run = run,
};
