/* SPDX-License-Identifier: MIT */
/* Vector forms: quartic and soft object along an arc or a circle. Where h does not vanish the arc is at most two
   windows about the points of the circle that are nearest to x, chi = 0 and pi; or it is one, without a rim. There h is
   a polynomial in cos 2 chi. */
#ifndef SKF_FIELD_BATCH_ARC_COMPACT_H
#define SKF_FIELD_BATCH_ARC_COMPACT_H

#include "field/batch_arc_smooth.h"

/* With the radius of the support and half the sweep; its sine and cosine are in the arc */
typedef struct compact_arc_row {
  arc_row arc;
  skf_vd R, R2, per_R, half;
} compact_arc_row;

static double *compact_arc_pack(const skf_prepared *e, double *k) {
  double R = e->kernel.param;
  return pack1(pack1(pack1(pack1(arc_pack(e, k), R), R * R), 1 / R), e->plan.arc.half);
}

/* R^2 - r^2 = qa cos^2 chi + qb sin^2 chi; where this is negative on the far side it vanishes at chi = +-rim, else rim
   = pi / 2. near: it cancels next to x. */
typedef struct disc_view {
  skf_vd qa, qb, spread, rim;
  skf_vd wide, thin; /* the roots of qa and -qb, where positive */
  skf_vi some, cut, near;
} disc_view;

SKF_INLINE disc_view arc_disc(const compact_arc_row *c, const arc_view *f) {
  skf_vd zero = vd_set(0);
  disc_view v = {.qa = c->R2 - f->alpha};
  v.spread = vd_set(4) * c->arc.rho * f->k;
  v.qb = v.qa - v.spread;
  v.cut = v.qb < zero;
  v.some = v.qa > zero;
  v.near = vd_set(1024) * vd_abs(v.qa) < c->R2;
  v.wide = vd_sqrt(vd_max(v.qa, zero)), v.thin = vd_sqrt(vd_max(-v.qb, zero));
  v.rim = vd_select(v.cut & v.some, vd_angle(v.wide, vd_select(v.some, v.thin, vd_set(1))), vd_set(SKF_PI / 2));
  /* next to the circle the distance from it is exact enough only for a large support */
  v.near |= vd_max(vd_set(1024) * f->alpha, vd_set(4) * c->R2) <= f->outer * f->outer;
  return v;
}

/* The part of the arc from chi0 to chi1 with |chi| < rim; R^2 - r^2 at that end which is farther from chi = 0 */
typedef struct window_view {
  skf_vd mid, half, q;
  skf_vi some;
} window_view;

SKF_INLINE window_view arc_window(const compact_arc_row *c, const disc_view *d, skf_vd chi0, skf_vd chi1, skf_vd q0,
                                  skf_vd q1) {
  skf_vd zero = vd_set(0), below = chi0 + d->rim, above = d->rim - chi1;
  skf_vi cut_lo = below < zero, cut_hi = above < zero;
  skf_vd length = vd_select(cut_lo & cut_hi, d->rim + d->rim, vd_select(cut_hi, d->rim - chi0, chi1 + d->rim));
  length = vd_select(cut_lo | cut_hi, length, c->half);
  skf_vd lo = vd_select(cut_lo, -d->rim, chi0), hi = vd_select(cut_hi, d->rim, chi1), mid = vd_set(0.5) * (lo + hi);
  skf_vi upper = mid >= zero, cut = (upper & cut_hi) | (~upper & cut_lo);
  return (window_view){mid, vd_set(0.5) * length, (skf_vd)((skf_vi)vd_select(upper, q1, q0) & ~cut),
                       d->some & (hi > lo) & (length > zero)};
}

typedef struct arc_sum {
  skf_vd F, cc, ss; /* int h, int g cos^2, int g sin^2 by units of the caller's */
} arc_sum;

/* int sin^2k t dt over |t| <= half, k = 0..3, half <= pi / 2; the last only for cubes */
typedef struct arc_moments {
  skf_vd m0, m1, m2, m3;
} arc_moments;

/* Of short windows from the highest one by parts: sums of positive terms; of long ones, whose series would lose digits,
   from the lowest. ss, part: sin^2, sin cos of half */
SKF_INLINE arc_moments window_moments(skf_vd half, skf_vd ss, skf_vd part, bool cubes) {
#ifdef SKF_VEC_FLOAT
  /* int sin^4 / half^5 and int sin^6 / half^7 in half^2 - 5 / 4, where what the long ones lose is an ulp or two: 3e-8,
     6e-8 */
  static const double fourth[] = {0.22006977082031958,    -0.1053464110813779,    0.025321851720305901,
                                  -0.0038718350081252038, 0.00041423638185867459, -0.000033015286706030031,
                                  1.9814415396328204e-6};
  static const double sixth[] = {0.10744808462977772,     -0.084273917862075626, 0.033150534887528551,
                                 -0.0084736489244605025,  0.0015586290660234399, -0.00021848075310083637,
                                 0.000024603286940134326, -2.1241878096709764e-6};
  const skf_vd y = half * half, x = y - vd_set(1.25), up = half * y * y, once = part * ss;
  arc_moments m = {.m0 = half + half, .m3 = vd_set(0)};
  if (cubes) {
    m.m3 = up * y * vd_estrin(sixth, 8, x);
    m.m2 = vd_fma(vd_set(6. / 5), m.m3, vd_set(2. / 5) * (once * ss));
  } else
    m.m2 = up * vd_estrin(fourth, 7, x);
  m.m1 = vd_fma(vd_set(4. / 3), m.m2, vd_set(2. / 3) * once);
  return m;
#else
  /* int sin^4 / half^5 and int sin^6 / half^7 in half^2: 8e-17, 6e-17 */
  static const double fourth[] = {0.39999999999999999042,     -0.19047619047618935741,   0.044444444444422814650,
                                  -0.0065416065414426718806,  0.00067290733893217973979, -0.000051306716488897806905,
                                  3.0185928094881222123e-6,   -1.4122517345914702432e-7, 5.3787821844728050829e-9,
                                  -1.6953632866644547126e-10, 4.3748795528486770046e-12, -7.7179269809935132629e-14};
  static const double sixth[] = {0.28571428571428571178,     -0.22222222222222182365,   0.084848484848474339235,
                                 -0.020838420838311621240,   0.0036684303345042776700,  -0.00049118637161078011155,
                                 0.000051968613758218269277, -4.4645347826399864559e-6, 3.1794843547178528802e-7,
                                 -1.9081624680720755470e-8,  9.7688486483416124894e-10, -4.2690744325123963976e-11,
                                 1.5155683150520404408e-12,  -3.3921132013577363614e-14};
  skf_vd y = half * half, up = half * y * y;
  arc_moments m = {.m0 = half + half};
  if (cubes) {
    m.m3 = up * y * vd_estrin(sixth, sizeof sixth / sizeof *sixth, y);
    m.m2 = vd_fma(vd_set(6. / 5), m.m3, vd_set(2. / 5) * (part * (ss * ss)));
  } else {
    m.m3 = vd_set(0);
    m.m2 = up * vd_estrin(fourth, sizeof fourth / sizeof *fourth, y);
  }
  m.m1 = vd_fma(vd_set(4. / 3), m.m2, vd_set(2. / 3) * (part * ss));
  skf_vi wide = half > vd_set(1);
  skf_vd m1 = half - part, m2 = vd_fms(vd_set(0.75), m1, vd_set(0.5) * (part * ss));
  m.m1 = vd_select(wide, m1, m.m1), m.m2 = vd_select(wide, m2, m.m2);
  if (cubes) {
    skf_vd m3 = vd_fms(vd_set(5. / 6), m2, vd_set(1. / 3) * (part * (ss * ss)));
    m.m3 = vd_select(wide, m3, m.m3);
  }
  return m;
#endif
}

/* With t = chi less the middle of a window and y = sin^2 t, there is R^2 - r^2 = q - e y - o / 2 sin 2t where q is its
   value in the middle, cos^2 chi = C^2 - c y - s / 2 sin 2t with C, S, c, s the cosine and sine of the middle's chi and
   2 chi; e, o are c, s times the spread. Odd terms vanish or pair up to y - y^2. As each y is of the order of q,
   nothing cancels where the window is short. */
SKF_INLINE void polynomial_moments(skf_vd q, skf_vd spread, skf_vd C, skf_vd S, const arc_moments *m, double c2,
                                   double c3, arc_sum *sum, skf_vi some) {
  skf_vd CC = C * C, SS = S * S, c = (C - S) * (C + S), s = vd_set(2) * C * S, e = spread * c, o = spread * s;
  skf_vd d1 = m->m1 - m->m2, so = s * o, oo = o * o;
  skf_vd L0 = vd_fma(q, m->m0, -(e * m->m1)), L1 = vd_fma(q, m->m1, -(e * m->m2)), turn = vd_fma(so, d1, -(c * L1));
  skf_vd J0 = vd_fma(oo, d1, vd_fma(q, L0, -(e * L1))), two = vd_set(2 * c2);
  skf_vd F = vd_set(c2) * J0, cc = two * vd_fma(CC, L0, turn), ss = two * vd_fma(SS, L0, -turn);
  if (c3 != 0) {
    skf_vd d2 = m->m2 - m->m3, Z = vd_set(2) * vd_fma(q, d1, -(e * d2)), L2 = vd_fma(q, m->m2, -(e * m->m3));
    skf_vd J1 = vd_fma(oo, d2, vd_fma(q, L1, -(e * L2))), bend = vd_fma(so, Z, -(c * J1)), three = vd_set(3 * c3);
    F = vd_fma(vd_set(c3), vd_fma(oo, Z, vd_fma(q, J0, -(e * J1))), F);
    cc = vd_fma(three, vd_fma(CC, J0, bend), cc);
    ss = vd_fma(three, vd_fma(SS, J0, -bend), ss);
  }
  sum->F += (skf_vd)((skf_vi)F & some);
  sum->cc += (skf_vd)((skf_vi)cc & some);
  sum->ss += (skf_vd)((skf_vi)ss & some);
}

SKF_INLINE void polynomial_window(const compact_arc_row *c, const disc_view *d, const window_view *w, double c2,
                                  double c3, arc_sum *sum) {
  if (!vi_any(w->some)) return;
  skf_vd per_R2 = c->per_R * c->per_R, qb = d->qb * per_R2, spread = d->spread * per_R2;
  skf_vsincos mid = vd_sincos(w->mid), half = vd_sincos(w->half);
  /* sin(2 |mid| + half), up to the farther end from its mirror image */
  skf_vd twice = vd_set(2) * vd_abs(mid.sin * mid.cos), cosine = (mid.cos - mid.sin) * (mid.cos + mid.sin);
  skf_vd across = vd_fma(twice, half.cos, cosine * half.sin);
  skf_vd q = vd_select(d->cut, vd_fma(spread * half.sin, across, w->q * per_R2), vd_fma(spread, mid.cos * mid.cos, qb));
  arc_moments m = window_moments(w->half, half.sin * half.sin, half.sin * half.cos, c3 != 0);
  polynomial_moments(q, spread, mid.cos, mid.sin, &m, c2, c3, sum, w->some);
}

SKF_INLINE skf_vvalue compact_finish(const compact_arc_row *c, const arc_view *f, const disc_view *d, const arc_sum *s,
                                     skf_vd slope, skf_vd ends) {
  skf_vd rho2 = c->arc.rho + c->arc.rho, g = rho2 * slope;
  arc_view near = *f;
  near.good = f->beta < vd_set(INFINITY);
  ends = (skf_vd)((skf_vi)ends & d->some);
  return arc_finish(&c->arc, &near, rho2 * s->F, g * s->cc, g * s->ss, ends, ~d->near);
}

/* q0, q1: R^2 - r^2 at the ends; turn = (q0 - q1) / k; and rho (h0 - h1) / k */
typedef struct tips_view {
  skf_vd q0, q1, turn;
} tips_view;

SKF_INLINE tips_view arc_tips(const compact_arc_row *c, const arc_view *f, disc_view *d, skf_vd *chi0) {
  ends_view t = arc_ends(&c->arc, f);
  skf_vd q0 = vd_fma(d->qa, t.c0 * t.c0, d->qb * (t.s0 * t.s0)), q1 = vd_fma(d->qa, t.c1 * t.c1, d->qb * (t.s1 * t.s1));
  d->near |= d->some & (vd_set(1024) * vd_min(vd_abs(q0), vd_abs(q1)) < c->R2);
  *chi0 = vd_set(-0.5) * vd_atan2(f->uy, f->ux);
  return (tips_view){q0, q1, vd_set(4) * c->arc.rho * t.rise};
}

SKF_INLINE skf_vvalue polynomial_arc(const compact_arc_row *c, skf_v3d x, double c2, double c3) {
  arc_view f = arc_see(&c->arc, x);
  disc_view d = arc_disc(c, &f);
  skf_vd zero = vd_set(0), chi0, per_R2 = c->per_R * c->per_R;
  arc_sum s = {zero, zero, zero};
  if (!vi_any(d.some)) return compact_finish(c, &f, &d, &s, vd_set(-2) * per_R2, zero);
  tips_view t = arc_tips(c, &f, &d, &chi0);
  skf_vd chi1 = chi0 + c->half, turn = vd_set(SKF_PI);
  d.rim = vd_select(d.cut, d.rim, turn + turn); /* uncut, the arc is one window */
  window_view front = arc_window(c, &d, chi0, chi1, t.q0, t.q1),
              back = arc_window(c, &d, chi0 - turn, chi1 - turn, t.q0, t.q1);
  back.some &= d.cut;
  polynomial_window(c, &d, &front, c2, c3, &s);
  polynomial_window(c, &d, &back, c2, c3, &s);
  skf_vi in0 = t.q0 > zero, in1 = t.q1 > zero;
  skf_vd m0 = vd_max(t.q0, zero) * per_R2, m1 = vd_max(t.q1, zero) * per_R2, sum = m0 + m1;
  skf_vd dm = vd_select(in0 & in1, t.turn * per_R2, (m0 - m1) / vd_select(in0 | in1, f.k, vd_set(1)));
  skf_vd ends = c->arc.rho * dm * vd_fma(vd_set(c3), vd_fma(sum, sum, -(m0 * m1)), vd_set(c2) * sum);
  return compact_finish(c, &f, &d, &s, vd_set(-2) * per_R2, ends);
}

/* Along a circle the axes do not matter: w from the axis to x. The window is about chi = 0, the whole circle where
   nothing is cut. In units of R and of the circle's factors. */
typedef struct compact_circle_row {
  skf_v3d center, n;
  skf_vd rho, R2, per_R2, four, F, g; /* 4 rho, 2 rho and -4 rho / R^2 times the strength */
  skf_vd reach, least;                /* R + rho, R - rho */
} compact_circle_row;

static double *compact_circle_pack(const skf_prepared *e, double *k) {
  const double rho = e->plan.arc.radius, R = e->kernel.param, F = 2 * rho * e->strength;
  k = pack3(pack3(k, e->primitive.arc.center), e->plan.arc.n);
  k = pack1(pack1(pack1(k, rho), R * R), 1 / (R * R));
  k = pack1(pack1(pack1(k, 4 * rho), F), -2 / (R * R) * F);
  return pack1(pack1(k, R + rho), R - rho);
}

typedef struct polynomial_circle_state {
  skf_v3d w;
  skf_vd z, k, qa, root, per; /* root: of -qa qb, where cut; per: 1 / spread */
  skf_vd offset, angle;       /* of the rim */
  skf_vi good;
} polynomial_circle_state;
typedef polynomial_circle_state quartic_circle_state, soft_object_circle_state;

/* How many times R^2 - r^2 must be R^2 at least: a moved place excuses floats, but for where nothing changes then. */
SKF_INLINE skf_vd rim_factor(skf_vd k, skf_vd rho, double on_axis) {
  return vd_select(vd_set(4) * k > rho, vd_set(SKF_PICK(1024, 0x1p14)), vd_set(on_axis));
}
#define RIM_PLAIN SKF_COUNT(24, 4)
#define RIM_APART SKF_COUNT(1024, 1024)

SKF_INLINE void polynomial_circle_begin(const compact_circle_row *c, skf_v3d x, polynomial_circle_state *s) {
  skf_v3d d = vd3_sub(x, c->center);
  s->z = vd3_dot(d, c->n);
  s->w = vd3_less(d, s->z, c->n);
  s->k = vd_sqrt(vd3_dot(s->w, s->w));
}
#define quartic_circle_begin     polynomial_circle_begin
#define soft_object_circle_begin polynomial_circle_begin

/* apart: next to the rim on the axis, where R - rho counts; not next to the circle */
SKF_INLINE void polynomial_circle_power(const compact_circle_row *c, polynomial_circle_state *s, bool apart) {
  skf_vd inner = s->k - c->rho, outer = s->k + c->rho, zz = s->z * s->z, alpha = vd_fma(inner, inner, zz);
  skf_vd qa = apart ? vd_fms(c->reach - s->k, c->least + s->k, zz) : c->R2 - alpha;
  skf_vd spread = c->four * s->k, most = outer * outer;
  s->qa = qa;
  s->root = vd_sqrt(vd_max(qa * (spread - qa), vd_set(0)));
  s->per = vd_set(1) / vd_max(spread, vd_set(SKF_PICK(1e-60, 1e-18)) * most);
  s->good = (rim_factor(s->k, c->rho, apart ? RIM_APART : RIM_PLAIN) * vd_abs(qa) >= c->R2) &
            (most < vd_set(SKF_PICK(1e70, 1e16)));
  if (apart) s->good &= vd_set(4) * s->k <= c->rho;
  /* next to the circle the distance from it is exact enough only for a large support */
  s->good &= vd_max(vd_set(SKF_PICK(1024, 0x1p24)) * alpha, vd_set(SKF_PICK(4, 0x1p16)) * c->R2) > most;
}
SKF_INLINE void polynomial_circle_roots(const compact_circle_row *c, polynomial_circle_state *s) {
  polynomial_circle_power(c, s, false);
}

SKF_INLINE void polynomial_circle_rim(const compact_circle_row *c, polynomial_circle_state *s) {
  (void)c;
  skf_vangle a = vd_angle_parts(vd_max(s->qa, vd_set(0)), s->root);
  s->offset = a.offset, s->angle = a.top / a.bottom;
}

SKF_INLINE void polynomial_circle_series(const compact_circle_row *c, polynomial_circle_state *s) {
  (void)c;
  s->angle = vd_angle_series(s->offset, s->angle);
}

SKF_INLINE skf_vvalue polynomial_circle(const compact_circle_row *c, const polynomial_circle_state *s, double c2,
                                        double c3) {
  skf_vd e = c->four * s->k * c->per_R2, q = s->qa * c->per_R2, two = vd_set(2 * c2);
  arc_moments m = window_moments(s->angle, vd_min(s->qa * s->per, vd_set(1)), s->root * s->per, c3 != 0);
  skf_vd L0 = vd_fma(q, m.m0, -(e * m.m1)), L1 = vd_fma(q, m.m1, -(e * m.m2)), J0 = vd_fma(q, L0, -(e * L1));
  skf_vd F = vd_set(c2) * J0, all = two * L0, ss = two * L1; /* all: int g */
  if (c3 != 0) {
    skf_vd L2 = vd_fma(q, m.m2, -(e * m.m3)), J1 = vd_fma(q, L1, -(e * L2)), three = vd_set(3 * c3);
    F = vd_fma(vd_set(c3), vd_fma(q, J0, -(e * J1)), F);
    all = vd_fma(three, J0, all), ss = vd_fma(three, J1, ss);
  }
  skf_vd across = vd_fma(s->k - c->rho, all, (c->rho + c->rho) * ss), per_k = c->four * s->per;
  skf_vi some = s->qa > vd_set(0);
  F = (skf_vd)((skf_vi)(c->F * F) & some);
  skf_vd by_w = (skf_vd)((skf_vi)(c->g * across * per_k) & some), by_n = (skf_vd)((skf_vi)(c->g * all * s->z) & some);
  return (skf_vvalue){F, vd3_mad(vd3_scale(by_w, s->w), by_n, c->n), s->good};
}
SKF_INLINE skf_vvalue quartic_circle_end(const compact_circle_row *c, const quartic_circle_state *s) {
  return polynomial_circle(c, s, 1, 0);
}
SKF_INLINE skf_vvalue soft_object_circle_end(const compact_circle_row *c, const soft_object_circle_state *s) {
  return polynomial_circle(c, s, 5. / 9, 4. / 9);
}

/* The same of an arc that x sees in one window, off the axis, stage after stage. */
typedef struct polynomial_arc_state {
  skf_vd u, v, z, k, per_k, qa;
  skf_vd root, cb, sb;         /* of -qa qb, where cut; cos and sin of half the azimuth up to signs, as arc_ends */
  skf_vd turn_offset, turn;    /* of half the azimuth */
  skf_vd rim_offset, rim;      /* of the rim */
  skf_vd mid, half, q, q0, q1; /* q: R^2 - r^2 at the farther end, then in the middle */
  skf_vsincos at;              /* of mid */
  arc_moments m;               /* m0, m1 at first sin and cos of half */
  skf_vi some, good;
} polynomial_arc_state;
typedef polynomial_arc_state quartic_arc_state, soft_object_arc_state;

SKF_INLINE void polynomial_arc_begin(const compact_arc_row *row, skf_v3d x, polynomial_arc_state *s) {
  const arc_row *c = &row->arc;
  skf_v3d d = vd3_sub(x, c->center);
  s->u = vd3_dot(d, c->e), s->v = vd3_dot(d, c->f), s->z = vd3_dot(d, c->n);
  s->k = vd_sqrt(vd_fma(s->u, s->u, s->v * s->v));
}
#define quartic_arc_begin     polynomial_arc_begin
#define soft_object_arc_begin polynomial_arc_begin

SKF_INLINE void polynomial_arc_look(const compact_arc_row *row, polynomial_arc_state *s) {
  const skf_vd rho = row->arc.rho, inner = s->k - rho, outer = s->k + rho, alpha = vd_fma(inner, inner, s->z * s->z);
  const skf_vd spread = vd_set(4) * rho * s->k, most = outer * outer;
  s->qa = row->R2 - alpha;
  s->root = vd_sqrt(vd_max(s->qa * (spread - s->qa), vd_set(0)));
  s->per_k = vd_set(1) / s->k;
  skf_vangle a = vd_angle_parts(vd_abs(s->v), s->k + vd_abs(s->u));
  s->turn_offset = a.offset, s->turn = a.top / a.bottom;
  s->good =
      (rim_factor(s->k, rho, SKF_COUNT(256, 32)) * vd_abs(s->qa) >= row->R2) & (most < vd_set(SKF_PICK(1e70, 1e16)));
  s->good &= (vd_max(vd_set(1024) * alpha, vd_set(4) * row->R2) > most) & (s->k > vd_set(SKF_PICK(1e-30, 1e-16)) * rho);
}

SKF_INLINE void polynomial_arc_angles(const compact_arc_row *row, polynomial_arc_state *s) {
  (void)row;
  skf_vd half = vd_set(0.5), by = half * s->per_k;
  s->cb = vd_sqrt(vd_fma(by, vd_abs(s->u), half));
  s->sb = vd_select(s->u < vd_set(0), by * s->v, -(by * s->v)) / s->cb;
  skf_vangle a = vd_angle_parts(vd_max(s->qa, vd_set(0)), s->root);
  s->rim_offset = a.offset, s->rim = a.top / a.bottom;
}

/* Of a window about chi = pi, which the arc reaches where it begins beyond the rim, chi is measured from there. */
SKF_INLINE void polynomial_arc_window(const compact_arc_row *row, polynomial_arc_state *s) {
  const arc_row *c = &row->arc;
  skf_vd zero = vd_set(0), half = vd_set(0.5), pi = vd_set(SKF_PI), spread = vd_set(4) * c->rho * s->k;
  skf_vd qa = s->qa, qb = qa - spread, turn = vd_angle_series(s->turn_offset, s->turn);
  skf_vi behind = s->u < zero, cut = qb < zero;
  skf_vd rim = vd_select(cut, vd_angle_series(s->rim_offset, s->rim), pi + pi);
  turn = vd_select(behind, vd_set(SKF_PI / 2) - turn, turn);
  skf_vd chi0 = (skf_vd)((skf_vi)turn ^ (vi_sign_bit() ^ vd_sign(s->v)));
  skf_vi beyond = chi0 >= rim;
  chi0 -= (skf_vd)((skf_vi)pi & beyond);
  skf_vd chi1 = chi0 + row->half, lo = vd_max(chi0, -rim), hi = vd_min(chi1, rim);
  skf_vi cut_lo = lo > chi0, cut_hi = hi < chi1;
  skf_vd length = vd_select(cut_lo | cut_hi, hi - lo, row->half), mid = half * (lo + hi);
  skf_vi seen = qa > zero, upper = mid >= zero, none = (upper & cut_hi) | (~upper & cut_lo);
  s->some = seen & (length > zero);
  skf_vd cb = s->cb, sb = s->sb, c1 = vd_fma(c->C, cb, -(c->S * sb)), s1 = vd_fma(c->S, cb, c->C * sb);
  skf_vd cc0 = cb * cb, ss0 = sb * sb, cc1 = c1 * c1, ss1 = s1 * s1;
  s->q0 = vd_fma(qa, vd_select(behind, ss0, cc0), qb * vd_select(behind, cc0, ss0));
  s->q1 = vd_fma(qa, vd_select(behind, ss1, cc1), qb * vd_select(behind, cc1, ss1));
  s->q = (skf_vd)((skf_vi)vd_select(upper, s->q1, s->q0) & ~none);
  s->mid = mid, s->half = half * vd_max(length, zero);
  s->good &= ~(seen & ((vd_set(SKF_PICK(1024, 4096)) * vd_min(vd_abs(s->q0), vd_abs(s->q1)) < row->R2) |
                       (cut & ~beyond & (chi1 > pi - rim))));
}

SKF_INLINE void polynomial_arc_middle(const compact_arc_row *row, polynomial_arc_state *s) {
  skf_vd per_R2 = row->per_R * row->per_R, spread = vd_set(4) * row->arc.rho * s->k, e = spread * per_R2;
  skf_vsincos mid = vd_sincos(s->mid), half = vd_sincos(s->half);
  skf_vd twice = vd_set(2) * vd_abs(mid.sin * mid.cos), cosine = (mid.cos - mid.sin) * (mid.cos + mid.sin);
  skf_vd across = vd_fma(twice, half.cos, cosine * half.sin), qb = s->qa - spread;
  s->q =
      vd_select(qb < vd_set(0), vd_fma(e * half.sin, across, s->q * per_R2), vd_fma(e, mid.cos * mid.cos, qb * per_R2));
  s->at = mid, s->m.m0 = half.sin, s->m.m1 = half.cos;
}

SKF_INLINE void quartic_arc_gather(const compact_arc_row *row, polynomial_arc_state *s) {
  (void)row;
  s->m = window_moments(s->half, s->m.m0 * s->m.m0, s->m.m0 * s->m.m1, false);
}
SKF_INLINE void soft_object_arc_gather(const compact_arc_row *row, polynomial_arc_state *s) {
  (void)row;
  s->m = window_moments(s->half, s->m.m0 * s->m.m0, s->m.m0 * s->m.m1, true);
}

SKF_INLINE skf_vvalue polynomial_arc_sum(const compact_arc_row *row, const polynomial_arc_state *s, double c2,
                                         double c3) {
  const arc_row *c = &row->arc;
  skf_vd zero = vd_set(0), per_R2 = row->per_R * row->per_R, spread = vd_set(4) * c->rho * s->k;
  skf_vd ux = s->u * s->per_k, uy = s->v * s->per_k;
  arc_sum sum = {zero, zero, zero};
  polynomial_moments(s->q, spread * per_R2, s->at.cos, s->at.sin, &s->m, c2, c3, &sum, s->some);
  skf_vi in0 = s->q0 > zero, in1 = s->q1 > zero;
  skf_vd turn = vd_set(4) * c->rho * (c->S * vd_fma(c->S, ux, -(c->C * uy)));
  skf_vd m0 = vd_max(s->q0, zero) * per_R2, m1 = vd_max(s->q1, zero) * per_R2, both = m0 + m1;
  skf_vd dm = vd_select(in0 & in1, turn * per_R2, (m0 - m1) * s->per_k);
  skf_vd ends = c->rho * dm * vd_fma(vd_set(c3), vd_fma(both, both, -(m0 * m1)), vd_set(c2) * both);
  ends = (skf_vd)((skf_vi)ends & (s->qa > zero));
  skf_vd F = (c->rho + c->rho) * c->strength, g = vd_set(-2) * per_R2 * F;
  const arc_view f = {.z = s->z, .ux = ux, .uy = uy, .inner = s->k - c->rho, .outer = s->k + c->rho, .good = s->good};
  return arc_finish(c, &f, F * sum.F, g * sum.cc, g * sum.ss, c->strength * ends, s->good);
}
SKF_INLINE skf_vvalue quartic_arc_end(const compact_arc_row *c, const quartic_arc_state *s) {
  return polynomial_arc_sum(c, s, 1, 0);
}
SKF_INLINE skf_vvalue soft_object_arc_end(const compact_arc_row *c, const soft_object_arc_state *s) {
  return polynomial_arc_sum(c, s, 5. / 9, 4. / 9);
}

SKF_OUTLINE skf_vvalue quartic_arc_twice(const compact_arc_row *c, skf_v3d x) {
  return vv_scale(c->arc.strength, polynomial_arc(c, x, 1, 0));
}
SKF_OUTLINE skf_vvalue soft_object_arc_twice(const compact_arc_row *c, skf_v3d x) {
  return vv_scale(c->arc.strength, polynomial_arc(c, x, 5. / 9, 4. / 9));
}

SKF_BATCH_LONG(quartic_arc, compact_arc, quartic_arc_twice, polynomial_arc_look, polynomial_arc_angles,
               polynomial_arc_window, polynomial_arc_middle, quartic_arc_gather)
SKF_INLINE void polynomial_circle_axis(const compact_circle_row *c, skf_v3d x, polynomial_circle_state *s) {
  polynomial_circle_begin(c, x, s);
  polynomial_circle_power(c, s, true);
  polynomial_circle_rim(c, s);
  polynomial_circle_series(c, s);
}
SKF_OUTLINE skf_vvalue quartic_circle_axis(const compact_circle_row *c, skf_v3d x) {
  quartic_circle_state s;
  polynomial_circle_axis(c, x, &s);
  return quartic_circle_end(c, &s);
}
SKF_OUTLINE skf_vvalue soft_object_circle_axis(const compact_circle_row *c, skf_v3d x) {
  soft_object_circle_state s;
  polynomial_circle_axis(c, x, &s);
  return soft_object_circle_end(c, &s);
}

SKF_BATCH_SCALED(quartic_circle, compact_circle, quartic_circle_axis, polynomial_circle_roots, polynomial_circle_rim,
                 polynomial_circle_series)
SKF_BATCH_LONG(soft_object_arc, compact_arc, soft_object_arc_twice, polynomial_arc_look, polynomial_arc_angles,
               polynomial_arc_window, polynomial_arc_middle, soft_object_arc_gather)
SKF_BATCH_SCALED(soft_object_circle, compact_circle, soft_object_circle_axis, polynomial_circle_roots,
                 polynomial_circle_rim, polynomial_circle_series)

#endif
