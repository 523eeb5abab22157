/* SPDX-License-Identifier: GPL-3.0-or-later */
/* skelfield render: a shaded picture of all bodies. */
#include "render_paths.h"
#include "core/vec3.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct render_job {
  const cli *c;
  skf_scene *scene;
  const skf_plot *plot;
  const skf_picture_format *format;
  run_data run;
  skf_render_scene what;
  skf_render_body *bodies;
  skf_tracer **tracers;
  float *rgb, *depth;
  bool cut; /* interrupted */
} render_job;

static int parse(render_job *j) {
  j->what.width = 1200, j->what.height = 900;
  int status = picture_format(j->c, &j->format);
  if (!status) status = picture_size(j->c, &j->what.width, &j->what.height);
  double n = 9;
  if (!status) status = cli_number(j->c, "spp", 0, &n);
  if (!status && (n != floor(n) || n > 4096))
    status = cli_fail(CLI_BAD, "--spp %s: expected a whole number from 1 to 4096", cli_value(j->c, "spp"));
  j->what.samples = (int)n;
  return status;
}

static int angle(const cli *c, const char *option, double lo, double hi, double *radians) {
  double degrees = *radians * (180 / SKF_PI);
  int status = cli_number(c, option, -INFINITY, &degrees);
  if (!status && (degrees < lo || degrees > hi))
    status = cli_fail(CLI_BAD, "--%s %s: expected degrees from %g to %g", option, cli_value(c, option), lo, hi);
  *radians = degrees * (SKF_PI / 180);
  return status;
}

/* A camera that frames the bodies and the paths. */
static int automatic_camera(render_job *j, double fov) {
  double azimuth = -60 * (SKF_PI / 180), elevation = 28 * (SKF_PI / 180);
  int status = angle(j->c, "azimuth", -360, 360, &azimuth);
  if (!status) status = angle(j->c, "elevation", -90, 90, &elevation);
  if (status) return status;
  size_t n = 0, bodies = j->scene->body_count;
  for (size_t i = 0; i < j->run.particle_count; i++) n += j->run.particles[i].count;
  skf_vec3 *points = malloc((n + 1) * sizeof *points);
  const skf_field **fields = malloc((bodies + 1) * sizeof *fields);
  double *isos = malloc((bodies + 1) * sizeof *isos);
  skf_status s = SKF_ERR_NOMEM;
  if (points && fields && isos) {
    n = 0;
    for (size_t i = 0; i < j->run.particle_count; i++)
      for (size_t k = 0; k < j->run.particles[i].count; k++) points[n++] = j->run.particles[i].states[k].x;
    for (size_t i = 0; i < bodies; i++) fields[i] = j->scene->bodies[i].field, isos[i] = j->scene->bodies[i].iso;
    s = skf_camera_frame(fields, isos, bodies, points, n, azimuth, elevation, fov,
                         (double)j->what.width / j->what.height, &j->what.camera);
  }
  free(points), free(fields), free(isos);
  return s ? cli_fail_status(s, "camera") : CLI_DONE;
}

static int vector(const cli *c, const char *option, skf_vec3 *out) {
  double v[3] = {out->x, out->y, out->z};
  int status = picture_numbers(c, option, 3, v);
  *out = v3(v[0], v[1], v[2]);
  return status;
}

/* The command line first, then the scene, then what frames everything. */
static int set_camera(render_job *j) {
  const cli *c = j->c;
  const skf_camera *given = &j->scene->camera;
  bool turned = cli_given(c, "azimuth") || cli_given(c, "elevation");
  double fov = given->given ? given->fov : 30 * (SKF_PI / 180);
  int status = angle(c, "fov", 0.01, 170, &fov);
  if (status) return status;
  if (given->given && !turned)
    j->what.camera = *given;
  else
    status = automatic_camera(j, fov);
  j->what.camera.fov = fov;
  if (!status) status = vector(c, "from", &j->what.camera.from);
  if (!status) status = vector(c, "to", &j->what.camera.to);
  if (!status) status = vector(c, "up", &j->what.camera.up);
  if (!status && !(v3_dist(j->what.camera.from, j->what.camera.to) > 0))
    status = cli_fail(CLI_BAD, "the camera looks nowhere: its two points, from and to, are one");
  return status;
}

/* The floor lies under the lowest point of the bodies' regions. */
static void set_ground(render_job *j) {
  if (!(j->what.ground = cli_given(j->c, "ground"))) return;
  double lowest = INFINITY;
  for (size_t i = 0; i < j->scene->body_count; i++) {
    const skf_body *b = j->scene->bodies + i;
    skf_box box;
    if (skf_field_region(b->field, b->iso, &box)) continue;
    /* The region is wide: the surface's own lowest point is where a ray from below meets it. */
    double low = box.hi.z;
    for (int k = 0; k < 48 * 48; k++) {
      int row = k / 48;
      skf_vec3 at = v3(box.lo.x + (k % 48 + 0.5) / 48 * (box.hi.x - box.lo.x),
                       box.lo.y + (row + 0.5) / 48 * (box.hi.y - box.lo.y), box.lo.z);
      skf_hit hit;
      bool found = false;
      if (!skf_tracer_first(j->tracers[i], &(skf_ray){at, {0, 0, 1}, 0, INFINITY}, &hit, &found, NULL) && found)
        low = fmin(low, hit.at.z);
    }
    lowest = fmin(lowest, low);
  }
  j->what.ground = isfinite(lowest);
  j->what.ground_at = v3(0, 0, lowest), j->what.ground_normal = v3(0, 0, 1);
}

static int set_bodies(render_job *j) {
  const skf_scene *s = j->scene;
  if (s->light_count > 8) return cli_fail(CLI_BAD, "the scene has %zu lights, expected at most 8", s->light_count);
  j->tracers = calloc(s->body_count + 1, sizeof *j->tracers);
  j->bodies = calloc(s->body_count + 1, sizeof *j->bodies);
  if (!j->tracers || !j->bodies) return cli_fail(CLI_FAILED, "out of memory");
  for (size_t i = 0; i < s->body_count; i++) {
    skf_status status = skf_tracer_new(s->bodies[i].field, s->bodies[i].iso, j->tracers + i);
    if (status) return cli_fail_status(status, s->bodies[i].name);
    j->bodies[i].tracer = j->tracers[i];
    memcpy(j->bodies[i].color, s->bodies[i].color, sizeof j->bodies[i].color);
  }
  j->what.bodies = j->bodies, j->what.body_count = s->body_count;
  j->what.lights = s->lights, j->what.light_count = s->light_count;
  static const double night[2][3] = {{0.055, 0.065, 0.085}, {0.012, 0.016, 0.028}};
  for (int k = 0; k < 2; k++)
    memcpy(j->what.background[k], s->has_background ? s->background : night[k], sizeof j->what.background[k]);
  return CLI_DONE;
}

static int trace(render_job *j) {
  size_t n = (size_t)j->what.width * j->what.height;
  j->rgb = malloc(3 * n * sizeof *j->rgb);
  j->depth = malloc(n * sizeof *j->depth);
  if (!j->rgb || !j->depth) return cli_fail(CLI_FAILED, "out of memory");
  skf_status s = skf_render(&j->what, j->rgb, j->depth, cli_progress("render"));
  cli_progress_end();
  j->cut = s == SKF_ERR_CANCELLED;
  return s && !j->cut ? cli_fail_status(s, "render") : CLI_DONE;
}

/* Light as it is, or as a picture with the paths. */
static skf_status encode(render_job *j, unsigned char **bytes, size_t *n, char error[256]) {
  int w = j->what.width, h = j->what.height;
  if (j->format->linear) return j->plot->encode_linear(w, h, j->rgb, j->format->ending, bytes, n, error);
  unsigned char *image = malloc(3 * (size_t)w * h);
  skf_canvas *canvas = j->plot->create(w, h, NULL, error);
  skf_status s = image && canvas ? SKF_OK : SKF_ERR_NOMEM;
  if (!s) {
    skf_render_srgb(j->rgb, w, (size_t)w * h, image);
    j->plot->image(canvas, 0, 0, w, h, image);
    path_view view = {j->plot,
                      canvas,
                      j->what.camera,
                      w,
                      h,
                      j->depth,
                      0.0028 * sqrt((double)w * h),
                      v3_dist(j->what.camera.from, j->what.camera.to)};
    if (!render_paths(&view, &j->run)) s = SKF_ERR_NOMEM;
  }
  if (s) snprintf(error, 256, "%s", skf_status_text(s));
  if (!s) s = j->plot->encode(canvas, j->format->ending, bytes, n, error);
  if (canvas) j->plot->destroy(canvas);
  free(image);
  return s;
}

static int write_picture(render_job *j) {
  unsigned char *bytes;
  size_t n;
  char error[256];
  const char *path = cli_value(j->c, "output");
  if (encode(j, &bytes, &n, error)) return cli_fail(CLI_FAILED, "%s: %s", path ? path : "stdout", error);
  int status = picture_write(j->c, j->plot, bytes, n);
  if (!status && j->cut) status = cli_fail(CLI_FAILED, "interrupted: the picture shows what was done");
  return status;
}

static int work(render_job *j) {
  int status = parse(j);
  if (!status) status = cli_scene(cli_operand(j->c, 0), &j->scene);
  if (!status) status = run_read(cli_value(j->c, "orbits"), cli_value(j->c, "contacts"), &j->run);
  if (!status) status = set_bodies(j);
  if (!status) status = set_camera(j);
  if (!status) status = picture_module(&j->plot);
  if (!status) set_ground(j);
  if (!status) status = trace(j);
  if (!status) status = write_picture(j);
  return status;
}

static int run(cli *c) {
  render_job j = {.c = c};
  int status = work(&j);
  for (size_t i = 0; j.tracers && i < j.scene->body_count; i++) skf_tracer_free(j.tracers[i]);
  free(j.tracers), free(j.bodies), free(j.rgb), free(j.depth);
  run_free(&j.run);
  skf_scene_free(j.scene);
  return status;
}

static const cli_option options[] = {
    {'o', "output", "IMAGE.png", "the picture; its ending tells the format (default: PNG on stdout)"},
    {0, "size", "WxH", "pixels (default: 1200x900)"},
    {0, "spp", "N", "rays for a pixel where surfaces end or light changes quickly (default: 9)"},
    {0, "azimuth", "DEGREES", "where the camera stands, from x towards y (default: -60)"},
    {0, "elevation", "DEGREES", "how high it stands (default: 28)"},
    {0, "fov", "DEGREES", "its vertical angle of view (default: the scene's, or 30)"},
    {0, "from", "X,Y,Z", "its place"},
    {0, "to", "X,Y,Z", "what it looks at"},
    {0, "up", "X,Y,Z", "what is up in the picture"},
    {0, "ground", NULL, "a floor below the bodies that catches their shadows"},
    {0, "orbits", "RUN.csv", "draw the paths that simulate wrote"},
    {0, "contacts", "C.csv", "mark the contacts that simulate --contacts wrote"},
};

const cli_command cmd_render = {
    .name = "render",
    .operands = "SCENE",
    .summary = "a shaded picture of the surfaces",
    .operand_count = 1,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .notes =
        "Camera, lights, background and colours are the scene's; what it does not give is chosen so that everything\n"
        "is in the picture. Formats: png, jpg, tif, webp, bmp, ppm; exr, pfm and hdr hold linear light, without "
        "paths.\n"
        "Ctrl-C ends with the picture as far as it is.\n"
        "Example: skelfield render donut.yaml -o donut.png --orbits run.csv --azimuth 30\n",
    .run = run,
};
