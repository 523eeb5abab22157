/* SPDX-License-Identifier: MIT */
/* Vector forms of floats: Cauchy's kernel and 1 / r^2 along a circle. */
#ifndef SKF_FIELD_BATCH_RING_H
#define SKF_FIELD_BATCH_RING_H

#include "field/batch_loop.h"

/* s^2, l = 1 or 0, s^2 R^2 and two and four times that; factors of the results. */
typedef struct ring_row {
  skf_v3d center, n;
  skf_vd s2, least, less, two, four, F, g;
} ring_row;

static double *ring_pack_by(const skf_prepared *e, double s2, double least, double F, double g, double *k) {
  const skf_arc_plan *a = &e->plan.arc;
  double q = s2 * a->radius * a->radius, size = 2 * SKF_PI * a->radius * e->strength;
  k = pack1(pack1(pack3(pack3(k, e->primitive.arc.center), a->n), s2), least);
  return pack1(pack1(pack1(pack1(pack1(k, q), 2 * q), 4 * q), F * size), g * size);
}

typedef ring_row cauchy_ring_row, squared_ring_row;
static double *cauchy_ring_pack(const skf_prepared *e, double *k) {
  double s2 = e->kernel.param * e->kernel.param;
  return ring_pack_by(e, s2, 1, 1, 2 * s2, k);
}
static double *squared_ring_pack(const skf_prepared *e, double *k) { return ring_pack_by(e, 1, 0, 1, -2, k); }

/* As batch_arc_open.h: w from the axis to x, z across; with q = l + s^2 z^2, u = s^2 (w^2 - R^2): v = u + q, a = v + 2
   s^2 R^2, D^2 = u^2 + q (u + v + 4 s^2 R^2). That u is a difference is what rounding the point does, too. */
typedef struct ring_state {
  skf_v3d w;
  skf_vd z, v, D2, D, per; /* per: 1 / D^3 */
} ring_state;
typedef ring_state cauchy_circle_state, inverse_squared_circle_state;

SKF_INLINE void ring_begin(const ring_row *c, skf_v3d x, ring_state *s) {
  skf_v3d d = vd3_sub(x, c->center);
  s->z = vd3_dot(d, c->n);
  s->w = vd3_less(d, s->z, c->n);
  skf_vd u = vd_fms(c->s2, vd3_dot(s->w, s->w), c->less), q = vd_fma(c->s2 * s->z, s->z, c->least);
  s->v = u + q;
  s->D2 = vd_fma(u, u, q * ((u + s->v) + c->four));
  s->D = vd_sqrt(s->D2);
}
#define cauchy_circle_begin          ring_begin
#define inverse_squared_circle_begin ring_begin

SKF_INLINE void ring_turn(const ring_row *c, ring_state *s) {
  (void)c;
  s->per = vd_set(1) / (s->D * s->D2);
}

/* int 1 / W^2 = 2 pi R a / D^3 */
SKF_INLINE skf_vvalue cauchy_circle_end(const ring_row *c, const ring_state *s) {
  skf_vd a = s->v + c->two, third = vd_set(-3) * a, slope = c->g * s->per * (s->D * s->per);
  skf_v3d g = vd3_scale(slope * vd_fma(third, s->v, s->D2), s->w);
  return (skf_vvalue){c->F * a * s->per, vd3_mad(g, slope * vd_fma(third, a, s->D2) * s->z, c->n),
                      s->D2 < vd_set(1e14)};
}

/* int 1 / r^2 = 2 pi R / D */
SKF_INLINE skf_vvalue inverse_squared_circle_end(const ring_row *c, const ring_state *s) {
  skf_vd slope = c->g * s->per;
  skf_v3d g = vd3_scale(slope * s->v, s->w);
  return (skf_vvalue){c->F * s->D2 * s->per, vd3_mad(g, slope * (s->v + c->two) * s->z, c->n),
                      (s->D2 > vd_set(1e-20)) & (s->D2 < vd_set(1e20))};
}

SKF_BATCH_CROSSED(cauchy_circle, cauchy_ring, skf_again_none, ring_turn, skf_stage_none, skf_stage_none)
SKF_BATCH_CROSSED(inverse_squared_circle, squared_ring, skf_again_none, ring_turn, skf_stage_none, skf_stage_none)

#endif
