/* SPDX-License-Identifier: MIT */
/* Cameras: rays, projection, and one that frames what there is. */
#include "core/alloc.h"
#include "field/envelope.h"
#include "ray/render_camera_lanes.h"
#include "ray/walk.h"
#include "simd/isa.h"

skf_status skf_view_make(const skf_camera *c, double aspect, skf_view *out) {
  skf_vec3 way = v3_sub(c->to, c->from);
  bool parallel = c->height != 0,
       lens = c->aperture >= 0 && isfinite(c->aperture) && c->focus >= 0 && isfinite(c->focus);
  if (!v3_finite(way) || !(v3_norm(way) > 0) || !(aspect > 0) || !lens) return SKF_ERR_ARG;
  if (parallel ? !(c->height > 0 && isfinite(c->height)) : !(c->fov > 0 && c->fov < SKF_PI)) return SKF_ERR_ARG;
  out->from = c->from;
  out->forward = v3_unit(way);
  skf_vec3 up = v3_unit(c->up), side = v3_cross(out->forward, up);
  if (!(v3_norm(side) > 1e-9)) side = v3_perp(out->forward); /* it looks along its own upright */
  out->right = v3_unit(side);
  out->up = v3_cross(out->right, out->forward);
  out->parallel = parallel;
  out->tan_y = parallel ? c->height / 2 : tan(c->fov / 2), out->tan_x = out->tan_y * aspect;
  out->row = skf_view_row_scalar;
#ifdef SKF_HAVE_AVX2
  if (skf_isa_pick() != SKF_ISA_SCALAR) out->row = skf_view_row_avx2;
#endif
  out->aperture = c->aperture, out->focus = c->focus > 0 ? c->focus : v3_norm(way);
  return SKF_OK;
}

/* A row of pixels on the picture plane, and a place in it. */
static skf_vec3 on_row(const skf_view *v, skf_vec3 from, int height, double py) {
  return v3_mad(from, (1 - 2 * py / height) * v->tan_y, v->up);
}

static skf_vec3 in_row(const skf_view *v, skf_vec3 row, int width, double px) {
  return v3_mad(row, (2 * px / width - 1) * v->tan_x, v->right);
}

/* Not shorter than `forward`, which it starts from: no square can underflow. */
static skf_vec3 direction(skf_vec3 way) { return v3_scale(1 / v3_norm(way), way); }

skf_vec3 skf_view_ray(const skf_view *v, int width, int height, double px, double py) {
  return v->parallel ? v->forward : direction(in_row(v, on_row(v, v->forward, height, py), width, px));
}

void skf_view_row_scalar(const skf_view *v, skf_vec3 row, int width, double px, int n, skf_beam *out) {
  view_row(v, row, width, px, n, out);
}

void skf_view_row(const skf_view *v, int width, int height, double px, double py, int n, skf_beam *out) {
  v->row(v, on_row(v, v->parallel ? v->from : v->forward, height, py), width, px, n, out);
}

void skf_view_lens(const skf_view *v, double x, double y, skf_vec3 *from, skf_vec3 *direction) {
  skf_vec3 sharp = v3_mad(*from, v->focus / v3_dot(*direction, v->forward), *direction);
  *from = v3_mad(v3_mad(*from, v->aperture * x, v->right), v->aperture * y, v->up);
  *direction = v3_unit(v3_sub(sharp, *from));
}

double skf_view_height(const skf_view *v, skf_vec3 direction) {
  double wide = v->parallel ? 0.36 : v->tan_y; /* as if through 40 degrees */
  double y = v3_dot(direction, v->up) / (fabs(v3_dot(direction, v->forward)) * wide);
  return isnan(y) ? 0.5 : fmin(fmax(0.5 + 0.5 * y, 0), 1);
}

bool skf_camera_project(const skf_camera *camera, int width, int height, skf_vec3 p, double px[3]) {
  skf_view v;
  if (skf_view_make(camera, (double)width / height, &v)) return false;
  skf_vec3 d = v3_sub(p, v.from);
  double z = v3_dot(d, v.forward), scale = v.parallel ? 1 : z;
  if (!(z > 0)) return false;
  px[0] = width * (1 + v3_dot(d, v.right) / (scale * v.tan_x)) / 2;
  px[1] = height * (1 - v3_dot(d, v.up) / (scale * v.tan_y)) / 2;
  px[2] = v.parallel ? z : v3_norm(d);
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
    length = fmax(length, skf_kernel_width(e->kernel));
  }
  double size = fmax(fmax(box_diagonal(all), length), 0);
  return box_grow(all, size > 0 ? size : 1);
}

/* What the camera has to show. */
typedef struct cloud {
  skf_vec3 *at;
  size_t n, capacity;
} cloud;

static skf_status add_point(cloud *c, skf_vec3 p) {
  if (c->n == c->capacity) {
    size_t more = c->capacity ? 2 * c->capacity : 1024;
    skf_vec3 *at = skf_realloc(c->at, more, sizeof *at);
    if (!at) return SKF_ERR_NOMEM;
    c->at = at, c->capacity = more;
  }
  c->at[c->n++] = p;
  return SKF_OK;
}

static skf_status add_box(cloud *c, skf_box b) {
  skf_status status = SKF_OK;
  for (int k = 0; k < 8 && !status; k++)
    status = add_point(c, v3(k & 1 ? b.hi.x : b.lo.x, k & 2 ? b.hi.y : b.lo.y, k & 4 ? b.hi.z : b.lo.z));
  return status;
}

/* The two planes of sight, across `side`, that touch the points on both sides at half angle atan(slope): they meet at
 *middle along side and at the returned place along forward. */
static double apex(const cloud *c, skf_vec3 side, skf_vec3 forward, double slope, double *middle) {
  double plus = -INFINITY, minus = -INFINITY;
  for (size_t i = 0; i < c->n; i++) {
    double x = v3_dot(c->at[i], side), z = slope * v3_dot(c->at[i], forward);
    plus = fmax(plus, x - z), minus = fmax(minus, -x - z);
  }
  *middle = (plus - minus) / 2;
  return -(plus + minus) / (2 * slope);
}

/* The same planes at the smaller angle for which they meet at z: then what is seen is in the middle of the picture. */
static double centre(const cloud *c, skf_vec3 side, skf_vec3 forward, double slope, double z) {
  double lo = 0, hi = slope, middle = 0;
  for (int k = 0; k < 60; k++) {
    double m = (lo + hi) / 2;
    if (apex(c, side, forward, m, &middle) < z)
      lo = m;
    else
      hi = m;
  }
  apex(c, side, forward, hi, &middle);
  return middle;
}

static void fit(skf_view *v, const cloud *c) {
  double x, y, zx = apex(c, v->right, v->forward, v->tan_x, &x), zy = apex(c, v->up, v->forward, v->tan_y, &y);
  double z = fmin(zx, zy);
  if (zx > z) x = centre(c, v->right, v->forward, v->tan_x, z);
  if (zy > z) y = centre(c, v->up, v->forward, v->tan_y, z);
  v->from = v3_mad(v3_mad(v3_scale(x, v->right), y, v->up), z, v->forward);
}

enum { PROBE = 56, PROBES = PROBE * PROBE }; /* rays each way that look for the surface */

/* Room for these rays and what they meet. */
typedef struct probes {
  skf_ray ray[PROBES];
  skf_hit hit[PROBES];
  bool found[PROBES];
} probes;

static bool holds(skf_box b, skf_vec3 p) {
  return p.x >= b.lo.x && p.y >= b.lo.y && p.z >= b.lo.z && p.x <= b.hi.x && p.y <= b.hi.y && p.z <= b.hi.z;
}

/* Adds the places where the camera's rays meet the surface within the box; the box where there are none. */
static skf_status add_surface(const skf_view *v, const skf_tracer *tracer, skf_box box, probes *p, cloud *c) {
  skf_status status = SKF_OK;
  size_t before = c->n;
  for (int k = 0; k < PROBES; k++) {
    int row = k / PROBE;
    p->ray[k] = (skf_ray){v->from, skf_view_ray(v, PROBE, PROBE, k % PROBE + 0.5, row + 0.5), 0, INFINITY};
  }
  skf_tracer_first_many(tracer, PROBES, p->ray, p->hit, p->found, NULL); /* what is wrong with a ray finds nothing */
  for (int k = 0; k < PROBES && !status; k++)
    if (p->found[k] && holds(box, p->hit[k].at)) status = add_point(c, p->hit[k].at);
  return status || c->n > before ? status : add_box(c, box);
}

/* The boxes are wide: they only give the first camera, which then looks at the surfaces themselves. */
static skf_status look_thrice(const skf_tracer *const *tracers, const skf_box *boxes, size_t count,
                              const skf_vec3 *points, size_t n, probes *p, skf_view *v) {
  cloud c = {NULL, 0, 0};
  skf_status status = SKF_OK;
  for (int pass = 0; pass < 3 && !status; pass++) {
    c.n = 0;
    for (size_t i = 0; i < count && !status; i++)
      status = pass ? add_surface(v, tracers[i], boxes[i], p, &c) : add_box(&c, boxes[i]);
    for (size_t i = 0; i < n && !status; i++) status = add_point(&c, points[i]);
    if (!status && c.n == 0) status = add_box(&c, (skf_box){{-1, -1, -1}, {1, 1, 1}});
    if (!status) fit(v, &c);
  }
  skf_free(c.at);
  return status;
}

skf_status skf_camera_frame_with(const skf_tracer *const *tracers, size_t count, const skf_vec3 *points, size_t n,
                                 double azimuth, double elevation, double fov, double aspect, skf_camera *out) {
  skf_vec3 back = v3(cos(elevation) * cos(azimuth), cos(elevation) * sin(azimuth), sin(elevation));
  skf_camera camera = {.given = true, .from = back, .up = {0, 0, 1}, .fov = fov};
  skf_view v;
  skf_status status = skf_view_make(&camera, aspect, &v);
  if (status) return status;
  v.tan_x *= 0.9, v.tan_y *= 0.9; /* the margin */
  skf_box *boxes = skf_alloc(count, sizeof *boxes), all = box_empty();
  probes *p = skf_alloc(1, sizeof *p);
  status = boxes && p ? SKF_OK : SKF_ERR_NOMEM;
  for (size_t i = 0; i < count && !status; i++) {
    if (skf_field_region(tracers[i]->field, tracers[i]->iso, boxes + i)) boxes[i] = skeleton_box(tracers[i]->field);
    all = box_join(all, boxes[i]);
  }
  if (!status) status = look_thrice(tracers, boxes, count, points, n, p, &v);
  skf_free(boxes), skf_free(p);
  double reach = count ? v3_dot(v3_sub(box_center(all), v.from), v.forward) : 1;
  camera.from = v.from, camera.to = v3_mad(v.from, reach > 0 ? reach : 1, v.forward);
  *out = camera;
  return status;
}

skf_status skf_camera_frame(const skf_field *const *fields, const double *isos, size_t count, const skf_vec3 *points,
                            size_t n, double azimuth, double elevation, double fov, double aspect, skf_camera *out) {
  skf_tracer **tracers = skf_alloc(count, sizeof *tracers);
  skf_status status = tracers ? SKF_OK : SKF_ERR_NOMEM;
  for (size_t i = 0; i < count && !status; i++)
    status = skf_tracer_new_with(fields[i], isos[i], &(skf_tracer_options){.normals = 1e-3}, tracers + i);
  if (!status)
    status = skf_camera_frame_with((const skf_tracer *const *)tracers, count, points, n, azimuth, elevation, fov,
                                   aspect, out);
  for (size_t i = 0; tracers && i < count; i++) skf_tracer_free(tracers[i]);
  skf_free(tracers);
  return status;
}
