/* SPDX-License-Identifier: MIT */
/* Kernels of the caller's own: what is checked, and the point, which needs no integral. */
#include "field/envelope.h"
#include "field/simple.h"

/* Beyond this the rest of a plane's integral is rounding, at the ring where the quadrature ends. */
#define LEAST_DECAY 2.125

void skf_kernel_eval(skf_kernel k, double r2, double d[4]) {
  if (k.type != SKF_USER_KERNEL)
    skf_kernel_row(k.type)->eval(k.param, r2, d);
  else if (k.user->radius > 0 && r2 >= k.user->radius * k.user->radius)
    d[0] = d[1] = d[2] = d[3] = 0;
  else
    k.user->eval(k.user->user, r2, d);
}

double skf_kernel_grain(skf_kernel k) {
  return k.type == SKF_USER_KERNEL && !k.user->singular ? 0.25 * k.user->width : 0;
}

static skf_status check_user(const skf_user_kernel *u) {
  if (!u || !u->eval || (u->break_count && !u->breaks)) return SKF_ERR_ARG;
  if (!(u->width > 0 && isfinite(u->width)) || !(u->radius >= 0) || isnan(u->decay)) return SKF_ERR_RANGE;
  if (u->break_count < 0 || u->break_count > SKF_USER_BREAKS) return SKF_ERR_RANGE;
  for (int i = 0; i < u->break_count; i++)
    if (!(u->breaks[i] > (i ? u->breaks[i - 1] : 0)) || !isfinite(u->breaks[i])) return SKF_ERR_RANGE;
  return SKF_OK;
}

skf_status skf_kernel_check(skf_kernel k, skf_shape shape) {
  if (k.type == SKF_USER_KERNEL) {
    skf_status s = check_user(k.user);
    bool endless = !s && shape == SKF_PLANE && skf_kernel_end(k) == INFINITY && k.user->decay < LEAST_DECAY;
    return endless ? SKF_ERR_UNSUPPORTED : s;
  }
  const skf_kernel_info *info = skf_kernel_get(k.type);
  if (!info) return SKF_ERR_ARG;
  return !info->param || (k.param > 0 && isfinite(k.param)) ? SKF_OK : SKF_ERR_RANGE;
}

bool skf_kernel_has_bound(skf_kernel k, skf_shape shape) {
  return k.type != SKF_USER_KERNEL || (k.user->bound && shape != SKF_PLANE);
}

static void point(const skf_prepared *e, skf_vec3 x, int order, skf_value *v) {
  double w, d[4];
  skf_dd3 delta = skf_point_delta(e, x, &w);
  if (w == 0 && e->kernel.user->singular) {
    v->F = INFINITY;
    return;
  }
  skf_kernel_eval(e->kernel, w, d);
  skf_point_result(d, delta, order, v);
}

#define ITSELF "+infinity on the primitive itself where the kernel is singular"

const skf_kernel_ops skf_kernel_user = {
    .info = {"user", "the caller's", "see skf_user_kernel", NULL, NULL, NULL, false, false},
    .closed[SKF_POINT] = point,
    .singular = {ITSELF, ITSELF, ITSELF, ITSELF, ITSELF},
};
