/* SPDX-License-Identifier: MIT */
/* Tracers: a field made ready for rays. */
#include "core/alloc.h"
#include "core/vec3.h"
#include "field/envelope.h"
#include "ray/rescale.h"
#include "ray/walk.h"
#include <float.h>
#include <stdint.h>

static bool is_linear(const skf_element *e) { return e->primitive.shape == SKF_PLANE && e->kernel.type == SKF_INVERSE; }

/* +-1: the sign of strength times profile; 0: both signs. */
static int sign_of(skf_weight_range w) { return w.lo >= 0 ? 1 : w.hi <= 0 ? -1 : 0; }

/* The profile plus a constant; the caller frees its knots. */
static skf_status raise(const skf_profile *p, double by, skf_profile *out) {
  *out = *p;
  out->ends[0] += by, out->ends[1] += by; /* no other profile without knots has both signs */
  if (!p->knot_count) return SKF_OK;
  skf_profile_knot *k = skf_alloc(p->knot_count, sizeof *k);
  for (size_t i = 0; k && i < p->knot_count; i++) k[i] = p->knots[i], k[i].value += by;
  out->knots = k;
  return k ? SKF_OK : SKF_ERR_NOMEM;
}

/* The part of an element whose weight has the sign: all, nothing, or of one with both signs what is above its least
   weight, and this weight. */
static skf_status take_part(skf_element *e, int sign, skf_profile *raised, bool *taken) {
  skf_weight_range w = skf_element_weights(e);
  int own = sign_of(w);
  *taken = !is_linear(e) && e->strength != 0 && (own == sign || own == 0);
  if (!*taken || own) return SKF_OK;
  const skf_profile *p = e->profile;
  e->profile = sign > 0 ? raised : NULL;
  if (sign < 0) e->strength = w.lo;
  return sign > 0 ? raise(p, -w.lo / e->strength, raised) : SKF_OK;
}

/* What of a field has the given sign; planes that are linear along rays are left out. */
static skf_status subfield(const skf_field *field, int sign, skf_field **out) {
  size_t n = skf_field_size(field), k = 0;
  skf_element *e = skf_alloc(n, sizeof *e);
  skf_profile *raised = skf_alloc(n, sizeof *raised);
  skf_status s = e && raised ? SKF_OK : SKF_ERR_NOMEM;
  for (size_t i = 0; i < n && !s; i++) {
    bool taken;
    e[k] = *skf_field_element(field, i);
    s = take_part(e + k, sign, raised + i, &taken);
    k += taken;
  }
  if (!s) s = skf_field_new(e, k, out);
  for (size_t i = 0; raised && i < n; i++) skf_free((void *)(uintptr_t)raised[i].knots);
  skf_free(raised), skf_free(e);
  return s;
}

/* Many blobs: the octree trims what sticks out of this at once. */
static bool reach_of_blobs(const skf_tracer *t, skf_box *out) {
  enum { MANY = 40 };
  *out = box_empty();
  if (!(t->iso > 0) || t->n < MANY) return false;
  for (size_t i = 0; i < t->n; i++) {
    const skf_blob *b = t->blobs + i;
    if (!(b->per > 0)) return false;
    skf_box ends = {b->at, b->at};
    if (b->length > 0) ends = skf_primitive_bounds(&t->sources[i].element.primitive);
    *out = box_join(*out, box_grow(ends, b->R));
  }
  return true;
}

/* Where the surface can be: iso < 0 is the surface of the negated field. */
static skf_status find_region(skf_tracer *t) {
  if (reach_of_blobs(t, &t->region)) {
    t->reach = SKF_OK;
  } else if (t->iso >= 0) {
    t->reach = skf_field_region(t->field, t->iso, &t->region);
  } else {
    skf_field *f;
    skf_status s = skf_field_negative(t->field, &f);
    if (s) return s;
    t->reach = skf_field_region(f, -t->iso, &t->region);
    skf_field_free(f);
  }
  if (t->reach != SKF_OK) return t->reach == SKF_ERR_EMPTY || t->reach == SKF_ERR_UNBOUNDED ? SKF_OK : t->reach;
  t->region = box_grow(t->region, 1e-9 * box_diagonal(t->region));
  return SKF_OK;
}

static void add_sources(skf_tracer *t, bool linear, int *first, bool *mixed) {
  for (size_t i = 0; i < skf_field_size(t->field); i++) {
    const skf_element *e = skf_field_element(t->field, i);
    if (e->strength == 0 || is_linear(e) != linear) continue;
    skf_pair_info pair = skf_pair_get(e->kernel.type, e->primitive.shape);
    if (!pair.closed) t->noise = fmax(t->noise, pair.error);     /* adaptive quadrature is not smooth */
    if (e->profile) t->noise = fmax(t->noise, 32 * DBL_EPSILON); /* of the sums over its nodes */
    if (e->primitive.shape == SKF_SOLID) t->noise = fmax(t->noise, 32 * DBL_EPSILON); /* long sums */
    skf_source_init(e, t->sources + t->n);
    int sign = sign_of((skf_weight_range){t->sources[t->n].least, t->sources[t->n].most});
    *mixed = *mixed || linear || !sign || sign * *first < 0;
    *first = sign;
    t->n++;
  }
  if (linear) t->linear = t->n;
}

/* Terms of both signs within one element: the sum of the elements' magnitudes is not that of the terms. */
static bool hides_signs(const skf_tracer *t) {
  for (size_t i = 0; i < t->n; i++)
    if (t->sources[i].least < 0 && t->sources[i].most > 0) return true;
  return false;
}

static skf_status fill(skf_tracer *t) {
  bool mixed = false;
  int first = 0;
  skf_status s;
  t->sources = skf_alloc(skf_field_size(t->field), sizeof *t->sources);
  if (!t->sources) return SKF_ERR_NOMEM;
  add_sources(t, true, &first, &mixed), add_sources(t, false, &first, &mixed);
  if (mixed && ((s = subfield(t->field, 1, &t->plus)) || (s = subfield(t->field, -1, &t->minus)))) return s;
  if (!(t->blobs = skf_alloc(t->n, sizeof *t->blobs))) return SKF_ERR_NOMEM;
  for (size_t i = 0; i < t->n; i++) {
    t->blobs[i] = skf_blob_of(&t->sources[i].element);
    if (t->blobs[i].per > 0) t->blobs[i].quiet = skf_blob_quiet(t->blobs + i, t->iso);
  }
  s = find_region(t);
  /* the octree takes sources for elements: none may have been left out */
  if (s || t->reach != SKF_OK || t->linear || t->n != skf_field_size(t->field) || hides_signs(t)) return s;
  return skf_octree_new(t->field, t->sources, t->blobs, t->n, t->iso, t->noise, t->region, &t->tree);
}

/* Of rays that start this many diagonals of the region away, rounding of the places would blur the surface. */
#define FAR 4096

static void set_middle(skf_tracer *t) {
  double far = FAR * box_diagonal(t->region);
  t->far2 = t->reach == SKF_OK && far > 0 ? far * far : INFINITY;
  t->middle = t->reach == SKF_OK ? box_center(t->region) : v3(0, 0, 0);
}

static skf_status set_copy(skf_tracer *t) {
  double iso;
  skf_status s = skf_rescale(t->field, t->iso, &t->power, &iso, &t->copied);
  if (s || !t->power) return s;
  s = skf_tracer_new_with(t->copied, iso, &(skf_tracer_options){.normals = t->normals}, &t->copy);
  if (!s && t->copy->copy) s = SKF_ERR_RANGE; /* cannot be: its size is about 1 */
  return s;
}

/* Squares of distances must not overflow. */
static bool is_in_range(const skf_field *f) {
  const double farthest = 3e153;
  for (size_t i = 0; i < skf_field_size(f); i++) {
    const skf_primitive *p = &skf_field_element(f, i)->primitive;
    skf_box b = skf_primitive_bounds(p);
    if (p->shape == SKF_PLANE) b.lo = b.hi = p->plane.through;
    for (int k = 0; k < 3; k++)
      if (!(v3_get(b.lo, k) >= -farthest && v3_get(b.hi, k) <= farthest)) return false;
  }
  return true;
}

skf_status skf_tracer_new(const skf_field *field, double iso, skf_tracer **out) {
  return skf_tracer_new_with(field, iso, NULL, out);
}

skf_status skf_tracer_new_with(const skf_field *field, double iso, const skf_tracer_options *options,
                               skf_tracer **out) {
  double normals = options ? options->normals : 0;
  *out = NULL;
  if (!isfinite(iso) || !(normals >= 0 && normals <= 1e-3)) return SKF_ERR_ARG;
  if (!skf_field_has_bound(field, NULL)) return SKF_ERR_UNSUPPORTED;
  if (!is_in_range(field)) return SKF_ERR_RANGE;
  skf_tracer *t = skf_alloc(1, sizeof *t);
  if (!t) return SKF_ERR_NOMEM;
  t->field = field, t->iso = iso, t->normals = normals, t->noise = 2 * DBL_EPSILON, t->isa = skf_isa_pick();
  skf_status s = fill(t);
  if (!s) set_middle(t), s = set_copy(t);
  if (s) return skf_tracer_free(t), s;
  return *out = t, SKF_OK;
}

void skf_tracer_free(skf_tracer *t) {
  if (!t) return;
  for (size_t i = 0; i < t->n; i++) skf_source_free(t->sources + i);
  skf_free(t->sources);
  skf_octree_free(t->tree);
  skf_free(t->blobs);
  skf_field_free(t->plus);
  skf_field_free(t->minus);
  skf_tracer_free(t->copy);
  skf_field_free(t->copied);
  skf_free(t);
}
