/* SPDX-License-Identifier: MIT */
/* Vector forms: Cauchy's kernel and 1 / r^2 along a circle. */
#ifndef SKF_FIELD_BATCH_RING_H
#define SKF_FIELD_BATCH_RING_H

#include "field/batch_loop.h"

/* The normal s long, and 2 R^2 times that; s^2, l = 1 or 0, l - s^2 R^2, two and four times s^2 R^2; factors of the
   results; for doubles next to the circle the normal as given, R, s / |normal|. */
typedef struct ring_row {
  skf_v3d center, n, over;
  skf_vd s2, least, rest, two, four, F, g;
#ifndef SKF_VEC_FLOAT
  skf_v3d raw;
  skf_vd R, per_raw;
#endif
} ring_row;

static double *ring_pack_by(const skf_prepared *e, double s, double least, double F, double g, double *k) {
  const skf_arc_plan *a = &e->plan.arc;
  double R2 = a->radius * a->radius, q = s * s * R2, size = 2 * SKF_PI * a->radius * e->strength;
  k = pack3(pack3(pack3(k, e->primitive.arc.center), v3_scale(s, a->n)), v3_scale(2 * R2 * s, a->n));
  k = pack1(pack1(pack1(pack1(pack1(k, s * s), least), least - q), 2 * q), 4 * q);
  k = pack1(pack1(k, F * size), g * size);
#ifndef SKF_VEC_FLOAT
  k = pack1(pack1(pack3(k, a->raw), a->radius), s / a->raw_length);
#endif
  return k;
}

typedef ring_row cauchy_ring_row, squared_ring_row;
static double *cauchy_ring_pack(const skf_prepared *e, double *k) {
  double s = e->kernel.param;
  return ring_pack_by(e, s, 1, 1, 2 * s * s, k);
}
static double *squared_ring_pack(const skf_prepared *e, double *k) { return ring_pack_by(e, 1, 0, 1, -2, k); }

/* As batch_arc_open.h: k from the axis, z across, s long; with q = l + z^2, u = s^2 (k^2 - R^2): v = u + q, a = v + 2
   s^2 R^2, D^2 = u^2 + q (u + v + 4 s^2 R^2). That u is a difference is what rounding the point does, too; next to the
   circle doubles promise more. The gradient is along x - center and, as the slopes differ, along n. */
typedef struct ring_state {
  skf_v3d d;
  skf_vd z, v, D2, D, per; /* per: 1 / D^2 */
} ring_state;
typedef ring_state cauchy_circle_state, inverse_squared_circle_state;

SKF_INLINE void ring_form(const ring_row *c, skf_vd u, skf_vd v, skf_vd q, ring_state *s) {
  skf_vd D2 = vd_fma(u, u, q * ((u + v) + c->four));
  s->v = v, s->D2 = D2, s->D = vd_sqrt(D2), s->per = vd_set(1) / D2;
}

SKF_INLINE void ring_begin(const ring_row *c, skf_v3d x, ring_state *s) {
  s->d = vd3_sub(x, c->center), s->z = vd3_dot(s->d, c->n);
  skf_vd q = vd_fma(s->z, s->z, c->least), v = vd_fma(c->s2, vd3_dot(s->d, s->d), c->rest);
  ring_form(c, v - q, v, q, s);
}
#define cauchy_circle_begin          ring_begin
#define inverse_squared_circle_begin ring_begin

/* int 1 / W^2 = 2 pi R a / D^3 */
SKF_INLINE skf_vvalue cauchy_ring(const ring_row *c, const ring_state *s) {
  /* in this order, in which far away nothing underflows before its product does */
  skf_vd a = s->v + c->two, third = vd_set(-3) * a, cube = s->D * s->per * s->per, slope = c->g * cube;
  skf_vd across = slope * (s->per * vd_fma(third, s->v, s->D2)), along = slope * (s->per * third) * s->z;
  return (skf_vvalue){c->F * (a * cube), vd3_mad(vd3_scale(across, s->d), along, c->over),
                      s->D2 < vd_set(SKF_PICK(1e90, 1e14))};
}

/* int 1 / r^2 = 2 pi R / D */
SKF_INLINE skf_vvalue squared_ring(const ring_row *c, const ring_state *s) {
  skf_vd per_D = s->D * s->per, slope = c->g * (per_D * s->per);
  return (skf_vvalue){c->F * per_D, vd3_mad(vd3_scale(slope * s->v, s->d), slope * s->z, c->over),
                      (s->D2 > vd_set(SKF_PICK(1e-90, 1e-20))) & (s->D2 < vd_set(SKF_PICK(1e90, 1e20)))};
}

#ifdef SKF_VEC_FLOAT
#define cauchy_circle_end           cauchy_ring
#define inverse_squared_circle_end  squared_ring
#define cauchy_circle_next          skf_again_none
#define inverse_squared_circle_next skf_again_none
#else
SKF_INLINE skf_vi ring_off(const ring_row *c, const ring_state *s) {
  const skf_vd a = s->v + c->two;
  return vd_set(256) * s->D2 > a * a;
}
SKF_INLINE skf_vvalue cauchy_circle_end(const ring_row *c, const ring_state *s) {
  skf_vvalue v = cauchy_ring(c, s);
  v.good &= ring_off(c, s);
  return v;
}
SKF_INLINE skf_vvalue inverse_squared_circle_end(const ring_row *c, const ring_state *s) {
  skf_vvalue v = squared_ring(c, s);
  v.good &= ring_off(c, s);
  return v;
}

/* k^2 - R^2 and z from the lower halves of the coordinates */
SKF_INLINE void ring_exact(const ring_row *c, skf_v3d x, ring_state *s) {
  s->d = vd3_sub(x, c->center);
  s->z = c->per_raw * vd3_dot_exact(s->d, vd3_lost(x, c->center, s->d), c->raw);
  skf_vd zz = s->z * s->z, u = vd_fnma(c->s2, power_exact(c->R, x, c->center, s->d), -zz), q = zz + c->least;
  ring_form(c, u, u + q, q, s);
}
SKF_OUTLINE skf_vvalue cauchy_circle_next(const ring_row *c, skf_v3d x) {
  ring_state s;
  ring_exact(c, x, &s);
  return cauchy_ring(c, &s);
}
SKF_OUTLINE skf_vvalue inverse_squared_circle_next(const ring_row *c, skf_v3d x) {
  ring_state s;
  ring_exact(c, x, &s);
  return squared_ring(c, &s);
}
#endif

SKF_BATCH_SCALED(cauchy_circle, cauchy_ring, cauchy_circle_next, skf_stage_none, skf_stage_none, skf_stage_none)
SKF_BATCH_SCALED(inverse_squared_circle, squared_ring, inverse_squared_circle_next, skf_stage_none, skf_stage_none,
                 skf_stage_none)

#endif
