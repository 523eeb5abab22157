/* SPDX-License-Identifier: MIT */
/* Particles that attract each other: the direct sum. */
#ifndef SKF_MOTION_PAIRS_H
#define SKF_MOTION_PAIRS_H

#include "simd/isa.h"
#include <stddef.h>

/* Points that attract, with the potential -G m / sqrt(r^2 + softening^2) [Plummer 1911]. */
typedef struct skf_pullers {
  size_t n;
  const double *x[3], *gm; /* G m */
  double softening2;
} skf_pullers;

/* Adds to a[0..2] of m targets what the pullers give each of them, in their order, and to rough the sizes of that. What
   lies exactly at the target gives nothing; *same counts how often that was so (softened: never). Every instruction set
   and every division of the targets gives the same bits. */
typedef void skf_pairs_pull(const skf_pullers *s, size_t m, const double *const x[3], double *const a[3], double *rough,
                            unsigned *same);
extern skf_pairs_pull skf_pairs_pull_base, skf_pairs_pull_avx2;
skf_pairs_pull *skf_pairs_pick(skf_isa isa);

#endif
