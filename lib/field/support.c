/* SPDX-License-Identifier: MIT */
#include "field/support.h"

/* R^2 - h^2 of a segment's line; near the rim from what is known exactly, where h's rounding would be lost in it. */
static double chord2(const skf_segment_frame *f, double R) {
  double T2 = (R - f->h) * (R + f->h);
  if (64 * fabs(T2) > R * R) return T2;
  skf_dd3 along = {dd_sub(f->d0.x, f->d1.x), dd_sub(f->d0.y, f->d1.y), dd_sub(f->d0.z, f->d1.z)};
  skf_dd3 n = dd3_cross(f->d0, along);
  skf_dd L2 = dd3_dot(along, along);
  return dd_sub(dd_mul(dd_two_prod(R, R), L2), dd3_dot(n, n)).hi / L2.hi;
}

bool skf_segment_support(const skf_segment_frame *f, double R, skf_segment_clip *c) {
  double t0 = f->t0, t1 = f->t1, q0 = dd3_power(R, f->d0), q1 = dd3_power(R, f->d1);
  double T2 = q0 > 0 ? q0 + t0 * t0 : q1 > 0 ? q1 + t1 * t1 : chord2(f, R);
  c->q0 = q0, c->q1 = q1;
  if (T2 <= 0 || (q0 <= 0 && t0 >= 0) || (q1 <= 0 && t1 <= 0)) return false;
  double T = c->T = sqrt(T2);
  bool in0 = q0 > 0, in1 = q1 > 0;
  c->lo = in0 ? t0 : -T, c->hi = in1 ? t1 : T;
  c->r_lo = in0 ? f->r0 : R, c->r_hi = in1 ? f->r1 : R;
  /* q = (T - t)(T + t) */
  c->gap_lo = !in0 ? 0 : t0 < 0 ? q0 / (T - t0) : T + t0;
  c->gap_hi = !in1 ? 0 : t1 > 0 ? q1 / (T + t1) : T - t1;
  double above0 = t0 > 0 ? q0 / (T + t0) : T - t0, below1 = t1 < 0 ? q1 / (T - t1) : T + t1;
  c->length = in0 && in1 ? f->L : in0 ? above0 : in1 ? below1 : 2 * T;
  return c->length > 0;
}

/* The same of a circle's nearest and farthest point, R^2 - rho^2 - |d|^2 +- 2 rho k = +-((2 rho k)^2 - P^2) / (2 rho k
   +- P). */
static void exact_powers(const skf_arc_frame *f, double R, skf_arc_clip *c) {
  const skf_vec3 raw = f->plan->raw;
  skf_dd3 n = {{raw.x, 0}, {raw.y, 0}, {raw.z, 0}}, across = dd3_cross(f->d, n);
  skf_dd rho2 = dd_two_prod(f->rho, f->rho), P = dd_sub(dd_add(rho2, dd3_dot(f->d, f->d)), dd_two_prod(R, R));
  skf_dd square = dd_mul((skf_dd){4 * rho2.hi, 4 * rho2.lo}, dd3_dot(across, across));
  double top = dd_sub(square, dd_mul(dd_mul(P, P), f->plan->raw2)).hi / f->plan->raw2.hi, half = 0.5 * f->spread;
  if (P.hi > 0)
    c->qa = top / (half + P.hi);
  else
    c->qb = -top / (half - P.hi);
}

bool skf_arc_support(const skf_arc_frame *f, double R, skf_arc_clip *c) {
  c->qa = (R - f->da) * (R + f->da);
  c->qb = (R - f->db) * (R + f->db);
  c->q0 = c->qa, c->q1 = c->qa;
  if (!f->full) {
    c->q0 = (R - f->r0) * (R + f->r0);
    c->q1 = (R - f->r1) * (R + f->r1);
  }
  if (2 * f->spread < R * R) { /* near the axis: from R^2 - rho^2 - |d|^2, exact */
    skf_dd3 d = f->d;
    skf_dd d2 = dd3_dot(d, d), q = dd_sub(dd_two_prod(R, R), dd_add(dd_two_prod(f->rho, f->rho), d2));
    double half = 0.5 * f->spread;
    c->qa = q.hi + half, c->qb = q.hi - half;
    if (!f->full) {
      c->q0 = q.hi + half * (f->c0 - f->s0) * (f->c0 + f->s0);
      c->q1 = q.hi + half * (f->c1 - f->s1) * (f->c1 + f->s1);
    }
  } else if (64 * fmin(fabs(c->qa), fabs(c->qb)) < R * R)
    exact_powers(f, R, c);
  c->cut = c->qb < 0;
  c->chi = c->cut && c->qa > 0 ? atan2(sqrt(c->qa), sqrt(-c->qb)) : SKF_PI / 2;
  return c->qa > 0;
}

bool skf_arc_clip_piece(const skf_arc_clip *c, skf_arc_piece *p, double *gap) {
  *gap = 0;
  if (!c->cut) return true;
  if (p->xa >= c->chi) return false;
  if (p->xb > c->chi)
    p->length = c->chi - p->xa;
  else
    *gap = c->chi - p->xb;
  return true;
}
