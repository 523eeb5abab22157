/* SPDX-License-Identifier: MIT */
/* The box outside of which F < iso: six planes by what each element can reach, then slices shaved off by subdivision.
 */
#include "core/alloc.h"
#include "core/vec3.h"
#include "field/bound.h"
#include "field/envelope.h"
#include "field/weight.h"

/* Upper bound of F beyond the plane at `c` along axis i, on the positive (sign = 1) or negative side. */
static double beyond(const skf_field *f, int i, double sign, double c) {
  double sum = 0;
  skf_vec3 up = {0, 0, 0};
  *v3_at(&up, i) = sign;
  for (size_t k = 0; k < skf_field_size(f); k++) {
    const skf_element *e = skf_field_element(f, k);
    double most = skf_element_weights(e).hi;
    if (most > 0) sum += most * skf_element_beyond(e, up, sign * c);
  }
  return sum;
}

/* The nearest such plane that the elements' reach allows, to a thousandth of its distance. */
static double face(const skf_field *f, double iso, int i, double sign, double top, double scale) {
  double far = fmin(scale, 1e300);
  while (beyond(f, i, sign, top + sign * far) >= iso && far < 1e300) far *= 2;
  double near = far;
  do {
    if (near < 1e-3 * scale || top + sign * near == top) return top + sign * far;
    near *= 0.5;
  } while (beyond(f, i, sign, top + sign * near) < iso && (far = near) > 0);
  while (far - near > 1e-3 * far) {
    double mid = 0.5 * (near + far);
    *(beyond(f, i, sign, top + sign * mid) < iso ? &far : &near) = mid;
  }
  return top + sign * far;
}

enum { LEAVES = 1024 };

typedef struct shave {
  const skf_field *field;
  double iso;
  size_t n;
  skf_box *leaf;
} shave;

static skf_box hull(const shave *s) {
  skf_box b = box_empty();
  for (size_t k = 0; k < s->n; k++) b = box_join(b, s->leaf[k]);
  return b;
}

/* The largest leaf that holds out side `side` (0..5: lo x, lo y, lo z, hi x, ...) of the hull. */
static size_t outermost(const shave *s, const skf_box *b, int side) {
  size_t best = s->n;
  for (size_t k = 0; k < s->n; k++) {
    const skf_box *l = s->leaf + k;
    int i = side % 3;
    bool on = side < 3 ? v3_get(l->lo, i) <= v3_get(b->lo, i) : v3_get(l->hi, i) >= v3_get(b->hi, i);
    if (on && (best == s->n || box_diagonal(*l) > box_diagonal(s->leaf[best]))) best = k;
  }
  return best;
}

static void keep(shave *s, skf_box b) {
  if (skf_field_bound(s->field, box_center(b), 0.5 * box_diagonal(b) * (1 + 1e-12)).hi >= s->iso) s->leaf[s->n++] = b;
}

static void split(shave *s, size_t k) {
  skf_box a = s->leaf[k], b = a;
  skf_vec3 d = v3_sub(a.hi, a.lo);
  int i = d.x >= d.y && d.x >= d.z ? 0 : d.y >= d.z ? 1 : 2;
  *v3_at(&a.hi, i) = *v3_at(&b.lo, i) = 0.5 * (v3_get(a.lo, i) + v3_get(a.hi, i));
  s->leaf[k] = s->leaf[--s->n];
  keep(s, a);
  keep(s, b);
}

static void shave_off(shave *s, skf_box whole, int budget) {
  double floor = 0.004 * box_diagonal(whole);
  int idle = 0;
  for (int side = 0; budget > 0 && idle < 6 && s->n && s->n + 2 < LEAVES; side = (side + 1) % 6) {
    skf_box b = hull(s);
    size_t k = outermost(s, &b, side);
    if (box_diagonal(s->leaf[k]) < floor) {
      idle++;
      continue;
    }
    idle = 0;
    split(s, k);
    budget -= 2;
  }
}

skf_status skf_field_region(const skf_field *field, double iso, skf_box *out) {
  size_t n = skf_field_size(field);
  skf_box b = box_empty();
  double sup = 0, scale = 0;
  bool plane = false;
  if (isnan(iso)) return SKF_ERR_ARG;
  if (!skf_field_has_bound(field, NULL)) return SKF_ERR_UNSUPPORTED;
  if (!(iso > 0)) return SKF_ERR_UNBOUNDED;
  for (size_t k = 0; k < n; k++) {
    const skf_element *e = skf_field_element(field, k);
    if (e->primitive.shape == SKF_PLANE && e->strength != 0) {
      plane = true;
      if (e->strength < 0 && skf_kernel_get(e->kernel.type)->singular) sup = INFINITY; /* it grows with distance */
    }
    double most = skf_element_weights(e).hi;
    if (!(most > 0)) continue;
    sup += most * skf_element_reach(e, 0).value;
    b = box_join(b, skf_primitive_bounds(&e->primitive));
    scale = fmax(scale, skf_kernel_width(e->kernel));
  }
  if (sup < iso) return SKF_ERR_EMPTY;
  if (plane) return SKF_ERR_UNBOUNDED;
  scale = fmax(scale, box_diagonal(b));
  if (!(scale > 0))
    scale = sup < INFINITY ? 1 : fmax(1e-290, 1e-6 * fmax(fabs(b.lo.x), fmax(fabs(b.lo.y), fabs(b.lo.z))));
  for (int i = 0; i < 3; i++) {
    *v3_at(&out->lo, i) = face(field, iso, i, -1, v3_get(b.lo, i), scale);
    *v3_at(&out->hi, i) = face(field, iso, i, 1, v3_get(b.hi, i), scale);
  }
  shave s = {field, iso, 0, skf_alloc(LEAVES, sizeof *s.leaf)};
  if (!s.leaf) return SKF_ERR_NOMEM;
  keep(&s, *out);
  shave_off(&s, *out, n < 3 ? 600 : n < 40 ? (int)(1800 / n) : 45);
  skf_box tight = hull(&s);
  size_t left = s.n;
  skf_free(s.leaf);
  if (!left) return SKF_ERR_EMPTY;
  return *out = tight, SKF_OK;
}

skf_status skf_field_negative(const skf_field *field, skf_field **out) {
  size_t n = skf_field_size(field);
  skf_element *e = skf_alloc(n, sizeof *e);
  if (!e) return SKF_ERR_NOMEM;
  for (size_t i = 0; i < n; i++) e[i] = *skf_field_element(field, i), e[i].strength = -e[i].strength;
  skf_status s = skf_field_new(e, n, out);
  skf_free(e);
  return s;
}
