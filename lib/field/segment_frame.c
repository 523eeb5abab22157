/* SPDX-License-Identifier: MIT */
#include "field/segment_frame.h"

/* d x e to an ulp or two of each coordinate; near the axis the plain product loses |d| / h of them. */
static skf_vec3 exact_cross(skf_dd3 d, skf_vec3 e, skf_vec3 e_lo) {
  skf_vec3 hi = dd3_round(d), lo = v3(d.x.lo, d.y.lo, d.z.lo);
  skf_vec3 n = v3(dd_det2(hi.y, e.z, hi.z, e.y), dd_det2(hi.z, e.x, hi.x, e.z), dd_det2(hi.x, e.y, hi.y, e.x));
  return v3_add(n, v3_add(v3_cross(lo, e), v3_cross(hi, e_lo)));
}

void skf_segment_place(const skf_prepared *e, skf_vec3 x, skf_segment_frame *f) {
  const skf_segment_plan *s = &e->plan.segment;
  f->d0 = dd3_diff(x, e->primitive.segment.from);
  f->d1 = dd3_diff(x, e->primitive.segment.to);
  skf_vec3 d0 = dd3_round(f->d0), d1 = dd3_round(f->d1);
  double n0 = v3_norm2(d0), n1 = v3_norm2(d1), L = s->length;
  bool near1 = n1 < n0;
  skf_vec3 n = v3_cross(near1 ? d1 : d0, s->e);
  double n2 = v3_norm2(n), L2 = L * L;
  if (16 * n2 < (near1 ? n1 : n0) * L2) {
    n = exact_cross(near1 ? f->d1 : f->d0, s->e, s->e_lo);
    n2 = v3_norm2(n);
  }
  f->a = s->a;
  f->L = L;
  f->w = v3_scale(1 / L2, v3_cross(s->e, n));
  f->h2 = n2 / L2;
  f->h = sqrt(n2) / L;
  f->t0 = -v3_dot(d0, s->a);
  f->t1 = -v3_dot(d1, s->a);
  f->r0 = sqrt(f->h2 + f->t0 * f->t0);
  f->r1 = sqrt(f->h2 + f->t1 * f->t1);
  f->sum = f->t0 + f->t1;
  f->dw = L * f->sum;
}

void skf_segment_result(const skf_segment_frame *f, const skf_segment_terms *t, int order, skf_value *v) {
  skf_vec3 a = f->a, w = f->w;
  v->F = t->F;
  v->g = v3_mad(v3_scale(t->ends, a), t->g, w);
  if (order < 2) return;
  double aa = skf_segment_moment(f, t) - t->g, aw = t->g_ends;
  double ww = f->h2 > 0 ? t->k_h2 / f->h2 : 0;
  v->h[0] = t->g + aa * a.x * a.x + ww * w.x * w.x + 2 * aw * a.x * w.x;
  v->h[1] = aa * a.x * a.y + ww * w.x * w.y + aw * (a.x * w.y + a.y * w.x);
  v->h[2] = aa * a.x * a.z + ww * w.x * w.z + aw * (a.x * w.z + a.z * w.x);
  v->h[3] = t->g + aa * a.y * a.y + ww * w.y * w.y + 2 * aw * a.y * w.y;
  v->h[4] = aa * a.y * a.z + ww * w.y * w.z + aw * (a.y * w.z + a.z * w.y);
  v->h[5] = t->g + aa * a.z * a.z + ww * w.z * w.z + 2 * aw * a.z * w.z;
}

/* Far along the axis both products are nearly equal: t1 - t0 = L and t0 + t1 help. Near an end they would cancel. */
double skf_segment_moment(const skf_segment_frame *f, const skf_segment_terms *t) {
  if (fmin(fabs(f->t0), fabs(f->t1)) < f->L) return f->t1 * t->g1 - f->t0 * t->g0;
  return 0.5 * (f->L * (t->g0 + t->g1) - f->sum * t->g_ends);
}

double skf_segment_excess(double ta, double ra, double tb, double rb, double h2) {
  double a = ta > 0 ? ra + ta : ra - ta > 0 ? h2 / (ra - ta) : 0;
  double b = tb < 0 ? rb - tb : rb + tb > 0 ? h2 / (rb + tb) : 0;
  return a + b;
}
