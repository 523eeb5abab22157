/* SPDX-License-Identifier: MIT */
/* What contact must keep: between bodies of which none is fixed its forces are internal, so that the momenta of a group
   of them, and all its angular momentum, are those at the end of the free motion; and its forces make no energy. */
#include "motion/swarm.h"

static const skf_mover *mover(const skf_swarm *s, size_t i) { return s->bodies + i; }

double skf_swarm_energy(const skf_swarm *s, const double *y) {
  double E = skf_swarm_potential(s, y);
  for (size_t i = 0; i < s->n; i++) {
    skf_attitude a = skf_mover_at(s, y, i);
    if (mover(s, i)->free) E += 0.5 * (mover(s, i)->is.mass * v3_norm2(a.v) + v3_dot(a.L, a.w));
  }
  return E;
}

/* ---- Groups: bodies that touch, named by the first of them ---- */

static void join(skf_swarm *s, size_t a, size_t b) {
  size_t p = s->group[a], q = s->group[b], to = p < q ? p : q, from = p < q ? q : p;
  for (size_t i = 0; i < s->n; i++)
    if (s->group[i] == from) s->group[i] = to;
}

void skf_rest_group(skf_swarm *s) {
  for (size_t i = 0; i < s->n; i++) s->group[i] = i;
  for (size_t k = 0; k < s->here.n; k++)
    for (int i = 0; i < s->there.bond[k].n; i++)
      if (skf_rest_touch(s, k, i)) join(s, s->here.bond[k].a, s->here.bond[k].b);
}

/* A group as if it were one body; v and w are 0 when one of it is fixed. */
typedef struct whole {
  double mass;
  skf_vec3 center, v, w, L; /* L: about the center */
  size_t members;
  bool fixed;
} whole;

static skf_vec3 inertia_times(const skf_swarm *s, const double *y, size_t g, skf_vec3 center, skf_vec3 w) {
  skf_vec3 L = {0, 0, 0};
  for (size_t i = 0; i < s->n; i++) {
    if (s->group[i] != g) continue;
    skf_attitude a = skf_mover_at(s, y, i);
    skf_vec3 r = v3_sub(a.x, center);
    L = v3_add(L, v3_mad(skf_mover_spun(mover(s, i), a.q, w), mover(s, i)->is.mass, v3_cross(r, v3_cross(w, r))));
  }
  return L;
}

static skf_vec3 spin_of(const skf_swarm *s, const double *y, size_t g, skf_vec3 center, skf_vec3 L) {
  skf_vec3 K[3];
  for (int k = 0; k < 3; k++) K[k] = inertia_times(s, y, g, center, v3(k == 0, k == 1, k == 2));
  return skf_symmetric_solve(K, L);
}

static whole whole_of(const skf_swarm *s, const double *y, size_t g) {
  whole w = {.mass = 0};
  for (size_t i = 0; i < s->n; i++) {
    if (s->group[i] != g) continue;
    skf_attitude a = skf_mover_at(s, y, i);
    double m = mover(s, i)->is.mass;
    w.members++, w.fixed = w.fixed || !mover(s, i)->free, w.mass += m;
    w.center = v3_mad(w.center, m, a.x), w.v = v3_mad(w.v, m, a.v);
  }
  if (w.fixed || w.members < 2) return w.v = v3(0, 0, 0), w;
  w.center = v3_scale(1 / w.mass, w.center), w.v = v3_scale(1 / w.mass, w.v);
  for (size_t i = 0; i < s->n; i++) {
    if (s->group[i] != g) continue;
    skf_attitude a = skf_mover_at(s, y, i);
    w.L = v3_add(w.L, v3_mad(a.L, mover(s, i)->is.mass, v3_cross(v3_sub(a.x, w.center), v3_sub(a.v, w.v))));
  }
  w.w = spin_of(s, y, g, w.center, w.L);
  return w;
}

/* What a member does as part of the whole. */
static void carried(const skf_swarm *s, const whole *w, const skf_attitude *a, size_t i, skf_vec3 *v, skf_vec3 *L) {
  *v = v3_add(w->v, v3_cross(w->w, v3_sub(a->x, w->center)));
  *L = skf_mover_spun(mover(s, i), a->q, w->w);
}

static void put(double *y, size_t i, skf_vec3 v, skf_vec3 L) {
  double *p = y + i * SKF_MOVER_STATE;
  p[3] = v.x, p[4] = v.y, p[5] = v.z, p[10] = L.x, p[11] = L.y, p[12] = L.z;
}

/* Gives the group at `to` the momenta that it has in the free motion's end, by a motion as a whole. */
static void restore(const skf_swarm *s, const double *free_end, double *to, size_t g) {
  whole is = whole_of(s, to, g), was = whole_of(s, free_end, g), more = is;
  if (is.fixed || is.members < 2) return;
  skf_vec3 L = v3_mad(was.L, was.mass, v3_cross(v3_sub(was.center, is.center), was.v));
  more.v = v3_sub(was.v, is.v), more.w = spin_of(s, to, g, is.center, v3_sub(L, is.L));
  for (size_t i = 0; i < s->n; i++) {
    if (s->group[i] != g) continue;
    skf_attitude a = skf_mover_at(s, to, i);
    skf_vec3 v, M;
    carried(s, &more, &a, i, &v, &M);
    put(to, i, v3_add(a.v, v), v3_add(a.L, M));
  }
}

/* The energy of the motions within the group; makes these `left` times as fast. */
static double within(const skf_swarm *s, double *to, size_t g, double left) {
  whole w = whole_of(s, to, g);
  double T = 0;
  for (size_t i = 0; i < s->n && w.members > 1; i++) {
    if (s->group[i] != g || !mover(s, i)->free) continue;
    skf_attitude a = skf_mover_at(s, to, i);
    skf_vec3 v, L;
    carried(s, &w, &a, i, &v, &L);
    skf_vec3 dv = v3_sub(a.v, v), dL = v3_sub(a.L, L);
    T += 0.5 * (mover(s, i)->is.mass * v3_norm2(dv) + v3_dot(dL, skf_mover_spin(mover(s, i), a.q, dL)));
    if (left < 1) put(to, i, v3_mad(v, left, dv), v3_mad(L, left, dL));
  }
  return T;
}

void skf_rest_keep(skf_swarm *s, const double *free_end, double most, double *to) {
  double T = 0;
  for (size_t g = 0; g < s->n; g++)
    if (s->group[g] == g) restore(s, free_end, to, g);
  double more = skf_swarm_energy(s, to) - most;
  if (!(more > 0)) return;
  for (size_t g = 0; g < s->n; g++)
    if (s->group[g] == g) T += within(s, to, g, 1);
  double left = T > more ? sqrt(1 - more / T) : 0;
  for (size_t g = 0; g < s->n; g++)
    if (s->group[g] == g) within(s, to, g, left);
}
