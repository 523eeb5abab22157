/* SPDX-License-Identifier: MIT */
/* The light that places side by side send back: a matt body under a thin gloss [Walter et al. 2007, the GGX
   distribution]. Each lane has the bits that it has alone. */
#ifndef SKF_RAY_RENDER_SHADE_LANES_H
#define SKF_RAY_RENDER_SHADE_LANES_H

#include "ray/render.h"
#include "simd/vec.h"

_Static_assert((int)SKF_SHADED == (int)SKF_LANES, "as many places as lanes");

typedef struct lanes3 {
  skf_vd x, y, z;
} lanes3;

SKF_INLINE skf_vd lanes_dot(lanes3 a, lanes3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

SKF_INLINE lanes3 lanes_gather(const skf_vec3 v[SKF_LANES]) {
  double x[SKF_LANES], y[SKF_LANES], z[SKF_LANES];
  for (int i = 0; i < SKF_LANES; i++) x[i] = v[i].x, y[i] = v[i].y, z[i] = v[i].z;
  return (lanes3){vd_load(x), vd_load(y), vd_load(z)};
}

/* Places side by side, and whether they share their looks and their light, as most do. */
typedef struct lanes_places {
  const skf_shaded *s;
  bool one_look, one_light;
  skf_vd gloss[3], a2; /* the looks' gloss, and the square of GGX's alpha */
  lanes3 normal, eye;
} lanes_places;

/* A number of each look's, so far into it. */
SKF_INLINE skf_vd of_looks(const lanes_places *p, size_t offset) {
  double v[SKF_LANES];
  for (int i = 0; i < (p->one_look ? 1 : SKF_LANES); i++) memcpy(v + i, (const char *)p->s[i].look + offset, sizeof *v);
  return p->one_look ? vd_set(v[0]) : vd_load(v);
}
#define OF_LOOKS(p, member) of_looks(p, offsetof(skf_look, member))

SKF_INLINE skf_vd of_light(const lanes_places *p, size_t k) {
  double v[SKF_LANES];
  for (int i = 0; i < (p->one_light ? 1 : SKF_LANES); i++) v[i] = p->s[i].lit[k];
  return p->one_light ? vd_set(v[0]) : vd_load(v);
}

SKF_INLINE lanes3 to_light(const lanes_places *p, const skf_light *light) {
  double unused;
  skf_vec3 to[SKF_LANES];
  if (light->directional) return (lanes3){vd_set(light->at.x), vd_set(light->at.y), vd_set(light->at.z)};
  for (int i = 0; i < SKF_LANES; i++) to[i] = skf_light_direction(light, p->s[i].at->at, &unused);
  return lanes_gather(to);
}

/* GGX with Smith's shadowing and Schlick's Fresnel term, times cos(light) pi; adds to rgb where `on`. */
SKF_INLINE void add_gloss(const lanes_places *p, lanes3 to, skf_vd nl, const skf_vd light[3], skf_vi on,
                          skf_vd rgb[3]) {
  skf_vd zero = vd_set(0), one = vd_set(1), two = vd_set(2), a2 = p->a2;
  lanes3 half = {to.x + p->eye.x, to.y + p->eye.y, to.z + p->eye.z};
  skf_vd length = vd_sqrt(lanes_dot(half, half)), per = vd_select(length > vd_set(1e-100), one / length, zero);
  skf_vd ne = lanes_dot(p->normal, p->eye), nh = lanes_dot(p->normal, half) * per, eh = lanes_dot(p->eye, half) * per;
  ne = vd_select(ne > vd_set(1e-4), ne, vd_set(1e-4)), eh = vd_select(eh > zero, eh, zero);
  skf_vd d = nh * nh * a2 + (one - nh * nh), f = one - eh, f5 = f * f * f * f * f;
  skf_vd smith = nl * vd_sqrt(ne * ne * (one - a2) + a2) + ne * vd_sqrt(nl * nl * (one - a2) + a2);
  skf_vd lobe = a2 * nl / (d * d * two * smith);
  for (int k = 0; k < 3; k++) {
    skf_vd more = light[k] * lobe * (p->gloss[k] + (one - p->gloss[k]) * f5);
    rgb[k] += vd_select(on & (p->gloss[k] > zero), more, zero);
  }
}

SKF_INLINE void add_lights(const skf_stage *g, const lanes_places *p, skf_vd matt[3], skf_vd gloss[3]) {
  skf_vd zero = vd_set(0);
  bool glossy = vi_any((p->gloss[0] > zero) | (p->gloss[1] > zero) | (p->gloss[2] > zero));
  for (size_t l = 0; l < g->light_count; l++) {
    skf_vd light[3];
    lanes3 to = to_light(p, g->lights + l);
    skf_vd c = lanes_dot(p->normal, to);
    if (!vi_any(c > zero)) continue;
    for (size_t k = 0; k < 3; k++) light[k] = of_light(p, 1 + 3 * l + k) * vd_set(g->lights[l].color[k]);
    skf_vi on = (c > zero) & (light[0] + light[1] + light[2] > zero);
    if (!vi_any(on)) continue;
    for (int k = 0; k < 3; k++) matt[k] += vd_select(on, light[k] * c, zero);
    if (glossy) add_gloss(p, to, c, light, on, gloss);
  }
}

SKF_INLINE void shade_lanes(const skf_stage *g, const skf_shaded s[SKF_LANES], double (*rgb)[3]) {
  skf_vd zero = vd_set(0), one = vd_set(1), matt[3] = {zero, zero, zero}, gloss[3] = {zero, zero, zero};
  lanes_places p = {.s = s, .one_look = true, .one_light = true};
  skf_vec3 normal[SKF_LANES], eye[SKF_LANES];
  for (int i = 0; i < SKF_LANES; i++) {
    p.one_look &= s[i].look == s[0].look, p.one_light &= s[i].lit == s[0].lit;
    normal[i] = s[i].normal, eye[i] = s[i].eye;
  }
  p.normal = lanes_gather(normal), p.eye = lanes_gather(eye);
  p.a2 = vd_set(2) / (OF_LOOKS(&p, shine) + vd_set(2));
  for (size_t k = 0; k < 3; k++) p.gloss[k] = of_looks(&p, offsetof(skf_look, specular) + k * sizeof(double));
  add_lights(g, &p, matt, gloss);
  skf_vec3 up = g->view.up;
  skf_vd above = vd_set(0.5) + vd_set(0.5) * lanes_dot(p.normal, (lanes3){vd_set(up.x), vd_set(up.y), vd_set(up.z)});
  for (size_t k = 0; k < 3; k++) {
    double out[SKF_LANES];
    skf_vd sky = vd_set(skf_sky_below[k]) + above * vd_set(skf_sky_above[k] - skf_sky_below[k]);
    skf_vd color = of_looks(&p, offsetof(skf_look, color) + k * sizeof(double)),
           clear = of_looks(&p, offsetof(skf_look, transparency) + k * sizeof(double));
    skf_vd all = color * (OF_LOOKS(&p, ambient) * of_light(&p, 0) * sky + OF_LOOKS(&p, diffuse) * matt[k]);
    if (g->bounces > 0) all = (one - clear) * all; /* else nothing stands for what is behind it */
    vd_store(out, all + gloss[k]);
    for (int i = 0; i < SKF_LANES; i++) rgb[i][k] = out[i];
  }
}

#endif
