/* SPDX-License-Identifier: MIT */
/* Light on surfaces: a matt body under a thin gloss [Walter et al. 2007, the GGX distribution], a sky of two colours.
 */
#include "ray/render.h"

static const double sky_above[3] = {0.26, 0.30, 0.38}, sky_below[3] = {0.10, 0.09, 0.08};
static const double roughness2 = 0.16; /* the square of GGX's alpha = 0.4: a satin look */
static const double facing = 0.04;     /* share that a dielectric surface reflects when seen from the front */

skf_vec3 skf_light_direction(const skf_light *light, skf_vec3 at, double *distance) {
  skf_vec3 way = light->directional ? light->at : v3_sub(light->at, at);
  *distance = light->directional ? INFINITY : v3_norm(way);
  return v3_unit(way);
}

static skf_vec3 mixed(const skf_view *v, double right, double up, double back) {
  return v3_mad(v3_mad(v3_scale(-back, v->forward), up, v->up), right, v->right);
}

void skf_lights_default(const skf_view *v, skf_light out[3]) {
  out[0] = (skf_light){true, mixed(v, -0.75, 0.85, 0.75), {0.80, 0.76, 0.69}}; /* key: warm, from the upper left */
  out[1] = (skf_light){true, mixed(v, 0.9, 0.15, 0.6), {0.12, 0.14, 0.19}};    /* fill: weak and cool */
  out[2] = (skf_light){true, mixed(v, 0.35, 0.45, -0.9), {0.30, 0.34, 0.42}};  /* rim: from behind */
}

void skf_background(const skf_render_scene *s, double up, double rgb[3]) {
  for (int k = 0; k < 3; k++) rgb[k] = s->background[0][k] + up * (s->background[1][k] - s->background[0][k]);
}

/* GGX with Smith's shadowing and Schlick's Fresnel term, times cos(light) pi. */
static double gloss(skf_vec3 n, skf_vec3 to_light, skf_vec3 to_eye) {
  skf_vec3 h = v3_unit(v3_add(to_light, to_eye));
  double nl = v3_dot(n, to_light), ne = fmax(v3_dot(n, to_eye), 1e-4), nh = v3_dot(n, h),
         eh = fmax(v3_dot(to_eye, h), 0);
  double d = nh * nh * (roughness2 - 1) + 1, f = 1 - eh;
  double fresnel = facing + (1 - facing) * f * f * f * f * f;
  double smith =
      nl * sqrt(ne * ne * (1 - roughness2) + roughness2) + ne * sqrt(nl * nl * (1 - roughness2) + roughness2);
  return roughness2 / (d * d) * fresnel * nl / (2 * smith);
}

static void shade_ground(const skf_render_scene *s, const skf_light *lights, size_t n, const skf_sight *at,
                         const skf_lit *lit, double up, double rgb[3]) {
  double full = 0.6, seen = 0.6 * lit->sky, unused; /* the sky's part in the light on the floor */
  for (size_t k = 0; k < n; k++) {
    double c = fmax(v3_dot(at->normal, skf_light_direction(lights + k, at->at, &unused)), 0) * lights[k].color[1];
    full += c, seen += c * lit->light[k];
  }
  skf_background(s, up, rgb);
  for (int k = 0; k < 3; k++) rgb[k] *= seen / full;
}

void skf_shade(const skf_render_scene *s, const skf_light *lights, size_t n, const skf_view *view, const skf_sight *at,
               const skf_lit *lit, double up, double rgb[3]) {
  if (at->body == SKF_NOTHING) {
    skf_background(s, up, rgb);
    return;
  }
  if (at->body == SKF_GROUND) {
    shade_ground(s, lights, n, at, lit, up, rgb);
    return;
  }
  const double *color = s->bodies[at->body].color;
  skf_vec3 eye = v3_unit(v3_sub(view->from, at->at));
  double above = 0.5 + 0.5 * v3_dot(at->normal, view->up);
  for (int k = 0; k < 3; k++) rgb[k] = color[k] * lit->sky * (sky_below[k] + above * (sky_above[k] - sky_below[k]));
  for (size_t l = 0; l < n; l++) {
    double unused;
    skf_vec3 to = skf_light_direction(lights + l, at->at, &unused);
    double c = v3_dot(at->normal, to);
    if (!(c > 0) || !(lit->light[l] > 0)) continue;
    double shine = gloss(at->normal, to, eye);
    for (int k = 0; k < 3; k++) rgb[k] += lit->light[l] * lights[l].color[k] * (c * color[k] + shine);
  }
}

static double press(double x) { return x <= 0.7 ? fmax(x, 0) : 1 - 0.3 * exp((0.7 - x) / 0.3); }

void skf_render_srgb(const float *rgb, int width, size_t n, unsigned char *out) {
  for (size_t i = 0; i < n; i++) {
    /* Noise of half a step, by a hash of the pixel's place. */
    unsigned h = (unsigned)(i % (size_t)width) * 73856093u ^ (unsigned)(i / (size_t)width) * 19349663u;
    h = (h ^ h >> 15) * 0x2c1b3c6du, h = (h ^ h >> 12) * 0x297a2d39u, h ^= h >> 15;
    double noise = h / 4294967296.0 - 0.5;
    for (int k = 0; k < 3; k++) {
      double x = press(rgb[3 * i + k]);
      double v = x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;
      out[3 * i + k] = (unsigned char)fmin(fmax(floor(255 * v + 0.5 + noise), 0), 255);
    }
  }
}
