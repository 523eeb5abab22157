/* SPDX-License-Identifier: MIT */
/* Light on surfaces, and a sky of two colours. */
#include "ray/render_shade_lanes.h"
#include "simd/isa.h"

const double skf_sky_above[3] = {0.26, 0.30, 0.38}, skf_sky_below[3] = {0.10, 0.09, 0.08};

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
  for (int k = 0; k < 3; k++) rgb[k] = skf_sky_below[k] + above * (skf_sky_above[k] - skf_sky_below[k]);
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

void skf_shade_scalar(const skf_stage *g, const skf_shaded s[SKF_SHADED], double (*rgb)[3]) { shade_lanes(g, s, rgb); }

skf_shade_fn *skf_shade_pick(void) {
#ifdef SKF_HAVE_AVX2
  if (skf_isa_pick() != SKF_ISA_SCALAR) return skf_shade_avx2;
#endif
  return skf_shade_scalar;
}

double skf_fresnel(double cosine, double n, double *bent) {
  double sine2 = n * n * (1 - cosine * cosine);
  if (sine2 >= 1) return 1;
  double c = *bent = sqrt(1 - sine2);
  double across = (n * cosine - c) / (n * cosine + c), along = (cosine - n * c) / (cosine + n * c);
  return (across * across + along * along) / 2;
}
