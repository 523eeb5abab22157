/* SPDX-License-Identifier: MIT */
/* Light on surfaces: a matt body under a thin gloss [Walter et al. 2007, the GGX distribution], a sky of two colours.
 */
#include "ray/render.h"

static const double sky_above[3] = {0.26, 0.30, 0.38}, sky_below[3] = {0.10, 0.09, 0.08};

bool skf_light_is_hard(const skf_light *l) {
  if (l->directional) return l->radius < 0;
  return !(l->radius > 0) && v3_norm2(l->u) == 0 && v3_norm2(l->v) == 0;
}

/* Half the angle that directional lights span which say nothing: 2 degrees. */
static const double light_radius = 0.035;

skf_vec3 skf_light_sample(const skf_light *l, skf_vec3 at, double a, double b, double *distance) {
  skf_vec3 to = skf_light_direction(l, at, distance), place = l->at;
  if (skf_light_is_hard(l)) return to;
  double out = sqrt(a), turn = 2 * SKF_PI * b, size = l->radius;
  if (l->directional) size = tan(size > 0 ? fmin(size, 1.5) : light_radius);
  skf_vec3 x = v3_perp(to), y = v3_cross(to, x);
  if (v3_norm2(l->u) > 0 || v3_norm2(l->v) > 0)
    place = v3_mad(v3_mad(place, a - 0.5, l->u), b - 0.5, l->v);
  else /* the disc that the ball shows */
    place = v3_mad(v3_mad(l->directional ? to : place, size * out * cos(turn), x), size * out * sin(turn), y);
  if (l->directional) return v3_unit(place);
  skf_vec3 way = v3_sub(place, at);
  *distance = v3_norm(way);
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

void skf_sky(const skf_view *view, skf_vec3 direction, double rgb[3]) {
  double above = 0.5 + 0.5 * v3_dot(direction, view->up);
  for (int k = 0; k < 3; k++) rgb[k] = sky_below[k] + above * (sky_above[k] - sky_below[k]);
}

/* GGX with Smith's shadowing and Schlick's Fresnel term, times cos(light) pi; adds to rgb. */
static void add_gloss(const skf_look *look, skf_vec3 n, skf_vec3 to_light, skf_vec3 to_eye, const double light[3],
                      double rgb[3]) {
  double a2 = 2 / (look->shine + 2); /* the square of GGX's alpha */
  skf_vec3 half = v3_add(to_light, to_eye);
  double length = v3_norm(half), per = length > 1e-100 ? 1 / length : 0;
  double nl = v3_dot(n, to_light), ne = v3_dot(n, to_eye), nh = v3_dot(n, half) * per, eh = v3_dot(to_eye, half) * per;
  if (!(ne > 1e-4)) ne = 1e-4;
  if (!(eh > 0)) eh = 0;
  double d = nh * nh * a2 + (1 - nh * nh), f = 1 - eh, f5 = f * f * f * f * f;
  double smith = nl * sqrt(ne * ne * (1 - a2) + a2) + ne * sqrt(nl * nl * (1 - a2) + a2);
  double lobe = a2 * nl / (d * d * 2 * smith);
  for (int k = 0; k < 3; k++)
    if (look->specular[k] > 0) rgb[k] += light[k] * lobe * (look->specular[k] + (1 - look->specular[k]) * f5);
}

void skf_shade_ground(const skf_stage *g, const skf_sight *at, const float *lit, double rgb[3]) {
  for (int k = 0; k < 3; k++) {
    double full = 0.6, seen = 0.6 * lit[0], unused; /* the sky's part in the light on the floor */
    for (size_t l = 0; l < g->light_count; l++) {
      double c =
          fmax(v3_dot(at->normal, skf_light_direction(g->lights + l, at->at, &unused)), 0) * g->lights[l].color[1];
      full += c, seen += c * lit[1 + 3 * l + k];
    }
    rgb[k] *= seen / full;
  }
}

void skf_shade(const skf_stage *g, const skf_look *look, const skf_sight *at, skf_vec3 normal, skf_vec3 eye,
               const float *lit, double rgb[3]) {
  double sky[3], matt[3] = {0, 0, 0}, gloss[3] = {0, 0, 0};
  bool glossy = look->specular[0] > 0 || look->specular[1] > 0 || look->specular[2] > 0;
  bool through = g->bounces > 0; /* else nothing stands for what is behind it */
  skf_sky(&g->view, normal, sky);
  for (size_t l = 0; l < g->light_count; l++) {
    double unused, light[3];
    skf_vec3 to = skf_light_direction(g->lights + l, at->at, &unused);
    double c = v3_dot(normal, to);
    if (!(c > 0)) continue;
    for (int k = 0; k < 3; k++) light[k] = lit[1 + 3 * l + k] * g->lights[l].color[k];
    if (!(light[0] + light[1] + light[2] > 0)) continue;
    for (int k = 0; k < 3; k++) matt[k] += light[k] * c;
    if (glossy) add_gloss(look, normal, to, eye, light, gloss);
  }
  for (int k = 0; k < 3; k++) {
    double all = look->color[k] * (look->ambient * lit[0] * sky[k] + look->diffuse * matt[k]);
    rgb[k] = (through ? 1 - look->transparency[k] : 1) * all + gloss[k];
  }
}

double skf_fresnel(double cosine, double n, double *bent) {
  double sine2 = n * n * (1 - cosine * cosine);
  if (sine2 >= 1) return 1;
  double c = *bent = sqrt(1 - sine2);
  double across = (n * cosine - c) / (n * cosine + c), along = (cosine - n * c) / (cosine + n * c);
  return (across * across + along * along) / 2;
}
