/* SPDX-License-Identifier: MIT */
/* The 4th-order Hermite scheme from accelerations and their derivatives [Makino & Aarseth 1992, PASJ 44, 141], with a
   fixed step and the corrector repeated until it is symmetric in time [Kokubo, Yoshinaga & Makino 1998, MNRAS 297,
   1067]: periodic orbits do not drift. */
#include "motion/integrator.h"
#include <string.h>

/* The corrector's error falls by about (omega h)^2 each time. */
enum { ITERATIONS = 3 };

typedef struct hermite4 {
  double done; /* last step, 0: none */
  skf_vec3 a, jerk;
  skf_orbit from, to;
} hermite4;

static skf_status begin(void *work, skf_ode *ode, const skf_orbit *at, double h) {
  hermite4 *w = work;
  (void)h;
  memset(w, 0, sizeof *w);
  skf_vec3 x = v3_add(at->x, at->x_low), v = v3_add(at->v, at->v_low);
  ode->evaluations++;
  return ode->jerk(ode->user, at->t, x, v, &w->a, &w->jerk) ? SKF_OK : SKF_ERR_CONVERGENCE;
}

static skf_status step(void *work, skf_ode *ode, const skf_step_control *control, skf_orbit *at, size_t *rejected) {
  hermite4 *w = work;
  double h = control->step;
  skf_clock t = clock_add(at->t, h);
  skf_vec3 v0 = v3_add(at->v, at->v_low), a = w->a, jerk = w->jerk;
  (void)rejected;
  if (!(h > skf_step_floor(at->t))) return SKF_ERR_CONVERGENCE;
  /* what the step adds to position and velocity, without the drift h v0 */
  skf_vec3 dv = v3_scale(h, v3_mad(a, h / 2, jerk)), dx = v3_scale(h * h / 2, v3_mad(a, h / 3, jerk));
  for (int i = 0; i < ITERATIONS; i++) {
    skf_vec3 x = v3_add(at->x, v3_add(at->x_low, v3_mad(dx, h, v0)));
    ode->evaluations++;
    if (!ode->jerk(ode->user, t, x, v3_add(v0, dv), &a, &jerk)) return SKF_ERR_CONVERGENCE;
    dv = v3_mad(v3_scale(h / 2, v3_add(w->a, a)), h * h / 12, v3_sub(w->jerk, jerk));
    dx = v3_mad(v3_scale(h / 2, dv), h * h / 12, v3_sub(w->a, a));
  }
  skf_orbit o = *at;
  o.t = t;
  skf_orbit_add(&o.x, &o.x_low, dx);
  skf_orbit_add(&o.x, &o.x_low, v3_scale(h, at->v_low));
  skf_orbit_add(&o.x, &o.x_low, v3_scale(h, at->v));
  skf_orbit_add(&o.v, &o.v_low, dv);
  *w = (hermite4){h, a, jerk, *at, o};
  return *at = o, SKF_OK;
}

static skf_status dense(void *work, skf_ode *ode, skf_path *path) {
  const hermite4 *w = work;
  return skf_path_between(ode, &w->from, &w->to, w->done, path);
}

const skf_integrator_ops skf_integrator_hermite4 = {
    .info = {"hermite4", "Hermite, symmetric in time, fixed step, 3 evaluations with jerk each", 4, 4, false},
    .work_size = sizeof(hermite4),
    .begin = begin,
    .step = step,
    .dense = dense,
};
