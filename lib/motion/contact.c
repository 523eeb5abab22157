/* SPDX-License-Identifier: MIT */
/* The first contact along a curved path, certified: a piece of the path is dismissed when an enclosure of the field
   over a ball around it excludes the iso value, or when F along the path, |F - F_m - F'_m ds| <= B ds^2 / 2 about its
   middle, cannot reach it; it holds at most one crossing when |F'_m| > B ds throughout. Everything else is halved, down
   to pieces on which F changes by no more than its rounding error: those stay in doubt. A contact is where the path is
   inside beyond doubt, and before that was outside or in doubt since it was. The fast search is the same down to
   eighths of a step, which it samples. */
#include "motion/contact.h"
#include "motion/view.h"
#include <float.h>
#include <stdint.h>

/* Halvings never go further: by then a piece is as short as the rounding of s. */
#define DEPTH 60
/* Nor those of the fast search. */
#define EIGHTHS 3
/* Pieces of one step in doubt before a path that runs along a surface, as a circular orbit of just its radius does, is
   believed to go on like that: it would take some 1e8 of them. */
#define PATIENCE 1000

/* The search along a path as one body sees it. */
typedef struct hunt {
  skf_view view;
  double from;
  int side;     /* where the path was last beyond doubt: 1 inside, -1 outside, 0 not known */
  bool doubt;   /* it is in doubt now, */
  double since; /* from here on */
  bool fast;
  skf_search_report *report;
} hunt;

static double level(const hunt *v, double s) { return skf_view_level(&v->view, s); }

static void settle(hunt *v, int side) { v->side = side, v->doubt = false; }

static void doubt(hunt *v, double s) {
  if (!v->doubt) v->doubt = true, v->since = s;
}

/* What level f tells at s. */
static void weigh(hunt *v, double f, double rough, double s) {
  if (fabs(f) > rough)
    settle(v, f < 0 ? -1 : 1);
  else
    doubt(v, s);
}

/* Where the path came in, that is inside beyond doubt at or behind b, and was outside before a or the doubt. */
static double entry(const hunt *v, double a, double b) {
  if (level(v, a) < 0) return skf_view_polish(&v->view, a, b);
  double from = v->doubt ? v->since : a;
  return level(v, from) < 0 ? skf_view_polish(&v->view, from, a) : from;
}

/* -1, 1: the piece is outside or inside; 0: not known, and unless *enough m is a model of it. */
static int tell(const hunt *v, skf_glance *m, double half, bool *enough) {
  int side = skf_view_side(&v->view, m, enough);
  if (side || *enough) return side;
  if (!skf_view_measure(&v->view, m, half, 0)) return m->hi < 0 ? -1 : 1;
  return m->lo > 0 ? 1 : m->hi < 0 ? -1 : 0;
}

/* What the start is: in doubt it counts as outside. */
static void begin(hunt *v) {
  skf_sight at = skf_view_at(&v->view, v->from);
  v->side = -1;
  weigh(v, at.f, at.rough, v->from);
}

/* The first entry in [a, b]; false when there is none. */
static bool search(hunt *v, double a, double b, int depth, double *s) {
  double half = 0.5 * (b - a), middle = a + half;
  bool enough;
  skf_glance m = skf_view_place(&v->view, middle, half);
  int side = tell(v, &m, half, &enough);
  v->report->bounds++;
  if (side < 0) return settle(v, -1), false;
  if (v->side == 0) begin(v);
  if (side > 0 && v->side < 0) return *s = entry(v, a, a), true;
  if (side > 0) return settle(v, 1), false;
  if (!enough && fabs(m.slope) > m.second * half) { /* monotone */
    double end = level(v, b);
    if (v->side < 0 && end > m.rough) return *s = entry(v, a, b), true;
    return weigh(v, end, m.rough, a), false;
  }
  if (v->fast && depth == 0) return v->doubt = false, skf_view_sample(&v->view, a, b, 1, &v->side, s);
  bool floor = depth == 0 || (!enough && fabs(m.slope) * half + 0.5 * m.second * half * half <= m.rough);
  if (v->report->grazing > PATIENCE && !enough && fabs(m.f) + fabs(m.slope) * half <= m.rough) floor = true;
  if (floor) return doubt(v, a), v->report->grazing++, false;
  return search(v, a, middle, depth - 1, s) || search(v, middle, b, depth - 1, s);
}

/* Whether the whole path is outside, by a ball about its start: where it is far from a body that does not turn. */
static bool passes(const skf_view *v, double reach) {
  if (v->omega != 0 || (!v->b->walled && !v->tracer)) return false;
  bool enough;
  skf_vec3 x = v->path->x0;
  skf_glance g = {.x = x, .q = x, .radius = reach + 16 * DBL_EPSILON * v3_norm(x)};
  return skf_view_side(v, &g, &enough) < 0;
}

skf_touch skf_contact_find(const skf_world *world, const skf_hunt *how, skf_search_report *report) {
  skf_touch first = {false, 0, how->to};
  double reach = skf_path_reach(how->path);
  for (size_t i = 0; i < world->n; i++) {
    if (!world->bodies[i].surface) continue;
    if (how->along && skf_rail_has(how->along, i)) continue;
    int born = how->born == i ? how->side : how->entered && how->entered[i] ? 1 : 0;
    hunt v = {skf_view_of(world, i, how->path), how->from, born, born != 0, how->from, how->fast, report};
    report->bounds++;
    bool blind = how->fast && !world->bodies[i].bounds;
    if (!blind && passes(&v.view, reach)) continue;
    double s;
    bool found = blind ? skf_view_sample(&v.view, how->from, first.s, 1 << EIGHTHS, &v.side, &s)
                       : search(&v, how->from, first.s, how->fast ? EIGHTHS : DEPTH, &s);
    if (found && (!first.found || s < first.s)) first = (skf_touch){true, i, s};
    if (first.found && first.s == how->from) break;
  }
  return first;
}

size_t skf_contact_born(const skf_world *world, skf_clock t, skf_vec3 p) {
  for (size_t i = 0; i < world->n; i++) {
    const skf_world_body *b = world->bodies + i;
    if (!b->surface) continue;
    skf_turn r = skf_field_turn_at(b, t);
    skf_vec3 g, q = skf_turn_point(&r, -1, p);
    double F = skf_field_at(b->is.field, q, &g);
    if (fabs(F - b->is.iso) <= 4 * skf_view_noise(b, F, g, q, p)) return i;
  }
  return SIZE_MAX;
}

skf_vec3 skf_contact_normal(const skf_world_body *b, skf_clock t, skf_vec3 p) {
  skf_turn r = skf_field_turn_at(b, t);
  skf_vec3 g;
  skf_field_at(b->is.field, skf_turn_point(&r, -1, p), &g);
  return v3_unit(v3_scale(-1, skf_turn_vector(&r, 1, g)));
}
