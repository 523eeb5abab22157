/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where bodies are between the rows that a run has kept. */
#include "run_csv.h"
#include "motion/pose.h"
#include <math.h>
#include <string.h>

/* A rotation as a vector along its axis, as long as the angle. */
static skf_vec3 turn_of(const double q[4]) {
  skf_vec3 v = v3(q[1], q[2], q[3]);
  double s = v3_norm(v), c = q[0] < 0 ? -q[0] : q[0];
  if (!(s > 0)) return v3(0, 0, 0);
  return v3_scale((q[0] < 0 ? -1 : 1) * 2 * atan2(s, c) / s, v);
}

/* A part s of the way from one attitude to the next: as the mean angular velocity turns, and evenly what that misses.
 */
static void turn_between(const run_pose *a, const run_pose *b, double s, double q[4]) {
  skf_vec3 likely = v3_scale(0.5 * (b->t - a->t), v3_add(a->w, b->w));
  memcpy(q, a->q, sizeof a->q);
  quat_rotate(q, likely);
  const double back[4] = {q[0], -q[1], -q[2], -q[3]};
  quat_times(b->q, back, q);
  skf_vec3 missed = turn_of(q);
  memcpy(q, a->q, sizeof a->q);
  quat_rotate(q, v3_scale(s, likely));
  quat_rotate(q, v3_scale(s, missed));
}

/* The cubic through both places with both velocities, where these explain the way; a hit between them does not. */
static skf_vec3 way_between(const run_pose *a, const run_pose *b, double s) {
  double h = b->t - a->t, r = 1 - s;
  skf_vec3 way = v3_sub(b->x, a->x), off = v3_sub(way, v3_scale(h / 2, v3_add(a->v, b->v)));
  if (v3_norm(off) > 0.35 * h * fmax(v3_norm(a->v), v3_norm(b->v))) return v3_mad(a->x, s, way);
  skf_vec3 p = v3_mad(a->x, s * s * (3 - 2 * s), way);
  return v3_mad(v3_mad(p, s * r * r * h, a->v), -s * s * r * h, b->v);
}

static void pose_at(const run_body *b, double t, skf_vec3 *x, double q[4]) {
  size_t lo = 0, hi = b->count - 1;
  while (lo + 1 < hi) {
    size_t middle = (lo + hi) / 2;
    *(b->poses[middle].t <= t ? &lo : &hi) = middle;
  }
  const run_pose *from = b->poses + lo, *to = b->poses + hi;
  double h = to->t - from->t, s = h > 0 ? fmin(fmax((t - from->t) / h, 0), 1) : 0;
  *x = way_between(from, to, s);
  turn_between(from, to, s, q);
}

run_place run_body_at(const run_body *b, double t) {
  skf_vec3 x;
  double q[4];
  pose_at(b, t, &x, q);
  skf_vec3 turn = turn_of(q);
  return (run_place){.axis = turn, .about = b->poses[0].x, .shift = v3_sub(x, b->poses[0].x), .angle = v3_norm(turn)};
}
