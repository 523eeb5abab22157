/* SPDX-License-Identifier: MIT */
/* The part of a segment or an arc inside the ball |q - x| < R, for kernels that vanish beyond R. R^2 - r^2 comes from
   exact differences: near the rim everything is proportional to a power of it. */
#ifndef SKF_FIELD_SUPPORT_H
#define SKF_FIELD_SUPPORT_H

#include "field/arc_frame.h"
#include "field/segment_frame.h"

/* The part lo <= t <= hi; T is half the chord of the ball. */
typedef struct skf_segment_clip {
  double q0, q1; /* R^2 - r^2 at the segment's ends, of any sign */
  double T, lo, hi, length;
  double gap_lo, gap_hi; /* T + lo, T - hi */
  double r_lo, r_hi;     /* distances to its ends */
} skf_segment_clip;

/* False when nothing is inside. */
bool skf_segment_support(const skf_segment_frame *f, double R, skf_segment_clip *c);

typedef struct skf_arc_clip {
  double qa, qb, q0, q1; /* R^2 - r^2 at the nearest and farthest point of the circle and at the arc's ends */
  bool cut;              /* the ball cuts the circle, where chi = chi */
  double chi;
} skf_arc_clip;

bool skf_arc_support(const skf_arc_frame *f, double R, skf_arc_clip *c);

/* Shortens a piece to the inside; *gap is chi of the rim minus the piece's end. False when nothing is left. */
bool skf_arc_clip_piece(const skf_arc_clip *c, skf_arc_piece *p, double *gap);

/* R^2 - r^2 at chi, which is `to_end` before the end of its piece. */
static inline double skf_arc_power(const skf_arc_frame *f, const skf_arc_clip *c, double chi, double cos_chi,
                                   double gap, double to_end) {
  return c->cut ? f->spread * sin(gap + to_end) * sin(c->chi + chi) : c->qb + f->spread * cos_chi * cos_chi;
}

#endif
