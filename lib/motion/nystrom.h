/* SPDX-License-Identifier: MIT */
/* Attempts of a step of the 12(10) Nystrom pair, by one particle or by many side by side; see nystrom_loop.h. */
#ifndef SKF_MOTION_NYSTROM_H
#define SKF_MOTION_NYSTROM_H

#include "motion/integrator.h"

enum { SKF_NYSTROM_STAGES = 17 };

/* Lane l has coordinate c of a vector at [c * lanes + l]. A lane's bits do not depend on its neighbours. */
#define SKF_NYSTROM_LANES(name, lanes, width)                                                                          \
  typedef struct name {                                                                                                \
    _Alignas(32) double h[lanes], t_hi[lanes], t_lo[lanes], tolerance[lanes]; /* the step, its start */                \
    double x[width], x_low[width], v[width], v_low[width];                    /* at the start */                       \
    double to_x[width], to_x_low[width], to_v[width], to_v_low[width];                                                 \
    _Alignas(32) double k[SKF_NYSTROM_STAGES][width]; /* no vector across two lines of the cache */                    \
    double error[lanes], root[lanes]; /* in tolerances; infinite when a force was not finite; about its 11th root */   \
    double noise[lanes];              /* rounding error of the accelerations */                                        \
  } name;
SKF_NYSTROM_LANES(skf_nystrom_one, 1, 4)
SKF_NYSTROM_LANES(skf_nystrom_many, SKF_FLOCK, 3 * SKF_FLOCK)

/* For each instruction set: from the start to to_* and the error. */
typedef struct skf_nystrom_ops {
  void (*one)(skf_nystrom_one *s, const skf_ode *ode);
  void (*many)(skf_nystrom_many *s, const skf_ode *ode);
} skf_nystrom_ops;

extern const skf_nystrom_ops skf_nystrom_base, skf_nystrom_avx2;

const skf_nystrom_ops *skf_nystrom_get(skf_isa isa);

/* What a flight keeps between its steps. */
typedef struct skf_nystrom {
  double h, done; /* next step, last step (0: none) */
  double root;    /* of the last step's error */
  skf_orbit from, to;
} skf_nystrom;

void skf_nystrom_pass(const skf_ode *ode, skf_lane *lanes, size_t n, double until);

/* The next step as a factor of h, from the root r of its error and how errors have changed from the step before
   (h_before 0: none), whose root is kept; h is done when the error is 1 at most. */
static inline double skf_nystrom_factor(double error, double r, double h, double h_before, double *root_before,
                                        bool refused) {
  double q = 0.9 / r, trend = 1;
  if (!(error <= 1)) return q > 0.2 ? q : 0.2;
  if (h_before > 0) trend = h * *root_before / (h_before * r);
  *root_before = r;
  q *= trend < 0.5 ? 0.5 : trend > 1.15 ? 1.15 : trend;
  return q < (refused ? 1 : 4) ? q : refused ? 1 : 4;
}

#endif
