/* SPDX-License-Identifier: MIT */
/* Cells and certificates. On a cell of length L the field is enclosed several times, each time at a higher price: by
   the sources' distances alone; by its ends and the most it can change between them; by the cubic through values and
   slopes at its ends, which is off by at most L^4 / 384 max |f''''| or L^2 / 16 max |f''|, whichever is known to be
   less; by that cubic's slope, which is off by at most sqrt(3) / 216 L^3 max |f''''| or 0.2516 L max |f''|. What is not
   decided then is halved. */
#include "ray/walk.h"
#include "core/vec3.h"
#include "field/some.h"
#include "ray/cubic.h"
#include <float.h>

enum { DEPTH = 128 };

/* Of cells that are left undecided on one piece of a ray; after them no cell is halved any more. */
enum { MANY = 1 << 14 };

static double largest(skf_vec3 a) { return fmax(fabs(a.x), fmax(fabs(a.y), fabs(a.z))); }

/* Planes whose field is linear on this piece of the ray. */
static void add_linear(const skf_walk *w, skf_vec3 p, double *F, double *size, skf_vec3 *g) {
  for (size_t i = 0; i < w->tracer->linear; i++) {
    const skf_source *s = w->tracer->sources + i;
    double c = -2 * SKF_PI * s->weight * w->side[i], z = v3_dot(v3_sub(p, s->a), s->b);
    double v = w->side[i] * z > 0 ? c * z : 0;
    *F += v, *size += fabs(v);
    *g = v3_mad(*g, c, s->b);
  }
}

static skf_knot knot_of(const skf_walk *w, double t, skf_vec3 p, double F, double size, skf_vec3 g, double noise) {
  double moved = 4 * DBL_EPSILON * (largest(p) + largest(w->origin)) * v3_norm(g);
  size += fabs(w->tracer->iso);
  return (skf_knot){
      t, F - w->tracer->iso, v3_dot(g, w->direction), size, isfinite(F) ? noise * size + moved : 0, p, g, true};
}

void skf_walk_look(skf_walk *w, double t, skf_knot *k) {
  const skf_tracer *tr = w->tracer;
  skf_vec3 p = v3_mad(w->origin, t, w->direction), g;
  double F, size, noise = 2 * tr->noise;
  if (w->leaf && w->leaf->blobs && !w->leaf->segments) {
    F = skf_blob_sum(w->leaf->blobs, w->leaf->count, p, &g, &size);
    noise = 16 * DBL_EPSILON;
  } else if (w->leaf && (w->leaf->blobs || w->leaf->count < tr->n)) {
    F = skf_field_some(tr->field, w->leaf->list, w->leaf->count, p, &g, &size);
    noise += 0.5 * DBL_EPSILON * w->leaf->count;
  } else if (!tr->plus && w->leaf && w->leaf->patch) { /* as many points at once give it */
    double out[4];
    skf_field_point(tr->field, &p, out);
    F = out[0], g = v3(out[1], out[2], out[3]), size = fabs(F);
  } else if (!tr->plus) {
    F = skf_field_at(tr->field, p, &g);
    size = fabs(F);
  } else {
    skf_vec3 h;
    double plus = skf_field_at(tr->plus, p, &g), minus = skf_field_at(tr->minus, p, &h);
    F = plus + minus, size = fabs(plus) + fabs(minus);
    g = v3_add(g, h);
    add_linear(w, p, &F, &size, &g);
  }
  w->report.evaluations++;
  *k = knot_of(w, t, p, F, size, g, noise);
}

typedef struct cell {
  double lo, hi;       /* of F, by distances */
  double error, slope; /* of the cubic, and of its derivative by the unit parameter */
  double change;       /* by which F can change along it */
} cell;

static double or_nothing(double x, double nothing) { return isnan(x) ? nothing : x; }

/* What has overflowed on its way bounds nothing. */
static cell known(cell c) {
  return (cell){or_nothing(c.lo, -INFINITY), or_nothing(c.hi, INFINITY), or_nothing(c.error, INFINITY),
                or_nothing(c.slope, INFINITY), or_nothing(c.change, INFINITY)};
}

/* By what is known of the whole leaf. */
static cell enclose_in_leaf(const skf_leaf *leaf, double L) {
  double L2 = L * L, L4 = L2 * L2;
  return known((cell){-INFINITY, INFINITY, fmin(L4 / 384 * leaf->fourth, L2 / 16 * leaf->bend),
                      fmin(0.00801876 * L4 * leaf->fourth, 0.2516 * L2 * leaf->bend), L * leaf->slope});
}

/* Largest distance from the source along the cell, whose middle is at d: the distance from what is convex is so along
   the ray, and largest at an end. It matters where the ray runs along a segment or a triangle, perhaps within. */
static double farthest(const skf_walk *w, const skf_source *s, double a, double b, double d, double slack) {
  skf_shape shape = s->element.primitive.shape;
  double most = d * (1 + 1e-12) + 0.5 * (b - a) + slack;
  if ((shape != SKF_SEGMENT && shape != SKF_TRIANGLE) || d >= b - a) return most;
  double first = skf_source_distance(s, v3_mad(w->origin, a, w->direction)),
         last = skf_source_distance(s, v3_mad(w->origin, b, w->direction));
  return fmin(most, fmax(first, last) * (1 + 1e-12) + slack);
}

static cell enclose(const skf_walk *w, double a, double b) {
  const skf_tracer *tr = w->tracer;
  if (w->leaf) return enclose_in_leaf(w->leaf, b - a);
  double L = b - a, half = 0.5 * L;
  skf_vec3 p = v3_mad(w->origin, a + half, w->direction);
  double slack = 4 * DBL_EPSILON * (largest(p) + largest(w->origin));
  cell c = {0, 0, 0, 0, 0};
  for (size_t i = 0; i < tr->linear; i++) {
    const skf_source *s = tr->sources + i;
    double factor = -2 * SKF_PI * s->weight * w->side[i], dz = skf_source_descent(s, w->direction);
    double v = factor * v3_dot(v3_sub(p, s->a), s->b), r = fabs(factor * (half * fabs(dz) + slack));
    c.lo += v - r, c.hi += v + r, c.change += 2 * r;
  }
  for (size_t i = tr->linear; i < tr->n; i++) {
    const skf_source *s = tr->sources + i;
    /* a plane's field depends on the distance alone: it sees the ray foreshortened */
    bool plane = s->element.primitive.shape == SKF_PLANE;
    double along = plane ? fabs(skf_source_descent(s, w->direction)) : 1, reach = along * half + slack;
    double d = skf_source_distance(s, p), x = fmax(fabs(s->least), fabs(s->most)), L2 = along * L * along * L,
           L4 = L2 * L2;
    double far = plane ? d * (1 + 1e-12) + reach : farthest(w, s, a, b, d, slack);
    skf_grade g = skf_source_grade(s, fmax(d * (1 - 1e-12) - reach, 0), far);
    if (s->disc && d < s->reach) g.below = fmax(g.below, skf_source_disc(s, p, reach));
    if (s->sheet && d < s->reach) g.above.slope = fmin(g.above.slope, skf_source_steepness(s, p, reach));
    if (s->bulk && d < s->reach) g.above = skf_source_bulk(s, p, reach);
    c.lo += skf_weight_times(s->least, s->least > 0 ? g.below : g.above.value);
    c.hi += skf_weight_times(s->most, s->most > 0 ? g.above.value : g.below);
    if (L2 == 0) continue; /* along the plane: constant */
    c.change += x * along * L * g.above.slope;
    c.error += x * fmin(L4 / 384 * g.above.fourth, L2 / 16 * g.above.bend);
    c.slope += x * fmin(0.00801876 * L4 * g.above.fourth, 0.2516 * L2 * g.above.bend);
  }
  return known(c);
}

static int sign_of(const skf_knot *k) { return fabs(k->f) > k->noise ? (k->f > 0 ? 1 : -1) : 0; }

typedef enum verdict { CLEAR, CROSSING, GRAZING, HALVE } verdict;

/* Decides a cell with both ends known; *guess is set for a crossing. */
static verdict judge(skf_walk *w, const skf_knot *a, const skf_knot *b, const cell *c, bool floor, double *guess) {
  double L = b->t - a->t, q[4], lo, hi;
  int sa = sign_of(a), sb = sign_of(b);
  if (!sa) sa = w->last;
  if (!sb) sb = sa;
  skf_cubic_hermite(a->f, L * a->slope, b->f, L * b->slope, q);
  double noise = fmax(a->noise, b->noise), error = c->error + noise;
  *guess = 0.5 * (a->t + b->t);
  w->last = sb;
  if (isfinite(q[0]) && isfinite(q[3])) {
    if (a->f * b->f > 0 && fabs(a->f) + fabs(b->f) > c->change + 2 * noise) return CLEAR;
    skf_cubic_range(q, &lo, &hi);
    if (lo > error || hi < -error) return CLEAR;
    if ((q[0] > 0) != (q[3] > 0)) *guess = a->t + L * skf_cubic_root(q);
    /* the noise in the slope is that of f over the place where the cell changes it */
    if (skf_cubic_steep(q, c->slope + 4 * noise)) return sa * sb < 0 ? CROSSING : CLEAR;
    /* twice: below once the noise in f itself would decide, cell by cell, whether the ray is clear of the surface */
    if (lo >= -2 * noise && hi <= 2 * noise) floor = true;
  }
  if (floor) return GRAZING;
  return HALVE;
}

bool skf_walk_piece(skf_walk *w, skf_knot *a, double end, skf_crossing_fn *found, void *user) {
  skf_knot stack[DEPTH];
  int depth = 0;
  size_t undecided = w->report.grazing + MANY;
  double iso = w->tracer->iso, grain = 8 * DBL_EPSILON * largest(w->origin);
  stack[depth++] = (skf_knot){.t = end};
  while (depth > 0) {
    skf_knot *b = stack + depth - 1;
    double L = b->t - a->t, mid = a->t + 0.5 * L, guess;
    int before = w->last;
    verdict v = HALVE;
    bool floor = depth == DEPTH || w->report.grazing >= undecided || !(mid > a->t && mid < b->t) ||
                 L <= grain + 8 * DBL_EPSILON * fmax(fabs(a->t), fabs(b->t));
    cell c = enclose(w, a->t, b->t);
    w->report.cells++;
    if (c.hi <= iso || c.lo >= iso) {
      w->last = c.hi <= iso ? -1 : 1;
      v = CLEAR;
    } else if (w->leaf || floor || (c.error < INFINITY && c.error <= 0.125 * (c.hi - c.lo)) ||
               c.change < 0.25 * fabs(iso)) {
      if (!a->known) skf_walk_look(w, a->t, a);
      if (!b->known) skf_walk_look(w, b->t, b);
      v = judge(w, a, b, &c, floor, &guess);
    }
    if (v == HALVE) {
      w->last = before;
      w->report.subdivisions++;
      stack[depth++] = (skf_knot){.t = mid};
      continue;
    }
    if (v == GRAZING) {
      w->report.grazing++;
      int sa = sign_of(a) ? sign_of(a) : before;
      if (sa * w->last < 0) v = CROSSING;
    }
    if (v == CROSSING && !found(user, w, a, b, guess)) return false;
    *a = *b;
    depth--;
  }
  return true;
}

/* Inverse cubic interpolation: t where f = 0, from values and slopes of two knots. */
static double inverse_step(const skf_knot *p, const skf_knot *q) {
  double h = q->f - p->f, s = -p->f / h, r = 1 - s;
  return r * r * (1 + 2 * s) * p->t + s * s * (1 + 2 * r) * q->t + h * s * r * (r / p->slope - s / q->slope);
}

skf_knot skf_walk_polish(skf_walk *w, const skf_knot *a, const skf_knot *b, double guess) {
  skf_knot lo = *a, hi = *b, best, old, k;
  if ((lo.f > 0) == (hi.f > 0)) { /* an end that is on the surface to within a model's error, or rounding */
    if (!lo.known) skf_walk_look(w, lo.t, &lo);
    if (!hi.known) skf_walk_look(w, hi.t, &hi);
  }
  best = old = fabs(lo.f) < fabs(hi.f) ? lo : hi;
  if ((lo.f > 0) == (hi.f > 0)) return best;
  double x = guess, grain = DBL_EPSILON * largest(v3_mad(w->origin, guess, w->direction));
  for (int i = 0; i < 100; i++) {
    if (!(x > lo.t && x < hi.t)) x = lo.t + 0.5 * (hi.t - lo.t);
    if (!(x > lo.t && x < hi.t)) break; /* neighbours */
    skf_walk_look(w, x, &k);
    if (fabs(k.f) < fabs(best.f)) best = k;
    if (fabs(k.f) <= 2 * DBL_EPSILON * k.size) break;
    *((k.f > 0) == (hi.f > 0) ? &hi : &lo) = k;
    double newton = k.f / k.slope, next = inverse_step(&old, &k);
    if (fabs(newton) <= 4 * grain) break; /* below */
    if (!(next > lo.t && next < hi.t) || fabs(next - k.t) > 2 * fabs(newton)) next = k.t - newton;
    if (i > 12 && i % 3 == 0) next = NAN; /* slow: rounding, or a flat root */
    old = k;
    x = next;
  }
  if (!best.known) skf_walk_look(w, best.t, &best);
  /* what is left is rounding; a last step costs nothing and centres it */
  double step = best.f / best.slope;
  if (fabs(step) <= 4 * grain && best.t - step >= a->t && best.t - step <= b->t) {
    best.t -= step;
    best.at = v3_mad(w->origin, best.t, w->direction);
  }
  return best;
}
