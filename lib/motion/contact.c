/* SPDX-License-Identifier: MIT */
/* The first contact along a curved path, certified: a piece of the path is dismissed when an enclosure of the field
   over a ball around it excludes the iso value, or when F along the path, |F - F_m - F'_m ds| <= B ds^2 / 2 about its
   middle, cannot reach it; it holds at most one crossing when |F'_m| > B ds throughout. Everything else is halved, down
   to pieces on which F changes by no more than its rounding error: those stay in doubt. A contact is where the path is
   inside beyond doubt, and before that was outside or in doubt since it was. */
#include "motion/contact.h"
#include <float.h>
#include <stdint.h>

/* Halvings never go further: by then a piece is as short as the rounding of s. */
#define DEPTH 60
/* Pieces of one step in doubt before a path that runs along a surface, as a circular orbit of just its radius does, is
   believed to go on like that: it would take some 1e8 of them. */
#define PATIENCE 1000

/* A path seen from a body. */
typedef struct view {
  const skf_world_body *b;
  const skf_path *path;
  double omega; /* turn per unit of s */
  int side;     /* where the path was last beyond doubt: 1 inside, -1 outside, 0 not known */
  bool doubt;   /* it is in doubt now, */
  double since; /* from here on */
  skf_search_report *report;
} view;

static skf_clock time_at(const view *v, double s) { return clock_add(v->path->t0, s * v->path->h); }

static double level(const view *v, double s) {
  skf_turn r = skf_turn_at(v->b, time_at(v, s));
  skf_vec3 q = skf_turn_point(&r, -1, skf_path_position(v->path, s));
  return skf_field_at(v->b->is.field, q, NULL) - v->b->is.iso;
}

/* Rounding error of F - iso at q, seen from the inertial place x; what is infinite is surely not iso. */
static double noise(const skf_world_body *b, double F, skf_vec3 g, skf_vec3 q, skf_vec3 x) {
  if (!isfinite(F)) return 0;
  double value = 16 * DBL_EPSILON * (fabs(F) + fabs(b->is.iso));
  return value + 8 * DBL_EPSILON * v3_norm(g) * (v3_norm(q) + v3_norm(x));
}

/* A crossing in [a, b] with f(a) < 0 <= f(b), by Chandrupatla's method, until F - iso is zero or the bracket is as
   narrow as s allows. */
static double polish(const view *v, double a, double b) {
  double fa = level(v, a), fb = level(v, b), c = a, fc = fa, t = 0.5;
  for (int i = 0; i < 100 && fb != 0 && fa != 0; i++) {
    double x = a + t * (b - a);
    if (!(x > fmin(a, b) && x < fmax(a, b))) break;
    double fx = level(v, x);
    if ((fx < 0) == (fa < 0)) {
      c = a, fc = fa;
    } else {
      c = b, fc = fb;
      b = a, fb = fa;
    }
    a = x, fa = fx;
    double xi = (a - b) / (c - b), phi = (fa - fb) / (fc - fb), tiny = DBL_EPSILON / fabs(b - a);
    bool smooth = phi * phi < xi && (1 - phi) * (1 - phi) < 1 - xi;
    t = smooth ? fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb) : 0.5;
    t = fmin(1 - tiny, fmax(tiny, t));
    if (!(tiny < 0.5)) break;
  }
  return fabs(fa) < fabs(fb) ? a : b;
}

/* What is known of F - iso on a piece of the path. */
typedef struct model {
  double f, slope, bend; /* at the middle, d/ds there, bound of |d2/ds2| */
  double rough;          /* rounding error of f */
  int side;              /* -1, 1: surely outside or inside all along */
} model;

static model look(const view *v, double middle, double half) {
  const skf_world_body *b = v->b;
  skf_piece p = skf_path_piece(v->path, middle, half);
  skf_turn r = skf_turn_at(b, time_at(v, middle));
  skf_vec3 arm = v3_sub(p.x, b->is.spin.about), q = skf_turn_point(&r, -1, p.x), g;
  double w = fabs(v->omega), reach = w > 0 ? v3_norm(arm) + p.speed * half : 0;
  double speed = p.speed + w * reach, bend = p.bend + w * (2 * p.speed + w * reach);
  double radius = speed * half * (1 + 1e-12); /* the bound of the speed is rounded */
  if (b->walled && v3_dist(q, b->wall_center) > b->wall_radius + radius) return (model){.side = -1};
  skf_bound bound = skf_field_bound(b->is.field, q, radius);
  v->report->bounds++;
  if (bound.hi < b->is.iso || bound.lo > b->is.iso) return (model){.side = bound.hi < b->is.iso ? -1 : 1};
  double F = skf_field_at(b->is.field, q, &g);
  skf_vec3 d = v3_mad(p.d1, -v->omega, v3_cross(b->axis, arm));
  model m = {F - b->is.iso, v3_dot(g, skf_turn_vector(&r, -1, d)), 0, noise(b, F, g, q, p.x), 0};
  m.bend = bound.hessian * speed * speed + bound.gradient * bend;
  if (fabs(m.f) > fabs(m.slope) * half + 0.5 * m.bend * half * half + m.rough) m.side = m.f < 0 ? -1 : 1;
  return m;
}

static void settle(view *v, int side) { v->side = side, v->doubt = false; }

static void doubt(view *v, double s) {
  if (!v->doubt) v->doubt = true, v->since = s;
}

/* What level f tells at s. */
static void weigh(view *v, double f, double rough, double s) {
  if (fabs(f) > rough)
    settle(v, f < 0 ? -1 : 1);
  else
    doubt(v, s);
}

/* Where the path came in, that is inside beyond doubt at or behind b, and was outside before a or the doubt. */
static double entry(const view *v, double a, double b) {
  if (level(v, a) < 0) return polish(v, a, b);
  double from = v->doubt ? v->since : a;
  return level(v, from) < 0 ? polish(v, from, a) : from;
}

/* The first entry in [a, b]; false when there is none. */
static bool search(view *v, double a, double b, int depth, double *s) {
  double half = 0.5 * (b - a), middle = a + half;
  model m = look(v, middle, half);
  if (m.side < 0) return settle(v, -1), false;
  if (v->side == 0) { /* the path begins in this piece; what begins in doubt comes from outside */
    v->side = -1;
    weigh(v, level(v, 0), m.rough, 0);
  }
  if (m.side > 0 && v->side < 0) return *s = entry(v, a, a), true;
  if (m.side > 0) return settle(v, 1), false;
  if (fabs(m.slope) > m.bend * half) { /* monotone */
    double end = level(v, b);
    if (v->side < 0 && end > m.rough) return *s = entry(v, a, b), true;
    return weigh(v, end, m.rough, a), false;
  }
  bool floor = depth == 0 || fabs(m.slope) * half + 0.5 * m.bend * half * half <= m.rough;
  if (v->report->grazing > PATIENCE && fabs(m.f) + fabs(m.slope) * half <= m.rough) floor = true;
  if (floor) return doubt(v, a), v->report->grazing++, false;
  return search(v, a, middle, depth - 1, s) || search(v, middle, b, depth - 1, s);
}

skf_touch skf_contact_find(const skf_world *world, const skf_path *path, double s_end, size_t born, int from,
                           skf_search_report *report) {
  skf_touch first = {false, 0, s_end};
  for (size_t i = 0; i < world->n; i++) {
    const skf_world_body *b = world->bodies + i;
    if (!b->surface) continue;
    view v = {b, path, b->rate * path->h, born == i ? from : 0, born == i, 0, report};
    double s;
    if (search(&v, 0, first.s, DEPTH, &s) && (!first.found || s < first.s)) first = (skf_touch){true, i, s};
    if (first.found && first.s == 0) break;
  }
  return first;
}

size_t skf_contact_born(const skf_world *world, skf_clock t, skf_vec3 p) {
  for (size_t i = 0; i < world->n; i++) {
    const skf_world_body *b = world->bodies + i;
    if (!b->surface) continue;
    skf_turn r = skf_turn_at(b, t);
    skf_vec3 g, q = skf_turn_point(&r, -1, p);
    double F = skf_field_at(b->is.field, q, &g);
    if (fabs(F - b->is.iso) <= 4 * noise(b, F, g, q, p)) return i;
  }
  return SIZE_MAX;
}

skf_vec3 skf_contact_normal(const skf_world_body *b, skf_clock t, skf_vec3 p) {
  skf_turn r = skf_turn_at(b, t);
  skf_vec3 g;
  skf_field_at(b->is.field, skf_turn_point(&r, -1, p), &g);
  return v3_unit(v3_scale(-1, skf_turn_vector(&r, 1, g)));
}
