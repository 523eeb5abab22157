/* SPDX-License-Identifier: MIT */
/* Quaternions w, x, y, z, inline. */
#ifndef SKF_MOTION_POSE_H
#define SKF_MOTION_POSE_H

#include "core/vec3.h"
#include "skelfield/rigid.h"

/* v + 2 u x (u x v + w v), u being the vector part */
static inline skf_vec3 quat_turn(const double q[4], double sign, skf_vec3 v) {
  skf_vec3 u = v3(sign * q[1], sign * q[2], sign * q[3]), t = v3_mad(v3_cross(u, v), q[0], v);
  return v3_mad(v, 2, v3_cross(u, t));
}

static inline void quat_times(const double a[4], const double b[4], double out[4]) {
  double r[4] = {
      a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
      a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
  for (int i = 0; i < 4; i++) out[i] = r[i];
}

static inline void quat_normalize(double q[4]) {
  double n = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (int i = 0; i < 4; i++) q[i] /= n;
}

/* Turns q by the rotation vector w (inertial). */
static inline void quat_rotate(double q[4], skf_vec3 w) {
  double angle = v3_norm(w), s = angle > 1e-8 ? sin(0.5 * angle) / angle : 0.5 - angle * angle / 48;
  double turn[4] = {cos(0.5 * angle), s * w.x, s * w.y, s * w.z};
  quat_times(turn, q, q);
  quat_normalize(q);
}

#endif
