/* SPDX-License-Identifier: MIT */
#include "motion/path.h"

static skf_vec3 horner(const skf_vec3 *c, int n, double s) {
  skf_vec3 r = {0, 0, 0};
  for (int k = n; k-- > 0;) r = v3_mad(c[k], s, r);
  return v3_scale(s, r);
}

skf_vec3 skf_path_position(const skf_path *p, double s) { return v3_add(p->x0, horner(p->x, p->degree, s)); }
skf_vec3 skf_path_velocity(const skf_path *p, double s) { return v3_add(p->v0, horner(p->v, p->degree, s)); }

skf_vec3 skf_path_rate(const skf_path *p, double s) {
  skf_vec3 r = {0, 0, 0};
  for (int k = p->degree; k-- > 0;) r = v3_mad(v3_scale(k + 1, p->x[k]), s, r);
  return r;
}

double skf_path_reach(const skf_path *p) {
  double r = 0;
  for (int k = 0; k < p->degree; k++) r += v3_norm(p->x[k]);
  return r * (1 + 1e-12);
}

skf_piece skf_path_piece(const skf_path *p, double middle, double half) {
  skf_vec3 c[SKF_PATH_DEGREE + 1] = {{0, 0, 0}}; /* coefficients about the middle */
  int n = p->degree;
  for (int k = 0; k < n; k++) c[k + 1] = p->x[k];
  for (int i = 0; i < n; i++) /* Taylor shift by repeated synthetic division */
    for (int k = n - 1; k >= i; k--) c[k] = v3_mad(c[k], middle, c[k + 1]);
  skf_piece r = {v3_add(p->x0, c[0]), c[1], 0, 0};
  double power = 1; /* half^(k-1) */
  for (int k = 1; k <= n; k++, power *= half) {
    double size = v3_norm(c[k]) * k;
    r.speed += size * power;
    if (k >= 2) r.bend += size * (k - 1) * (power / half);
  }
  if (!(half > 0)) r.bend = n >= 2 ? 2 * v3_norm(c[2]) : 0;
  return r;
}
