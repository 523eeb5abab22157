/* SPDX-License-Identifier: MIT */
/* The 12(10) Nystrom pair: control of the step, and its path as a polynomial. */
#include "motion/nystrom.h"
#include <string.h>

const skf_nystrom_ops *skf_nystrom_get(skf_isa isa) {
#ifdef SKF_HAVE_AVX2
  if (isa != SKF_ISA_SCALAR) return &skf_nystrom_avx2;
#endif
  (void)isa;
  return &skf_nystrom_base;
}

static skf_status begin(void *work, skf_ode *ode, const skf_orbit *at, double h) {
  skf_nystrom *w = work;
  skf_vec3 a;
  memset(w, 0, sizeof *w);
  w->h = h;
  return skf_ode_eval(ode, at->t, v3_add(at->x, at->x_low), &a, NULL) ? SKF_OK : SKF_ERR_CONVERGENCE;
}

static void put(double *to, skf_vec3 p) { to[0] = p.x, to[1] = p.y, to[2] = p.z, to[3] = 0; }
static skf_vec3 get(const double *p) { return v3(p[0], p[1], p[2]); }

static void set(skf_nystrom_one *s, const skf_orbit *at, double tolerance) {
  s->tolerance[0] = tolerance;
  s->t_hi[0] = at->t.hi, s->t_lo[0] = at->t.lo;
  put(s->x, at->x), put(s->x_low, at->x_low), put(s->v, at->v), put(s->v_low, at->v_low);
}

static skf_orbit end_of(const skf_nystrom_one *s) {
  return (skf_orbit){clock_add((skf_clock){s->t_hi[0], s->t_lo[0]}, s->h[0]), get(s->to_x), get(s->to_v),
                     get(s->to_x_low), get(s->to_v_low)};
}

static skf_status step(void *work, skf_ode *ode, const skf_step_control *control, skf_orbit *at, size_t *rejected) {
  skf_nystrom *w = work;
  const skf_nystrom_ops *ops = skf_nystrom_get(ode->isa);
  skf_nystrom_one s;
  double h = fmin(w->h, control->h_max);
  set(&s, at, control->tolerance);
  for (bool refused = false;; (*rejected)++, refused = true) {
    if (!(h > skf_step_floor(at->t)) || !isfinite(h)) return SKF_ERR_CONVERGENCE;
    s.h[0] = h;
    ops->one(&s, ode);
    ode->evaluations += SKF_NYSTROM_STAGES;
    double factor = skf_nystrom_factor(s.error[0], s.root[0], h, w->done, &w->root, refused);
    if (s.error[0] <= 1) {
      *w = (skf_nystrom){h * factor, h, w->root, *at, end_of(&s)};
      return *at = w->to, SKF_OK;
    }
    h *= factor;
  }
}

/* ---- Dense output: the Hermite polynomial through position, velocity and acceleration at five times of the step, the
   inner ones the ends of shorter steps from its start ---- */

enum { KNOTS = 5, TERMS = 3 * KNOTS };

/* x(s) - x0 of one coordinate: d[k] the data (value, first, half the second derivative by s) of knot k at s = k / 4;
   out: its powers from s on. Divided differences with each knot three times, then Newton's form as powers. */
static void interpolate(double d[KNOTS][3], double out[TERMS]) {
  double table[TERMS], power[TERMS] = {0};
  for (int i = 0; i < TERMS; i++) table[i] = d[i / 3][0];
  for (int order = 1; order < TERMS; order++)
    for (int i = TERMS - 1; i >= order; i--) {
      int a = (i - order) / 3, b = i / 3;
      table[i] = a == b ? d[a][order] : 4 * (table[i] - table[i - 1]) / (b - a);
    }
  for (int i = TERMS; i-- > 0;) {
    double at = 0.25 * (i / 3);
    for (int k = TERMS - 1; k > 0; k--) power[k] = power[k - 1] - at * power[k];
    power[0] = table[i] - at * power[0];
  }
  memcpy(out, power, sizeof power);
}

static skf_status dense(void *work, skf_ode *ode, skf_path *path) {
  skf_nystrom *w = work;
  const skf_nystrom_ops *ops = skf_nystrom_get(ode->isa);
  double h = w->done, d[3][KNOTS][3];
  skf_nystrom_one s;
  set(&s, &w->from, 1);
  for (int k = 0; k < KNOTS; k++) {
    skf_orbit at = k == 0 ? w->from : w->to;
    skf_vec3 a;
    if (k > 0 && k + 1 < KNOTS) {
      s.h[0] = 0.25 * k * h;
      ops->one(&s, ode);
      ode->evaluations += SKF_NYSTROM_STAGES;
      at = end_of(&s);
    }
    if (!skf_ode_eval(ode, at.t, v3_add(at.x, at.x_low), &a, NULL)) return SKF_ERR_CONVERGENCE;
    skf_vec3 x = v3_add(v3_sub(at.x, w->from.x), v3_sub(at.x_low, w->from.x_low));
    skf_vec3 v = v3_scale(h, v3_add(at.v, at.v_low));
    for (int c = 0; c < 3; c++)
      d[c][k][0] = v3_get(x, c), d[c][k][1] = v3_get(v, c), d[c][k][2] = 0.5 * h * h * v3_get(a, c);
  }
  *path = skf_path_begin(&w->from, h, TERMS - 1);
  for (int c = 0; c < 3; c++) {
    double power[TERMS];
    interpolate(d[c], power);
    *v3_at(&path->v0, c) = power[1] / h;
    for (int k = 1; k < TERMS; k++) *v3_at(path->x + k - 1, c) = power[k];
    for (int k = 2; k < TERMS; k++) *v3_at(path->v + k - 2, c) = k * power[k] / h;
  }
  return SKF_OK;
}

const skf_integrator_ops skf_integrator_rkn12 = {
    .info = {"rkn12", "12(10) Nystrom pair of Dormand, El-Mikkawy and Prince: the fastest without contact", 12, 12,
             true},
    .takes = SKF_TAKES_PUSH,
    .work_size = sizeof(skf_nystrom),
    .begin = begin,
    .step = step,
    .dense = dense,
    .pass = skf_nystrom_pass,
};
