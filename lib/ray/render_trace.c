/* SPDX-License-Identifier: MIT */
/* What light comes back along a ray, with mirrors and glass on its way. */
#include "ray/render.h"

static void background(const skf_stage *g, const skf_beam *beam, double rgb[3]) {
  double sky[3];
  skf_background(g->s, beam->height >= 0 ? beam->height : skf_view_height(&g->view, beam->direction), rgb);
  if (!beam->mirrored) return;
  skf_sky(&g->view, beam->direction, sky);
  for (int k = 0; k < 3; k++) rgb[k] = fmax(rgb[k], sky[k]);
}

static void light_bounced(const skf_stage *g, const skf_sight *at, const skf_beam *beam, float *lit) {
  bool fine = g->s->quality == SKF_RENDER_FINE, one = beam->scattered;
  bool strong = beam->weight > 0.5;
  skf_light_at(g, at, beam, one ? 1 : fine ? 16 : strong ? 4 : 2, one ? 1 : fine ? 8 : strong ? 3 : 1, lit);
}

static void fog(const skf_stage *g, double t, double rgb[3]) {
  const skf_fog *f = &g->s->fog;
  if (!(f->distance > 0)) return;
  double left = exp(-t / f->distance);
  for (int k = 0; k < 3; k++) rgb[k] = f->color[k] + left * (rgb[k] - f->color[k]);
}

/* Adds what comes from another direction, times a share. */
static void follow(const skf_stage *g, const skf_beam *beam, const skf_sight *at, skf_vec3 direction, bool mirror,
                   const double share[3], double rgb[3]) {
  double most = fmax(share[0], fmax(share[1], share[2])), light[3];
  skf_beam next = *beam;
  next.from = at->at, next.direction = direction, next.height = -1;
  if (!beam->scattered) next.share = -1;
  next.depth++, next.weight *= most, next.mirrored = beam->mirrored || mirror;
  if (!(next.weight > 1.0 / 512)) return; /* less than a step of the picture */
  if (next.depth > g->bounces) {
    background(g, &next, light);
    fog(g, INFINITY, light);
  } else {
    skf_sight there = skf_look_along(g, &next, NULL);
    float lit[SKF_LIT];
    if (there.body != SKF_NOTHING) light_bounced(g, &there, &next, lit);
    skf_radiance(g, &next, &there, lit, light);
  }
  for (int k = 0; k < 3; k++) rgb[k] += share[k] * light[k];
}

/* Mirrors and glass. */
static void beyond(const skf_stage *g, const skf_beam *beam, const skf_sight *at, const skf_look *look, skf_vec3 normal,
                   double rgb[3]) {
  double cosine = -v3_dot(beam->direction, normal), n = at->inside ? look->ior : 1 / look->ior, bent = cosine;
  double fresnel = look->ior == 1 ? 0 : skf_fresnel(cosine, n, &bent), mirror[3], through[3];
  for (int k = 0; k < 3; k++) {
    mirror[k] = (at->inside ? 0 : look->reflection[k]) + look->transparency[k] * fresnel;
    through[k] = look->transparency[k] * (1 - fresnel);
  }
  if (mirror[0] + mirror[1] + mirror[2] > 0) {
    skf_vec3 d = v3_mad(beam->direction, 2 * cosine, normal);
    if (!(v3_dot(d, at->normal) > 0)) /* a relief would send it into the surface */
      d = v3_mad(beam->direction, -2 * v3_dot(beam->direction, at->normal), at->normal);
    follow(g, beam, at, v3_unit(d), true, mirror, rgb);
  }
  if (through[0] + through[1] + through[2] > 0) {
    skf_vec3 d = beam->direction;
    if (look->ior != 1) d = v3_unit(v3_mad(v3_scale(n, d), n * cosine - bent, normal));
    follow(g, beam, at, d, false, through, rgb);
  }
}

/* Surfaces side by side. */
typedef struct company {
  size_t n, of[SKF_SHADED]; /* their beams */
  skf_shaded s[SKF_SHADED];
  skf_look room[SKF_SHADED];
} company;

static void finish(const skf_stage *g, company *c, const skf_beam *beams, double (*rgb)[3]) {
  double out[SKF_SHADED][3];
  if (c->n == 0) return;
  for (size_t i = c->n; i < SKF_SHADED; i++) c->s[i] = c->s[0];
  g->shade(g, c->s, out);
  for (size_t i = 0; i < c->n; i++) {
    const skf_shaded *s = c->s + i;
    double *to = rgb[c->of[i]];
    for (int k = 0; k < 3; k++) to[k] = out[i][k];
    if (g->bounces > 0) beyond(g, beams + c->of[i], s->at, s->look, s->normal, to);
    fog(g, s->at->t, to);
  }
  c->n = 0;
}

/* weights: see skf_palette_look. */
static void join(const skf_stage *g, company *c, size_t of, const skf_beam *beam, const skf_sight *at, const float *lit,
                 const double *weights) {
  skf_shaded *s = c->s + c->n;
  s->at = at, s->lit = lit, s->eye = v3_scale(-1, beam->direction);
  s->look = skf_palette_look(g->palettes[at->body], g->bodies + at->body, at, weights, c->room + c->n, &s->normal);
  if (!(v3_dot(s->normal, s->eye) > 0)) s->normal = at->normal;
  c->of[c->n++] = of;
}

/* The weights of the looks on one body, where it is seen. */
static void weigh(const skf_stage *g, int body, size_t n, const skf_sight *at, double (*weights)[SKF_PARTS],
                  const double **out) {
  size_t which[SKF_MANY], m = 0;
  for (size_t k = 0; k < n; k++)
    if (at[k].body == body) which[m++] = k;
  if (!m || !skf_palette_weigh(g->palettes[body], m, which, at, weights)) return;
  for (size_t i = 0; i < m; i++) out[which[i]] = weights[which[i]];
}

void skf_radiance_many(const skf_stage *g, size_t n, const skf_beam *beams, const skf_sight *at, const float *lit,
                       size_t stride, double (*rgb)[3]) {
  double weights[SKF_MANY][SKF_PARTS];
  const double *known[SKF_MANY] = {NULL};
  for (size_t i = 0; i < g->s->body_count; i++)
    if (g->palettes[i]) weigh(g, (int)i, n, at, weights, known);
  company c;
  c.n = 0;
  for (size_t k = 0; k < n; k++) {
    const float *light = lit + k * stride;
    if (at[k].body >= 0) {
      join(g, &c, k, beams + k, at + k, light, known[k]);
      if (c.n == SKF_SHADED) finish(g, &c, beams, rgb);
      continue;
    }
    background(g, beams + k, rgb[k]);
    if (at[k].body == SKF_GROUND) skf_shade_ground(g, at + k, light, rgb[k]);
    fog(g, at[k].t, rgb[k]);
  }
  finish(g, &c, beams, rgb);
}

void skf_radiance(const skf_stage *g, const skf_beam *beam, const skf_sight *at, const float *lit, double rgb[3]) {
  double out[1][3];
  skf_radiance_many(g, 1, beam, at, lit, 0, out);
  for (int k = 0; k < 3; k++) rgb[k] = out[0][k];
}
