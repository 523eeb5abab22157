/* SPDX-License-Identifier: MIT */
/* The row that each integrator's file gives to the registry. */
#ifndef SKF_MOTION_INTEGRATOR_H
#define SKF_MOTION_INTEGRATOR_H

#include "skelfield/motion.h"
#include "core/sum.h"
#include "field/some.h"
#include "motion/path.h"
#include "motion/world.h"
#include "simd/isa.h"

/* x'' = a(t, x). `eval` returns false where the acceleration is not finite; *noise, if asked for, is the size of its
   rounding error. */
typedef struct skf_ode {
  bool (*eval)(const void *user, skf_clock t, const skf_vec3 *x, skf_vec3 *a, double *noise);
  /* The same for n particles, each at a time of its own: p[0..2], a[0..2], which are NAN where they are not finite. The
     same bits as of `eval`. */
  void (*many)(const void *user, size_t n, const double *t_hi, const double *t_lo, const double *const p[3],
               double *const a[3], double *noise);
  /* Acceleration and its derivative along the motion. */
  bool (*jerk)(const void *user, skf_clock t, skf_vec3 x, skf_vec3 v, skf_vec3 *a, skf_vec3 *jerk);
  /* Adds what depends on the velocity; NULL when nothing does. */
  bool (*drag)(const void *user, skf_clock t, skf_vec3 x, skf_vec3 v, skf_vec3 *a);
  const void *user;
  /* A body at rest that makes all of the force, so that the world need not be asked, and its field's call in registers
     for code of the instruction set `isa`; or NULL. */
  const skf_world_body *lone;
  skf_quick *quick;
  const struct skf_tile *tile;
  bool timed; /* the force depends on t; else t may be anything */
  skf_isa isa;
  size_t evaluations;
} skf_ode;

/* Particles side by side where many are integrated at once. */
enum { SKF_FLOCK = 32 };

/* Where a particle is, with the rounding errors of the running sums. */
typedef struct skf_orbit {
  skf_clock t;
  skf_vec3 x, v, x_low, v_low;
} skf_orbit;

typedef struct skf_step_control {
  double tolerance;
  double h_max; /* never step further than this */
  double step;  /* of those with a fixed one, which know neither tolerance nor h_max */
} skf_step_control;

/* Hears of contacts, of the i-th flight of several. */
typedef struct skf_listener {
  skf_status (*told)(void *user, size_t i, const skf_contact *contact);
  void *user;
} skf_listener;

/* One of many particles that fly at once. */
typedef struct skf_lane skf_lane;
struct skf_lane {
  void *work;
  skf_orbit *orbit;
  skf_clock *from; /* start of the last step */
  skf_flight_report *report;
  size_t *evaluations;
  double tolerance;
  double (*longest)(const skf_flight *flight, const skf_orbit *at); /* step from there */
  /* Looks at the step that has been taken, and may change the orbit and begin it anew; false when it ends here. NULL:
     no need to. */
  bool (*moved)(skf_lane *lane);
  skf_flight *flight;
  size_t index; /* of the flight among all */
  const skf_listener *listener;
  skf_status status;
};

/* Forces that an integrator takes besides gravity. */
typedef enum skf_takes { SKF_TAKES_NONE, SKF_TAKES_PUSH, SKF_TAKES_DRAG } skf_takes;

/* One file per integrator. `work` is work_size bytes of its own. */
typedef struct skf_integrator_ops {
  skf_integrator_info info;
  skf_takes takes;
  size_t work_size;
  /* Forget the past: a new orbit begins; h is a first guess. SKF_ERR_CONVERGENCE when the force is not finite there. */
  skf_status (*begin)(void *work, skf_ode *ode, const skf_orbit *at, double h);
  /* Advance *at by one accepted step, counting those that were refused. On failure *at is as it was. */
  skf_status (*step)(void *work, skf_ode *ode, const skf_step_control *control, skf_orbit *at, size_t *rejected);
  /* The path of the last step. */
  skf_status (*dense)(void *work, skf_ode *ode, skf_path *path);
  /* Steps of many particles until each one's orbit has reached a time, or its status tells why not; passes over those
     that have a status already. The same bits as of `step`. NULL: they fly one after the other. */
  void (*pass)(const skf_ode *ode, skf_lane *lanes, size_t n, double until);
  /* `dense` evaluates no force, and `pass` calls `moved`: flights with contact go side by side, too. */
  bool path_is_free;
} skf_integrator_ops;

extern const skf_integrator_ops skf_integrator_gauss_radau, skf_integrator_dop853, skf_integrator_rkn12,
    skf_integrator_leapfrog, skf_integrator_yoshida4, skf_integrator_mclachlan4, skf_integrator_yoshida6,
    skf_integrator_kahan_li6, skf_integrator_yoshida8, skf_integrator_kahan_li8, skf_integrator_hermite4;

const skf_integrator_ops *skf_integrator_row(const char *name);

/* The smallest step that still moves the clock by a few units in the last place. */
static inline double skf_step_floor(skf_clock t) { return 64 * 2.220446049250313e-16 * fabs(t.hi); }

static inline bool skf_ode_eval(skf_ode *ode, skf_clock t, skf_vec3 x, skf_vec3 *a, double *noise) {
  ode->evaluations++;
  if (!ode->lone) return ode->eval(ode->user, t, &x, a, noise);
  double v[4], gain = ode->lone->is.gain;
  skf_field_point(ode->lone->is.field, &x, v);
  *a = v3(0 + gain * v[1], 0 + gain * v[2], 0 + gain * v[3]); /* never -0, as in a sum */
  if (noise) *noise = skf_body_noise(ode->lone, x, v[0], v3(v[1], v[2], v[3]));
  return isfinite(v[0]) && v3_finite(*a);
}

/* The same where the velocity is known. */
static inline bool skf_ode_feel(skf_ode *ode, skf_clock t, skf_vec3 x, skf_vec3 v, skf_vec3 *a, double *noise) {
  return skf_ode_eval(ode, t, x, a, noise) && (!ode->drag || ode->drag(ode->user, t, x, v, a));
}

/* The polynomial of degree 5 through position, velocity and acceleration at both ends of a step: a path for integrators
   that have none of their own. */
skf_status skf_path_between(skf_ode *ode, const skf_orbit *from, const skf_orbit *to, double h, skf_path *path);

/* A path whose terms are still to come. The errors of the running sums belong to its start: in a long run they are many
   roundings. */
static inline skf_path skf_path_begin(const skf_orbit *from, double h, int degree) {
  return (skf_path){
      .t0 = from->t, .h = h, .degree = degree, .x0 = v3_add(from->x, from->x_low), .v0 = v3_add(from->v, from->v_low)};
}

/* A step has been taken from `from` to *to. */
static inline void skf_lane_count(skf_lane *lane, skf_clock from, const skf_orbit *to) {
  double h = clock_since(to->t.hi, from) + to->t.lo;
  skf_flight_report *r = lane->report;
  r->steps++;
  r->h_min = h < r->h_min ? h : r->h_min;
  r->h_max = h > r->h_max ? h : r->h_max;
  *lane->from = from;
}

/* x += by d, errors kept. */
static inline void skf_orbit_add(skf_vec3 *x, skf_vec3 *low, skf_vec3 d) {
  sum_add_to(&x->x, &low->x, d.x);
  sum_add_to(&x->y, &low->y, d.y);
  sum_add_to(&x->z, &low->z, d.z);
}

#endif
