/* SPDX-License-Identifier: MIT */
/* The impulse between two rigid bodies at one place. */
#include "motion/swarm.h"

/* A rebound that would rise less than this part of the body's size is none: the bodies lean on each other. */
#define HOP 1e-6
/* The same without loss of energy: only bodies that were put down without any speed rest. */
#define HOP_ELASTIC 1e-14
/* Over the speeds: what a rebound without restitution leaves. */
#define ROUNDING 1e-12
/* Friction that would create energy is made less, so often by a tenth. */
enum { LESSER = 60 };

/* Inertia of a body as an impulse at x meets it: velocity there after a unit impulse. */
static skf_vec3 yields(const skf_mover *m, const skf_attitude *a, skf_vec3 x, skf_vec3 impulse) {
  if (!m->free) return v3(0, 0, 0);
  skf_vec3 arm = v3_sub(x, a->x), w = skf_mover_spin(m, a->q, v3_cross(arm, impulse));
  return v3_mad(v3_cross(w, arm), 1 / m->is.mass, impulse);
}

static skf_vec3 speed(const skf_attitude *a, skf_vec3 x) { return v3_add(a->v, v3_cross(a->w, v3_sub(x, a->x))); }

skf_vec3 skf_symmetric_solve(const skf_vec3 K[3], skf_vec3 r) {
  double det = v3_dot(K[0], v3_cross(K[1], K[2]));
  return v3(v3_dot(r, v3_cross(K[1], K[2])) / det, v3_dot(K[0], v3_cross(r, K[2])) / det,
            v3_dot(K[0], v3_cross(K[1], r)) / det);
}

static skf_vec3 turn(const skf_vec3 K[3], skf_vec3 J) {
  return v3_add(v3_scale(J.x, K[0]), v3_add(v3_scale(J.y, K[1]), v3_scale(J.z, K[2])));
}

static void apply(const skf_mover *m, double *y, const skf_attitude *a, skf_vec3 x, skf_vec3 impulse) {
  if (!m->free) return;
  skf_vec3 v = v3_mad(a->v, 1 / m->is.mass, impulse), L = v3_add(a->L, v3_cross(v3_sub(x, a->x), impulse));
  y[3] = v.x, y[4] = v.y, y[5] = v.z, y[10] = L.x, y[11] = L.y, y[12] = L.z;
}

/* The impulse between two whose places part by u with the speeds K J of an impulse J: restitution e, friction mu. */
static skf_vec3 impulse(const skf_vec3 K[3], skf_vec3 u, skf_vec3 n, double e, double mu) {
  double un = v3_dot(u, n);
  skf_vec3 slip = v3_mad(u, -un, n), J = v3_scale(-(1 + e) * un / v3_dot(n, turn(K, n)), n);
  if (!(mu > 0)) return J;
  /* what would end the slip, if friction reaches so far; else Coulomb's against the slip */
  skf_vec3 stick = skf_symmetric_solve(K, v3_sub(v3_scale(-e * un, n), u)), along = v3_mad(stick, -v3_dot(stick, n), n);
  if (v3_norm(along) <= mu * v3_dot(stick, n)) return stick;
  skf_vec3 way = v3_mad(n, -mu, v3_unit(slip));
  double Kn = v3_dot(n, turn(K, way));
  return Kn > 0 ? v3_scale(-(1 + e) * un / Kn, way) : J;
}

/* What an impulse adds to the kinetic energy. */
static double gain(const skf_vec3 K[3], skf_vec3 u, skf_vec3 J) { return v3_dot(J, v3_mad(u, 0.5, turn(K, J))); }

double skf_swarm_hop(const skf_swarm *s, const double *slope, size_t i, size_t j) {
  double a = 0, size = INFINITY, fast = 0;
  for (int k = 0; k < 2; k++) {
    size_t m = k ? j : i;
    const double *d = slope + m * SKF_MOVER_STATE + 3;
    if (!s->bodies[m].free) continue;
    skf_attitude at = skf_mover_at(s, s->y, m);
    fast += v3_norm(at.v) + skf_mover_reach(s->bodies + m) * v3_norm(at.w);
    a = fmax(a, v3_norm(v3(d[0], d[1], d[2]))), size = fmin(size, s->bodies[m].hull->radius);
  }
  return fmax(sqrt(2 * a * (s->options.restitution < 1 ? HOP : HOP_ELASTIC) * size), ROUNDING * fast);
}

bool skf_swarm_strike(skf_swarm *s, skf_rigid_hit *hit, double hop) {
  const skf_mover *a = s->bodies + hit->a, *b = s->bodies + hit->b;
  skf_attitude at_a = skf_mover_at(s, s->y, hit->a), at_b = skf_mover_at(s, s->y, hit->b);
  skf_vec3 n = hit->normal, u = v3_sub(speed(&at_b, hit->at), speed(&at_a, hit->at)), K[3];
  double un = v3_dot(u, n), e = s->options.restitution, mu = s->options.friction;
  hit->closing = -un;
  if (!(un < 0)) return false;
  if (e * hit->closing < hop) e = 0;
  for (int k = 0; k < 3; k++) {
    skf_vec3 unit = {k == 0, k == 1, k == 2};
    K[k] = v3_add(yields(a, &at_a, hit->at, unit), yields(b, &at_b, hit->at, unit));
  }
  skf_vec3 J = impulse(K, u, n, e, mu);
  for (int k = 0; mu > 0 && gain(K, u, J) > 0; k++) J = impulse(K, u, n, e, k < LESSER ? mu *= 0.9 : (mu = 0));
  hit->impulse = J;
  apply(a, s->y + hit->a * SKF_MOVER_STATE, &at_a, hit->at, v3_scale(-1, J));
  apply(b, s->y + hit->b * SKF_MOVER_STATE, &at_b, hit->at, J);
  return true;
}
