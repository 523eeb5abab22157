/* SPDX-License-Identifier: MIT */
#include "ray/smooth.h"
#include "core/vec3.h"
#include "field/some.h"
#include <float.h>

/* A polynomial may be off by this part of what it changes by in a leaf; */
#define TOLERANCE 5e-5
/* of which the lower degree may leave out that much, more where the field is soon summed once more; */
#define LEAST        2e-5
#define LEAST_OF_FEW 1e-3
/* and those of the branches above it by this part of what the field is made of there. */
#define FAR 1e-5

/* What is known of the near elements. */
typedef struct outlook {
  double lo, hi, drop; /* of their field; a guess by how much it changes */
  skf_margin off;      /* if they were sampled here */
  double rough;        /* the same at the rough nodes */
} outlook;

static double largest(skf_vec3 a) { return fmax(fabs(a.x), fmax(fabs(a.y), fabs(a.z))); }

/* Elements whose polynomial is good enough already go to the front of `kept`: *far of them. */
static outlook look_out(const skf_smooth *t, const skf_smooth_cell *c, const skf_far_part *above, uint32_t *kept,
                        uint32_t *far, skf_margin *off_far) {
  outlook o = {.lo = 0};
  double radius = 1.7320508075688773 * c->half, small = 0.1 * FAR * fabs(t->iso) / (1 + above->count);
  uint32_t n = 0;
  *off_far = (skf_margin){.value = 0};
  for (uint32_t i = 0; i < above->count; i++) {
    uint32_t k = above->list[i];
    const skf_source *s = t->sources + k;
    double d = skf_source_distance(s, c->center), near = fmax(d * (1 - 1e-12) - radius, 0),
           end = d * (1 + 1e-12) + radius;
    skf_grade g = skf_source_grade(s, near, end);
    kept[i] = k;
    if (!(g.above.value > 0)) {
      kept[i] = kept[n], kept[n++] = k; /* nothing here: as good as far */
      continue;
    }
    o.lo += skf_weight_times(s->least, s->least > 0 ? g.below : g.above.value);
    o.hi += skf_weight_times(s->most, s->most > 0 ? g.above.value : g.below);
    skf_margin m = skf_margin_of(s, near, g.above.value, c->half);
    skf_margin_add(&o.off, &m);
    o.rough += skf_margin_rough(s, near, g.above.value, c->half);
    o.drop += fmax(fabs(s->least), fabs(s->most)) * skf_source_grade(s, d, d).above.value * c->half / (d + c->half);
    if (!(m.value < INFINITY) || (m.value > FAR * m.size && m.value > small)) continue;
    skf_margin_add(off_far, &m);
    kept[i] = kept[n], kept[n++] = k;
  }
  *far = n;
  return o;
}

/* The field of n elements at all of the nodes, `many` along each axis. */
static bool look(const skf_smooth *t, const skf_smooth_cell *c, const uint32_t *list, uint32_t n, const double *node,
                 int many, double *values) {
  double at[3][SKF_ALL_NODES];
  int all = many * many * many;
  for (int i = 0; i < all; i++) {
    at[0][i] = c->center.x + c->half * node[i / many / many];
    at[1][i] = c->center.y + c->half * node[i / many % many];
    at[2][i] = c->center.z + c->half * node[i % many];
  }
  const double *const p[3] = {at[0], at[1], at[2]};
  return !skf_field_some_many(t->field, list, n, (size_t)all, p, values);
}

/* The rounding of samples of that size, grown by the interpolation, and of their places. */
static double rounding_of(const skf_smooth *t, const skf_smooth_cell *c, double size) {
  double lambda = t->table.lebesgue, grown = lambda * lambda * lambda;
  return grown * ((4 * t->noise + 1e-15) * size + 4 * DBL_EPSILON * largest(c->center) * size / c->half);
}

static bool sample(const skf_smooth *t, const skf_smooth_cell *c, const uint32_t *list, uint32_t n,
                   const skf_margin *off, skf_model *m) {
  double values[SKF_ALL_NODES];
  if (!n) return true;
  if (!look(t, c, list, n, t->table.node, SKF_NODES, values)) return false;
  skf_margin with = *off;
  with.value += rounding_of(t, c, off->size);
  skf_model_add(&t->table, values, &with, m);
  return true;
}

/* By how much F is certainly above iso in the cell, or below; else 0. m: of the far elements. */
static double clearance(const skf_smooth *t, const skf_model *m, double error) {
  double f = m->c[0] - t->iso, over = fabs(f) - skf_model_swing(&t->table, m, 0) - error - 1e-14 * m->off.size;
  return over > 0 ? copysign(over, f) : 0;
}

/* Most cells in which there is no surface are told by a few samples. */
static bool glance(const skf_smooth *t, const skf_smooth_cell *c, const uint32_t *list, uint32_t n, const outlook *o,
                   const skf_model *far, double *over) {
  double values[SKF_ALL_ROUGH];
  skf_model m = *far;
  *over = 0;
  if (!(o->rough + far->off.value < o->hi - o->lo)) return true;
  if (!look(t, c, list, n, t->table.rough, SKF_ROUGH, values)) return false;
  skf_model_add_rough(&t->table, values, &m);
  m.off.size += o->off.size;
  *over = clearance(t, &m, o->rough + far->off.value + rounding_of(t, c, o->off.size));
  return true;
}

/* By powers, of the lower degree where what that leaves out does not count. */
static void shape(const skf_smooth *t, const skf_smooth_cell *c, const skf_model *m, bool low, skf_patch *p) {
  p->off = m->off, p->degree = low ? SKF_LOW_DEGREE : SKF_DEGREE, p->per = 1 / c->half;
  skf_model_powers(&t->table, m, c->half, p->degree, p->c, &p->off);
  p->c[0] -= t->iso;
  p->off.value += 4 * DBL_EPSILON * fabs(t->iso);
}

skf_smooth_kind skf_smooth_examine(const skf_smooth *t, const skf_smooth_cell *c, const skf_far_part *above,
                                   skf_patch *patch, skf_model *m, uint32_t *kept, uint32_t *keep) {
  uint32_t far;
  skf_margin off;
  outlook o = look_out(t, c, above, kept, &far, &off);
  skf_model_halve(&t->table, &above->model, c->child, m);
  double swing = skf_model_swing(&t->table, m, 0), rounding = 1e-14 * m->off.size;
  double wide = swing + m->off.value + rounding, middle = m->c[0], over;
  if (middle + wide + o.hi < t->iso) return SKF_SMOOTH_OUTSIDE;
  if (middle - wide + o.lo > t->iso) return SKF_SMOOTH_INSIDE;
  if (!glance(t, c, kept, above->count, &o, m, &over)) return SKF_SMOOTH_LOST;
  if (over != 0) return over < 0 ? SKF_SMOOTH_OUTSIDE : SKF_SMOOTH_INSIDE;
  if (c->last || o.off.value <= TOLERANCE * (swing + 4 * o.drop) || o.off.value <= m->off.value) {
    if (!(o.off.value < INFINITY)) return SKF_SMOOTH_BARE;
    skf_model all = *m;
    if (!sample(t, c, kept, above->count, &o.off, &all)) return SKF_SMOOTH_LOST;
    swing = skf_model_swing(&t->table, &all, 0);
    over = clearance(t, &all, all.off.value);
    if (over != 0) return over < 0 ? SKF_SMOOTH_OUTSIDE : SKF_SMOOTH_INSIDE;
    double error = all.off.value + skf_model_swing(&t->table, &all, SKF_DEGREE);
    if (c->last || error <= TOLERANCE * swing + 2 * m->off.value) { /* the far part's error does not shrink */
      shape(t, c, &all, skf_model_swing(&t->table, &all, SKF_LOW_DEGREE) <= (t->few ? LEAST_OF_FEW : LEAST) * swing,
            patch);
      return SKF_SMOOTH_LEAF;
    }
  }
  if (!sample(t, c, kept, far, &off, m)) return SKF_SMOOTH_LOST;
  *keep = above->count - far;
  for (uint32_t i = 0; i < *keep; i++) kept[i] = kept[far + i];
  return SKF_SMOOTH_BRANCH;
}
