/* SPDX-License-Identifier: MIT */
/* Textures: functions of space, and pictures on primitives. */
#include "ray/render.h"

static const skf_texture_info textures[SKF_TEXTURE_COUNT] = {
    [SKF_TEXTURE_CHECKER] = {"checker", "cubes of edge `size`", false},
    [SKF_TEXTURE_MARBLE] = {"marble", "waves across `axis`, bent by turbulence", false},
    [SKF_TEXTURE_WOOD] = {"wood", "rings about `axis` through `at`", false},
    [SKF_TEXTURE_GRANITE] = {"granite", "grains of all sizes from `size` down", false},
    [SKF_TEXTURE_ONION] = {"onion", "shells about `at`", false},
    [SKF_TEXTURE_RIPPLES] = {"ripples", "waves about `at` that turn the normal", true},
    [SKF_TEXTURE_BUMPS] = {"bumps", "roughness that turns the normal", true},
    [SKF_TEXTURE_IMAGE] = {"image", "a picture on every primitive, mixed along the surface", false},
};

const skf_texture_info *skf_texture_get(skf_texture_type type) {
  return (unsigned)type < SKF_TEXTURE_COUNT ? textures + type : NULL;
}

static unsigned hash(long x, long y, long z) {
  unsigned h = (unsigned)x * 0x9e3779b1u ^ (unsigned)y * 0x85ebca77u ^ (unsigned)z * 0xc2b2ae3du;
  h = (h ^ h >> 15) * 0x2c1b3c6du, h = (h ^ h >> 12) * 0x297a2d39u;
  return h ^ h >> 15;
}

/* The slope at a corner of the lattice: one of the twelve edges of a cube. */
static skf_vec3 corner(long x, long y, long z) {
  static const signed char edges[12][3] = {{1, 1, 0},  {-1, 1, 0},  {1, -1, 0}, {-1, -1, 0}, {1, 0, 1},  {-1, 0, 1},
                                           {1, 0, -1}, {-1, 0, -1}, {0, 1, 1},  {0, -1, 1},  {0, 1, -1}, {0, -1, -1}};
  const signed char *e = edges[hash(x, y, z) % 12];
  return v3(e[0], e[1], e[2]);
}

static double fade(double t) { return t * t * t * (t * (6 * t - 15) + 10); }
static double fade_slope(double t) { return 30 * t * t * (t - 1) * (t - 1); }

double skf_noise(skf_vec3 p, skf_vec3 *g) {
  const double far = 1e9; /* beyond, the lattice's numbers would overflow: noise repeats there */
  double base[3], f[3], sum = 0, slope[3] = {0, 0, 0};
  for (int k = 0; k < 3; k++) {
    double x = v3_get(p, k);
    if (!(fabs(x) < far)) x = isfinite(x) ? fmod(x, far) : 0;
    base[k] = floor(x), f[k] = x - base[k];
  }
  for (int c = 0; c < 8; c++) {
    int i[3] = {c & 1, c >> 1 & 1, c >> 2};
    skf_vec3 e = corner((long)base[0] + i[0], (long)base[1] + i[1], (long)base[2] + i[2]);
    skf_vec3 d = v3(f[0] - i[0], f[1] - i[1], f[2] - i[2]);
    double w[3], dw[3], h = v3_dot(e, d);
    for (int k = 0; k < 3; k++)
      w[k] = i[k] ? fade(f[k]) : 1 - fade(f[k]), dw[k] = i[k] ? fade_slope(f[k]) : -fade_slope(f[k]);
    sum += w[0] * w[1] * w[2] * h;
    for (int k = 0; k < 3; k++)
      slope[k] += w[0] * w[1] * w[2] * v3_get(e, k) + dw[k] * w[(k + 1) % 3] * w[(k + 2) % 3] * h;
  }
  if (g) *g = v3(slope[0], slope[1], slope[2]);
  return sum;
}

enum { OCTAVES = 5 };

/* Noise of several sizes, each half as wide and half as high as the one before. */
static double rough(skf_vec3 p, bool folded) {
  double sum = 0;
  for (int k = 0; k < OCTAVES; k++) {
    double s = 1 << k, n = skf_noise(v3_scale(s, v3_add(p, v3(0.31 * k, 0.17 * k, 0.23 * k))), NULL);
    sum += (folded ? fabs(n) : n) / s;
  }
  return sum;
}

static skf_vec3 axis_of(const skf_texture *t) {
  skf_vec3 a = v3_unit(t->axis);
  return v3_norm2(a) > 0 ? a : v3(0, 0, 1);
}

/* Where between its two colours a texture is, 0 to 1. */
static double share(const skf_texture *t, skf_vec3 p) {
  skf_vec3 q = v3_scale(1 / t->size, v3_sub(p, t->at)), a = axis_of(t);
  double bend = t->turbulence > 0 ? t->turbulence * rough(q, false) : 0, along = v3_dot(q, a), x;
  switch (t->type) {
  case SKF_TEXTURE_CHECKER: /* shifted a little: floors often lie where cubes meet, and rounding must not tell them */
    return fabs(fmod(floor(q.x + 1e-7) + floor(q.y + 1e-7) + floor(q.z + 1e-7), 2));
  case SKF_TEXTURE_MARBLE: return 0.5 - 0.5 * cos(2 * SKF_PI * (along + bend));
  case SKF_TEXTURE_WOOD:
    x = v3_norm(v3_mad(q, -along, a)) + bend;
    x -= floor(x);
    return x < 0.8 ? x / 0.8 : (1 - x) / 0.2; /* slowly darker, quickly light again */
  case SKF_TEXTURE_ONION: return 0.5 - 0.5 * cos(2 * SKF_PI * (v3_norm(q) + bend));
  case SKF_TEXTURE_GRANITE: return fmin(rough(v3_scale(0.5, q), true), 1);
  default: return 0;
  }
}

/* Between the four nearest pixels; the picture repeats. */
static void pixel(const skf_image *image, double u, double v, double rgb[3]) {
  if (!isfinite(u) || !isfinite(v)) u = v = 0; /* divided by a tiny size */
  double x = (u - floor(u)) * image->width - 0.5, y = (1 - (v - floor(v))) * image->height - 0.5;
  double fx = x - floor(x), fy = y - floor(y);
  for (int k = 0; k < 3; k++) rgb[k] = 0;
  for (int c = 0; c < 4; c++) {
    int i = ((int)floor(x) + (c & 1) + image->width) % image->width;
    int j = ((int)floor(y) + (c >> 1) + image->height) % image->height;
    double w = (c & 1 ? fx : 1 - fx) * (c >> 1 ? fy : 1 - fy);
    for (int k = 0; k < 3; k++) rgb[k] += w * image->rgb[3 * ((size_t)j * image->width + i) + k];
  }
}

void skf_texture_color(const skf_texture *t, skf_vec3 p, const double uv[2], double rgb[3]) {
  if (t->type == SKF_TEXTURE_IMAGE && t->image && t->image->rgb) {
    pixel(t->image, uv[0] / t->size, uv[1] / t->size, rgb);
    return;
  }
  double s = share(t, p);
  for (int k = 0; k < 3; k++) rgb[k] = t->colors[0][k] + s * (t->colors[1][k] - t->colors[0][k]);
}

skf_vec3 skf_texture_relief(const skf_texture *t, skf_vec3 p) {
  skf_vec3 q = v3_scale(1 / t->size, v3_sub(p, t->at)), sum = {0, 0, 0};
  if (t->type == SKF_TEXTURE_RIPPLES) return v3_scale(t->height * cos(2 * SKF_PI * v3_norm(q)), v3_unit(q));
  for (int k = 0; k < 3; k++) { /* the finer ones are lower in proportion: their slopes are alike */
    skf_vec3 g;
    skf_noise(v3_scale(1 << k, v3_add(q, v3(0.31 * k, 0.17 * k, 0.23 * k))), &g);
    sum = v3_mad(sum, 1.0 / (1 + k), g);
  }
  return v3_scale(t->height, sum);
}

static double around(skf_vec3 d, skf_vec3 x, skf_vec3 y) {
  double a = atan2(v3_dot(d, y), v3_dot(d, x)) / (2 * SKF_PI);
  return a < 0 ? a + 1 : a;
}

static void ball_uv(skf_vec3 d, double uv[2]) {
  double r = v3_norm(d);
  uv[0] = around(d, v3(1, 0, 0), v3(0, 1, 0)), uv[1] = r > 0 ? 0.5 + asin(fmin(fmax(d.z / r, -1), 1)) / SKF_PI : 0.5;
}

void skf_texture_inset(const skf_texture *t, skf_shape shape, double uv[2]) {
  if (shape == SKF_PLANE) return; /* it has no ends */
  double size[2] = {t->size / t->image->width, t->size / t->image->height};
  for (int k = shape == SKF_TRIANGLE ? 0 : 1; k < 2; k++)
    uv[k] = fmin(fmax(uv[k], fmin(0.5 * size[k], 0.5)), fmax(1 - 0.5 * size[k], 0.5));
}

/* Beyond an end the picture comes back as in a mirror: no seam there, and nothing is drawn out over a cap. */
static double folded(double x) { return fmin(fabs(x - 2 * round(0.5 * x)), 1); }

static void tube_uv(const skf_arc *a, skf_vec3 at, double uv[2]) {
  skf_vec3 n = v3_unit(a->normal), x = v3_unit(v3_mad(a->start, -v3_dot(a->start, n), n)), y = v3_cross(n, x);
  skf_vec3 d = v3_sub(at, a->center);
  double turn = around(d, x, y) * 2 * SKF_PI, sweep = a->sweep;
  bool past = turn > sweep;
  if (past) turn = turn - sweep < 2 * SKF_PI - turn ? sweep : 0;
  skf_vec3 out = v3_add(v3_scale(cos(turn), x), v3_scale(sin(turn), y)), q = v3_mad(d, -a->radius, out);
  double beyond = past ? v3_dot(q, v3_cross(n, out)) / a->radius : 0; /* the end, straight on */
  uv[0] = around(q, out, n), uv[1] = folded((turn + beyond) / sweep);
}

void skf_primitive_uv(const skf_primitive *p, skf_vec3 at, double uv[2]) {
  const skf_vec3 *v = p->triangle.vertices;
  skf_vec3 d, a, b;
  switch (p->shape) {
  case SKF_POINT: ball_uv(v3_sub(at, p->point.at), uv); break;
  case SKF_SEGMENT:
    a = v3_sub(p->segment.to, p->segment.from), d = v3_sub(at, p->segment.from), b = v3_perp(v3_unit(a));
    uv[0] = around(d, b, v3_cross(v3_unit(a), b)), uv[1] = folded(v3_dot(d, a) / v3_norm2(a));
    break;
  case SKF_ARC: tube_uv(&p->arc, at, uv); break;
  case SKF_TRIANGLE: { /* the foot is v0 + u a + v b */
    a = v3_sub(v[1], v[0]), b = v3_sub(v[2], v[0]), d = v3_sub(at, v[0]);
    double aa = v3_dot(a, a), ab = v3_dot(a, b), bb = v3_dot(b, b), da = v3_dot(d, a), db = v3_dot(d, b);
    double det = aa * bb - ab * ab;
    uv[0] = folded((da * bb - db * ab) / det), uv[1] = folded((db * aa - da * ab) / det);
    break;
  }
  case SKF_PLANE:
    a = v3_perp(v3_unit(p->plane.normal)), b = v3_cross(v3_unit(p->plane.normal), a), d = v3_sub(at, p->plane.through);
    uv[0] = v3_dot(d, a), uv[1] = v3_dot(d, b);
    break;
  default: ball_uv(v3_sub(at, skf_solid_get(p->solid)->center), uv); break;
  }
}
