/* SPDX-License-Identifier: MIT */
/* Arcs and circles seen by vector forms. The geometry is that of arc_frame.c; points next to the circle, where it needs
   double-double, are left to the closed form. */
#ifndef SKF_FIELD_BATCH_ARC_H
#define SKF_FIELD_BATCH_ARC_H

#include "field/batch_loop.h"

/* As skf_arc_plan; the kernel's parameter squared */
typedef struct arc_row {
  skf_v3d center, e, f, n;
  skf_vd rho, S, C, param2, strength; /* radius, sine and cosine of half the sweep */
} arc_row;

static double *arc_pack(const skf_prepared *e, double *k) {
  const skf_arc_plan *a = &e->plan.arc;
  k = pack3(pack3(pack3(pack3(k, e->primitive.arc.center), a->e), a->f), a->n);
  k = pack1(pack1(pack1(k, a->radius), a->sin_half), a->cos_half);
  return pack1(pack1(k, e->kernel.param * e->kernel.param), e->strength);
}

typedef struct arc_view {
  skf_vd k, z, ux, uy, inner, outer, alpha, beta;
  skf_vi good;
} arc_view;

/* Next to the circle doubles need its distance more exactly; in floats what it loses is less than the point's rounding,
   down to where elliptic series end. */
SKF_INLINE arc_view arc_see(const arc_row *c, skf_v3d x) {
  skf_v3d d = vd3_sub(x, c->center);
  skf_vd u = vd3_dot(d, c->e), v = vd3_dot(d, c->f), rho = c->rho, zero = vd_set(0);
  arc_view f = {.k = vd_sqrt(vd_fma(u, u, v * v)), .z = vd3_dot(d, c->n)};
  skf_vi off = f.k > vd_set(SKF_PICK(1e-30, 1e-18)) * rho; /* the axis; much nearer, squares lose their digits */
  skf_vd per = vd_set(1) / vd_select(off, f.k, rho);
  f.ux = vd_select(off, u * per, vd_set(1));
  f.uy = vd_select(off, v * per, zero);
  f.inner = f.k - rho, f.outer = f.k + rho;
  f.alpha = vd_fma(f.inner, f.inner, f.z * f.z);
  f.beta = vd_fma(f.outer, f.outer, f.z * f.z);
  f.good = (vd_set(SKF_PICK(1024, 0x1p24)) * f.alpha > f.outer * f.outer) & vd_sane(f.beta);
  return f;
}

/* The same for a circle, which pulls nowhere off its axis from there. */
SKF_INLINE arc_view circle_see(const arc_row *c, skf_v3d x) {
  arc_view f = arc_see(c, x);
  f.ux = (skf_vd)((skf_vi)f.ux & (f.k > vd_set(0)));
  return f;
}

/* From int h, int g cos^2 chi, int g sin^2 chi and the ends' share, as skf_arc_gather and skf_arc_result. */
SKF_INLINE skf_vvalue arc_finish(const arc_row *c, const arc_view *f, skf_vd F, skf_vd cc, skf_vd ss, skf_vd ends,
                                 skf_vi good) {
  skf_vd k = vd_fma(f->inner, cc, f->outer * ss);
  skf_v3d g = vd3_scale(vd_fma(k, f->ux, -(ends * f->uy)), c->e);
  g = vd3_mad(g, vd_fma(k, f->uy, ends * f->ux), c->f);
  return (skf_vvalue){F, vd3_mad(g, f->z * (cc + ss), c->n), good & f->good};
}

#endif
