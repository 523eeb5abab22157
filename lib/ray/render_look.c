/* SPDX-License-Identifier: MIT */
/* Materials along a surface: mixed by what each element adds to the field there. */
#include "ray/render.h"
#include "core/alloc.h"
#include "field/some.h"

struct skf_palette {
  size_t n;           /* of parts of the field: one for each look, or for each element of looks with pictures */
  skf_field **fields; /* NULL for a part without elements of positive strength */
  const skf_element **elements; /* of a part with a picture; else NULL */
  unsigned char *look_of;
};

skf_look skf_look_default(void) {
  return (skf_look){
      .color = {0.8, 0.8, 0.8}, .ambient = 1, .diffuse = 1, .specular = {0.04, 0.04, 0.04}, .shine = 10.5, .ior = 1};
}

static bool has_picture(const skf_look *look) {
  for (int i = 0; i < look->texture_count; i++)
    if (look->textures[i].type == SKF_TEXTURE_IMAGE) return true;
  return false;
}

static bool is_clear(const skf_look *l) {
  return l->transparency[0] > 0 || l->transparency[1] > 0 || l->transparency[2] > 0;
}

bool skf_look_is_clear(const skf_render_body *body) {
  for (size_t i = 0; i < body->look_count; i++)
    if (is_clear(body->looks + i)) return true;
  return false;
}

static size_t look_of(const skf_render_body *body, size_t element) {
  return body->look_of && body->look_count > 1 ? body->look_of[element] : 0;
}

static skf_status add_part(skf_palette *p, const skf_element *e, size_t n, size_t look, const skf_element *alone) {
  p->look_of[p->n] = (unsigned char)look, p->elements[p->n] = alone;
  return n ? skf_field_new(e, n, p->fields + p->n++) : (p->n++, SKF_OK);
}

static skf_status fill(skf_palette *p, const skf_render_body *body, skf_element *kept) {
  skf_status s = SKF_OK;
  for (size_t i = 0; i < body->look_count && !s; i++) {
    size_t n = 0;
    bool picture = has_picture(body->looks + i);
    for (size_t k = 0; k < body->element_count && !s; k++) {
      if (look_of(body, k) != i || !(body->elements[k].strength > 0)) continue;
      kept[n++] = body->elements[k];
      if (picture) s = add_part(p, body->elements + k, 1, i, body->elements + k), n = 0;
    }
    if (!picture && !s) s = add_part(p, kept, n, i, NULL);
  }
  return s;
}

skf_status skf_palette_new(const skf_render_body *body, skf_palette **out) {
  bool pictures = false;
  *out = NULL;
  for (size_t i = 0; i < body->look_count; i++) pictures = pictures || has_picture(body->looks + i);
  if (body->offsets || !body->elements || (body->look_count < 2 && !pictures)) return SKF_OK;
  size_t most = body->look_count + body->element_count;
  skf_palette *p = skf_alloc(1, sizeof *p);
  skf_element *kept = skf_alloc(body->element_count, sizeof *kept);
  skf_status s = p && kept ? SKF_OK : SKF_ERR_NOMEM;
  if (p) {
    p->fields = skf_alloc(most, sizeof *p->fields);
    p->elements = skf_alloc(most, sizeof *p->elements);
    p->look_of = skf_alloc(most, 1);
    if (!p->fields || !p->elements || !p->look_of) s = SKF_ERR_NOMEM;
  }
  if (!s) s = fill(p, body, kept);
  skf_free(kept);
  if (s) skf_palette_free(p), p = NULL;
  *out = p;
  return s;
}

void skf_palette_free(skf_palette *p) {
  if (!p) return;
  for (size_t i = 0; p->fields && i < p->n; i++) skf_field_free(p->fields[i]);
  skf_free(p->fields), skf_free(p->elements), skf_free(p->look_of);
  skf_free(p);
}

/* The textures of a look at one place, on one primitive; adds to the relief's gradient. */
static void dress(skf_look *look, skf_vec3 at, const skf_primitive *on, double share, skf_vec3 *relief) {
  bool first = true;
  double uv[2] = {0, 0};
  if (on && has_picture(look)) skf_primitive_uv(on, at, uv);
  for (int i = 0; i < look->texture_count; i++) {
    const skf_texture *t = look->textures + i;
    if (skf_texture_get(t->type)->relief) {
      *relief = v3_mad(*relief, share, skf_texture_relief(t, at));
      continue;
    }
    double rgb[3], place[2] = {uv[0], uv[1]};
    if (on && t->type == SKF_TEXTURE_IMAGE) skf_texture_inset(t, on->shape, place);
    skf_texture_color(t, at, place, rgb);
    for (int k = 0; k < 3; k++) look->color[k] = first ? rgb[k] : look->color[k] * rgb[k];
    first = false;
  }
}

static void add_share(skf_look *to, double share, const skf_look *from) {
  for (int k = 0; k < 3; k++) {
    to->color[k] += share * from->color[k], to->specular[k] += share * from->specular[k];
    to->reflection[k] += share * from->reflection[k], to->transparency[k] += share * from->transparency[k];
  }
  to->ambient += share * from->ambient, to->diffuse += share * from->diffuse;
  to->shine += share * from->shine, to->ior += share * from->ior;
}

static void divide(skf_look *look, double by) {
  for (int k = 0; k < 3; k++) {
    look->color[k] /= by, look->specular[k] /= by;
    look->reflection[k] /= by, look->transparency[k] /= by;
  }
  look->ambient /= by, look->diffuse /= by, look->shine /= by, look->ior /= by;
}

/* A part counts where it is positive. */
static double count(double f) { return f > 0 ? fmin(f, 1e200) : 0; }

static void weigh_part(const skf_field *field, size_t n, const size_t *which, const skf_sight *sights, double *out) {
  double at[3][SKF_MANY], *const F[4] = {out, NULL, NULL, NULL};
  if (n == 0) return;
  for (size_t i = 0; i < n; i++) {
    skf_vec3 p = sights[which[i]].own;
    at[0][i] = p.x, at[1][i] = p.y, at[2][i] = p.z;
  }
  const double *const p[3] = {at[0], at[1], at[2]};
  if (skf_field_is_direct(field)) {
    skf_field_serial(field, n, p, F);
    return;
  }
  for (size_t i = 0; i < n; i++) out[i] = skf_field_at(field, sights[which[i]].own, NULL);
}

bool skf_palette_weigh(const skf_palette *p, size_t n, const size_t *which, const skf_sight *sights,
                       double (*weights)[SKF_PARTS]) {
  if (p->n > SKF_PARTS) return false;
  for (size_t k = 0; k < p->n; k++) {
    double f[SKF_MANY] = {0};
    if (p->fields[k]) weigh_part(p->fields[k], n, which, sights, f);
    for (size_t i = 0; i < n; i++) weights[which[i]][k] = count(f[i]);
  }
  return true;
}

/* Each part's look by its share of the sum of all. Without any field there, the first look. Of many parts nobody keeps
   the weights. */
static void mix(const skf_palette *p, const skf_render_body *body, skf_vec3 at, const double *weights, skf_look *look,
                skf_vec3 *relief) {
  double sum = 0;
  *look = (skf_look){.texture_count = 0};
  for (size_t i = 0; i < p->n; i++) {
    double weight = weights ? weights[i] : p->fields[i] ? count(skf_field_at(p->fields[i], at, NULL)) : 0;
    if (!(weight > 0)) continue;
    const skf_look *part = body->looks + p->look_of[i];
    skf_look dressed;
    if (part->texture_count) {
      dressed = *part;
      dress(&dressed, at, p->elements[i] ? &p->elements[i]->primitive : NULL, weight, relief);
      part = &dressed;
    }
    add_share(look, weight, part);
    sum += weight;
  }
  if (!(sum > 0))
    *look = body->looks[0];
  else
    divide(look, sum), *relief = v3(relief->x / sum, relief->y / sum, relief->z / sum);
}

const skf_look *skf_palette_at(const skf_palette *p, const skf_render_body *body, const skf_sight *at, skf_look *room,
                               skf_vec3 *normal) {
  const size_t first = 0;
  double weights[1][SKF_PARTS];
  bool known = p && skf_palette_weigh(p, 1, &first, at, weights);
  return skf_palette_look(p, body, at, known ? weights[0] : NULL, room, normal);
}

const skf_look *skf_palette_look(const skf_palette *p, const skf_render_body *body, const skf_sight *at,
                                 const double *weights, skf_look *room, skf_vec3 *normal) {
  skf_vec3 relief = {0, 0, 0};
  const skf_look *look = room;
  if (normal) *normal = at->normal;
  if (p) {
    mix(p, body, at->own, weights, room, &relief);
  } else {
    bool one = body->offsets && body->elements;
    look = body->looks + (body->offsets && body->look_of ? look_of(body, at->item) : 0);
    if (!look->texture_count) return look;
    *room = *look, look = room;
    dress(room, at->own, one ? &body->elements[at->item].primitive : NULL, 1, &relief);
  }
  if (!normal || v3_norm2(relief) == 0) return look;
  relief = skf_body_world(body, at->time, relief);
  relief = v3_mad(relief, -v3_dot(relief, at->normal), at->normal);
  *normal = v3_unit(v3_mad(at->normal, at->inside ? 1 : -1, relief));
  return look;
}

/* A turn about a unit vector; the zero vector: none. */
typedef struct turning {
  skf_vec3 axis;
  double cosine, sine;
} turning;

static turning turn_at(const skf_render_body *b, double time) {
  double angle = b->angle + time * b->sweep;
  if (angle == 0) return (turning){{0, 0, 0}, 1, 0};
  return (turning){v3_unit(b->axis), cos(angle), sin(angle)};
}

static skf_vec3 turn(const turning *t, double sine, skf_vec3 v) {
  skf_vec3 k = t->axis, across = v3_mad(v3_scale(t->cosine, v), sine, v3_cross(k, v));
  if (v3_norm2(k) == 0) return v;
  return v3_mad(across, v3_dot(k, v) * (1 - t->cosine), k); /* Rodrigues */
}

void skf_body_own(const skf_render_body *b, double time, skf_vec3 *place, skf_vec3 *direction) {
  turning t = turn_at(b, time);
  *place = v3_add(turn(&t, -t.sine, v3_sub(v3_sub(*place, b->shift), b->about)), b->about);
  *direction = turn(&t, -t.sine, *direction);
}

skf_vec3 skf_body_world(const skf_render_body *b, double time, skf_vec3 direction) {
  turning t = turn_at(b, time);
  return turn(&t, t.sine, direction);
}
