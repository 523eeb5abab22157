/* SPDX-License-Identifier: MIT */
/* Vector forms: Gaussians and 1 / r^2 along a segment. */
#ifndef SKF_FIELD_BATCH_SEGMENT_SMOOTH_H
#define SKF_FIELD_BATCH_SEGMENT_SMOOTH_H

#include "field/batch_segment.h"
#include "simd/vecspecial.h"

/* A segment, and what a short one needs: a^2 from the midpoint, m_n = int x^(2n) exp(p (1 - x^2)) dx over [0, 1] by
   (2n)!, p = (a L / 2)^2. */
enum { GAUSSIAN_MOMENTS = 7 };
typedef struct gaussian_span_row {
  segment_row s;
  skf_vd width; /* a L */
  skf_vd m[GAUSSIAN_MOMENTS];
} gaussian_span_row;

static double *gaussian_span_pack(const skf_prepared *e, double *k) {
  double width = e->kernel.param * e->plan.segment.length, pp = 0.5 * width * width, m = 0, factorial = 1;
  k = pack1(segment_pack(e, k), width);
  if (!(width <= 1)) pp = 0;      /* never short */
  for (int n = 16; n >= 0; n--) { /* by parts */
    m = (1 + pp * m) / (2 * n + 1);
    if (n < GAUSSIAN_MOMENTS) k[n] = m;
  }
  for (int n = 1; n < GAUSSIAN_MOMENTS; n++) k[n] /= factorial *= (2 * n) * (2 * n - 1);
  return k + GAUSSIAN_MOMENTS;
}

/* Squares of a times the distances from the ends and the line; a times the abscissae of the ends, and the width that
   they leave; the sum of the abscissae times half the width. */
typedef struct gaussian_view {
  skf_vd y0, y1, yh, u0, u1, width, delta;
  skf_vi brief; /* the series is for these */
} gaussian_view;

SKF_INLINE gaussian_view gaussian_see(skf_vd y0, skf_vd y1, skf_vd yh, skf_vd u0, skf_vd u1, skf_vd width) {
  skf_vd sum = u0 + u1;
  return (gaussian_view){
      y0, y1, yh, u0, u1, width, vd_set(0.5) * width * sum, width * vd_max(vd_abs(sum), width) <= vd_set(1)};
}

/* a int exp(-a^2 r^2) dt and h(r0) - h(r1); the smallest exponent that counts. */
typedef struct gaussian_value {
  skf_vd F, ends, least;
} gaussian_value;

/* int exp(-u^2) du = X(u0) exp(-u0^2) - X(u1) exp(-u1^2), X = vd_erfc_scaled, for 0 <= u0 <= u1; X(u) exp(-u^2) and its
   mirror image add up to sqrt(pi). Where the sum and the width of u0, u1 are so small that this would cancel, its
   Taylor series in delta = (u1^2 - u0^2) / 2 times the exponential at the mean square. */
SKF_INLINE gaussian_value gaussian_between(const gaussian_view *f, const skf_vd m[GAUSSIAN_MOMENTS]) {
  static const double sinh[] = {1,           1. / 6,         1. / 120,         1. / 5040,
                                1. / 362880, 1. / 39916800., 1. / 6227020800., 1. / 1307674368000.};
  skf_vd zero = vd_set(0), most = vd_set(VD_EXP_MAX), q = f->delta * f->delta;
  skf_vi within = (f->u0 < zero) & (f->u1 > zero);
  skf_vd third = vd_select(f->brief, vd_set(0.5) * (f->y0 + f->y1), f->yh);
  skf_vd e0 = vd_exp(-vd_min(f->y0, most)), e1 = vd_exp(-vd_min(f->y1, most)), e2 = vd_exp(-vd_min(third, most));
  skf_vd x0 = e0 * vd_erfc_scaled(vd_abs(f->u0)), x1 = e1 * vd_erfc_scaled(vd_abs(f->u1));
  skf_vd all = vd_fma(vd_set(1.7724538509055160273), e2, -(x0 + x1)), F = vd_select(within, all, vd_abs(x0 - x1));
  skf_vd s = m[GAUSSIAN_MOMENTS - 1];
  for (int n = GAUSSIAN_MOMENTS - 2; n >= 0; n--) s = vd_fma(s, q, m[n]);
  return (gaussian_value){vd_select(f->brief, f->width * e2 * s, F),
                          vd_select(f->brief, vd_set(2) * e2 * f->delta * vd_estrin(sinh, 8, q), e0 - e1),
                          vd_select(within & ~f->brief, f->yh, vd_min(f->y0, f->y1))};
}

/* So that an exponential cut at VD_EXP_MAX does not count */
#define GAUSSIAN_SEEN (VD_EXP_MAX - SKF_PICK(40, 17))

SKF_INLINE skf_vvalue gaussian_segment(const gaussian_span_row *c, skf_v3d x) {
  const segment_row *s = &c->s;
  segment_view f = segment_see(s, x);
  skf_vd a = s->param, a2 = s->param2, u0 = -a * vd3_dot(f.d0, s->a), u1 = -a * vd3_dot(f.d1, s->a);
  gaussian_view w = gaussian_see(a2 * f.n0, a2 * f.n1, a2 * s->per_L2 * f.n2, u0, u1, c->width);
  gaussian_value v = gaussian_between(&w, c->m);
  skf_vi seen = v.least < vd_set(GAUSSIAN_SEEN), gone = (v.least > vd_set(VD_EXP_ZERO)) & (v.least < vd_set(INFINITY));
  skf_vd F = (skf_vd)((skf_vi)(s->per_param * v.F) & seen), ends = (skf_vd)((skf_vi)v.ends & seen);
  skf_v3d g = segment_gradient(s, &f, vd_set(-2) * a2 * F, ends);
  return (skf_vvalue){F, g, (seen & (f.n2 < vd_set(INFINITY))) | gone};
}

/* inverse_squared.c's segment. With N = r0 r1 and delta the angle of view: F = delta / h, and -int g dt =
   (delta - sin delta) / h^3 + 2 c L / (N h^2) where c, cos^2 of the mean direction, has the factor h^2 beyond the ends.
 */
typedef struct inverse_squared_segment_state {
  segment_view f;
  skf_vd N, h, sum, cosine;          /* cosine: then bottom */
  skf_vd offset, t, top, inv, per_h; /* set in the middle */
  skf_vi good;
} inverse_squared_segment_state;

SKF_INLINE void inverse_squared_segment_begin(const segment_row *c, skf_v3d x, inverse_squared_segment_state *s) {
  segment_view f = segment_see(c, x);
  skf_vd N = vd_sqrt(f.n0 * f.n1), h2 = f.n2 * c->per_L2, h = vd_sqrt(h2);
  skf_vd t0 = -vd3_dot(f.d0, c->a), t1 = -vd3_dot(f.d1, c->a);
  *s = (inverse_squared_segment_state){f, N, h, t0 + t1, h2 - t0 * t1, h2, h2, h2, h2, h2, (skf_vi)h2};
}

SKF_INLINE void inverse_squared_segment_middle(const segment_row *c, inverse_squared_segment_state *s) {
  skf_vd NN = s->f.n0 * s->f.n1, one = vd_set(1), h2 = s->f.n2 * c->per_L2, A = s->N + vd_abs(s->cosine);
  skf_vi front = s->cosine >= vd_set(0);
  skf_vd bottom = vd_select(front, h2, A);
  skf_vangle angle = vd_angle_parts(s->h * c->L, vd3_dot(s->f.d0, s->f.d1));
  s->offset = angle.offset, s->t = angle.top / angle.bottom;
  s->top = vd_select(front, A, s->sum * s->sum), s->inv = one / (NN * bottom), s->per_h = one / s->h;
  s->cosine = bottom;
  s->good = vd_sane(NN) & vd_sane(s->f.n2) & vd_sane(NN * bottom);
}

SKF_INLINE skf_vvalue inverse_squared_segment_end(const segment_row *c, const inverse_squared_segment_state *s) {
  skf_vd L = c->L, per_NN = s->cosine * s->inv, ends = L * s->sum * per_NN, per_h = s->per_h;
  skf_vd delta = vd_angle_series(s->offset, s->t), gap = span_gap3(delta, s->h * L * s->N * per_NN), F = delta * per_h;
  skf_vd g = vd_fma(gap * per_h, per_h * per_h, L * s->top * s->inv);
  return (skf_vvalue){F, segment_gradient(c, &s->f, -g, ends), s->good};
}

SKF_BATCH_FORM(gaussian_segment, gaussian_span, skf_again_none)
SKF_BATCH_WOVEN(inverse_squared_segment, segment, skf_again_none, inverse_squared_segment_middle, skf_stage_none,
                skf_stage_none)

#endif
