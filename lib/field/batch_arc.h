/* SPDX-License-Identifier: MIT */
/* Vector forms: kernels along an arc or a circle. The geometry is that of arc_frame.c; points next to the circle, where
   it needs double-double, are left to the closed form. */
#ifndef SKF_FIELD_BATCH_ARC_H
#define SKF_FIELD_BATCH_ARC_H

#include "field/batch_span.h"

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

SKF_INLINE arc_view arc_see(const arc_row *c, skf_v3d x) {
  skf_v3d d = vd3_sub(x, c->center);
  skf_vd u = vd3_dot(d, c->e), v = vd3_dot(d, c->f), rho = c->rho, zero = vd_set(0);
  arc_view f = {.k = vd_sqrt(vd_fma(u, u, v * v)), .z = vd3_dot(d, c->n)};
  skf_vi off = f.k > zero; /* the axis */
  skf_vd per = vd_set(1) / vd_select(off, f.k, rho);
  f.ux = vd_select(off, u * per, vd_set(1));
  f.uy = vd_select(off, v * per, zero);
  f.inner = f.k - rho, f.outer = f.k + rho;
  f.alpha = vd_fma(f.inner, f.inner, f.z * f.z);
  f.beta = vd_fma(f.outer, f.outer, f.z * f.z);
  f.good = (vd_set(1024) * f.alpha > f.outer * f.outer) & vd_sane(f.beta);
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

/* The span of an arc that is no circle, N and W = 1 + s^2 r^2 at its ends; from the antipode of x cos and sin change
   places. */
SKF_INLINE span_view arc_span(const arc_row *c, const arc_view *f, skf_vd Pm, skf_vd Pp, skf_vd D, skf_vd *W_sum,
                              skf_vd *sin_mid) {
  skf_vd S = c->S, C = c->C;
  skf_vi behind = f->ux < vd_set(0);
  skf_vd uy = vd_select(behind, -f->uy, f->uy), cb = vd_sqrt(vd_fma(vd_set(0.5), vd_abs(f->ux), vd_set(0.5)));
  skf_vd sb = vd_set(-0.5) * uy / cb, c1 = vd_fma(C, cb, -(S * sb)), s1 = vd_fma(S, cb, C * sb);
  skf_vd P = vd_select(behind, Pp, Pm), Q = vd_select(behind, Pm, Pp); /* W = P cos^2 + Q sin^2 */
  skf_vd W0 = vd_fma(P, cb * cb, Q * (sb * sb)), W1 = vd_fma(P, c1 * c1, Q * (s1 * s1));
  skf_vd u = P * (cb * c1), v = Q * (sb * s1), cos_sigma = u - v;
  *W_sum = W0 + W1;
  *sin_mid = vd_fma(S, f->ux, -(C * f->uy));
  return span_see(D * S, u + v, vd_sqrt(W0 * W1), vd_select(behind, -cos_sigma, cos_sigma), D * *sin_mid);
}

typedef struct cauchy_factors {
  skf_vd Pm, Pp, D, per_D, im, ip;
  skf_vi good;
} cauchy_factors;

SKF_INLINE cauchy_factors cauchy_factor(const arc_row *c, const arc_view *f) {
  skf_vd one = vd_set(1), Pm = vd_fma(c->param2, f->alpha, one), Pp = vd_fma(c->param2, f->beta, one), PP = Pm * Pp;
  skf_vd D = vd_sqrt(PP), per_D = one / D, per = per_D * per_D;
  return (cauchy_factors){Pm, Pp, D, per_D, Pp * per, Pm * per, vd_sane(PP)};
}

/* From the integrals of cos^2, sin^2, cos^4, sin^4, cos^2 sin^2 */
SKF_INLINE skf_vvalue cauchy_gather(const arc_row *c, const arc_view *f, const cauchy_factors *p, skf_vd c2, skf_vd s2,
                                    skf_vd c4, skf_vd s4, skf_vd mixed, skf_vd ends, skf_vi good) {
  skf_vd K = (c->rho + c->rho) * p->per_D, G = vd_set(-4) * c->param2 * K, F = K * vd_fma(c2, p->im, s2 * p->ip);
  skf_vd cc = G * p->im * vd_fma(c4, p->im, mixed * p->ip), ss = G * p->ip * vd_fma(mixed, p->im, s4 * p->ip);
  return arc_finish(c, f, F, cc, ss, ends, good & p->good);
}

/* Off the axis, away from the circle of a thin body and from the ends of a long thin one neither the distance to the
   axis nor half angles are needed. In coordinates scaled by s about the arc's middle, p towards it, t along it, z
   across, k^2 = p^2 + t^2, an element at the angle phi has W = 1 + s^2 r^2 = a - 2 rho (p cos phi + t sin phi), a = 1 +
   z^2 + k^2 + rho^2. With N = dW / dphi, D^2 = a^2 - (2 rho k)^2 = q (2 a - q) + w^2, q = 1 + z^2, w = k^2 - rho^2,
   and brackets for differences between the ends
     I1 = int dphi / W = 2 delta / D, tan delta = D S / (a C - 2 rho p), I2 = ([N / W] + a I1) / D^2,
     I3 = ([N / W^2] - I1 + 3 a I2) / (2 D^2), int sin(phi - azimuth) / W^3 = -[1 / W^2] / (4 rho k),
     int 2 rho k cos(phi - azimuth) / W^3 = a I3 - I2, without its cancellation;
   at the ends W = g -+ 2 rho S t, g = a - 2 rho C p, and their product is (D S)^2 + (a C - 2 rho p)^2. */
typedef struct open_arc_row {
  arc_row at;
  skf_v3d m, t, n;                                                  /* the axes of p, t, z, s long */
  skf_vd rho2, twice, twice2, twice_C, twice_S, S2, F, g, g2, rise; /* g2 = 2 g, rise = 2 twice^2 g */
} open_arc_row;

static double *open_arc_pack_by(const skf_prepared *e, double s, double *k) {
  const skf_arc_plan *a = &e->plan.arc;
  double C = a->cos_half, S = a->sin_half, rho = s * a->radius;
  k = arc_pack(e, k);
  k = pack3(k, v3_scale(s, v3_add(v3_scale(C, a->e), v3_scale(S, a->f))));
  k = pack3(k, v3_scale(s, v3_sub(v3_scale(C, a->f), v3_scale(S, a->e))));
  k = pack3(k, v3_scale(s, a->n));
  k = pack1(pack1(pack1(k, rho * rho), 2 * rho), 4 * rho * rho);
  k = pack1(pack1(pack1(k, 2 * rho * C), 2 * rho * S), S * S);
  double g = -2 * a->radius * e->strength;
  return pack1(pack1(pack1(pack1(k, -g), g), 2 * g), 8 * rho * rho * g);
}

static double *open_arc_pack(const skf_prepared *e, double *k) { return open_arc_pack_by(e, e->kernel.param, k); }

typedef struct open_arc_state {
  skf_vd p, t, z, k2, a, dot, D2, WW, D, per_WW, per_D2, per_k2;
  skf_vd offset, delta; /* set in the middle, delta a tangent at first; then D becomes 1 / D */
  skf_vi good;
} open_arc_state;
typedef open_arc_state cauchy_arc_state;

/* W = least + r^2, r scaled by s */
SKF_INLINE void open_arc_begin(const open_arc_row *c, skf_v3d x, double least, open_arc_state *s) {
  skf_v3d d = vd3_sub(x, c->at.center);
  skf_vd p = vd3_dot(d, c->m), t = vd3_dot(d, c->t), z = vd3_dot(d, c->n);
  skf_vd k2 = vd_fma(p, p, t * t), q = vd_fma(z, z, vd_set(least)), rest = k2 + c->rho2, w = k2 - c->rho2, a = q + rest;
  skf_vd D2 = vd_fma(w, w, q * (a + rest)), dot = vd_fms(a, c->at.C, c->twice * p), WW = vd_fma(dot, dot, D2 * c->S2);
  skf_vd a2 = a * a;
  s->p = p, s->t = t, s->z = z, s->k2 = k2, s->a = a, s->dot = dot;
  s->good = (vd_set(16) * vd_min(D2, vd_set(64) * WW) > a2) & (k2 > vd_set(SKF_PICK(1e-140, 1e-18))) &
            (a2 < vd_set(SKF_PICK(1e70, 1e18)));
  s->D2 = D2, s->WW = WW;
}

SKF_INLINE void cauchy_arc_begin(const open_arc_row *c, skf_v3d x, open_arc_state *s) { open_arc_begin(c, x, 1, s); }

SKF_INLINE void open_arc_turn(const open_arc_row *c, open_arc_state *s) {
  skf_vd one = vd_set(1);
  (void)c;
  s->D = vd_sqrt(s->D2), s->per_WW = one / s->WW, s->per_D2 = one / s->D2, s->per_k2 = one / s->k2;
}

SKF_INLINE void open_arc_middle(const open_arc_row *c, open_arc_state *s) {
  skf_vangle angle = vd_angle_parts(s->D * c->at.S, s->dot);
  s->offset = angle.offset, s->delta = angle.top / angle.bottom;
  s->D *= s->per_D2;
}

SKF_INLINE void open_arc_series(const open_arc_row *c, open_arc_state *s) {
  (void)c;
  s->delta = vd_angle_series(s->offset, s->delta) * s->D;
}

/* I1 and I2 by halves */
SKF_INLINE skf_vvalue cauchy_arc_end(const open_arc_row *c, const open_arc_state *s) {
  skf_vd p = s->p, t = s->t, a = s->a, per_W = s->per_WW, per_D2 = s->per_D2, I1 = s->delta;
  skf_vd pS = c->twice_S * p, tS = c->twice_S * t, tC = c->twice_C * t, g = vd_fnma(c->twice_C, p, a);
  skf_vd ends = vd_fms(pS, g, tC * tS) * per_W, I2 = vd_fma(a, I1, ends) * per_D2;
  skf_vd y = (tS + tS) * (per_W * per_W), gy = g * y, ends2 = vd_fms(pS, vd_fma(tS, y, per_W), tC * gy);
  skf_vd three = vd_fma(vd_set(3), a * I2, ends2 - I1), I3 = c->g2 * (three * per_D2), G = c->g * s->per_k2;
  skf_vd part = vd_fma(vd_fma(a, ends, c->twice2 * s->k2 * I1), per_D2, ends2);
  skf_vd R = vd_fnma(vd_fma(G * a, part, c->rise * I2), per_D2, I3), E = G * gy;
  skf_v3d v = vd3_scale(vd_fms(R, p, E * t), c->m);
  v = vd3_mad(vd3_mad(v, vd_fma(R, t, E * p), c->t), s->z * I3, c->n);
  return (skf_vvalue){c->F * I2, v, s->good & (vd_set(16) * three > I1)};
}

SKF_INLINE skf_vvalue cauchy_arc_close(const open_arc_row *row, skf_v3d x) {
  const arc_row *c = &row->at;
  arc_view f = arc_see(c, x);
  cauchy_factors p = cauchy_factor(c, &f);
  skf_vd W_sum, sin_mid;
  span_view a = arc_span(c, &f, p.Pm, p.Pp, p.D, &W_sum, &sin_mid);
  skf_vd per_N2 = a.per_N * a.per_N, rho2 = c->rho * c->rho;
  skf_vd ends = vd_set(4) * rho2 * c->param2 * c->S * sin_mid * W_sum * (per_N2 * per_N2);
  skf_vvalue v = cauchy_gather(c, &f, &p, span_second(&a, a.c), span_second(&a, a.s), span_fourth(&a, a.c),
                               span_fourth(&a, a.s), span_mixed(&a), ends, a.good);
  return vv_scale(c->strength, v);
}

SKF_INLINE skf_vvalue cauchy_circle(const arc_row *c, skf_v3d x) {
  arc_view f = circle_see(c, x);
  cauchy_factors p = cauchy_factor(c, &f);
  skf_vd second = vd_set(SKF_PI / 2), fourth = vd_set(3 * SKF_PI / 8);
  return cauchy_gather(c, &f, &p, second, second, fourth, fourth, vd_set(SKF_PI / 8), vd_set(0), vi_set(-1));
}

SKF_BATCH_CROSSED(cauchy_arc, open_arc, cauchy_arc_close, open_arc_turn, open_arc_middle, open_arc_series)
SKF_BATCH_FORM(cauchy_circle, arc, skf_again_none)

#endif
