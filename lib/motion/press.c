/* SPDX-License-Identifier: MIT */
/* Impulses at many places at once: projected Gauss and Seidel's method, place after place until nothing changes. */
#include "motion/swarm.h"
#include "core/alloc.h"

#define DONE 1e-14 /* relative change of the speeds */
enum { SWEEPS = 3000 };

/* A place with what an impulse there does. */
typedef struct lever {
  skf_vec3 arm_a, arm_b;
  double Kn, Kt; /* speed along the normal, and bound of that along the surface, per unit of impulse */
  double Kr;     /* bound of the turn per unit of angular momentum */
} lever;

static skf_vec3 spin_after(const skf_mover *m, const double q[4], skf_vec3 arm, skf_vec3 J) {
  return skf_mover_spin(m, q, v3_cross(arm, J));
}

/* Speed there per unit of impulse along n, along n; and the sum of both bodies' traces as a bound for all directions.
 */
static double yields(const skf_mover *m, const double q[4], skf_vec3 arm, skf_vec3 n) {
  if (!m->free) return 0;
  return 1 / m->is.mass + v3_dot(n, v3_cross(spin_after(m, q, arm, n), arm));
}

static skf_vec3 speed(const skf_swarm *s, const skf_attitude *at, const double *v, size_t i, skf_vec3 arm) {
  if (!s->bodies[i].free) return v3(0, 0, 0);
  const double *p = v + 6 * i;
  skf_vec3 w = skf_mover_spin(s->bodies + i, at->q, v3(p[3], p[4], p[5]));
  return v3_add(v3(p[0], p[1], p[2]), v3_cross(w, arm));
}

static void push(const skf_swarm *s, double *v, size_t i, skf_vec3 arm, skf_vec3 J) {
  if (!s->bodies[i].free) return;
  double *p = v + 6 * i, m = s->bodies[i].is.mass;
  skf_vec3 L = v3_cross(arm, J);
  p[0] += J.x / m, p[1] += J.y / m, p[2] += J.z / m, p[3] += L.x, p[4] += L.y, p[5] += L.z;
}

static void apply(const skf_swarm *s, double *v, const skf_press *p, const lever *l, skf_vec3 J) {
  push(s, v, p->a, l->arm_a, v3_scale(-1, J));
  push(s, v, p->b, l->arm_b, J);
}

/* The same for angular momentum alone. */
static void turn(const skf_swarm *s, double *v, const skf_press *p, skf_vec3 L) {
  for (int k = 0; k < 2; k++) {
    size_t i = k ? p->b : p->a;
    double *to = v + 6 * i + 3, sign = k ? 1 : -1;
    if (s->bodies[i].free) to[0] += sign * L.x, to[1] += sign * L.y, to[2] += sign * L.z;
  }
}

static double trace(const skf_mover *m) { return m->free ? m->inverse[0] + m->inverse[3] + m->inverse[5] : 0; }

static skf_vec3 slip_at(const skf_swarm *s, const skf_attitude *at, const double *v, const skf_press *p,
                        const lever *l) {
  return v3_sub(speed(s, at + p->b, v, p->b, l->arm_b), speed(s, at + p->a, v, p->a, l->arm_a));
}

static skf_vec3 spin_of(const skf_swarm *s, const skf_attitude *at, const double *v, size_t i) {
  const double *p = v + 6 * i;
  return s->bodies[i].free ? skf_mover_spin(s->bodies + i, at[i].q, v3(p[3], p[4], p[5])) : v3(0, 0, 0);
}

static skf_vec3 clamp(skf_vec3 x, double most) {
  double size = v3_norm(x);
  return size > most ? v3_scale(most / size, x) : x;
}

/* One place: what it takes for its want, friction within the cone, and what slows the rolling; returns the change of
   speed. */
static double relax(const skf_swarm *s, const skf_attitude *at, double *v, skf_press *p, const lever *l) {
  double old = v3_dot(p->impulse, p->normal),
         normal = fmax(0, old - (v3_dot(slip_at(s, at, v, p, l), p->normal) - p->want) / l->Kn);
  double change = fabs(normal - old) * l->Kn;
  skf_vec3 along = v3_mad(p->impulse, -old, p->normal);
  apply(s, v, p, l, v3_scale(normal - old, p->normal));
  if (p->friction > 0) {
    skf_vec3 u = slip_at(s, at, v, p, l), slip = v3_mad(u, -v3_dot(u, p->normal), p->normal);
    skf_vec3 next = clamp(v3_mad(along, -1 / l->Kt, slip), p->friction * normal), more = v3_sub(next, along);
    apply(s, v, p, l, more);
    along = next, change += v3_norm(more) * l->Kt;
  }
  p->impulse = v3_mad(along, normal, p->normal);
  if (p->rolling > 0) {
    skf_vec3 w = v3_sub(spin_of(s, at, v, p->b), spin_of(s, at, v, p->a));
    skf_vec3 next = clamp(v3_mad(p->twist, -1 / l->Kr, w), p->rolling * normal), more = v3_sub(next, p->twist);
    turn(s, v, p, more);
    p->twist = next, change += v3_norm(more) * l->Kr * fmax(v3_norm(l->arm_a), v3_norm(l->arm_b));
  }
  return change;
}

skf_status skf_press_solve(const skf_swarm *s, const double *y, skf_press *p, size_t n, double *v) {
  skf_attitude *at = skf_alloc(s->n, sizeof *at);
  lever *l = skf_alloc(n, sizeof *l);
  skf_status status = at && l ? SKF_OK : SKF_ERR_NOMEM;
  double fast = 0;
  for (size_t i = 0; i < s->n && !status; i++) at[i] = skf_mover_at(s, y, i);
  for (size_t k = 0; k < n && !status; k++) {
    const skf_mover *a = s->bodies + p[k].a, *b = s->bodies + p[k].b;
    const skf_attitude *pa = at + p[k].a, *pb = at + p[k].b;
    skf_vec3 N = p[k].normal, e = v3_perp(N), f = v3_cross(N, e);
    l[k].arm_a = v3_sub(p[k].at, pa->x), l[k].arm_b = v3_sub(p[k].at, pb->x);
    l[k].Kn = yields(a, pa->q, l[k].arm_a, N) + yields(b, pb->q, l[k].arm_b, N);
    l[k].Kt = yields(a, pa->q, l[k].arm_a, e) + yields(b, pb->q, l[k].arm_b, e) + yields(a, pa->q, l[k].arm_a, f) +
              yields(b, pb->q, l[k].arm_b, f);
    l[k].Kr = trace(a) + trace(b);
    apply(s, v, p + k, l + k, p[k].impulse), turn(s, v, p + k, p[k].twist);
    fast = fmax(fast, fabs(p[k].want) + v3_norm(p[k].impulse) * l[k].Kn);
  }
  for (size_t i = 0; i < 6 * s->n; i++)
    if (i % 6 < 3) fast = fmax(fast, fabs(v[i]));
  for (int sweep = 0; sweep < SWEEPS && !status; sweep++) {
    double change = 0;
    for (size_t k = 0; k < n; k++) change = fmax(change, relax(s, at, v, p + k, l + k));
    if (change <= DONE * fast) break;
  }
  skf_free(at), skf_free(l);
  return status;
}
