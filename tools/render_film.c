/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Films: numbered pictures, or motion JPEG in an AVI file. */
#include "render_job.h"
#include "avi.h"
#include "core/vec3.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

int render_film_parse(render_job *j) {
  const cli *c = j->c;
  const char *path = cli_value(c, "output"), *dot = path ? strrchr(path, '.') : NULL;
  j->frames = 0;
  int status = cli_whole(c, "frames", 2, 100000, &j->frames);
  static const char *const others[] = {"fps", "until", "turntable"};
  for (int i = 0; i < 3 && !status && !j->frames; i++)
    if (cli_given(c, others[i])) status = cli_fail(CLI_BAD, "--%s: expected --frames with it", others[i]);
  j->video = j->frames && dot && !strcasecmp(dot, ".avi");
  if (!status && j->frames && !j->video && cli_streams(path))
    status = cli_fail(CLI_BAD, "--frames: a film is not written to stdout, expected -o NAME.avi or NAME.png");
  if (j->video) j->format = skf_picture_format_find("frame.jpg");
  return status;
}

/* When the film ends, or a message when nothing would move. */
static int find_end(render_job *j) {
  double fastest = 0, end = j->scene->animated_until;
  for (size_t i = 0; i < j->scene->body_count; i++) fastest = fmax(fastest, fabs(j->scene->bodies[i].spin.rate));
  for (size_t i = 0; i < j->run.particle_count; i++)
    if (j->run.particles[i].count) end = fmax(end, j->run.particles[i].states[j->run.particles[i].count - 1].t);
  for (size_t i = 0; i < j->moved.count; i++) end = fmax(end, j->moved.bodies[i].poses[j->moved.bodies[i].count - 1].t);
  if (end > j->time)
    j->until = end;
  else if (fastest > 0) /* the turn's end is its start: one frame less */
    j->until = j->time + 2 * SKF_PI / fastest * (j->frames - 1) / j->frames;
  else
    j->until = j->time;
  int status = cli_number(j->c, "until", -INFINITY, &j->until);
  if (!status && j->until < j->time)
    status = cli_fail(CLI_BAD, "--until %s: expected a time after --time", cli_value(j->c, "until"));
  if (!status && j->until == j->time && !cli_given(j->c, "turntable"))
    status =
        cli_fail(CLI_BAD, "--frames %d: nothing moves, expected --turntable, a spin, `animate`, --orbits or --bodies",
                 j->frames);
  return status;
}

/* The scene as it is at the job's time; only what has changed is made anew. */
static int advance(render_job *j, bool own_camera) {
  int status = CLI_DONE;
  if (j->scene->animated_until > -INFINITY) {
    float *rgb = j->rgb, *depth = j->depth;
    j->rgb = j->depth = NULL; /* they stay */
    render_release(j);
    skf_scene_free(j->scene), j->scene = NULL;
    j->rgb = rgb, j->depth = depth;
    status = cli_scene_at(j->c, cli_operand(j->c, 0), j->time, &j->scene);
    if (!status) status = render_bodies(j);
    if (!status) status = render_images(j);
  }
  if (!status) render_spin(j);
  if (!status && own_camera) status = render_camera(j);
  return status;
}

static void turn_camera(render_job *j, const skf_camera *first, double angle) {
  skf_camera *c = &j->what.camera;
  skf_vec3 k = v3_unit(first->up), d = v3_sub(first->from, first->to); /* about the upright through `to` */
  double cosine = cos(angle), sine = sin(angle);
  d = v3_add(v3_mad(v3_scale(cosine, d), sine, v3_cross(k, d)), v3_scale(v3_dot(k, d) * (1 - cosine), k));
  c->from = v3_add(first->to, d);
}

static int write_frame(render_job *j, int k, const unsigned char *bytes, size_t n) {
  const char *path = cli_value(j->c, "output"), *dot = strrchr(path, '.');
  char name[4096];
  cli_out o;
  snprintf(name, sizeof name, "%.*s-%04d%s", (int)(dot - path), path, k + 1, dot);
  int status = cli_out_open(&o, name);
  if (status) return status;
  fwrite(bytes, 1, n, o.file);
  return cli_out_commit(&o);
}

static int frames(render_job *j, avi *film) {
  int status = CLI_DONE;
  double start = j->time;
  bool own_camera = j->scene->camera.given && !cli_given(j->c, "azimuth") && !cli_given(j->c, "elevation");
  skf_camera first = j->what.camera;
  for (int k = 0; k < j->frames && !status; k++) {
    j->time = start + (j->until - start) * k / (j->frames - 1);
    status = advance(j, own_camera);
    if (own_camera) first = j->what.camera;
    if (cli_given(j->c, "turntable")) turn_camera(j, &first, 2 * SKF_PI * k / j->frames);
    unsigned char *bytes;
    size_t n;
    snprintf(j->label, sizeof j->label, "frame %d of %d", k + 1, j->frames);
    if (!status) status = render_picture(j, &bytes, &n);
    if (status) return status;
    if (!j->cut) status = j->video ? avi_add(film, bytes, n) : write_frame(j, k, bytes, n);
    render_give_back(j, bytes);
    if (j->cut) return cli_say("skelfield: interrupted: %d of %d frames are written", k, j->frames), CLI_DONE;
  }
  return status;
}

int render_film(render_job *j) {
  double fps = 25;
  cli_out o;
  avi film = {NULL};
  int status = cli_number(j->c, "fps", 0, &fps);
  if (!status && (fps < 0.1 || fps > 1000))
    status = cli_fail(CLI_BAD, "--fps %s: expected a number from 0.1 to 1000", cli_value(j->c, "fps"));
  if (!status) status = find_end(j);
  if (status) return status;
  if (!j->video) return (status = frames(j, NULL)) ? status : j->cut ? CLI_FAILED : CLI_DONE;
  if ((status = cli_out_open(&o, cli_value(j->c, "output")))) return status;
  status = avi_open(&film, o.file, j->what.width, j->what.height, fps);
  if (!status) status = frames(j, &film);
  if (!status) status = avi_close(&film);
  free(film.index);
  if (status || !film.count) return cli_out_abort(&o), status ? status : CLI_FAILED; /* no film without a frame */
  status = cli_out_commit(&o);
  return status ? status : j->cut ? CLI_FAILED : CLI_DONE;
}
