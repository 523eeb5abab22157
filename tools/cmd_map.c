/* SPDX-License-Identifier: GPL-3.0-or-later */
/* skelfield map: a picture of the field in a plane. */
#include "map_draw.h"
#include "core/vec3.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static int parse_kind(map_job *j) {
  const char *name = cli_value(j->c, "quantity");
  if (!name) return j->kind = MAP_F, CLI_DONE;
  for (int k = 0; k < MAP_KIND_COUNT; k++)
    if (!strcmp(name, map_quantities[k].name)) return j->kind = (map_kind)k, CLI_DONE;
  return cli_fail(CLI_BAD, "--quantity %s: expected F, potential or acceleration", name);
}

static int parse_ranges(map_job *j) {
  for (int k = 0; k < 4; k++) j->extent[k] = NAN;
  j->range[0] = j->range[1] = NAN;
  int status = picture_numbers(j->c, "extent", 4, j->extent);
  if (status || (status = picture_numbers(j->c, "range", 2, j->range))) return status;
  if (j->extent[0] >= j->extent[1] || j->extent[2] >= j->extent[3])
    return cli_fail(CLI_BAD, "--extent %s: expected X0,X1,Y0,Y1 with X0 < X1 and Y0 < Y1", cli_value(j->c, "extent"));
  if (j->range[0] >= j->range[1] || (j->log && j->range[0] <= 0))
    return cli_fail(CLI_BAD, "--range %s: expected LO,HI with %sLO < HI", cli_value(j->c, "range"),
                    j->log ? "0 < " : "");
  return CLI_DONE;
}

static int parse(map_job *j) {
  const cli *c = j->c;
  const char *plane = cli_value(c, "plane");
  j->width = 1600, j->height = 1200, j->levels = 14, j->every = 1, j->log = cli_given(c, "log");
  if (!map_plane_parse(plane ? plane : "z=0", &j->plane))
    return cli_fail(CLI_BAD, "--plane %s: expected x=, y= or z= and a finite number", plane);
  int status = parse_kind(j);
  if (!status) status = parse_ranges(j);
  if (!status) status = picture_size(c, &j->width, &j->height);
  if (!status) status = cli_whole(c, "levels", 0, 60, &j->levels);
  if (!status) status = cli_whole(c, "every", 1, 64, &j->every);
  if (status || (cli_given(c, "csv") && !cli_given(c, "output"))) return status;
  status = picture_format(c, &j->format);
  if (!status && j->format->linear)
    status = cli_fail(CLI_BAD, "%s: this format holds light, a map needs one for pictures such as .png",
                      cli_value(c, "output"));
  return status;
}

/* The module, its colour map, the canvas. */
static int open_canvas(map_job *j) {
  int status = picture_module(&j->plot);
  if (status) return status;
  const char *name = cli_value(j->c, "colormap");
  if (!j->plot->colormap(name ? name : "viridis", j->scale.rgb)) {
    char list[256] = "";
    for (const char *const *n = j->plot->colormaps; *n; n++)
      snprintf(list + strlen(list), sizeof list - strlen(list), "%s%s", n == j->plot->colormaps ? "" : ", ", *n);
    return cli_fail(CLI_BAD, "--colormap %s: expected one of %s", name, list);
  }
  char error[256];
  j->chart.plot = j->plot, j->chart.width = j->width, j->chart.height = j->height;
  j->chart.canvas = j->plot->create(j->width, j->height, cli_value(j->c, "font"), error);
  return j->chart.canvas ? CLI_DONE : cli_fail(cli_given(j->c, "font") ? CLI_BAD : CLI_FAILED, "%s", error);
}

/* Bodies with room around them, and the paths. */
static void automatic_extent(map_job *j) {
  double x[2] = {1, -1}, y[2] = {1, -1};
  map_frame(j->scene, j->plane, x, y);
  if (!(x[0] <= x[1])) x[0] = y[0] = -1, x[1] = y[1] = 1;
  double margin = 0.4 * fmax(x[1] - x[0], y[1] - y[0]);
  x[0] -= margin, x[1] += margin, y[0] -= margin, y[1] += margin;
  for (size_t i = 0; i < j->run.particle_count; i++)
    for (size_t k = 0; k < j->run.particles[i].count; k++) {
      skf_vec3 p = j->run.particles[i].states[k].x;
      double u = v3_get(p, j->plane.u), v = v3_get(p, j->plane.v);
      x[0] = fmin(x[0], u), x[1] = fmax(x[1], u), y[0] = fmin(y[0], v), y[1] = fmax(y[1], v);
    }
  margin = j->run.particle_count ? 0.04 * fmax(x[1] - x[0], y[1] - y[0]) : 0;
  j->extent[0] = x[0] - margin, j->extent[1] = x[1] + margin, j->extent[2] = y[0] - margin,
  j->extent[3] = y[1] + margin;
}

static int lay_out(map_job *j) {
  bool automatic = !cli_given(j->c, "extent");
  if (automatic) automatic_extent(j);
  chart *h = &j->chart;
  h->x0 = j->extent[0], h->x1 = j->extent[1], h->y0 = j->extent[2], h->y1 = j->extent[3];
  double w = j->width, t = j->height;
  if (h->canvas) {
    chart_layout(h, automatic);
    w = h->right - h->left, t = h->bottom - h->top;
    if (w < 16 || t < 16) return cli_fail(CLI_BAD, "--size: too little room for a map of this extent");
  }
  map_grid *g = &j->grid;
  *g = (map_grid){.plane = j->plane, .x0 = h->x0, .x1 = h->x1, .y0 = h->y0, .y1 = h->y1};
  g->nx = (int)ceil(w / j->every), g->ny = (int)ceil(t / j->every);
  return CLI_DONE;
}

static int sample(map_job *j) {
  size_t n = (size_t)j->grid.nx * j->grid.ny;
  j->outlines = calloc(j->scene->body_count + 1, sizeof *j->outlines);
  if (!j->outlines) return cli_fail(CLI_FAILED, "out of memory");
  skf_status s = map_sample(j->scene, j->kind, cli_given(j->c, "arrows"), &j->grid, j->outlines, cli_progress("map"));
  cli_progress_end();
  if (s == SKF_ERR_CANCELLED) return CLI_FAILED;
  if (s) return cli_fail_status(s, "map");
  map_range(j->grid.value, n, j->log, j->range[0], j->range[1], &j->scale);
  return CLI_DONE;
}

static int write_csv(map_job *j) {
  cli_out o;
  const map_grid *g = &j->grid;
  int status = cli_out_open(&o, cli_value(j->c, "csv"));
  if (status) return status;
  fprintf(o.file, "x,y,z,%s\n", map_quantities[j->kind].name);
  for (int k = 0; k < g->ny; k++)
    for (int i = 0; i < g->nx; i++) {
      skf_vec3 p = map_point(g, i, k);
      const double row[4] = {p.x, p.y, p.z, g->value[(size_t)k * g->nx + i]};
      for (int m = 0; m < 4; m++) cli_put(o.file, row[m]), fputc(m < 3 ? ',' : '\n', o.file);
    }
  return cli_out_commit(&o);
}

static int work(map_job *j) {
  bool ignored;
  int status = parse(j);
  if (!status) status = cli_scene(j->c, cli_operand(j->c, 0), &j->scene);
  if (!status) status = run_read(cli_value(j->c, "orbits"), cli_value(j->c, "contacts"), &j->run);
  if (!status && j->format) status = open_canvas(j);
  if (!status) status = lay_out(j);
  if (!status) status = cli_accuracy(j->c, j->scene, (size_t)j->grid.nx * (size_t)j->grid.ny, &ignored);
  if (!status) status = sample(j);
  if (!status && cli_given(j->c, "csv")) status = write_csv(j);
  if (!status && j->format) status = map_draw(j);
  return status;
}

static int run(cli *c) {
  map_job *j = calloc(1, sizeof *j);
  if (!j) return cli_fail(CLI_FAILED, "out of memory");
  j->c = c;
  int status = work(j);
  for (size_t i = 0; j->outlines && i < j->scene->body_count; i++) contour_free(j->outlines + i);
  free(j->outlines);
  map_grid_free(&j->grid);
  run_free(&j->run);
  if (j->chart.canvas) j->plot->destroy(j->chart.canvas);
  skf_scene_free(j->scene);
  free(j);
  return status;
}

static const cli_option options[] = {
    {'o', "output", "MAP.png", "the picture; its ending tells the format (default: PNG on stdout)"},
    {0, "plane", "z=0", "the plane: x, y or z = a number"},
    {0, "quantity", "NAME", "F (default), potential (-G rho F) or acceleration (|G rho grad F|), summed over bodies"},
    {0, "extent", "X0,X1,Y0,Y1", "what to show, across and up (default: the bodies, with room around them)"},
    {0, "size", "WxH", "pixels (default: 1600x1200)"},
    {0, "every", "N", "sample every N-th pixel each way (default: 1)"},
    {0, "levels", "N", "about how many iso-lines (default: 14)"},
    {0, "no-contours", NULL, "no iso-lines"},
    {0, "colormap", "NAME", "viridis (default), magma, inferno, plasma, cividis, grey"},
    {0, "range", "LO,HI", "values at the ends of the colour bar"},
    {0, "log", NULL, "logarithmic colours, of the absolute value"},
    {0, "arrows", NULL, "arrows along the force"},
    {0, "title", "TEXT", "title (default: the bodies)"},
    {0, "font", "FILE", "a TrueType font (default: DejaVu Sans)"},
    {0, "orbits", "RUN.csv", "draw the paths that simulate wrote"},
    {0, "contacts", "C.csv", "mark the contacts that simulate --contacts wrote"},
    CLI_ACCURACY,
    {0, "csv", "FILE", "also write the samples: x,y,z and the quantity; without -o only these"},
};

static const char *const writes[] = {"output", "csv", NULL};
static const char *const reads[] = {"font", "orbits", "contacts", NULL};

const cli_command cmd_map = {
    .name = "map",
    .operands = "SCENE",
    .summary = "draw the field in a plane: colours, iso-lines, the bodies' outlines",
    .operand_count = 1,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .notes =
        "Formats: png, jpg, tif, webp, bmp, ppm. A colour bar that ends in a point says that values go on beyond it.\n"
        "--accuracy A, from 1e-12 to 0.01, is for large skeletons, or exact: as in skelfield eval.\n"
        "Examples:\n"
        "  skelfield map donut.yaml -o donut.png --plane y=0 --quantity potential\n"
        "  skelfield map donut.yaml -o orbits.png --orbits run.csv --contacts contacts.csv\n",
    .run = run,
    .writes = writes,
    .reads = reads,
};
