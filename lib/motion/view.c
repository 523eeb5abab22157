/* SPDX-License-Identifier: MIT */
#include "motion/view.h"
#include "motion/scout.h"
#include <float.h>

/* So many elements are bounded as quickly as smaller pieces are looked up. */
#define FEW 8

skf_view skf_view_of(const skf_world *w, size_t body, const skf_path *path) {
  const skf_world_body *b = w->bodies + body;
  return (skf_view){b, skf_scout_tracer(w, body), path, b->turns ? b->rate * path->h : 0};
}

static skf_clock time_at(const skf_view *v, double s) { return clock_add(v->path->t0, s * v->path->h); }

/* dq/ds in the inertial frame: what moves, less the turn of the body. */
static skf_vec3 drift(const skf_view *v, skf_vec3 x, skf_vec3 dx) {
  if (v->omega == 0) return dx;
  return v3_mad(dx, -v->omega, v3_cross(v->b->axis, v3_sub(x, v->b->is.spin.about)));
}

double skf_view_level(const skf_view *v, double s) {
  skf_turn r = skf_field_turn_at(v->b, time_at(v, s));
  skf_vec3 x = skf_path_position(v->path, s);
  return skf_field_at(v->b->is.field, skf_turn_point(&r, -1, x), NULL) - v->b->is.iso;
}

skf_sight skf_view_at(const skf_view *v, double s) {
  skf_turn r = skf_field_turn_at(v->b, time_at(v, s));
  skf_vec3 x = skf_path_position(v->path, s), q = skf_turn_point(&r, -1, x), g;
  double F = skf_field_at(v->b->is.field, q, &g);
  skf_vec3 d = skf_turn_vector(&r, -1, drift(v, x, skf_path_rate(v->path, s)));
  return (skf_sight){s, F - v->b->is.iso, v3_dot(g, d), skf_view_noise(v->b, F, g, q, x), v3_norm(g)};
}

double skf_view_polish(const skf_view *v, double a, double b) {
  double fa = skf_view_level(v, a), fb = skf_view_level(v, b), c = a, fc = fa, t = 0.5;
  for (int i = 0; i < 100 && fb != 0 && fa != 0; i++) {
    double x = a + t * (b - a);
    if (!(x > fmin(a, b) && x < fmax(a, b))) break;
    double fx = skf_view_level(v, x);
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

double skf_view_noise(const skf_world_body *b, double F, skf_vec3 g, skf_vec3 q, skf_vec3 x) {
  if (!isfinite(F)) return 0;
  double value = 16 * DBL_EPSILON * (fabs(F) + fabs(b->is.iso));
  return value + 8 * DBL_EPSILON * v3_norm(g) * (v3_norm(q) + v3_norm(x));
}

skf_glance skf_view_place(const skf_view *v, double middle, double half) {
  skf_piece p = skf_path_piece(v->path, middle, half);
  skf_glance g = {.x = p.x, .q = p.x, .d = p.d1, .speed = p.speed, .bend = p.bend};
  if (v->omega != 0) {
    skf_turn r = skf_field_turn_at(v->b, time_at(v, middle));
    double w = fabs(v->omega), reach = v3_dist(p.x, v->b->is.spin.about) + p.speed * half;
    g.q = skf_turn_point(&r, -1, p.x);
    g.d = skf_turn_vector(&r, -1, drift(v, p.x, p.d1));
    g.speed += w * reach, g.bend += w * (2 * p.speed + w * reach);
  }
  double rounding = 8 * DBL_EPSILON * (v3_norm(g.q) + v3_norm(g.x));
  g.radius = g.speed * half * (1 + 1e-12) + rounding; /* the bound of the speed is rounded, too */
  return g;
}

bool skf_view_beyond_wall(const skf_view *v, const skf_glance *g) {
  return v->b->walled && v3_dist(g->q, v->b->wall_center) > v->b->wall_radius + g->radius;
}

int skf_view_side(const skf_view *v, skf_glance *g, bool *enough) {
  *enough = false;
  if (skf_view_beyond_wall(v, g)) return -1;
  if (!v->tracer) return 0;
  g->ball = skf_octree_ball(v->tracer->tree, g->q, g->radius);
  *enough = !g->ball.exhausted && g->ball.count > FEW;
  return g->ball.side;
}

static skf_outlook bounds(const skf_view *v, skf_glance *g) {
  if (v->tracer) {
    skf_octree *tree = v->tracer->tree;
    if (!g->ball.list) g->ball = skf_octree_ball(tree, g->q, g->radius);
    const skf_leaf *leaf = g->ball.leaf;
    if (leaf && leaf->count > FEW && leaf->bend < INFINITY)
      return (skf_outlook){-INFINITY, INFINITY, leaf->slope, leaf->bend, leaf->fourth};
    return skf_octree_enclose(tree, &g->ball, g->q, g->radius);
  }
  skf_bound o = skf_field_bound(v->b->is.field, g->q, g->radius);
  return (skf_outlook){o.lo, o.hi, o.gradient, o.hessian, o.fourth};
}

bool skf_view_measure(const skf_view *v, skf_glance *m, double half, double below) {
  double iso = v->b->is.iso;
  skf_outlook o = bounds(v, m);
  m->lo = o.lo - iso, m->hi = o.hi - iso;
  if (m->hi < below || m->lo > 0) return false;
  skf_vec3 g;
  double F = skf_field_at(v->b->is.field, m->q, &g);
  m->f = F - iso;
  m->slope = v3_dot(g, m->d);
  m->second = o.bend * m->speed * m->speed + o.slope * m->bend;
  m->rough = skf_view_noise(v->b, F, g, m->q, m->x);
  double change = fabs(m->slope) * half + 0.5 * m->second * half * half + m->rough;
  m->lo = fmax(m->lo, m->f - change), m->hi = fmin(m->hi, m->f + change);
  return true;
}
