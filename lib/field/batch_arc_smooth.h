/* SPDX-License-Identifier: MIT */
/* Vector forms: 1 / r along an arc, Gaussians along a circle. */
#ifndef SKF_FIELD_BATCH_ARC_SMOOTH_H
#define SKF_FIELD_BATCH_ARC_SMOOTH_H

#include "field/batch_arc.h"
#include "field/batch_circle.h"
#include "simd/vecspecial.h"

/* cos chi and sin chi at the ends, all with the same sign or none; from the antipode of x where it is behind. */
typedef struct ends_view {
  skf_vd c0, s0, c1, s1;
  skf_vd rise; /* sin^2 chi1 - sin^2 chi0 */
} ends_view;

SKF_INLINE ends_view arc_ends(const arc_row *c, const arc_view *f) {
  skf_vd S = c->S, C = c->C;
  skf_vi behind = f->ux < vd_set(0);
  skf_vd uy = vd_select(behind, -f->uy, f->uy), cb = vd_sqrt(vd_fma(vd_set(0.5), vd_abs(f->ux), vd_set(0.5)));
  skf_vd sb = vd_set(-0.5) * uy / cb, c1 = vd_fma(C, cb, -(S * sb)), s1 = vd_fma(S, cb, C * sb);
  return (ends_view){vd_select(behind, sb, cb), vd_select(behind, -cb, sb), vd_select(behind, s1, c1),
                     vd_select(behind, -c1, s1), S * vd_fma(S, f->ux, -(C * f->uy))};
}

/* 4 rho times int dchi / r and int alpha cos^2 chi / r^3 dchi over a quarter turn: 2 pi rho / M(da, db) as for a
   circle, and what it loses when da grows. */
typedef struct quarter_view {
  skf_vd K, cos2;
} quarter_view;

SKF_INLINE quarter_view arc_quarter(const arc_row *c, const arc_view *f) {
  skf_vd da = vd_sqrt(f->alpha), db = vd_sqrt(f->beta), one = vd_set(1), a = vd_set(0.5) * (da + db);
  skf_vd g = vd_sqrt(da * db), sum = a + g, per = one / (a * sum), rise = c->rho * f->k * per, q = rise * rise;
  elliptic_view e = elliptic_series(q * q);
  skf_vd m = (q + q) * e.slope, per_sum = a * per, K = vd_set(2 * SKF_PI) * c->rho * per_sum;
  skf_vd by_a = K * per_sum * vd_fnma(m, one - q, e.K), by_g = K * per_sum * (g * vd_fma(m, one + q, e.K));
  return (quarter_view){(K + K) * e.K, vd_fma(da, by_a, by_g)};
}

/* The same after one step more, for r_near >= r_far / 4096 */
SKF_INLINE quarter_view arc_quarter_next(const arc_row *c, const arc_view *f) {
  skf_vd da = vd_sqrt(f->alpha), db = vd_sqrt(f->beta), one = vd_set(1), half = vd_set(0.5), a0 = half * (da + db);
  skf_vd g0 = vd_sqrt(da * db), a = half * (a0 + g0), g = vd_sqrt(a0 * g0), per = one / (a + g), q = (a - g) * per;
  elliptic_view e = elliptic_series(q * q);
  skf_vd m = (q + q) * e.slope, K = vd_set(2 * SKF_PI) * c->rho * per, scale = half * K * per;
  skf_vd by_a = scale * vd_fnma(m, one - q, e.K), by_g = scale * (g * vd_fma(m, one + q, e.K));
  skf_vd by_g0 = vd_fma(g0, by_a, by_g);
  by_a += by_g / a0;
  return (quarter_view){(K + K) * e.K, vd_fma(da, by_a, by_g0)};
}

/* int dchi / r = R_F(U1^2, U2^2, U3^2) and int cos^2 chi / r^3 dchi = R_D / 3 + c0 c1 / (r0 r1 U3) with U1 = cs u,
   U2 = ds u, U3 = ns u times da, u the difference of the elliptic arguments at the ends [DLMF 19.29.4, 19.25.35]. The
   addition theorem [DLMF 22.8] gives them for any sweep; beyond a quarter period, where U1 < 0, u is measured from the
   half period. Each is written in two ways, so that terms of one sign are added where the ends are in one quadrant and
   where a multiple of pi / 2 lies between them. */
typedef struct inverse_arc_state {
  arc_view f;
  ends_view t;
  skf_vd r0, r1; /* distances from the ends */
  skf_vd U1, U3;
  skf_vduplication d;
} inverse_arc_state;

SKF_INLINE void inverse_arc_begin(const arc_row *c, skf_v3d x, inverse_arc_state *s) { s->f = arc_see(c, x); }

SKF_INLINE void inverse_arc_ends(const arc_row *c, inverse_arc_state *s) {
  const ends_view t = arc_ends(c, &s->f);
  skf_vd al = s->f.alpha, be = s->f.beta;
  s->r0 = vd_sqrt(vd_fma(al, t.c0 * t.c0, be * (t.s0 * t.s0)));
  s->r1 = vd_sqrt(vd_fma(al, t.c1 * t.c1, be * (t.s1 * t.s1)));
  s->t = t;
}

/* With the first duplication */
SKF_INLINE void inverse_arc_arguments(const arc_row *c, inverse_arc_state *s) {
  const ends_view t = s->t;
  skf_vd zero = vd_set(0), r0 = s->r0, r1 = s->r1, spread = vd_set(4) * c->rho * s->f.k;
  skf_vd cc = t.c0 * t.c1, ss = t.s0 * t.s1, up = t.c0 * t.s1, down = t.c1 * t.s0, rr = r0 * r1;
  skf_vi apart = cc * ss < zero;
  skf_vd den = vd_select(apart, vd_fma(up, r0, -(down * r1)), t.rise), per = vd_set(1) / den;
  skf_vd one1 = vd_fma(t.c1 * t.s1, r0, t.c0 * t.s0 * r1), two1 = vd_fma(s->f.alpha, cc, ss * rr);
  skf_vd one2 = vd_fma(up, r1, down * r0), two2 = vd_fma(-spread, cc * ss, rr);
  skf_vd one3 = vd_fma(up, r0, down * r1), two3 = vd_fma(spread, ss * ss, s->f.alpha);
  skf_vd U1 = vd_select(apart, two1, one1) * per, U2 = vd_select(apart, two2, one2) * per,
         U3 = vd_select(apart, two3, one3) * per;
  s->f.good &=
      vd_sane(rr) & (rr < vd_set(SKF_PICK(1e90, INFINITY))) & vd_sane(U2) & vd_sane(U3) & (U2 > zero) & (U3 > zero);
#ifdef SKF_VEC_FLOAT /* far from short arcs fourth powers of these and, below, sixth powers of the distance overflow   \
                      */
  s->f.good &= (U2 < vd_set(1e9)) & (U3 < vd_set(1e9)) & (rr * (r0 + r1) * (U3 * s->f.beta) < vd_set(1e37));
#endif
  s->U1 = U1, s->U3 = U3;
  s->d = vd_carlson_begin(vd_abs(U1), U2, U3);
  vd_carlson_twice(&s->d, 0x1p-2);
  vd_carlson_roots(&s->d);
}

SKF_INLINE void inverse_arc_duplications(const arc_row *c, inverse_arc_state *s) {
  (void)c;
  vd_carlson_twice(&s->d, 0x1p-4);
  vd_carlson_roots(&s->d);
  vd_carlson_twice(&s->d, 0x1p-6);
#ifndef SKF_VEC_FLOAT
  vd_carlson_roots(&s->d);
  vd_carlson_twice(&s->d, 0x1p-8);
  vd_carlson_roots(&s->d);
  vd_carlson_twice(&s->d, 0x1p-10);
#endif
}

SKF_INLINE skf_vvalue inverse_arc_finish(const arc_row *c, const inverse_arc_state *s, double scale, bool next) {
  const arc_view *f = &s->f;
  skf_vcarlson v = vd_carlson_end(&s->d, scale);
  skf_vi beyond = s->U1 < vd_set(0);
  skf_vd rho2 = c->rho + c->rho, I = v.rf, A = vd_set(1. / 3) * v.rd, rr = s->r0 * s->r1;
  if (vi_any(beyond)) {
    quarter_view q = next ? arc_quarter_next(c, f) : arc_quarter(c, f);
    skf_vd per_rho = vd_set(1) / rho2; /* twice a quarter's */
    if (!next) v.good &= ~beyond | (vd_set(1024) * f->alpha > f->outer * f->outer);
    I = vd_select(beyond, vd_fma(q.K, per_rho, -I), I);
    A = vd_select(beyond, vd_fma(q.cos2 / f->alpha, per_rho, -A), A);
  }
  skf_vd sum = s->r0 + s->r1, rest = s->U3 * f->beta, inv = vd_set(1) / (rr * sum * rest);
  A = vd_fma(s->t.c0 * s->t.c1, inv * (sum * f->beta), A);
  skf_vd per_beta = inv * (rr * sum) * s->U3, ends = rho2 * rho2 * s->t.rise * (inv * rest);
  return arc_finish(c, f, rho2 * I, -(rho2 * A), -rho2 * vd_fnma(f->alpha, A, I) * per_beta, ends, v.good);
}

SKF_INLINE skf_vvalue inverse_arc_end(const arc_row *c, const inverse_arc_state *s) {
  return inverse_arc_finish(c, s, SKF_COUNT(0x1p-10, 0x1p-6), false);
}

/* With three duplications more, in floats next to the circle, too */
SKF_OUTLINE skf_vvalue inverse_arc_slow(const arc_row *c, skf_v3d x) {
  inverse_arc_state s;
  inverse_arc_begin(c, x, &s);
  inverse_arc_ends(c, &s);
  inverse_arc_arguments(c, &s);
  inverse_arc_duplications(c, &s);
  const double last = SKF_COUNT(0x1p-14, 0x1p-10);
  for (double scale = 4 * last; scale >= last; scale *= 0.25) {
    vd_carlson_roots(&s.d);
    vd_carlson_twice(&s.d, scale);
  }
  return inverse_arc_finish(c, &s, last, SKF_COUNT(false, true));
}

/* The radius and its square; of exp(-a^2 w) as in batch_point.h; a^2, 2 a^2 rho, a^2 rho^2; 2 pi rho and -4 pi rho a^2,
   both times the strength. */
typedef struct gaussian_ring_row {
  skf_v3d center, n;
  skf_vd rho, rho2, exponent, low, param2, b, other, F, g;
} gaussian_ring_row;

static double *gaussian_ring_pack(const skf_prepared *e, double *k) {
  const double rho = e->plan.arc.radius, a2 = e->kernel.param * e->kernel.param, F = 2 * SKF_PI * rho * e->strength;
  k = pack3(pack3(k, e->primitive.arc.center), e->plan.arc.n);
  const bool fits = fabs(a2 * F) < (double)SKF_PICK(1e307, 1e37); /* else no lane is good */
  k = pack_exponent_low(pack1(pack1(k, rho), rho * rho), fits ? e->kernel.param : (double)NAN);
  return pack1(pack1(pack1(pack1(pack1(k, a2), 2 * a2 * rho), a2 * rho * rho), F), -2 * a2 * F);
}

/* gaussian.c's circle, b = 2 a^2 rho k, w from the axis to x, k long. */
typedef struct gaussian_circle_state {
  skf_v3d w;
  skf_vd z, kk, k, b;
  skf_vpower e;
  skf_vi good, gone;
} gaussian_circle_state;

SKF_INLINE void gaussian_circle_begin(const gaussian_ring_row *c, skf_v3d x, gaussian_circle_state *s) {
  const skf_v3d d = vd3_sub(x, c->center);
  s->z = vd3_dot(d, c->n);
  s->w = vd3_less(d, s->z, c->n);
  s->kk = vd3_dot(s->w, s->w), s->k = vd_sqrt(s->kk);
}

/* exp(-a^2 (r^2 + 2 rho k)), or of the nearest point's r^2 where Bessel's function is scaled */
SKF_INLINE void gaussian_circle_power(const gaussian_ring_row *c, gaussian_circle_state *s) {
  const skf_vd b = c->b * s->k, inner = s->k - c->rho, zz = s->z * s->z, alpha = vd_fma(inner, inner, zz);
  const skf_vd w = vd_select(b < vd_set(VD_BESSEL_NEAR), s->kk + zz + c->rho2, alpha);
  s->b = b;
  s->e = SKF_COUNT(1, 0) ? vd_exp2_begin_low(c->exponent, c->low, w) : vd_exp2_begin(c->exponent, w);
  s->gone = vd_gaussian_gone(c->exponent, w), s->good = vd_gaussian_near(&s->e) | s->gone;
#ifndef SKF_VEC_FLOAT
  /* next to the circle its distance is exact enough for a wide Gaussian; what it loses in floats is less than the
     point's rounding */
  const skf_vd outer = s->k + c->rho, most = outer * outer;
  s->good &= (vd_set(1024) * alpha > most) | (c->param2 * most < vd_set(16));
#endif
  vd_exp2_middle(&s->e);
}
SKF_INLINE void gaussian_circle_late(const gaussian_ring_row *c, gaussian_circle_state *s) {
  (void)c;
  vd_exp2_late(&s->e);
}

SKF_INLINE skf_vvalue gaussian_circle_end(const gaussian_ring_row *c, const gaussian_circle_state *s) {
  const skf_vd most = vd_set(VD_BESSEL_NEAR), h = (skf_vd)((skf_vi)vd_exp2_end(&s->e) & ~s->gone);
  const skf_vi near = s->b < most;
  skf_vbessel v = vd_bessel_near(vd_min(s->b, most));
  skf_vd i0 = v.i0, across = vd_fnma(c->other, v.other, v.i0);
  if (!vi_all(near)) {
    v = vd_bessel_far(vd_max(s->b, most));
    i0 = vd_select(near, i0, v.i0);
    across = vd_select(near, across, vd_fma(s->k - c->rho, v.i0, c->rho * v.other) / s->k);
  }
  const skf_vd g = c->g * h;
  return (skf_vvalue){c->F * (h * i0), vd3_mad(vd3_scale(g * across, s->w), g * i0 * s->z, c->n), s->good};
}

SKF_BATCH_STAGED(inverse_arc, arc, inverse_arc_slow, inverse_arc_ends, inverse_arc_arguments, inverse_arc_duplications)
SKF_BATCH_SCALED(gaussian_circle, gaussian_ring, skf_again_none, gaussian_circle_power, gaussian_circle_late,
                 skf_stage_none)

#endif
