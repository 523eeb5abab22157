/* SPDX-License-Identifier: MIT */
/* Vector forms: kernels along an arc or a circle. The geometry is that of arc_frame.c; points next to the circle, where
   it needs double-double, are left to the closed form. */
#ifndef SKF_FIELD_BATCH_ARC_H
#define SKF_FIELD_BATCH_ARC_H

#include "field/batch_span.h"

/* As skf_arc_plan; the kernel's parameter squared */
typedef struct arc_row {
  skf_v3d center, e, f, n;
  skf_vd rho, S, C, param2; /* radius, sine and cosine of half the sweep */
} arc_row;

static double *arc_pack(const skf_prepared *e, double *k) {
  const skf_arc_plan *a = &e->plan.arc;
  k = pack3(pack3(pack3(pack3(k, e->primitive.arc.center), a->e), a->f), a->n);
  k = pack1(pack1(pack1(k, a->radius), a->sin_half), a->cos_half);
  return pack1(k, e->kernel.param * e->kernel.param);
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

/* Away from the axis, from the circle of a thin body (rounding k shifts 1 + s^2 alpha by s k of an ulp) and from the
   ends of a long thin one no half angles are needed: with a = (Pp + Pm) / 2, b = (Pp - Pm) / 2 and the azimuth mu of x
   from the middle of the arc, N cos delta = a C - b cos mu, N cos sigma = a cos mu - b C, N sin delta = D S, W0 + W1 =
   2 (a - b C cos mu). */
typedef struct cauchy_arc_state {
  skf_vd u, v, z, k;
  skf_vd inner, outer, Pm, Pp, D, per_k;                /* set in the turn */
  skf_vd a, b, m, cross, dot, per_D, per_N2, offset, t; /* set in the middle; then t is delta */
  skf_vi good;
} cauchy_arc_state;

SKF_INLINE void cauchy_arc_begin(const arc_row *c, skf_v3d x, cauchy_arc_state *s) {
  skf_v3d d = vd3_sub(x, c->center);
  s->u = vd3_dot(d, c->e), s->v = vd3_dot(d, c->f), s->z = vd3_dot(d, c->n);
  s->k = vd_sqrt(vd_fma(s->u, s->u, s->v * s->v));
}

SKF_INLINE void cauchy_arc_turn(const arc_row *c, cauchy_arc_state *s) {
  skf_vd inner = s->k - c->rho, outer = s->k + c->rho, zz = s->z * s->z, outer2 = outer * outer, one = vd_set(1);
  skf_vd alpha = vd_fma(inner, inner, zz), Pm = vd_fma(c->param2, alpha, one), Pp = vd_fma(c->param2, outer2 + zz, one);
  s->inner = inner, s->outer = outer, s->Pm = Pm, s->Pp = Pp;
  s->D = vd_sqrt(Pm * Pp), s->per_k = one / s->k;
  s->good =
      ((vd_set(1024) * alpha > outer2) | (c->param2 * outer2 < vd_set(64))) & (s->k > vd_set(SKF_PICK(1e-140, 1e-18)));
}

SKF_INLINE void cauchy_arc_middle(const arc_row *c, cauchy_arc_state *s) {
  skf_vd b2 = (c->rho + c->rho) * c->param2, m = vd_fma(c->C, s->u, c->S * s->v), b = b2 * s->k, a = s->Pm + b;
  skf_vd dot = vd_fnma(b2, m, a * c->C), cross = s->D * c->S, N2 = vd_fma(dot, dot, cross * cross);
  skf_vangle angle = vd_angle_parts(cross, dot);
  s->m = m, s->b = b, s->a = a, s->dot = dot, s->cross = cross, s->offset = angle.offset;
  s->per_N2 = vd_set(1) / N2, s->per_D = vd_set(1) / s->D, s->t = angle.top / angle.bottom;
  s->good &= (vd_set(1024) * N2 > a * a) & (N2 < vd_set(SKF_PICK(1e140, 1e18)));
}

SKF_INLINE void cauchy_arc_series(const arc_row *c, cauchy_arc_state *s) {
  (void)c;
  s->t = vd_angle_series(s->offset, s->t);
}

/* first, second: sin delta cos sigma and sin 2 delta cos 2 sigma / 2; int cos^2 = (delta + first) / 2, int cos^4 =
   (3 delta + 4 first + second) / 8, int cos^2 sin^2 = (delta - second) / 8. */
SKF_INLINE skf_vvalue cauchy_arc_end(const arc_row *c, const cauchy_arc_state *s) {
  skf_vd per_k = s->per_k, per_D = s->per_D, per = per_D * per_D, im = s->Pp * per, ip = s->Pm * per;
  skf_vd cs = vd_fms(s->a, s->m * per_k, s->b * c->C), sN = s->cross * s->per_N2, turned = s->per_N2 * cs;
  skf_vd delta = s->t, first = sN * cs;
  skf_vd second = sN * s->dot * vd_fma(turned + turned, cs, vd_set(-1)), twice = first + first, four = twice + twice;
  skf_vd fourth = vd_fma(vd_set(3), delta, second), mixed = delta - second;
  skf_vd cc = im * vd_fma(fourth + four, im, mixed * ip), ss = ip * vd_fma(fourth - four, ip, mixed * im),
         all = cc + ss;
  skf_vd F = c->rho * per_D * vd_fma(delta + first, im, (delta - first) * ip);
  skf_vd G = -(c->rho * c->param2) * per_D, R = G * per_k * vd_fma(s->inner, cc, s->outer * ss);
  skf_vd b2 = (c->rho + c->rho) * c->param2, W = vd_fnma(c->C * b2, s->m, s->a), per_kN = per_k * s->per_N2;
  skf_vd ends = vd_set(4) * c->rho * b2 * c->S * vd_fms(c->S, s->u, c->C * s->v) * W * (per_kN * per_kN);
  skf_v3d g = vd3_scale(vd_fms(R, s->u, ends * s->v), c->e);
  g = vd3_mad(vd3_mad(g, vd_fma(R, s->v, ends * s->u), c->f), G * all * s->z, c->n);
  return (skf_vvalue){F, g, s->good & (vd_set(16) * all > delta * im * im)};
}

SKF_INLINE skf_vvalue cauchy_arc_close(const arc_row *c, skf_v3d x) {
  arc_view f = arc_see(c, x);
  cauchy_factors p = cauchy_factor(c, &f);
  skf_vd W_sum, sin_mid;
  span_view a = arc_span(c, &f, p.Pm, p.Pp, p.D, &W_sum, &sin_mid);
  skf_vd per_N2 = a.per_N * a.per_N, rho2 = c->rho * c->rho;
  skf_vd ends = vd_set(4) * rho2 * c->param2 * c->S * sin_mid * W_sum * (per_N2 * per_N2);
  return cauchy_gather(c, &f, &p, span_second(&a, a.c), span_second(&a, a.s), span_fourth(&a, a.c),
                       span_fourth(&a, a.s), span_mixed(&a), ends, a.good);
}

SKF_INLINE skf_vvalue cauchy_circle(const arc_row *c, skf_v3d x) {
  arc_view f = circle_see(c, x);
  cauchy_factors p = cauchy_factor(c, &f);
  skf_vd second = vd_set(SKF_PI / 2), fourth = vd_set(3 * SKF_PI / 8);
  return cauchy_gather(c, &f, &p, second, second, fourth, fourth, vd_set(SKF_PI / 8), vd_set(0), vi_set(-1));
}

/* 4 rho int dchi / r and 4 rho int sin^2 chi dchi / r^3 beta over a quarter turn, by the arithmetic-geometric mean of
   skf_elliptic_complete: da / db >= 1/33, so that five steps are enough. */
typedef struct quarter_view {
  skf_vd K, sin2;
} quarter_view;

SKF_INLINE quarter_view arc_quarter(const arc_row *c, const arc_view *f) {
  skf_vd da = vd_sqrt(f->alpha), db = vd_sqrt(f->beta), one = vd_set(1), half = vd_set(0.5), per_db = one / db;
  skf_vd kp = da * per_db, rest = vd_set(4) * c->rho * f->k * per_db / (da + db); /* 1 - kp */
  skf_vd a = half * (one + kp), g = vd_sqrt(kp), w = half * rest, E = vd_set(0.25) * rest / (one + kp), t = one;
  skf_vd S = half + E;
  for (int i = 0; i < 5; i++) {
    skf_vd next = half * (a + g), q = vd_set(0.25) * w / next;
    g = vd_sqrt(a * g);
    a = next;
    E *= q * q;
    w *= q;
    t += t;
    S = vd_fma(t, E, S);
  }
  skf_vd K = vd_set(SKF_PI * 2) * c->rho * per_db / a;
  return (quarter_view){K, K * S};
}

SKF_INLINE skf_vvalue inverse_circle(const arc_row *c, skf_v3d x) {
  arc_view f = circle_see(c, x);
  quarter_view q = arc_quarter(c, &f);
  return arc_finish(c, &f, q.K, (q.sin2 - q.K) / f.alpha, -(q.sin2 / f.beta), vd_set(0), vd_sane(f.alpha));
}

SKF_BATCH_STAGED(cauchy_arc, arc, cauchy_arc_close, cauchy_arc_turn, cauchy_arc_middle, cauchy_arc_series)
SKF_BATCH_FORM(cauchy_circle, arc, skf_again_none)
SKF_BATCH_FORM(inverse_circle, arc, skf_again_none)

#endif
