/* SPDX-License-Identifier: MIT */
/* Vector forms: Gaussians along an arc that is no circle and not much longer than their width. An incomplete Bessel
   function has no closed form: the Gauss rule of fixed points of the arc, whatever x is, so that neither angles nor
   ends are needed and nothing cancels. With H half the sweep and b = 2 a^2 rho k, k from the axis, an element's
   Gaussian is a factor times exp(b cos(phi - phi_x)), |phi| <= H: up to a b that depends on H the rule leaves 5e-15 of
   the integral (in floats 2e-8), wherever x is. */
#ifndef SKF_FIELD_BATCH_ARC_GAUSSIAN_H
#define SKF_FIELD_BATCH_ARC_GAUSSIAN_H

#include "field/batch_arc.h"
#include "num/gauss.h"

/* Half of the nodes of each rule */
enum { GAUSSIAN_ARC_FEW = SKF_COUNT(6, 4), GAUSSIAN_ARC_MANY = SKF_COUNT(12, 8) };

/* A node pair's coordinates from the middle of the arc, towards it and along it there, and its weight */
typedef struct arc_node {
  skf_vd u, t, w;
} arc_node;

typedef struct gaussian_arc_place {
  skf_v3d from, m, t, n;          /* the arc's middle; directions: outwards, along, across */
  skf_v3d up, on, over;           /* the same times -2 a^2 */
  skf_vd low_u, low_t, low_z;     /* what the middle lost to rounding */
  skf_vd exponent, rho, k2, most; /* of vd_exp2_product; bounds of k^2 and of the squared distance from the middle */
} gaussian_arc_place;

typedef struct few_nodes_row {
  gaussian_arc_place at;
  arc_node node[GAUSSIAN_ARC_FEW];
} few_nodes_row;

typedef struct many_nodes_row {
  gaussian_arc_place at;
  arc_node node[GAUSSIAN_ARC_MANY];
} many_nodes_row;

static double *gaussian_arc_pack(const skf_prepared *e, int pairs, bool many, double *k) {
  const skf_arc_plan *a = &e->plan.arc;
  double C = a->cos_half, S = a->sin_half, rho = a->radius, param = e->kernel.param, slope = -2 * param * param;
  skf_vec3 m = v3_add(v3_scale(C, a->e), v3_scale(S, a->f)), t = v3_sub(v3_scale(C, a->f), v3_scale(S, a->e));
  skf_vec3 center = e->primitive.arc.center, from = v3_mad(center, rho, m), axes[3] = {m, t, a->n};
  skf_dd3 off = dd3_diff(from, center);
  k = pack3(k, from);
  for (int i = 0; i < 3; i++) k = pack3(k, axes[i]);
  for (int i = 0; i < 3; i++) k = pack3(k, v3_scale(slope, axes[i]));
  k = pack1(pack1(k, -0.5 * dd3_power(rho, off) / rho), dd3_dot_d(off, t));
  k = pack_exponent(pack1(k, dd3_dot_d(off, a->raw) / a->raw_length), param);
  double far = skf_gaussian_arc_most(a->half, many) / (-slope * rho);
  double seen = sqrt((double)SKF_PICK(690, 84)) / param - rho * a->half; /* each node then is within VD_EXP_MAX */
  k = pack1(pack1(pack1(k, rho), far * far), seen > 0 ? seen * seen : 0);
  const skf_gauss_node *node = skf_gauss_rule(2 * pairs) + pairs;
  for (int j = 0; j < pairs; j++) {
    double phi = a->half * node[j].x, half = sin(0.5 * phi);
    k = pack1(pack1(pack1(k, -2 * rho * half * half), rho * sin(phi)), rho * a->half * node[j].w);
  }
  return k;
}

static double *few_nodes_pack(const skf_prepared *e, double *k) {
  return gaussian_arc_pack(e, GAUSSIAN_ARC_FEW, false, k);
}
static double *many_nodes_pack(const skf_prepared *e, double *k) {
  return gaussian_arc_pack(e, GAUSSIAN_ARC_MANY, true, k);
}

/* Coordinates of x, then the integrals of h, and of h times x less the element */
typedef struct gaussian_arc_state {
  skf_vd u, t, z, F;
  skf_vi good;
} gaussian_arc_state;
typedef gaussian_arc_state gaussian_arc_brief_state, gaussian_arc_wide_state;

SKF_INLINE void gaussian_arc_see(const gaussian_arc_place *c, skf_v3d x, gaussian_arc_state *s) {
  skf_v3d d = vd3_sub(x, c->from);
  skf_vd u = vd3_dot(d, c->m) + c->low_u, t = vd3_dot(d, c->t) + c->low_t, z = vd3_dot(d, c->n) + c->low_z;
  skf_vd k = u + c->rho, tt = t * t;
  s->u = u, s->t = t, s->z = z;
  s->good = (vd_fma(k, k, tt) < c->k2) & (vd_fma(z, z, vd_fma(u, u, tt)) < c->most);
}

SKF_INLINE void gaussian_arc_sum(const gaussian_arc_place *c, const arc_node *node, int pairs, gaussian_arc_state *s) {
  const skf_vd u = s->u, t = s->t, z = s->z, zz = z * z, zero = vd_set(0);
  skf_vd F = zero, U = zero, aside = zero;
  for (int j = 0; j < pairs; j += 2) {
    skf_vd du[2], w[4], h[4], ex[4];
    SKF_EACH(i, 2) {
      const arc_node *at = node + j + i;
      skf_vd one = t - at->t, other = t + at->t, rest;
      du[i] = u - at->u, rest = vd_fma(du[i], du[i], zz);
      w[2 * i] = vd_fma(one, one, rest), w[2 * i + 1] = vd_fma(other, other, rest);
    }
    SKF_EACH(i, 4) ex[i] = c->exponent;
    vd_exp2_products(4, ex, w, h);
    SKF_EACH(i, 2) {
      const arc_node *at = node + j + i;
      skf_vd both = at->w * (h[2 * i] + h[2 * i + 1]);
      F += both;
      U = vd_fma(both, du[i], U);
      aside = vd_fma(at->w * at->t, h[2 * i + 1] - h[2 * i], aside);
    }
  }
  s->F = F, s->u = U, s->t = vd_fma(t, F, aside), s->z = z * F;
}

SKF_INLINE skf_vvalue gaussian_arc_pull(const gaussian_arc_place *c, const gaussian_arc_state *s) {
  return (skf_vvalue){s->F, vd3_mad(vd3_mad(vd3_scale(s->u, c->up), s->t, c->on), s->z, c->over), s->good};
}

SKF_INLINE void gaussian_arc_brief_begin(const few_nodes_row *c, skf_v3d x, gaussian_arc_state *s) {
  gaussian_arc_see(&c->at, x, s);
}
SKF_INLINE void gaussian_arc_brief_sum(const few_nodes_row *c, gaussian_arc_state *s) {
  gaussian_arc_sum(&c->at, c->node, GAUSSIAN_ARC_FEW, s);
}
SKF_INLINE skf_vvalue gaussian_arc_brief_end(const few_nodes_row *c, const gaussian_arc_state *s) {
  return gaussian_arc_pull(&c->at, s);
}
SKF_INLINE void gaussian_arc_wide_begin(const many_nodes_row *c, skf_v3d x, gaussian_arc_state *s) {
  gaussian_arc_see(&c->at, x, s);
}
SKF_INLINE void gaussian_arc_wide_sum(const many_nodes_row *c, gaussian_arc_state *s) {
  gaussian_arc_sum(&c->at, c->node, GAUSSIAN_ARC_MANY, s);
}
SKF_INLINE skf_vvalue gaussian_arc_wide_end(const many_nodes_row *c, const gaussian_arc_state *s) {
  return gaussian_arc_pull(&c->at, s);
}

SKF_BATCH_STAGED(gaussian_arc_brief, few_nodes, skf_again_none, gaussian_arc_brief_sum, skf_stage_none, skf_stage_none)
SKF_BATCH_STAGED(gaussian_arc_wide, many_nodes, skf_again_none, gaussian_arc_wide_sum, skf_stage_none, skf_stage_none)

#endif
