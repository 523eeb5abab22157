/* SPDX-License-Identifier: MIT */
/* The parts of a Gauss-Radau step, for one particle (gauss_radau.c) and for many that attract each other (crowd.c). */
#ifndef SKF_MOTION_GAUSS_RADAU_H
#define SKF_MOTION_GAUSS_RADAU_H

#include "motion/integrator.h"

enum { SKF_RADAU_NODES = 8, SKF_RADAU_TERMS = 7, SKF_RADAU_SWEEPS = 12 };

/* A vector as one load: x, y, z and nothing. */
typedef struct skf_row {
  double c[4];
} skf_row;

static inline skf_row skf_row_of(skf_vec3 v) { return (skf_row){{v.x, v.y, v.z, 0}}; }
static inline skf_vec3 skf_row_vec(const skf_row *r) { return v3(r->c[0], r->c[1], r->c[2]); }

typedef struct skf_gauss_radau {
  double h, done;                                 /* next step, last step (0: none) */
  skf_vec3 a0;                                    /* acceleration at the start of the next step */
  double noise;                                   /* rounding error of accelerations, from some of the nodes */
  skf_row b[SKF_RADAU_TERMS], e[SKF_RADAU_TERMS]; /* of the last step, and what had been predicted for it */
  skf_orbit from;                                 /* start of the last step */
  skf_vec3 from_a;
} skf_gauss_radau;

typedef struct skf_radau_ops skf_radau_ops;

/* How far the solution of a step is: b, the divided differences g, what the last sweep changed, the largest
   acceleration; and where the step starts. */
typedef struct skf_radau_guess {
  const skf_radau_ops *ops;
  skf_row b[SKF_RADAU_TERMS], e[SKF_RADAU_TERMS], g[SKF_RADAU_TERMS], a0, x, v, x_low, v_low;
  double change, size;
} skf_radau_guess;

/* What is done at every node, for an instruction set; all give the same bits. */
struct skf_radau_ops {
  /* The first guess for a step of length h: the last step's polynomial, continued over a step q times as long, and
     corrected by how far the last prediction was off; what the step starts with is in the guess. */
  void (*predict)(const skf_gauss_radau *w, double h, skf_radau_guess *u);
  /* Where the guess has the particle at node n; v may be NULL. */
  void (*place)(const skf_radau_guess *u, double h, int n, skf_vec3 *x, skf_vec3 *v);
  /* Takes the acceleration there. */
  void (*learn)(int n, skf_vec3 a, skf_radau_guess *u);
};
extern const skf_radau_ops skf_radau_base, skf_radau_avx2;
const skf_radau_ops *skf_radau_get(skf_isa isa);

/* Roots of (P_7 + P_8)(2 s - 1) [Everhart 1985], computed at 60 digits. */
static const double skf_radau_node[SKF_RADAU_NODES] = {0.0,
                                                       0.056262560536922146466,
                                                       0.18024069173689236499,
                                                       0.35262471711316963737,
                                                       0.547153626330555383,
                                                       0.73421017721541053152,
                                                       0.88532094683909576809,
                                                       0.97752061356128750189};

/* A step is refused when its error asks for less than this share of it. */
#define SKF_RADAU_REFUSE 0.5

/* Whether noise is asked for at node n. */
static inline bool skf_radau_listens(int n) { return n % 3 == 1; }
static inline double skf_radau_size(skf_vec3 a) {
  double x = fabs(a.x), y = fabs(a.y), z = fabs(a.z), r = x > y ? x : y;
  return r > z ? r : z;
}
/* Begins a step of length h from w->from. */
static inline void skf_radau_predict(const skf_radau_ops *ops, skf_gauss_radau *w, double h, skf_radau_guess *u) {
  u->ops = ops;
  ops->predict(w, h, u);
  u->change = 0, u->size = skf_radau_size(w->a0);
  w->noise = 0;
}
static inline void skf_radau_learn(skf_gauss_radau *w, int n, skf_vec3 a, double noise, skf_radau_guess *u) {
  double size = skf_radau_size(a);
  w->noise = noise > w->noise ? noise : w->noise;
  u->size = size > u->size ? size : u->size;
  u->ops->learn(n, a, u);
}
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
