/* SPDX-License-Identifier: MIT */
/* Forces and torques between rigid bodies. */
#include "motion/swarm.h"
#include <string.h>

/* M v for a symmetric M of the body's frame, of which six are known. */
static skf_vec3 times(const double M[6], const double q[4], skf_vec3 v) {
  skf_vec3 b = quat_turn(q, -1, v);
  b = v3(M[0] * b.x + M[1] * b.y + M[2] * b.z, M[1] * b.x + M[3] * b.y + M[4] * b.z,
         M[2] * b.x + M[4] * b.y + M[5] * b.z);
  return quat_turn(q, 1, b);
}

skf_vec3 skf_mover_spin(const skf_mover *m, const double q[4], skf_vec3 L) { return times(m->inverse, q, L); }
skf_vec3 skf_mover_spun(const skf_mover *m, const double q[4], skf_vec3 w) { return times(m->inertia, q, w); }

skf_attitude skf_mover_at(const skf_swarm *s, const double *y, size_t i) {
  const double *p = y + i * SKF_MOVER_STATE;
  skf_attitude a = {
      v3(p[0], p[1], p[2]), v3(p[3], p[4], p[5]), v3(p[10], p[11], p[12]), {0, 0, 0}, {p[6], p[7], p[8], p[9]}};
  quat_normalize(a.q);
  if (s->bodies[i].free) a.w = skf_mover_spin(s->bodies + i, a.q, a.L);
  return a;
}

/* Sums over the nodes of i in the field of j, times share: force and torque on i, torque on j, potential energy. */
typedef struct grip {
  skf_vec3 force, torque, back;
  double energy;
} grip;

static void feel(const skf_swarm *s, size_t i, const skf_attitude *at_i, size_t j, const skf_attitude *at_j,
                 double share, grip *g) {
  const skf_mover *a = s->bodies + i, *b = s->bodies + j;
  double gain = s->options.G * b->is.density * share;
  for (size_t k = 0; k < a->nodes; k++) {
    skf_vec3 arm = quat_turn(at_i->q, 1, a->node[k].at), from = v3_sub(v3_add(at_i->x, arm), at_j->x), grad;
    double F = skf_field_at(b->is.field, v3_add(b->center, quat_turn(at_j->q, -1, from)), &grad);
    skf_vec3 f = v3_scale(gain * a->node[k].mass, quat_turn(at_j->q, 1, grad));
    g->force = v3_add(g->force, f);
    g->torque = v3_add(g->torque, v3_cross(arm, f));
    g->back = v3_sub(g->back, v3_cross(from, f));
    g->energy -= gain * a->node[k].mass * F;
  }
}

/* Force on i, torques on both. */
static grip between(const skf_swarm *s, size_t i, const skf_attitude *at_i, size_t j, const skf_attitude *at_j) {
  grip g = {.energy = 0}, h = {.energy = 0};
  bool both = s->bodies[i].nodes && s->bodies[j].nodes;
  feel(s, i, at_i, j, at_j, both ? 0.5 : 1, &g);
  feel(s, j, at_j, i, at_i, both ? 0.5 : 1, &h);
  g.force = v3_sub(g.force, h.force);
  g.torque = v3_add(g.torque, h.back), g.back = v3_add(g.back, h.torque);
  g.energy += h.energy;
  return g;
}

static void put(double *y, skf_vec3 v, double factor) {
  y[0] += factor * v.x, y[1] += factor * v.y, y[2] += factor * v.z;
}

bool skf_swarm_slope(const skf_swarm *s, const double *y, double *dy) {
  memset(dy, 0, s->n * SKF_MOVER_STATE * sizeof *dy);
  for (size_t i = 0; i < s->n; i++) {
    if (!s->bodies[i].free) continue;
    skf_attitude a = skf_mover_at(s, y, i);
    double *d = dy + i * SKF_MOVER_STATE, w[4] = {0, a.w.x, a.w.y, a.w.z}, turn[4];
    quat_times(w, a.q, turn);
    put(d, a.v, 1), put(d + 3, s->options.gravity, 1);
    for (int k = 0; k < 4; k++) d[6 + k] = 0.5 * turn[k];
  }
  for (size_t i = 0; i < s->n && s->options.G != 0; i++)
    for (size_t j = i + 1; j < s->n; j++) {
      const skf_mover *a = s->bodies + i, *b = s->bodies + j;
      if (!a->free && !b->free) continue;
      skf_attitude at_i = skf_mover_at(s, y, i), at_j = skf_mover_at(s, y, j);
      grip g = between(s, i, &at_i, j, &at_j);
      double *di = dy + i * SKF_MOVER_STATE, *dj = dy + j * SKF_MOVER_STATE;
      if (!v3_finite(g.force) || !v3_finite(g.torque) || !v3_finite(g.back)) return false;
      if (a->free) put(di + 3, g.force, 1 / a->is.mass), put(di + 10, g.torque, 1);
      if (b->free) put(dj + 3, g.force, -1 / b->is.mass), put(dj + 10, g.back, 1);
    }
  return true;
}

double skf_swarm_potential(const skf_swarm *s, const double *y) {
  double U = 0;
  for (size_t i = 0; i < s->n; i++) {
    skf_attitude a = skf_mover_at(s, y, i);
    if (s->bodies[i].free) U -= s->bodies[i].is.mass * v3_dot(s->options.gravity, a.x);
    for (size_t j = i + 1; j < s->n && s->options.G != 0; j++) {
      if (!s->bodies[i].free && !s->bodies[j].free) continue;
      skf_attitude b = skf_mover_at(s, y, j);
      U += between(s, i, &a, j, &b).energy;
    }
  }
  return U;
}
