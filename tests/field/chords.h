/* SPDX-License-Identifier: MIT */
/* Places about a segment by what a ball around them cuts from its line. */
#ifndef SKF_TESTS_FIELD_CHORDS_H
#define SKF_TESTS_FIELD_CHORDS_H

#include "core/vec3.h"
#include "random.h"
#include "skelfield/field.h"

/* A share of R that is anything, next to nothing, or next to one of the metaball's two radii, from within or without */
static inline double rnd_share(uint64_t *seed) {
  const double rim = rnd(seed, 0, 1) < 0.5 ? 1 : 1. / 3, off = pow(10, rnd(seed, -12, -1));
  switch ((int)rnd(seed, 0, 4)) {
  case 0: return off;
  case 1: return rim * (1 + (rnd(seed, 0, 1) < 0.3 ? off : -off));
  default: return rnd(seed, 0, 1.05);
  }
}

/* The foot of the perpendicular anywhere, or so that an end is at such a share of R, too; sometimes an end itself */
static inline skf_vec3 rnd_chord(uint64_t *seed, const skf_segment *s, double R) {
  const skf_vec3 e = v3_sub(s->to, s->from), b = rnd_unit(seed), a = v3_unit(e);
  const double L = v3_norm(e), h = R * rnd_share(seed), r = R * rnd_share(seed);
  double t = rnd(seed, -R, L + R);
  if (rnd(seed, 0, 1) < 0.05) return rnd(seed, 0, 1) < 0.5 ? s->from : s->to;
  if (r > h && rnd(seed, 0, 1) < 0.5) {
    t = sqrt((r - h) * (r + h));
    if (rnd(seed, 0, 1) < 0.3) t = -t;
    if (rnd(seed, 0, 1) < 0.5) t = L - t;
  }
  return v3_mad(v3_mad(s->from, t, a), h, v3_unit(v3_mad(b, -v3_dot(a, b), a)));
}

#endif
