/* SPDX-License-Identifier: MIT */
/* Vector forms: 1 / r^2 over a triangle in closed form. With phi = atan(l / d) at the end of an edge, c^2 = d^2 + z^2,
   w = ((c - d) / z)^2 and any length `base`,
     int d log((l^2 + c^2) / base^2) / 2 (l^2 + d^2) dl = phi log((c + d) / base)
                                                        - Im [Li2(-w exp(2 i phi)) - Li2(-exp(2 i phi))] / 2,
   and the logarithms of 1 + w exp(2 i phi) have simple parts. That is exact to some ulps of 1: where the sum over the
   edges is much less, the panels of batch_area_smooth.h decide. */
#ifndef SKF_FIELD_BATCH_AREA_SQUARED_H
#define SKF_FIELD_BATCH_AREA_SQUARED_H

#include "field/batch_area.h"

/* The imaginary parts of Li2(1 - exp(-u)), u = x + i y, |u| < 1.06: u - u^2 / 4 + sum B_2k u^(2k+1) / (2k+1)!, the sums
   by Clenshaw's rule for real coefficients, four side by side; into y. */
SKF_INLINE void squared_dilogs(const skf_vd x[4], skf_vd y[4]) {
  static const double b[] = {0.027777777777777777778,   -0.00027777777777777777778, 4.7241118669690098262e-6,
                             -9.1857730746619635509e-8, 1.8978869988970999072e-9,   -4.0647616451442255268e-11,
                             8.9216910204564525552e-13, -1.9939295860721075687e-14, 4.5189800296199181917e-16};
  enum { N = SKF_COUNT(9, 4) };
  skf_vd p[4], q[4], twice[4], s[4], high[4], low[4];
  SKF_EACH(u, 4) q[u] = x[u] * y[u], p[u] = vd_fms(x[u], x[u], y[u] * y[u]);
  SKF_EACH(u, 4) q[u] += q[u], twice[u] = p[u] + p[u];
  SKF_EACH(u, 4) s[u] = vd_fma(p[u], p[u], q[u] * q[u]);
  SKF_EACH(u, 4) high[u] = vd_set(b[N - 1]), low[u] = vd_fma(twice[u], high[u], vd_set(b[N - 2]));
#pragma GCC unroll 8
  for (int k = N - 3; k >= 0; k--) {
    skf_vd next[4];
    SKF_EACH(u, 4) next[u] = vd_fnma(s[u], high[u], vd_set(b[k]));
    SKF_EACH(u, 4) next[u] = vd_fma(twice[u], low[u], next[u]), high[u] = low[u], low[u] = next[u];
  }
  /* sum b_k v^k = low v - high |v|^2, v = u^2 = p + i q */
  SKF_EACH(u, 4) high[u] = vd_fms(low[u], p[u], high[u] * s[u]), low[u] *= q[u];
  SKF_EACH(u, 4)
  y[u] = vd_fma(y[u], high[u], vd_fma(x[u], low[u], vd_fnma(vd_set(0.25), q[u], y[u])));
}

/* What an edge's ends add: the integral from the foot, and phi less the angle seen from c, both with the sign of l;
   `size` of the terms. */
typedef struct squared_ends {
  skf_vd F[2], size[2], gap[2];
} squared_ends;

/* d > 0; c, g = c + d; base: log(g / base); w: -log of w; zz_g = z^2 / g */
SKF_INLINE squared_ends squared_from(const skf_vd l[2], skf_vd d, skf_vd c, skf_vd g, skf_vd zz_g, skf_vd base,
                                     skf_vd w) {
  const skf_vd zero = vd_set(0), half = vd_set(0.5), log2 = vd_set(0.69314718055994531),
               pi = vd_set(3.1415926535897932);
  const skf_vd dd = d * d, cc = c * c, gg = g * g, dc = d * c;
  skf_vd ll[2], phi[2], one[2], other[2], rest[2], x[4], y[4];
  skf_vi direct[2], plain[2];
  squared_ends e;
  SKF_EACH(u, 2) {
    skf_vd al = vd_abs(l[u]), four;
    ll[u] = l[u] * l[u], four = vd_set(4) * (cc + ll[u]);
    phi[u] = vd_angle(al, d), e.gap[u] = vd_angle(al * zz_g, dc + ll[u]);
    skf_vd flat = vd_log_ratio(dd + ll[u], dd, ll[u]), high = vd_log_ratio(four, gg, four - gg);
    one[u] = half * (high - flat), other[u] = vd_fnma(half, flat, log2), rest[u] = vd_fnma(vd_set(2), phi[u], pi);
    direct[u] = one[u] >= -w, plain[u] = other[u] >= zero;
    x[u] = vd_select(direct[u], -one[u], w), y[u] = vd_select(direct[u], -e.gap[u], rest[u]);
    x[2 + u] = vd_select(plain[u], -other[u], zero), y[2 + u] = vd_select(plain[u], -phi[u], rest[u]);
  }
  squared_dilogs(x, y);
  SKF_EACH(u, 2) {
    skf_vd first = vd_select(direct[u], y[u], vd_fma(w, e.gap[u], vd_fms(rest[u], one[u], y[u])));
    skf_vd second = vd_select(plain[u], y[2 + u], vd_fms(rest[u], other[u], y[2 + u])), flux = phi[u] * base;
    e.size[u] = vd_abs(flux) + half * (vd_abs(first) + vd_abs(second));
    e.F[u] = (skf_vd)((skf_vi)vd_fma(half, second - first, flux) ^ vd_sign(l[u]));
    e.gap[u] = (skf_vd)((skf_vi)e.gap[u] ^ vd_sign(l[u]));
  }
  return e;
}

/* Over the triangle, where the height is known better than the edges' lines, so that only these may not be next to the
   foot, and higher than beside it base = |z|; else the distance, any constant being allowed, and the
   gradient's part across without the angles about the foot, that add up to 0. */
SKF_INLINE skf_vvalue squared_closed(const area_row *c, const area_view *f) {
  const skf_vd zero = vd_set(0), one = vd_set(1), least = vd_set(SKF_PICK(1e-60, 1e-12));
  area_sum sum = {zero, zero, {zero, zero, zero}, zero, zero};
  const skf_vi above = f->inside | (f->zz >= f->lat2);
  const skf_vd base2 = vd_select(above, f->zz, f->dist2), diam2 = c->diam * c->diam;
  const skf_vd per_z = (skf_vd)((skf_vi)(one / vd_select(f->z == zero, one, f->z)) & (f->z != zero));
  skf_vi good = (vd_set(SKF_PICK(0x1p60, 0x1p32)) * f->dist2 > diam2) & vd_sane(f->dist2) & vd_sane(diam2);
  for (int i = 0; i < 3; i++) {
    skf_vd d = vd_max(vd_abs(f->d[i]), vd_set(SKF_PICK(1e-30, 1e-9)) * c->diam), cc = vd_fma(d, d, f->zz);
    skf_vd h = vd_sqrt(cc), g = h + d, gg = g * g, zz = vd_max(f->zz, least * gg);
    skf_vd w = vd_log_ratio(gg, zz, gg - zz), large = vd_max(gg, base2), small = vd_min(gg, base2);
    skf_vd base = vd_set(0.5) * vd_log_ratio(large, small, large - small), zz_g = f->zz / g;
    base = vd_select(gg < base2, -base, base);
    const skf_vd l[2] = {f->l1[i], f->l2[i]};
    const squared_ends e = squared_from(l, d, h, g, zz_g, base, w);
    skf_vd view = vd_atan2(h * c->T.L[i], vd_fma(f->l1[i], f->l2[i], cc)), J = view / h;
    skf_vd apart = e.gap[1] - e.gap[0], across = vd_fma(zz_g, J, apart);
    skf_vd Z = per_z * vd_select(above, -(d * J), across);
    sum.J[i] = J;
    sum.F += (skf_vd)((skf_vi)(e.F[1] - e.F[0]) ^ vd_sign(f->d[i])), sum.abs_F += e.size[0] + e.size[1];
    sum.Z += (skf_vd)((skf_vi)Z ^ vd_sign(f->d[i]));
    sum.abs_Z += vd_abs(Z) + (skf_vd)((skf_vi)(vd_abs(per_z) * (vd_abs(e.gap[0]) + vd_abs(e.gap[1]))) & ~above);
    good &= vd_set(SKF_PICK(0x1p16, 0x1p32)) * cc > diam2;
  }
  return area_gather(c, f, &sum, good);
}

#endif
