/* SPDX-License-Identifier: MIT */
/* 15th-order Gauss-Radau predictor-corrector for x'' = a(t, x) [Everhart 1985; Rein & Spiegel 2015, "IAS15"]: on a step
   a(s) = a0 + sum_k b_k s^(k+1) is the polynomial through eight Radau nodes, found by fixed-point iteration from the
   previous step's extrapolation, and summed with the rounding errors kept. */
#include "motion/gauss_radau.h"
#include <float.h>
#include <string.h>

enum { NODES = SKF_RADAU_NODES, TERMS = SKF_RADAU_TERMS };

/* 1 / ((k + 2)(k + 3)): the position's coefficient for b_k; 1 / (k + 2): the velocity's. */
static const double twice[TERMS] = {1.0 / 6, 1.0 / 12, 1.0 / 20, 1.0 / 30, 1.0 / 42, 1.0 / 56, 1.0 / 72};
static const double once[TERMS] = {1.0 / 2, 1.0 / 3, 1.0 / 4, 1.0 / 5, 1.0 / 6, 1.0 / 7, 1.0 / 8};

/* Sum of |db_6 / da(node j)|: what rounding errors of a become in b_6. */
#define AMPLIFICATION 1.15e4
/* The largest |s prod (s - node)| is 1.6e-4 and the first term left out some tenths of the last one kept: that one may
   be this many tolerances before the acceleration is off by a tolerance inside of the step. The error at its end, of
   order 15, is then far below. */
#define LAST_TERM 1e4
/* Margin of the check at the end of the step, in tolerances and in rounding errors. */
#define JOIN 64
static skf_status begin(void *work, skf_ode *ode, const skf_orbit *at, double h) {
  skf_gauss_radau *w = work;
  memset(w, 0, sizeof *w);
  w->h = h;
  return skf_ode_feel(ode, at->t, v3_add(at->x, at->x_low), v3_add(at->v, at->v_low), &w->a0, &w->noise)
             ? SKF_OK
             : SKF_ERR_CONVERGENCE;
}

/* One sweep over the nodes. Returns false where the force is not finite. */
static bool sweep(skf_gauss_radau *w, skf_ode *ode, double h, skf_radau_guess *u) {
  u->size = skf_radau_size(w->a0);
  for (int n = 1; n < NODES; n++) {
    skf_vec3 a, x, v = w->from.v;
    double noise = 0;
    u->ops->place(u, h, n, &x, ode->drag ? &v : NULL);
    if (!skf_ode_feel(ode, clock_add(w->from.t, h * skf_radau_node[n]), x, v, &a, skf_radau_listens(n) ? &noise : NULL))
      return false;
    skf_radau_learn(w, n, a, noise, u);
  }
  return true;
}

bool skf_radau_settled(const skf_radau_guess *u) { return !(u->change > 0.1 * DBL_EPSILON * u->size); }
bool skf_radau_will_do(const skf_gauss_radau *w, const skf_radau_guess *u) {
  return u->change <= 1e-6 * u->size || u->change <= AMPLIFICATION * w->noise;
}

/* Solves for b on a step of length h. False when it does not settle or the force is not finite. */
static bool solve(skf_gauss_radau *w, skf_ode *ode, double h, skf_radau_guess *u) {
  double last = INFINITY;
  for (int i = 0; i < SKF_RADAU_SWEEPS; i++) {
    if (!sweep(w, ode, h, u)) return false;
    if (skf_radau_settled(u)) return true;
    if (i > 1 && u->change >= last) return skf_radau_will_do(w, u);
    last = u->change;
  }
  return u->change <= 1e-9 * u->size;
}

/* Small terms first, the products with h exact. */
void skf_radau_finish(skf_gauss_radau *w, const skf_radau_guess *u, double h, skf_orbit *at) {
  memcpy(w->b, u->b, sizeof w->b);
  memcpy(w->e, u->e, sizeof w->e);
  w->from_a = w->a0;
  w->done = h;
  skf_vec3 dv = {0, 0, 0}, dx = {0, 0, 0};
  for (int k = TERMS; k-- > 0;) {
    dv = v3_mad(dv, once[k], skf_row_vec(w->b + k));
    dx = v3_mad(dx, twice[k], skf_row_vec(w->b + k));
  }
  dv = v3_add(dv, w->from_a);
  dx = v3_mad(dx, 0.5, w->from_a);
  skf_vec3 v = w->from.v, hv = v3_scale(h, v);
  skf_vec3 rest = v3(fma(h, v.x, -hv.x), fma(h, v.y, -hv.y), fma(h, v.z, -hv.z));
  skf_orbit_add(&at->x, &at->x_low, v3_mad(rest, h, w->from.v_low));
  skf_orbit_add(&at->x, &at->x_low, v3_scale(h * h, dx));
  skf_orbit_add(&at->x, &at->x_low, hv);
  skf_orbit_add(&at->v, &at->v_low, v3_scale(h, dv));
  at->t = clock_add(at->t, h);
}

/* An error of the acceleration counts relative to the acceleration, or, where that hardly matters, to the velocity;
   what rounding makes of b_6 is no error. */
double skf_radau_share(const skf_gauss_radau *w, const skf_radau_guess *u, double h, double tolerance) {
  double allowed = tolerance * (LAST_TERM * u->size + skf_radau_size(w->from.v) / h);
  double error = skf_radau_size(skf_row_vec(u->b + TERMS - 1)) - AMPLIFICATION * w->noise;
  if (!(error > 0)) return 4;
  return fmin(4, pow(allowed / error, 1.0 / TERMS));
}

/* The acceleration at the end of the step is known for the next one: where it is not what the polynomial says, the
   force has a join that no node has seen. A smooth force differs there by less than the tolerance, see LAST_TERM. */
bool skf_radau_meets(const skf_gauss_radau *w, double h, double size, double tolerance, skf_vec3 a) {
  skf_vec3 end = w->from_a;
  for (int k = 0; k < TERMS; k++) end = v3_add(end, skf_row_vec(w->b + k));
  double allowed = tolerance * (JOIN * size + skf_radau_size(w->from.v) / h) + JOIN * w->noise;
  return skf_radau_size(v3_sub(end, a)) <= allowed;
}

/* One attempt. Returns the share of h that would meet the tolerance; below REFUSE the step has not been taken. */
static double attempt(skf_gauss_radau *w, skf_ode *ode, double h, double tolerance, skf_orbit *at) {
  skf_gauss_radau before = *w;
  skf_radau_guess u;
  skf_radau_predict(skf_radau_get(ode->isa), w, h, &u);
  if (!solve(w, ode, h, &u)) return 0.25;
  double q = skf_radau_share(w, &u, h, tolerance);
  if (q < SKF_RADAU_REFUSE) return fmax(q, 0.1);
  skf_orbit next = *at;
  skf_radau_finish(w, &u, h, &next);
  bool finite = skf_ode_feel(ode, next.t, v3_add(next.x, next.x_low), v3_add(next.v, next.v_low), &w->a0, NULL);
  if (!finite || !skf_radau_meets(w, h, u.size, tolerance, w->a0)) return *w = before, 0.25;
  return *at = next, q;
}

static skf_status step(void *work, skf_ode *ode, const skf_step_control *control, skf_orbit *at, size_t *rejected) {
  skf_gauss_radau *w = work;
  double h = fmin(w->h, control->h_max);
  w->from = *at;
  for (;; (*rejected)++) {
    if (!(h > skf_step_floor(at->t)) || !isfinite(h)) return SKF_ERR_CONVERGENCE;
    double q = attempt(w, ode, h, control->tolerance, at);
    if (q >= SKF_RADAU_REFUSE) return w->h = h * q, SKF_OK;
    h *= q;
  }
}

static skf_status dense(void *work, skf_ode *ode, skf_path *path) {
  (void)ode;
  const skf_gauss_radau *w = work;
  double h = w->done;
  *path = skf_path_begin(&w->from, h, TERMS + 2);
  path->x[0] = v3_scale(h, path->v0);
  path->x[1] = v3_scale(0.5 * h * h, w->from_a);
  path->v[0] = v3_scale(h, w->from_a);
  for (int k = 0; k < TERMS; k++) {
    path->x[k + 2] = v3_scale(h * h * twice[k], skf_row_vec(w->b + k));
    path->v[k + 1] = v3_scale(h * once[k], skf_row_vec(w->b + k));
  }
  return SKF_OK;
}

const skf_integrator_ops skf_integrator_gauss_radau = {
    .info = {"gauss-radau", "15th-order Gauss-Radau predictor-corrector, good to rounding over long runs", 15, 9, true},
    .takes = SKF_TAKES_DRAG,
    .work_size = sizeof(skf_gauss_radau),
    .begin = begin,
    .step = step,
    .dense = dense,
    .pass = skf_radau_pass,
    .path_is_free = true,
};
