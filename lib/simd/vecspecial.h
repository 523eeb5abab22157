/* SPDX-License-Identifier: MIT */
/* Special functions of several numbers at once, inline, for any type of number. Largest relative errors in halves of an
   ulp of 1, for doubles: erfc_scaled and its like 9, sin and cos 2 (of the larger one), Carlson's forms 10, Bessel
   functions 8. The coefficients interpolate at Chebyshev nodes; beside them stands the relative error that they leave.
 */
#ifndef SKF_SIMD_VECSPECIAL_H
#define SKF_SIMD_VECSPECIAL_H

#include "simd/vecmath.h"

/* As vd_estrin, for any number of coefficients: eights of them by Horner's rule. */
SKF_INLINE skf_vd vd_series(const double *c, int n, skf_vd x) {
  skf_vd x2 = x * x, x4 = x2 * x2, x8 = x4 * x4;
  int at = (n - 1) / 8 * 8;
  skf_vd s = vd_poly8(c + at, n - at, x, x2, x4);
#pragma GCC unroll 4
  for (at -= 8; at >= 0; at -= 8) s = vd_fma(s, x8, vd_poly8(c + at, 8, x, x2, x4));
  return s;
}

/* A polynomial in w, divided by w^2 + a three times or less, where a > 0 is such that no odd powers are left over, only
   b: `c` is what then remains, (a, b) follow from inside. There are such a if w's origin is to the right of all zeros
   [Hermite, Biehler]. Two degrees take one product and a sum beside it then, not two products [Eve 1964]; rounding
   errors are half as large again. */
SKF_INLINE skf_vd vd_reduced(const double *c, int n, const double (*step)[2], int steps, skf_vd w) {
  skf_vd ww = w * w, s = vd_halves(c, n, w);
#pragma GCC unroll 4
  for (int i = 0; i < steps; i++) s = vd_fma(s, ww + vd_set(step[i][0]), vd_set(step[i][1]));
  return s;
}

/* X(u) = exp(u^2) int exp(-v^2) dv over v = u..infinity, sqrt(pi) / 2 exp(u^2) erfc(u), for u >= 0 between 1 / (u + 1)
   and 1 / 2u. Quotients of polynomials in t, u = t sqrt(log 2), so that exp(u^2) = 2^(t^2); for u up to 27, where
   exp(-u^2) ends, in floats up to 10. */
#define VD_ERFC_UNIT 1.2011224087864497949 /* sqrt(1 / log 2) */

/* X of t >= 0; beyond those bounds it leaves less than 3e-12 and 2e-5. */
SKF_INLINE skf_vd vd_erfc_binary(skf_vd t) {
#ifdef SKF_VEC_FLOAT /* 8e-9 */
  static const double top[] = {0.8862269280, 0.9077374369, 0.4439987172, 0.115019307, 0.01355923168};
  static const double bottom[] = {1, 1.963709573, 1.652629447, 0.7553240692, 0.1915336198, 0.02257729058};
  return vd_halves(top, 5, t) / vd_halves(bottom, 6, t);
#else /* 5e-17 */
  static const double top[] = {0.0012587455600652096, 0.00054166101528883449, 0.0001112210105504565,
                               1.0608301621251613e-5};
  static const double bottom[] = {0.0042984909646491758, 0.0026093841878987445, 0.00083593862127933635,
                                  0.00016090715668596183, 1.7663980862706419e-5};
  static const double top_steps[][2] = {{3.0829178961103123, -0.0062045899650285299},
                                        {11.974831617734697, 0.037073529531345401},
                                        {6.3093798125177265, 0.020217045865552159}};
  static const double bottom_steps[][2] = {{0.7506208643998983, -0.01208034323503312},
                                           {7.5447699961557442, 0.057810864896629452},
                                           {3.1127544012510614, 0.040596982471805596}};
  const skf_vd w = t + vd_set(1.375);
  return vd_reduced(top, 4, top_steps, 3, w) / vd_reduced(bottom, 5, bottom_steps, 3, w);
#endif
}
SKF_INLINE skf_vd vd_erfc_scaled(skf_vd u) { return vd_erfc_binary(vd_set(VD_ERFC_UNIT) * u); }

/* X for u >= -2, of t + VD_ERFC_NEAR, and for u >= 1 / 2, of t + VD_ERFC_FAR. The relative error grows with u^2, as
   that of the exponential beside it does: it leaves this times 1 + u^2 / 4. */
#define VD_ERFC_NEAR SKF_COUNT(2.4959948175728995897, 2.4022448175728995897)
SKF_INLINE skf_vd vd_erfc_near(skf_vd w) {
#ifdef SKF_VEC_FLOAT /* 2e-8 */
  static const double top[] = {96.5463644693, 25.7848670226,  21.8883691193,  7.35073564289,
                               2.41780987232, 0.532689633317, 0.0746556933118};
  static const double bottom[] = {
      1, 3.60591731538, 6.01352875098, 6.09251773632, 4.12169961071, 1.93129342727, 0.590708555305, 0.124265635283};
  return vd_halves(top, 7, w) / vd_halves(bottom, 8, w);
#else /* 5e-17 */
  static const double top[] = {
      88.421406179094199,    80.745435786777642,     59.857585828439391,   33.630375018198706,  15.826137296500819,
      6.2609791187246742,    2.0917022592360776,     0.58501200694346356,  0.13482595075419585, 0.024933387617504958,
      0.0035355380566824747, 0.00035150418599132723, 1.9579625170183848e-5};
  static const double bottom[] = {
      0.37392314149073907, 1.1394395337673445,   1.1820048088503495,    0.73769788510362254,   0.32112431186121344,
      0.10288517440489321, 0.024552869818711687, 0.0042717177329965651, 0.0005039179046310915, 3.260221443418661e-5};
  static const double steps[][2] = {{4.940920177197126, 1.0377998091625637},
                                    {0.51787381933841263, -0.82852457678592654}};
  return vd_halves(top, 13, w) / vd_reduced(bottom, 10, steps, 2, w);
#endif
}

#define VD_ERFC_FAR SKF_COUNT(1.2994387956067751026, -0.60056120439322489743)
SKF_INLINE skf_vd vd_erfc_far(skf_vd w) {
#ifdef SKF_VEC_FLOAT /* 2e-8 */
  static const double top[] = {0.545641348104, 0.455339613231, 0.156898592312, 0.0216492926873};
  static const double bottom[] = {1, 1.5277749284, 0.942175190873, 0.282827375525, 0.0360506206594};
  return vd_halves(top, 4, w) / vd_halves(bottom, 5, w);
#else /* 3e-17 */
  static const double top[] = {0.00036040585964950859, 0.00011915233214835219, 1.4962823841202945e-5};
  static const double bottom[] = {-0.0016257583563632027, 0.00020834844860518263, 0.0001660264727032665,
                                  2.4914735969361903e-5};
  static const double top_steps[][2] = {{3.172940419635233, -0.002427750080718389},
                                        {13.50211321500149, 0.019263374902184749},
                                        {6.6892776990836463, 0.0090627108001135382}};
  static const double bottom_steps[][2] = {{25.272109443359291, 0.046953978823024088},
                                           {0.80928790675006799, -0.0078998606113384679},
                                           {3.3808533703487092, 0.014749341162577377}};
  return vd_reduced(top, 3, top_steps, 3, w) / vd_reduced(bottom, 4, bottom_steps, 3, w);
#endif
}

/* exp(x) - 1 */
SKF_INLINE skf_vd vd_exp_less_1(skf_vexp e) { return vd_fma(e.scale, e.part, e.scale - vd_set(1)); }

typedef struct skf_vsincos {
  skf_vd sin, cos;
} skf_vsincos;

/* |x| up to a few turns. */
SKF_INLINE skf_vsincos vd_sincos(skf_vd x) {
  /* (sin(r) / r - 1) / r^2 and (cos(r) - 1 + r^2 / 2) / r^4 in r^2, |r| <= pi / 4 */
#ifdef SKF_VEC_FLOAT /* 8e-8, 2e-8 */
  static const double s[] = {-0.16666664601601209487, 0.0083327365297542595212, -0.00019585366912907002113};
  static const double c[] = {0.041666664598674786118, -0.0013888291271073755622, 2.4545412771168977185e-5};
  const skf_vd shift = vd_set(0x1.8p23);
#else /* 8e-17, 1e-17 */
  static const double s[] = {-0.16666666666666664498,  0.0083333333333308266943,  -0.00019841269836575245027,
                             2.7557316007933251255e-6, -2.5051112223400198837e-8, 1.5916722686286470476e-10};
  static const double c[] = {0.04166666666666666531,    -0.0013888888888887321048, 2.4801587298651001295e-5,
                             -2.7557317212537512799e-7, 2.0876133993327845762e-9,  -1.1381752459316456189e-11};
  const skf_vd shift = vd_set(0x1.8p52);
#endif
  skf_vd biased = vd_fma(x, vd_set(0.63661977236758134308), shift), k = biased - shift;
  skf_vd r = vd_fnma(k, vd_set(SKF_PICK(0x1.921fb54442d18p+0, 0x1.921fb6p+0)), x);
  r = vd_fnma(k, vd_set(SKF_PICK(0x1.1a62633145c07p-54, -0x1.777a5cp-25)), r);
  skf_vi whole = (skf_vi)biased, odd = -(whole & vi_set(1)) != vi_set(0);
  const int top = 8 * (int)sizeof(skf_real) - 1;
  skf_vd rr = r * r, sine = vd_fma(r * rr, vd_estrin(s, sizeof s / sizeof *s, rr), r);
  skf_vd cosine = vd_fma(rr * rr, vd_estrin(c, sizeof c / sizeof *c, rr), vd_fnma(vd_set(0.5), rr, vd_set(1)));
  skf_vi flip_sin = ((whole >> 1) & vi_set(1)) << top, flip_cos = (((whole + vi_set(1)) >> 1) & vi_set(1)) << top;
  return (skf_vsincos){(skf_vd)((skf_vi)vd_select(odd, cosine, sine) ^ flip_sin),
                       (skf_vd)((skf_vi)vd_select(odd, sine, cosine) ^ flip_cos)};
}

/* Carlson's R_F(x^2, y^2, z^2) and R_D(x^2, y^2, z^2) for x >= 0 (or a rounding error of 0), y, z > 0 [Carlson 1995;
   DLMF 19.36], by `count` duplications: each brings the arguments nearer to their mean, by a factor of four in the end.
   `good` where they are within 1/64 of it, so that the series up to the seventh order leaves 3e-17; four do this unless
   x and another are much smaller than the third. In floats, within 2/11, which leaves 5e-8 and takes two less. */
typedef struct skf_vcarlson {
  skf_vd rf, rd;
  skf_vi good;
} skf_vcarlson;

/* The same in steps: `scale` is 4^-n after n duplications. */
typedef struct skf_vduplication {
  skf_vd x, y, z, sx, sy, sz, S; /* arguments, their roots, the sum for R_D */
} skf_vduplication;

SKF_INLINE skf_vduplication vd_carlson_begin(skf_vd sx, skf_vd sy, skf_vd sz) {
  return (skf_vduplication){sx * sx, sy * sy, sz * sz, sx, sy, sz, vd_set(0)};
}
/* A duplication, its roots not taken yet */
SKF_INLINE void vd_carlson_twice(skf_vduplication *d, double scale) {
  skf_vd quarter = vd_set(0.25), l = vd_fma(d->sx, d->sy + d->sz, d->sy * d->sz);
  d->S += vd_set(4 * scale) / (d->sz * (d->z + l));
  d->x = quarter * (d->x + l), d->y = quarter * (d->y + l), d->z = quarter * (d->z + l);
}
SKF_INLINE void vd_carlson_roots(skf_vduplication *d) {
  d->sx = vd_sqrt(d->x), d->sy = vd_sqrt(d->y), d->sz = vd_sqrt(d->z);
}
SKF_INLINE skf_vcarlson vd_carlson_end(const skf_vduplication *run, double scale) {
  skf_vd x = run->x, y = run->y, z = run->z;
  skf_vd one = vd_set(1), A = (x + y + z) * vd_set(1. / 3), C = vd_fma(vd_set(3), z, x + y) * vd_set(0.2);
  skf_vd per = one / (A * C), per_A = per * C, per_C = per * A;
  skf_vd X = (A - x) * per_A, Y = (A - y) * per_A, Z = -(X + Y), E2 = vd_fnma(Z, Z, X * Y), E3 = X * Y * Z;
  skf_vd s = vd_fma(E2, vd_fma(E2, vd_fma(E2, vd_set(-5. / 208), vd_set(1. / 24)), vd_set(-0.1)), one);
  skf_vd s3 = vd_fma(E2, vd_fma(E2, vd_set(1. / 16), vd_set(-3. / 44)), vd_set(1. / 14));
  s = vd_fma(E3, vd_fma(E3, vd_set(3. / 104), s3), s);
  skf_vd P = (C - x) * per_C, Q = (C - y) * per_C, T = (P + Q) * vd_set(-1. / 3), PQ = P * Q, TT = T * T;
  skf_vd D2 = vd_fnma(vd_set(6), TT, PQ), D3 = vd_fnma(vd_set(8), TT, vd_set(3) * PQ) * T;
  skf_vd D4 = vd_set(3) * (PQ - TT) * TT, D5 = PQ * TT * T;
  skf_vd d = vd_fma(D2, vd_fma(D2, vd_fma(D2, vd_set(-1. / 16), vd_set(9. / 88)), vd_set(-3. / 14)), one);
  skf_vd d3 = vd_fma(D2, vd_fma(D2, vd_set(45. / 272), vd_set(-9. / 52)), vd_set(1. / 6));
  d = vd_fma(D3, vd_fma(D3, vd_set(3. / 40), vd_fma(D4, vd_set(-9. / 68), d3)), d);
  d = vd_fma(D4, vd_fma(D2, vd_set(3. / 20), vd_set(-3. / 22)),
             vd_fma(D5, vd_fma(D2, vd_set(-9. / 68), vd_set(3. / 26)), d));
  skf_vd far = vd_max(vd_max(vd_abs(Z), vd_abs(X)), vd_max(vd_max(vd_abs(P), vd_abs(Q)), vd_abs(Y)));
  skf_vd rd = vd_fma(vd_set(scale) * (per_C * per_C) * vd_sqrt(C), d, vd_set(3) * run->S);
  return (skf_vcarlson){s * (per_A * vd_sqrt(A)), rd, far < vd_set(SKF_PICK(1. / 64, 1. / 5.5))};
}

SKF_INLINE skf_vcarlson vd_carlson(skf_vd sx, skf_vd sy, skf_vd sz, int count) {
  skf_vduplication d = vd_carlson_begin(sx, sy, sz);
  double scale = 1;
  for (int n = 0; n < count; n++) {
    if (n > 0) vd_carlson_roots(&d);
    vd_carlson_twice(&d, scale *= 0.25);
  }
  return vd_carlson_end(&d, scale);
}

/* I0(b) and I1(b) / (b / 2) for 0 <= b <= VD_BESSEL_NEAR. */
#define VD_BESSEL_NEAR 10
typedef struct skf_vbessel {
  skf_vd i0, other;
} skf_vbessel;

SKF_INLINE skf_vbessel vd_bessel_near(skf_vd b) {
  const skf_vd q = vd_set(0.25) * b * b;
#ifdef SKF_VEC_FLOAT
  /* in b^2 / 4: 2e-8, 4e-9 */
  static const double c[] = {1.0000000159881708,     0.99999963566866541,   0.2500011772692339,
                             0.027776464129873493,   0.0017367930601650989, 6.9253658560990542e-5,
                             1.9601599250099063e-6,  3.628424272562027e-8,  8.0083437687683105e-10,
                             1.0592363930664062e-12, 1.936106467578125e-13};
  static const double d[] = {1.0000000040287174,     0.49999992812282429,   0.083333525152652743,
                             0.006944260495821014,   3.4730678189257655e-4, 1.1552642242016923e-5,
                             2.787995618406646e-7,   4.6223110928821564e-9, 8.5356878705024719e-11,
                             1.8785719836425781e-13, 1.6829242912597656e-14};
  return (skf_vbessel){vd_halves(c, 11, q), vd_halves(d, 11, q)};
#else
  /* 2e-17, 9e-19 */
  static const double c[] = {0.99999999999999998081,    1.0000000000000004973,     0.24999999999999785941,
                             0.027777777777781427675,   0.0017361111111078307042,  6.9444444446237301263e-5,
                             1.9290123450308155605e-6,  3.9367599055015514625e-8,  6.1511870280070313085e-10,
                             7.5940624699311153505e-12, 7.5940173320050709051e-14, 6.2763975981474445641e-16,
                             4.3565485133502533167e-18, 2.5869716184443619175e-20, 1.2899240266389696359e-22,
                             6.4382769741174410302e-25, 1.3887463825307687175e-27, 1.5726311766046009607e-29};
  static const double d[] = {0.99999999999999999902,    0.50000000000000002539,    0.083333333333333224034,
                             0.0069444444444446308168,  3.4722222222205470629e-4,  1.1574074074165635241e-5,
                             2.7557319220675180337e-7,  4.9209498697835891672e-9,  6.8346524326631262045e-11,
                             7.5940604936380707165e-13, 6.9036684724680273639e-15, 5.2302295103087564063e-17,
                             3.3516655119285560315e-19, 1.8462095224407275097e-21, 8.6393767146402798049e-24,
                             3.9578734525239105654e-26, 8.8311861285943530035e-29, 8.4335141056229349522e-31};
  return (skf_vbessel){vd_series(c, 18, q), vd_series(d, 18, q)};
#endif
}

/* exp(-b) I0(b) and exp(-b) (I0(b) - I1(b)), the difference not by subtraction, for b from VD_BESSEL_NEAR on. */
SKF_INLINE skf_vbessel vd_bessel_far(skf_vd b) {
  const skf_vd per = vd_set(1) / b, t = vd_fma(vd_set(2 * VD_BESSEL_NEAR), per, vd_set(-1)), root = vd_sqrt(per);
#ifdef SKF_VEC_FLOAT
  /* times sqrt(b) and b sqrt(b), in 20 / b - 1: 1e-8, 2e-8 */
  static const double c[] = {0.40150976183911651, 0.0026458619146093112, 8.3100264684791555e-5, 5.2460996238629077e-6,
                             5.3123254322005756e-7};
  static const double d[] = {0.20340077093462666,   0.0041350644741774319, 2.2315940024941473e-4,
                             1.9992009003674936e-5, 2.8248813649083145e-6, 5.6323085795528501e-7};
  return (skf_vbessel){root * vd_horner(c, 5, t), root * per * vd_horner(d, 6, t)};
#else
  /* 3e-17 */
  static const double c[] = {
      0.40150976083120649723,     0.0026458859671862075169,   8.3113272639278530135e-5,   5.1520339511047127979e-6,
      5.0412567934740241073e-7,   7.0784005161455597882e-8,   1.3636125731770243313e-8,   3.5594563157926025284e-9,
      1.2741444053790702729e-9,   6.3362613984688192976e-10,  3.941095458022842913e-10,   1.5145324594818796637e-10,
      -1.5448552468921096008e-10, -2.4233493280656519151e-10, -3.5589688433600278112e-11, 1.0170469305586485726e-10,
      3.1554216687868040329e-11,  -2.4183349727737923125e-11, -6.3262039191494151332e-12, 2.7603485241861068732e-12};
  static const double d[] = {
      0.20340076638278945698,    0.0041350554960536061285,   2.2323928344718660919e-4,   2.0048621831933149579e-5,
      2.6224858625210599609e-6,  4.7112313730867088769e-7,   1.1354561982960751118e-7,   3.6940250775410344168e-8,
      1.6580516501520825806e-8,  9.705464464967375359e-9,    5.5737108070312922547e-9,   6.5357205968288388035e-10,
      -4.4170676910854159057e-9, -5.2184724261041089721e-9,  -1.7711507927577685188e-10, 3.8374379511745610365e-9,
      1.4263541068834600491e-9,  -1.8901714421860579162e-9,  -9.4052718915628956306e-10, 6.9374142837851621328e-10,
      3.1566796507807534198e-10, -1.7174245386124777928e-10, -4.6385956197823891506e-11, 2.1052918217253403846e-11};
  return (skf_vbessel){root * vd_series(c, 20, t), root * per * vd_series(d, 24, t)};
#endif
}

#endif
