/* SPDX-License-Identifier: MIT */
/* Vector form: 1 / r along a circle. Points within a thousandth of its width are left to the closed form. */
#ifndef SKF_FIELD_BATCH_CIRCLE_H
#define SKF_FIELD_BATCH_CIRCLE_H

#include "field/batch_loop.h"

/* K = 2 / pi times the complete integral of the first kind, and its slope, for parameters q^2 up to that of a circle
   seen from where r_near >= r_far / 32, after one step of the arithmetic-geometric mean. */
typedef struct elliptic_view {
  skf_vd K, slope;
} elliptic_view;

SKF_INLINE elliptic_view elliptic_series(skf_vd x) {
  /* (K - 1) / x and dK / dx for x = q^2 up to 0.242 */
#ifdef SKF_VEC_FLOAT /* 1e-8, 9e-8 */
  static const double c[] = {0.24999999132428597714, 0.14062757349892773414,  0.097534097320298889128,
                             0.07685355590122596816, 0.044928848722901761892, 0.10124612534179589865};
  static const double d[] = {0.24999993255451477099, 0.28126999872998822775, 0.29202143322479295002,
                             0.315177329337672776,   0.18305243580292895762, 0.68438077151678032717};
#else /* 4e-17, 5e-17 */
  static const double c[] = {0.25000000000000003284,  0.14062499999995416344,  0.09765625001057082881,
                             0.074768065451290991971, 0.060562178458683759509, 0.050887776798678958035,
                             0.043900716701058748191, 0.038307093065890379062, 0.036461174665249699913,
                             0.019912744108246717307, 0.067854195002770643885, -0.060340853386643379044,
                             0.12043163741277107926};
  static const double d[] = {0.24999999999999996409, 0.28125000000005813206,  0.29296874998443454502,
                             0.29907226726216983282, 0.30281057936072555792,  0.30533701716773209889,
                             0.30708991211795836426, 0.30939936841084994928,  0.3009720887228809884,
                             0.36955584248321885138, 0.031508843446869510371, 1.1955059210172823381,
                             -1.4165277447278784066, 2.0379935703406459773};
#endif
#ifdef SKF_VEC_FLOAT
  return (elliptic_view){vd_fma(x, vd_horner(c, 6, x), vd_set(1)), vd_horner(d, 6, x)};
#else
  return (elliptic_view){vd_fma(x, vd_estrin(c, sizeof c / sizeof *c, x), vd_set(1)),
                         vd_estrin(d, sizeof d / sizeof *d, x)};
#endif
}

/* The circle's centre and normal; R^2, two and four times that; 4 pi R times the strength; R, the normal as given and
   1 / its length. */
typedef struct circle_row {
  skf_v3d center, n;
  skf_vd R2, twice, four, F;
  skf_vd R;
  skf_v3d raw;
  skf_vd per_raw;
} circle_row;

static double *circle_pack(const skf_prepared *e, double *k) {
  const skf_arc_plan *a = &e->plan.arc;
  double R2 = a->radius * a->radius;
  k = pack3(pack3(k, e->primitive.arc.center), a->n);
  k = pack1(pack1(pack1(pack1(k, R2), 2 * R2), 4 * R2), 4 * SKF_PI * a->radius * e->strength);
  return pack1(pack3(pack1(k, a->radius), e->primitive.arc.normal), 1 / v3_norm(e->primitive.arc.normal));
}

/* F = 2 pi R / M, M the arithmetic-geometric mean of the least and the largest distance from the circle, a0 and g0.
   With k from the axis, z from the plane, s = k^2 + z^2 + R^2 and D^2 = s^2 - (2 R k)^2 = (k^2 - R^2)^2 + z^2 (s + k^2
   + R^2): a0^2 + g0^2 = 2 s, a0 g0 = D, so that neither they nor k are needed for its next terms a^2 = (s + D) / 2, g^2
   = D; one more step, q = (a - g) / (a + g) = R^2 k^2 / (a (a + g))^2 without cancellation, and 1 / M = 2 K(q^2) / (a +
   g). The gradient is that of this composition. */
typedef struct inverse_circle_state {
  skf_v3d d;                /* from the centre */
  skf_vd k2, z, s, rise, D; /* rise = k^2 + z^2 - R^2 */
  skf_vd a, g, per, per_D;  /* per: 1 / (2 a (a + g)) */
  skf_vi good;
} inverse_circle_state;

SKF_INLINE void inverse_circle_begin(const circle_row *c, skf_v3d x, inverse_circle_state *s) {
  skf_v3d d = vd3_sub(x, c->center);
  skf_vd z = vd3_dot(d, c->n), zz = z * z, dd = vd3_dot(d, d), all = dd + c->R2, rise = dd - c->R2, less = rise - zz;
  s->D = vd_sqrt(vd_fma(less, less, zz * (all + (all - zz))));
  s->d = d, s->z = z, s->k2 = dd - zz, s->s = all, s->rise = rise;
}

SKF_INLINE void inverse_circle_quotients(const circle_row *c, inverse_circle_state *s) {
  (void)c;
  s->a = vd_sqrt(vd_set(0.5) * (s->s + s->D)), s->g = vd_sqrt(s->D);
  s->good = (vd_set(16) * s->D > s->s) & (s->s < vd_set(SKF_PICK(1e70, 1e9)));
  s->per = vd_set(0.5) / (s->a * (s->a + s->g)), s->per_D = vd_set(1) / s->D;
}

/* Along d and, as the slopes differ, along n */
SKF_INLINE skf_vvalue inverse_circle_end(const circle_row *c, const inverse_circle_state *s) {
  skf_vd one = vd_set(1), q = (c->four * s->k2) * (s->per * s->per), per_sum = (s->a + s->a) * s->per;
  elliptic_view e = elliptic_series(q * q);
  skf_vd m = (q + q) * e.slope, F = c->F * per_sum;
  /* minus the slopes in a^2 and in g^2, by the same factor */
  skf_vd by_a = vd_fnma(m, one - q, e.K) * s->per, by_g = vd_fma(m, one + q, e.K) * (per_sum * (s->g * s->per_D));
  skf_vd by_D = F * ((by_a + by_g) * s->per_D), across = vd_fma(by_D, s->rise, F * by_a);
  return (skf_vvalue){F * e.K, vd3_less(vd3_scale(-across, s->d), by_D * (c->twice * s->z), c->n), s->good};
}

/* Next to the circle, down to r_near = r_far / 1000: k^2 - R^2 and z from the lower halves of the coordinates, and two
   steps more, (a + g) / 2 and sqrt(a g), before the series: p = 1 / M = 2 K(q^2) / (a + g) has slopes of one sign. */
SKF_OUTLINE skf_vvalue inverse_circle_next(const circle_row *c, skf_v3d x) {
  skf_vd half = vd_set(0.5), two = vd_set(2);
  skf_v3d d = vd3_sub(x, c->center);
  skf_vd z = c->per_raw * vd3_dot_exact(d, vd3_lost(x, c->center, d), c->raw), zz = z * z;
  skf_vd less = -power_exact(c->R, x, c->center, d) - zz, k2 = c->R2 + less, s = k2 + c->R2 + zz;
  skf_vd D = vd_sqrt(vd_fma(less, less, zz * (s + (k2 + c->R2)))), a0 = vd_sqrt(half * (s + D)), g0 = vd_sqrt(D);
  skf_vd a1 = half * (a0 + g0), g1 = vd_sqrt(a0 * g0), sum = a1 + g1, per = vd_set(1) / sum, q = (a1 - g1) * per;
  elliptic_view e = elliptic_series(q * q);
  skf_vd m = vd_set(4) * q * e.slope * per, scale = two * per * per;
  skf_vd by_a1 = scale * vd_fms(m, g1, e.K), by_g1 = -scale * vd_fma(m, a1, e.K);
  skf_vd by_a0 = half * by_a1 + by_g1 * (half * g1 / a0), by_g0 = half * by_a1 + by_g1 * (half * g1 / g0);
  skf_vd by_s = by_a0 / (vd_set(4) * a0), by_D = (by_s + by_g0 / (two * g0)) / D;
  skf_vd F = half * c->F, across = two * F * vd_fma(by_D, less + zz, by_s), along = two * F * vd_fma(by_D, s, by_s);
  skf_v3d w = vd3_less(d, z, c->n), g = vd3_scale(across, w);
  return (skf_vvalue){F * two * e.K * per, vd3_less(g, -along * z, c->n),
                      (vd_set(2.5e5) * D > vd_set(500) * s) & (s < vd_set(SKF_PICK(1e70, 1e9))) &
                          (s > vd_set(SKF_PICK(1e-70, 1e-9))) & (vd_set(16) * D < s)};
}

SKF_BATCH_CROSSED(inverse_circle, circle, inverse_circle_next, inverse_circle_quotients, skf_stage_none, skf_stage_none)

#endif
