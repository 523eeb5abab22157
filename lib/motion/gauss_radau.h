/* SPDX-License-Identifier: MIT */
/* The parts of a Gauss-Radau step, for one particle (gauss_radau.c) and for many that attract each other (crowd.c). */
#ifndef SKF_MOTION_GAUSS_RADAU_H
#define SKF_MOTION_GAUSS_RADAU_H

#include "motion/integrator.h"

enum { SKF_RADAU_NODES = 8, SKF_RADAU_TERMS = 7, SKF_RADAU_SWEEPS = 12 };

typedef struct skf_gauss_radau {
  double h, done;                                  /* next step, last step (0: none) */
  skf_vec3 a0;                                     /* acceleration at the start of the next step */
  double noise;                                    /* rounding error of accelerations, from some of the nodes */
  skf_vec3 b[SKF_RADAU_TERMS], e[SKF_RADAU_TERMS]; /* of the last step, and what had been predicted for it */
  skf_orbit from;                                  /* start of the last step */
  skf_vec3 from_a;
} skf_gauss_radau;

/* How far the solution of a step is: b, the divided differences g, what the last sweep changed, the largest
   acceleration. */
typedef struct skf_radau_guess {
  skf_vec3 b[SKF_RADAU_TERMS], e[SKF_RADAU_TERMS], g[SKF_RADAU_TERMS];
  double change, size;
} skf_radau_guess;

/* A step is refused when its error asks for less than this share of it. */
#define SKF_RADAU_REFUSE 0.5

/* Node n of the step, as a share of it; whether noise is asked for there. */
double skf_radau_node(int n);
static inline bool skf_radau_listens(int n) { return n % 3 == 1; }
/* The first guess for a step of length h. */
void skf_radau_predict(skf_gauss_radau *w, double h, skf_radau_guess *u);
/* Where the guess has the particle at node n. */
void skf_radau_place(const skf_gauss_radau *w, const skf_radau_guess *u, double h, int n, skf_vec3 *x, skf_vec3 *v);
/* Takes the acceleration there. */
void skf_radau_learn(skf_gauss_radau *w, int n, skf_vec3 a, double noise, skf_radau_guess *u);
/* The guess has settled; it will settle no further: it is good enough all the same. */
bool skf_radau_settled(const skf_radau_guess *u);
bool skf_radau_will_do(const skf_gauss_radau *w, const skf_radau_guess *u);
/* The step that would just meet the tolerance, as a share of h. */
double skf_radau_share(const skf_gauss_radau *w, const skf_radau_guess *u, double h, double tolerance);
/* Moves the orbit to the end of the step. */
void skf_radau_finish(skf_gauss_radau *w, const skf_radau_guess *u, double h, skf_orbit *at);
/* Whether the acceleration at its end is what the step says. */
bool skf_radau_meets(const skf_gauss_radau *w, double h, double size, double tolerance, skf_vec3 a);

/* An integrator's `pass`. */
void skf_radau_pass(const skf_ode *ode, skf_lane *lanes, size_t n, double until);

#endif
