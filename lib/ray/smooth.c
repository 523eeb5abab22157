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
    o.drop += fmax(fabs(s->least), fabs(s->most)) * skf_source_grade(s, d, d).above.value * c->half / (d + c->half);
    if (!(m.value < INFINITY) || (m.value > FAR * m.size && m.value > small)) continue;
    skf_margin_add(off_far, &m);
    kept[i] = kept[n], kept[n++] = k;
  }
  *far = n;
  return o;
}

static bool sample(const skf_smooth *t, const skf_smooth_cell *c, const uint32_t *list, uint32_t n,
                   const skf_margin *off, skf_model *m) {
  double at[3][SKF_ALL_NODES], values[SKF_ALL_NODES];
  if (!n) return true;
  for (int i = 0; i < SKF_ALL_NODES; i++) {
    at[0][i] = c->center.x + c->half * t->table.node[i / SKF_NODES / SKF_NODES];
    at[1][i] = c->center.y + c->half * t->table.node[i / SKF_NODES % SKF_NODES];
    at[2][i] = c->center.z + c->half * t->table.node[i % SKF_NODES];
  }
  const double *const p[3] = {at[0], at[1], at[2]};
  if (skf_field_some_many(t->field, list, n, SKF_ALL_NODES, p, values)) return false;
  skf_margin with = *off;
  /* rounding of the samples, grown by the interpolation, and of the places */
  double lambda = t->table.lebesgue, grown = lambda * lambda * lambda;
  with.value +=
      grown * ((4 * t->noise + 1e-15) * off->size + 4 * DBL_EPSILON * largest(c->center) * off->size / c->half);
  skf_model_add(&t->table, values, &with, m);
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
  double wide = swing + m->off.value + rounding, middle = m->c[0];
  if (middle + wide + o.hi < t->iso) return SKF_SMOOTH_OUTSIDE;
  if (middle - wide + o.lo > t->iso) return SKF_SMOOTH_INSIDE;
  if (c->last || o.off.value <= TOLERANCE * (swing + 4 * o.drop) || o.off.value <= m->off.value) {
    if (!(o.off.value < INFINITY)) return SKF_SMOOTH_BARE;
    skf_model all = *m;
    if (!sample(t, c, kept, above->count, &o.off, &all)) return SKF_SMOOTH_LOST;
    swing = skf_model_swing(&t->table, &all, 0);
    double over = fabs(all.c[0] - t->iso) - swing - all.off.value - rounding;
    if (over > 0) return all.c[0] < t->iso ? SKF_SMOOTH_OUTSIDE : SKF_SMOOTH_INSIDE;
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
