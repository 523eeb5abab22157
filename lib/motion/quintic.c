/* SPDX-License-Identifier: MIT */
#include "motion/integrator.h"

skf_status skf_path_between(skf_ode *ode, const skf_orbit *from, const skf_orbit *to, double h, skf_path *path) {
  skf_vec3 a0, a1;
  if (!skf_ode_eval(ode, from->t, v3_add(from->x, from->x_low), &a0, NULL)) return SKF_ERR_CONVERGENCE;
  if (!skf_ode_eval(ode, to->t, v3_add(to->x, to->x_low), &a1, NULL)) return SKF_ERR_CONVERGENCE;
  skf_vec3 way = v3_add(v3_sub(to->x, from->x), v3_sub(to->x_low, from->x_low));
  skf_vec3 v0 = v3_scale(h, v3_add(from->v, from->v_low)), v1 = v3_scale(h, v3_add(to->v, to->v_low));
  skf_vec3 b0 = v3_scale(0.5 * h * h, a0), b1 = v3_scale(0.5 * h * h, a1);
  /* what is left of the end's position, velocity and acceleration: powers 3 to 5 */
  skf_vec3 x = v3_sub(way, v3_add(v0, b0)), v = v3_sub(v1, v3_mad(v0, 2, b0)), b = v3_sub(b1, b0);
  *path = skf_path_begin(from, h, 5);
  path->x[0] = v0, path->x[1] = b0;
  path->x[2] = v3_add(v3_mad(v3_scale(10, x), -4, v), b);
  path->x[3] = v3_mad(v3_mad(v3_scale(-15, x), 7, v), -2, b);
  path->x[4] = v3_add(v3_mad(v3_scale(6, x), -3, v), b);
  for (int k = 1; k < 5; k++) path->v[k - 1] = v3_scale((k + 1) / h, path->x[k]);
  return SKF_OK;
}
