/* SPDX-License-Identifier: MIT */
/* Gauss-Radau steps of particles that attract each other: one clock, one length of step for all of them. */
#ifndef SKF_MOTION_CROWD_H
#define SKF_MOTION_CROWD_H

#include "motion/gauss_radau.h"

/* All arrays have n entries. */
typedef struct skf_crowd {
  size_t n;
  const skf_radau_ops *ops;
  skf_gauss_radau **work;
  skf_orbit **orbit;
  /* Accelerations of all particles at one time; v and noise may be NULL. False when one is not finite. */
  bool (*eval)(void *user, skf_clock t, const skf_vec3 *x, const skf_vec3 *v, skf_vec3 *a, double *noise);
  void *user;
  bool drags; /* it reads v */
  skf_vec3 *x, *v, *a;
  double *noise;
  skf_radau_guess *guess;
  skf_gauss_radau *before;
} skf_crowd;

/* Forget the past; h is a first guess. SKF_ERR_CONVERGENCE when the force is not finite there. */
skf_status skf_crowd_begin(skf_crowd *c, double h);
/* One accepted step of all particles, of the same length, which the one that needs the shortest decides. On failure
   nothing has moved. */
skf_status skf_crowd_step(skf_crowd *c, double tolerance, double h_max, size_t *rejected);

#endif
