/* SPDX-License-Identifier: MIT */
/* Vector forms: Gaussians and 1 / r^2 along a segment. */
#ifndef SKF_FIELD_BATCH_SEGMENT_SMOOTH_H
#define SKF_FIELD_BATCH_SEGMENT_SMOOTH_H

#include "field/batch_segment.h"
#include "simd/vecspecial.h"

/* A segment, and what a short one needs: a^2 from the midpoint, m_n = int x^(2n) exp(p (1 - x^2)) dx over [0, 1] by
   (2n)!, p = (a L / 2)^2. What a longer one needs, in units of sqrt(log 2) / a, so that the kernel is 2^-r^2: its
   direction by and times the unit, the latter times the strength; the unit's square; half the vector between the ends
   and half its length, and what this makes of arguments of vd_erfc_near and _far; a square of abscissae near enough for
   any distance from the axis; factors of the results. */
enum { GAUSSIAN_MOMENTS = 7 };
typedef struct gaussian_span_row {
  segment_row s;
  skf_vd width; /* a L */
  skf_vd m[GAUSSIAN_MOMENTS];
  skf_v3d middle, up, down, along;
  skf_vd binary, half, near, far, axis, F, g;
} gaussian_span_row;

/* So that an exponential cut at VD_EXP_MAX does not count */
#define GAUSSIAN_SEEN (VD_EXP_MAX - SKF_PICK(40, 17))

#define LOG2_E 1.4426950408889634074L

/* r times the direction, rounded once, and the inverse to what that is now: w = d - (d . up) down has no part along it.
 */
static double *pack_direction(double *k, long double r, const skf_prepared *e) {
  const skf_vec3 d = e->plan.segment.e, lo = e->plan.segment.e_lo;
  long double x = (long double)d.x + lo.x, y = (long double)d.y + lo.y, z = (long double)d.z + lo.z;
  r /= sqrtl(x * x + y * y + z * z);
  const skf_vec3 up = v3((double)(r * x), (double)(r * y), (double)(r * z));
  x = up.x, y = up.y, z = up.z;
  r = 1 / (x * x + y * y + z * z);
  return pack3(pack3(k, up), v3((double)(r * x), (double)(r * y), (double)(r * z)));
}

static double *gaussian_span_pack(const skf_prepared *e, double *k) {
  double width = e->kernel.param * e->plan.segment.length, pp = 0.5 * width * width, m = 0, factorial = 1;
  k = pack1(segment_pack(e, k), width);
  if (!(width <= 1)) pp = 0;      /* never short */
  for (int n = 16; n >= 0; n--) { /* by parts */
    m = (1 + pp * m) / (2 * n + 1);
    if (n < GAUSSIAN_MOMENTS) k[n] = m;
  }
  for (int n = 1; n < GAUSSIAN_MOMENTS; n++) k[n] /= factorial *= (2 * n) * (2 * n - 1);
  double a = e->kernel.param;
  skf_vec3 along = e->plan.segment.a;
  const long double binary = LOG2_E * a * a, unit = sqrtl(binary);
  const double half = (double)(unit * e->plan.segment.length / 2);
  k = pack3(k + GAUSSIAN_MOMENTS, v3_scale(0.5, e->plan.segment.e));
  k = pack3(pack_direction(k, unit, e), v3_scale(e->strength, along));
  k = pack1(pack1(pack1(pack1(k, (double)binary), half), VD_ERFC_NEAR - half), VD_ERFC_FAR + half);
  return pack1(pack1(pack1(k, (double)LOG2_E * 64 / (width * width)), e->strength / a), 2 * a * e->strength);
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

#define SQRT_PI 1.7724538509055160273

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
  skf_vd all = vd_fma(vd_set(SQRT_PI), e2, -(x0 + x1)), F = vd_select(within, all, vd_abs(x0 - x1));
  skf_vd s = m[GAUSSIAN_MOMENTS - 1];
  for (int n = GAUSSIAN_MOMENTS - 2; n >= 0; n--) s = vd_fma(s, q, m[n]);
  return (gaussian_value){vd_select(f->brief, f->width * e2 * s, F),
                          vd_select(f->brief, vd_set(2) * e2 * f->delta * vd_estrin(sinh, 8, q), e0 - e1),
                          vd_select(within & ~f->brief, f->yh, vd_min(f->y0, f->y1))};
}

SKF_INLINE skf_vvalue gaussian_segment_short(const gaussian_span_row *c, skf_v3d x) {
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

SKF_INLINE skf_vvalue gaussian_segment_careful(const gaussian_span_row *c, skf_v3d x) {
  return vv_scale(c->s.strength, gaussian_segment_short(c, x));
}

/* The same of one longer than its width, in stages: the series is never needed. On the axis w is not known well enough
   far from an end. Exponentials 2^-(u^2 + yh) are not of the rounded sum, which only tells their whole part, k. */
#define GAUSSIAN_MOST ((double)LOG2_E * VD_EXP_MAX)

SKF_INLINE skf_vd gaussian_whole(skf_vd y) { return vd_set(VD_EXP2_SHIFT) - vd_min(y, vd_set(GAUSSIAN_MOST)); }
/* Where k was cut, too */
SKF_INLINE skf_vd gaussian_mantissa(skf_vd k, skf_vd u, skf_vd yh) {
  skf_vd f = vd_max(vd_fnma(u, u, (vd_set(VD_EXP2_SHIFT) - k) - yh), vd_set(-0.5));
  skf_vpower e = {k, f, f};
  vd_exp2_middle(&e);
  vd_exp2_late(&e);
  return vd_exp2_mantissa(&e);
}
/* Near enough to count; next to the axis, y being the square of the distance from an end, known well enough; or gone */
SKF_INLINE skf_vi gaussian_seen(skf_vd least) { return least < vd_set((double)LOG2_E * GAUSSIAN_SEEN); }
SKF_INLINE skf_vi gaussian_good(const gaussian_span_row *c, skf_vd yh, skf_vd y, skf_vi seen, skf_vd least) {
  return (seen & (vd_fma(vd_set(SKF_PICK(256, 1e8)), yh, c->axis) > y)) |
         ((least > vd_set((double)LOG2_E * VD_EXP_ZERO)) & (least < vd_set(INFINITY)));
}
SKF_INLINE skf_vvalue gaussian_result(const gaussian_span_row *c, skf_vd F, skf_vd ends, skf_v3d w, skf_vi good) {
  return (skf_vvalue){c->F * F, vd3_mad(vd3_scale(ends, c->along), c->g * F, w), good};
}

/* No longer than four widths. The middle is u = v or -v from the foot of the perpendicular, the nearer end v - half,
   the other v + half: int 2^-u^2 du is X(v - half) 2^-(v - half)^2 - X(v + half) 2^-(v + half)^2 everywhere, X being
   known from -half on. */
typedef struct gaussian_segment_state {
  skf_v3d w;
  skf_vd u, yh, kn, kf, en, ef, xn, xf; /* en, ef: mantissas of the exponentials */
  skf_vi seen, good;
} gaussian_segment_state;

SKF_INLINE void gaussian_segment_begin(const gaussian_span_row *c, skf_v3d x, gaussian_segment_state *s) {
  skf_v3d d = vd3_add(vd3_sub(c->s.from, x), c->middle);
  skf_vd u = vd3_dot(d, c->up), v = vd_abs(u), un = v - c->half, uf = v + c->half;
  skf_v3d w = vd3_less(d, u, c->down);
  skf_vd yh = c->binary * vd3_dot(w, w), yn = vd_fma(un, un, yh), yf = vd_fma(uf, uf, yh);
  s->w = w, s->u = u, s->yh = yh;
  s->kn = gaussian_whole(yn), s->kf = gaussian_whole(yf);
  s->seen = gaussian_seen(yn), s->good = gaussian_good(c, yh, yf, s->seen, yn);
}

SKF_INLINE void gaussian_segment_exp(const gaussian_span_row *c, gaussian_segment_state *s) {
  skf_vd v = vd_abs(s->u);
  s->en = gaussian_mantissa(s->kn, v - c->half, s->yh), s->ef = gaussian_mantissa(s->kf, v + c->half, s->yh);
}

SKF_INLINE void gaussian_segment_erfc(const gaussian_span_row *c, gaussian_segment_state *s) {
  skf_vd v = vd_abs(s->u);
  s->xn = vd_erfc_near(v + c->near), s->xf = vd_erfc_far(v + c->far);
}

SKF_INLINE skf_vvalue gaussian_segment_end(const gaussian_span_row *c, const gaussian_segment_state *s) {
  skf_vd en = vd_exp2_raise(s->en, s->kn), ef = vd_exp2_raise(s->ef, s->kf);
  skf_vi F = (skf_vi)vd_fms(en, s->xn, ef * s->xf) & s->seen, ends = (skf_vi)(en - ef) & s->seen;
  return gaussian_result(c, (skf_vd)F, (skf_vd)(ends ^ vd_sign(s->u)), s->w, s->good);
}

/* Longer: exponentials and X at both ends, and the exponential at the foot where that is within. */
typedef struct gaussian_segment_long_state {
  skf_v3d w;
  skf_vd u0, u1, yh, k0, k1, e0, e1, eh, x0, x1;
  skf_vi seen, good;
} gaussian_segment_long_state;

SKF_INLINE skf_vi gaussian_within(skf_vd u0, skf_vd u1) { return ((skf_vi)u0 ^ (skf_vi)u1) < vi_set(0); }

SKF_INLINE void gaussian_segment_long_begin(const gaussian_span_row *c, skf_v3d x, gaussian_segment_long_state *s) {
  skf_v3d d0 = vd3_sub(c->s.from, x), d1 = vd3_sub(c->s.to, x);
  skf_vd u0 = vd3_dot(d0, c->up), u1 = vd3_dot(d1, c->up);
  skf_v3d w = vd3_less(d0, u0, c->down);
  skf_vd yh = c->binary * vd3_dot(w, w), y0 = vd_fma(u0, u0, yh), y1 = vd_fma(u1, u1, yh);
  skf_vd least = vd_select(gaussian_within(u0, u1), yh, vd_min(y0, y1));
  s->w = w, s->u0 = u0, s->u1 = u1, s->yh = yh;
  s->k0 = gaussian_whole(y0), s->k1 = gaussian_whole(y1);
  s->seen = gaussian_seen(least), s->good = gaussian_good(c, yh, y0, s->seen, least);
}

SKF_INLINE void gaussian_segment_long_exp(const gaussian_span_row *c, gaussian_segment_long_state *s) {
  (void)c;
  s->e0 = gaussian_mantissa(s->k0, s->u0, s->yh), s->e1 = gaussian_mantissa(s->k1, s->u1, s->yh);
  s->eh = gaussian_mantissa(gaussian_whole(s->yh), vd_set(0), s->yh);
}

SKF_INLINE void gaussian_segment_long_erfc(const gaussian_span_row *c, gaussian_segment_long_state *s) {
  (void)c;
  s->x0 = vd_erfc_binary(vd_abs(s->u0)), s->x1 = vd_erfc_binary(vd_abs(s->u1));
}

SKF_INLINE skf_vvalue gaussian_segment_long_end(const gaussian_span_row *c, const gaussian_segment_long_state *s) {
  skf_vd e0 = vd_exp2_raise(s->e0, s->k0), e1 = vd_exp2_raise(s->e1, s->k1);
  skf_vd eh = vd_exp2_raise(s->eh, gaussian_whole(s->yh)), x0 = e0 * s->x0, x1 = e1 * s->x1;
  skf_vd all = vd_fma(vd_set(SQRT_PI), eh, -(x0 + x1)), part = vd_abs(x0 - x1);
  skf_vi F = (skf_vi)vd_select(gaussian_within(s->u0, s->u1), all, part) & s->seen;
  return gaussian_result(c, (skf_vd)F, (skf_vd)((skf_vi)(e0 - e1) & s->seen), s->w, s->good);
}

/* inverse_squared.c's segment. With N = r0 r1 and delta the angle of view: F = delta / h, and -int g dt =
   (delta - sin delta) / h^3 + 2 c L / (N h^2) where c, cos^2 of the mean direction, has the factor h^2 beyond the ends:
   there and next to the axis, the other lanes' form is below. */
typedef struct squared_span_row {
  segment_row s;
  skf_v3d along; /* the direction times the strength */
#ifdef SKF_VEC_FLOAT
  skf_vd L, twice_L; /* the strength times the length; times twice the scale of the series, too */
#endif
} squared_span_row;

/* Of the series in floats below, whose quotient begins with 1 */
#define SQUARED_SPAN_SCALE 9.1902961298118567243

static double *squared_span_pack(const skf_prepared *e, double *k) {
  k = pack3(segment_pack(e, k), v3_scale(e->strength, e->plan.segment.a));
#ifdef SKF_VEC_FLOAT
  double L = e->strength * e->plan.segment.length;
  if (fabs(L) < 1e-30) L = 0; /* no lane is good then */
  k = pack1(pack1(k, L), 2 * SQUARED_SPAN_SCALE * L);
#endif
  return k;
}

SKF_INLINE skf_vvalue inverse_squared_segment_close(const squared_span_row *row, skf_v3d x) {
  const segment_row *c = &row->s;
  segment_view f = segment_see(c, x);
  skf_vd one = vd_set(1), L = c->L, NN = f.n0 * f.n1, N = vd_sqrt(NN), h2 = f.n2 * c->per_L2, h = vd_sqrt(h2);
  skf_vd t0 = -vd3_dot(f.d0, c->a), t1 = -vd3_dot(f.d1, c->a), sum = t0 + t1, cosine = h2 - t0 * t1;
  skf_vi front = cosine >= vd_set(0);
  skf_vd A = N + vd_abs(cosine), bottom = vd_select(front, h2, A), top = vd_select(front, A, sum * sum);
  skf_vd inv = one / (NN * bottom), per_NN = bottom * inv, per_h = one / h;
  skf_vd delta = vd_angle(h * L, vd3_dot(f.d0, f.d1)), gap = span_gap3(delta, h * L * N * per_NN);
  skf_vd g = vd_fma(gap * per_h, per_h * per_h, L * top * inv);
  return vv_scale(c->strength, (skf_vvalue){delta * per_h, segment_gradient(c, &f, -g, L * sum * per_NN),
                                            vd_sane(NN) & vd_sane(f.n2) & vd_sane(NN * bottom)});
}

/* With W = h^2 + t^2 at the ends: -int g dt = (F + [t / W]) / h^2, which cancels beyond the ends. */
#ifdef SKF_VEC_FLOAT
/* Without octants: N = r0 r1, X = N + d0 d1 = 2 N C^2 with C = cos(delta / 2), and F = 2 L / S acos(C) / sqrt(1 - C^2)
   where S = 2 N C is made as the root of X^2 + (h L)^2, which loses nothing where X does. */
typedef struct inverse_squared_segment_state {
  skf_v3d w;
  skf_vd t0, h2, S, per_N, F; /* S and what follows set on the way */
} inverse_squared_segment_state;

SKF_INLINE void inverse_squared_segment_begin(const squared_span_row *c, skf_v3d x, inverse_squared_segment_state *s) {
  skf_v3d d = vd3_sub(c->s.from, x);
  s->t0 = vd3_dot(d, c->s.a), s->w = vd3_less(d, s->t0, c->s.a), s->h2 = vd3_dot(s->w, s->w);
}

SKF_INLINE void inverse_squared_segment_turn(const squared_span_row *c, inverse_squared_segment_state *s) {
  skf_vd dot = vd_fma(s->t0, s->t0 + c->s.L, s->h2), hL2 = c->s.L2 * s->h2, N = vd_sqrt(vd_fma(dot, dot, hL2));
  s->S = vd_sqrt(vd_fma(N + dot, N + dot, hL2)), s->per_N = vd_set(1) / N;
}

/* acos(C) / sqrt(1 - C^2) in C2 = 2 C up to 2: 2e-8 */
SKF_INLINE void inverse_squared_segment_series(const squared_span_row *c, inverse_squared_segment_state *s) {
  skf_vd C2 = s->S * s->per_N, top = vd_fma(C2 + vd_set(14.419999185117903526), C2, vd_set(34.043872531520480307));
  skf_vd bottom = vd_fma(C2 + vd_set(27.991013904866936745), C2, vd_set(147.76861111838702219));
  s->F = c->twice_L * top / (s->S * vd_fma(bottom, C2, vd_set(199.18131368073289218)));
}

SKF_INLINE skf_vvalue inverse_squared_segment_end(const squared_span_row *c, const inverse_squared_segment_state *s) {
  skf_vd t1 = s->t0 + c->s.L, L_WW = c->L * s->per_N * s->per_N, ends1 = vd_fnma(s->t0, t1, s->h2) * L_WW;
  skf_vd both = s->F + ends1;
  skf_v3d g = vd3_mad(vd3_scale((s->t0 + t1) * L_WW, c->s.a), both / s->h2, s->w);
  skf_vd left = (skf_vd)((skf_vi)vd_fma(vd_set(0.25), ends1, both) ^ vd_sign(c->L)); /* the strength's sign is in all */
  return (skf_vvalue){s->F, g, (left > vd_set(0)) & (s->S > vd_set(1e-9)) & (s->S < vd_set(1e9))};
}
#else
typedef struct inverse_squared_segment_state {
  skf_v3d w;
  skf_vd t0, t1, h, h2, WW, inv; /* inv: 1 / (WW h^2), set in the middle, too */
  skf_vd offset, t;              /* set in the middle */
  skf_vi good;
} inverse_squared_segment_state;

SKF_INLINE void inverse_squared_segment_begin(const squared_span_row *c, skf_v3d x, inverse_squared_segment_state *s) {
  skf_v3d d = vd3_sub(c->s.from, x);
  skf_vd t0 = vd3_dot(d, c->s.a), t1 = t0 + c->s.L;
  skf_v3d w = vd3_less(d, t0, c->s.a);
  skf_vd h2 = vd3_dot(w, w), W0 = vd_fma(t0, t0, h2), WW = W0 * vd_fma(t1, t1, h2), bottom = WW * h2;
  s->w = w, s->t0 = t0, s->t1 = t1, s->h2 = h2, s->WW = WW;
  s->h = vd_sqrt(h2), s->inv = bottom;
  s->good = (bottom > vd_set(1e-140)) & (bottom < vd_set(1e140)) & (vd_set(1601) * h2 > W0);
}

SKF_INLINE void inverse_squared_segment_middle(const squared_span_row *c, inverse_squared_segment_state *s) {
  skf_vangle angle = vd_angle_parts(s->h * c->s.L, vd_fma(s->t0, s->t1, s->h2));
  s->offset = angle.offset, s->t = angle.top / angle.bottom, s->inv = vd_set(1) / s->inv;
}

SKF_INLINE void inverse_squared_segment_series(const squared_span_row *c, inverse_squared_segment_state *s) {
  (void)c;
  s->t = vd_angle_series(s->offset, s->t);
}

SKF_INLINE skf_vvalue inverse_squared_segment_end(const squared_span_row *c, const inverse_squared_segment_state *s) {
  skf_vd per_h2 = s->inv * s->WW, L_WW = c->s.L * (s->inv * s->h2), F = s->t * (s->h * per_h2);
  skf_vd ends1 = vd_fnma(s->t0, s->t1, s->h2) * L_WW, both = F + ends1;
  skf_v3d g = vd3_mad(vd3_scale((s->t0 + s->t1) * L_WW, c->along), c->s.strength * per_h2 * both, s->w);
  return (skf_vvalue){c->s.strength * F, g, s->good & (vd_fma(vd_set(0.03125), ends1, both) > vd_set(0))};
}
#endif

SKF_BATCH_FORM(gaussian_segment_short, gaussian_span, skf_again_none)
SKF_BATCH_SCALED(gaussian_segment, gaussian_span, gaussian_segment_careful, gaussian_segment_exp, gaussian_segment_erfc,
                 skf_stage_none)
SKF_BATCH_SCALED(gaussian_segment_long, gaussian_span, gaussian_segment_careful, gaussian_segment_long_exp,
                 gaussian_segment_long_erfc, skf_stage_none)
#ifdef SKF_VEC_FLOAT
SKF_BATCH_CROSSED(inverse_squared_segment, squared_span, inverse_squared_segment_close, inverse_squared_segment_turn,
                  inverse_squared_segment_series, skf_stage_none)
#else
SKF_BATCH_CROSSED(inverse_squared_segment, squared_span, inverse_squared_segment_close, inverse_squared_segment_middle,
                  inverse_squared_segment_series, skf_stage_none)
#endif

#endif
