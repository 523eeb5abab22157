/* SPDX-License-Identifier: MIT */
/* Symmetric compositions of leapfrog with a fixed step: drift x += h v, t += h and kick v += h a(t, x), both exact
   maps. Time drifts with the particle; so in the frame that turns with the bodies the drift is the exact flow of p^2 /
   2 - omega . L and the kick that of the potential, and the map is symplectic there, too: the Jacobi constant, or
   without spin the energy, oscillates but does not drift. Weights: [Yoshida 1990, Phys. Lett. A 150, 262, solutions A
   of order 6 and D of order 8], [Suzuki 1990; McLachlan 1995, SIAM J. Sci. Comput. 16, 151, order 4 of five stages],
   [Kahan & Li 1997, Math. Comput. 66, 1089, orders 6 and 8 of 9 and 17 stages]. */
#include "motion/integrator.h"
#include <string.h>

/* Half of the symmetric weights, from the outermost one on; the middle one makes their sum 1. */
typedef struct scheme {
  int half;
  double outer[8];
} scheme;

static const scheme leapfrog = {0, {0}};
static const scheme yoshida4 = {1, {1.3512071919596576340}};
static const scheme mclachlan4 = {2, {0.41449077179437573714, 0.41449077179437573714}};
static const scheme yoshida6 = {3, {0.78451361047755726382, 0.23557321335935813368, -1.1776799841788710069}};
static const scheme kahan_li6 = {
    4, {0.39216144400731413928, 0.33259913678935943860, -0.70624617255763935981, 0.082213596293550800231}};
static const scheme yoshida8 = {7,
                                {0.914844246229740, 0.253693336566229, -1.44485223686048, -0.158240635368243,
                                 1.93813913762276, -1.96061023297549, 0.102799849391985}};
static const scheme kahan_li8 = {8,
                                 {0.13020248308889008088, 0.56116298177510838456, -0.38947496264484728641,
                                  0.15884190655515560090, -0.39590389413323757734, 0.18453964097831570709,
                                  0.25837438768632204729, 0.29501172360931029887}};

typedef struct symplectic {
  double done; /* last step, 0: none */
  skf_orbit from, to;
} symplectic;

static skf_status begin(void *work, skf_ode *ode, const skf_orbit *at, double h) {
  skf_vec3 a;
  (void)h;
  memset(work, 0, sizeof(symplectic));
  return skf_ode_eval(ode, at->t, v3_add(at->x, at->x_low), &a, NULL) ? SKF_OK : SKF_ERR_CONVERGENCE;
}

static double weight(const scheme *s, int stage) {
  int i = stage <= s->half ? stage : 2 * s->half - stage;
  if (i < s->half) return s->outer[i];
  double sum = 0;
  for (int k = 0; k < s->half; k++) sum += s->outer[k];
  return 1 - 2 * sum;
}

static void drift(skf_orbit *o, double h) {
  skf_orbit_add(&o->x, &o->x_low, v3_scale(h, o->v_low));
  skf_orbit_add(&o->x, &o->x_low, v3_scale(h, o->v));
}

static skf_status compose(const scheme *s, symplectic *w, skf_ode *ode, const skf_step_control *control,
                          skf_orbit *at) {
  int stages = 2 * s->half + 1;
  double h = control->step, before = 0, elapsed = 0;
  skf_orbit o = *at;
  for (int i = 0; i < stages; i++) {
    double share = weight(s, i), way = 0.5 * (before + share);
    skf_vec3 a;
    drift(&o, way * h);
    elapsed += way;
    if (!skf_ode_eval(ode, clock_add(at->t, elapsed * h), v3_add(o.x, o.x_low), &a, NULL)) return SKF_ERR_CONVERGENCE;
    skf_orbit_add(&o.v, &o.v_low, v3_scale(share * h, a));
    before = share;
  }
  drift(&o, 0.5 * before * h);
  o.t = clock_add(at->t, h);
  if (!(h > skf_step_floor(at->t)) || !v3_finite(o.x) || !v3_finite(o.v)) return SKF_ERR_CONVERGENCE;
  *w = (symplectic){h, *at, o};
  return *at = o, SKF_OK;
}

static skf_status dense(void *work, skf_ode *ode, skf_path *path) {
  const symplectic *w = work;
  return skf_path_between(ode, &w->from, &w->to, w->done, path);
}

/* A row of the registry for each scheme. */
#define SCHEME(name, title, text, of_order, of_dense)                                                                  \
  static skf_status step_##name(void *work, skf_ode *ode, const skf_step_control *c, skf_orbit *at,                    \
                                size_t *rejected) {                                                                    \
    (void)rejected;                                                                                                    \
    return compose(&name, work, ode, c, at);                                                                           \
  }                                                                                                                    \
  const skf_integrator_ops skf_integrator_##name = {.info = {title, text, of_order, of_dense, false},                  \
                                                    .takes = SKF_TAKES_PUSH,                                           \
                                                    .work_size = sizeof(symplectic),                                   \
                                                    .begin = begin,                                                    \
                                                    .step = step_##name,                                               \
                                                    .dense = dense};
SCHEME(leapfrog, "leapfrog", "symplectic, fixed step, 1 evaluation each", 2, 2)
SCHEME(yoshida4, "yoshida4", "symplectic, fixed step, 3 evaluations each", 4, 4)
SCHEME(mclachlan4, "mclachlan4", "symplectic, fixed step, 5 evaluations each", 4, 4)
SCHEME(yoshida6, "yoshida6", "symplectic, fixed step, 7 evaluations each", 6, 5)
SCHEME(kahan_li6, "kahan-li6", "symplectic, fixed step, 9 evaluations each", 6, 5)
SCHEME(yoshida8, "yoshida8", "symplectic, fixed step, 15 evaluations each", 8, 5)
SCHEME(kahan_li8, "kahan-li8", "symplectic, fixed step, 17 evaluations each, the best of order 8", 8, 5)
