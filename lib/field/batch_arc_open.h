/* SPDX-License-Identifier: MIT */
/* Vector forms: Cauchy's kernel and 1 / r^2 along an arc that is no circle.

   Neither the distance to the axis nor half angles are needed. In coordinates scaled by s, p towards the arc's middle,
   t along it there, z across, an element at the angle phi has W = l + s^2 r^2 = a - 2 rho (p cos phi + t sin phi), l =
   1 or 0. With k^2 = p^2 + t^2, w = k^2 - rho^2, q = l + z^2: v = w + q, a = v + 2 rho^2,
     D^2 = a^2 - (2 rho k)^2 = w^2 + q (2 w + q + 4 rho^2),
   and W at both ends has the product B = X^2 + (D S)^2, X = a C - 2 rho p. Then, each the derivative of the one before,
     int 1 / W = I1 = 2 delta / D, tan delta = D S / X;
     int (1, cos phi, sin phi) / W^2 = K (a, 2 rho p, 2 rho t) + E (C, 1, 0), K = (I1 - X E) / D^2, E = 2 S / B;
     2 int (1, cos phi, sin phi) / W^3 = M (a, 2 rho p, 2 rho t) + N (C, 1, 0) - (K, 0, 0), M = a L + C H,
     L = (3 K - X H) / D^2, H = 4 S^3 / B^2, N = H (a + C X / S^2).
   p = u + rho, so that where an arc is short u, measured from its middle, W and D are as exact as the place; else p =
   u. Next to the circle, W and D would lose too much to their subtractions: there k^2 - rho^2 and z are formed exactly,
   and what K and L lose by theirs, beyond the ends, comes from series in tan delta. */
#ifndef SKF_FIELD_BATCH_ARC_OPEN_H
#define SKF_FIELD_BATCH_ARC_OPEN_H

#include "field/batch_loop.h"
#include "num/gauss.h"

typedef struct open_arc_row {
  skf_v3d from, m, t, n;         /* the origin of u; the axes of u, t, z, s long */
  skf_v3d up, on, over;          /* the same times -2 rho and the strength, rho not scaled */
  skf_vd above;                  /* z of the origin, which is rounded */
  skf_vd twice, less, two, four; /* 2 rho or 0, rho^2 less the origin's k^2, 2 rho^2, 4 rho^2 */
  skf_vd side, base, size;       /* X = C R + side u + base, R = u^2 + t^2 + q, their scale */
  skf_vd cut;                    /* next to a thin body w must be exact */
#ifdef SKF_VEC_FLOAT
  skf_vd least_D2, least_B; /* nearer to the body, and to its ends, more care is taken */
  skf_vd rest, wide, level; /* l - less; X = C v + wide u + level */
  skf_vd pull;              /* the factor of x - from in the gradient; up is that of T or N, over that of M z */
  skf_vd half, near2;       /* half the sweep; within this squared distance of the middle the sums are not good */
#endif
  skf_vd S, C, S2, versed;       /* S^2, 1 - C */
  skf_vd ends, H, CH2, mid, out; /* 2 S, 4 S^3, 4 S C, in floats half of them; rho or 0, 0 or -rho */
  skf_vd F, F1;                  /* rho, in floats twice that, and 2 rho, not scaled, times the strength */
  skf_v3d center, raw;           /* exactly: the normal is s / |raw| raw */
  skf_vd radius, s2, per_raw;    /* not scaled; s^2; s / |raw| */
} open_arc_row;

/* Of int 1 / W and its derivatives floats take halves, so that nothing is doubled. */
#define OPEN_ARC_PART SKF_COUNT(1, 0.5)

static double *open_arc_pack_by(const skf_prepared *e, double s, bool thin, double *k) {
  const skf_arc_plan *a = &e->plan.arc;
  double C = a->cos_half, S = a->sin_half, rho = s * a->radius, rho2 = rho * rho, F = a->radius * e->strength;
  double versed = C > 0 ? S * S / (1 + C) : 1 - C;
  bool brief = a->half < 0.5;
  double extent = C > 0 ? S : 1, cut = thin ? fmax(16 - 64 / (rho2 * extent * extent), 0) * 4 * rho2 : 0;
  const double part = OPEN_ARC_PART, by[3] = {SKF_COUNT(1, brief ? rho : -rho), 1, SKF_COUNT(1, 2 * rho2)};
  skf_vec3 m = v3_add(v3_scale(C, a->e), v3_scale(S, a->f)), t = v3_sub(v3_scale(C, a->f), v3_scale(S, a->e));
  skf_vec3 axes[3] = {v3_scale(s, m), v3_scale(s, t), v3_scale(s, a->n)}, center = e->primitive.arc.center;
  skf_vec3 from = brief ? v3_mad(center, a->radius, m) : center;
  skf_dd3 off = dd3_diff(from, center);
  double less = dd3_power(a->radius, off);
  k = pack3(k, from);
  for (int i = 0; i < 3; i++) k = pack3(k, axes[i]);
  for (int i = 0; i < 3; i++) k = pack3(k, v3_scale(-2 / part * F * by[i], axes[i]));
  k = pack1(k, s * (dd3_dot_d(off, a->raw) / a->raw_length));
  k = pack1(pack1(pack1(pack1(k, brief ? 2 * rho : 0), s * s * less), 2 * rho2), 4 * rho2);
  k = pack1(pack1(k, -2 * rho * (brief ? versed : 1)), brief ? -2 * rho2 * versed : C * rho2);
  k = pack1(pack1(k, brief ? 2 * rho2 * versed : rho2), cut);
#ifdef SKF_VEC_FLOAT
  /* what rounding errors next to the body are compared with */
  const double size = (brief ? 6 * rho2 * versed : 2 * rho2) + (thin ? 1 : 0), size2 = fmax(size * size, 1e-16);
  k = pack1(pack1(k, (size2 + cut) / (thin ? 64 : 512)), size2 / (thin ? 64 : 256));
  k = pack1(pack1(pack1(k, (thin ? 1 : 0) - s * s * less), -2 * rho), brief ? -2 * rho2 * versed : 2 * C * rho2);
  k = pack1(k, -2 / part * F * s * s);
  /* T loses rho, as if x were displaced, which counts where the body is small and near */
  const skf_box box = skf_primitive_bounds(&e->primitive);
  double reach = 0;
  for (int i = 0; i < 3; i++) reach = fmax(reach, fmax(fabs(v3_get(box.lo, i)), fabs(v3_get(box.hi, i))));
  const double near = thin && brief ? (2.2 * a->radius - 6.9 * reach) / 16 : 0;
  k = pack1(pack1(k, a->half), near > 0 ? near * near : -1);
#endif
  k = pack1(pack1(pack1(pack1(k, S), C), S * S), versed);
  k = pack1(pack1(pack1(k, part * 2 * S), part * 4 * S * S * S), part * 4 * S * C);
  k = pack1(pack1(k, brief ? rho : 0), brief ? 0 : -rho);
  k = pack3(pack3(pack1(pack1(k, F / part), 2 * F), center), a->raw);
  return pack1(pack1(pack1(k, a->radius), s * s), s / a->raw_length);
}

static double *open_arc_pack(const skf_prepared *e, double *k) { return open_arc_pack_by(e, e->kernel.param, true, k); }
typedef open_arc_row squared_arc_row;
static double *squared_arc_pack(const skf_prepared *e, double *k) { return open_arc_pack_by(e, 1, false, k); }

typedef struct open_arc_state {
#ifdef SKF_VEC_FLOAT
  skf_v3d d;   /* x - from, along which the gradient is taken, too */
  skf_vd M, T; /* its factor; that of the middle's direction */
#endif
  skf_vd u, t, z; /* the coordinates, in doubles then the gradient in them */
  skf_vd v, X, D2, B, D, per_B, per_D2;
  skf_vd offset, angle; /* of delta; angle: first tan of what is left of it, then delta / D, then F */
  skf_vd excess;        /* half of K D^2, for 1 / r^2 */
  skf_vi good;
} open_arc_state;
typedef open_arc_state cauchy_arc_state, inverse_squared_arc_state;

SKF_INLINE void open_arc_begin(const open_arc_row *c, skf_v3d x, open_arc_state *s) {
  skf_v3d d = vd3_sub(x, c->from);
  s->u = vd3_dot(d, c->m), s->t = vd3_dot(d, c->t);
#ifdef SKF_VEC_FLOAT
  s->d = d;
#endif
  s->z = vd_fma(d.z, c->n.z, vd_fma(d.y, c->n.y, vd_fma(d.x, c->n.x, c->above)));
}

/* From w and q; size2: the square of what rounding errors may be compared with */
SKF_INLINE skf_vd open_arc_form(const open_arc_row *c, skf_vd w, skf_vd q, skf_vd y, open_arc_state *s) {
  skf_vd R = vd_fma(s->t, s->t, vd_fma(s->u, s->u, q));
  skf_vd D2 = vd_fma(w, w, q * SKF_COUNT((w + w) + (q + c->four), vd_fma(vd_set(2), w, q + c->four)));
  skf_vd X = vd_fma(c->C, R, vd_fma(c->side, s->u, c->base)), B = vd_fma(D2, c->S2, X * X);
  skf_vd size = (R + vd_abs(y)) + c->size;
  s->v = w + q, s->X = X, s->D2 = D2, s->B = B, s->D = vd_sqrt(D2);
  return size * size;
}

#ifndef SKF_VEC_FLOAT
SKF_INLINE void open_arc_look(const open_arc_row *c, double least, double near, open_arc_state *s) {
  skf_vd q = vd_fma(s->z, s->z, vd_set(least)), y = c->twice * s->u;
  skf_vd size2 = open_arc_form(c, vd_fma(s->t, s->t, vd_fma(s->u, s->u, y - c->less)), q, y, s);
  s->good = vd_min(vd_fms(vd_set(near), s->D2, c->cut), vd_set(1024) * s->B) > size2;
  s->good &= size2 < vd_set(1e70);
  if (least == 0) s->good &= size2 > vd_set(1e-70);
}

SKF_INLINE void cauchy_arc_look(const open_arc_row *c, open_arc_state *s) { open_arc_look(c, 1, 16, s); }
SKF_INLINE void inverse_squared_arc_look(const open_arc_row *c, open_arc_state *s) { open_arc_look(c, 0, 1024, s); }
#define cauchy_arc_begin          open_arc_begin
#define inverse_squared_arc_begin open_arc_begin
#endif

/* The same where w and z need the lower halves of the coordinates: w = |d|^2 - rho^2 - z^2 */
SKF_INLINE void open_arc_exact(const open_arc_row *c, skf_v3d x, double least, open_arc_state *s) {
  skf_v3d d = vd3_sub(x, c->center);
  open_arc_begin(c, x, s);
  s->z = c->per_raw * vd3_dot_exact(d, vd3_lost(x, c->center, d), c->raw);
  skf_vd zz = s->z * s->z, w = vd_fnma(c->s2, power_exact(c->radius, x, c->center, d), -zz);
  skf_vd size2 = open_arc_form(c, w, zz + vd_set(least), c->twice * s->u, s);
  s->good = (s->B > SKF_COUNT(vd_set(1. / 1024) * size2, c->least_B)) & (s->D2 > vd_set(1e-20) * size2) &
            (size2 < vd_set(SKF_PICK(1e70, 1e16))) & (size2 > vd_set(SKF_PICK(1e-70, 1e-16)));
}

SKF_INLINE void open_arc_turn(const open_arc_row *c, open_arc_state *s) {
  (void)c;
  s->per_B = vd_set(1) / s->B, s->per_D2 = vd_set(1) / s->D2;
}

SKF_INLINE void open_arc_middle(const open_arc_row *c, open_arc_state *s) {
  skf_vangle angle = vd_angle_parts(s->D * c->S, s->X);
  s->offset = angle.offset, s->angle = angle.top / angle.bottom;
  s->D *= s->per_D2; /* from now on 1 / D */
}

/* The gradient from M, N and (1 - C) N + K */
SKF_INLINE void open_arc_pull(const open_arc_row *c, open_arc_state *s, skf_vd M, skf_vd N, skf_vd rest) {
  skf_vd T = vd_fms(M, s->v, rest), U = T + N;
#ifdef SKF_VEC_FLOAT
  s->M = c->pull * U, s->T = vd_select(c->mid > vd_set(0), T, N), s->z *= M;
#else
  s->z *= vd_fma(c->two, M, U);
  s->t *= U;
  s->u = vd_fma(s->u, U, vd_fma(c->mid, T, c->out * N));
#endif
}

SKF_INLINE skf_vvalue open_arc_end(const open_arc_row *c, const open_arc_state *s) {
#ifdef SKF_VEC_FLOAT
  return (skf_vvalue){s->angle, vd3_mad(vd3_mad(vd3_scale(s->M, s->d), s->T, c->up), s->z, c->over), s->good};
#else
  return (skf_vvalue){s->angle, vd3_mad(vd3_mad(vd3_scale(s->u, c->up), s->t, c->on), s->z, c->over), s->good};
#endif
}

/* What is made of half an integral */
SKF_INLINE skf_vd open_arc_part(skf_vd half) { return SKF_COUNT(half + half, half); }

SKF_INLINE void cauchy_arc_series(const open_arc_row *c, open_arc_state *s) {
  (void)c;
  s->angle = vd_angle_series(s->offset, s->angle) * s->D;
}

/* From K and L D^2; sets F but for its factor, returns 2 int 1 / W^3 */
SKF_INLINE skf_vd cauchy_arc_force(const open_arc_row *c, open_arc_state *s, skf_vd K, skf_vd LD2, skf_vd H) {
  skf_vd C = c->C, a = s->v + c->two, M = vd_fma(a * s->per_D2, LD2, C * H);
  skf_vd N = SKF_COUNT(vd_fma(a, H, (c->CH2 * s->X) * (s->per_B * s->per_B)), H * vd_fma(s->X, c->CH2 / c->H, a));
  open_arc_pull(c, s, M, N, vd_fma(c->versed, N, K));
  s->angle = vd_fma(a, K, C * (c->ends * s->per_B));
  return vd_fma(a, M, vd_fms(C, N, K));
}

SKF_INLINE void cauchy_arc_gather(const open_arc_row *c, open_arc_state *s) {
  skf_vd I1 = open_arc_part(s->angle), H = c->H * (s->per_B * s->per_B), r = (s->v + c->two) * s->per_D2;
#ifdef SKF_VEC_FLOAT
  skf_vd K = vd_fnma(c->ends * s->per_B, s->X, I1) * s->per_D2;
  cauchy_arc_force(c, s, K, vd_fnma(s->X, H, (K + K) + K), H);
  /* what K loses, and with it L; and nothing underflows */
  s->good &= (s->angle > vd_set(0.185) * (r * I1)) & (H > vd_set(1e-33));
  s->angle *= c->F;
#else
  skf_vd K = vd_fnma(c->ends * s->X, s->per_B, I1) * s->per_D2;
  skf_vd I3 = cauchy_arc_force(c, s, K, vd_fnma(s->X, H, vd_set(3) * K), H);
  s->angle *= c->F;
  s->good &= vd_set(16) * I3 > I1 * (r * r);
#endif
}

/* (atan(t) / t - 1 + t^2 / 3) / t^4 for |t| <= tan(pi / 8) */
SKF_INLINE skf_vd open_arc_fifth(skf_vd tt) {
  skf_vd s = vd_set(1. / 47);
#pragma GCC unroll 24
  for (int n = 45; n >= 5; n -= 2) s = vd_fnma(s, tt, vd_set(1. / n));
  return s;
}

#ifdef SKF_VEC_FLOAT
/* Short arcs, whose sums differ by little from a point's: the Gauss rule of so many points of the arc, measured from
   its middle. It is exact to 1e-7 where W falls to the square of 3/4 of half the length, s long, at least. */
SKF_INLINE skf_vvalue cauchy_arc_rule(const open_arc_row *c, skf_v3d x) {
  enum { PAIRS = 6 };
  const skf_gauss_node *node = skf_gauss_rule(2 * PAIRS) + PAIRS;
  const skf_vd one = vd_set(1), zero = vd_set(0), rho = c->mid, length = rho * c->half;
  open_arc_state s;
  open_arc_begin(c, x, &s);
  const skf_vd q = vd_fma(s.z, s.z, one);
  skf_vd F = zero, G = zero, U = zero, T = zero, least = vd_set(INFINITY);
  for (int j = 0; j < PAIRS; j++) {
    const skf_vd phi = c->half * vd_set(node[j].x), yy = phi * phi, weight = vd_set(node[j].w);
    const skf_vd sine = phi * vd_fma(yy, vd_fma(yy, vd_set(1. / 120), vd_set(-1. / 6)), one);
    const skf_vd versed = yy * vd_fma(yy, vd_fma(yy, vd_set(1. / 720), vd_set(-1. / 24)), vd_set(0.5));
    const skf_vd u = vd_fma(rho, versed, s.u), a = vd_fnma(rho, sine, s.t), b = vd_fma(rho, sine, s.t);
    const skf_vd rest = vd_fma(u, u, q), A = vd_fma(a, a, rest), B = vd_fma(b, b, rest);
    const skf_vd per_A = one / A, per_B = one / B, hA = per_A * per_A, hB = per_B * per_B;
    const skf_vd gA = hA * per_A, gB = hB * per_B, both = weight * (gA + gB);
    F = vd_fma(weight, hA + hB, F), G += both;
    U = vd_fma(both, versed, U), T = vd_fma(weight * sine, gB - gA, T);
    least = vd_min(least, vd_min(A, B));
  }
  const skf_v3d g = vd3_mad(vd3_mad(vd3_scale(c->pull * G, s.d), U, c->up), rho * T, c->on);
  return (skf_vvalue){vd_set(0.5) * c->F * c->half * F, vd3_scale(c->half, g),
                      (least > vd_set(0.64) * (length * length)) & (least < vd_set(1e9))};
}
#endif

/* Not within a quarter of the kernel's width from the circle, where the gradient all but vanishes */
SKF_OUTLINE skf_vvalue cauchy_arc_careful(const open_arc_row *c, skf_v3d x) {
  open_arc_state s;
  open_arc_exact(c, x, 1, &s);
  open_arc_turn(c, &s);
  open_arc_middle(c, &s);
  skf_vi narrow = (s.offset == vd_set(0)) & (vd_abs(s.angle) < vd_set(0.415)); /* tan(pi / 8) */
  skf_vd t = s.angle, tt = t * t, ttt = t * tt, fifth = open_arc_fifth(tt);
  skf_vd rest = SKF_COUNT(ttt * vd_fma(tt, fifth, vd_set(-1. / 3)), vd_angle_rest(t));
  skf_vd sin2 = c->S2 * s.D2 * s.per_B, cos2 = vd_fnma(vd_set(2), sin2, vd_set(1)), H = c->H * (s.per_B * s.per_B);
  s.angle = s.D * (s.offset + (t + rest));
  skf_vd excess = vd_select(narrow, s.D * vd_fma(t, sin2, rest), vd_fnma(s.X, c->S * s.per_B, s.angle));
  skf_vd K = open_arc_part(excess) * s.per_D2;
  skf_vd L = s.D * s.per_D2 * ttt * (vd_set(OPEN_ARC_PART) * vd_fma(vd_set(6) * tt, fifth, (sin2 + sin2) * cos2));
  L = vd_select(narrow, L, vd_fnma(s.X, H, vd_set(3) * K));
  skf_vd I1 = open_arc_part(s.angle), a = s.v + c->two, r = a * s.per_D2, most = r * vd_select(narrow, a * L, I1 * r);
  s.good &= (s.D2 > vd_set(17. / 16) * c->four) & (vd_set(16) * cauchy_arc_force(c, &s, K, L, H) > most);
  s.angle *= c->F;
#ifdef SKF_VEC_FLOAT
  const skf_vi near = vd3_dot(s.d, s.d) < c->near2;
  s.good &= (H > vd_set(1e-33)) & ~near;
  skf_vvalue v = open_arc_end(c, &s);
  if (!vi_any(near)) return v;
  const skf_vvalue w = cauchy_arc_rule(c, x);
  return (skf_vvalue){vd_select(near, w.F, v.F), vd3_select(near, w.g, v.g), v.good | (near & w.good)};
#else
  return open_arc_end(c, &s);
#endif
}

SKF_INLINE void inverse_squared_arc_series(const open_arc_row *c, open_arc_state *s) {
  skf_vd t = s->angle, rest = vd_angle_rest(t), delta = s->D * (s->offset + (t + rest));
  skf_vd narrow = s->D * vd_fma(t, c->S2 * s->D2 * s->per_B, rest);
  s->excess = vd_select(s->offset == vd_set(0), narrow, vd_fnma(s->X, c->S * s->per_B, delta));
  s->angle = delta;
}

SKF_INLINE void inverse_squared_arc_gather(const open_arc_row *c, open_arc_state *s) {
  skf_vd E = c->ends * s->per_B;
  open_arc_pull(c, s, open_arc_part(s->excess) * s->per_D2, E, c->versed * E);
  s->angle *= c->F1;
}

SKF_OUTLINE skf_vvalue inverse_squared_arc_careful(const open_arc_row *c, skf_v3d x) {
  open_arc_state s;
  open_arc_exact(c, x, 0, &s);
  open_arc_turn(c, &s);
  open_arc_middle(c, &s);
  inverse_squared_arc_series(c, &s);
  inverse_squared_arc_gather(c, &s);
  return open_arc_end(c, &s);
}

#ifdef SKF_VEC_FLOAT
/* v from |d|^2, so that t is not needed; only what is read again is kept. */
SKF_INLINE void open_arc_seen(const open_arc_row *c, skf_v3d x, double least, open_arc_state *s) {
  skf_v3d d = vd3_sub(x, c->from);
  skf_vd u = vd3_dot(d, c->m), z = vd_fma(d.z, c->n.z, vd_fma(d.y, c->n.y, vd_fma(d.x, c->n.x, c->above)));
  const skf_vd dd = vd3_dot(d, d);
  skf_vd q = vd_fma(z, z, vd_set(least)), v = vd_fma(c->s2, dd, vd_fma(c->twice, u, c->rest)), w = v - q;
  skf_vd D2 = vd_fma(w, w, q * ((w + v) + c->four)), X = vd_fma(c->C, v, vd_fma(c->wide, u, c->level));
  skf_vd B = vd_fma(D2, c->S2, X * X);
  s->d = d, s->z = z, s->v = v, s->X = X;
  s->good = (D2 > c->least_D2) & (B > c->least_B);
  if (least == 0)
    s->D2 = D2, s->good &= B < vd_set(1e16);
  else
    s->good &= dd >= c->near2;
  s->D = vd_sqrt(D2), s->per_B = vd_set(1) / B, s->per_D2 = vd_set(1) / D2;
}
SKF_INLINE void cauchy_arc_begin(const open_arc_row *c, skf_v3d x, open_arc_state *s) { open_arc_seen(c, x, 1, s); }
SKF_INLINE void inverse_squared_arc_begin(const open_arc_row *c, skf_v3d x, open_arc_state *s) {
  open_arc_seen(c, x, 0, s);
}
SKF_INLINE skf_vvalue cauchy_arc_end(const open_arc_row *c, const open_arc_state *s) {
  open_arc_state f = *s;
  cauchy_arc_gather(c, &f);
  return open_arc_end(c, &f);
}
SKF_INLINE skf_vvalue inverse_squared_arc_end(const open_arc_row *c, const open_arc_state *s) {
  open_arc_state f = *s;
  inverse_squared_arc_gather(c, &f);
  return open_arc_end(c, &f);
}
SKF_BATCH_SCALED(cauchy_arc, open_arc, cauchy_arc_careful, open_arc_middle, cauchy_arc_series, skf_stage_none)
SKF_BATCH_SCALED(inverse_squared_arc, squared_arc, inverse_squared_arc_careful, open_arc_middle,
                 inverse_squared_arc_series, skf_stage_none)
#else
#define cauchy_arc_end          open_arc_end
#define inverse_squared_arc_end open_arc_end
SKF_BATCH_LONG(cauchy_arc, open_arc, cauchy_arc_careful, cauchy_arc_look, open_arc_turn, open_arc_middle,
               cauchy_arc_series, cauchy_arc_gather)
SKF_BATCH_LONG(inverse_squared_arc, squared_arc, inverse_squared_arc_careful, inverse_squared_arc_look, open_arc_turn,
               open_arc_middle, inverse_squared_arc_series, inverse_squared_arc_gather)

#endif

#endif
