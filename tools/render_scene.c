/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a scene to what is rendered: bodies, their offsets and skeletons, pictures on them, camera, floor. */
#include "render_job.h"
#include "core/alloc.h"
#include "core/vec3.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static double linear_light(unsigned char x) {
  double v = x / 255.0;
  return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

int render_images(render_job *j) {
  for (size_t i = 0; i < j->scene->image_count; i++) {
    skf_scene_image *image = j->scene->images[i];
    skf_image *p = &image->pixels;
    unsigned char *rgb;
    char error[256];
    struct stat about;
    errno = 0;
    if (stat(image->path, &about) || !S_ISREG(about.st_mode) ||
        access(image->path, R_OK)) /* a pipe would be waited for */
      return cli_fail(CLI_BAD, "%s:%ld: %s: %s, expected a picture", cli_operand(j->c, 0), image->line, image->path,
                      errno ? strerror(errno) : "not a regular file");
    if (j->plot->decode(image->path, &p->width, &p->height, &rgb, error))
      return cli_fail(CLI_BAD, "%s:%ld: %s: %s, expected a picture", cli_operand(j->c, 0), image->line, image->path,
                      error);
    size_t n = 3 * (size_t)p->width * p->height;
    p->rgb = malloc(n * sizeof *p->rgb);
    for (size_t k = 0; p->rgb && k < n; k++) p->rgb[k] = (float)linear_light(rgb[k]);
    j->plot->release(rgb);
    if (!p->rgb) return cli_fail(CLI_FAILED, "out of memory");
  }
  return CLI_DONE;
}

/* How far an element's surface is from it where it is alone; of several pieces of an entry all have that of the entry's
   handles. 0: nowhere. */
static void radii(const skf_body *b, double *out) {
  skf_handles h;
  for (size_t i = 0; i < b->element_count; i++) {
    bool solid = b->elements[i].primitive.shape == SKF_SOLID;
    out[i] = !solid && !skf_handles_find(b->elements + i, 1, b->iso, &h) ? h.radius : 0;
  }
  for (size_t k = 0; k < b->handled_count; k++) {
    const skf_handled *e = b->handled + k;
    if (e->count > 1 && !skf_handles_find(b->elements + e->first, e->count, b->iso, &h))
      for (size_t i = 0; i < e->count; i++) out[e->first + i] = h.radius;
  }
}

/* Slot k of the offsets: hulls around a body's elements, at `radius` or, where it is 0, at their own. */
static int add_offsets(render_job *j, size_t k, const skf_body *b, double radius) {
  size_t n = 0;
  double *own = malloc((b->element_count + 1) * sizeof *own);
  j->items[k] = calloc(b->element_count + 1, sizeof **j->items);
  j->look_of[k] = calloc(b->element_count + 1, 1);
  j->kept[k] = calloc(b->element_count + 1, sizeof **j->kept);
  if (!own || !j->items[k] || !j->look_of[k] || !j->kept[k]) return free(own), cli_fail(CLI_FAILED, "out of memory");
  radii(b, own);
  for (size_t i = 0; i < b->element_count; i++) {
    const skf_primitive *p = &b->elements[i].primitive;
    double r = p->shape == SKF_SOLID ? 0 : radius > 0 ? radius : own[i];
    if (p->shape != SKF_SOLID && !(r > 0)) continue;
    if (radius == 0 && !(b->elements[i].strength > 0)) continue; /* it carves */
    j->look_of[k][n] = radius > 0 ? 0 : b->look_of[i];
    j->kept[k][n] = b->elements[i];
    j->items[k][n++] = (skf_offset){*p, r};
  }
  free(own);
  skf_status s = skf_offsets_new(j->items[k], n, j->offsets + k);
  return s ? cli_fail_status(s, b->name) : CLI_DONE;
}

static double extent(const skf_body *b) {
  skf_box all = box_empty(), region;
  for (size_t i = 0; i < b->element_count; i++)
    if (b->elements[i].primitive.shape != SKF_PLANE)
      all = box_join(all, skf_primitive_bounds(&b->elements[i].primitive));
  double size = b->element_count && all.lo.x <= all.hi.x ? box_diagonal(all) : 0;
  if (!(size > 0) && !skf_field_region(b->field, b->iso, &region)) size = box_diagonal(region);
  return size > 0 ? size : 1;
}

/* A run's bodies are moved, without a trace of it while the shutter is open; the others turn by their spin. */
static void turn_body(const render_job *j, const skf_body *b, skf_render_body *out) {
  for (size_t i = 0; i < j->moved.count; i++) {
    if (j->moved.bodies[i].body != (size_t)(b - j->scene->bodies)) continue;
    run_place p = run_body_at(j->moved.bodies + i, j->time);
    out->axis = p.axis, out->about = p.about, out->angle = p.angle, out->shift = p.shift, out->sweep = 0;
    return;
  }
  double shutter = j->scene->shutter;
  out->axis = b->spin.axis, out->about = b->spin.about;
  out->angle = b->spin.rate * (j->time - shutter / 2), out->sweep = b->spin.rate * shutter;
}

/* The surface, or its offsets. */
static int add_body(render_job *j, size_t i) {
  const skf_body *b = j->scene->bodies + i;
  skf_render_body *out = j->bodies + i;
  const skf_tracer_options options = {.normals = 1e-8};
  skf_status s = SKF_OK;
  if (j->mode != RENDER_OFFSET) s = skf_tracer_new_with(b->field, b->iso, &options, j->tracers + i);
  if (s) return cli_fail_status(s, b->name);
  *out = (skf_render_body){.tracer = j->tracers[i],
                           .looks = b->looks,
                           .look_count = b->look_count,
                           .elements = b->elements,
                           .element_count = b->element_count,
                           .look_of = b->look_of};
  memcpy(out->color, b->color, sizeof out->color);
  turn_body(j, b, out);
  if (j->mode != RENDER_OFFSET) return CLI_DONE;
  int status = add_offsets(j, i, b, 0);
  out->offsets = j->offsets[i], out->look_of = j->look_of[i], out->elements = j->kept[i];
  return status;
}

/* The skeleton as thin red rods, and the surface like thin glass around it. */
static int add_skeleton(render_job *j, size_t i) {
  const skf_body *b = j->scene->bodies + i;
  size_t n = j->scene->body_count, k = n + i;
  skf_look *looks = j->looks[i] = calloc(b->look_count + 1, sizeof *looks);
  if (!looks) return cli_fail(CLI_FAILED, "out of memory");
  int status = add_offsets(j, k, b, 0.008 * extent(b));
  if (status) return status;
  looks[b->look_count] = skf_look_default();
  static const double red[3] = {0.85, 0.05, 0.03};
  memcpy(looks[b->look_count].color, red, sizeof red);
  j->bodies[k] = (skf_render_body){
      .offsets = j->offsets[k], .looks = looks + b->look_count, .look_count = 1, .element_count = b->element_count};
  turn_body(j, b, j->bodies + k);
  memcpy(looks, b->looks, b->look_count * sizeof *looks);
  for (size_t m = 0; m < b->look_count; m++)
    for (int c = 0; c < 3; c++) looks[m].transparency[c] = fmax(looks[m].transparency[c], 0.8);
  j->bodies[i].looks = looks;
  return CLI_DONE;
}

void render_spin(render_job *j) {
  size_t n = j->scene->body_count;
  for (size_t i = 0; i < j->what.body_count; i++) turn_body(j, j->scene->bodies + i % n, j->bodies + i);
}

int render_bodies(render_job *j) {
  const skf_scene *s = j->scene;
  size_t n = s->body_count;
  j->tracers = calloc(n + 1, sizeof *j->tracers), j->bodies = calloc(2 * n + 1, sizeof *j->bodies);
  j->offsets = calloc(2 * n + 1, sizeof *j->offsets), j->items = calloc(2 * n + 1, sizeof *j->items);
  j->looks = calloc(n + 1, sizeof *j->looks), j->look_of = calloc(2 * n + 1, sizeof *j->look_of);
  j->kept = calloc(2 * n + 1, sizeof *j->kept);
  if (!j->tracers || !j->bodies || !j->offsets || !j->items || !j->looks || !j->look_of || !j->kept)
    return cli_fail(CLI_FAILED, "out of memory");
  int status = CLI_DONE;
  for (size_t i = 0; i < n && !status; i++) status = add_body(j, i);
  for (size_t i = 0; i < n && !status && j->skeleton; i++) status = add_skeleton(j, i);
  j->what.bodies = j->bodies, j->what.body_count = j->skeleton ? 2 * n : n;
  j->what.lights = s->lights, j->what.light_count = s->light_count;
  j->what.fog = s->fog;
  static const double night[2][3] = {{0.055, 0.065, 0.085}, {0.012, 0.016, 0.028}};
  memcpy(j->what.background, night, sizeof night);
  if (s->has_background) {
    memcpy(j->what.background[0], s->background, sizeof s->background);
    memcpy(j->what.background[1], s->background_top, sizeof s->background_top);
  }
  return status;
}

void render_release(render_job *j) {
  size_t n = j->scene ? j->scene->body_count : 0;
  for (size_t i = 0; j->tracers && i < n; i++) skf_tracer_free(j->tracers[i]);
  for (size_t i = 0; j->offsets && i < 2 * n; i++) skf_offsets_free(j->offsets[i]);
  for (size_t i = 0; j->items && i < 2 * n; i++) free(j->items[i]);
  for (size_t i = 0; j->look_of && i < 2 * n; i++) free(j->look_of[i]);
  for (size_t i = 0; j->kept && i < 2 * n; i++) free(j->kept[i]);
  for (size_t i = 0; j->looks && i < n; i++) free(j->looks[i]);
  for (size_t i = 0; j->scene && i < j->scene->image_count; i++) free(j->scene->images[i]->pixels.rgb);
  free(j->tracers), free(j->bodies), free(j->offsets), free(j->items), free(j->looks), free(j->look_of), free(j->kept);
  skf_free(j->rgb), free(j->depth);
  j->tracers = NULL, j->bodies = NULL, j->offsets = NULL, j->items = NULL, j->looks = NULL, j->look_of = NULL,
  j->kept = NULL;
  j->rgb = j->depth = NULL;
}

static int angle(const cli *c, const char *option, double lo, double hi, double *radians) {
  double degrees = *radians * (180 / SKF_PI);
  int status = cli_number(c, option, -INFINITY, &degrees);
  if (!status && (degrees < lo || degrees > hi))
    status = cli_fail(CLI_BAD, "--%s %s: expected degrees from %g to %g", option, cli_value(c, option), lo, hi);
  *radians = degrees * (SKF_PI / 180);
  return status;
}

/* Points around a hull, not further from it than the picture's margin is wide. */
enum { AROUND = 14, ARC_PLACES = 16, HULL_POINTS = ARC_PLACES * AROUND };

static size_t around(skf_vec3 p, double radius, skf_vec3 *out) {
  size_t n = 0;
  for (int k = 0; k < 27; k++) {
    skf_vec3 d = v3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
    double square = v3_norm2(d);
    if (square == 1 || square == 3) out[n++] = v3_mad(p, 1.1 * radius, v3_unit(d));
  }
  return n;
}

static size_t hull_points(const skf_offset *o, skf_vec3 *out) {
  const skf_primitive *p = &o->primitive;
  size_t n = 0;
  skf_box box = skf_primitive_bounds(p);
  switch (p->shape) {
  case SKF_POINT: return around(p->point.at, o->radius, out);
  case SKF_PLANE: return around(p->plane.through, o->radius, out);
  case SKF_SEGMENT: n = around(p->segment.from, o->radius, out); return n + around(p->segment.to, o->radius, out + n);
  case SKF_TRIANGLE:
    for (int k = 0; k < 3; k++) n += around(p->triangle.vertices[k], o->radius, out + n);
    return n;
  case SKF_ARC: {
    skf_vec3 z = v3_unit(p->arc.normal), x = v3_unit(v3_mad(p->arc.start, -v3_dot(p->arc.start, z), z));
    skf_vec3 y = v3_cross(z, x);
    for (int k = 0; k < ARC_PLACES; k++) {
      double turn = p->arc.sweep * k / (ARC_PLACES - 1), r = p->arc.radius;
      n += around(v3_mad(v3_mad(p->arc.center, r * cos(turn), x), r * sin(turn), y), o->radius, out + n);
    }
    return n;
  }
  default:
    for (; n < 8; n++)
      out[n] = v3(n & 1 ? box.hi.x : box.lo.x, n & 2 ? box.hi.y : box.lo.y, n & 4 ? box.hi.z : box.lo.z);
    return n;
  }
}

static bool is_hull(const skf_offset *o) { return o->primitive.shape == SKF_SOLID || o->radius > 0; }

/* Where a body's skeleton can be along its way. */
static size_t places(const render_job *j, const run_body *b, skf_vec3 *out) {
  double reach = 0.5 * extent(j->scene->bodies + b->body);
  size_t n = 0;
  for (size_t i = 0; i < b->count; i++)
    for (int k = 0; k < 6; k++) {
      skf_vec3 p = b->poses[i].x;
      *v3_at(&p, k / 2) += k & 1 ? reach : -reach;
      out[n++] = p;
    }
  return n;
}

/* A camera that frames the bodies and the paths. */
static int automatic_camera(render_job *j, double fov) {
  double azimuth = -60 * (SKF_PI / 180), elevation = 28 * (SKF_PI / 180);
  int status = angle(j->c, "azimuth", -360, 360, &azimuth);
  if (!status) status = angle(j->c, "elevation", -90, 90, &elevation);
  if (status) return status;
  if (cli_given(j->c, "from") && cli_given(j->c, "to")) /* then there is nothing to frame */
    return j->what.camera = (skf_camera){.given = true, .up = {0, 0, 1}, .fov = fov}, CLI_DONE;
  size_t n = 0, bodies = j->scene->body_count;
  for (size_t i = 0; i < j->run.particle_count; i++) n += j->run.particles[i].count;
  for (size_t i = 0; i < j->moved.count; i++) n += 6 * j->moved.bodies[i].count;
  for (size_t i = 0; i < bodies && j->mode == RENDER_OFFSET; i++) n += HULL_POINTS * j->scene->bodies[i].element_count;
  skf_vec3 *points = malloc((n + 1) * sizeof *points);
  const skf_field **fields = malloc((bodies + 1) * sizeof *fields);
  double *isos = malloc((bodies + 1) * sizeof *isos);
  skf_status s = SKF_ERR_NOMEM;
  if (points && fields && isos) {
    n = 0;
    for (size_t i = 0; i < j->run.particle_count; i++)
      for (size_t k = 0; k < j->run.particles[i].count; k++) points[n++] = j->run.particles[i].states[k].x;
    for (size_t i = 0; i < j->moved.count; i++) n += places(j, j->moved.bodies + i, points + n);
    for (size_t i = 0; i < bodies && j->mode == RENDER_OFFSET; i++)
      for (size_t k = 0; k < j->scene->bodies[i].element_count; k++)
        if (is_hull(j->items[i] + k)) n += hull_points(j->items[i] + k, points + n);
    for (size_t i = 0; i < bodies; i++) fields[i] = j->scene->bodies[i].field, isos[i] = j->scene->bodies[i].iso;
    double aspect = (double)j->what.width / j->what.height;
    if (j->mode == RENDER_OFFSET)
      s = skf_camera_frame(fields, isos, bodies, points, n, azimuth, elevation, fov, aspect, &j->what.camera);
    else
      s = skf_camera_frame_with((const skf_tracer *const *)j->tracers, bodies, points, n, azimuth, elevation, fov,
                                aspect, &j->what.camera);
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
int render_camera(render_job *j) {
  const cli *c = j->c;
  const skf_camera *given = &j->scene->camera;
  skf_camera *camera = &j->what.camera;
  bool turned = cli_given(c, "azimuth") || cli_given(c, "elevation");
  double fov = given->given ? given->fov : 30 * (SKF_PI / 180);
  int status = angle(c, "fov", 0.01, 170, &fov);
  if (status) return status;
  if (given->given && !turned)
    *camera = *given;
  else
    status = automatic_camera(j, fov);
  if (!status && cli_given(c, "fov") && camera->height > 0)
    status = cli_fail(CLI_BAD, "--fov %s: the scene's camera is orthographic, expected one in perspective",
                      cli_value(c, "fov"));
  camera->fov = fov, camera->aperture = given->aperture, camera->focus = given->focus;
  if (!status) status = vector(c, "from", &camera->from);
  if (!status) status = vector(c, "to", &camera->to);
  if (!status) status = vector(c, "up", &camera->up);
  if (!status && !(v3_dist(camera->from, camera->to) > 0))
    status = cli_fail(CLI_BAD, "the camera looks nowhere: its two points, from and to, are one");
  return status;
}

/* The floor lies under the lowest point of the bodies' regions. */
void render_ground(render_job *j) {
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
      skf_ray up = {at, {0, 0, 1}, 0, INFINITY};
      skf_hit hit;
      bool found = false;
      if (j->offsets[i])
        found = skf_offsets_first(j->offsets[i], &up, &hit, NULL);
      else if (skf_tracer_first(j->tracers[i], &up, &hit, &found, NULL))
        found = false;
      if (found) low = fmin(low, hit.at.z);
    }
    lowest = fmin(lowest, low);
  }
  j->what.ground = isfinite(lowest);
  j->what.ground_at = v3(0, 0, lowest), j->what.ground_normal = v3(0, 0, 1);
}
