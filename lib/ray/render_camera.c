/* SPDX-License-Identifier: MIT */
/* Cameras: rays, projection, and one that frames what there is. */
#include "ray/render.h"
#include "core/alloc.h"

skf_status skf_view_make(const skf_camera *c, double aspect, skf_view *out) {
  skf_vec3 way = v3_sub(c->to, c->from);
  if (!v3_finite(way) || !(v3_norm(way) > 0) || !(c->fov > 0 && c->fov < SKF_PI) || !(aspect > 0)) return SKF_ERR_ARG;
  out->from = c->from;
  out->forward = v3_unit(way);
  skf_vec3 up = v3_unit(c->up), side = v3_cross(out->forward, up);
  if (!(v3_norm(side) > 1e-9)) side = v3_perp(out->forward); /* it looks along its own upright */
  out->right = v3_unit(side);
  out->up = v3_cross(out->right, out->forward);
  out->tan_y = tan(c->fov / 2), out->tan_x = out->tan_y * aspect;
  return SKF_OK;
}

skf_vec3 skf_view_ray(const skf_view *v, int width, int height, double px, double py) {
  double x = (2 * px / width - 1) * v->tan_x, y = (1 - 2 * py / height) * v->tan_y;
  return v3_unit(v3_mad(v3_mad(v->forward, x, v->right), y, v->up));
}

bool skf_camera_project(const skf_camera *camera, int width, int height, skf_vec3 p, double px[3]) {
  skf_view v;
  if (skf_view_make(camera, (double)width / height, &v)) return false;
  skf_vec3 d = v3_sub(p, v.from);
  double z = v3_dot(d, v.forward);
  if (!(z > 0)) return false;
  px[0] = width * (1 + v3_dot(d, v.right) / (z * v.tan_x)) / 2;
  px[1] = height * (1 - v3_dot(d, v.up) / (z * v.tan_y)) / 2;
  px[2] = v3_norm(d);
  return true;
}

/* The skeleton's bounds with room around them, for surfaces without bounds of their own. */
static skf_box skeleton_box(const skf_field *field) {
  skf_box all = box_empty();
  double length = 0;
  for (size_t i = 0; i < skf_field_size(field); i++) {
    const skf_element *e = skf_field_element(field, i);
    skf_box b = skf_primitive_bounds(&e->primitive);
    if (e->primitive.shape == SKF_PLANE) b = (skf_box){e->primitive.plane.through, e->primitive.plane.through};
    all = box_join(all, b);
    const skf_kernel_info *k = skf_kernel_get(e->kernel.type);
    if (k->param) length = fmax(length, k->compact ? e->kernel.param : 1 / e->kernel.param);
  }
  double size = fmax(fmax(box_diagonal(all), length), 0);
  return box_grow(all, size > 0 ? size : 1);
}

/* Points in the camera's frame: across, up, forward. */
typedef struct extremes {
  double right, left, up, down; /* largest distances beyond the planes through the apex at 0 */
  size_t n;
} extremes;

static void add_point(const skf_view *v, skf_vec3 p, extremes *e) {
  double x = v3_dot(p, v->right), y = v3_dot(p, v->up), z = v3_dot(p, v->forward);
  e->right = fmax(e->right, x - v->tan_x * z), e->left = fmax(e->left, -x - v->tan_x * z);
  e->up = fmax(e->up, y - v->tan_y * z), e->down = fmax(e->down, -y - v->tan_y * z);
  e->n++;
}

static void add_box(const skf_view *v, skf_box b, extremes *e) {
  for (int k = 0; k < 8; k++)
    add_point(v, v3(k & 1 ? b.hi.x : b.lo.x, k & 2 ? b.hi.y : b.lo.y, k & 4 ? b.hi.z : b.lo.z), e);
}

/* The pyramid of view that touches all points on both sides: its four planes give the apex in closed form. */
static void fit(const skf_view *v, const extremes *e, skf_vec3 *from) {
  double zx = -(e->right + e->left) / (2 * v->tan_x), zy = -(e->up + e->down) / (2 * v->tan_y);
  double x = (e->right - e->left) / 2, y = (e->up - e->down) / 2, z = fmin(zx, zy);
  *from = v3_mad(v3_mad(v3_scale(x, v->right), y, v->up), z, v->forward);
}

enum { PROBE = 56 }; /* rays each way that look for the surface */

/* Adds the places where the camera's rays meet the surface within the box. */
static skf_status add_surface(const skf_view *v, const skf_field *field, double iso, skf_box box, extremes *e) {
  skf_tracer *tracer;
  skf_status status = skf_tracer_new(field, iso, &tracer);
  if (status) return status;
  for (int k = 0; k < PROBE * PROBE; k++) {
    int row = k / PROBE;
    skf_ray ray = {v->from, skf_view_ray(v, PROBE, PROBE, k % PROBE + 0.5, row + 0.5), 0, INFINITY};
    skf_hit hit;
    bool found = false;
    if (skf_tracer_first(tracer, &ray, &hit, &found, NULL) || !found) continue;
    const skf_vec3 p = hit.at;
    if (p.x < box.lo.x || p.y < box.lo.y || p.z < box.lo.z || p.x > box.hi.x || p.y > box.hi.y || p.z > box.hi.z)
      continue;
    add_point(v, p, e);
  }
  skf_tracer_free(tracer);
  return SKF_OK;
}

static const extremes nothing = {-INFINITY, -INFINITY, -INFINITY, -INFINITY, 0};

skf_status skf_camera_frame(const skf_field *const *fields, const double *isos, size_t count, const skf_vec3 *points,
                            size_t n, double azimuth, double elevation, double fov, double aspect, skf_camera *out) {
  skf_vec3 back = v3(cos(elevation) * cos(azimuth), cos(elevation) * sin(azimuth), sin(elevation));
  skf_camera camera = {true, back, {0, 0, 0}, {0, 0, 1}, fov};
  skf_view v;
  skf_status status = skf_view_make(&camera, aspect, &v);
  if (status) return status;
  v.tan_x *= 0.9, v.tan_y *= 0.9; /* the margin */
  skf_box *boxes = skf_alloc(count, sizeof *boxes);
  if (!boxes) return SKF_ERR_NOMEM;
  extremes e = nothing;
  for (size_t i = 0; i < count; i++) {
    if (skf_field_region(fields[i], isos[i], boxes + i)) boxes[i] = skeleton_box(fields[i]);
    add_box(&v, boxes[i], &e);
  }
  for (size_t i = 0; i < n; i++) add_point(&v, points[i], &e);
  if (e.n == 0) add_box(&v, (skf_box){{-1, -1, -1}, {1, 1, 1}}, &e);
  fit(&v, &e, &v.from);
  for (int pass = 0; pass < 2 && !status; pass++) { /* the boxes are wide: look at the surfaces themselves */
    e = nothing;
    for (size_t i = 0; i < count && !status; i++) {
      size_t before = e.n;
      status = add_surface(&v, fields[i], isos[i], boxes[i], &e);
      if (e.n == before) add_box(&v, boxes[i], &e);
    }
    for (size_t i = 0; i < n; i++) add_point(&v, points[i], &e);
    if (e.n) fit(&v, &e, &v.from);
  }
  skf_box all = box_empty();
  for (size_t i = 0; i < count; i++) all = box_join(all, boxes[i]);
  skf_free(boxes);
  double reach = count ? v3_dot(v3_sub(box_center(all), v.from), v.forward) : 1;
  camera.from = v.from, camera.to = v3_mad(v.from, reach > 0 ? reach : 1, v.forward);
  *out = camera;
  return status;
}
