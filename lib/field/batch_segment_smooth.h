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

/* int exp(-u^2) du = X(u0) exp(-u0^2) - X(u1) exp(-u1^2), X = vd_erfc_scaled, for 0 <= u0 <= u1; X(u) exp(-u^2) and its
   mirror image add up to sqrt(pi). Where the sum and the width of u0, u1 are so small that this would cancel, its
   Taylor series in delta = (u1^2 - u0^2) / 2 times the exponential at the mean square. */
SKF_INLINE skf_vvalue gaussian_segment(const gaussian_span_row *c, skf_v3d x) {
  static const double sinh[] = {1,           1. / 6,         1. / 120,         1. / 5040,
                                1. / 362880, 1. / 39916800., 1. / 6227020800., 1. / 1307674368000.};
  const segment_row *s = &c->s;
  segment_view f = segment_see(s, x);
  skf_vd a = s->param, a2 = s->param2, zero = vd_set(0), half = vd_set(0.5), most = vd_set(VD_EXP_MAX);
  skf_vd u0 = -a * vd3_dot(f.d0, s->a), u1 = -a * vd3_dot(f.d1, s->a), sum = u0 + u1;
  skf_vd y0 = a2 * f.n0, y1 = a2 * f.n1, yh = a2 * s->per_L2 * f.n2, delta = half * c->width * sum, q = delta * delta;
  skf_vi within = (u0 < zero) & (u1 > zero), brief = c->width * vd_max(vd_abs(sum), c->width) <= vd_set(1);
  skf_vd third = vd_select(brief, half * (y0 + y1), yh), least = vd_select(within & ~brief, yh, vd_min(y0, y1));
  skf_vd e0 = vd_exp(-vd_min(y0, most)), e1 = vd_exp(-vd_min(y1, most)), e2 = vd_exp(-vd_min(third, most));
  skf_vd x0 = e0 * vd_erfc_scaled(vd_abs(u0)), x1 = e1 * vd_erfc_scaled(vd_abs(u1));
  skf_vd all = vd_fma(vd_set(1.7724538509055160273), e2, -(x0 + x1)), F = vd_select(within, all, vd_abs(x0 - x1));
  skf_vd m = c->m[GAUSSIAN_MOMENTS - 1];
  for (int n = GAUSSIAN_MOMENTS - 2; n >= 0; n--) m = vd_fma(m, q, c->m[n]);
  F = s->per_param * vd_select(brief, c->width * e2 * m, F);
  skf_vd ends = vd_select(brief, vd_set(2) * e2 * delta * vd_estrin(sinh, 8, q), e0 - e1);
  /* so that an exponential cut at VD_EXP_MAX does not count */
  skf_vi seen = least < vd_set(VD_EXP_MAX - SKF_PICK(40, 17)),
         gone = (least > vd_set(VD_EXP_ZERO)) & (least < vd_set(INFINITY));
  F = (skf_vd)((skf_vi)F & seen), ends = (skf_vd)((skf_vi)ends & seen);
  skf_v3d g = segment_gradient(s, &f, vd_set(-2) * a2 * F, ends);
  return (skf_vvalue){F, g, (seen & (f.n2 < vd_set(INFINITY))) | gone};
}

/* inverse_squared.c's segment. With N = r0 r1 and delta the angle of view: F = delta / h, and -int g dt =
   (delta - sin delta) / h^3 + 2 c L / (N h^2) where c, cos^2 of the mean direction, has the factor h^2 beyond the ends.
 */
SKF_INLINE skf_vvalue inverse_squared_segment(const segment_row *c, skf_v3d x) {
  segment_view f = segment_see(c, x);
  skf_vd L = c->L, one = vd_set(1), NN = f.n0 * f.n1, N = vd_sqrt(NN), h2 = f.n2 * c->per_L2, h = vd_sqrt(h2);
  skf_vd t0 = -vd3_dot(f.d0, c->a), t1 = -vd3_dot(f.d1, c->a), sum = t0 + t1, tt = t0 * t1;
  skf_vd dot = vd3_dot(f.d0, f.d1), cross = h * L, delta = vd_atan2(cross, dot), cosine = h2 - tt,
         A = N + vd_abs(cosine);
  skf_vi front = cosine >= vd_set(0);
  skf_vd bottom = vd_select(front, h2, A), top = vd_select(front, A, sum * sum), inv = one / (NN * bottom);
  skf_vd ends = L * sum * bottom * inv, per_NN = bottom * inv;
  skf_vd per_h = one / h, gap = span_gap3(delta, cross * N * per_NN), F = delta * per_h;
  skf_vd g = vd_fma(gap * per_h, per_h * per_h, L * top * inv);
  skf_vi good = vd_sane(NN) & vd_sane(f.n2) & vd_sane(NN * bottom);
  return (skf_vvalue){F, segment_gradient(c, &f, -g, ends), good};
}

SKF_BATCH_FORM(gaussian_segment, gaussian_span, skf_again_none)
SKF_BATCH_FORM(inverse_squared_segment, segment, skf_again_none)

#endif
