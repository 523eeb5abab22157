/* SPDX-License-Identifier: GPL-3.0-or-later */
/* skelfield render: a shaded picture of all bodies. */
#include "render_job.h"
#include <math.h>
#include <string.h>

static int choice(const cli *c, const char *option, const char *const *words, int n, int *out) {
  const char *text = cli_value(c, option);
  char list[128] = "";
  for (int i = 0; text && i < n; i++) {
    if (!strcmp(text, words[i])) return *out = i, CLI_DONE;
    snprintf(list + strlen(list), sizeof list - strlen(list), "%s%s",
             i == 0      ? ""
             : i + 1 < n ? ", "
                         : " or ",
             words[i]);
  }
  return text ? cli_fail(CLI_BAD, "--%s %s: expected %s", option, text, list) : CLI_DONE;
}

static const char *const modes[] = {[RENDER_SURFACE] = "surface", [RENDER_OFFSET] = "offset", [RENDER_COST] = "cost"};
static const char *const qualities[] = {
    [SKF_RENDER_NORMAL] = "normal", [SKF_RENDER_DRAFT] = "draft", [SKF_RENDER_FINE] = "fine"};

static int check_format(const render_job *j) {
  const skf_picture_format *f = j->format;
  if (j->bits == 16 && !f->deep) return cli_fail(CLI_BAD, "--depth 16: .%s has none, expected png or tif", f->ending);
  if (j->bits == 16 && cli_given(j->c, "orbits")) return cli_fail(CLI_BAD, "--depth 16: expected no --orbits with it");
  if (j->bits == 16 && cli_given(j->c, "contacts"))
    return cli_fail(CLI_BAD, "--depth 16: expected no --contacts with it");
  if (f->linear && j->mode == RENDER_COST)
    return cli_fail(CLI_BAD, "--mode cost: .%s holds light, expected another format", f->ending);
  if (j->mode == RENDER_OFFSET && j->skeleton)
    return cli_fail(CLI_BAD, "--skeleton with --mode offset: expected one of them");
  return CLI_DONE;
}

static int parse(render_job *j) {
  const cli *c = j->c;
  int mode = RENDER_SURFACE, quality = SKF_RENDER_NORMAL;
  j->what.width = 1200, j->what.height = 900, j->bits = 8;
  int status = render_film_parse(j);
  if (!status && !j->video) status = picture_format(c, &j->format);
  if (!status) status = picture_size(c, &j->what.width, &j->what.height);
  if (!status) status = choice(c, "quality", qualities, 3, &quality);
  if (!status) status = choice(c, "mode", modes, 3, &mode);
  if (!status) status = cli_whole(c, "spp", 1, 4096, &j->what.samples);
  if (!status) status = cli_whole(c, "bounces", 0, 64, &j->what.bounces);
  if (!status) status = cli_whole(c, "depth", 8, 16, &j->bits);
  if (!status && j->bits != 8 && j->bits != 16) status = cli_fail(CLI_BAD, "--depth %d: expected 8 or 16", j->bits);
  if (!status) status = cli_number(c, "time", -INFINITY, &j->time);
  if (cli_given(c, "bounces") && j->what.bounces == 0) j->what.bounces = -1;
  j->what.quality = (skf_render_quality)quality, j->mode = (render_mode)mode, j->skeleton = cli_given(c, "skeleton");
  return status ? status : check_format(j);
}

/* Without --spp: what fits the scene. */
static void set_samples(render_job *j) {
  bool moves = false;
  for (size_t i = 0; i < j->what.body_count; i++) moves = moves || j->bodies[i].sweep != 0;
  if (cli_given(j->c, "spp")) return;
  int many = moves || j->what.camera.aperture > 0 ? 128 : 9;
  j->what.samples = j->what.quality == SKF_RENDER_DRAFT ? 1 : j->what.quality == SKF_RENDER_FINE ? 2 * many : many;
}

static int write_picture(render_job *j) {
  unsigned char *bytes;
  size_t n;
  int status = render_picture(j, &bytes, &n);
  if (status) return status;
  status = picture_write(j->c, bytes, n);
  render_give_back(j, bytes);
  if (!status && j->cut) status = cli_fail(CLI_FAILED, "interrupted: the picture shows what was done");
  return status;
}

static int work(render_job *j) {
  int status = parse(j);
  if (!status) status = cli_scene(j->c, cli_operand(j->c, 0), &j->scene);
  if (!status && j->scene->animated_until > -INFINITY && j->time != 0) {
    skf_scene_free(j->scene), j->scene = NULL;
    status = cli_scene_at(j->c, cli_operand(j->c, 0), j->time, &j->scene);
  }
  if (!status) status = run_read(cli_value(j->c, "orbits"), cli_value(j->c, "contacts"), &j->run);
  if (!status) status = run_bodies_read(cli_value(j->c, "bodies"), j->scene, &j->moved);
  if (!status) status = render_bodies(j);
  if (!status) status = render_camera(j);
  if (!status && (!render_is_plain(j) || j->scene->image_count)) status = picture_module(&j->plot);
  if (!status) status = render_images(j);
  if (status) return status;
  render_ground(j);
  set_samples(j);
  return j->frames ? render_film(j) : write_picture(j);
}

static int run(cli *c) {
  render_job j = {.c = c, .label = "render"};
  int status = work(&j);
  render_release(&j);
  run_free(&j.run);
  run_bodies_free(&j.moved);
  skf_scene_free(j.scene);
  return status;
}

static const cli_option options[] = {
    {'o', "output", "IMAGE.png", "the picture; its ending tells the format (default: PNG on stdout)"},
    {0, "size", "WxH", "pixels (default: 1200x900)"},
    {0, "quality", "NAME",
     "normal, fine (four times the rays for soft shadows), or draft: no shadows, one ray a pixel"},
    {0, "spp", "N",
     "rays for a pixel where surfaces end or light changes quickly (default: 9; with lens or shutter 128; 1 does "
     "without both)"},
    {0, "bounces", "N", "how often light is mirrored or refracted; then rays see the background (default: 6)"},
    {0, "mode", "NAME", "surface, offset (hard surfaces around the skeleton), or cost (evaluations per pixel)"},
    {0, "skeleton", NULL, "shows the skeleton inside of surfaces that are seen through"},
    {0, "time", "T", "of animated numbers, and how far bodies have spun (default: 0)"},
    {0, "frames", "N", "a film: NAME-0001.png and so on, or one NAME.avi (motion JPEG); see below"},
    {0, "fps", "F", "pictures a second of an AVI (default: 25)"},
    {0, "until", "T", "time of the last frame (default: see below)"},
    {0, "turntable", NULL, "a film's camera turns once about what it looks at"},
    {0, "depth", "BITS", "of a channel in png and tif: 8 or 16 (default: 8)"},
    {0, "azimuth", "DEGREES", "where the camera stands, from x towards y (default: -60)"},
    {0, "elevation", "DEGREES", "how high it stands (default: 28)"},
    {0, "fov", "DEGREES", "its vertical angle of view (default: the scene's, or 30)"},
    {0, "from", "X,Y,Z", "its place"},
    {0, "to", "X,Y,Z", "what it looks at"},
    {0, "up", "X,Y,Z", "what is up in the picture"},
    {0, "ground", NULL, "a floor below the bodies that catches their shadows; in a film it stays where it is at first"},
    {0, "orbits", "RUN.csv", "draw the paths that simulate wrote"},
    {0, "contacts", "C.csv", "mark the contacts that simulate --contacts wrote"},
    {0, "bodies", "FILE", "put the bodies where simulate --bodies wrote that they are at --time"},
};

static const char *const writes[] = {"output", NULL};
static const char *const reads[] = {"orbits", "contacts", "bodies", NULL};

const cli_command cmd_render = {
    .name = "render",
    .operands = "SCENE",
    .summary = "a shaded picture of the surfaces",
    .operand_count = 1,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .notes =
        "Camera, lights, background, fog, materials and textures are the scene's (skelfield help scene); what it does\n"
        "not give is chosen so that everything is in the picture. Formats: png, jpg, tif, webp, bmp, ppm; exr, pfm "
        "and\n"
        "hdr hold linear light, without paths. Ctrl-C ends with the picture as far as it is.\n"
        "A film runs from --time to --until: to the last key of `animate`, to the end of --orbits, whose particles "
        "then\n"
        "are dots with trails, to that of --bodies, or else through one turn of the fastest spin.\n"
        "Example: skelfield render donut.yaml -o donut.png --orbits run.csv --azimuth 30\n"
        "         skelfield simulate heap.yaml --bodies b.csv; skelfield render heap.yaml -o heap.avi --frames 120 "
        "--bodies b.csv\n",
    .run = run,
    .writes = writes,
    .reads = reads,
};
