/* SPDX-License-Identifier: MIT */
/* Vector forms: Gaussians over a triangle not much larger than their width, by slices parallel to its longest edge. A
   slice is a difference of error functions, their squares the exponents along the other edges: F is a sum of positive
   terms from anywhere, by one Gauss-Legendre rule, its nodes those of all edges' integrals J_i, too. With the nodes at
   m +- t from the foot, exp(-(m +- t)^2) = exp(-m^2) exp(-t^2) exp(-+2 m t): the second factor is the triangle's, and
   the third of both nodes takes one series. */
#ifndef SKF_FIELD_BATCH_AREA_SLICES_H
#define SKF_FIELD_BATCH_AREA_SLICES_H

#include "field/batch_area.h"
#include "field/batch_segment_smooth.h"

/* Of a rule with 2 PAIRS nodes at most */
enum { SLICES_PAIRS = SKF_COUNT(10, 6) };

/* The longest edge first, from then on in units of the width: half the lengths of the edges and of the height over the
   longest; halves of the others' shares in its direction, upwards; nodes > 0, their weights times exp(-t^2) on each of
   these lines; the number of pairs, 0 for wider triangles; how far from the lines' middles the rule is exact. */
typedef struct gaussian_area_row {
  area_row area;
  skf_vd half[4], right, left, node[SLICES_PAIRS], weight[4][SLICES_PAIRS], pairs, reach;
} gaussian_area_row;

/* Measured against erf: nodes, the largest half length, and the middle's distance from the foot up to which the rule
   leaves less than 1e-16, in floats 1e-9. */
static const struct {
  int nodes;
  double half, reach;
} slices_rules[] = {
#ifdef SKF_VEC_FLOAT
    {8, 0.6, 4.5},
    {10, 1, 5.5},
    {12, 1.75, 5.5},
#else
    {12, 0.6, 5.5}, {14, 1, 5}, {16, 1.5, 5}, {18, 2, 5}, {20, 2.25, 6},
#endif
};

/* The longest edge first */
static skf_prepared slices_turned(const skf_prepared *e) {
  const skf_triangle_plan *T = &e->plan.triangle;
  skf_prepared turned = *e;
  skf_triangle_plan *to = &turned.plan.triangle;
  for (int i = 0; i < 3; i++) {
    const int k = (T->longest + i) % 3;
    to->v[i] = T->v[k], to->t[i] = T->t[k], to->m[i] = T->m[k];
    to->L[i] = T->L[k], to->c[i] = T->c[k], to->s[i] = T->s[k];
  }
  to->longest = 0;
  return turned;
}

static double *gaussian_area_pack(const skf_prepared *e, double *k) {
  enum { RULES = sizeof slices_rules / sizeof *slices_rules };
  const skf_prepared turned = slices_turned(e);
  const skf_triangle_plan *T = &turned.plan.triangle;
  const double up = 0.5 * e->kernel.param;
  const double half[4] = {up * T->L[0], up * T->L[1], up * T->L[2], up * T->twice / T->L[0]};
  int rule = 0;
  while (rule < RULES && !(half[0] <= slices_rules[rule].half)) rule++;
  const int pairs = rule < RULES ? slices_rules[rule].nodes / 2 : 0;
  const skf_gauss_node *node = pairs ? skf_gauss_rule(2 * pairs) + pairs : NULL;
  k = area_pack(&turned, k);
  for (int i = 0; i < 4; i++) k = pack1(k, half[i]);
  k = pack1(pack1(k, half[1] * T->c[1]), -(half[2] * T->c[2]));
  for (int j = 0; j < SLICES_PAIRS; j++) k = pack1(k, j < pairs ? node[j].x : 0);
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < SLICES_PAIRS; j++)
      k = pack1(k, j < pairs ? node[j].w * exp(-(half[i] * node[j].x) * (half[i] * node[j].x)) : 0);
  return pack1(pack1(k, pairs), pairs ? slices_rules[rule].reach : -1);
}

/* exp(x), exp(-x) for |x| <= VD_EXP_MAX */
typedef struct slices_pair {
  skf_vd more, less;
} slices_pair;

SKF_INLINE slices_pair slices_exp(skf_vd x) {
  /* (cosh(r) - 1) / r^2 and (sinh(r) / r - 1) / r^2 in r^2, |r| <= log(2) / 2 */
#ifdef SKF_VEC_FLOAT /* 2e-10, 5e-8 */
  static const double c[] = {0.50000000134578042103, 0.041666465005270031865, 0.0013933641117472883976};
  static const double s[] = {0.16666630825049945652, 0.0083572002035029246};
  const skf_vd shift = vd_set(0x1.8p23);
#else /* 2e-17, 1e-18 */
  static const double c[] = {0.50000000000000010211, 0.041666666666624161578, 0.001388888891719688114,
                             0.000024801521322116824174, 2.7620075999810651055e-7};
  static const double s[] = {0.16666666666666667452, 0.0083333333333300644245, 0.000198412698630406699,
                             2.755726848011633485e-6, 2.5100375924709716851e-8};
  const skf_vd shift = vd_set(0x1.8p52);
#endif
  skf_vd biased = vd_fma(x, vd_set(1.4426950408889634), shift), k = biased - shift;
  skf_vd r = vd_fnma(k, vd_set(SKF_PICK(0x1.62e42fefa39efp-1, 0x1.62e43p-1)), x);
  r = vd_fnma(k, vd_set(SKF_PICK(0x1.abc9e3b39803fp-56, -0x1.05c61p-29)), r);
  skf_vi whole = (skf_vi)biased << SKF_MANTISSA;
  skf_vd rr = r * r, cosh = vd_fma(rr, vd_horner(c, sizeof c / sizeof *c, rr), vd_set(1));
  skf_vd sinh = vd_fma(r * rr, vd_horner(s, sizeof s / sizeof *s, rr), r);
  return (slices_pair){(skf_vd)((skf_vi)(cosh + sinh) + whole), (skf_vd)((skf_vi)(cosh - sinh) - whole)};
}

/* The lines: the edges, the height through the foot. For each its middle and exp(-its squared distance from the point);
   the other edges' middles along the longest. */
typedef struct slices_view {
  skf_vd slope[4], even[4]; /* 2 m t over the node, exp(-m^2 - ...) */
  skf_vd right, left;
  skf_vi good;
} slices_view;

SKF_INLINE slices_view slices_see(const gaussian_area_row *c, const area_view *f) {
  const skf_vd a = c->area.param, half = vd_set(0.5), most = vd_set(VD_EXP_MAX), zz = c->area.param2 * f->zz;
  slices_view v = {.good = vi_set(-1)};
  for (int i = 0; i < 4; i++) {
    skf_vd d = i < 3 ? a * f->d[i] : vd_set(0);
    skf_vd m = i < 3 ? half * a * (f->l1[i] + f->l2[i]) : vd_fms(a, f->d[0], c->half[3]);
    skf_vd y = vd_fma(m, m, vd_fma(d, d, zz));
    v.slope[i] = vd_set(i == 1 ? 2 : -2) * m * c->half[i], v.even[i] = vd_exp(-vd_min(y, most));
    v.good &= (vd_abs(m) <= c->reach) & (y < vd_set(GAUSSIAN_SEEN));
  }
  v.right = vd_fma(a, f->l2[0], c->right), v.left = vd_fma(a, f->l1[0], c->left);
  return v;
}

/* e int exp(x^2 - v^2) dv from |x| on, with the sign of x */
SKF_INLINE skf_vd slices_rest(skf_vd e, skf_vd x) {
  return (skf_vd)((skf_vi)(e * vd_erfc_scaled(vd_abs(x))) ^ vd_sign(x));
}

SKF_INLINE skf_vvalue gaussian_slices(const gaussian_area_row *c, const area_view *f) {
  const skf_vd zero = vd_set(0);
  slices_view v = slices_see(c, f);
  skf_vd J[3] = {zero, zero, zero}, right = zero, left = zero, whole = zero;
  for (int j = 0; j < SLICES_PAIRS && vi_any(vd_set(j) < c->pairs); j++) {
    const skf_vd n = c->node[j];
    skf_vd up[4], down[4];
    for (int i = 0; i < 4; i++) {
      slices_pair p = slices_exp(v.slope[i] * n);
      up[i] = c->weight[i][j] * p.less, down[i] = c->weight[i][j] * p.more;
      if (i < 3) J[i] += up[i] + down[i];
    }
    skf_vd xr = vd_fma(c->right, n, v.right), xl = vd_fma(c->left, n, v.left);
    right += slices_rest(up[1], xr), left += slices_rest(up[2], xl);
    whole += (skf_vd)((skf_vi)up[3] & (((skf_vi)xr ^ (skf_vi)xl) < vi_set(0)));
    xr = vd_fnma(c->right, n, v.right), xl = vd_fnma(c->left, n, v.left);
    right += slices_rest(down[1], xr), left += slices_rest(down[2], xl);
    whole += (skf_vd)((skf_vi)down[3] & (((skf_vi)xr ^ (skf_vi)xl) < vi_set(0)));
  }
  skf_vd F = vd_fms(v.even[2], left, v.even[1] * right);
  F = vd_fma(vd_set(1.7724538509055160273) * v.even[3], whole, F) * (c->half[3] * c->area.per_param2);
  area_sum sum = {.F = F, .abs_F = F, .Z = vd_set(-2) * c->area.param2 * f->z * F};
  sum.abs_Z = vd_abs(sum.Z);
  for (int i = 0; i < 3; i++) sum.J[i] = c->area.per_param * c->half[i] * (v.even[i] * J[i]);
  return area_gather(&c->area, f, &sum, v.good);
}

#endif
